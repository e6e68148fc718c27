#include "bounds/leak.h"
#include "motehound/matrix.h"
#include "port.h"
#include "unity.h"
#include "world/gas.h"

#include <math.h>

static const struct gas nominal = {
    .rate_mlps = 30, .mixing_m2ps = 30, .wind_mps = 1, .downwind_x = 1, .noise_ppm = 1e-4, .unit_ppm = 1e-3, .seed = 3};

void setUp(void) {}
void tearDown(void) {}

static void near(double expected, double actual, double share)
{
    TEST_ASSERT_TRUE(fabs(actual - expected) <= share * fabs(expected));
}

static void published_concentrations(void)
{
    static const struct {
        struct point place;
        double ppm, gradient[3];
    } east[] = {
        {{475, 112}, 0.000284331426462394, {4.69122311960534e-07, 1.37245575294756e-06, 9.47771421541312e-06}},
        {{450, 0}, 0.000397887357729738, {9.94718394324346e-07, 0, 1.32629119243246e-05}},
        {{250, -150}, 0.000276673812571135, {-3.68898416761511e-08, -3.43075527588207e-06, 9.22246041903783e-06}},
        {{60, 10}, 0.0105032416235515, {0.000473889943725953, 0.000648943970785145, 0.000350108054118385}},
        {{50.3, 0.2}, 0.157308924801105, {-0.00262181541335176, 0, 0.00524363082670351}},
        {{20, 40}, 0.000839055750319899, {-3.24434890123694e-05, 2.46123020093837e-05, 2.79685250106633e-05}},
    };
    for (size_t i = 0; i < sizeof east / sizeof east[0]; i++) {
        const struct point source = {50, 0};
        double gradient[3];
        gas_gradient(&nominal, source, east[i].place, gradient);
        near(east[i].ppm, gas_mean_ppm(&nominal, source, east[i].place), 1e-12);
        for (int k = 0; k < 3; k++) {
            near(east[i].gradient[k], gradient[k], 1e-11);
        }
    }
    const struct gas turned = {
        .rate_mlps = 45, .mixing_m2ps = 30, .wind_mps = 2, .downwind_x = cos(0.7), .downwind_y = sin(0.7)};
    const struct point source = {60, -20}, place = {40, -10};
    double gradient[3];
    gas_gradient(&turned, source, place, gradient);
    near(0.00377170712219057, gas_mean_ppm(&turned, source, place), 1e-12);
    near(-0.000359477555944556, gradient[0], 1e-11);
    near(5.0666084580215e-05, gradient[1], 1e-11);
    near(8.38157138264571e-05, gradient[2], 1e-11);
}

/* Mean and standard deviation of many readings, with five standard errors. */
static void readings_fluctuate_as_they_are_to(void)
{
    enum { READINGS = 40000 };
    const struct point source = {50, 0}, place = {150, 10};
    struct gas gas = nominal;
    gas.fluctuation = 0.3;
    const double mean = gas_mean_ppm(&gas, source, place) / gas.unit_ppm;
    const double sd = hypot(0.3 * mean, gas.noise_ppm / gas.unit_ppm);
    double sum = 0, squares = 0, product = 0, before = 0;
    for (uint32_t i = 0; i < READINGS; i++) {
        const uint32_t instant = i / 200;
        const double off = gas_reading(&gas, source, 5.0 * instant, i % 200, place) - mean;
        sum += off;
        squares += off * off;
        product += off * before;
        before = off;
    }
    TEST_ASSERT_TRUE(fabs(sum / READINGS) < 5 * sd / sqrt(READINGS));
    near(sd, sqrt(squares / READINGS), 0.03);
    TEST_ASSERT_TRUE(fabs(product / READINGS) < 5 * sd * sd / sqrt(READINGS));
    gas.fluctuation = gas.noise_ppm = 0;
    near(mean, gas_reading(&gas, source, 5, 7, place), 1e-12);
}

static void information_of_six_samples(void)
{
    const struct scenario_prior vague = {.sd_x_m = 1e9, .sd_y_m = 1e9, .rate_sd = 1e9};
    const struct scenario_prior expected = {.sd_x_m = 150, .sd_y_m = 120, .rate_sd = 30};
    struct leak_information information = leak_information_of(&vague);
    const double alone = leak_bound(&(struct leak_information){{1, 0, 4, 0, 0, 0.25}}).position_m;
    for (int k = 0; k < 6; k++) {
        leak_information_add(&information, &nominal, (struct point){50, 0},
                             (struct point){430 + 12 * k, 30 * cos(1.3 * k)});
    }
    near(0.000522954724243055, information.J[MH_PACKED(0, 0)], 1e-9);
    near(0.000102901798194379, information.J[MH_PACKED(1, 1)], 1e-9);
    near(0.0987473768428994, information.J[MH_PACKED(2, 2)], 1e-9);
    near(5.85214202406571e-05, information.J[MH_PACKED(0, 1)], 1e-9);
    near(0.00717761296666797, information.J[MH_PACKED(0, 2)], 1e-9);
    near(0.000792087373775646, information.J[MH_PACKED(1, 2)], 1e-9);
    near(sqrt(1.25), alone, 1e-12);
    const struct leak_information before = leak_information_of(&expected);
    near(hypot(150, 120), leak_bound(&before).position_m, 1e-12);
    near(30, leak_bound(&before).rate, 1e-12);
}

/* J J^-1 = 1: the bounds are roots of what solves J v = e. */
static void bound_is_the_inverse(void)
{
    const struct leak_information information = {{4, 1, 3, 0.5, -0.2, 0.25}};
    const double determinant = 4 * (3 * 0.25 - 0.04) - 1 * (0.25 + 0.1) + 0.5 * (-0.2 - 1.5);
    const struct leak_bound bound = leak_bound(&information);
    near(sqrt(((3 * 0.25 - 0.04) + (4 * 0.25 - 0.25)) / determinant), bound.position_m, 1e-12);
    near(sqrt((4 * 3 - 1) / determinant), bound.rate, 1e-12);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(published_concentrations);
    RUN_TEST(readings_fluctuate_as_they_are_to);
    RUN_TEST(information_of_six_samples);
    RUN_TEST(bound_is_the_inverse);
    port_exit(UNITY_END() > 0);
    return 0;
}
