#include "port.h"
#include "scenarios.h"
#include "unity.h"
#include "world/deployment.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static char error[300];
static struct deployment nodes;

void setUp(void) { nodes = (struct deployment){0}; }
void tearDown(void) { deployment_free(&nodes); }

static struct scenario of_layout(enum layout_kind layout, int64_t count)
{
    struct scenario scenario = e1();
    scenario.network.layout = layout;
    scenario.network.nodes = count;
    return scenario;
}

/* Every cell of a 4 x 4 division of the field has its share, within `tolerance` of it. */
static void assert_even(double tolerance)
{
    double in_cell[16] = {0};
    for (size_t i = 0; i < nodes.count; i++) {
        TEST_ASSERT_TRUE(nodes.nodes[i].x_m >= 0 && nodes.nodes[i].x_m < 80);
        TEST_ASSERT_TRUE(nodes.nodes[i].y_m >= 0 && nodes.nodes[i].y_m < 80);
        TEST_ASSERT_EQUAL_UINT32(i, nodes.nodes[i].id);
        in_cell[(int)(nodes.nodes[i].x_m / 20) * 4 + (int)(nodes.nodes[i].y_m / 20)]++;
    }
    for (int c = 0; c < 16; c++) {
        TEST_ASSERT_TRUE(fabs(in_cell[c] - (double)nodes.count / 16) <= tolerance);
    }
}

static void uniform(void)
{
    const struct scenario scenario = of_layout(LAYOUT_UNIFORM, 16000);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 3, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(16000, nodes.count);
    assert_even(4 * sqrt(1000.0 * 15 / 16));
    /* SplitMix64 from state 0 begins with 0xE220A8397B1DCDAF, 0x6E789E6AA1B965F4 */
    deployment_free(&nodes);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 0, error, sizeof error));
    TEST_ASSERT_TRUE(fabs(nodes.nodes[0].x_m - 80 * (0xE220A8397B1DCDAFp0 / 0x1p64)) < 1e-12);
    TEST_ASSERT_TRUE(fabs(nodes.nodes[0].y_m - 80 * (0x6E789E6AA1B965F4p0 / 0x1p64)) < 1e-12);
}

static void r2_is_the_sequence_of_the_known_answers(void)
{
    static float places[960][2];
    FILE *file = fopen(MOTEHOUND_KNOWN_ANSWERS "/luo/g2_X.f32", "rb");
    TEST_ASSERT_TRUE(file && fread(places, sizeof places[0], 960, file) == 960);
    fclose(file);
    const struct scenario scenario = of_layout(LAYOUT_R2, 960);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 0, error, sizeof error));
    for (int i = 0; i < 960; i++) {
        TEST_ASSERT_TRUE(fabs(nodes.nodes[i].x_m - (double)places[i][0]) < 1e-5);
        TEST_ASSERT_TRUE(fabs(nodes.nodes[i].y_m - (double)places[i][1]) < 1e-5);
    }
    assert_even(3);
}

static void r2_shifts_with_the_seed(void)
{
    const struct scenario scenario = of_layout(LAYOUT_R2, 100);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 7, error, sizeof error));
    for (int i = 0; i < 100; i++) {
        const double x = 0.5 + (i + 1 + 7000) * 0.7548776662466927, y = 0.5 + (i + 1 + 7000) * 0.5698402909980532;
        TEST_ASSERT_TRUE(fabs(nodes.nodes[i].x_m - 80 * (x - floor(x))) < 1e-9);
        TEST_ASSERT_TRUE(fabs(nodes.nodes[i].y_m - 80 * (y - floor(y))) < 1e-9);
    }
}

static void grid_is_32_by_40(void)
{
    const struct scenario scenario = of_layout(LAYOUT_GRID, 1280);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 0, error, sizeof error));
    for (size_t i = 0; i < 1280; i++) {
        TEST_ASSERT_TRUE(fabs(nodes.nodes[i].x_m - 2.5 * ((double)(i % 32) + 0.5)) < 1e-12);
        TEST_ASSERT_TRUE(fabs(nodes.nodes[i].y_m - 2.0 * ((double)(i / 32) + 0.5)) < 1e-12);
    }
}

static void grid_of_a_prime_number(void)
{
    const struct scenario scenario = of_layout(LAYOUT_GRID, 1279);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 0, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(1279, nodes.count);
    assert_even(16);
}

/* 30 m cells in a field of 35 x 40 of them: the last row is cut short, and each node is uniform in the middle 60 % of its cell. */
static void grid_with_spacing_and_jitter(void)
{
    struct scenario scenario = of_layout(LAYOUT_GRID, 1000);
    scenario.field.width_m = 35 * 30 + 1;
    scenario.field.height_m = 1200;
    scenario.network.spacing_m = 30;
    scenario.network.jitter = 0.3;
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 1, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(1000, nodes.count);
    double sum = 0, squares = 0;
    for (size_t i = 0; i < 1000; i++) {
        const double off[2] = {nodes.nodes[i].x_m / 30 - ((double)(i % 35) + 0.5),
                               nodes.nodes[i].y_m / 30 - ((double)(i / 35) + 0.5)};
        for (int axis = 0; axis < 2; axis++) {
            TEST_ASSERT_TRUE(fabs(off[axis]) <= 0.3);
            sum += off[axis];
            squares += off[axis] * off[axis];
        }
    }
    TEST_ASSERT_TRUE(fabs(sum / 2000) < 4 * 0.3 / sqrt(3 * 2000)); /* mean 0 */
    TEST_ASSERT_TRUE(fabs(squares / 2000 / 0.03 - 1) <
                     4 * sqrt(0.8 / 2000)); /* variance 0.3^2 / 3; that of its square is 0.8 as large */
}

static void file_brings_its_own(void)
{
    static char path[] = "deployment_test_nodes.csv";
    FILE *file = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs("node,x_m,y_m,z_m\n70,1.5,2,0.25\n9,3,4,0\n200,5,6,0\n10,7,8,0\n", file);
    fclose(file);
    struct scenario scenario = of_layout(LAYOUT_FILE, 1280);
    scenario.network.file = path;
    const int result = deployment_make(&nodes, &scenario, 0, error, sizeof error);
    remove(path);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, result, error);
    TEST_ASSERT_EQUAL_UINT(4, nodes.count);
    TEST_ASSERT_EQUAL_UINT32(9, nodes.nodes[0].id);
    TEST_ASSERT_EQUAL_UINT32(70, nodes.nodes[2].id);
    TEST_ASSERT_TRUE(nodes.nodes[2].x_m == 1.5 && nodes.nodes[2].z_m == 0.25);
    TEST_ASSERT_EQUAL_UINT(2, deployment_find(&nodes, 70));
    TEST_ASSERT_EQUAL_UINT(3, deployment_find(&nodes, 200));
    TEST_ASSERT_EQUAL_UINT(4, deployment_find(&nodes, 2)); /* none */
    scenario.network.file = path;
    struct deployment none;
    TEST_ASSERT_EQUAL_INT(-1, deployment_make(&none, &scenario, 0, error, sizeof error));
    TEST_ASSERT_NOT_NULL(strstr(error, path));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(uniform);
    RUN_TEST(r2_is_the_sequence_of_the_known_answers);
    RUN_TEST(r2_shifts_with_the_seed);
    RUN_TEST(grid_is_32_by_40);
    RUN_TEST(grid_of_a_prime_number);
    RUN_TEST(grid_with_spacing_and_jitter);
    RUN_TEST(file_brings_its_own);
    port_exit(UNITY_END() > 0);
    return 0;
}
