/* Luo's first experiment with reports that travel by places, in the simulator. */
#include "../unit/host_sim/scenarios.h"
#include "port.h"
#include "simulation.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef __SANITIZE_ADDRESS__
enum { SEEDS = 1, NODES = 500 }; /* sanitizers take ten times as long */
#else
enum { SEEDS = 2, NODES = 1280 };
#endif

enum { SKIPPED = 3 };

static struct simulation_counters counters;
static struct {
    double square;
    unsigned count;
} errors;

static double square(double a) { return a * a; }

static void hear_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                          const struct truth *at_time, const struct truth *at_arrival)
{
    (void)context;
    (void)time_s, (void)head;
    (void)at_time;
    if (errors.count++ >= SKIPPED) {
        errors.square += square(estimate->origin.x_mm * 1e-3 + (double)estimate->position.x - at_arrival->x_m) +
                         square(estimate->origin.y_mm * 1e-3 + (double)estimate->position.y - at_arrival->y_m);
    }
}

struct outcome {
    double rmse_m, delivered, hops;
    unsigned estimates, lost;
};

static struct scenario scenario;

void setUp(void)
{
    static char diffusion[] = "diffusion";
    scenario = e1();
    scenario.radio.retries = scenario.radio.backoffs = -1;
    scenario.tracker.name = diffusion;
    scenario.protocol.hello_s = 10;
}

void tearDown(void) {}

/* Reports that reached the head in time, as a share of those that were published; frames a report takes, and its losses. */
static struct outcome run(enum routing_kind routing)
{
    static const char *const names[] = {"tree", "geographic", "greedy"};
    const struct observer observer = {.estimate = hear_estimate};
    struct outcome sum = {0};
    scenario.protocol.routing = routing;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        char error[300] = "";
        errors.square = errors.count = 0;
        TEST_ASSERT_EQUAL_INT_MESSAGE(
            0, simulation_run(&scenario, seed, &observer, NULL, &counters, error, sizeof error), error);
        sum.rmse_m += sqrt(errors.square / (errors.count - SKIPPED)) / SEEDS;
        sum.delivered += (double)counters.head.measurements / counters.motes.reports / SEEDS;
        sum.hops += (double)counters.frames_sent[MH_MESSAGE_REPORT] / counters.motes.reports / SEEDS;
        sum.estimates += errors.count;
        for (int reason = 0; reason < MH_LOSS_DUPLICATE; reason++) {
            sum.lost += counters.protocol.lost[reason];
        }
    }
    printf("%-10s %5.1f %% in time, %5.2f frames each, %4u lost, rmse %6.3f m at %u instants\n", names[routing],
           100 * sum.delivered, sum.hops, sum.lost, sum.rmse_m, sum.estimates);
    return sum;
}

/* Without losses both ways do as well, the geographic one with tables that hold a quarter of the neighbours; only a report or two of the
 * first instant come before the hellos. */
static void as_good_as_the_tree_without_losses(void)
{
    scenario.network.nodes = NODES;
    const struct outcome tree = run(ROUTING_TREE), places = run(ROUTING_GEOGRAPHIC);
    TEST_ASSERT_TRUE(places.delivered > 0.995);
    TEST_ASSERT_TRUE(places.hops < 1.2 * tree.hops);
    TEST_ASSERT_TRUE(fabs(places.rmse_m - tree.rmse_m) < 0.1 * tree.rmse_m);
    TEST_ASSERT_TRUE(places.estimates + SEEDS >= tree.estimates);
}

/* At each instant many report; what the radio gives up is sent again. */
static void both_ways_bear_contention(void)
{
    scenario.radio.profile = "802154";
    scenario.network.nodes = 500;
    const struct outcome tree = run(ROUTING_TREE), places = run(ROUTING_GEOGRAPHIC);
    TEST_ASSERT_TRUE(tree.delivered > 0.99);
    TEST_ASSERT_TRUE(places.delivered > 0.99);
    TEST_ASSERT_TRUE(fabs(places.rmse_m - tree.rmse_m) < 0.1 * tree.rmse_m);
}

/* Each node hears some 140 others, and some 20 report at an instant: what reaches the head, and where it then takes the source to be, is as
 * without contention. */
static void a_dense_field_shares_the_channel(void)
{
    scenario.network.nodes = NODES;
    const struct outcome alone = run(ROUTING_TREE);
    scenario.radio.profile = "802154";
    const struct outcome shared = run(ROUTING_TREE);
    TEST_ASSERT_TRUE(shared.delivered > 0.98);
    TEST_ASSERT_TRUE(shared.rmse_m < 1.2 * alone.rmse_m);
    TEST_ASSERT_TRUE(shared.estimates + SEEDS >= alone.estimates);
}

/* A third of the nodes dies. Their neighbours miss the acknowledgements and go by others. */
static void the_dead_are_left_out(void)
{
    scenario.network.nodes = 500;
    scenario.faults.dead.share = 0.33;
    scenario.faults.dead.from_s = 40;
    const struct outcome places = run(ROUTING_GEOGRAPHIC);
    TEST_ASSERT_TRUE(places.delivered > 0.99);
}

/* Nodes everywhere but in a ring around the head, broader than the radio's range, with a gate in its west. */
static void a_ring_is_walked_around(void)
{
    static char path[] = "/tmp/motehound_ring_XXXXXX";
    const int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0);
    FILE *nodes = fdopen(file, "w");
    fprintf(nodes, "node,x_m,y_m\n");
    for (unsigned i = 0; i < 900; i++) { /* Roberts' R2 sequence */
        const double x = 80 * fmod(0.5 + i * 0.7548776662466927, 1), y = 80 * fmod(0.5 + i * 0.5698402909980532, 1);
        const double radius = hypot(x - 40, y - 40), from_west = fabs(atan2(y - 40, 40 - x));
        if (radius < 12 || radius > 28 || from_west < 0.4) {
            fprintf(nodes, "%u,%.3f,%.3f\n", i, x, y);
        }
    }
    fclose(nodes);
    scenario.network.layout = LAYOUT_FILE;
    scenario.network.file = path;
    const struct outcome greedy = run(ROUTING_GREEDY), places = run(ROUTING_GEOGRAPHIC);
    remove(path);
    TEST_ASSERT_TRUE(greedy.delivered < 0.9 && greedy.lost > 100);
    TEST_ASSERT_TRUE(places.delivered > 0.99);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(as_good_as_the_tree_without_losses);
    RUN_TEST(both_ways_bear_contention);
    RUN_TEST(a_dense_field_shares_the_channel);
    RUN_TEST(the_dead_are_left_out);
    RUN_TEST(a_ring_is_walked_around);
    port_exit(UNITY_END() > 0);
    return 0;
}
