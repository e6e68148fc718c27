#include "motehound/plume_regression.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

enum { PLACES = 3, SENSORS = 4, WINDS = 12 };

static const struct mh_vec2 places[PLACES] = {{0, 0}, {30, 10}, {-20, 25}};
static const struct mh_vec2 sensors[SENSORS] = {{50, 0}, {0, 50}, {-50, 0}, {0, -50}};
static struct mh_plume_regression regression;
static struct mh_plume_fit fit;
static uint32_t random_state;

static mh_real chance(void)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (mh_real)(random_state >> 8) * (1.0f / 16777216.0f);
}

static struct mh_plume_share wind(uint8_t i)
{
    const struct mh_plume_share one = {{0.9f, 3.0f, mh_direction((mh_real)i * 0.5f - 3.0f)}, 1.0f};
    return one;
}

static mh_real concentration(uint8_t place, uint8_t w, uint8_t sensor)
{
    const struct mh_plume_share air = wind(w);
    mh_real c = 0;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(&air.plume, sensors[sensor], places[place], 0, &c, NULL));
    return c;
}

/* What the sensor reads of a release of 400 at `place`, wrong by up to `error`. */
static mh_real reading(uint8_t place, uint8_t w, uint8_t sensor, mh_real error)
{
    return 400.0f * concentration(place, w, sensor) + error * (2.0f * chance() - 1.0f);
}

static void release(uint8_t place, mh_real error)
{
    mh_plume_regression_init(&regression);
    random_state = 1;
    for (uint8_t w = 0; w < WINDS; w++) {
        const struct mh_plume_share air = wind(w);
        for (uint8_t s = 0; s < SENSORS; s++) {
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_regression_take(&regression, places, PLACES, &air, 1, sensors[s],
                                                                  reading(place, w, s, error)));
        }
    }
}

static void without_noise_place_and_rate_are_exact(void)
{
    for (uint8_t place = 0; place < PLACES; place++) {
        release(place, 0);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_regression_solve(&regression, places, PLACES, 1.0f, &fit));
        TEST_ASSERT_EQUAL_UINT16(place, fit.place);
        TEST_ASSERT_FLOAT_WITHIN(0.01f, 400.0f, fit.rate);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.0f, fit.likelihood);
        TEST_ASSERT_FLOAT_WITHIN(0.1f, 0, fit.spread.xx + fit.spread.yy);
    }
}

/* The residual of a place, rate by rate, from the readings themselves. */
static mh_real least_residual(uint8_t place, uint8_t truth, mh_real error, mh_real *rate)
{
    mh_real least = 1e30f;
    for (mh_real q = 0; q < 1000.0f; q += 10.0f) {
        mh_real sum = 0;
        random_state = 1;
        for (uint8_t w = 0; w < WINDS; w++) {
            for (uint8_t s = 0; s < SENSORS; s++) {
                sum += mh_squared(reading(truth, w, s, error) - q * concentration(place, w, s));
            }
        }
        if (sum < least) {
            least = sum;
            *rate = q;
        }
    }
    return least;
}

static void agrees_with_trying_every_rate(void)
{
    const mh_real error = 2.0f; /* the readings themselves go up to 1.5 */
    mh_real residuals[PLACES], rates[PLACES], likelihoods[PLACES], sum = 0;
    uint8_t best = 0;
    for (uint8_t i = 0; i < PLACES; i++) {
        residuals[i] = least_residual(i, 1, error, &rates[i]);
        best = residuals[i] < residuals[best] ? i : best;
    }
    struct mh_sym2 spread = {0, 0, 0};
    for (uint8_t i = 0; i < PLACES; i++) {
        likelihoods[i] = powf(residuals[i] / residuals[best], -0.5f * WINDS * SENSORS / 4.0f);
        const mh_real x = places[i].x - places[best].x, y = places[i].y - places[best].y;
        sum += likelihoods[i];
        spread.xx += likelihoods[i] * x * x;
        spread.xy += likelihoods[i] * x * y;
        spread.yy += likelihoods[i] * y * y;
    }
    release(1, error);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_regression_solve(&regression, places, PLACES, 4.0f, &fit));
    TEST_ASSERT_EQUAL_UINT16(best, fit.place);
    TEST_ASSERT_FLOAT_WITHIN(5.1f, rates[best], fit.rate);
    TEST_ASSERT_TRUE(fit.likelihood < 0.95f); /* so that the others weigh */
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 1.0f / sum, fit.likelihood);
    TEST_ASSERT_FLOAT_WITHIN(5.0f, spread.xx / sum, fit.spread.xx);
    TEST_ASSERT_FLOAT_WITHIN(5.0f, spread.xy / sum, fit.spread.xy);
    TEST_ASSERT_FLOAT_WITHIN(5.0f, spread.yy / sum, fit.spread.yy);
}

/* Two plumes of half the gas each are their mean. */
static void shares_of_plumes_add_up(void)
{
    struct mh_plume_share air[2] = {wind(2), wind(9)};
    air[0].share = air[1].share = 0.5f;
    mh_plume_regression_init(&regression);
    for (uint8_t s = 0; s < SENSORS; s++) {
        const mh_real z = 50.0f * (concentration(0, 2, s) + concentration(0, 9, s));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_regression_take(&regression, places, 1, air, 2, sensors[s], z));
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_regression_solve(&regression, places, 1, 1.0f, &fit));
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 100.0f, fit.rate);
}

static void what_is_forgotten_gives_way(void)
{
    release(0, 0);
    mh_plume_regression_forget(&regression, 1e-4f);
    for (uint8_t w = 0; w < WINDS; w++) {
        const struct mh_plume_share air = wind(w);
        for (uint8_t s = 0; s < SENSORS; s++) {
            TEST_ASSERT_EQUAL_INT(
                MH_OK, mh_plume_regression_take(&regression, places, PLACES, &air, 1, sensors[s], reading(2, w, s, 0)));
        }
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_regression_solve(&regression, places, PLACES, 1.0f, &fit));
    TEST_ASSERT_EQUAL_UINT16(2, fit.place);
    TEST_ASSERT_FLOAT_WITHIN(1.0f, 400.0f, fit.rate);
}

static void nothing_to_say(void)
{
    const struct mh_plume_share air = wind(0);
    mh_plume_regression_init(&regression);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_plume_regression_solve(&regression, places, PLACES, 1.0f, &fit));
    /* below the background everywhere: no release explains that */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_regression_take(&regression, places, PLACES, &air, 1, sensors[0], -1.0f));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_plume_regression_solve(&regression, places, PLACES, 1.0f, &fit));
}

static void refuses_without_a_trace(void)
{
    release(1, 0);
    const struct mh_plume_regression before = regression;
    const struct mh_plume_share air = wind(6);
    const struct mh_vec2 nowhere = {NAN, 0}, inside = {0, 0};
    struct mh_plume_share singular = air;
    singular.plume.diffusion_m2ps = 1e-38f;
    singular.plume.wind_mps = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_plume_regression_take(&regression, places, 0, &air, 1, sensors[0], 1.0f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_plume_regression_take(&regression, places, MH_LEAK_PLACES_MAX + 1, &air,
                                                                    1, sensors[0], 1.0f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE,
                          mh_plume_regression_take(&regression, places, PLACES, &air, 1, nowhere, 1.0f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE,
                          mh_plume_regression_take(&regression, places, PLACES, &air, 1, sensors[0], NAN));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE,
                          mh_plume_regression_take(&regression, places, PLACES, &air, 1, sensors[0], 1e30f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE,
                          mh_plume_regression_take(&regression, places, PLACES, &singular, 1, inside, 1.0f));
    TEST_ASSERT_EQUAL_INT(0, memcmp(&before, &regression, sizeof before));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_plume_regression_solve(&regression, places, PLACES, 0.5f, &fit));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_plume_regression_solve(&regression, places, PLACES, NAN, &fit));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_plume_regression_solve(&regression, places, 0, 1.0f, &fit));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_noise_place_and_rate_are_exact);
    RUN_TEST(agrees_with_trying_every_rate);
    RUN_TEST(shares_of_plumes_add_up);
    RUN_TEST(what_is_forgotten_gives_way);
    RUN_TEST(nothing_to_say);
    RUN_TEST(refuses_without_a_trace);
    port_exit(UNITY_END() > 0);
    return 0;
}
