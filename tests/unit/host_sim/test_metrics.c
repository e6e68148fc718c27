#include "bus/bus.h"
#include "port.h"
#include "record/metrics.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Unity is built without double. */
static bool near(double expected, double actual) { return fabs(expected - actual) <= 1e-9 * (1 + fabs(expected)); }
#define NEAR(expected, actual) TEST_ASSERT_TRUE(near(expected, actual))

static struct scenario scenario;
static struct recorder recorder;
static struct errors errors;
static double values[METRIC_COUNT];
static char error[300];

void setUp(void)
{
    memset(&recorder, 0, sizeof recorder);
    memset(&errors, 0, sizeof errors);
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
}
void tearDown(void)
{
    recorder_free(&recorder);
    errors_free(&errors);
    scenario_free(&scenario);
}

static void statistics_have_their_closed_forms(void)
{
    struct samples samples = {0};
    TEST_ASSERT_TRUE(isnan(samples_mean(&samples)) && isnan(samples_rms(&samples)) && isnan(samples_sd(&samples)) &&
                     isnan(samples_quantile(&samples, 0.5)));
    TEST_ASSERT_EQUAL_INT(0, samples_add(&samples, 3));
    TEST_ASSERT_TRUE(samples_sd(&samples) == 0 && samples_quantile(&samples, 0.95) == 3);
    samples.count = 0;
    /* 1..n shuffled by a step that has no factor in common with n */
    const int n = 1001;
    for (int i = 0; i < n; i++) {
        TEST_ASSERT_EQUAL_INT(0, samples_add(&samples, 1 + i * 389 % n));
    }
    NEAR((n + 1) / 2.0, samples_mean(&samples));
    NEAR(sqrt(n * (n + 1) / 12.0), samples_sd(&samples));
    NEAR(sqrt((n + 1) * (2.0 * n + 1) / 6), samples_rms(&samples));
    NEAR(501, samples_quantile(&samples, 0.5));
    NEAR(951, samples_quantile(&samples, 0.95));
    NEAR(1 + 0.123456 * 1000, samples_quantile(&samples, 0.123456));
    NEAR(1, samples_quantile(&samples, 0));
    NEAR(1001, samples_quantile(&samples, 1));
    samples_free(&samples);
}

/* The simulation's side: estimates at instant k with the truth at (k, 0), through the bus, as a run does. */
static void tell(const struct observer *observer, double time_s, bool present, float x, float y, float variance,
                 uint8_t target)
{
    const struct truth truth = {.time_s = time_s, .x_m = time_s, .present = present, .target = target};
    const struct truth arrival = {.time_s = time_s - 0.5, .x_m = time_s - 0.5, .present = present && time_s >= 0.5};
    const struct mh_estimate estimate = {.origin = {10000, -20000, 0},
                                         .position = {x - 10, y + 20},
                                         .raw = {x - 10, y + 20 + 4},
                                         .covariance = {variance, 0, 4 * variance},
                                         .states = variance > 0 ? 2 : 0,
                                         .age = 0.5f,
                                         .target = target};
    observer->truth(observer->context, &truth);
    observer->estimate(observer->context, time_s, 0, &estimate, &truth, &arrival);
}

static void run_of(int instants, void (*run)(const struct observer *observer, int instant))
{
    struct bus bus;
    struct simulation_counters counters = {
        .frames_sent = {1, 20, 300},
        .frames_received = 7,
        .motes = {.reports = 20, .reports_asked = 9},
        .head = {.measurements = 13, .late = 2},
        .energy = {.joules = {[ENERGY_LISTEN] = {[ENERGY_IDLE] = 3, [ENERGY_ROUTING] = 0.5},
                              [ENERGY_TRANSMIT] = {[ENERGY_ROUTING] = 0.25, [ENERGY_TIME] = 0.125}},
                   .lifetime_s = (double)NAN,
                   .lifetime_half_s = 77,
                   .dead = 4},
        .clock_error_p99_ms = 0.75};
    TEST_ASSERT_EQUAL_INT(0, bus_open(&bus, 0, NULL, NULL, 0, error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, recorder_subscribe(&recorder, bus.lcm));
    bus.run = 1; /* whose motes are told only where they count */
    bus.searches = scenario.sensor.quantity == QUANTITY_GAS;
    const struct observer observer = bus_observer(&bus);
    bus_begin(&bus, 5, "a scenario", "1.2.3");
    for (int i = 0; i < instants; i++) {
        run(&observer, i);
    }
    bus_end(&bus, &counters);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, bus_close(&bus, error, sizeof error), error);
    TEST_ASSERT_FALSE(recorder.failed);
    TEST_ASSERT_EQUAL_INT(0, errors_of(&recorder, &scenario, &errors));
    metrics_of_run(&recorder, &scenario, &errors, values);
}

/* Off by (0, 3) at every instant but the first three, which are far away; the source goes after instant 9. */
static void three_metres_off(const struct observer *observer, int i)
{
    tell(observer, i, i < 10, (float)i, i < 3 ? 100 : 3, 0.25f, 0);
}

static void errors_leave_out_the_first_and_the_time_without_a_source(void)
{
    run_of(12, three_metres_off);
    TEST_ASSERT_EQUAL_size_t(7, errors.position.count);
    NEAR(3, values[METRIC_POSITION_RMSE_M]);
    NEAR(3, values[METRIC_POSITION_MEDIAN_M]);
    NEAR(3, values[METRIC_POSITION_P95_M]);
    NEAR(7, values[METRIC_RAW_POSITION_RMSE_M]);
    NEAR(sqrt(9.25), values[METRIC_POSITION_RMSE_AT_ARRIVAL_M]);
    NEAR(9, values[METRIC_NEES_MEDIAN]); /* 3^2 / (4 * 0.25) */
    NEAR(1, values[METRIC_TRACKED_SHARE]);
    NEAR(0, values[METRIC_TRACK_LOST]);
    NEAR(12, values[METRIC_ESTIMATES]);
    NEAR(321, values[METRIC_FRAMES_SENT]);
    NEAR(1, values[METRIC_FRAMES_SENT_BEACONS]);
    NEAR(20, values[METRIC_FRAMES_SENT_REPORTS]);
    NEAR(300, values[METRIC_FRAMES_SENT_REQUESTS]);
    NEAR(7, values[METRIC_FRAMES_RECEIVED]);
    NEAR(9, values[METRIC_REPORTS_ASKED]);
    NEAR(0.75, values[METRIC_DELIVERY_SHARE]);
    NEAR(3875, values[METRIC_ENERGY_MJ]);
    NEAR(750, values[METRIC_ENERGY_MJ_ROUTING]);
    NEAR(125, values[METRIC_ENERGY_MJ_TIME]);
    NEAR(3000, values[METRIC_ENERGY_MJ_IDLE]);
    NEAR(3500, values[METRIC_ENERGY_MJ_STATE_LISTEN]);
    NEAR(375, values[METRIC_ENERGY_MJ_STATE_TRANSMIT]);
    NEAR(0, values[METRIC_ENERGY_MJ_STATE_CPU]);
    NEAR(77, values[METRIC_LIFETIME_HALF_S]);
    NEAR(4, values[METRIC_MOTES_DEAD]);
    NEAR(0.75, values[METRIC_CLOCK_ERROR_P99_MS]);
    TEST_ASSERT_TRUE(isnan(values[METRIC_LIFETIME_S]));
}

/* The source of 200 is there until instant 4; the estimate of its rate grows by 100 an instant. */
static void growing_rate(const struct observer *observer, int i)
{
    const struct truth truth = {.time_s = i, .present = i < 5, .rate = i < 5 ? 200 : 0};
    const struct mh_estimate estimate = {.rate = 100.0f * (float)(i + 1)};
    observer->truth(observer->context, &truth);
    observer->estimate(observer->context, i, 0, &estimate, &truth, &truth);
}

static void the_rate_is_judged_at_the_end_of_the_release(void)
{
    run_of(8, growing_rate);
    NEAR(2.5, values[METRIC_RATE_RATIO]);
    tearDown();
    setUp();
    run_of(12, three_metres_off);
    TEST_ASSERT_TRUE(isnan(values[METRIC_RATE_RATIO]));
}

static void metrics_have_names_of_their_own(void)
{
    for (size_t i = 0; i < METRIC_COUNT; i++) {
        TEST_ASSERT_TRUE(strlen(metric_meanings[i]) > 0);
        for (size_t j = 0; j < i; j++) {
            TEST_ASSERT_TRUE_MESSAGE(strcmp(metric_names[i], metric_names[j]) != 0, metric_names[i]);
        }
    }
    TEST_ASSERT_EQUAL_STRING("local_anees_4", metric_names[METRIC_ERRORS_COUNT - 1]);
    TEST_ASSERT_EQUAL_STRING(total_names[0], metric_names[METRIC_FIRST_TOTAL]);
}

/* The name of every state and cause stands in a metric's, that of a cause also in one by sampling instant. */
static void energy_metrics_cover_states_and_causes(void)
{
    struct simulation_counters counters = {.samples = 4};
    double totals[TOTAL_COUNT];
    for (int state = 0; state < ENERGY_STATES; state++) {
        for (int cause = 0; cause < ENERGY_CAUSES; cause++) {
            char of_state[60], of_cause[60], by_sample[60];
            snprintf(of_state, sizeof of_state, "energy_mj_state_%s", energy_state_names[state]);
            snprintf(of_cause, sizeof of_cause, "energy_mj_%s", energy_cause_names[cause]);
            snprintf(by_sample, sizeof by_sample, "energy_mj_per_sample_%s", energy_cause_names[cause]);
            counters.energy.joules[state][cause] = 2;
            totals_of(&counters, totals);
            int found = 0;
            for (int i = 0; i < TOTAL_COUNT; i++) {
                const bool meant = strcmp(total_names[i], of_state) == 0 || strcmp(total_names[i], of_cause) == 0 ||
                                   strcmp(total_names[i], "energy_mj") == 0;
                const bool shared =
                    strcmp(total_names[i], by_sample) == 0 || strcmp(total_names[i], "energy_mj_per_sample") == 0;
                found += meant + shared;
                if (strncmp(total_names[i], "energy_mj", 9) == 0) {
                    NEAR(meant ? 2000 : shared ? 500 : 0, totals[i]);
                }
            }
            TEST_ASSERT_EQUAL_INT(5, found);
            counters.energy.joules[state][cause] = 0;
        }
    }
}

/* Every other instant without a position; no covariance. */
static void half_of_the_time(const struct observer *observer, int i)
{
    const struct truth truth = {.time_s = i, .x_m = i, .present = true};
    if (i % 2 == 0) {
        tell(observer, i, true, (float)i, 0, 0, 0);
    } else {
        observer->truth(observer->context, &truth);
    }
}

static void what_a_tracker_does_not_state_does_not_apply(void)
{
    run_of(20, half_of_the_time);
    NEAR(0.5, values[METRIC_TRACKED_SHARE]);
    NEAR(0, values[METRIC_POSITION_RMSE_M]);
    TEST_ASSERT_TRUE(isnan(values[METRIC_NEES_MEDIAN]));
}

/* Three states: off by (1, 0) and the rate by 2; four: by (1, 0) and (2, 0). Two correlated ones with
 * [4 2; 2 2]^-1 = [1/2 -1/2; -1/2 1], the others of variance 1: 1/2 - 2 + 4. */
static void all_states(const struct observer *observer, int i, uint8_t states)
{
    const struct truth truth = {.time_s = i, .x_m = i - 1, .present = true, .vx_mps = 10, .rate = states == 3 ? 30 : 0};
    struct mh_estimate estimate = {.position = {(float)i, 0},
                                   .velocity = {12, 0},
                                   .covariance = {4, 0, 1},
                                   .covariance_more = {2, 0, 2, 0, 0, 0, 1},
                                   .rate = states == 3 ? 32 : 0,
                                   .states = states};
    observer->truth(observer->context, &truth);
    observer->estimate(observer->context, i, 0, &estimate, &truth, &truth);
}

static void with_rate(const struct observer *observer, int i) { all_states(observer, i, 3); }

static void with_velocity(const struct observer *observer, int i) { all_states(observer, i, 4); }

static void the_normalised_error_is_of_all_states_that_are_stated(void)
{
    run_of(10, with_rate);
    NEAR(2.5, values[METRIC_NEES_MEDIAN]);
    tearDown();
    setUp();
    run_of(10, with_velocity);
    NEAR(2.5, values[METRIC_NEES_MEDIAN]);
}

/* Off by 3 m to 6 m in turns at every second instant; the third cluster by twice as much, what it claims is 1 m each way. */
static void fused(const struct observer *observer, int i)
{
    const struct truth truth = {.time_s = i, .x_m = i, .present = true};
    const float off = (float)(3 + i / 2 % 2 * 3);
    const struct mh_estimate centre = {.position = {(float)i + off, 0},
                                       .covariance = {4, 0, 5},
                                       .covariance_more = {0, 0, 1, 0, 0, 0, 1},
                                       .states = 4};
    const struct mh_estimate local = {.position = {(float)i + 2 * off, 0},
                                      .covariance = {1, 0, 1},
                                      .covariance_more = {0, 0, 1, 0, 0, 0, 1},
                                      .states = 4};
    observer->truth(observer->context, &truth);
    if (i % 2 == 1) {
        observer->local(observer->context, i, 2, 40, &local, &truth);
        observer->estimate(observer->context, i, 50, &centre, &truth, &truth);
    }
}

static void fixed_clusters_are_judged_over_the_runs(void)
{
    struct errors pooled = {0};
    double both[METRIC_ERRORS_COUNT];
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "network.protocol", "fixed", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "metrics.skip_first", "2", error, sizeof error));
    run_of(20, fused); /* 3, 6, 3 ... at instants 1, 3 ... 19 */
    NEAR(45, values[METRIC_SMSE_M]);
    NEAR(6, values[METRIC_POSITION_RMSE_WORST_M]);
    NEAR(sqrt(22.5), values[METRIC_POSITION_RMSE_M]);
    NEAR(22.5 / 4, values[METRIC_ANEES]);
    NEAR(sqrt(9 / 22.5), values[METRIC_CLAIMED_OVER_RMSE]);
    NEAR(2 * sqrt(22.5), values[METRIC_LOCAL_POSITION_RMSE_M_3]);
    NEAR(90, values[METRIC_LOCAL_ANEES_3]);
    TEST_ASSERT_TRUE(isnan(values[METRIC_LOCAL_ANEES_1]) && isnan(values[METRIC_LOCAL_POSITION_RMSE_M_4]));
    TEST_ASSERT_EQUAL_INT(0, errors_append(&pooled, &errors));
    TEST_ASSERT_EQUAL_INT(0, errors_append(&pooled, &errors));
    for (size_t i = 0; i < pooled.squares.count; i++) { /* a third run without any error */
        pooled.counts.values[i] += i % 2 == 1;
    }
    metrics_of_errors(&pooled, both);
    NEAR(45 * sqrt(2.0 / 3), both[METRIC_SMSE_M]);
    NEAR(6 * sqrt(2.0 / 3), both[METRIC_POSITION_RMSE_WORST_M]);
    NEAR(2 * sqrt(22.5), both[METRIC_LOCAL_POSITION_RMSE_M_3]);
    errors_free(&pooled);
}

static void blind(const struct observer *observer, int i) { tell(observer, i, false, 1, 2, 1, 0); }

static void without_truth_there_are_no_errors(void)
{
    run_of(20, blind);
    for (size_t i = 0; i < METRIC_ESTIMATES; i++) {
        TEST_ASSERT_TRUE_MESSAGE(isnan(values[i]), metric_names[i]);
    }
    NEAR(20, values[METRIC_ESTIMATES]);
}

/* Two targets in turn; only target 1 is off by more than 5 m, from instant 20 for 4 and from 40 for 5 of its own
 * instants. */
static void target_1_strays(const struct observer *observer, int i)
{
    const bool strays = i % 2 == 1 && ((i >= 20 && i < 28) || (i >= 40 && i < 50));
    tell(observer, i, true, (float)i, strays ? 5.01f : 4.99f, 1, (uint8_t)(i % 2));
}

static void a_track_is_lost_after_so_many_successive_errors_of_one_target(void)
{
    run_of(30, target_1_strays);
    NEAR(0, values[METRIC_TRACK_LOST]);
    tearDown();
    setUp();
    run_of(60, target_1_strays);
    NEAR(1, values[METRIC_TRACK_LOST]);
    TEST_ASSERT_EQUAL_size_t(60 - 2 * 3, errors.position.count);
}

/* The head is off by 10 m, but by 60 m at instants 8 to 11 and silent at 20 to 24; the sink, told from instant 2 on, by 20 m. */
static void followed_in_clusters(const struct observer *observer, int i)
{
    const struct truth truth = {.time_s = i, .x_m = i, .present = true};
    const struct mh_estimate sink = {.position = {(float)i, 20}, .velocity = {1, 0}};
    if (i >= 20 && i < 25) {
        observer->truth(observer->context, &truth);
    } else {
        tell(observer, i, true, (float)i, i >= 8 && i < 12 ? -60 : 10, 0, 0);
    }
    if (i >= 2) {
        observer->sink(observer->context, i, &sink, &truth);
    }
}

static void a_ranged_target_is_judged_by_its_sensing_range(void)
{
    scenario.sensor.quantity = QUANTITY_RANGE;
    scenario.metrics.skip_first = 5;
    run_of(40, followed_in_clusters);
    NEAR((26 * 10 + 4 * 60) / 30.0 / 50, values[METRIC_LOCALISATION_ERROR_RS]);
    NEAR(0.4, values[METRIC_SINK_ERROR_RS]);
    NEAR(6, values[METRIC_LONGEST_GAP_S]); /* from 19 s to 25 s; from 7 s to 12 s it is 5 s */
    TEST_ASSERT_EQUAL_size_t(38, recorder.sink_count);
    TEST_ASSERT_EQUAL_INT(-1, recorder.sinks[0].head);
    NEAR(2, recorder.sinks[0].true_x_m);
}

/* Its last position comes 10 s before the end. */
static void given_up(const struct observer *observer, int i)
{
    const struct truth truth = {.time_s = i, .x_m = i, .present = true};
    if (i >= 4 && i < 30) {
        tell(observer, i, true, (float)i, 0, 0, 0);
    } else {
        observer->truth(observer->context, &truth);
    }
}

static void a_gap_may_be_at_either_end(void)
{
    scenario.sensor.quantity = QUANTITY_RANGE;
    run_of(40, given_up);
    NEAR(10, values[METRIC_LONGEST_GAP_S]);
    TEST_ASSERT_TRUE(isnan(values[METRIC_SINK_ERROR_RS]) && isnan(values[METRIC_CLUSTERS]));
    tearDown();
    setUp();
    run_of(40, given_up);
    TEST_ASSERT_TRUE(isnan(values[METRIC_LONGEST_GAP_S]) && isnan(values[METRIC_LOCALISATION_ERROR_RS]));
}

static void clusters_are_counted_where_there_are_any(void)
{
    struct simulation_counters counters = {.samples = 50, .clusters.total = {30, 4, 25, 400, 200}};
    double totals[TOTAL_COUNT];
    totals_of(&counters, totals);
    TEST_ASSERT_TRUE(isnan(totals[TOTAL_CLUSTERS]) && isnan(totals[TOTAL_REPORTS_PER_SAMPLE]));
    counters.clusters.present = true;
    totals_of(&counters, totals);
    NEAR(30, totals[TOTAL_CLUSTERS]);
    NEAR(4, totals[TOTAL_RECOVERIES]);
    NEAR(0.5, totals[TOTAL_REPORTS_PER_SAMPLE]);
    NEAR(8, totals[TOTAL_ASKED_PER_SAMPLE]);
    NEAR(4, totals[TOTAL_ANSWERED_PER_SAMPLE]);
}

static void pooled_errors_weigh_estimates_not_runs(void)
{
    struct errors one = {0}, pooled = {0};
    double pooled_values[METRIC_ERRORS_COUNT];
    for (int i = 0; i < 30; i++) {
        TEST_ASSERT_EQUAL_INT(0, samples_add(&one.position, i < 10 ? 4 : 1));
    }
    TEST_ASSERT_EQUAL_INT(0, errors_append(&pooled, &one));
    one.position.count = 10; /* the fours alone */
    TEST_ASSERT_EQUAL_INT(0, errors_append(&pooled, &one));
    metrics_of_errors(&pooled, pooled_values);
    NEAR(sqrt((20 * 16 + 20 * 1) / 40.0), pooled_values[METRIC_POSITION_RMSE_M]);
    NEAR(2.5, pooled_values[METRIC_POSITION_MEDIAN_M]);
    TEST_ASSERT_TRUE(isnan(pooled_values[METRIC_RAW_POSITION_RMSE_M]));
    errors_free(&one);
    errors_free(&pooled);
}

/* Six heads in a row along x, each heard with the two nodes beyond it; the leak is at the origin and releases 30. Errors of 80, 9, 30, 8, 4 and 3 m, the
 * last three calm; the rate is 33 in the end. */
static void a_search(const struct observer *observer, int i)
{
    static const float off_m[] = {80, 9, 30, 8, 4, 3};
    const struct truth truth = {.time_s = 5.0 * i, .present = true, .rate = 30};
    const mh_node_id head = (mh_node_id)i, members[] = {head + 1, head + 2};
    const struct mh_estimate estimate = {.position = {off_m[i], 0},
                                         .covariance = {9, 0, 9},
                                         .covariance_more = {0, 0, 9},
                                         .states = 3,
                                         .rate = 33,
                                         .flags = i >= 3 ? MH_ESTIMATE_CALM : 0};
    for (mh_node_id node = 0; i == 0 && node < 8; node++) {
        const struct mh_place place = {100000 - 10000 * (int32_t)node, 0, 0};
        observer->node(observer->context, node, &place);
    }
    observer->truth(observer->context, &truth);
    observer->cluster(observer->context, truth.time_s, 0, head, members, 2, i > 0);
    observer->estimate(observer->context, truth.time_s, head, &estimate, &truth, &truth);
}

static void a_search_is_judged_by_its_end(void)
{
    scenario.sensor.quantity = QUANTITY_GAS;
    run_of(6, a_search);
    NEAR(1, values[METRIC_SUCCESS_50M]);
    NEAR(1, values[METRIC_SUCCESS_10M]);
    NEAR(1, values[METRIC_CONVERGED]);
    NEAR(0, values[METRIC_CONVERGED_WRONG]);
    NEAR(6, values[METRIC_HOPS]);
    NEAR(8, values[METRIC_SENSORS_USED]);
    NEAR(6, values[METRIC_SENSORS_TO_10M]); /* at the fourth head */
    NEAR(3, values[METRIC_POSITION_ERROR_MEDIAN_M]);
    NEAR(0.1, values[METRIC_RATE_ERROR_MEDIAN]);
    NEAR(2, values[METRIC_NEES_MEDIAN]); /* (3^2 + 3^2) / 9 */
    TEST_ASSERT_TRUE(values[METRIC_CRLB_M] > 0 && values[METRIC_CRLB_M] < 200);
    NEAR(fmin(3 / values[METRIC_CRLB_M], 5), values[METRIC_ERROR_OVER_CRLB]);
    tearDown();
    setUp();
    scenario.sensor.quantity = QUANTITY_GAS;
    run_of(1, a_search); /* broken off, and far away */
    NEAR(0, values[METRIC_SUCCESS_50M]);
    NEAR(0, values[METRIC_CONVERGED]);
    NEAR(3, values[METRIC_SENSORS_USED]);
    TEST_ASSERT_TRUE(isnan(values[METRIC_SENSORS_TO_10M]) && isnan(values[METRIC_ERROR_OVER_CRLB]));
    tearDown();
    setUp();
    scenario.sensor.quantity = QUANTITY_GAS;
    scenario.protocol.calm = 1;
    run_of(4, a_search);
    NEAR(1, values[METRIC_SUCCESS_50M]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(statistics_have_their_closed_forms);
    RUN_TEST(errors_leave_out_the_first_and_the_time_without_a_source);
    RUN_TEST(the_rate_is_judged_at_the_end_of_the_release);
    RUN_TEST(metrics_have_names_of_their_own);
    RUN_TEST(energy_metrics_cover_states_and_causes);
    RUN_TEST(what_a_tracker_does_not_state_does_not_apply);
    RUN_TEST(the_normalised_error_is_of_all_states_that_are_stated);
    RUN_TEST(fixed_clusters_are_judged_over_the_runs);
    RUN_TEST(without_truth_there_are_no_errors);
    RUN_TEST(a_track_is_lost_after_so_many_successive_errors_of_one_target);
    RUN_TEST(a_ranged_target_is_judged_by_its_sensing_range);
    RUN_TEST(a_gap_may_be_at_either_end);
    RUN_TEST(clusters_are_counted_where_there_are_any);
    RUN_TEST(pooled_errors_weigh_estimates_not_runs);
    RUN_TEST(a_search_is_judged_by_its_end);
    port_exit(UNITY_END() > 0);
    return 0;
}
