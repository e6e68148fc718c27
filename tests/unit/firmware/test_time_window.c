#include "motehound/time_window.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void a_node_beside_the_path(void)
{
    const struct mh_vec2 node = {100, 24}, velocity = {10, 0}; /* half a chord: sqrt(40^2 - 24^2) = 32 */
    struct mh_time_window window;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_time_window(node, velocity, 40, &window));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 6.8f, window.in);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 13.2f, window.out);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 10.0f, window.closest_s);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 24.0f, window.closest_m);
}

/* At the edge of its window a node is just one radius from the target, however the path runs. */
static void edges_are_one_radius_away(void)
{
    for (int i = 0; i < 24; i++) {
        const mh_real angle = MH_PI * (mh_real)(i - 12) / 12.0f;
        const struct mh_vec2 u = mh_direction(angle), velocity = {7 * u.x, 7 * u.y}, node = {-15, 30};
        struct mh_time_window window;
        if (mh_time_window(node, velocity, 25, &window) != MH_OK) {
            TEST_ASSERT_GREATER_THAN_FLOAT(25.0f - 1e-3f, mh_abs(node.x * u.y - node.y * u.x));
            continue;
        }
        const mh_real edges[2] = {window.in, window.out};
        for (int j = 0; j < 2; j++) {
            const mh_real x = node.x - velocity.x * edges[j], y = node.y - velocity.y * edges[j];
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, 25.0f, mh_sqrt(x * x + y * y));
        }
        TEST_ASSERT_TRUE(window.in <= window.out);
    }
}

static void what_has_no_window(void)
{
    const struct mh_vec2 node = {100, 40}, velocity = {10, 0}, rest = {0, 0}, bad = {NAN, 0};
    struct mh_time_window window = {-1, -1, -1, -1};
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_time_window(node, velocity, 40, &window)); /* it touches the circle */
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_time_window(node, rest, 40, &window));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_time_window(bad, velocity, 40, &window));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_time_window(node, bad, 40, &window));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_time_window(node, velocity, 0, &window));
    TEST_ASSERT_EQUAL_FLOAT(-1, window.in);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_node_beside_the_path);
    RUN_TEST(edges_are_one_radius_away);
    RUN_TEST(what_has_no_window);
    port_exit(UNITY_END() > 0);
}
