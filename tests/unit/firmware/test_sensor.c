#include "motehound/sensor.h"
#include "port.h"
#include "unity.h"

#define T 1000u

static struct mh_sensor_config config;
static struct mh_sensor sensor;
static struct mh_sample sample;

void setUp(void)
{
    const struct mh_sensor_config plain = {
        .q20_per_count = 1, .counts_min = INT32_MIN, .counts_max = INT32_MAX, .interval = T, .threshold = MH_Q20(0.2f)};
    config = plain;
    TEST_ASSERT_EQUAL(MH_OK, mh_sensor_init(&sensor, &config));
}

void tearDown(void) {}

static enum mh_status take(mh_tick time, int32_t counts)
{
    const struct mh_reading reading = {time, counts, 0};
    return mh_sensor_take(&sensor, &reading, &sample);
}

static void bad_configurations_are_refused(void)
{
    const struct mh_sensor_config good = config;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_sensor_init(&sensor, NULL));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_sensor_init(NULL, &config));
    config.interval = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_sensor_init(&sensor, &config));
    config.interval = 3600001u;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_sensor_init(&sensor, &config));
    config = good;
    config.report_spread = T;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_sensor_init(&sensor, &config));
    config = good;
    config.q20_per_count = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_sensor_init(&sensor, &config));
    config = good;
    config.counts_min = 5;
    config.counts_max = 4;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_sensor_init(&sensor, &config));
}

/* A 10-bit converter over 0 to 5 with an offset of 12 counts: 5 / 1023 of Q11.20 is 5125.0 */
static void counts_become_a_quantity(void)
{
    config.zero_counts = 12;
    config.q20_per_count = 5125;
    config.counts_min = 0;
    config.counts_max = 1023;
    TEST_ASSERT_EQUAL(MH_OK, take(0, 12));
    TEST_ASSERT_EQUAL_INT32(0, sample.value);
    TEST_ASSERT_EQUAL(MH_OK, take(T, 1023));
    TEST_ASSERT_EQUAL_INT32(1011 * 5125L, sample.value);
    TEST_ASSERT_EQUAL(MH_OK, take(2 * T, 0));
    TEST_ASSERT_EQUAL_INT32(-12 * 5125L, sample.value);
    TEST_ASSERT_EQUAL_INT32(-1023 * 5125L, sample.increment);
    TEST_ASSERT_EQUAL(MH_ERR_RANGE, take(3 * T, 1024));
    TEST_ASSERT_EQUAL(MH_ERR_RANGE, take(3 * T, -1));
}

static void conversion_and_difference_saturate(void)
{
    config.q20_per_count = INT32_MAX;
    config.zero_counts = INT32_MIN;
    TEST_ASSERT_EQUAL(MH_OK, take(0, INT32_MAX)); /* the largest product there is */
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, sample.value);
    config.zero_counts = INT32_MAX;
    TEST_ASSERT_EQUAL(MH_OK, take(T, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, sample.value);
    TEST_ASSERT_TRUE(sample.has_increment);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, sample.increment);
    config.q20_per_count = 1 << 14; /* values that are told, with a difference that is not */
    config.zero_counts = 0;
    TEST_ASSERT_EQUAL(MH_OK, take(3 * T, 100000));
    TEST_ASSERT_EQUAL(MH_OK, take(4 * T, -100000));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, sample.increment);
}

static void no_increment_from_a_reading_that_never_came(void)
{
    TEST_ASSERT_EQUAL(MH_OK, take(0, 100));
    TEST_ASSERT_FALSE(sample.has_increment);
    TEST_ASSERT_EQUAL(MH_OK, take(T, 130));
    TEST_ASSERT_TRUE(sample.has_increment);
    TEST_ASSERT_EQUAL_INT32(30, sample.increment);
    TEST_ASSERT_EQUAL(MH_OK, take(3 * T, 200)); /* 2 T was lost */
    TEST_ASSERT_FALSE(sample.has_increment);
    TEST_ASSERT_EQUAL_INT32(0, sample.increment);
    TEST_ASSERT_EQUAL(MH_OK, take(2 * T, 150)); /* no: it was late */
    TEST_ASSERT_EQUAL_INT32(20, sample.increment);
    TEST_ASSERT_EQUAL(MH_OK, mh_sensor_recall(&sensor, 3 * T, &sample));
    TEST_ASSERT_EQUAL_INT32(50, sample.increment);
}

static void repeated_and_too_old_readings_are_refused(void)
{
    for (mh_tick k = 0; k < MH_SENSOR_HISTORY; k++) {
        TEST_ASSERT_EQUAL(MH_OK, take((k + 10) * T, 0));
    }
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, take(10 * T, 7));
    TEST_ASSERT_EQUAL(MH_ERR_TIME, take(9 * T, 7));
    TEST_ASSERT_EQUAL(MH_OK, mh_sensor_recall(&sensor, 10 * T, &sample)); /* the refused ones left no trace */
    TEST_ASSERT_EQUAL_INT32(0, sample.value);
    TEST_ASSERT_EQUAL(MH_NONE, mh_sensor_recall(&sensor, 9 * T, &sample));
}

static void jitter_of_a_quarter_interval_is_tolerated(void)
{
    TEST_ASSERT_EQUAL(MH_OK, take(0, 1));
    TEST_ASSERT_EQUAL(MH_OK, take(T + T / 4, 2));
    TEST_ASSERT_TRUE(sample.has_increment);
    TEST_ASSERT_EQUAL(MH_OK, take(2 * T + T / 2 + 1, 3));
    TEST_ASSERT_FALSE(sample.has_increment);
    TEST_ASSERT_EQUAL(MH_OK, mh_sensor_recall(&sensor, T, &sample));
    TEST_ASSERT_EQUAL_INT32(2, sample.value);
    TEST_ASSERT_EQUAL(MH_NONE, mh_sensor_recall(&sensor, T - 1, &sample));
    TEST_ASSERT_FALSE(mh_sensor_is_of(&sensor, &sample, T - 1));
    TEST_ASSERT_TRUE(mh_sensor_is_of(&sensor, &sample, T + T / 2));
}

static void ticks_may_wrap(void)
{
    const mh_tick before = (mh_tick)0 - T / 2; /* half an interval before the wrap */
    TEST_ASSERT_EQUAL(MH_OK, take(before, 10));
    TEST_ASSERT_EQUAL(MH_OK, take(before + 2 * T, 40));
    TEST_ASSERT_FALSE(sample.has_increment);
    TEST_ASSERT_EQUAL(MH_OK, take(before + T, 15));
    TEST_ASSERT_EQUAL_INT32(5, sample.increment);
    TEST_ASSERT_EQUAL(MH_OK, mh_sensor_recall(&sensor, before + 2 * T, &sample));
    TEST_ASSERT_EQUAL_INT32(25, sample.increment);
}

static void targets_are_differenced_apart(void)
{
    const struct mh_reading readings[] = {{0, 100, 1}, {0, 500, 2}, {T, 110, 1}, {T, 490, 2}};
    for (uint8_t i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL(MH_OK, mh_sensor_take(&sensor, &readings[i], &sample));
        TEST_ASSERT_EQUAL_UINT8(readings[i].target, sample.target);
    }
    TEST_ASSERT_EQUAL_INT32(-10, sample.increment);
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, mh_sensor_take(&sensor, &readings[2], &sample));
}

static void reports_follow_algorithm_1(void)
{
    const mh_q20 chi = config.threshold;
    const struct {
        mh_q20 value, increment;
        bool has_increment, tracking, reports;
    } cases[] = {
        {chi, 0, false, false, false},      {chi + 1, 0, false, false, true},  {chi + 1, 0, false, true, false},
        {chi, chi, true, true, true},       {chi, chi - 1, true, true, false}, {chi + 1, -chi, true, false, true},
        {chi + 1, -chi, true, true, false},
    };
    for (uint8_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct mh_sample s = {
            .value = cases[i].value, .increment = cases[i].increment, .has_increment = cases[i].has_increment};
        TEST_ASSERT_EQUAL(cases[i].reports, mh_sensor_reports(&sensor, &s, cases[i].tracking));
    }
    config.report_always = true;
    const struct mh_sample nothing = {.value = 0};
    TEST_ASSERT_TRUE(mh_sensor_reports(&sensor, &nothing, true));
}

static void reported_samples_are_remembered(void)
{
    TEST_ASSERT_EQUAL(MH_OK, take(0, 1));
    mh_sensor_mark_reported(&sensor, &sample);
    TEST_ASSERT_EQUAL(MH_OK, take(T, 2));
    TEST_ASSERT_FALSE(sample.reported);
    TEST_ASSERT_EQUAL(MH_OK, mh_sensor_recall(&sensor, 0, &sample));
    TEST_ASSERT_TRUE(sample.reported);
}

/* Against a memory of every reading: samples k = 0..59 across the wrap, lost with 20 %, late by up to 2 places, repeated with 10 %. */
static void brute_force(void)
{
    enum { N = 60 };
    static int32_t value[N];
    static bool taken[N];
    uint32_t random = 12345;
    const mh_tick begin = (mh_tick)0 - 30 * T;
    int increments = 0;
    for (int i = 0; i < N; i++) {
        value[i] = (int32_t)(i * i * 37L % 1009);
        taken[i] = false;
    }
    for (int step = 0; step < 3 * N; step++) {
        random = random * 1664525u + 1013904223u;
        const int k = step / 3 - (int)(random >> 24) % 3; /* each sample has several chances, in no order */
        if (k < 0 || random >> 12 & 1) {
            continue;
        }
        int kept_newer = 0; /* of the samples taken, how many are newer: the ring holds the newest MH_SENSOR_HISTORY */
        for (int j = k + 1; j < N; j++) {
            kept_newer += taken[j];
        }
        const enum mh_status status = take(begin + (mh_tick)k * T, value[k]);
        if (taken[k] && kept_newer < MH_SENSOR_HISTORY) {
            TEST_ASSERT_EQUAL(MH_ERR_REPEATED, status);
        } else if (kept_newer >= MH_SENSOR_HISTORY) {
            TEST_ASSERT_EQUAL(MH_ERR_TIME, status);
        } else {
            TEST_ASSERT_EQUAL(MH_OK, status);
            taken[k] = true;
            /* the predecessor is still kept if fewer than MH_SENSOR_HISTORY samples from k on were taken */
            const bool expected = k > 0 && taken[k - 1] && kept_newer + 1 < MH_SENSOR_HISTORY;
            TEST_ASSERT_EQUAL(expected, sample.has_increment);
            TEST_ASSERT_EQUAL_INT32(expected ? value[k] - value[k - 1] : 0, sample.increment);
            increments += expected;
        }
    }
    TEST_ASSERT_GREATER_THAN(20, increments); /* the test has tested something */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bad_configurations_are_refused);
    RUN_TEST(counts_become_a_quantity);
    RUN_TEST(conversion_and_difference_saturate);
    RUN_TEST(no_increment_from_a_reading_that_never_came);
    RUN_TEST(repeated_and_too_old_readings_are_refused);
    RUN_TEST(jitter_of_a_quarter_interval_is_tolerated);
    RUN_TEST(ticks_may_wrap);
    RUN_TEST(targets_are_differenced_apart);
    RUN_TEST(reports_follow_algorithm_1);
    RUN_TEST(reported_samples_are_remembered);
    RUN_TEST(brute_force);
    port_exit(UNITY_END() > 0);
    return 0;
}
