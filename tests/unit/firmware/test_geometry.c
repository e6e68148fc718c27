#include "motehound/geometry.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void offset_round_trip(void)
{
    const struct mh_place origin = {900000000, -900000000, 5};
    const struct mh_vec2 offset = {-12.345f, 6.789f};
    const struct mh_place place = mh_place_from_offset(&origin, offset);
    TEST_ASSERT_EQUAL_INT32(899987655, place.x_mm);
    TEST_ASSERT_EQUAL_INT32(-899993211, place.y_mm);
    const struct mh_vec2 back = mh_place_relative(&place, &origin);
    TEST_ASSERT_FLOAT_WITHIN(0.0006f, offset.x, back.x);
    TEST_ASSERT_FLOAT_WITHIN(0.0006f, offset.y, back.y);
}

static void places_stay_on_the_map(void)
{
    const struct mh_place origin = {900000000, -900000000, 0};
    const struct mh_vec2 offsets[] = {{2e5f, -2e5f}, {3e6f, -3e6f}, {1e38f, -1e38f}, {INFINITY, -INFINITY}};
    for (uint8_t i = 0; i < 4; i++) {
        const struct mh_place place = mh_place_from_offset(&origin, offsets[i]);
        TEST_ASSERT_EQUAL_INT32(MH_COORDINATE_MAX_MM, place.x_mm);
        TEST_ASSERT_EQUAL_INT32(-MH_COORDINATE_MAX_MM, place.y_mm);
    }
    const struct mh_vec2 across = {-1.9e6f, 1.9e6f};
    const struct mh_place place = mh_place_from_offset(&origin, across);
    TEST_ASSERT_EQUAL_INT32(-MH_COORDINATE_MAX_MM, place.x_mm);
    TEST_ASSERT_EQUAL_INT32(MH_COORDINATE_MAX_MM, place.y_mm);
    TEST_ASSERT_TRUE(mh_coordinate_valid(MH_COORDINATE_MAX_MM));
    TEST_ASSERT_FALSE(mh_coordinate_valid(-MH_COORDINATE_MAX_MM - 1));
}

static void within_includes_the_border(void)
{
    const struct mh_place a = {0, 0, 0}, b = {3000, 4000, 99999};
    TEST_ASSERT_TRUE(mh_place_within(&a, &b, 5000));
    TEST_ASSERT_FALSE(mh_place_within(&a, &b, 4999));
}

static void roots_and_distances_are_rounded_down(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, mh_square_root(0));
    TEST_ASSERT_EQUAL_UINT32(1, mh_square_root(3));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, mh_square_root(UINT64_MAX));
    for (uint32_t root = 1; root < 4000000000u - root / 3; root += root / 3 + 1) {
        const uint64_t square = (uint64_t)root * root;
        TEST_ASSERT_EQUAL_UINT32(root, mh_square_root(square));
        TEST_ASSERT_EQUAL_UINT32(root - 1, mh_square_root(square - 1));
    }
    const struct mh_place a = {-1000000000, -1000000000, 0}, b = {1000000000, 1000000000, 5};
    TEST_ASSERT_EQUAL_UINT32(2828427124u, mh_place_distance_mm(&a, &b));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(offset_round_trip);
    RUN_TEST(places_stay_on_the_map);
    RUN_TEST(within_includes_the_border);
    RUN_TEST(roots_and_distances_are_rounded_down);
    port_exit(UNITY_END() > 0);
    return 0;
}
