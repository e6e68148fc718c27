/* A target of white acceleration and the clusters on rings that follow it: known answers, closed forms, and what is random. */
#include "port.h"
#include "scenario/scenario.h"
#include "unity.h"
#include "world/accelerated.h"
#include "world/clusters.h"
#include "world/deployment.h"
#include "world/ranging.h"

#include <math.h>

#define ASSERT_NEAR(expected, actual, tolerance) TEST_ASSERT_TRUE(fabs((expected) - (actual)) <= (tolerance))

static struct scenario scenario;
static char error[300];

static void set(const char *key, const char *value)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, key, value, error, sizeof error), error);
}

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    set("field.width_m", "100");
    set("field.height_m", "100");
    set("source.path", "white_acceleration");
    set("source.duration_s", "100");
    set("target.x_m", "10");
    set("target.y_m", "20");
    set("target.vx_mps", "0.8");
    set("target.vy_mps", "0.6");
    set("target.acceleration_y_mps2", "0.02");
    set("network.layout", "rings");
    set("network.nodes", "18");
    set("sensor.interval_s", "0.5");
    set("sensor.range_m", "1000");
}

void tearDown(void) { scenario_free(&scenario); }

/* Published with the specification of the experiment, to the last digit. */
static void rings_stand_where_they_should(void)
{
    static const struct {
        size_t node;
        double x_m, y_m;
    } wanted[] = {{0, 40, 25},
                  {1, 17.5, 37.9903810567666},
                  {3, 88.5145330185363, 31.5082560867634},
                  {6, 81.5082560867634, 11.4854669814637},
                  {7, 34.352347027881, 86.7274722370205},
                  {12, 78.3378140093447, 89.6239186827273},
                  {17, 89.3335920867921, 79.4213276161636}};
    struct deployment nodes;
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 7, error, sizeof error));
    TEST_ASSERT_EQUAL_size_t(18, nodes.count);
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        ASSERT_NEAR(wanted[i].x_m, nodes.nodes[wanted[i].node].x_m, 1e-9);
        ASSERT_NEAR(wanted[i].y_m, nodes.nodes[wanted[i].node].y_m, 1e-9);
    }
    deployment_free(&nodes);
}

static void each_node_has_its_cluster_and_its_rate(void)
{
    static const uint64_t periods[18] = {2, 4, 6, 2, 2, 4, 6, 2, 2, 4, 4, 6, 2, 2, 4, 4, 6, 6};
    static const double variances[4] = {0.02, 0.015, 0.01, 0.03};
    TEST_ASSERT_EQUAL_size_t(4, clusters_count(&scenario));
    TEST_ASSERT_EQUAL_size_t(18, clusters_nodes(&scenario));
    for (size_t i = 0; i < 18; i++) {
        const struct clustered_node node = clustered_node(&scenario, i);
        const size_t cluster = i < 3 ? 0 : i < 7 ? 1 : i < 12 ? 2 : 3;
        TEST_ASSERT_EQUAL_size_t(cluster, node.cluster);
        TEST_ASSERT_EQUAL_size_t(i - clusters_first(&scenario, cluster), node.index);
        TEST_ASSERT_EQUAL_UINT64(periods[i], node.period);
        ASSERT_NEAR(variances[cluster], node.range_variance_m2, 0);
        for (size_t r = 0; r < 4; r++) {
            TEST_ASSERT_EQUAL(r == cluster, clusters_hear(&scenario, r, i));
        }
    }
    set("clusters.shared", "2");
    TEST_ASSERT_TRUE(clusters_hear(&scenario, 0, 4) && !clusters_hear(&scenario, 0, 5));
    TEST_ASSERT_TRUE(clusters_hear(&scenario, 3, 1) && !clusters_hear(&scenario, 3, 2));
    TEST_ASSERT_FALSE(clusters_hear(&scenario, 1, 0));
}

/* Position and velocity obey the model between any two instants, and the path goes through them. */
static void the_path_is_that_of_the_model(void)
{
    enum { STEPS = 200 };
    const struct accelerated target = accelerated_of(&scenario);
    struct accelerated_state states[STEPS + 1];
    struct trajectory path;
    accelerated_states(&target, 5, STEPS, states);
    TEST_ASSERT_EQUAL_INT(0, trajectory_make(&path, &scenario, 5, error, sizeof error));
    ASSERT_NEAR(100, path.duration_s, 1e-9);
    for (size_t k = 0; k < STEPS; k++) {
        const struct accelerated_state *a = &states[k], *b = &states[k + 1];
        const double t = 0.5 * (double)k;
        const struct point p = trajectory_position(&path, t), v = trajectory_velocity(&path, t);
        const struct point middle = trajectory_position(&path, t + 0.25);
        ASSERT_NEAR(a->at.x_m, p.x_m, 1e-9);
        ASSERT_NEAR(a->velocity.y_m, v.y_m, 1e-9);
        ASSERT_NEAR(a->at.y_m + 0.25 * a->velocity.y_m + 0.03125 * a->acceleration.y_m, middle.y_m, 1e-9);
        ASSERT_NEAR(a->at.x_m + 0.5 * a->velocity.x_m + 0.125 * a->acceleration.x_m, b->at.x_m, 1e-12);
        ASSERT_NEAR(a->velocity.x_m + 0.5 * a->acceleration.x_m, b->velocity.x_m, 1e-12);
    }
    const struct point end = trajectory_velocity(&path, 100);
    ASSERT_NEAR(states[STEPS].velocity.x_m, end.x_m, 1e-9);
    trajectory_free(&path);
}

/* Means and variances over 4,000 seeds, within four standard errors. */
static void start_and_accelerations_have_their_moments(void)
{
    enum { SEEDS = 4000 };
    const struct accelerated target = accelerated_of(&scenario);
    const double mean[4] = {10, 20, 0.8, 0.6}, sd[6] = {1, 1, 0.2, 0.2, 0.01, 0.02};
    double sum[6] = {0}, square[6] = {0}, product = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct accelerated_state states[3];
        accelerated_states(&target, seed, 2, states);
        const double off[6] = {states[0].at.x_m - mean[0],       states[0].at.y_m - mean[1],
                               states[0].velocity.x_m - mean[2], states[0].velocity.y_m - mean[3],
                               states[1].acceleration.x_m,       states[1].acceleration.y_m};
        for (int i = 0; i < 6; i++) {
            sum[i] += off[i] / sd[i];
            square[i] += off[i] * off[i] / (sd[i] * sd[i]);
        }
        product += off[0] * off[4] / (sd[0] * sd[4]);
    }
    for (int i = 0; i < 6; i++) {
        ASSERT_NEAR(0, sum[i] / SEEDS, 4 / sqrt(SEEDS));
        ASSERT_NEAR(1, square[i] / SEEDS, 4 * sqrt(2.0 / SEEDS));
    }
    ASSERT_NEAR(0, product / SEEDS, 4 / sqrt(SEEDS));
}

/* Each cluster's own variance; any two nodes' noise of an instant correlated, of two instants not. */
static void ranges_have_the_noise_that_is_asked_for(void)
{
    enum { SAMPLES = 20000 };
    set("sensor.noise_correlation", "0.6");
    const struct ranging ranging = ranging_of(&scenario, 3);
    double own[2] = {0}, both = 0, next = 0, last = 0;
    for (uint64_t t = 0; t < SAMPLES; t++) {
        double a, b;
        TEST_ASSERT_TRUE(ranging_detects(&ranging, t, 0, 50, &a) && ranging_detects(&ranging, t, 12, 70, &b));
        a = (a - 50) / sqrt(0.02);
        b = (b - 70) / sqrt(0.03);
        own[0] += a * a;
        own[1] += b * b;
        both += a * b;
        next += last * a;
        last = a;
    }
    const double tolerance = 4 * sqrt(2.0 / SAMPLES);
    ASSERT_NEAR(1, own[0] / SAMPLES, tolerance);
    ASSERT_NEAR(1, own[1] / SAMPLES, tolerance);
    ASSERT_NEAR(0.6, both / SAMPLES, tolerance);
    ASSERT_NEAR(0, next / SAMPLES, tolerance);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rings_stand_where_they_should);
    RUN_TEST(each_node_has_its_cluster_and_its_rate);
    RUN_TEST(the_path_is_that_of_the_model);
    RUN_TEST(start_and_accelerations_have_their_moments);
    RUN_TEST(ranges_have_the_noise_that_is_asked_for);
    port_exit(UNITY_END() > 0);
    return 0;
}
