/* A target that nodes hear, over the network: what is sensed and what comes of it at the sink; the same from a recording; and by the protocol prince what the
 * observer is told of heads. */
#include "motehound/wire.h"
#include "port.h"
#include "simulation.h"
#include "unity.h"
#include "world/deployment.h"
#include "world/sound.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 12, NODES = SIDE * SIDE, ESTIMATES_MAX = 40, SEED = 5 };

static struct scenario scenario;
static struct simulation_counters counters;
static char error[300];

static struct {
    struct deployment nodes;
    struct targets targets;
    struct sound sound;
    struct point estimates[ESTIMATES_MAX];
    size_t estimate_count, reports, watches, clusters, members;
    double sum_m;
} seen;

static void set(const char *key, const char *value)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, key, value, error, sizeof error), error);
}

/* A target goes 200 m through 144 nodes of as many per area as the published experiments have. */
void setUp(void)
{
    memset(&seen, 0, sizeof seen);
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    static const char *const settings[][2] = {{"field.width_m", "353"},     {"field.height_m", "353"},
                                              {"source.path", "parallel"},  {"source.points", "80,150; 280,190"},
                                              {"source.speed_mps", "10"},   {"network.layout", "strat"},
                                              {"network.grid", "12"},       {"network.sink_x_m", "176"},
                                              {"network.sink_y_m", "176"},  {"network.protocol", "direct"},
                                              {"sensor.quantity", "sound"}, {"sensor.range_m", "40"},
                                              {"sensor.interval_s", "1"},   {"radio.range_m", "1000"},
                                              {"tracker.name", "acoustic"}};
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        set(settings[i][0], settings[i][1]);
    }
}

static void forget(void)
{
    deployment_free(&seen.nodes);
    targets_free(&seen.targets);
    memset(&seen, 0, sizeof seen);
}

void tearDown(void)
{
    forget();
    scenario_free(&scenario);
}

static void hear_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                          const struct truth *at_time, const struct truth *at_arrival)
{
    (void)context, (void)time_s, (void)at_arrival, (void)head;
    const double x_m = estimate->origin.x_mm * 1e-3 + (double)estimate->position.x;
    const double y_m = estimate->origin.y_mm * 1e-3 + (double)estimate->position.y;
    TEST_ASSERT_TRUE(seen.estimate_count < ESTIMATES_MAX);
    seen.estimates[seen.estimate_count++] = (struct point){x_m, y_m};
    seen.sum_m += hypot(x_m - at_time->x_m, y_m - at_time->y_m);
    TEST_ASSERT_TRUE(at_time->target == 0 || at_time->target == 1);
}

/* Every report holds the energy at its node and sample, to a quantum, and it is one that counts. */
static void hear_frame(void *context, double time_s, mh_node_id sender, mh_node_id destination, const uint8_t *bytes,
                       size_t length)
{
    (void)context, (void)time_s, (void)destination;
    struct mh_message message;
    if (mh_wire_decode(mh_wire_all, bytes, length, &message) != MH_OK || message.kind != MH_MESSAGE_REPORT) {
        return;
    }
    const mh_report_t *report = &message.as.report;
    const struct recorded_node *node = &seen.nodes.nodes[sender];
    const double energy =
        sound_reading(&seen.sound, &seen.targets, report->time_ms * 1e-3, sender, (struct point){node->x_m, node->y_m});
    TEST_ASSERT_TRUE(energy >= 1 && fabs(ldexp(report->value_q20, -20) - energy) < 1e-6);
    seen.reports++;
}

static void hear_watch(void *context, double time_s, const struct watch_news *watch)
{
    (void)context;
    TEST_ASSERT_TRUE(watch->number < seen.targets.count && watch->head < NODES);
    const struct target_state truth = targets_at(&seen.targets, watch->number, time_s);
    TEST_ASSERT_TRUE(!truth.present || hypot(watch->x_m - truth.at.x_m, watch->y_m - truth.at.y_m) < 40);
    TEST_ASSERT_TRUE(watch->prince == MH_BROADCAST || (watch->prince < NODES && watch->prince_s > time_s - 1));
    TEST_ASSERT_EQUAL_UINT(1, watch->members);
    seen.watches++;
}

/* Nobody who hears a target is farther than twice 60 m from whom he answers. */
static void hear_cluster(void *context, double time_s, uint32_t track, mh_node_id head, const mh_node_id *members,
                         size_t count, bool is_new)
{
    (void)context, (void)time_s;
    const struct recorded_node *nodes = seen.nodes.nodes;
    TEST_ASSERT_EQUAL_INT(seen.clusters > 0, is_new);
    TEST_ASSERT_TRUE(track != 0);
    for (size_t i = 0; i < count; i++) {
        const struct recorded_node *member = &nodes[members[i]];
        TEST_ASSERT_TRUE(members[i] != head);
        TEST_ASSERT_TRUE(hypot(member->x_m - nodes[head].x_m, member->y_m - nodes[head].y_m) < 120);
    }
    seen.clusters++;
    seen.members += count;
}

static const struct observer all = {
    .estimate = hear_estimate, .frame = hear_frame, .watch = hear_watch, .cluster = hear_cluster};

static void prepare(void)
{
    forget();
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_check(&scenario, "test", error, sizeof error), error);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&seen.nodes, &scenario, SEED, error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, targets_make(&seen.targets, &scenario, SEED, error, sizeof error));
    seen.sound = sound_of(&scenario, SEED);
}

static void run(void)
{
    prepare();
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, simulation_run(&scenario, SEED, &all, NULL, &counters, error, sizeof error),
                                  error);
}

static void the_sink_hears_of_all_that_hear(void)
{
    run();
    unsigned heard = 0; /* from the second instant on: until then nobody knows the sink */
    for (int t = 1; t <= 20; t++) {
        for (uint32_t i = 0; i < NODES; i++) {
            const struct point place = {seen.nodes.nodes[i].x_m, seen.nodes.nodes[i].y_m};
            heard += sound_reading(&seen.sound, &seen.targets, t, i, place) >= 1;
        }
    }
    TEST_ASSERT_EQUAL_UINT(heard, seen.reports);
    TEST_ASSERT_GREATER_THAN_UINT(20 * 3, heard);
    TEST_ASSERT_EQUAL_size_t(20, seen.estimate_count);
    TEST_ASSERT_TRUE(seen.sum_m / 20 < 3);
}

/* The same readings as a recording give the same track. */
static void a_recording_of_energies(void)
{
    set("tracker.speed_mps", "10"); /* of a recording it is not known */
    run();
    enum { READINGS_MAX = 1000 };
    static struct recorded_reading readings[READINGS_MAX];
    struct point estimates[20];
    memcpy(estimates, seen.estimates, sizeof estimates);
    struct recording recording = {
        .nodes = malloc(NODES * sizeof *recording.nodes), .node_count = NODES, .readings = readings, .interval_s = 1};
    TEST_ASSERT_NOT_NULL(recording.nodes);
    memcpy(recording.nodes, seen.nodes.nodes, NODES * sizeof *recording.nodes);
    for (int t = 1; t <= 20; t++) {
        for (uint32_t i = 0; i < NODES; i++) {
            const struct point place = {seen.nodes.nodes[i].x_m, seen.nodes.nodes[i].y_m};
            const double energy = sound_reading(&seen.sound, &seen.targets, t, i, place);
            TEST_ASSERT_TRUE(recording.reading_count < READINGS_MAX);
            if (energy >= 0.5) { /* some that do not count, too */
                readings[recording.reading_count++] =
                    (struct recorded_reading){.time_s = t, .node = i, .value = energy};
            }
        }
    }
    seen.estimate_count = 0;
    seen.sum_m = 0;
    const struct observer only = {.estimate = hear_estimate};
    scenario.sensor.interval_s = 0;
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0, simulation_replay(&scenario, &recording, 0, &only, NULL, &counters, error, sizeof error), error);
    free(recording.nodes);
    TEST_ASSERT_EQUAL_size_t(20, seen.estimate_count);
    for (int i = 0; i < 20; i++) {
        const double off_m = hypot(seen.estimates[i].x_m - estimates[i].x_m, seen.estimates[i].y_m - estimates[i].y_m);
        TEST_ASSERT_TRUE(off_m < 1e-3);
    }
}

static void heads_are_told(void)
{
    set("network.protocol", "prince");
    set("protocol.election", "prince");
    set("protocol.watch_s", "0");
    set("source.start_s", "10");
    set("sensor.interval_s", "0.25");
    set("radio.profile", "cc1000");
    set("radio.range_m", "140");
    run();
    TEST_ASSERT_GREATER_THAN_size_t(2, seen.estimate_count);
    TEST_ASSERT_EQUAL_size_t(seen.estimate_count, seen.watches);
    TEST_ASSERT_EQUAL_size_t(seen.estimate_count, seen.clusters);
    TEST_ASSERT_GREATER_OR_EQUAL_size_t(seen.clusters, seen.members);
    TEST_ASSERT_EQUAL_UINT64(seen.estimate_count, counters.protocol.princes.located);
    TEST_ASSERT_TRUE(seen.sum_m / (double)seen.estimate_count < 8);
}

/* Every announcement of a head that was sent, once. */
static struct {
    mh_awake_t awakes[200];
    size_t count;
} announced;

static void see_awake(void *context, double time_s, mh_node_id sender, mh_node_id destination, const uint8_t *bytes,
                      size_t length)
{
    struct mh_message message;
    (void)context;
    (void)time_s;
    (void)sender;
    (void)destination;
    if (mh_wire_decode(mh_wire_all, bytes, length, &message) != MH_OK || message.kind != MH_MESSAGE_AWAKE) {
        return;
    }
    for (size_t i = 0; i < announced.count; i++) {
        const mh_awake_t *one = &announced.awakes[i];
        if (one->sender == message.as.awake.sender && one->target == message.as.awake.target &&
            one->generation == message.as.awake.generation) {
            return;
        }
    }
    TEST_ASSERT_TRUE(announced.count < sizeof announced.awakes / sizeof announced.awakes[0]);
    announced.awakes[announced.count++] = message.as.awake;
}

static size_t second_heads(void)
{
    size_t count = 0;
    for (size_t i = 0; i < announced.count; i++) {
        bool second = false;
        for (size_t j = 0; j < i; j++) {
            second = second || (announced.awakes[i].target == announced.awakes[j].target &&
                                announced.awakes[i].generation == announced.awakes[j].generation);
        }
        count += second;
    }
    return count;
}

/* Those that never hear of each other count, too. */
static void second_heads_are_counted(void)
{
    const struct observer observer = {.frame = see_awake};
    size_t total = 0;
    set("network.protocol", "prince");
    set("protocol.election", "prince");
    set("sensor.interval_s", "0.25");
    set("protocol.watch_s", "0");
    set("source.start_s", "10");
    set("source.points", "20,20; 330,330");
    set("radio.profile", "cc1000");
    set("radio.range_m", "140");
    set("radio.loss", "0.4");
    for (uint64_t seed = 0; seed < 30; seed++) {
        announced.count = 0;
        TEST_ASSERT_EQUAL_INT_MESSAGE(
            0, simulation_run(&scenario, seed, &observer, NULL, &counters, error, sizeof error), error);
        TEST_ASSERT_EQUAL_size_t(second_heads(), counters.double_heads);
        total += second_heads();
    }
    TEST_ASSERT_GREATER_THAN_size_t(0, total);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_sink_hears_of_all_that_hear);
    RUN_TEST(a_recording_of_energies);
    RUN_TEST(heads_are_told);
    RUN_TEST(second_heads_are_counted);
    port_exit(UNITY_END() > 0);
}
