#include "motehound/range.h"
#include "port.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

enum { ANCHORS = 4, INTERVAL = 100 };

static const struct mh_place anchors[ANCHORS] = {{-500000000, 700000000, 2500},
                                                 {-499980000, 700000000, 500},
                                                 {-499980000, 700020000, 2500},
                                                 {-500000000, 700020000, 500}};

static struct mh_range state;
static struct mh_measurement set[ANCHORS];
static struct mh_estimate estimate;

static void begin(mh_real sd)
{
    struct mh_range_config config;
    mh_range_config_default(&config);
    config.range_sd_m = sd;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.init(&state, &config, INTERVAL));
}

/* exact ranges at `time` to (x, y) m from the first anchor, 1 m above ground */
static void range_all(mh_tick time, mh_real x, mh_real y)
{
    memset(set, 0, sizeof set);
    for (int i = 0; i < ANCHORS; i++) {
        const struct mh_vec2 a = mh_place_relative(&anchors[i], &anchors[0]);
        const mh_real dz = 1.0f - (mh_real)anchors[i].z_mm * 0.001f;
        set[i].node = (mh_node_id)i;
        set[i].place = anchors[i];
        set[i].time = time;
        set[i].value = mh_q20_from_real(mh_sqrt((x - a.x) * (x - a.x) + (y - a.y) * (y - a.y) + dz * dz));
    }
}

static enum mh_status step(mh_tick time, size_t count)
{
    return mh_tracker_range.step(&state, time, set, count, &estimate);
}

static void assert_at(mh_real tolerance, mh_real x, mh_real y)
{
    const struct mh_vec2 origin = mh_place_relative(&estimate.origin, &anchors[0]);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, x, origin.x + estimate.position.x);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, y, origin.y + estimate.position.y);
}

/* from (2, 3) at (1.5, -0.5) m/s, the clock wrapping on the way; the anchors are read one after the other, 20 ms apart */
static void follows_a_straight_line(void)
{
    const mh_tick t0 = UINT32_MAX - 1500;
    begin(0.1f);
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(t0, 0));
    for (int i = 1; i <= 40; i++) {
        for (int a = 0; a < ANCHORS; a++) {
            const struct mh_measurement earlier[2] = {set[0], set[1]};
            const struct mh_measurement last = set[2];
            const mh_real s = 0.1f * (mh_real)i - 0.02f * (mh_real)(ANCHORS - 1 - a);
            range_all(t0 + (mh_tick)(i * INTERVAL - 20 * (ANCHORS - 1 - a)), 2 + 1.5f * s, 3 - 0.5f * s);
            if (a > 0) {
                set[0] = earlier[0];
            }
            if (a > 1) {
                set[1] = earlier[1];
            }
            if (a > 2) {
                set[2] = last;
            }
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, step(t0 + (mh_tick)(i * INTERVAL), ANCHORS));
        TEST_ASSERT_EQUAL_UINT8(i == 1 ? MH_ESTIMATE_STARTED : 0, estimate.flags & ~MH_ESTIMATE_REFRESHED);
        TEST_ASSERT_EQUAL_UINT16(ANCHORS, estimate.measurements);
    }
    assert_at(0.01f, 8, 1);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 1.5f, estimate.velocity.x);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, -0.5f, estimate.velocity.y);
    TEST_ASSERT_TRUE(estimate.covariance.xx > 0 && estimate.covariance.xx < 0.01f);
    TEST_ASSERT_EQUAL_INT32(anchors[0].x_mm, estimate.origin.x_mm);
    TEST_ASSERT_EQUAL_INT32(anchors[0].y_mm, estimate.origin.y_mm);
    TEST_ASSERT_EQUAL_INT32(1000, estimate.origin.z_mm);
    const mh_tick now = t0 + 4000;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.predict(&state, now + 2000, &estimate));
    assert_at(0.15f, 11, 0);
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_COASTED, estimate.flags);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_tracker_range.predict(&state, now - 1, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, step(now, ANCHORS));
}

/* runs from `time` to `end` with the target at rest; gives the last time */
static mh_tick rest(mh_tick time, mh_tick end, mh_real x, mh_real y)
{
    for (; mh_tick_before(time, end); time += INTERVAL) {
        range_all(time + INTERVAL, x, y);
        TEST_ASSERT_EQUAL_INT(MH_OK, step(time + INTERVAL, ANCHORS));
    }
    return time;
}

static void starts_with_three_that_agree(void)
{
    begin(0.1f);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_range.predict(&state, 0, &estimate));
    range_all(100, 5, 6);
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(100, 2));
    range_all(200, 5, 6);
    set[0].value = 0;
    set[1].value = -MH_Q20_ONE;
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(200, ANCHORS));
    range_all(300, 5, 6);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(300, 3));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_STARTED | MH_ESTIMATE_REFRESHED, estimate.flags);
    TEST_ASSERT_EQUAL_UINT16(3, estimate.measurements);
    assert_at(0.01f, 5, 6);
}

static void coasts_then_starts_again(void)
{
    begin(0.1f);
    mh_tick now = rest(0, 2000, 5, 6);
    mh_real before = estimate.covariance.xx;
    for (; now < 12000;) {
        now += 1000;
        TEST_ASSERT_EQUAL_INT(MH_OK, step(now, 0));
        TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_COASTED, estimate.flags);
        TEST_ASSERT_TRUE(estimate.covariance.xx > before);
        before = estimate.covariance.xx;
    }
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(now + 100, 0)); /* 10.1 s without a range */
    range_all(now + 200, 15, 8);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(now + 200, ANCHORS));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_STARTED | MH_ESTIMATE_REFRESHED, estimate.flags);
    assert_at(0.01f, 15, 8);
}

static void outliers_are_refused(void)
{
    begin(0.1f);
    mh_tick now = rest(0, 3000, 5, 6);
    for (int i = 0; i < 50; i++) { /* one anchor sees a reflection all the time */
        now += INTERVAL;
        range_all(now, 5, 6);
        set[2].value += MH_Q20(3.0f);
        TEST_ASSERT_EQUAL_INT(MH_OK, step(now, ANCHORS));
        TEST_ASSERT_EQUAL_UINT16(ANCHORS - 1, estimate.measurements);
        assert_at(0.02f, 5, 6);
    }
}

/* the target is carried 12 m away between two readings, on which all four agree */
static void gate_does_not_lock_out(void)
{
    begin(0.1f);
    mh_tick now = rest(0, 3000, 3, 3);
    range_all(now + INTERVAL, 12, 11);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(now + INTERVAL, ANCHORS));
    TEST_ASSERT_EQUAL_UINT16(ANCHORS, estimate.measurements);
    rest(now + INTERVAL, now + 1000, 12, 11);
    assert_at(0.05f, 12, 11);
}

/* the same where one anchor is heard at a time, so that no instant has the three ranges of a new start */
static void one_range_at_a_time_does_not_lock_out(void)
{
    begin(0.1f);
    mh_tick now = rest(0, 3000, 3, 3);
    for (int i = 0; i < 400; i++) {
        now += INTERVAL / 4;
        range_all(now, 5, 5);
        set[0] = set[i % ANCHORS];
        TEST_ASSERT_EQUAL_INT(MH_OK, step(now, 1));
    }
    assert_at(0.05f, 5, 5);
}

static void old_and_early_ranges_are_left_out(void)
{
    begin(0.1f);
    mh_tick now = rest(0, 1000, 5, 6);
    range_all(now + INTERVAL, 5, 6);
    set[0].time = now - 50;           /* older than the newest taken */
    set[3].time = now + INTERVAL + 1; /* after the instant */
    TEST_ASSERT_EQUAL_INT(MH_OK, step(now + INTERVAL, ANCHORS));
    TEST_ASSERT_EQUAL_UINT16(2, estimate.measurements);
}

static void bad_arguments(void)
{
    struct mh_range_config config;
    mh_range_config_default(&config);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.init(&state, &config, 0));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.init(&state, &config, 3600001u));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.init(&state, NULL, 100));
    config.range_sd_m = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.init(&state, &config, 100));
    mh_range_config_default(&config);
    config.acceleration_sd_mps2 = NAN;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.init(&state, &config, 100));
    mh_range_config_default(&config);
    config.height_m = INFINITY;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.init(&state, &config, 100));
    begin(0.1f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.step(&state, 100, NULL, 1, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.step(&state, 100, NULL, 0, NULL));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_range.step(&state, 100, NULL, 0, &estimate));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(follows_a_straight_line);
    RUN_TEST(starts_with_three_that_agree);
    RUN_TEST(coasts_then_starts_again);
    RUN_TEST(outliers_are_refused);
    RUN_TEST(gate_does_not_lock_out);
    RUN_TEST(one_range_at_a_time_does_not_lock_out);
    RUN_TEST(old_and_early_ranges_are_left_out);
    RUN_TEST(bad_arguments);
    port_exit(UNITY_END() > 0);
    return 0;
}
