/* The bounds of fixed clusters against closed forms: motion alone, one dimension, and a target that never moves. */
#include "bounds/pcrb_fixed.h"
#include "port.h"
#include "unity.h"
#include "world/deployment.h"

#include <math.h>

enum { STEPS = 200 };

static struct scenario scenario;
static struct deployment nodes;
static struct clusters clusters;
static double bounds[STEPS + 1];
static char error[300];

static void set(const char *key, const char *value)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, key, value, error, sizeof error), error);
}

static void near(double expected, double actual, double share)
{
    TEST_ASSERT_TRUE(fabs(actual / expected - 1) <= share);
}

/* The scenario's, as it is now. */
static const struct clusters *its_clusters(void)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, clusters_make(&clusters, &scenario, error, sizeof error), error);
    return &clusters;
}

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    set("field.width_m", "100");
    set("field.height_m", "100");
    set("source.path", "white_acceleration");
    set("source.duration_s", "100");
    set("sensor.interval_s", "0.5");
    set("target.x_m", "40");
    set("target.y_m", "60");
    set("target.acceleration_x_mps2", "0.01");
    set("target.acceleration_y_mps2", "0.02");
    set("network.layout", "rings");
    set("network.nodes", "18");
    set("network.protocol", "fixed");
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 0, error, sizeof error));
}

void tearDown(void)
{
    deployment_free(&nodes);
    scenario_free(&scenario);
}

/* Ranges that say nothing: P0 + (kT)^2 V0 + sum over j of ((k - j - 1/2) T^2)^2 of both accelerations. */
static void motion_alone(void)
{
    set("clusters.range_variance_m2", "1e4, 1e4, 1e4, 1e4");
    set("clusters.every", "1000");
    TEST_ASSERT_EQUAL_INT(0, pcrb_fixed_posterior(&scenario, its_clusters(), PCRB_ALL_CLUSTERS, bounds));
    double blur = 0;
    for (int k = 0; k <= STEPS; k++) {
        near(2 + pow(0.5 * k, 2) * 2 * 0.04 + blur * (1e-4 + 4e-4), bounds[k], 1e-9);
        blur += pow((k + 0.5) * 0.25, 2);
    }
}

/* A target that stands still at a known velocity of next to nothing: information adds up, P^-1 = P0^-1 + sum of u u' / R. */
static void standing(void)
{
    set("target.velocity_sd_mps", "0.001");
    set("target.vx_mps", "0");
    set("target.acceleration_x_mps2", "1e-5");
    set("target.acceleration_y_mps2", "1e-5");
    set("target.position_sd_m", "0.5");
    TEST_ASSERT_EQUAL_INT(0, pcrb_fixed_posterior(&scenario, its_clusters(), 1, bounds));
    /* in the first ten seconds cluster 2's nodes sample 10, 10, 5 and 3 times, at 0.015 m2 */
    const double times[4] = {10, 10, 5, 3};
    double xx = 4, xy = 0, yy = 4;
    for (int i = 0; i < 4; i++) {
        const double x = 40 - nodes.nodes[3 + i].x_m, y = 60 - nodes.nodes[3 + i].y_m, r = x * x + y * y;
        xx += times[i] * x * x / r / 0.015;
        xy += times[i] * x * y / r / 0.015;
        yy += times[i] * y * y / r / 0.015;
    }
    near((xx + yy) / (xx * yy - xy * xy), bounds[20], 0.02);
}

/* What more nodes measure can only help; over many paths the posterior bound is the lower one, and where all paths are one both are the same. */
static void all_clusters_and_one(void)
{
    double one[STEPS + 1], path[STEPS + 1];
    TEST_ASSERT_EQUAL_INT(0, pcrb_fixed_posterior(&scenario, its_clusters(), PCRB_ALL_CLUSTERS, bounds));
    double paths = 0, paths_of_one = 0;
    for (uint64_t seed = 0; seed < 100; seed++) {
        TEST_ASSERT_EQUAL_INT(0, pcrb_fixed_conditional(&scenario, its_clusters(), PCRB_ALL_CLUSTERS, seed, path));
        TEST_ASSERT_EQUAL_INT(0, pcrb_fixed_conditional(&scenario, its_clusters(), 2, seed, one));
        for (int k = 2; k <= STEPS; k++) {
            TEST_ASSERT_TRUE(path[k] < one[k]);
        }
        paths += pow(pcrb_fixed_rms_m(&scenario, path), 2) / 100;
        paths_of_one += pow(pcrb_fixed_rms_m(&scenario, one), 2) / 100;
    }
    TEST_ASSERT_EQUAL_INT(0, pcrb_fixed_posterior(&scenario, its_clusters(), 2, one));
    const double all_m = pcrb_fixed_rms_m(&scenario, bounds), one_m = pcrb_fixed_rms_m(&scenario, one);
    TEST_ASSERT_TRUE(sqrt(paths) >= all_m && sqrt(paths_of_one) >= one_m); /* Jensen's inequality */
    set("target.position_sd_m", "0.001");
    set("target.velocity_sd_mps", "0.001");
    set("target.acceleration_x_mps2", "1e-5");
    set("target.acceleration_y_mps2", "1e-5");
    TEST_ASSERT_EQUAL_INT(0, pcrb_fixed_posterior(&scenario, its_clusters(), PCRB_ALL_CLUSTERS, bounds));
    TEST_ASSERT_EQUAL_INT(0, pcrb_fixed_conditional(&scenario, its_clusters(), PCRB_ALL_CLUSTERS, 7, path));
    near(pcrb_fixed_rms_m(&scenario, bounds), pcrb_fixed_rms_m(&scenario, path), 1e-3);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(motion_alone);
    RUN_TEST(standing);
    RUN_TEST(all_clusters_and_one);
    port_exit(UNITY_END() > 0);
    return 0;
}
