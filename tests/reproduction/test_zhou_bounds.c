/* The published bounds of the walk at density 12, means over 20 seeds of two hours each, and the filter that knows all of the model beside them. */
#include "bounds/hindsight.h"
#include "bounds/pcrb.h"
#include "host_sim/scenarios.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SEEDS = 20, STEPS = 3600, SKIPPED = 5 };

#define SENSING_RANGE_M 50

static char error[300];
static struct scenario scenario;

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    walk_among_nodes(&scenario);
}

void tearDown(void) { scenario_free(&scenario); }

static struct deployment nodes_of(uint64_t seed)
{
    struct deployment nodes;
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, deployment_make(&nodes, &scenario, seed, error, sizeof error), error);
    return nodes;
}

static void posterior_bounds(void)
{
    static const struct {
        double speed_mph, sd_m, pcrb_m, snapshot_m;
    } published[] = {{4, 1, 0.55, 0.65},  {4, 5, 2.04, 3.24},  {4, 10, 3.45, 6.48},
                     {10, 1, 0.60, 0.65}, {10, 5, 2.44, 3.24}, {10, 10, 4.26, 6.48},
                     {25, 1, 0.63, 0.65}, {25, 5, 2.78, 3.24}, {25, 10, 5.01, 6.48}};
    for (size_t i = 0; i < sizeof published / sizeof published[0]; i++) {
        scenario.target.speed_mph = published[i].speed_mph;
        const struct mobility mobility = mobility_of(&scenario);
        double pcrb_m = 0, snapshot_m = 0;
        for (uint64_t seed = 1; seed <= SEEDS; seed++) {
            struct deployment nodes = nodes_of(seed);
            const struct pcrb_of_walk bounds =
                pcrb_of_walk(&mobility, seed, STEPS, SKIPPED, &nodes, SENSING_RANGE_M, published[i].sd_m);
            pcrb_m += bounds.pcrb_m / SEEDS;
            snapshot_m += bounds.snapshot_m / SEEDS;
            deployment_free(&nodes);
        }
        printf("%2g mph, sd %2g m: bound %.3f m (published %.2f), of a snapshot %.3f m (%.2f)\n",
               published[i].speed_mph, published[i].sd_m, pcrb_m, published[i].pcrb_m, snapshot_m,
               published[i].snapshot_m);
        TEST_ASSERT_TRUE(fabs(pcrb_m - published[i].pcrb_m) <= 0.011);
        TEST_ASSERT_TRUE(fabs(snapshot_m - published[i].snapshot_m) <= 0.011);
    }
}

static void least_hand_overs_and_reports(void)
{
    static const struct {
        double speed_mph, hand_overs;
    } published[] = {{4, 137}, {10, 336}, {25, 787}};
    static struct point path[STEPS + 1];
    for (size_t i = 0; i < sizeof published / sizeof published[0]; i++) {
        scenario.target.speed_mph = published[i].speed_mph;
        const struct mobility mobility = mobility_of(&scenario);
        double hand_overs = 0, reports = 0;
        for (uint64_t seed = 1; seed <= SEEDS; seed++) {
            struct deployment nodes = nodes_of(seed);
            mobility_positions(&mobility, seed, STEPS, path);
            size_t changes, segments;
            TEST_ASSERT_EQUAL_INT(
                0, hindsight_hand_overs(nodes.nodes, nodes.count, path, STEPS + 1, SENSING_RANGE_M, &changes));
            TEST_ASSERT_EQUAL_INT(0, hindsight_reports(path, STEPS + 1, 5, &segments));
            hand_overs += (double)changes / SEEDS;
            reports += (double)segments / (STEPS + 1) / SEEDS;
            deployment_free(&nodes);
        }
        printf("%2g mph: at least %.2f hand-overs (published %g), %.4f reports a sample within 5 m\n",
               published[i].speed_mph, hand_overs, published[i].hand_overs, reports);
        TEST_ASSERT_TRUE(fabs(hand_overs - published[i].hand_overs) <= 0.51);
    }
}

/* ---- the filter that knows the model ---- */

enum { PARTICLES = 2000, WALK = 800 };

struct cloud {
    struct mobility_state particle[PARTICLES], drawn[PARTICLES];
    double weight[PARTICLES];
};

/* The ranges of one sample as the target's place and the nodes in range give them; log likelihood into the weights. */
static void weigh(struct cloud *cloud, const struct deployment *nodes, const struct point *target, uint64_t seed,
                  uint64_t n, double sd_m)
{
    double greatest = -HUGE_VAL;
    for (size_t k = 0; k < PARTICLES; k++) {
        cloud->weight[k] = 0;
    }
    for (size_t i = 0; i < nodes->count; i++) {
        const double x = nodes->nodes[i].x_m, y = nodes->nodes[i].y_m;
        const double distance_m = hypot(target->x_m - x, target->y_m - y);
        if (distance_m > SENSING_RANGE_M) {
            continue;
        }
        const double range_m = distance_m + sd_m * recipe_normal(seed, RECIPE_RANGE_NOISE + n, i);
        for (size_t k = 0; k < PARTICLES; k++) {
            const double dx = cloud->particle[k].at.x_m - x, dy = cloud->particle[k].at.y_m - y;
            const double residual = (range_m - sqrt(dx * dx + dy * dy)) / sd_m;
            cloud->weight[k] -= residual * residual / 2;
        }
    }
    double total = 0;
    for (size_t k = 0; k < PARTICLES; k++) {
        greatest = fmax(greatest, cloud->weight[k]);
    }
    for (size_t k = 0; k < PARTICLES; k++) {
        cloud->weight[k] = exp(cloud->weight[k] - greatest);
        total += cloud->weight[k];
    }
    for (size_t k = 0; k < PARTICLES; k++) {
        cloud->weight[k] /= total;
    }
}

static struct point mean_of(const struct cloud *cloud)
{
    struct point mean = {0, 0};
    for (size_t k = 0; k < PARTICLES; k++) {
        mean.x_m += cloud->weight[k] * cloud->particle[k].at.x_m;
        mean.y_m += cloud->weight[k] * cloud->particle[k].at.y_m;
    }
    return mean;
}

/* Systematic resampling. */
static void resample(struct cloud *cloud, double offset)
{
    double sum = cloud->weight[0];
    for (size_t k = 0, from = 0; k < PARTICLES; k++) {
        while (sum < ((double)k + offset) / PARTICLES && from + 1 < PARTICLES) {
            sum += cloud->weight[++from];
        }
        cloud->drawn[k] = cloud->particle[from];
    }
    for (size_t k = 0; k < PARTICLES; k++) {
        cloud->particle[k] = cloud->drawn[k];
    }
}

/* Mean square error of the filter's mean over a walk. */
static double mean_square_error(const struct mobility *mobility, uint64_t seed, double sd_m)
{
    static struct cloud cloud;
    struct deployment nodes = nodes_of(seed);
    struct mobility_state state = mobility_start(mobility, seed);
    double sum = 0;
    for (size_t k = 0; k < PARTICLES; k++) { /* near where it starts, as if it had been there for some time */
        cloud.particle[k] = state;
        cloud.particle[k].at.x_m += 3 * recipe_normal(seed, 100, 2 * k);
        cloud.particle[k].at.y_m += 3 * recipe_normal(seed, 100, 2 * k + 1);
    }
    for (size_t n = 0; n <= WALK; n++) {
        if (n > 0) {
            mobility_next(mobility, seed, n, &state);
            for (size_t k = 0; k < PARTICLES; k++) {
                mobility_step(mobility, recipe_normal(seed, 101, n * PARTICLES + k),
                              recipe_normal(seed, 102, n * PARTICLES + k), &cloud.particle[k]);
            }
        }
        weigh(&cloud, &nodes, &state.at, seed, n, sd_m);
        const struct point mean = mean_of(&cloud);
        const double x = mean.x_m - state.at.x_m, y = mean.y_m - state.at.y_m;
        sum += n >= SKIPPED ? x * x + y * y : 0;
        resample(&cloud, recipe_uniform(seed, 103, n));
    }
    deployment_free(&nodes);
    return sum / (WALK + 1 - SKIPPED);
}

/* With a cloud of particles that move as the target does and weigh each range by its true likelihood, no filter does better. */
static void the_best_filter_comes_to_the_bound(void)
{
    enum { WALKS = 4 };
    static const double sds_m[] = {5, 10};
    scenario.target.speed_mph = 10;
    const struct mobility mobility = mobility_of(&scenario);
    for (size_t i = 0; i < sizeof sds_m / sizeof sds_m[0]; i++) {
        double square = 0, bound = 0;
        for (uint64_t seed = 1; seed <= WALKS; seed++) {
            struct deployment nodes = nodes_of(seed);
            square += mean_square_error(&mobility, seed, sds_m[i]);
            bound += pow(pcrb_of_walk(&mobility, seed, WALK, SKIPPED, &nodes, SENSING_RANGE_M, sds_m[i]).pcrb_m, 2);
            deployment_free(&nodes);
        }
        printf("sd %2g m: particle filter with the exact model %.3f of the bound\n", sds_m[i], sqrt(square / bound));
        TEST_ASSERT_TRUE(sqrt(square / bound) >= 0.95 && sqrt(square / bound) <= 1.04);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(posterior_bounds);
    RUN_TEST(least_hand_overs_and_reports);
    RUN_TEST(the_best_filter_comes_to_the_bound);
    port_exit(UNITY_END() > 0);
    return 0;
}
