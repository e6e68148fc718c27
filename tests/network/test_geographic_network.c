/* Luo's first experiment with reports that travel by places, in the simulator. */
#include "../unit/host_sim/scenarios.h"
#include "port.h"
#include "simulation.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

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

void setUp(void) {}
void tearDown(void) {}

static double square(double a) { return a * a; }

static void hear_estimate(void *context, double time_s, const struct mh_estimate *estimate, const struct truth *at_time,
                          const struct truth *at_arrival)
{
    (void)context;
    (void)time_s;
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

/* Reports that reached the head in time, as a share of those that were published; frames a report takes, and its losses. */
static struct outcome run(enum routing_kind routing, const char *profile, unsigned nodes)
{
    static char diffusion[] = "diffusion";
    static char name[20];
    const struct observer observer = {.estimate = hear_estimate};
    struct outcome sum = {0};
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct scenario scenario = e1();
        char error[300] = "";
        snprintf(name, sizeof name, "%s", profile);
        scenario.radio.profile = name;
        scenario.radio.retries = scenario.radio.backoffs = -1;
        scenario.tracker.name = diffusion;
        scenario.network.nodes = nodes;
        scenario.protocol.routing = routing;
        scenario.protocol.hello_s = 10;
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
    printf("%-10s %-7s %4u nodes: %5.1f %% in time, %.2f frames each, %u lost, rmse %.3f m at %u instants\n",
           routing == ROUTING_TREE ? "tree" : "geographic", profile, nodes, 100 * sum.delivered, sum.hops, sum.lost,
           sum.rmse_m, sum.estimates);
    return sum;
}

/* Without losses both ways do as well, the geographic one with tables that hold a quarter of the neighbours; only a report or two of the
 * first instant come before the hellos. */
static void as_good_as_the_tree_without_losses(void)
{
    const struct outcome tree = run(ROUTING_TREE, "ideal", NODES), places = run(ROUTING_GEOGRAPHIC, "ideal", NODES);
    TEST_ASSERT_TRUE(places.delivered > 0.995);
    TEST_ASSERT_TRUE(places.hops < 1.2 * tree.hops);
    TEST_ASSERT_TRUE(fabs(places.rmse_m - tree.rmse_m) < 0.1 * tree.rmse_m);
    TEST_ASSERT_TRUE(places.estimates + SEEDS >= tree.estimates);
}

/* At each instant many report at once; a unicast frame that collides is lost on the tree, and sent again by the link. */
static void acknowledged_hops_bear_contention(void)
{
    const struct outcome tree = run(ROUTING_TREE, "802154", 500), places = run(ROUTING_GEOGRAPHIC, "802154", 500);
    TEST_ASSERT_TRUE(places.delivered > 0.95);
    TEST_ASSERT_TRUE(places.delivered > tree.delivered + 0.2);
    TEST_ASSERT_TRUE(places.rmse_m < tree.rmse_m);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(as_good_as_the_tree_without_losses);
    RUN_TEST(acknowledged_hops_bear_contention);
    port_exit(UNITY_END() > 0);
    return 0;
}
