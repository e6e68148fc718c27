/* The published answers of the recipe for lambda 12, 10 mph and seed 1, and what its numbers are by definition. */
#include "port.h"
#include "scenarios.h"
#include "unity.h"
#include "world/deployment.h"
#include "world/mobility.h"
#include "world/ranging.h"
#include "world/recipe.h"

#include <math.h>
#include <stdlib.h>

static char error[300];
static struct scenario scenario;

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    walk_among_nodes(&scenario);
}

void tearDown(void) { scenario_free(&scenario); }

static void assert_near(double expected, double actual) { TEST_ASSERT_TRUE(fabs(expected - actual) <= 1e-6); }

static void numbers(void)
{
    TEST_ASSERT_TRUE(recipe_hash(1, 1, 0) == UINT64_C(0x9EDBE9BD18AD781D));
    TEST_ASSERT_TRUE(fabs(recipe_uniform(1, 1, 0) - 0.620543106714356) < 1e-15);
    TEST_ASSERT_TRUE(fabs(recipe_normal(1, 4, 1) - 0.300014067397841) < 1e-14);
    TEST_ASSERT_TRUE(fabs(recipe_normal(1, RECIPE_RANGE_NOISE + 7, 42) - 1.234403059410361) < 1e-14);
}

static void field_and_nodes(void)
{
    static const double sides[][2] = {{8, 990.832}, {12, 809.010797}, {16, 700.624}, {24, 572.057}};
    for (size_t i = 0; i < 4; i++) {
        scenario.network.density = sides[i][0];
        const struct scenario_field field = scenario_field(&scenario);
        TEST_ASSERT_TRUE(fabs(field.width_m - sides[i][1]) < 5e-4);
        TEST_ASSERT_TRUE(field.height_m == field.width_m);
        TEST_ASSERT_TRUE(field.sink_x_m == field.width_m / 2 && field.sink_y_m == field.width_m / 2);
    }
    struct deployment nodes;
    scenario.network.density = 12;
    assert_near(809.010797, scenario_field(&scenario).width_m);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 1, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(1000, nodes.count);
    assert_near(502.026073273, nodes.nodes[0].x_m);
    assert_near(196.156060127, nodes.nodes[0].y_m);
    assert_near(197.409597592, nodes.nodes[999].x_m);
    assert_near(591.462976362, nodes.nodes[999].y_m);
    deployment_free(&nodes);
}

/* Without a density the same numbers fill the field of the scenario. */
static void a_field_of_its_own(void)
{
    struct deployment nodes;
    scenario.network.density = 0;
    scenario.field.width_m = 300;
    scenario.field.height_m = 200;
    scenario.network.sink_x_m = 7;
    scenario.network.sink_y_m = 9;
    const struct scenario_field field = scenario_field(&scenario);
    TEST_ASSERT_TRUE(field.width_m == 300 && field.height_m == 200 && field.sink_x_m == 7 && field.sink_y_m == 9);
    TEST_ASSERT_EQUAL_INT(0, deployment_make(&nodes, &scenario, 1, error, sizeof error));
    assert_near(300 * 0.620543106714356, nodes.nodes[0].x_m);
    assert_near(200 * recipe_uniform(1, RECIPE_NODE_Y, 0), nodes.nodes[0].y_m);
    deployment_free(&nodes);
}

static const struct {
    size_t step;
    struct point place;
} on_path[] = {{0, {610.004451752, 756.698232349}},
               {10, {539.397139492, 709.375505133}},
               {100, {96.790869464, 326.509100122}},
               {3600, {551.228905286, 501.430038866}}};

static void walk(void)
{
    const struct mobility mobility = mobility_of(&scenario);
    struct point places[3601];
    mobility_positions(&mobility, 1, 3600, places);
    for (size_t i = 0; i < sizeof on_path / sizeof on_path[0]; i++) {
        assert_near(on_path[i].place.x_m, places[on_path[i].step].x_m);
        assert_near(on_path[i].place.y_m, places[on_path[i].step].y_m);
    }
    const double side = scenario_field(&scenario).width_m, longest = MOBILITY_FASTEST * mobility.speed_mps * 2;
    for (size_t n = 1; n <= 3600; n++) {
        TEST_ASSERT_TRUE(places[n].x_m >= 50 && places[n].x_m <= side - 50);
        TEST_ASSERT_TRUE(places[n].y_m >= 50 && places[n].y_m <= side - 50);
        TEST_ASSERT_TRUE(hypot(places[n].x_m - places[n - 1].x_m, places[n].y_m - places[n - 1].y_m) <= longest + 1e-9);
    }
}

/* The path is at the walk's places at the samples, half way between them half way, and ends with the last. */
static void path(void)
{
    struct trajectory path;
    struct point places[3601];
    const struct mobility mobility = mobility_of(&scenario);
    mobility_positions(&mobility, 1, 3600, places);
    TEST_ASSERT_EQUAL_INT(0, trajectory_make(&path, &scenario, 1, error, sizeof error));
    TEST_ASSERT_TRUE(path.duration_s == 7200);
    for (size_t n = 0; n <= 3600; n++) {
        const struct point at = trajectory_position(&path, 2.0 * (double)n);
        TEST_ASSERT_TRUE(fabs(at.x_m - places[n].x_m) < 1e-9 && fabs(at.y_m - places[n].y_m) < 1e-9);
        if (n < 3600) {
            const struct point between = trajectory_position(&path, 2.0 * (double)n + 1);
            TEST_ASSERT_TRUE(fabs(between.x_m - (places[n].x_m + places[n + 1].x_m) / 2) < 1e-9);
            TEST_ASSERT_TRUE(fabs(between.y_m - (places[n].y_m + places[n + 1].y_m) / 2) < 1e-9);
        }
    }
    const struct point beyond = trajectory_position(&path, 8000);
    TEST_ASSERT_TRUE(fabs(beyond.x_m - places[3600].x_m) < 1e-9);
    trajectory_free(&path);
}

/* Without memory each step's speed is drawn anew; the spread of the heading is what was asked for either way: the differences of headings k
 * steps apart have the variance 2 sd^2 (1 - alpha^k). */
static void heading_keeps_its_spread(void)
{
    enum { STEPS = 20000 };
    static struct point places[STEPS + 1];
    const double memories[] = {0, 0.9};
    for (size_t m = 0; m < 2; m++) {
        const struct mobility mobility = {.width_m = 1e7,
                                          .height_m = 1e7,
                                          .margin_m = 50,
                                          .interval_s = 2,
                                          .speed_mps = 4,
                                          .speed_sd_mps = 0.8,
                                          .heading_sd_rad = 0.3,
                                          .memory = memories[m]};
        mobility_positions(&mobility, 5, STEPS, places);
        double sum = 0;
        int count = 0;
        for (size_t n = 1; n + 10 < STEPS; n++, count++) {
            const double a = atan2(places[n].y_m - places[n - 1].y_m, places[n].x_m - places[n - 1].x_m);
            const double b = atan2(places[n + 10].y_m - places[n + 9].y_m, places[n + 10].x_m - places[n + 9].x_m);
            const double turn = remainder(b - a, 2 * 3.141592653589793);
            sum += turn * turn;
        }
        const double expected = 2 * 0.09 * (1 - pow(memories[m], 10));
        TEST_ASSERT_TRUE(fabs(sum / count - expected) < 0.06 * expected);
    }
}

static void detection(void)
{
    struct ranging ranging = ranging_of(&scenario, NULL, 1);
    double range = -1;
    TEST_ASSERT_TRUE(ranging_detects(&ranging, 7, 42, 50, &range));
    assert_near(50 + 5 * 1.234403059410361, range);
    range = -1;
    TEST_ASSERT_FALSE(ranging_detects(&ranging, 7, 42, 50.001, &range));
    TEST_ASSERT_TRUE(range == -1);
    ranging.noisy = true;
    TEST_ASSERT_FALSE(ranging_detects(&ranging, 7, 42, 49, &range)); /* 55.2 */
    TEST_ASSERT_TRUE(ranging_detects(&ranging, 7, 42, 43.8, &range));
    assert_near(43.8 + 5 * 1.234403059410361, range);
    ranging.noise_m = 0;
    ranging.noisy = false;
    TEST_ASSERT_TRUE(ranging_detects(&ranging, 7, 42, 12.5, &range));
    TEST_ASSERT_TRUE(range == 12.5);
}

/* Near the target about half of the ranges are negative, and of those far beyond the range some are detected by their noise. */
static void ranges_are_what_the_noise_makes_them(void)
{
    struct ranging ranging = ranging_of(&scenario, NULL, 3);
    int negative = 0, heard = 0;
    double sum = 0, squares = 0;
    ranging.noisy = true;
    for (uint32_t i = 0; i < 10000; i++) {
        double range = 0;
        TEST_ASSERT_TRUE(ranging_detects(&ranging, 11, i, 0, &range));
        negative += range < 0;
        sum += range;
        squares += range * range;
        heard += ranging_detects(&ranging, 11, i, 55, &range);
    }
    TEST_ASSERT_TRUE(abs(negative - 5000) < 4 * 50);
    TEST_ASSERT_TRUE(fabs(sum / 10000) < 4 * 0.05);
    TEST_ASSERT_TRUE(fabs(sqrt(squares / 10000) - 5) < 4 * 0.036);
    TEST_ASSERT_TRUE(abs(heard - 1587) < 4 * 37); /* one standard deviation */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(numbers);
    RUN_TEST(field_and_nodes);
    RUN_TEST(a_field_of_its_own);
    RUN_TEST(walk);
    RUN_TEST(path);
    RUN_TEST(heading_keeps_its_spread);
    RUN_TEST(detection);
    RUN_TEST(ranges_are_what_the_noise_makes_them);
    port_exit(UNITY_END() > 0);
}
