/* A target of white acceleration and the clusters on rings that follow it: known answers, closed forms, and what is random. */
#include "port.h"
#include "scenario/scenario.h"
#include "unity.h"
#include "world/accelerated.h"
#include "world/clusters.h"
#include "world/deployment.h"
#include "world/ranging.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define ASSERT_NEAR(expected, actual, tolerance) TEST_ASSERT_TRUE(fabs((expected) - (actual)) <= (tolerance))

static struct scenario scenario;
static struct clusters clusters;
static char error[300];

static void set(const char *key, const char *value)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, key, value, error, sizeof error), error);
}

static void make_clusters(void)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, clusters_make(&clusters, &scenario, error, sizeof error), error);
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
    make_clusters();
    TEST_ASSERT_EQUAL_size_t(4, clusters.count);
    TEST_ASSERT_EQUAL_size_t(18, clusters.node_count);
    for (size_t i = 0; i < 18; i++) {
        const struct clustered_node node = clusters.nodes[i];
        const size_t cluster = i < 3 ? 0 : i < 7 ? 1 : i < 12 ? 2 : 3;
        TEST_ASSERT_EQUAL_size_t(cluster, node.cluster);
        TEST_ASSERT_EQUAL_size_t(i - clusters_first(&clusters, cluster), node.index);
        TEST_ASSERT_EQUAL_UINT64(periods[i], node.period);
        ASSERT_NEAR(variances[cluster], node.range_variance_m2, 0);
        for (size_t r = 0; r < 4; r++) {
            TEST_ASSERT_EQUAL(r == cluster, clusters_hear(&clusters, r, i));
        }
    }
    set("clusters.shared", "2");
    make_clusters();
    TEST_ASSERT_TRUE(clusters_hear(&clusters, 0, 4) && !clusters_hear(&clusters, 0, 5));
    TEST_ASSERT_TRUE(clusters_hear(&clusters, 3, 1) && !clusters_hear(&clusters, 3, 2));
    TEST_ASSERT_FALSE(clusters_hear(&clusters, 1, 0));
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
    make_clusters();
    const struct ranging ranging = ranging_of(&scenario, &clusters, 3);
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

/* A file's text as network.file of clusters that are one's own. */
static int read_own(const char *text)
{
    static const char path[] = "own_clusters.csv";
    FILE *file = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(text, file);
    fclose(file);
    set("network.layout", "file");
    set("network.protocol", "fixed");
    set("network.file", path);
    const int status = clusters_make(&clusters, &scenario, error, sizeof error);
    remove(path);
    return status;
}

static void clusters_of_ones_own(void)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0,
                                  read_own("node,x_m,y_m,cluster,period_s,noise_m2\n"
                                           "40,1,2,2,0.5,0.01\n7,3,4,1,1,0.04\n12,5,6,2,1.5,0.09\n9,7,8,1,3,0.16\n"),
                                  error);
    static const struct clustered_node wanted[4] = {{7, {3, 4}, 0, 0, 2, 0.04},
                                                    {9, {7, 8}, 0, 1, 6, 0.16},
                                                    {12, {5, 6}, 1, 0, 3, 0.09},
                                                    {40, {1, 2}, 1, 1, 1, 0.01}};
    TEST_ASSERT_EQUAL_size_t(2, clusters.count);
    TEST_ASSERT_EQUAL_size_t(4, clusters.node_count);
    for (size_t i = 0; i < 4; i++) {
        const struct clustered_node *node = &clusters.nodes[i];
        TEST_ASSERT_EQUAL_UINT32(wanted[i].id, node->id);
        TEST_ASSERT_EQUAL_size_t(wanted[i].cluster, node->cluster);
        TEST_ASSERT_EQUAL_size_t(wanted[i].index, node->index);
        TEST_ASSERT_EQUAL_UINT64(wanted[i].period, node->period);
        ASSERT_NEAR(wanted[i].place.x_m, node->place.x_m, 0);
        ASSERT_NEAR(wanted[i].place.y_m, node->place.y_m, 0);
        ASSERT_NEAR(wanted[i].range_variance_m2, node->range_variance_m2, 0);
    }
    TEST_ASSERT_EQUAL_size_t(2, clusters_first(&clusters, 1));
    set("clusters.every", "3");
    set("sensor.range_noise_m", "0.2");
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, read_own("cluster,node,x_m,y_m\n1,1,1,1\n1,2,2,2\n1,3,3,3\n1,4,4,4\n"), error);
    TEST_ASSERT_EQUAL_UINT64(3, clusters.nodes[3].period);
    ASSERT_NEAR(0.04, clusters.nodes[3].range_variance_m2, 1e-12);
}

static void clusters_of_ones_own_have_limits(void)
{
    static const char *const cases[][2] = {
        {"node,x_m,y_m\n1,1,1\n2,2,2\n3,3,3\n4,4,4\n", "csv:1: expected a column cluster"},
        {"node,x_m,y_m,period_s\n1,1,1,1\n2,2,2,1\n3,3,3,1\n4,4,4,1\n", "csv:1: expected a column cluster"},
        {"node,x_m,y_m,cluster\n1,1,1,1\n2,2,2,0\n3,3,3,1\n4,4,4,1\n", "csv:3: cluster: expected a whole number"},
        {"node,x_m,y_m,cluster\n1,1,1,1\n2,2,2,1.5\n3,3,3,1\n4,4,4,1\n", "csv:3: cluster: expected a whole number"},
        {"node,x_m,y_m,cluster\n1,1,1,1\n2,2,2,3\n3,3,3,3\n4,4,4,1\n", "found 0 of 2"},
        {"node,x_m,y_m,cluster,period_s\n1,1,1,1,1\n2,2,2,1,1\n3,3,3,1,0.75\n4,4,4,1,1\n", "csv:4: period_s: expected"},
        {"node,x_m,y_m,z_m,cluster\n1,1,1,0,1\n2,2,2,1,1\n3,3,3,0,1\n4,4,4,0,1\n", "csv:3: z_m: expected 0"},
        {"node,x_m,y_m,cluster,noise_m2\n1,1,1,1,0\n2,2,2,1,1\n3,3,3,1,1\n4,4,4,1,1\n", "csv:2: noise_m2: expected"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, read_own(cases[i][0]), cases[i][1]);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, cases[i][1]), error);
    }
    set("sensor.range_noise_m", "0");
    TEST_ASSERT_EQUAL_INT(-1, read_own("node,x_m,y_m,cluster\n1,1,1,1\n2,2,2,1\n3,3,3,1\n4,4,4,1\n"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "csv:1: expected a column noise_m2"), error);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rings_stand_where_they_should);
    RUN_TEST(each_node_has_its_cluster_and_its_rate);
    RUN_TEST(clusters_of_ones_own);
    RUN_TEST(clusters_of_ones_own_have_limits);
    RUN_TEST(the_path_is_that_of_the_model);
    RUN_TEST(start_and_accelerations_have_their_moments);
    RUN_TEST(ranges_have_the_noise_that_is_asked_for);
    port_exit(UNITY_END() > 0);
    return 0;
}
