#include "bounds/bounds.h"
#include "bounds/hindsight.h"
#include "bounds/pcrb.h"
#include "port.h"
#include "totals.h"
#include "unity.h"

#include <math.h>

static char error[300];
static struct scenario scenario;
static struct bounds bounds;

static void set(const char *key, const char *value)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, key, value, error, sizeof error), error);
}

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    set("source.path", "gauss_markov");
    set("source.duration_s", "200");
    set("network.nodes", "1000");
    set("network.layout", "hashed");
    set("network.density", "12");
    set("sensor.interval_s", "2");
    set("sensor.quantity", "range");
}

void tearDown(void) { scenario_free(&scenario); }

static void find(void)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, bounds_of(&scenario, 3, &bounds, error, sizeof error), error);
}

static void of_a_walk(void)
{
    enum { STEPS = 100 };
    struct deployment nodes;
    struct point path[STEPS + 1];
    size_t hand_overs, reports;
    set("metrics.skip_first", "7");
    find();
    const struct mobility mobility = mobility_of(&scenario);
    mobility_positions(&mobility, 3, STEPS, path);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 3, error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, hindsight_hand_overs(nodes.nodes, nodes.count, path, STEPS + 1, 50, &hand_overs));
    TEST_ASSERT_EQUAL_INT(0, hindsight_reports(path, STEPS + 1, 5, &reports));
    TEST_ASSERT_TRUE(bounds.apply && bounds.hand_overs == hand_overs && bounds.reports == reports);
    TEST_ASSERT_TRUE(bounds.pcrb_m == pcrb_of_walk(&mobility, 3, STEPS, 7, &nodes, 50, 5).pcrb_m);
    TEST_ASSERT_TRUE(bounds.hand_overs > 1 && bounds.reports > 1 && bounds.pcrb_m > 1);
    deployment_free(&nodes);
}

static void of_other_paths_and_detections(void)
{
    set("sensor.noisy_detection", "true");
    find();
    TEST_ASSERT_TRUE(bounds.apply && isnan(bounds.pcrb_m) && bounds.reports > 1);
    set("sensor.noisy_detection", "false");
    set("sensor.range_noise_m", "0");
    find();
    TEST_ASSERT_TRUE(isnan(bounds.pcrb_m));
    set("sensor.range_noise_m", "5");
    set("source.path", "waypoints");
    set("source.points", "100,100; 300,100; 300,300");
    set("source.speed_mps", "4");
    find(); /* one report for each leg */
    TEST_ASSERT_TRUE(bounds.apply && isnan(bounds.pcrb_m) && bounds.reports == 2);
}

/* As a run tells them. */
static void in_the_totals(void)
{
    double values[TOTAL_COUNT];
    struct simulation_counters counters = {.samples = 10};
    set("source.path", "waypoints");
    set("source.points", "100,100; 300,100; 300,300");
    set("source.speed_mps", "4");
    find();
    counters.bounds = bounds;
    totals_of(&counters, values);
    TEST_ASSERT_TRUE(isnan(values[TOTAL_PCRB_M]) && values[TOTAL_REPORTS_LEAST] == 0.2);
    TEST_ASSERT_TRUE(values[TOTAL_CLUSTERS_LEAST] == (double)bounds.hand_overs);
    set("sensor.quantity", "concentration");
    find();
    counters.bounds = bounds;
    totals_of(&counters, values);
    TEST_ASSERT_TRUE(isnan(values[TOTAL_PCRB_M]) && isnan(values[TOTAL_REPORTS_LEAST]) &&
                     isnan(values[TOTAL_CLUSTERS_LEAST]));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(of_a_walk);
    RUN_TEST(of_other_paths_and_detections);
    RUN_TEST(in_the_totals);
    port_exit(UNITY_END() > 0);
    return 0;
}
