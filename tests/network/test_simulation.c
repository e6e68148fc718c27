/* Whole runs: the firmware in a simulated world, and on recordings. */
#include "../unit/host_sim/scenarios.h"
#include "engine/random.h"
#include "port.h"
#include "scenario/keys.h"
#include "simulation.h"
#include "unity.h"
#include "world/deployment.h"
#include "world/field.h"
#include "world/sensor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ESTIMATES_MAX = 4000 };

/* All that a run tells. */
static struct told {
    struct one {
        double now_s, time_s, x_m, y_m, error_m;
        struct mh_estimate estimate;
    } estimates[ESTIMATES_MAX];
    unsigned count, nodes, instants;
    double square, raw_square, arrival_square; /* sums over the estimates */
    uint64_t frames[MH_MESSAGE_KINDS], unsound;
    double last_s, instant_s;
    bool backwards;
    uint64_t hash; /* FNV-1a of every call */
} told;

static char error[300];
static struct simulation_counters counters;

void setUp(void) {}
void tearDown(void) {}

static void mix(const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        told.hash = (told.hash ^ ((const uint8_t *)bytes)[i]) * UINT64_C(1099511628211);
    }
}

static void at(double time_s)
{
    told.backwards |= time_s < told.last_s;
    told.last_s = time_s;
    mix(&time_s, sizeof time_s);
}

static void hear_node(void *context, mh_node_id id, const struct mh_place *place)
{
    (void)context;
    told.nodes++;
    mix(&id, sizeof id);
    mix(place, sizeof *place);
}

static void hear_truth(void *context, const struct truth *truth)
{
    (void)context;
    at(truth->time_s);
    mix(&truth->x_m, sizeof truth->x_m);
    told.instant_s = truth->time_s;
    told.instants++;
}

static double square(double a) { return a * a; }

static double to(const struct mh_estimate *estimate, struct mh_vec2 offset, const struct truth *truth)
{
    return square(estimate->origin.x_mm * 1e-3 + (double)offset.x - truth->x_m) +
           square(estimate->origin.y_mm * 1e-3 + (double)offset.y - truth->y_m);
}

static void hear_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                          const struct truth *at_time, const struct truth *at_arrival)
{
    (void)context, (void)head;
    at(time_s);
    mix(&estimate->position, sizeof estimate->position);
    mix(&estimate->covariance, sizeof estimate->covariance);
    TEST_ASSERT_TRUE(mh_finite(estimate->position.x) && mh_finite(estimate->position.y));
    TEST_ASSERT_TRUE(told.count < ESTIMATES_MAX);
    TEST_ASSERT_TRUE(at_time->time_s == told.instant_s); /* bit by bit, or its presence could differ */
    told.estimates[told.count++] = (struct one){.now_s = time_s,
                                                .time_s = at_time->time_s,
                                                .x_m = estimate->origin.x_mm * 1e-3 + (double)estimate->position.x,
                                                .y_m = estimate->origin.y_mm * 1e-3 + (double)estimate->position.y,
                                                .error_m = sqrt(to(estimate, estimate->position, at_time)),
                                                .estimate = *estimate};
    told.square += to(estimate, estimate->position, at_time);
    told.raw_square += to(estimate, estimate->raw, at_time);
    told.arrival_square += to(estimate, estimate->position, at_arrival);
}

static void hear_frame(void *context, double time_s, mh_node_id sender, mh_node_id destination, const uint8_t *bytes,
                       size_t length)
{
    (void)context;
    at(time_s);
    mix(&sender, sizeof sender);
    mix(&destination, sizeof destination);
    mix(bytes, length);
    struct mh_message message;
    if (mh_wire_decode(mh_wire_all, bytes, length, &message) == MH_OK) {
        told.frames[message.kind]++;
    } else {
        told.unsound++;
    }
}

static const struct observer all = {
    .node = hear_node, .truth = hear_truth, .estimate = hear_estimate, .frame = hear_frame};

static void run(const struct scenario *scenario, uint64_t seed)
{
    told.last_s = -1e9;
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, simulation_run(scenario, seed, &all, NULL, &counters, error, sizeof error), error);
}

static double rmse(double sum) { return sqrt(sum / told.count); }

static void assert_share(double expected, double share, double actual)
{
    printf("  %.3f, expected %.3f +- %.0f %%\n", actual, expected, 100 * share);
    TEST_ASSERT_TRUE(fabs(actual / expected - 1) <= share);
}

/* The means over many deployments are known; ten deployments have a share of their spread. */
static void luo_without_noise(const struct scenario *scenario, double filtered, double raw, double at_arrival)
{
#ifdef __SANITIZE_ADDRESS__
    enum { SEEDS = 2 };
#else
    enum { SEEDS = 10 };
#endif
    told = (struct told){0};
    uint64_t samples = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        run(scenario, seed);
        samples += counters.samples;
        TEST_ASSERT_EQUAL_UINT(0, counters.motes.frames_corrupt + counters.motes.readings_refused +
                                      counters.motes.reports_no_route + counters.head.repeated + counters.head.late);
    }
    assert_share(filtered, 0.15, rmse(told.square));
    assert_share(raw, 0.15, rmse(told.raw_square));
    assert_share(at_arrival, 0.15, rmse(told.arrival_square));
    TEST_ASSERT_TRUE(told.count >= 0.97 * (double)samples - SEEDS); /* the source begins without a reading */
}

static void luo_on_e1(void)
{
    const struct scenario scenario = e1();
    luo_without_noise(&scenario, 3.53, 3.31, 1.75);
}

static void luo_on_e2(void)
{
    const struct scenario scenario = e2();
    luo_without_noise(&scenario, 4.10, 3.64, 2.94);
}

static void same_seed_same_calls(void)
{
    struct scenario scenario = e1();
    scenario.sensor.relative_noise = 0.01;
    scenario.sensor.additive_noise = 0.02;
    scenario.sensor.loss = 0.1;
    scenario.radio.loss = 0.1;
    uint64_t hashes[4];
    for (unsigned i = 0; i < 4; i++) {
        told = (struct told){.hash = UINT64_C(14695981039346656037)};
        run(&scenario, i < 2 ? 5 : 4 + i);
        hashes[i] = told.hash;
        TEST_ASSERT_TRUE(told.count > 20);
        TEST_ASSERT_FALSE(told.backwards);
    }
    TEST_ASSERT_EQUAL_HEX64(hashes[0], hashes[1]);
    TEST_ASSERT_TRUE(hashes[0] != hashes[2] && hashes[2] != hashes[3]);
}

static void what_is_told_agrees_with_what_is_counted(void)
{
    static char diffusion[] = "diffusion";
    struct scenario scenario = e1();
    scenario.tracker.name = diffusion;
    told = (struct told){0};
    run(&scenario, 1);
    TEST_ASSERT_EQUAL_UINT(1281, told.nodes);
    TEST_ASSERT_EQUAL_UINT(97, told.instants);
    TEST_ASSERT_EQUAL_UINT(97, counters.samples);
    TEST_ASSERT_EQUAL_UINT(0, told.unsound);
    uint64_t sent = 0;
    for (int kind = 0; kind < MH_MESSAGE_KINDS; kind++) {
        TEST_ASSERT_TRUE(told.frames[kind] == counters.frames_sent[kind]);
        TEST_ASSERT_TRUE(told.frames[kind] > 0 || kind > MH_MESSAGE_REQUEST); /* what collection sends */
        sent += told.frames[kind];
    }
    TEST_ASSERT_TRUE(sent == counters.motes.frames_sent);
    TEST_ASSERT_TRUE(counters.frames_received == counters.motes.frames_received);
    TEST_ASSERT_EQUAL_UINT(1280 * 97, counters.motes.readings);
    TEST_ASSERT_EQUAL_UINT(told.count, counters.head.estimates);
}

/* Of what went over the radio a third of each hop is lost: fewer positions, but none of them wild. */
static void luo_with_lossy_radio(void)
{
    struct scenario scenario = e1();
    scenario.radio.loss = 0.3;
    told = (struct told){0};
    double lost = 0, frames = 0;
    for (uint64_t seed = 0; seed < 5; seed++) {
        run(&scenario, seed);
        lost += (double)counters.frames_lost;
        frames += (double)(counters.frames_lost + counters.frames_received);
    }
    assert_share(0.3, 0.01, lost / frames);
    printf("  %u positions, RMSE %.2f m\n", told.count, rmse(told.square));
    TEST_ASSERT_TRUE(told.count > 5 * 30);
    TEST_ASSERT_TRUE(rmse(told.square) < 2 * 3.53);
}

static void outage_leaves_a_gap_and_no_more(void)
{
    static char diffusion[] = "diffusion";
    struct scenario scenario = e1();
    scenario.tracker.name = diffusion;
    scenario.sensor.outage_start_s = 40;
    scenario.sensor.outage_s = 20;
    for (uint64_t seed = 0; seed < 3; seed++) {
        told = (struct told){0};
        run(&scenario, seed);
        TEST_ASSERT_EQUAL_UINT(1280 * 77, counters.motes.readings);
        double worst = 0;
        for (unsigned i = 0; i < told.count; i++) {
            if (told.estimates[i].time_s >= 70) {
                worst = fmax(worst, told.estimates[i].error_m);
            }
        }
        TEST_ASSERT_TRUE(told.estimates[told.count - 1].time_s == 96);
        TEST_ASSERT_TRUE(worst < 5);
    }
}

/* All nodes restart between two samples: nobody knows the way to the head, until its next beacon. */
static void nodes_restart_between_samples(void)
{
    struct scenario scenario = e1();
    told = (struct told){0};
    run(&scenario, 1);
    const uint32_t without = counters.motes.reports_no_route;
    scenario.faults.reboot.share = 1;
    scenario.faults.reboot.from_s = 44.3;
    scenario.faults.reboot.for_s = 0.4;
    run(&scenario, 1);
    TEST_ASSERT_EQUAL_UINT(1280 * 97, counters.motes.readings);
    TEST_ASSERT_TRUE(counters.motes.reports_no_route > without + 20);
}

static void a_run_is_quick(void)
{
    const struct scenario scenario = e1();
    told = (struct told){0};
    const clock_t start = clock();
    run(&scenario, 0);
    TEST_ASSERT_TRUE((double)(clock() - start) / CLOCKS_PER_SEC < 2);
}

static void stops_when_told(void)
{
    const struct scenario scenario = e1();
    const volatile sig_atomic_t stop = 1;
    told = (struct told){0};
    TEST_ASSERT_EQUAL_INT(-1, simulation_run(&scenario, 0, &all, &stop, &counters, error, sizeof error));
    TEST_ASSERT_NOT_NULL(strstr(error, "stopped at 0.000 s"));
}

static void assert_refused(const struct scenario *scenario, const char *why)
{
    TEST_ASSERT_EQUAL_INT(-1, simulation_run(scenario, 0, &all, NULL, &counters, error, sizeof error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, why), error);
}

static void refuses_what_it_cannot_run(void)
{
    static char unknown[] = "magic", range[] = "range";
    struct scenario scenario = e1();
    scenario.tracker.name = unknown;
    assert_refused(&scenario, "tracker.name: `magic`, expected diffusion, luo, range, pftl, msl, centroid, cv_ukf, "
                              "cv_ekf, gas, gas_small, gas_ekf, gas_ukf, acoustic, dm or ml");
    scenario.tracker.name = range;
    assert_refused(&scenario, "tracker.name: `range` works on ranges");
    scenario = e1();
    scenario.network.protocol = unknown;
    assert_refused(&scenario,
                   "network.protocol: `magic`, expected collection, direct, cluster, prince, fixed, token or chatter");
    scenario = e1();
    scenario.tracker.diffusion_m2ps = -1;
    assert_refused(&scenario, "tracker.*");
}

/* What simulated sensors read, recorded and replayed, gives the same track as the simulation: the head cannot tell a
 * collection tree from one hop, nor the nodes' other names and the later date. */
static void replay_of_a_simulation_is_the_simulation(void)
{
    enum { NODES = 1280, INSTANTS = 97 };
    struct scenario scenario = e1();
    scenario.sensor.relative_noise = 0.01;
    scenario.sensor.additive_noise = 0.02;
    told = (struct told){0};
    run(&scenario, 3);
    static struct told simulated;
    simulated = told;

    struct deployment nodes;
    struct field field;
    struct sensors sensors;
    static double concentrations[NODES];
    static int32_t counts[NODES];
    static struct recorded_reading readings[NODES * INSTANTS];
    static struct recorded_truth truths[INSTANTS];
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 3, error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, field_make(&field, &scenario, 0, error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, sensors_make(&sensors, &scenario, 3, NODES));
    for (unsigned p = 0; p < INSTANTS; p++) {
        TEST_ASSERT_EQUAL_INT(0, field_prepare(&field, p));
        for (unsigned i = 0; i < NODES; i++) {
            concentrations[i] = field_concentration(&field, nodes.nodes[i].x_m, nodes.nodes[i].y_m);
        }
        sensors_read(&sensors, p, concentrations, counts);
        for (unsigned i = 0; i < NODES; i++) {
            readings[p * NODES + i] =
                (struct recorded_reading){.time_s = 1.7e9 + p, .node = i, .value = ldexp(counts[i], -20)};
        }
        const struct point source = trajectory_position(&field.trajectory, p);
        truths[p] = (struct recorded_truth){.time_s = 1.7e9 + p, .x_m = source.x_m, .y_m = source.y_m};
    }
    for (unsigned i = 0; i < NODES; i++) {
        nodes.nodes[i].id = 1000 + 3 * i;
    }
    const struct recording recording = {.nodes = nodes.nodes,
                                        .node_count = NODES,
                                        .readings = readings,
                                        .reading_count = NODES * INSTANTS,
                                        .truths = truths,
                                        .truth_count = INSTANTS,
                                        .interval_s = 1};
    scenario.sensor.interval_s = 0;
    told = (struct told){.last_s = -1e9};
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0, simulation_replay(&scenario, &recording, 0, &all, NULL, &counters, error, sizeof error), error);
    TEST_ASSERT_EQUAL_UINT(INSTANTS, told.instants);
    TEST_ASSERT_EQUAL_UINT(INSTANTS, counters.samples);
    TEST_ASSERT_TRUE(told.count >= simulated.count && simulated.count > 90);
    for (unsigned i = 0; i < simulated.count; i++) {
        TEST_ASSERT_TRUE(fabs(told.estimates[i].time_s - 1.7e9 - simulated.estimates[i].time_s) < 1e-6);
        TEST_ASSERT_TRUE(fabs(told.estimates[i].x_m - simulated.estimates[i].x_m) < 1e-9);
        TEST_ASSERT_TRUE(fabs(told.estimates[i].y_m - simulated.estimates[i].y_m) < 1e-9);
        TEST_ASSERT_TRUE(fabs(told.estimates[i].error_m - simulated.estimates[i].error_m) < 1e-6);
    }
    sensors_free(&sensors);
    field_free(&field);
    deployment_free(&nodes);
}

/* Five anchors range a target on a circle of 8 m at 1 m/s, ten times a second, each with its own jitter around the burst. */
static void replay_of_ranges_with_jitter(void)
{
    enum { ANCHORS = 5, BURSTS = 600, TRUTHS = 61 };
    static struct recorded_node anchors[ANCHORS] = {
        {1, 0, 0, 2}, {2, 20, 0, 2}, {3, 20, 20, 2}, {4, 0, 20, 2}, {9, 10, 25, 3}};
    static struct recorded_reading readings[ANCHORS * BURSTS];
    static struct recorded_truth truths[TRUTHS * 10];
    static double noise[ANCHORS * BURSTS];
    static char range[] = "range";
    const struct random_stream stream = random_stream(1, RANDOM_READING_LOSS);
    random_normals(random_stream(1, RANDOM_ADDITIVE_NOISE), 0, ANCHORS * BURSTS, noise);
    for (unsigned k = 0; k < BURSTS; k++) {
        for (unsigned a = 0; a < ANCHORS; a++) {
            /* ordered within the burst; up to 4 ms before and 8 ms after its time */
            const double t = 50 + 0.1 * k - 0.004 + 0.002 * a + 0.002 * random_uniform(stream, k * ANCHORS + a);
            const double x = 10 + 8 * cos(t / 8), y = 10 + 8 * sin(t / 8);
            const double distance =
                sqrt(square(anchors[a].x_m - x) + square(anchors[a].y_m - y) + square(anchors[a].z_m - 1));
            readings[k * ANCHORS + a] =
                (struct recorded_reading){.time_s = t, .node = a, .value = distance + 0.05 * noise[k * ANCHORS + a]};
        }
    }
    for (unsigned k = 0; k < TRUTHS * 10; k++) {
        const double t = 49.9 + 0.1 * k;
        truths[k] = (struct recorded_truth){.time_s = t, .x_m = 10 + 8 * cos(t / 8), .y_m = 10 + 8 * sin(t / 8)};
    }
    const struct recording recording = {.nodes = anchors,
                                        .node_count = ANCHORS,
                                        .readings = readings,
                                        .reading_count = ANCHORS * BURSTS,
                                        .truths = truths,
                                        .truth_count = TRUTHS * 10,
                                        .interval_s = 0.1};
    struct scenario scenario = e1();
    scenario.tracker.name = range;
    scenario.tracker.range_sd_m = 0.05;
    scenario.tracker.acceleration_sd_mps2 = 0.2;
    scenario.tracker.height_m = 1;
    scenario.sensor.interval_s = 0;
    told = (struct told){.last_s = -1e9};
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0, simulation_replay(&scenario, &recording, 0, &all, NULL, &counters, error, sizeof error), error);
    TEST_ASSERT_EQUAL_UINT(ANCHORS * BURSTS, counters.motes.readings);
    TEST_ASSERT_EQUAL_UINT(ANCHORS * BURSTS,
                           counters.head.measurements); /* every burst whole, in an instant of its own */
    TEST_ASSERT_EQUAL_UINT(0, counters.head.late + counters.head.repeated);
    TEST_ASSERT_TRUE(told.count >= BURSTS - 5);
    printf("  RMSE %.3f m\n", rmse(told.square));
    TEST_ASSERT_TRUE(rmse(told.square) < 0.05);
}

static void replay_without_truth_or_readings(void)
{
    struct recorded_node nodes[4] = {{0, 0, 0, 0}, {1, 1, 0, 0}, {2, 0, 1, 0}, {3, 1, 1, 0}};
    struct recorded_reading readings[2] = {{.time_s = 0, .node = 0, .value = 1}, {.time_s = 1, .node = 0, .value = -1}};
    struct recording recording = {
        .nodes = nodes, .node_count = 4, .readings = readings, .reading_count = 2, .interval_s = 1};
    const struct scenario scenario = e1();
    told = (struct told){.last_s = -1e9};
    TEST_ASSERT_EQUAL_INT(0, simulation_replay(&scenario, &recording, 0, &all, NULL, &counters, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(0, told.count);
    TEST_ASSERT_EQUAL_UINT(2, counters.motes.readings);
    TEST_ASSERT_EQUAL_UINT(2, told.instants);
    recording.reading_count = 0;
    TEST_ASSERT_EQUAL_INT(-1, simulation_replay(&scenario, &recording, 0, &all, NULL, &counters, error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("the recording has no readings", error);
}

/* Thirds of a second are no whole number of anything. */
static void estimates_are_of_the_instants_that_are_told(void)
{
    struct scenario scenario = e1();
    scenario.sensor.interval_s = 0.3;
    scenario.tracker.window_s = 1e-6; /* the head closes at once */
    memset(&told, 0, sizeof told);
    run(&scenario, 0);
    TEST_ASSERT_EQUAL_UINT64(counters.samples, told.instants);
    scenario.tracker.window_s = 0;
    memset(&told, 0, sizeof told);
    run(&scenario, 0);
    TEST_ASSERT_TRUE(told.count > 20);
}

/* What the table of keys lets through, the trackers take. */
static void every_tracker_comes_up_at_both_ends_of_every_key(void)
{
    static const char *const names[] = {"diffusion", "luo"};
    for (size_t i = 0; i < scenario_key_count; i++) {
        const struct scenario_key *key = &scenario_keys[i];
        const bool counts =
            key->type == KEY_NUMBER && (strncmp(key->path, "tracker.", 8) == 0 ||
                                        strncmp(key->path, "sensor.", 7) == 0 || strncmp(key->path, "radio.", 6) == 0);
        for (int end = 0; end < 4 && counts; end++) {
            char text[40];
            struct scenario scenario;
            TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
            TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "network.nodes", "20", error, sizeof error));
            TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "source.speed_mps", "30", error, sizeof error));
            TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "tracker.name", names[end / 2], error, sizeof error));
            snprintf(text, sizeof text, "%.17g", end % 2 == 0 ? key->minimum : key->maximum);
            TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, key->path, text, error, sizeof error), error);
            if (scenario_check(&scenario, "scenario", error, sizeof error) == 0) {
                const struct observer none = {0};
                TEST_ASSERT_EQUAL_INT_MESSAGE(
                    0, simulation_run(&scenario, 0, &none, NULL, &counters, error, sizeof error), key->path);
            }
            scenario_free(&scenario);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(luo_on_e1);
    RUN_TEST(luo_on_e2);
    RUN_TEST(same_seed_same_calls);
    RUN_TEST(what_is_told_agrees_with_what_is_counted);
    RUN_TEST(luo_with_lossy_radio);
    RUN_TEST(outage_leaves_a_gap_and_no_more);
    RUN_TEST(nodes_restart_between_samples);
    RUN_TEST(a_run_is_quick);
    RUN_TEST(stops_when_told);
    RUN_TEST(estimates_are_of_the_instants_that_are_told);
    RUN_TEST(every_tracker_comes_up_at_both_ends_of_every_key);
    RUN_TEST(refuses_what_it_cannot_run);
    RUN_TEST(replay_of_a_simulation_is_the_simulation);
    RUN_TEST(replay_of_ranges_with_jitter);
    RUN_TEST(replay_without_truth_or_readings);
    port_exit(UNITY_END() > 0);
    return 0;
}
