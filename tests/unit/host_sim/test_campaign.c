#include "port.h"
#include "unity.h"
#include "world/campaign.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static char error[300];
static struct scenario scenario;
static struct deployment nodes;
static struct waypoint source = {50, 200, 1};

void setUp(void)
{
    memset(&scenario, 0, sizeof scenario);
    scenario.field.width_m = 500;
    scenario.field.height_m = 400;
    scenario.source.path = PATH_STILL;
    scenario.source.points = &source;
    scenario.source.points_count = 1;
    scenario.network.nodes = 100;
    scenario.network.layout = LAYOUT_UNIFORM;
    scenario.network.starts = 10;
    scenario.network.start_m = 400;
    scenario.radio.range_m = 80;
    nodes = (struct deployment){0};
}

void tearDown(void) { deployment_free(&nodes); }

/* Whoever is marked marks who is near until nobody new is marked: another way than the one of the code. */
static size_t marked_from_node(size_t first, double range_m)
{
    bool marked[100] = {false};
    size_t count = 1, before = 0;
    marked[first] = true;
    while (count > before) {
        before = count;
        for (size_t i = 0; i < nodes.count; i++) {
            for (size_t j = 0; j < nodes.count && !marked[i]; j++) {
                marked[i] = marked[j] && hypot(nodes.nodes[i].x_m - nodes.nodes[j].x_m,
                                               nodes.nodes[i].y_m - nodes.nodes[j].y_m) <= range_m;
                count += marked[i];
            }
        }
    }
    return count;
}

static void deployments_are_connected_and_shared_by_ten_starts(void)
{
    for (uint64_t d = 0; d < 20; d++) {
        bool begun[100] = {false};
        double x_m = 0;
        for (uint64_t k = 0; k < 10; k++) {
            uint32_t start = UINT32_MAX;
            TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 10 * d + k, error, sizeof error));
            TEST_ASSERT_EQUAL_INT(0, campaign_start(&scenario, 10 * d + k, &nodes, &start, error, sizeof error));
            TEST_ASSERT_TRUE(start < 100 && !begun[start]);
            TEST_ASSERT_TRUE(hypot(nodes.nodes[start].x_m - 50, nodes.nodes[start].y_m - 200) > 400);
            TEST_ASSERT_TRUE(k == 0 || fabs(nodes.nodes[0].x_m - x_m) < 1e-12);
            begun[start] = true;
            x_m = nodes.nodes[0].x_m;
            if (k == 0) {
                TEST_ASSERT_EQUAL_size_t(100, marked_from_node(d, 80));
            }
            deployment_free(&nodes);
        }
    }
}

static void starts_are_spread_over_all_far_nodes(void)
{
    scenario.network.starts = 2;
    unsigned first_is_lower = 0;
    for (uint64_t d = 0; d < 200; d++) {
        uint32_t start[2];
        TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 2 * d, error, sizeof error));
        TEST_ASSERT_EQUAL_INT(0, campaign_start(&scenario, 2 * d, &nodes, &start[0], error, sizeof error));
        TEST_ASSERT_EQUAL_INT(0, campaign_start(&scenario, 2 * d + 1, &nodes, &start[1], error, sizeof error));
        first_is_lower += start[0] < start[1];
        deployment_free(&nodes);
    }
    TEST_ASSERT_TRUE(first_is_lower > 65 && first_is_lower < 135); /* 100 +- five standard deviations */
}

static void impossible_ones_are_refused(void)
{
    scenario.radio.range_m = 10;
    TEST_ASSERT_EQUAL_INT(-1, deployment_make(&nodes, &scenario, 0, error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("network.starts: no deployment is connected and has 10 nodes farther than network.start_m "
                             "= 400 m from the source",
                             error);
    scenario.network.starts = 0;
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 0, error, sizeof error));
    uint32_t start;
    scenario.protocol.start = 17;
    TEST_ASSERT_EQUAL_INT(0, campaign_start(&scenario, 0, &nodes, &start, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT32(17, start);
    scenario.protocol.start = 100;
    TEST_ASSERT_EQUAL_INT(-1, campaign_start(&scenario, 0, &nodes, &start, error, sizeof error));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(deployments_are_connected_and_shared_by_ten_starts);
    RUN_TEST(starts_are_spread_over_all_far_nodes);
    RUN_TEST(impossible_ones_are_refused);
    port_exit(UNITY_END() > 0);
    return 0;
}
