#include "port.h"
#include "scenarios.h"
#include "unity.h"
#include "world/trajectory.h"

#include <math.h>

#define ASSERT_NEAR(expected, actual, tolerance) TEST_ASSERT_TRUE(fabs((expected) - (actual)) <= (tolerance))

static char error[200];
static struct trajectory path;

void setUp(void) { path = (struct trajectory){0}; }
void tearDown(void) { trajectory_free(&path); }

static void two_arcs(void)
{
    const struct scenario scenario = e1();
    TEST_ASSERT_EQUAL_INT(0, trajectory_make(&path, &scenario, 0, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(2, path.count);
    ASSERT_NEAR(96.3706, trajectory_length_m(&path), 5e-5);
    ASSERT_NEAR(96.3706, path.duration_s, 5e-5);
    ASSERT_NEAR(30.6757, 1 / path.legs[0].curvature_radpm, 5e-5);
    const struct point start = trajectory_position(&path, 0), middle = trajectory_position(&path, path.duration_s / 2),
                       end = trajectory_position(&path, path.duration_s), after = trajectory_position(&path, 1e6);
    ASSERT_NEAR(0, start.x_m, 1e-12);
    ASSERT_NEAR(0, start.y_m, 1e-12);
    ASSERT_NEAR(19, middle.x_m, 1e-9); /* the arcs meet half way */
    ASSERT_NEAR(39, middle.y_m, 1e-9);
    ASSERT_NEAR(38, end.x_m, 1e-9);
    ASSERT_NEAR(78, end.y_m, 1e-9);
    ASSERT_NEAR(38, after.x_m, 1e-9);
}

static void arcs_keep_their_distance_from_their_centre(void)
{
    const struct scenario scenario = e1();
    TEST_ASSERT_EQUAL_INT(0, trajectory_make(&path, &scenario, 0, error, sizeof error));
    const double radius = 1 / path.legs[0].curvature_radpm, heading = path.legs[0].heading_rad;
    const struct point centre = {-radius * sin(heading), radius * cos(heading)}; /* left of the start */
    for (double t = 0; t < path.legs[0].duration_s; t += 1) {
        const struct point p = trajectory_position(&path, t);
        ASSERT_NEAR(radius, hypot(p.x_m - centre.x_m, p.y_m - centre.y_m), 1e-9);
        const struct point q = trajectory_position(&path, t + 1e-6), v = trajectory_velocity(&path, t);
        ASSERT_NEAR((q.x_m - p.x_m) * 1e6, v.x_m, 1e-6);
        ASSERT_NEAR((q.y_m - p.y_m) * 1e6, v.y_m, 1e-6);
    }
    const struct point gone = trajectory_velocity(&path, path.duration_s + 1);
    ASSERT_NEAR(0, hypot(gone.x_m, gone.y_m), 0);
}

static void waypoints(void)
{
    const struct scenario scenario = e2();
    TEST_ASSERT_EQUAL_INT(0, trajectory_make(&path, &scenario, 0, error, sizeof error));
    ASSERT_NEAR(133.612, trajectory_length_m(&path), 5e-4);
    ASSERT_NEAR(125.375, path.duration_s, 5e-4);
    for (unsigned i = 1; i < scenario.source.points_count; i++) {
        const struct point p = trajectory_position(&path, path.legs[i - 1].start_s + path.legs[i - 1].duration_s);
        ASSERT_NEAR(scenario.source.points[i].x_m, p.x_m, 1e-9);
        ASSERT_NEAR(scenario.source.points[i].y_m, p.y_m, 1e-9);
    }
}

static void speed_is_that_of_the_leg(void)
{
    struct scenario scenario = e2();
    scenario.source.speed_mps = 0.5;
    TEST_ASSERT_EQUAL_INT(0, trajectory_make(&path, &scenario, 0, error, sizeof error));
    ASSERT_NEAR(2 * 125.375, path.duration_s, 1e-3);
    for (unsigned i = 0; i < path.count; i++) {
        const double t = path.legs[i].start_s + 0.3 * path.legs[i].duration_s;
        const struct point a = trajectory_position(&path, t), b = trajectory_position(&path, t + 0.25);
        ASSERT_NEAR(0.25 * 0.5 * scenario.source.points[i + 1].speed_factor, hypot(b.x_m - a.x_m, b.y_m - a.y_m), 1e-9);
    }
}

static void still(void)
{
    struct scenario scenario = e2();
    scenario.source.path = PATH_STILL;
    scenario.source.duration_s = 50;
    TEST_ASSERT_EQUAL_INT(0, trajectory_make(&path, &scenario, 0, error, sizeof error));
    ASSERT_NEAR(50, path.duration_s, 0);
    ASSERT_NEAR(0, trajectory_length_m(&path), 0);
    const struct point p = trajectory_position(&path, 20);
    ASSERT_NEAR(1, p.x_m, 0);
    ASSERT_NEAR(1, p.y_m, 0);
}

static void refuses_what_is_no_path(void)
{
    struct scenario scenario = e1();
    scenario.source.points_count = 1;
    TEST_ASSERT_EQUAL_INT(-1, trajectory_make(&path, &scenario, 0, error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("source.points: 1 given, the path needs at least 2", error);
    scenario = e2();
    scenario.source.speed_mps = 0;
    TEST_ASSERT_EQUAL_INT(-1, trajectory_make(&path, &scenario, 0, error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("source.speed_mps: 0, expected a speed above 0", error);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(two_arcs);
    RUN_TEST(arcs_keep_their_distance_from_their_centre);
    RUN_TEST(waypoints);
    RUN_TEST(speed_is_that_of_the_leg);
    RUN_TEST(still);
    RUN_TEST(refuses_what_is_no_path);
    port_exit(UNITY_END() > 0);
    return 0;
}
