#include "motehound/range_model.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

/* 3, 4, 12 and 13 are whole */
static void slant_range_by_hand(void)
{
    const struct mh_vec2 target = {4, -1}, anchor = {1, 3};
    mh_real range;
    struct mh_vec2 gradient;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_range_model(target, anchor, -12, &range, &gradient));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 13, range);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 3.0f / 13.0f, gradient.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -4.0f / 13.0f, gradient.y);
}

static void gradient_is_the_slope(void)
{
    const struct mh_vec2 target = {7, 2}, anchor = {1, -3};
    const mh_real d = 0.01f;
    const struct mh_vec2 right = {7 + d, 2}, left = {7 - d, 2}, up = {7, 2 + d}, down = {7, 2 - d};
    mh_real range, high, low;
    struct mh_vec2 gradient, unused;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_range_model(target, anchor, 2, &range, &gradient));
    mh_range_model(right, anchor, 2, &high, &unused);
    mh_range_model(left, anchor, 2, &low, &unused);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, (high - low) / (2 * d), gradient.x);
    mh_range_model(up, anchor, 2, &high, &unused);
    mh_range_model(down, anchor, 2, &low, &unused);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, (high - low) / (2 * d), gradient.y);
}

static void overhead_there_is_no_slope(void)
{
    const struct mh_vec2 place = {5, 5};
    mh_real range;
    struct mh_vec2 gradient;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_range_model(place, place, 2, &range, &gradient));
    TEST_ASSERT_EQUAL_FLOAT(2, range);
    TEST_ASSERT_EQUAL_FLOAT(0, gradient.x);
    TEST_ASSERT_EQUAL_FLOAT(0, gradient.y);
}

static void bad_input_changes_nothing(void)
{
    const struct mh_vec2 place = {5, 5}, bad = {NAN, 0};
    mh_real range = 77;
    struct mh_vec2 gradient = {78, 79};
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_range_model(place, place, 0, &range, &gradient));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_range_model(bad, place, 0, &range, &gradient));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_range_model(place, place, INFINITY, &range, &gradient));
    TEST_ASSERT_EQUAL_FLOAT(77, range);
    TEST_ASSERT_EQUAL_FLOAT(78, gradient.x);
    TEST_ASSERT_EQUAL_FLOAT(79, gradient.y);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(slant_range_by_hand);
    RUN_TEST(gradient_is_the_slope);
    RUN_TEST(overhead_there_is_no_slope);
    RUN_TEST(bad_input_changes_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
