#include "motehound/head.h"
#include "port.h"
#include "unity.h"

#include <string.h>

#define T 1000u
#define WINDOW 400u

/* A tracker that writes down what it is given. */
static struct {
    enum mh_status init_status, step_status, predict_status;
    mh_tick interval, time;
    mh_tick lateness; /* of the head: set by the test */
    size_t count;
    mh_node_id first, last;
    bool ordered;
} seen;

static enum mh_status tracker_init(void *state, const void *config, mh_tick interval)
{
    (void)state;
    (void)config;
    seen.interval = interval;
    return seen.init_status;
}

static enum mh_status tracker_step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                                   struct mh_estimate *estimate)
{
    (void)state;
    seen.time = time;
    seen.count = count;
    seen.ordered = true;
    for (size_t i = 0; i < count; i++) {
        seen.first = measurements[0].node;
        seen.last = measurements[i].node;
        seen.ordered &= !mh_tick_before(time, measurements[i].time) &&
                        !mh_tick_before(measurements[i].time, time - seen.lateness - T + 1);
        seen.ordered &= i == 0 || mh_tick_before(measurements[i - 1].time, measurements[i].time) ||
                        (measurements[i - 1].time == measurements[i].time &&
                         (measurements[i - 1].node < measurements[i].node ||
                          (measurements[i - 1].node == measurements[i].node &&
                           measurements[i - 1].target < measurements[i].target)));
    }
    if (seen.step_status == MH_OK) {
        memset(estimate, 0, sizeof *estimate);
        estimate->time = time;
    }
    return seen.step_status;
}

static enum mh_status tracker_predict(const void *state, mh_tick time, struct mh_estimate *expected)
{
    (void)state;
    (void)time;
    (void)expected;
    return seen.predict_status;
}

static const struct mh_tracker tracker = {
    .name = "notes", .init = tracker_init, .step = tracker_step, .predict = tracker_predict};

static struct mh_head head;
static struct mh_head_config config;
static struct mh_estimate estimate;

void setUp(void)
{
    const struct mh_head_config plain = {&tracker, "", &seen, 0, T, WINDOW, 0, false, 0};
    config = plain;
    memset(&seen, 0, sizeof seen);
    TEST_ASSERT_EQUAL(MH_OK, mh_head_init(&head, &config, 5 * T));
}

void tearDown(void) {}

static enum mh_status measure(mh_node_id node, mh_tick time, mh_q20 increment, uint8_t target)
{
    const struct mh_measurement measurement = {.node = node, .time = time, .increment = increment, .target = target};
    return mh_head_measurement(&head, &measurement);
}

static mh_tick first_instant(mh_tick epoch, mh_tick now)
{
    config.epoch = epoch;
    TEST_ASSERT_EQUAL(MH_OK, mh_head_init(&head, &config, now));
    return head.instant;
}

static void gathering_begins_at_the_next_instant(void)
{
    TEST_ASSERT_EQUAL_UINT32(T, seen.interval);
    TEST_ASSERT_EQUAL_UINT32(7, first_instant(7, 7));
    TEST_ASSERT_EQUAL_UINT32(7 + T, first_instant(7, 8));
    TEST_ASSERT_EQUAL_UINT32(7 + T, first_instant(7, 7 + T));
    TEST_ASSERT_EQUAL_UINT32(7 + 2 * T, first_instant(7, 8 + T));
    TEST_ASSERT_EQUAL_UINT32(7, first_instant(7 + 3 * T, 7)); /* the epoch is still to come */
    TEST_ASSERT_EQUAL_UINT32(7 + T, first_instant(7 + 3 * T, 8));
    TEST_ASSERT_EQUAL_UINT32(T - 500, first_instant((mh_tick)0 - 500, 1)); /* across the wrap */
    TEST_ASSERT_EQUAL_UINT32((mh_tick)0 - 300, first_instant(T - 300, (mh_tick)0 - 400));
    TEST_ASSERT_EQUAL_UINT32(head.instant + WINDOW, mh_head_deadline(&head));
}

static void bad_configurations_are_refused(void)
{
    const struct mh_head_config good = config;
    config.interval = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_head_init(&head, &config, 0));
    config.interval = 3600001u;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_head_init(&head, &config, 0));
    config = good;
    config.window = T;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_head_init(&head, &config, 0));
    config = good;
    config.tracker_state = NULL;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_head_init(&head, &config, 0));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_head_init(&head, NULL, 0));
    config = good;
    seen.init_status = MH_ERR_RANGE;
    TEST_ASSERT_EQUAL(MH_ERR_RANGE, mh_head_init(&head, &config, 0));
}

static void the_tracker_gets_one_instant_in_order(void)
{
    TEST_ASSERT_EQUAL(MH_OK, measure(9, 5 * T, 1, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(3, 5 * T, 2, 1));
    TEST_ASSERT_EQUAL(MH_OK, measure(3, 5 * T, 2, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(8, 5 * T - 1, 3, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(4, 6 * T, 4, 0)); /* already of the next */
    TEST_ASSERT_EQUAL(MH_OK, mh_head_close(&head, &estimate));
    TEST_ASSERT_EQUAL_UINT32(5 * T, seen.time);
    TEST_ASSERT_EQUAL(4, seen.count);
    TEST_ASSERT_EQUAL_UINT32(8, seen.first);
    TEST_ASSERT_EQUAL_UINT32(9, seen.last);
    TEST_ASSERT_TRUE(seen.ordered);
    TEST_ASSERT_EQUAL_UINT32(6 * T, head.instant);
    TEST_ASSERT_EQUAL(MH_OK, mh_head_close(&head, &estimate));
    TEST_ASSERT_EQUAL(1, seen.count);
    TEST_ASSERT_EQUAL_UINT32(4, seen.first);
    TEST_ASSERT_EQUAL_UINT32(2, head.counters.estimates);
    TEST_ASSERT_EQUAL_UINT32(5, head.counters.measurements);
}

static void late_early_and_repeated_are_counted(void)
{
    TEST_ASSERT_EQUAL(MH_OK, measure(1, 5 * T, 1, 0));
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, measure(1, 5 * T, 1, 0));
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, measure(1, 5 * T - 3, 1, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(1, 6 * T, 1, 0)); /* another instant */
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, measure(1, 6 * T, 1, 0));
    TEST_ASSERT_EQUAL(MH_ERR_TIME, measure(2, 4 * T, 1, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(2, 4 * T + 1, 1, 0));
    TEST_ASSERT_EQUAL(MH_ERR_TIME, measure(3, 6 * T + 1, 1, 0));
    TEST_ASSERT_EQUAL_UINT32(1, head.counters.late);
    TEST_ASSERT_EQUAL_UINT32(1, head.counters.early);
    TEST_ASSERT_EQUAL_UINT32(3, head.counters.repeated);
    TEST_ASSERT_EQUAL_UINT32(3, head.counters.measurements);
}

/* Whatever the order of arrival, the largest increments stay; of equal ones the smallest node numbers. */
static void the_smallest_increment_gives_way(void)
{
    const uint16_t offered = MH_REPORTS_MAX + 5;
    for (uint8_t pass = 0; pass < 2; pass++) {
        TEST_ASSERT_EQUAL(MH_OK, mh_head_init(&head, &config, 5 * T));
        for (uint16_t i = 0; i < offered; i++) {
            const uint16_t node = pass == 0 ? i : (uint16_t)(offered - 1 - i);
            const mh_q20 increment = node < 3 ? -5 : 7; /* 0, 1, 2 are the smallest */
            TEST_ASSERT_EQUAL(i < MH_REPORTS_MAX ? MH_OK : MH_ERR_CAPACITY, measure(node, 5 * T, increment, 0));
        }
        TEST_ASSERT_EQUAL_UINT32(5, head.counters.overflowed);
        TEST_ASSERT_EQUAL(MH_REPORTS_MAX, head.count);
        TEST_ASSERT_EQUAL_UINT32(3, head.measurements[0].node);
        TEST_ASSERT_EQUAL_UINT32(offered - 3, head.measurements[MH_REPORTS_MAX - 1].node);
    }
}

static void without_a_position_the_next_instant_is_gathered_all_the_same(void)
{
    TEST_ASSERT_EQUAL(MH_OK, mh_head_close(&head, &estimate));
    TEST_ASSERT_TRUE(head.tracking);
    seen.step_status = MH_NONE;
    estimate.time = 77;
    TEST_ASSERT_EQUAL(MH_NONE, mh_head_close(&head, &estimate));
    TEST_ASSERT_EQUAL_UINT32(77, estimate.time);
    TEST_ASSERT_TRUE(head.tracking); /* an instant without a position is not the end of a track */
    TEST_ASSERT_EQUAL_UINT32(7 * T, head.instant);
    seen.predict_status = MH_NONE;
    TEST_ASSERT_EQUAL(MH_NONE, mh_head_close(&head, &estimate));
    TEST_ASSERT_FALSE(head.tracking);
    TEST_ASSERT_EQUAL_UINT32(1, head.counters.estimates);
}

/* Each node samples by its own idea of the time. */
static void what_is_nearly_of_an_instant_is_of_it(void)
{
    config.tolerance = 3;
    TEST_ASSERT_EQUAL(MH_OK, mh_head_init(&head, &config, 5 * T));
    TEST_ASSERT_EQUAL(MH_OK, measure(1, 5 * T + 3, 10, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(2, 5 * T - 3, 10, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(3, 5 * T - 4, 10, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(4, 5 * T + 4, 10, 0));       /* of the next instant */
    TEST_ASSERT_EQUAL(MH_OK, measure(5, 6 * T + 3, 10, 0));       /* of the next instant, too */
    TEST_ASSERT_EQUAL(MH_ERR_TIME, measure(6, 4 * T + 3, 10, 0)); /* of the one before */
    TEST_ASSERT_EQUAL(MH_ERR_TIME, measure(7, 6 * T + 4, 10, 0)); /* of the one after the next */
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, measure(1, 5 * T - 1, 10, 0));
    TEST_ASSERT_EQUAL_UINT32(1, head.counters.late);
    TEST_ASSERT_EQUAL_UINT32(1, head.counters.early);
    mh_head_close(&head, &estimate);
    TEST_ASSERT_EQUAL(3, seen.count);
    mh_head_close(&head, &estimate);
    TEST_ASSERT_EQUAL(2, seen.count);
    config.tolerance = T / 2;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_head_init(&head, &config, 5 * T));
}

/* A tracker that can use them gets them before those of the instant. */
static void late_measurements_are_passed_on_as_far_as_they_are_wanted(void)
{
    config.lateness = seen.lateness = 2 * T;
    config.tolerance = 3;
    TEST_ASSERT_EQUAL(MH_OK, mh_head_init(&head, &config, 5 * T));
    TEST_ASSERT_EQUAL(MH_OK, measure(1, 5 * T, 10, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(1, 3 * T - 1, 10, 0)); /* of 3 T */
    TEST_ASSERT_EQUAL(MH_OK, measure(2, 3 * T + 3, 10, 0)); /* of 3 T, too, being near it */
    TEST_ASSERT_EQUAL(MH_OK, measure(1, 4 * T, 10, 0));
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, measure(1, 3 * T, 10, 0));
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, measure(1, 5 * T, 10, 0));
    TEST_ASSERT_EQUAL(MH_ERR_TIME, measure(4, 2 * T, 10, 0));
    TEST_ASSERT_EQUAL_UINT32(3 * T, head.measurements[0].time);
    TEST_ASSERT_EQUAL_UINT32(3 * T, head.measurements[1].time);
    TEST_ASSERT_EQUAL_UINT32(1, head.counters.late);
    mh_head_close(&head, &estimate);
    TEST_ASSERT_EQUAL(4, seen.count);
    TEST_ASSERT_TRUE(seen.ordered);
    TEST_ASSERT_EQUAL(MH_OK, measure(4, 4 * T, 10, 0));
    TEST_ASSERT_EQUAL(MH_ERR_TIME, measure(4, 3 * T, 10, 0)); /* now too late */
    config.lateness = 3600001u;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_head_init(&head, &config, 5 * T));
}

static void instants_go_on_across_the_wrap(void)
{
    TEST_ASSERT_EQUAL_UINT32((mh_tick)0 - 300, first_instant(T - 300, (mh_tick)0 - 400));
    TEST_ASSERT_EQUAL(MH_OK, measure(2, 700, 1, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(1, (mh_tick)0 - 300, 1, 0));
    TEST_ASSERT_EQUAL(MH_OK, measure(3, 5, 1, 0));
    TEST_ASSERT_EQUAL(MH_OK, mh_head_close(&head, &estimate));
    TEST_ASSERT_EQUAL(1, seen.count);
    TEST_ASSERT_EQUAL(MH_OK, mh_head_close(&head, &estimate));
    TEST_ASSERT_EQUAL_UINT32(700, seen.time);
    TEST_ASSERT_EQUAL(2, seen.count);
    TEST_ASSERT_EQUAL_UINT32(3, seen.first);
    TEST_ASSERT_TRUE(seen.ordered);
}

static void measurements_at_an_end_are_counted(void)
{
    const mh_q20 values[] = {INT32_MAX, INT32_MAX - 1, INT32_MIN, INT32_MIN + 1, 0};
    struct mh_measurement measurement = {.time = 5 * T, .increment = 1};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        measurement.node++;
        measurement.value = values[i];
        TEST_ASSERT_EQUAL(MH_OK, mh_head_measurement(&head, &measurement));
    }
    measurement.node++;
    measurement.increment = INT32_MIN;
    TEST_ASSERT_EQUAL(MH_OK, mh_head_measurement(&head, &measurement));
    TEST_ASSERT_EQUAL_UINT32(3, head.counters.at_end);
}

/* What a tracker cannot compute in its numbers is counted, and the head goes on; what it merely cannot tell is not. */
static void numbers_too_large_are_counted(void)
{
    const enum mh_status answers[] = {MH_ERR_RANGE, MH_NONE, MH_ERR_NOT_FINITE, MH_OK, MH_ERR_SINGULAR};
    for (size_t i = 0; i < sizeof answers / sizeof answers[0]; i++) {
        seen.step_status = answers[i];
        TEST_ASSERT_EQUAL(answers[i], mh_head_close(&head, &estimate));
    }
    TEST_ASSERT_EQUAL_UINT32(2, head.counters.saturated);
    TEST_ASSERT_EQUAL_UINT32(1, head.counters.estimates);
    TEST_ASSERT_EQUAL_UINT32(10 * T, head.instant);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(gathering_begins_at_the_next_instant);
    RUN_TEST(bad_configurations_are_refused);
    RUN_TEST(the_tracker_gets_one_instant_in_order);
    RUN_TEST(late_early_and_repeated_are_counted);
    RUN_TEST(the_smallest_increment_gives_way);
    RUN_TEST(without_a_position_the_next_instant_is_gathered_all_the_same);
    RUN_TEST(what_is_nearly_of_an_instant_is_of_it);
    RUN_TEST(late_measurements_are_passed_on_as_far_as_they_are_wanted);
    RUN_TEST(measurements_at_an_end_are_counted);
    RUN_TEST(numbers_too_large_are_counted);
    RUN_TEST(instants_go_on_across_the_wrap);
    port_exit(UNITY_END() > 0);
    return 0;
}
