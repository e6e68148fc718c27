/* A target that nodes measure the range to, over the network: what is sensed, and what comes of it at the head. */
#include "motehound/wire.h"
#include "port.h"
#include "simulation.h"
#include "unity.h"
#include "world/deployment.h"
#include "world/mobility.h"
#include "world/ranging.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STEPS = 100, NODES = 1000 };

static struct scenario scenario;
static struct simulation_counters counters;
static char error[300];

/* What was told, and what should have been. */
static struct {
    struct point places[STEPS + 1];
    struct deployment nodes;
    struct ranging ranging;
    uint64_t seed;
    unsigned truths, estimates, reports, negative;
    double square_m2, farthest_m, largest_m;
} seen;

static void set(const char *key, const char *value)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, key, value, error, sizeof error), error);
}

void setUp(void)
{
    memset(&seen, 0, sizeof seen);
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    set("source.path", "gauss_markov");
    set("source.duration_s", "200");
    set("sensor.quantity", "range");
    set("sensor.interval_s", "2");
    set("network.nodes", "1000");
    set("network.layout", "hashed");
    set("network.density", "12");
    set("network.protocol", "direct");
    set("radio.range_m", "1200");
    set("tracker.name", "pftl");
}

void tearDown(void)
{
    deployment_free(&seen.nodes);
    scenario_free(&scenario);
}

static void hear_truth(void *context, const struct truth *truth)
{
    (void)context;
    if (seen.truths <= STEPS) {
        TEST_ASSERT_TRUE(truth->present && fabs(truth->time_s - 2.0 * seen.truths) < 1e-9);
        const struct point *place = &seen.places[seen.truths];
        seen.farthest_m = fmax(seen.farthest_m, hypot(truth->x_m - place->x_m, truth->y_m - place->y_m));
    }
    seen.truths++;
}

static void hear_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                          const struct truth *at_time, const struct truth *at_arrival)
{
    (void)context, (void)time_s, (void)at_arrival;
    const double x_m = estimate->origin.x_mm * 1e-3 + (double)estimate->position.x;
    const double y_m = estimate->origin.y_mm * 1e-3 + (double)estimate->position.y;
    TEST_ASSERT_EQUAL_UINT32(NODES, head); /* the sink */
    const double error_m = hypot(x_m - at_time->x_m, y_m - at_time->y_m);
    seen.square_m2 += error_m * error_m;
    seen.estimates++;
}

/* Every report holds the range of its node at its sample, to a quantum, and no other node reports. */
static void hear_frame(void *context, double time_s, mh_node_id sender, mh_node_id destination, const uint8_t *bytes,
                       size_t length)
{
    (void)context, (void)time_s, (void)destination;
    struct mh_message message;
    if (mh_wire_decode(mh_wire_all, bytes, length, &message) != MH_OK || message.kind != MH_MESSAGE_REPORT ||
        (mh_node_id)message.as.report.origin != sender) {
        return;
    }
    const mh_report_t *report = &message.as.report;
    const uint32_t sample = (uint32_t)report->time_ms / 2000;
    const struct recorded_node *node = &seen.nodes.nodes[sender];
    const struct point *place = &seen.places[sample];
    double range_m = 0;
    TEST_ASSERT_TRUE((uint32_t)report->time_ms % 2000 == 0 && sample <= STEPS);
    TEST_ASSERT_TRUE(ranging_detects(&seen.ranging, sample, sender,
                                     hypot(node->x_m - place->x_m, node->y_m - place->y_m), &range_m));
    TEST_ASSERT_TRUE(fabs(ldexp(report->value_q20, -20) - range_m) < 1e-6);
    seen.negative += report->value_q20 < 0;
    seen.largest_m = fmax(seen.largest_m, ldexp(report->value_q20, -20));
    seen.reports++;
}

static const struct observer all = {.truth = hear_truth, .estimate = hear_estimate, .frame = hear_frame};

static void run(uint64_t seed)
{
    const struct mobility mobility = mobility_of(&scenario);
    mobility_positions(&mobility, seed, STEPS, seen.places);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&seen.nodes, &scenario, seed, error, sizeof error));
    seen.ranging = ranging_of(&scenario, NULL, seed);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, simulation_run(&scenario, seed, &all, NULL, &counters, error, sizeof error),
                                  error);
}

/* How many nodes detect the target from sample `first` on. */
static unsigned detections(unsigned first)
{
    unsigned count = 0;
    for (unsigned sample = first; sample <= STEPS; sample++) {
        for (uint32_t i = 0; i < NODES; i++) {
            double range_m;
            const double distance_m = hypot(seen.nodes.nodes[i].x_m - seen.places[sample].x_m,
                                            seen.nodes.nodes[i].y_m - seen.places[sample].y_m);
            count += ranging_detects(&seen.ranging, sample, i, distance_m, &range_m);
        }
    }
    return count;
}

/* Before the head is known, at the first sample, nobody has a way to it. */
static void all_who_detect_the_target_report_its_range(void)
{
    run(1);
    TEST_ASSERT_EQUAL_UINT(STEPS + 1, seen.truths);
    TEST_ASSERT_TRUE(seen.farthest_m < 1e-9);
    TEST_ASSERT_EQUAL_UINT(detections(1), seen.reports);
    TEST_ASSERT_EQUAL_UINT(detections(0), counters.motes.readings);
    TEST_ASSERT_EQUAL_UINT(STEPS, seen.estimates);
    printf("  %u reports, PFTL %.2f m\n", seen.reports, sqrt(seen.square_m2 / seen.estimates));
    TEST_ASSERT_TRUE(sqrt(seen.square_m2 / seen.estimates) < 5);
    TEST_ASSERT_FALSE(counters.clusters.present);
}

static void negative_and_noisy_ranges_reach_the_head(void)
{
    set("sensor.range_noise_m", "40");
    set("sensor.noisy_detection", "true");
    set("tracker.name", "centroid");
    run(2);
    TEST_ASSERT_EQUAL_UINT(detections(1), seen.reports);
    TEST_ASSERT_TRUE(seen.negative > seen.reports / 20);
    TEST_ASSERT_TRUE(seen.largest_m <= 50);
    TEST_ASSERT_EQUAL_UINT(STEPS, seen.estimates);
}

/* Faults concern ranges as they do concentrations. */
static void a_sensor_may_be_biased(void)
{
    set("tracker.name", "range");
    set("faults.bias_share", "1");
    set("faults.bias", "-200");
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0, simulation_run(&scenario, 1, &(struct observer){0}, NULL, &counters, error, sizeof error), error);
    TEST_ASSERT_TRUE(counters.motes.readings > STEPS);
    TEST_ASSERT_EQUAL_UINT(0, counters.motes.readings_refused);
    set("sensor.loss", "1");
    TEST_ASSERT_EQUAL_INT(0, simulation_run(&scenario, 1, &(struct observer){0}, NULL, &counters, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(0, counters.motes.readings);
}

static void a_tracker_gets_what_it_works_on(void)
{
    const struct observer nobody = {0};
    set("tracker.name", "luo");
    TEST_ASSERT_EQUAL_INT(-1, simulation_run(&scenario, 1, &nobody, NULL, &counters, error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("tracker.name: `luo` works on concentrations, sensor.quantity is range", error);
    set("tracker.name", "msl");
    set("sensor.quantity", "concentration");
    TEST_ASSERT_EQUAL_INT(-1, simulation_run(&scenario, 1, &nobody, NULL, &counters, error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("tracker.name: `msl` works on ranges, sensor.quantity is concentration", error);
}

/* A path of straight legs does as well as a walk: 90 m in 90 s. */
static void sum_errors(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                       const struct truth *at_time, const struct truth *at_arrival)
{
    hear_estimate(context, time_s, head, estimate, at_time, at_arrival);
    TEST_ASSERT_TRUE(fabs(at_time->x_m - (300 + at_time->time_s)) < 1e-6 && fabs(at_time->y_m - 400) < 1e-6);
}

static void any_path_will_do(void)
{
    const struct observer observer = {.estimate = sum_errors};
    set("source.path", "waypoints");
    set("source.points", "300,400; 390,400");
    for (int i = 0; i < 2; i++) {
        seen.square_m2 = 0;
        seen.estimates = 0;
        set("tracker.name", i == 0 ? "range" : "pftl");
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, simulation_run(&scenario, 3, &observer, NULL, &counters, error, sizeof error),
                                      error);
        TEST_ASSERT_TRUE(seen.estimates >= 44);
        TEST_ASSERT_TRUE(sqrt(seen.square_m2 / seen.estimates) < 5);
    }
}

/* ---- clusters, over the air and in the ideal network ---- */

static struct {
    unsigned clusters, new_ones, estimates, estimates_by_told, sinks;
    double last_sink_s, worst_m;
    bool was_head[NODES];
} followed;

static void hear_cluster(void *context, double time_s, uint32_t track, mh_node_id head, const mh_node_id *members,
                         size_t count, bool is_new)
{
    (void)context, (void)time_s, (void)track;
    TEST_ASSERT_TRUE(head < NODES);
    for (size_t i = 0; i < count; i++) {
        TEST_ASSERT_TRUE(members[i] < NODES && members[i] != head);
        const struct recorded_node *a = &seen.nodes.nodes[members[i]], *b = &seen.nodes.nodes[head];
        TEST_ASSERT_TRUE(hypot(a->x_m - b->x_m, a->y_m - b->y_m) <= 100.01); /* motes know whole millimetres */
        for (size_t j = 0; j < i; j++) {
            TEST_ASSERT_TRUE(members[i] != members[j]);
        }
    }
    followed.was_head[head] = true;
    followed.clusters++;
    followed.new_ones += is_new;
}

static void hear_head(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                      const struct truth *at_time, const struct truth *at_arrival)
{
    (void)context, (void)time_s, (void)estimate, (void)at_time, (void)at_arrival;
    TEST_ASSERT_TRUE(head < NODES);
    followed.estimates++;
    followed.estimates_by_told += followed.was_head[head];
}

static void hear_sink(void *context, double time_s, const struct mh_estimate *estimate, const struct truth *at_time)
{
    (void)context;
    TEST_ASSERT_TRUE(time_s >= at_time->time_s && fabs(remainder(at_time->time_s, 2)) < 1e-9);
    TEST_ASSERT_TRUE(at_time->time_s > followed.last_sink_s);
    followed.last_sink_s = at_time->time_s;
    followed.worst_m =
        fmax(followed.worst_m, hypot(estimate->origin.x_mm * 1e-3 + (double)estimate->position.x - at_time->x_m,
                                     estimate->origin.y_mm * 1e-3 + (double)estimate->position.y - at_time->y_m));
    followed.sinks++;
}

static void follow_in_clusters(bool ideal)
{
    static const struct observer observer = {.cluster = hear_cluster, .estimate = hear_head, .sink = hear_sink};
    memset(&followed, 0, sizeof followed);
    followed.last_sink_s = -1;
    set("network.protocol", "cluster");
    set("network.ideal", ideal ? "true" : "false");
    set("tracker.name", "range");
    set("radio.profile", "802154");
    set("radio.range_m", "100");
    set("radio.wake_period_s", "0.25");
    set("source.duration_s", "600");
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&seen.nodes, &scenario, 4, error, sizeof error));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, simulation_run(&scenario, 4, &observer, NULL, &counters, error, sizeof error),
                                  error);
    printf("  %u clusters told, %u formed, %u positions, %u by heads told of, %u at the sink\n", followed.clusters,
           counters.clusters.total.formed, followed.estimates, followed.estimates_by_told, followed.sinks);
    TEST_ASSERT_TRUE(counters.clusters.present);
    TEST_ASSERT_TRUE(followed.new_ones >= 10);
    TEST_ASSERT_TRUE(followed.sinks >= 280 && followed.sinks <= 301);
    TEST_ASSERT_TRUE(followed.estimates >= 290);
    TEST_ASSERT_TRUE(counters.clusters.total.reports >= 30 &&
                     counters.clusters.total.answered <= counters.clusters.total.asked);
}

static void clusters_of_the_ideal_network_are_told(void)
{
    follow_in_clusters(true);
    TEST_ASSERT_EQUAL_UINT(counters.clusters.total.formed, followed.new_ones);
    TEST_ASSERT_EQUAL_UINT(301, followed.sinks);
    TEST_ASSERT_EQUAL_UINT(followed.estimates, followed.estimates_by_told);
}

/* A head may find and follow the target for a moment before its formation is on the air. */
static void clusters_over_the_air_are_told(void)
{
    follow_in_clusters(false);
    TEST_ASSERT_TRUE(followed.estimates_by_told * 10 >= followed.estimates * 9);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(all_who_detect_the_target_report_its_range);
    RUN_TEST(negative_and_noisy_ranges_reach_the_head);
    RUN_TEST(a_sensor_may_be_biased);
    RUN_TEST(a_tracker_gets_what_it_works_on);
    RUN_TEST(any_path_will_do);
    RUN_TEST(clusters_of_the_ideal_network_are_told);
    RUN_TEST(clusters_over_the_air_are_told);
    port_exit(UNITY_END() > 0);
}
