#include "port.h"
#include "radio/propagation.h"
#include "unity.h"

#include <math.h>

enum { PLACES = 300, LINKS = PLACES * (PLACES - 1) / 2 };

void setUp(void) {}
void tearDown(void) {}

static void expect_near(double tolerance, double expected, double value)
{
    TEST_ASSERT_TRUE(fabs(value - expected) <= tolerance);
}

static const struct propagation_config log_distance = {
    .kind = PROPAGATION_LOG_DISTANCE, .power_dbm = 0, .exponent = 3, .reference_loss_db = 46.68, .shadowing_db = 0};

static double power_dbm(const struct propagation *propagation, double distance_m)
{
    const struct place a = {3, -4, 0}, b = {3 + distance_m * 0.6, -4 + distance_m * 0.8, 1};
    return 10 * log10(propagation_power(propagation, &a, &b));
}

/* 0 dBm - 46.68 dB - 30 lg d: -46.68, -76.68, -106.68 dBm at 1, 10, 100 m; nearer than 1 m as at 1 m. */
static void log_distance_by_hand(void)
{
    struct propagation_config config = log_distance;
    struct propagation propagation = propagation_make(&config, 2, 1);
    expect_near(1e-9, -46.68, power_dbm(&propagation, 1));
    expect_near(1e-9, -46.68, power_dbm(&propagation, 0.3));
    expect_near(1e-9, -76.68, power_dbm(&propagation, 10));
    expect_near(1e-9, -106.68, power_dbm(&propagation, 100));
    expect_near(1e-6, 100, propagation_reach_m(&propagation, mw_from_dbm(-106.68)));
    config.power_dbm = 5;
    config.exponent = 2;
    propagation = propagation_make(&config, 2, 1);
    expect_near(1e-9, 5 - 46.68 - 40, power_dbm(&propagation, 100));
}

static void disc_has_an_edge(void)
{
    const struct propagation_config config = {.kind = PROPAGATION_DISC, .range_m = 25};
    const struct propagation propagation = propagation_make(&config, 2, 1);
    const struct place a = {0, 0, 0}, on = {15, 20, 1}, beyond = {15, 20.001, 1};
    TEST_ASSERT_TRUE(propagation_power(&propagation, &a, &on) == 1);
    TEST_ASSERT_TRUE(propagation_power(&propagation, &a, &beyond) == 0);
}

/* Over 44,850 links the mean is 0 within 4 sd / sqrt(links); the standard deviation within 4 sd / sqrt(2 links) of that of a normal cut
 * at 3 sd, which is 0.99748 sd; the same both ways; no link like another; another seed, other links. */
static void shadowing_is_normal_and_symmetric(void)
{
    const double sd = 4;
    struct propagation_config config = log_distance;
    config.shadowing_db = sd;
    const struct propagation propagation = propagation_make(&config, PLACES, 5),
                             other = propagation_make(&config, PLACES, 6);
    double sum = 0, sum_sq = 0, product = 0, beyond = 0;
    for (uint32_t a = 0; a < PLACES; a++) {
        for (uint32_t b = 0; b < a; b++) {
            const double x = propagation_shadowing_db(&propagation, a, b);
            TEST_ASSERT_TRUE(propagation_shadowing_db(&propagation, b, a) == x);
            TEST_ASSERT_TRUE(fabs(x) <= 3 * sd);
            sum += x;
            sum_sq += x * x;
            product += x * propagation_shadowing_db(&other, a, b);
            beyond += fabs(x) > sd;
        }
    }
    expect_near(4 * sd / sqrt(LINKS), 0, sum / LINKS);
    expect_near(4 * sd / sqrt(2.0 * LINKS), 0.99748 * sd, sqrt(sum_sq / LINKS));
    expect_near(4 / sqrt(LINKS), 0, product / LINKS / (sd * sd));
    expect_near(4 * sqrt(0.3173 * 0.6827 / LINKS), 0.3173, beyond / LINKS);
}

/* Regression of the power over lg d returns the exponent and the loss at 1 m. */
static void exponent_shows_through_the_shadowing(void)
{
    struct propagation_config config = log_distance;
    config.shadowing_db = 6;
    config.exponent = 3.3;
    const struct propagation propagation = propagation_make(&config, PLACES, 11);
    double n = 0, sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
    for (uint32_t a = 0; a < PLACES; a++) {
        for (uint32_t b = 0; b < a; b++) {
            const struct place from = {0, 0, a}, to = {pow(10, 3.0 * (a + b) / (2 * PLACES)), 0, b};
            const double x = log10(to.x_m), y = 10 * log10(propagation_power(&propagation, &from, &to));
            n++;
            sum_x += x;
            sum_y += y;
            sum_xx += x * x;
            sum_xy += x * y;
        }
    }
    const double spread = sum_xx - sum_x * sum_x / n;
    const double slope = (sum_xy - sum_x * sum_y / n) / spread;
    expect_near(4 * 6 / sqrt(spread), -33, slope);
    expect_near(4 * 6 * sqrt(sum_xx / n / spread), -46.68, (sum_y - slope * sum_x) / n);
}

/* Nothing as strong arrives from beyond the reach, and something does from just within. */
static void reach_bounds_what_arrives(void)
{
    struct propagation_config config = log_distance;
    config.shadowing_db = 4;
    const struct propagation propagation = propagation_make(&config, PLACES, 2);
    const double least = mw_from_dbm(-95), reach = propagation_reach_m(&propagation, least);
    double strongest = 0;
    for (uint32_t a = 0; a < PLACES; a++) {
        for (uint32_t b = 0; b < a; b++) {
            const struct place from = {0, 0, a}, to = {reach * 1.0001, 0, b};
            strongest = fmax(strongest, propagation_power(&propagation, &from, &to));
        }
    }
    TEST_ASSERT_TRUE(strongest < least && strongest > 0.99 * least);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(log_distance_by_hand);
    RUN_TEST(disc_has_an_edge);
    RUN_TEST(shadowing_is_normal_and_symmetric);
    RUN_TEST(exponent_shows_through_the_shadowing);
    RUN_TEST(reach_bounds_what_arrives);
    port_exit(UNITY_END() > 0);
    return 0;
}
