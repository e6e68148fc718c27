#include "motehound/followed.h"
#include "port.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

static const struct mh_vec2 still = {0, 0};

static void nothing_is_known_at_first(void)
{
    const struct mh_followed followed = {0};
    struct mh_vec2 position = {MH_REAL(7.0f), MH_REAL(7.0f)};
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_followed_predict(&followed, 5, &position));
    TEST_ASSERT_EQUAL_FLOAT(7.0f, mh_real_to_float(position.x));
    TEST_ASSERT_TRUE(mh_followed_differs(&followed, 5, still, MH_REAL_UPTO(1e9f)));
}

static void goes_on_at_constant_velocity(void)
{
    struct mh_followed followed = {0};
    const struct mh_vec2 position = {MH_REAL(100.0f), MH_REAL(-50.0f)}, velocity = {MH_REAL(4.0f), MH_REAL(-2.0f)};
    const mh_tick before_wrap = UINT32_MAX - 999;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_followed_report(&followed, before_wrap, position, velocity));
    struct mh_vec2 there;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_followed_predict(&followed, before_wrap, &there));
    TEST_ASSERT_EQUAL_FLOAT(100.0f, mh_real_to_float(there.x));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_followed_predict(&followed, 1500, &there)); /* 2.5 s later */
    TEST_ASSERT_EQUAL_FLOAT(110.0f, mh_real_to_float(there.x));
    TEST_ASSERT_EQUAL_FLOAT(-55.0f, mh_real_to_float(there.y));
}

static void tolerance_is_a_distance(void)
{
    struct mh_followed followed = {0};
    const struct mh_vec2 at_5_m = {MH_REAL(3.0f), MH_REAL(4.0f)}, nan = {mh_real_from_float(NAN), 0};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_followed_report(&followed, 0, still, still));
    TEST_ASSERT_FALSE(mh_followed_differs(&followed, 2000, at_5_m, MH_REAL(5.0f)));
    TEST_ASSERT_TRUE(mh_followed_differs(&followed, 2000, at_5_m, MH_REAL(4.999f)));
    TEST_ASSERT_FALSE(mh_followed_differs(&followed, 2000, still, MH_REAL(0.0f)));
    TEST_ASSERT_TRUE(mh_followed_differs(&followed, 2000, at_5_m, MH_REAL(0.0f)));
    TEST_ASSERT_TRUE(mh_followed_differs(&followed, 2000, nan, MH_REAL(5.0f)));
}

static void refuses_what_is_no_report(void)
{
    struct mh_followed followed = {0};
    const struct mh_vec2 nan = {mh_real_from_float(NAN), 0}, infinite = {0, mh_real_from_float(INFINITY)},
                         fast = {MH_REAL_UPTO(3e38f), 0}, there = {MH_REAL(1.0f), MH_REAL(2.0f)};
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_followed_report(&followed, 1000, nan, still));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_followed_report(&followed, 1000, still, infinite));
    TEST_ASSERT_FALSE(followed.known);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_followed_report(&followed, 1000, there, still));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_followed_report(&followed, 999, still, still));
    TEST_ASSERT_EQUAL_FLOAT(1.0f, mh_real_to_float(followed.position.x));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_followed_report(&followed, 1000, there, fast));
    struct mh_vec2 position = {MH_REAL(7.0f), MH_REAL(7.0f)};
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_followed_predict(&followed, 9000, &position));
    TEST_ASSERT_EQUAL_FLOAT(7.0f, mh_real_to_float(position.x));
    TEST_ASSERT_TRUE(mh_followed_differs(&followed, 9000, there, MH_REAL(5.0f)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nothing_is_known_at_first);
    RUN_TEST(goes_on_at_constant_velocity);
    RUN_TEST(tolerance_is_a_distance);
    RUN_TEST(refuses_what_is_no_report);
    port_exit(UNITY_END() > 0);
    return 0;
}
