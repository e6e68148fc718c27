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
        TEST_ASSERT_EQUAL_UINT8(i == 1 ? MH_ESTIMATE_STARTED : 0, estimate.flags & ~(unsigned)MH_ESTIMATE_REFRESHED);
        TEST_ASSERT_EQUAL_UINT16(ANCHORS, estimate.measurements);
    }
    assert_at(0.01f, 8, 1);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 1.5f, estimate.velocity.x);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, -0.5f, estimate.velocity.y);
    TEST_ASSERT_TRUE(estimate.covariance.xx > 0 && estimate.covariance.xx < 0.01f);
    TEST_ASSERT_TRUE(mh_place_within(&estimate.origin, &anchors[0], 30000)); /* an anchor */
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

/* two ranges of 50 days ago, whose ticks have come again since, and a third: no place */
static void ticks_that_wrap_make_no_range_new(void)
{
    const mh_tick days = 86400000;
    begin(0.1f);
    range_all(100, 5, 6);
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(100, 2));
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(20 * days, 0));
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(40 * days, 0));
    range_all(1100, 5, 6);
    set[0] = set[2];
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(1100, 1));
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
    mh_range_config_default(&config);
    mh_real *const others[] = {&config.bias_sd_m, &config.scale_sd, &config.sensing_range_m, &config.speed_mps,
                               &config.tolerance_m};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        static const mh_real wrong[] = {-1, NAN, INFINITY};
        for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
            mh_range_config_default(&config);
            *others[i] = wrong[k];
            TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.init(&state, &config, 100));
        }
    }
    begin(0.1f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.step(&state, 100, NULL, 1, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_range.step(&state, 100, NULL, 0, NULL));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_range.step(&state, 100, NULL, 0, &estimate));
}

/* A field of sensors that hear a target within 50 m and answer at once, every 2 s, with ranges of 5 m. */
enum { NODES = 6, SAMPLE = 2000 };

static const mh_real nodes[NODES][2] = {{-30, 10}, {-5, 35}, {20, 25}, {35, -10}, {5, -30}, {-25, -25}};
static struct mh_measurement answers[NODES];

static void begin_in_field(mh_real tolerance_m)
{
    struct mh_range_config config;
    mh_range_config_default(&config);
    config.range_sd_m = 5;
    config.sensing_range_m = 50;
    config.acceleration_sd_mps2 = 0.5f;
    config.speed_mps = 4.5f;
    config.height_m = 0;
    config.tolerance_m = tolerance_m;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.init(&state, &config, SAMPLE));
}

/* what the first `count` nodes measure of a target at (x, y) m, a node's error each time the same */
static enum mh_status sample(mh_tick number, mh_real x, mh_real y, size_t count)
{
    static const mh_real errors[NODES] = {2, -3, 4, -2, 1, -2};
    for (size_t i = 0; i < count; i++) {
        const struct mh_measurement taken = {
            .node = (mh_node_id)i,
            .place = {(int32_t)(1000 * nodes[i][0]), (int32_t)(1000 * nodes[i][1]), 0},
            .time = number * SAMPLE,
            .value = mh_q20_from_real(mh_sqrt(mh_squared(nodes[i][0] - x) + mh_squared(nodes[i][1] - y)) + errors[i])};
        answers[i] = taken;
    }
    return mh_tracker_range.step(&state, number * SAMPLE, answers, count, &estimate);
}

static mh_real estimated_x(void) { return (mh_real)estimate.origin.x_mm * 0.001f + estimate.position.x; }
static mh_real estimated_y(void) { return (mh_real)estimate.origin.y_mm * 0.001f + estimate.position.y; }

static void assert_near(mh_real tolerance, mh_real x, mh_real y)
{
    const struct mh_sym2 *P = &estimate.covariance;
    TEST_ASSERT_FLOAT_WITHIN(tolerance, x, estimated_x());
    TEST_ASSERT_FLOAT_WITHIN(tolerance, y, estimated_y());
    TEST_ASSERT_TRUE(mh_finite(P->xx) && P->xx > 0 && P->xx * P->yy > P->xy * P->xy);
}

/* one, then two that hear it: it is near them, and the covariance knows no better than the sensors' range; then none, then all */
static void starts_with_one_range(void)
{
    begin_in_field(0);
    TEST_ASSERT_EQUAL_INT(MH_NONE, sample(1, 0, 0, 0));
    TEST_ASSERT_EQUAL_INT(MH_OK, sample(2, 0, 0, 1));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_STARTED | MH_ESTIMATE_REFRESHED, estimate.flags);
    assert_near(50, 0, 0);
    TEST_ASSERT_FLOAT_WITHIN(1, 625, estimate.covariance.xx);
    TEST_ASSERT_EQUAL_INT(MH_OK, sample(3, 0, 0, 2));
    assert_near(50, 0, 0);
    TEST_ASSERT_EQUAL_INT(MH_OK, sample(4, 0, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_COASTED, estimate.flags);
    TEST_ASSERT_EQUAL_INT(MH_OK, sample(5, 0, 0, NODES));
    assert_near(8, 0, 0);
    TEST_ASSERT_TRUE(estimate.covariance.xx < 12 && estimate.covariance.yy < 12);
}

/* 4.5 m/s, then a turn of 90 degrees; the bound of a step is that of six ranges of 5 m without any past, 2.9 m in each coordinate */
static void follows_a_manoeuvre(void)
{
    begin_in_field(0);
    for (mh_tick i = 0; i < 8; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, sample(i, -27 + 9 * (mh_real)i, 0, NODES));
    }
    assert_near(5, 36, 0);
    for (mh_tick i = 8; i < 12; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, sample(i, 36, 9 * (mh_real)(i - 7), NODES));
        TEST_ASSERT_EQUAL_UINT16(NODES, estimate.measurements);
        assert_near(9, 36, 9 * (mh_real)(i - 7));
    }
}

/* two ranges at a time keep a track that six have started */
static void two_ranges_keep_the_track(void)
{
    begin_in_field(0);
    TEST_ASSERT_EQUAL_INT(MH_OK, sample(1, 0, 0, NODES));
    for (mh_tick i = 2; i < 30; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, sample(i, 0.5f * (mh_real)(i - 1), 0, 2));
        assert_near(12, 0.5f * (mh_real)(i - 1), 0);
    }
}

/* a target on top of a node, measured below zero: among others, and alone */
static void negative_ranges_are_measurements(void)
{
    begin_in_field(0);
    sample(1, 20, 25, NODES);
    sample(2, 20, 25, NODES);
    for (size_t i = 0; i < NODES; i++) {
        answers[i].time = 3 * SAMPLE;
    }
    answers[2].value = MH_Q20(-6.0f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.step(&state, 3 * SAMPLE, answers, NODES, &estimate));
    TEST_ASSERT_EQUAL_UINT16(NODES, estimate.measurements);
    assert_near(8, 20, 25);
    answers[2].time = 4 * SAMPLE;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.step(&state, 4 * SAMPLE, &answers[2], 1, &estimate));
    TEST_ASSERT_EQUAL_UINT16(1, estimate.measurements);
    assert_near(8, 20, 25);
}

/* 1e9 m is 2,048 m in Q11.20: one false range among six spoils nothing, six of them leave the track where it was */
static void a_range_of_1e9(void)
{
    begin_in_field(0);
    sample(1, 0, 0, NODES);
    sample(2, 0, 0, NODES);
    const mh_real x = estimated_x(), y = estimated_y();
    for (size_t i = 0; i < NODES; i++) {
        answers[i].time = 3 * SAMPLE;
    }
    answers[1].value = mh_q20_from_real(1e9f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.step(&state, 3 * SAMPLE, answers, NODES, &estimate));
    TEST_ASSERT_EQUAL_UINT16(NODES - 1, estimate.measurements);
    assert_near(5, x, y);
    for (size_t i = 0; i < NODES; i++) {
        answers[i].time = 4 * SAMPLE;
        answers[i].value = mh_q20_from_real(1e9f);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.step(&state, 4 * SAMPLE, answers, NODES, &estimate));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_COASTED, estimate.flags);
    assert_near(8, x, y);
    TEST_ASSERT_EQUAL_INT(MH_OK, sample(5, 0, 0, NODES));
    assert_near(8, 0, 0);
}

/* they cannot tell which side of the line it is on, 15 m off it, and the covariance says so; a node off the line tells */
static void nodes_on_a_line(void)
{
    begin_in_field(0);
    for (mh_tick number = 1; number < 6; number++) {
        for (size_t i = 0; i < NODES; i++) {
            const mh_real x = 15 * (mh_real)i - 40;
            const struct mh_measurement taken = {.node = (mh_node_id)i,
                                                 .place = {(int32_t)(1000 * x), 0, 0},
                                                 .time = number * SAMPLE,
                                                 .value = mh_q20_from_real(mh_sqrt((x - 2) * (x - 2) + 225))};
            answers[i] = taken;
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.step(&state, number * SAMPLE, answers, NODES, &estimate));
        assert_near(30, 2, 15);
        TEST_ASSERT_TRUE(mh_squared(estimated_x() - 2) < 9 * estimate.covariance.xx);
        TEST_ASSERT_TRUE(mh_squared(estimated_y() - 15) < 9 * estimate.covariance.yy);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, sample(6, 2, 15, NODES));
    assert_near(8, 2, 15);
}

/* the stored position leaves the estimate by no more than the tolerance, and moves on by itself in between */
static void stores_what_the_tolerance_demands(void)
{
    static const mh_real tolerances[] = {0, 5, 20};
    int reports[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        struct mh_estimate last = {.flags = 0};
        begin_in_field(tolerances[k]);
        for (mh_tick i = 0; i < 12; i++) {
            TEST_ASSERT_EQUAL_INT(MH_OK, sample(i, -27 + 4.5f * (mh_real)i, i % 3 == 0 ? 3 : -3, NODES));
            const mh_real x = estimate.stored.x - estimate.position.x, y = estimate.stored.y - estimate.position.y;
            TEST_ASSERT_TRUE(mh_sqrt(x * x + y * y) <= tolerances[k] * 1.00001f);
            if (estimate.flags & MH_ESTIMATE_REFRESHED) {
                reports[k]++;
                TEST_ASSERT_EQUAL_FLOAT(estimate.position.x, estimate.stored.x);
                TEST_ASSERT_EQUAL_FLOAT(estimate.velocity.y, estimate.stored_velocity.y);
            } else {
                TEST_ASSERT_FLOAT_WITHIN(1e-4f, last.stored.x + 2 * last.stored_velocity.x, estimate.stored.x);
                TEST_ASSERT_FLOAT_WITHIN(1e-4f, last.stored.y + 2 * last.stored_velocity.y, estimate.stored.y);
            }
            last = estimate;
        }
    }
    TEST_ASSERT_EQUAL_INT(12, reports[0]);
    TEST_ASSERT_TRUE(reports[1] < 12 && reports[2] < reports[1] && reports[2] > 0);
}

/* a second tracker goes on where the first one was, to what 8 bits of the covariance's factors and a millimetre leave */
static void is_handed_over(void)
{
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length = 0;
    begin_in_field(5);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_range.save(&state, bytes, &length));
    for (mh_tick i = 0; i < 5; i++) {
        sample(i, -27 + 9 * (mh_real)i, 2, NODES);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.save(&state, bytes, &length));
    TEST_ASSERT_EQUAL_UINT(MH_RANGE_SAVED, length);
    sample(5, 18, 2, NODES);
    const struct mh_estimate first = estimate;
    const mh_real x = estimated_x(), y = estimated_y();
    begin_in_field(5);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.load(&state, bytes, length));
    sample(5, 18, 2, NODES);
    TEST_ASSERT_EQUAL_UINT8(first.flags, estimate.flags);
    TEST_ASSERT_FLOAT_WITHIN(0.02f, x, estimated_x());
    TEST_ASSERT_FLOAT_WITHIN(0.02f, y, estimated_y());
    TEST_ASSERT_FLOAT_WITHIN(0.02f, first.velocity.x, estimate.velocity.x);
    TEST_ASSERT_FLOAT_WITHIN(0.01f * first.covariance.xx, first.covariance.xx, estimate.covariance.xx);
    TEST_ASSERT_FLOAT_WITHIN(0.002f, first.stored.x - first.position.x,
                             estimate.stored.x - estimate.position.x + 0.001f);
    TEST_ASSERT_EQUAL_FLOAT(first.stored_velocity.x, estimate.stored_velocity.x);
}

/* (1, -2) m at (3, -4) m/s, as a big-endian machine and a small-endian one write it */
static void saved_bytes_are_the_same_everywhere(void)
{
    static const uint8_t expected[MH_RANGE_SAVED] = {
        0,    0,    0x07, 0xD0, 0x00, 0x00, 0x03, 0xE8, 0xFF, 0xFF, 0xF8, 0x30, 0x40, 0x40, 0,
        0,    0xC0, 0x80, 0,    0,    0x40, 0x80, 0x3F, 0x00, 0x40, 0x80, 0,    0,    0,    0,
        0x3F, 0x80, 0,    0,    0,    0,    0,    0,    0x3F, 0x80, 0,    0,    0x07, 0xD0, 0x00,
        0x00, 0x03, 0xE8, 0xFF, 0xFF, 0xF8, 0x30, 0x40, 0x40, 0,    0,    0xC0, 0x80, 0,    0};
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length;
    begin_in_field(5);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.load(&state, expected, MH_RANGE_SAVED));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.predict(&state, 3000, &estimate));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 4, estimated_x());
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, -6, estimated_y());
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.save(&state, bytes, &length));
    TEST_ASSERT_EQUAL_UINT(MH_RANGE_SAVED, length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, bytes, MH_RANGE_SAVED);
}

static void corrupt_bytes_are_refused(void)
{
    uint8_t good[MH_TRACK_BYTES_MAX], bad[MH_TRACK_BYTES_MAX];
    size_t length;
    begin_in_field(5);
    sample(1, 0, 0, NODES);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.save(&state, good, &length));
    begin_in_field(5);
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_range.load(&state, good, length - 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_range.load(&state, good, length + 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_range.load(&state, good, 0));
    /* places beyond a coordinate's range, velocities and factors that are no numbers, a variance below 0 */
    static const uint8_t at[] = {4, 8, 12, 16, 20, 22, 28, 38, 44, 48, 52, 56};
    for (size_t i = 0; i < sizeof at; i++) {
        memcpy(bad, good, sizeof bad);
        bad[at[i]] = 0x7F;
        bad[at[i] + 1] = 0xC0;
        TEST_ASSERT_EQUAL_INT_MESSAGE(MH_ERR_CORRUPT, mh_tracker_range.load(&state, bad, length), "not a number");
    }
    memcpy(bad, good, sizeof bad);
    bad[20] |= 0x80;
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_range.load(&state, bad, length));
    memcpy(bad, good, sizeof bad);
    bad[22] = 0x71; /* finite factors of an infinite covariance */
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_range.load(&state, bad, length));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_range.predict(&state, 5000, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.load(&state, good, length));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.predict(&state, 5000, &estimate));
}

/* Factors of a covariance that is none in mh_real, for the variance of y is lost in what it gets from x: what comes out is one. */
static void a_loaded_covariance_is_one(void)
{
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length;
    begin_in_field(5);
    sample(1, 0, 0, NODES);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.save(&state, bytes, &length));
    bytes[22] = 0x4B; /* 1e7 */
    bytes[23] = 0x18;
    begin_in_field(5);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.load(&state, bytes, length));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.predict(&state, SAMPLE, &estimate));
    const struct mh_sym2 *c = &estimate.covariance;
    TEST_ASSERT_TRUE(c->xy * (c->xy / c->xx) < c->yy);
    /* U so large that its square is infinite, D so small that P is not */
    bytes[22] = 0x70; /* 1.6e29 */
    bytes[23] = 0x00;
    bytes[24] = 0x13; /* 1.6e-27 */
    bytes[25] = 0x00;
    begin_in_field(5);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.load(&state, bytes, length));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.predict(&state, SAMPLE, &estimate));
    TEST_ASSERT_TRUE(mh_finite(estimate.covariance.xx));
}

/* told that it is elsewhere, it starts anew among those who hear it, at once */
static void restarts_elsewhere(void)
{
    begin_in_field(5);
    for (mh_tick i = 0; i < 5; i++) {
        sample(i, 0, 0, NODES);
    }
    mh_tracker_range.restart(&state);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_range.predict(&state, 5 * SAMPLE, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_NONE, sample(5, 0, 0, 0));
    TEST_ASSERT_EQUAL_INT(MH_OK, sample(6, 25, -20, NODES));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_STARTED | MH_ESTIMATE_REFRESHED, estimate.flags);
    assert_near(8, 25, -20);
    TEST_ASSERT_EQUAL_FLOAT(0, estimate.velocity.x);
}

#if MH_RANGE_BIASES_MAX >= 5
/* anchors read one after the other whose ranges are 5 % long, and each off by up to 2 m: (true distance) x 1.05 + bias */
static void learns_scale_and_biases(void)
{
    static const struct mh_place far[ANCHORS] = {{0, 0, 0}, {60000, 5000, 0}, {50000, 55000, 0}, {-5000, 50000, 0}};
    static const mh_real bias[ANCHORS] = {2, -1, 1, -2};
    struct mh_range_config config;
    mh_range_config_default(&config);
    config.range_sd_m = 0.3f;
    config.bias_sd_m = 2;
    config.scale_sd = 0.1f;
    config.acceleration_sd_mps2 = 0.3f;
    config.height_m = 0;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.init(&state, &config, 250));
    mh_real early = 0, late = 0, sd = 0;
    for (int i = 1; i <= 2000; i++) { /* along a circle at 1 m/s */
        const mh_real angle = 0.25f * (mh_real)i / 18;
        const mh_real x = 28 + 18 * cosf(angle), y = 27 + 18 * sinf(angle);
        const int a = i % ANCHORS;
        const mh_real distance =
            mh_sqrt(mh_squared(x - (mh_real)far[a].x_mm * 0.001f) + mh_squared(y - (mh_real)far[a].y_mm * 0.001f));
        const struct mh_measurement taken = {.node = (mh_node_id)(10 + a),
                                             .place = far[a],
                                             .time = (mh_tick)i * 250,
                                             .value = mh_q20_from_real(1.05f * distance + bias[a])};
        if (mh_tracker_range.step(&state, (mh_tick)i * 250, &taken, 1, &estimate) != MH_OK) {
            TEST_ASSERT_TRUE(i < 3);
            continue;
        }
        const mh_real square = mh_squared(estimated_x() - x) + mh_squared(estimated_y() - y);
        early = i < 40 ? mh_max(early, square) : early;
        late = i > 1000 ? mh_max(late, square) : late;
        sd = i == 40 ? estimate.covariance.xx : sd;
    }
    TEST_ASSERT_TRUE(late < 1 && late < early);
    TEST_ASSERT_TRUE(estimate.covariance.xx < 0.5f * sd);
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(follows_a_straight_line);
    RUN_TEST(starts_with_three_that_agree);
    RUN_TEST(coasts_then_starts_again);
    RUN_TEST(ticks_that_wrap_make_no_range_new);
    RUN_TEST(outliers_are_refused);
    RUN_TEST(gate_does_not_lock_out);
    RUN_TEST(one_range_at_a_time_does_not_lock_out);
    RUN_TEST(old_and_early_ranges_are_left_out);
    RUN_TEST(bad_arguments);
    RUN_TEST(starts_with_one_range);
    RUN_TEST(follows_a_manoeuvre);
    RUN_TEST(two_ranges_keep_the_track);
    RUN_TEST(negative_ranges_are_measurements);
    RUN_TEST(a_range_of_1e9);
    RUN_TEST(nodes_on_a_line);
    RUN_TEST(stores_what_the_tolerance_demands);
    RUN_TEST(is_handed_over);
    RUN_TEST(saved_bytes_are_the_same_everywhere);
    RUN_TEST(corrupt_bytes_are_refused);
    RUN_TEST(a_loaded_covariance_is_one);
    RUN_TEST(restarts_elsewhere);
#if MH_RANGE_BIASES_MAX >= 5
    RUN_TEST(learns_scale_and_biases);
#endif
    port_exit(UNITY_END() > 0);
    return 0;
}
