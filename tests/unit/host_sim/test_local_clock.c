#include "unity.h"
#include "world/local_clock.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

static const double period_us = LOCAL_CLOCK_WANDER_PERIOD_S * 1e6;

static void test_zero_is_ideal(void)
{
    const struct local_clock clock = {0};
    TEST_ASSERT_TRUE(local_clock_is_ideal(&clock));
    TEST_ASSERT_EQUAL_INT64(123456789, local_clock_us(&clock, 123456789));
    TEST_ASSERT_EQUAL_UINT32(123456, local_clock_tick(&clock, 123456789));
    TEST_ASSERT_EQUAL_INT64(5000000, local_clock_time_of(&clock, 123456789, 5000));
    TEST_ASSERT_EQUAL_INT64(500000000, local_clock_time_of(&clock, 123456789, 500000));
}

static void test_drift_is_what_the_data_sheet_says(void)
{
    const struct local_clock clock = {.offset_us = -2500000, .drift_ppm = 40};
    TEST_ASSERT_FALSE(local_clock_is_ideal(&clock));
    /* 40 ppm of one hour: 144 ms */
    TEST_ASSERT_INT64_WITHIN(1, INT64_C(3600000000) - 2500000 + 144000, local_clock_us(&clock, INT64_C(3600000000)));
    /* before its zero the clock shows what a wrapped counter shows */
    TEST_ASSERT_EQUAL_UINT32((mh_tick)-2500, local_clock_tick(&clock, 0));
    TEST_ASSERT_EQUAL_UINT32((mh_tick)-2501, local_clock_tick(&(struct local_clock){.offset_us = -2500001}, 0));
}

/* The mean rate over an arc of half a period is 2/3 of the amplitude, to one side and then to the other. */
static void test_wander_is_bounded_and_periodic(void)
{
    const struct local_clock clock = {.wander_ppm = 10};
    const int64_t half = (int64_t)(period_us / 2);
    const double arc = 10e-6 * 2 / 3 * (double)half;
    TEST_ASSERT_INT64_WITHIN(1, half + (int64_t)arc, local_clock_us(&clock, half));
    for (int64_t whole = 1; whole < 4; whole++) {
        TEST_ASSERT_INT64_WITHIN(1, 2 * half * whole, local_clock_us(&clock, 2 * half * whole));
    }
    /* the rate: s differs from the sine by at most 0.056 */
    for (double time = 0; time < period_us; time += period_us / 100) {
        const int64_t from = (int64_t)time, step = 10000000;
        const double ppm = (double)(local_clock_us(&clock, from + step) - local_clock_us(&clock, from) - step) / 10;
        const double sine = 10 * sin(2 * 3.14159265358979 * ((double)from + (double)step / 2) / period_us);
        TEST_ASSERT_TRUE(fabs(ppm - sine) < 0.56 + 0.1);
    }
}

static void test_back_and_forth(void)
{
    for (uint32_t mote = 0; mote < 40; mote++) {
        const struct local_clock clock = local_clock_draw(7, mote, 100, mote < 20 ? 40 : 900, mote % 2 ? 20 : 0);
        for (uint64_t now = 0; now < UINT64_C(400000000000); now = now * 3 + 777777) {
            const mh_tick shown = local_clock_tick(&clock, now);
            for (int32_t ahead = -5000; ahead <= 70000000; ahead += 17512345) {
                const mh_tick tick = shown + (mh_tick)ahead;
                const int64_t time = local_clock_time_of(&clock, now, tick);
                if (time > 0) {
                    TEST_ASSERT_EQUAL_UINT32(tick, local_clock_tick(&clock, (sim_time)time));
                    TEST_ASSERT_EQUAL_UINT32(tick - 1, local_clock_tick(&clock, (sim_time)time - 1));
                }
            }
        }
    }
}

static void test_never_runs_backwards(void)
{
    const struct local_clock clock = {.offset_us = 3, .drift_ppm = -999, .wander_ppm = 1000, .wander_phase = 0.6};
    for (int64_t begin = 0; begin < INT64_C(10000000000); begin = begin * 2 + 1) {
        for (int64_t time = begin; time < begin + 3000; time++) {
            TEST_ASSERT_LESS_OR_EQUAL_INT64(local_clock_us(&clock, time + 1), local_clock_us(&clock, time));
        }
    }
}

static void test_restart(void)
{
    struct local_clock clock = {.offset_us = 77, .drift_ppm = -30}, ideal = {0};
    local_clock_restart(&clock, 5000000);
    TEST_ASSERT_EQUAL_INT64(0, local_clock_us(&clock, 5000000));
    TEST_ASSERT_INT64_WITHIN(1, 10000000 - 300, local_clock_us(&clock, 15000000));
    local_clock_restart(&ideal, 5000000);
    TEST_ASSERT_TRUE(local_clock_is_ideal(&ideal));
}

static void test_draws_are_uniform_and_of_the_seed(void)
{
    enum { MOTES = 4000 };
    double sum = 0, squares = 0;
    for (uint32_t mote = 0; mote < MOTES; mote++) {
        const struct local_clock clock = local_clock_draw(3, mote, 2, 40, 0);
        TEST_ASSERT_TRUE(fabs(clock.drift_ppm) <= 40 && clock.offset_us >= -2000000 && clock.offset_us <= 2000000);
        sum += clock.drift_ppm;
        squares += clock.drift_ppm * clock.drift_ppm;
    }
    /* uniform: mean 0, variance 40^2 / 3; the mean's standard deviation is 0.37, the variance's 1.4 % */
    TEST_ASSERT_TRUE(fabs(sum / MOTES) < 1.5);
    TEST_ASSERT_TRUE(fabs(squares / MOTES - 1600.0 / 3) < 0.06 * 1600 / 3);
    const struct local_clock a = local_clock_draw(3, 5, 2, 40, 1), b = local_clock_draw(4, 5, 2, 40, 1);
    TEST_ASSERT_TRUE(a.offset_us != b.offset_us);
    const struct local_clock ideal = local_clock_draw(3, 5, 0, 0, 0);
    TEST_ASSERT_TRUE(local_clock_is_ideal(&ideal));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_zero_is_ideal);
    RUN_TEST(test_drift_is_what_the_data_sheet_says);
    RUN_TEST(test_wander_is_bounded_and_periodic);
    RUN_TEST(test_back_and_forth);
    RUN_TEST(test_never_runs_backwards);
    RUN_TEST(test_restart);
    RUN_TEST(test_draws_are_uniform_and_of_the_seed);
    return UNITY_END();
}
