#include "motehound/gas_wind.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

enum { PLACES = 3, SENSORS = 4 };

#define MINUTE ((mh_tick)60000)

static const struct mh_place places[PLACES] = {{500000000, 0, 0}, {500030000, 10000, 0}, {499980000, 25000, 0}};
static const struct mh_place sensors[SENSORS] = {
    {500050000, 0, 2000}, {500000000, 50000, 2000}, {499950000, 0, 2000}, {500000000, -50000, 2000}};
static struct mh_gas_wind gas;
static struct mh_gas_wind_config config;
static struct mh_measurement set[SENSORS + 2];
static struct mh_estimate estimate;
static uint32_t random_state;

static mh_real chance(void)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (mh_real)(random_state >> 8) * (1.0f / 16777216.0f);
}

static void begin(void)
{
    mh_gas_wind_config_default(&config);
    memcpy(config.places, places, sizeof places);
    config.place_count = PLACES;
    config.learn = 3 * MINUTE;
    config.direction_sd_rad = 0;
    config.background.step = 1e-4f;
    memset(&gas, 0x55, sizeof gas);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas_wind.init(&gas, &config, MINUTE));
    random_state = 1;
}

static struct mh_measurement measured(mh_node_id node, struct mh_place place, mh_tick time, uint8_t target,
                                      mh_real value)
{
    const struct mh_measurement m = {
        .node = node, .place = place, .time = time, .target = target, .value = mh_q20_from_real(value)};
    return m;
}

static mh_real brought(uint8_t place, struct mh_vec2 wind, uint8_t sensor)
{
    const mh_real speed = sqrtf(wind.x * wind.x + wind.y * wind.y);
    const struct mh_plume plume = {config.mixing_m * speed, speed, {wind.x / speed, wind.y / speed}};
    mh_real c = 0;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(&plume, mh_place_relative(&sensors[sensor], &places[0]),
                                                mh_place_relative(&places[place], &places[0]), 0, &c, NULL));
    return c;
}

/* Readings and wind of an instant at which `place` releases `rate`, each sensor with a background of its own; half of the gas left in the wind before. */
static size_t instant(mh_tick time, uint8_t place, mh_real rate, struct mh_vec2 before, struct mh_vec2 wind)
{
    for (uint8_t i = 0; i < SENSORS; i++) {
        const mh_real c = 0.5f * (brought(place, before, i) + brought(place, wind, i));
        set[i] = measured(i, sensors[i], time, 0, 1.5f + 0.2f * (mh_real)i + rate * c);
    }
    set[SENSORS] = measured(0, sensors[0], time, MH_TARGET_WIND_X, wind.x);
    set[SENSORS + 1] = measured(0, sensors[0], time, MH_TARGET_WIND_Y, wind.y);
    return SENSORS + 2;
}

static enum mh_status step(mh_tick time, size_t count)
{
    return mh_tracker_gas_wind.step(&gas, time, set, count, &estimate);
}

/* Three instants to learn the backgrounds, then the release in winds from all around. */
static mh_tick release(uint8_t place, mh_real rate)
{
    mh_tick now = 0;
    struct mh_vec2 before = {2.0f, 0};
    for (; now < 3 * MINUTE; now += MINUTE) {
        TEST_ASSERT_EQUAL_INT(MH_NONE, step(now, instant(now, place, 0, before, before)));
    }
    for (uint8_t i = 0; i < 24; i++, now += MINUTE) {
        const struct mh_vec2 to = mh_direction((mh_real)i * 0.26f - 3.1f);
        const struct mh_vec2 wind = {3.0f * to.x, 3.0f * to.y};
        TEST_ASSERT_EQUAL_INT(MH_OK, step(now, instant(now, place, rate, before, wind)));
        before = wind;
    }
    return now;
}

static void finds_the_place_and_the_rate(void)
{
    for (uint8_t place = 0; place < PLACES; place++) {
        begin();
        release(place, 400.0f);
        TEST_ASSERT_EQUAL_INT(0, memcmp(&places[place], &estimate.origin, sizeof estimate.origin));
        TEST_ASSERT_EQUAL_FLOAT(0, estimate.position.x);
        TEST_ASSERT_FLOAT_WITHIN(1.0f, 400.0f, estimate.rate);
        TEST_ASSERT_EQUAL_UINT8(2, estimate.states);
        TEST_ASSERT_EQUAL_UINT16(SENSORS, estimate.measurements);
        TEST_ASSERT_TRUE(gas.fit.likelihood > 0.9f);
        TEST_ASSERT_TRUE(estimate.covariance.xx >= 9.0f && estimate.covariance.yy >= 9.0f);
    }
}

static void unit_scales_the_rate_alone(void)
{
    begin();
    release(1, 400.0f);
    const mh_real rate = estimate.rate;
    begin();
    config.unit = 0.5f; /* the sensors count half as much: the same numbers are half the gas */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas_wind.init(&gas, &config, MINUTE));
    release(1, 400.0f);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 0.5f * rate, estimate.rate);
}

/* Readings of an instant whose wind is missing, or half of it, tell nothing of the place. */
static void without_wind_only_backgrounds_are_learned(void)
{
    const struct mh_vec2 wind = {3.0f, 0};
    begin();
    for (mh_tick now = 0; now < 20 * MINUTE; now += MINUTE) {
        instant(now, 0, now < 3 * MINUTE ? 0 : 400.0f, wind, wind);
        TEST_ASSERT_EQUAL_INT(MH_NONE, step(now, SENSORS + (size_t)(now / MINUTE % 2)));
    }
    TEST_ASSERT_EQUAL_UINT16(SENSORS, gas.sensor_count);
    TEST_ASSERT_EQUAL_FLOAT(0, gas.regression.count);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_gas_wind.predict(&gas, 20 * MINUTE, &estimate));
}

static void winds_of_several_anemometers_are_averaged(void)
{
    begin();
    struct mh_measurement both[4];
    both[0] = measured(1, sensors[1], 0, MH_TARGET_WIND_X, 4.0f);
    both[1] = measured(1, sensors[1], 0, MH_TARGET_WIND_Y, -2.0f);
    both[2] = measured(2, sensors[2], 0, MH_TARGET_WIND_X, -4.0f);
    both[3] = measured(2, sensors[2], 0, MH_TARGET_WIND_Y, 8.0f);
    mh_tracker_gas_wind.step(&gas, 0, both, 4, &estimate);
    TEST_ASSERT_EQUAL_FLOAT(3.0f, gas.air[1].plume.wind_mps); /* (0, 3) */
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0, gas.air[1].plume.downwind.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1.0f, gas.air[1].plume.downwind.y);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.9f, gas.air[1].plume.diffusion_m2ps);
}

static void a_calm_has_a_least_wind(void)
{
    begin();
    set[0] = measured(1, sensors[1], 0, MH_TARGET_WIND_X, 0);
    set[1] = measured(1, sensors[1], 0, MH_TARGET_WIND_Y, 0);
    step(0, 2);
    TEST_ASSERT_EQUAL_FLOAT(MH_GAS_CALM_MPS, gas.air[1].plume.wind_mps);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, gas.air[1].plume.downwind.x);
}

static void goes_on_without_measurements(void)
{
    begin();
    mh_tick now = release(2, 400.0f);
    const mh_real rate = estimate.rate;
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, step(now - MINUTE, 0));
    TEST_ASSERT_EQUAL_INT(MH_OK, step(now, 0));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_COASTED, estimate.flags);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, rate, estimate.rate);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_tracker_gas_wind.predict(&gas, now - 1, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas_wind.predict(&gas, now + 1, &estimate));
    TEST_ASSERT_EQUAL_UINT32(now + 1, estimate.time);
}

static void random_input_leaves_it_sound(void)
{
    begin();
    config.learn = 0;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas_wind.init(&gas, &config, MINUTE));
    mh_tick now = 4294000000u; /* wraps on the way */
    for (uint16_t i = 0; i < 400; i++, now += (mh_tick)(1.0f + chance() * 120000.0f)) {
        const size_t count = (size_t)(chance() * (SENSORS + 2));
        for (size_t k = 0; k < count; k++) {
            set[k].node = (mh_node_id)(chance() * 2 * MH_LEAK_SENSORS_MAX);
            set[k].target = (uint8_t)(chance() < 0.5f ? 0 : 252 + 4 * chance());
            set[k].value = chance() < 0.3f ? INT32_MAX : chance() < 0.3f ? INT32_MIN : (mh_q20)(chance() * 1e7f);
            set[k].place.x_mm = (int32_t)((chance() - 0.5f) * 2e9f);
            set[k].place.y_mm = (int32_t)((chance() - 0.5f) * 2e5f);
            set[k].time = now;
        }
        const enum mh_status status = step(now, count);
        TEST_ASSERT_TRUE(status == MH_OK || status == MH_NONE);
        if (status == MH_OK) {
            TEST_ASSERT_TRUE(mh_finite(estimate.rate) && estimate.rate > 0);
            TEST_ASSERT_TRUE(mh_finite(estimate.covariance.xx) && estimate.covariance.xx >= 9.0f);
            TEST_ASSERT_TRUE(estimate.covariance.xx * estimate.covariance.yy > mh_squared(estimate.covariance.xy));
            TEST_ASSERT_TRUE(gas.fit.likelihood > 0 && gas.fit.likelihood <= 1.0f);
        }
    }
    TEST_ASSERT_EQUAL_UINT16(MH_LEAK_SENSORS_MAX, gas.sensor_count);
    TEST_ASSERT_TRUE(gas.crowded > 0);
}

static void refused(void)
{
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_gas_wind.init(&gas, &config, MINUTE));
    begin();
}

static void refuses_what_is_out_of_range(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_gas_wind.init(&gas, &config, 0));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_gas_wind.step(&gas, 0, NULL, 1, &estimate));
    config.place_count = 0;
    refused();
    config.place_count = MH_LEAK_PLACES_MAX + 1;
    refused();
    config.places[1].x_mm = MH_COORDINATE_MAX_MM + 1;
    refused();
    config.mixing_m = 0;
    refused();
    config.direction_sd_rad = NAN;
    refused();
    config.unit = 0;
    refused();
    config.place_sd_m = 0; /* its covariance would be none */
    refused();
    config.correlation = 0.5f;
    refused();
    config.background.quantile = 0;
    refused();
    config.background.step = INFINITY;
    refused();
    config.learn = 0x80000000u;
    refused();
    config.memory = 0x80000000u;
    refused();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(finds_the_place_and_the_rate);
    RUN_TEST(unit_scales_the_rate_alone);
    RUN_TEST(without_wind_only_backgrounds_are_learned);
    RUN_TEST(winds_of_several_anemometers_are_averaged);
    RUN_TEST(a_calm_has_a_least_wind);
    RUN_TEST(goes_on_without_measurements);
    RUN_TEST(random_input_leaves_it_sound);
    RUN_TEST(refuses_what_is_out_of_range);
    port_exit(UNITY_END() > 0);
    return 0;
}
