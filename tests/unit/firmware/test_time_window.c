#include "motehound/time_window.h"
#include "port.h"
#include "unity.h"

#include <math.h>

#if MH_REAL_FIXED
#define RESOLUTION (1.0f / 65536)
#else
#define RESOLUTION 0
#endif
#define RADIUS MH_REAL(40.0f)

void setUp(void) {}
void tearDown(void) {}

static void a_node_beside_the_path(void)
{
    const struct mh_vec2 node = {MH_REAL(100.0f), MH_REAL(24.0f)},
                         velocity = {MH_REAL(10.0f), 0}; /* half a chord: sqrt(40^2 - 24^2) = 32 */
    struct mh_time_window window;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_time_window(node, velocity, RADIUS, &window));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f + 2 * RESOLUTION, 6.8f, mh_real_to_float(window.in));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f + 2 * RESOLUTION, 13.2f, mh_real_to_float(window.out));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f + 2 * RESOLUTION, 10.0f, mh_real_to_float(window.closest_s));
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 24.0f, mh_real_to_float(window.closest_m));
}

/* At the edge of its window a node is just one radius from the target, however the path runs. */
static void edges_are_one_radius_away(void)
{
    for (int i = 0; i < 24; i++) {
        const mh_real angle = mh_mul(MH_PI, mh_real_from_ratio(i - 12, 12));
        const struct mh_vec2 u = mh_direction(angle), velocity = {7 * u.x, 7 * u.y},
                             node = {MH_REAL(-15.0f), MH_REAL(30.0f)};
        struct mh_time_window window;
        if (mh_time_window(node, velocity, MH_REAL(25.0f), &window) != MH_OK) {
            TEST_ASSERT_GREATER_THAN_FLOAT(25.0f - 1e-3f,
                                           mh_real_to_float(mh_abs(mh_mul(node.x, u.y) - mh_mul(node.y, u.x))));
            continue;
        }
        const mh_real edges[2] = {window.in, window.out};
        for (int j = 0; j < 2; j++) {
            const struct mh_vec2 away = mh_vec2_along(node, -edges[j], velocity);
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, 25.0f, mh_real_to_float(mh_vec2_length(away)));
        }
        TEST_ASSERT_TRUE(window.in <= window.out);
    }
}

static void what_has_no_window(void)
{
    const struct mh_vec2 node = {MH_REAL(100.0f), RADIUS}, velocity = {MH_REAL(10.0f), 0}, rest = {0, 0},
                         bad = {mh_real_from_float(NAN), 0};
    struct mh_time_window window = {MH_REAL(-1.0f), 0, 0, 0};
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_time_window(node, velocity, RADIUS, &window)); /* it touches the circle */
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_time_window(node, rest, RADIUS, &window));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_time_window(bad, velocity, RADIUS, &window));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_time_window(node, bad, RADIUS, &window));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_time_window(node, velocity, 0, &window));
    TEST_ASSERT_EQUAL_FLOAT(-1.0f, mh_real_to_float(window.in));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_node_beside_the_path);
    RUN_TEST(edges_are_one_radius_away);
    RUN_TEST(what_has_no_window);
    port_exit(UNITY_END() > 0);
}
