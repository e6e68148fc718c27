#include "motehound/geometry.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

#define R mh_real_from_float
#define F mh_real_to_float

static void offset_round_trip(void)
{
    const struct mh_place origin = {900000000, -900000000, 5};
    const struct mh_vec2 offset = {R(-12.345f), R(6.789f)};
    const struct mh_place place = mh_place_from_offset(&origin, offset);
    TEST_ASSERT_EQUAL_INT32(899987655, place.x_mm);
    TEST_ASSERT_EQUAL_INT32(-899993211, place.y_mm);
    const struct mh_vec2 back = mh_place_relative(&place, &origin);
    TEST_ASSERT_FLOAT_WITHIN(0.0006f, F(offset.x), F(back.x));
    TEST_ASSERT_FLOAT_WITHIN(0.0006f, F(offset.y), F(back.y));
}

static void places_stay_on_the_map(void)
{
    const struct mh_place origin = {999980000, -999980000, 0}; /* 20 km from the border */
    const struct mh_vec2 offsets[] = {
        {R(3e4f), R(-3e4f)}, {R(3e6f), R(-3e6f)}, {R(1e38f), R(-1e38f)}, {R(INFINITY), R(-INFINITY)}};
    for (uint8_t i = 0; i < 4; i++) {
        const struct mh_place place = mh_place_from_offset(&origin, offsets[i]);
        TEST_ASSERT_EQUAL_INT32(MH_COORDINATE_MAX_MM, place.x_mm);
        TEST_ASSERT_EQUAL_INT32(-MH_COORDINATE_MAX_MM, place.y_mm);
    }
#if !MH_REAL_FIXED
    const struct mh_vec2 across = {-1.99999e6f, 1.99999e6f};
    const struct mh_place place = mh_place_from_offset(&origin, across);
    TEST_ASSERT_EQUAL_INT32(-MH_COORDINATE_MAX_MM, place.x_mm);
    TEST_ASSERT_EQUAL_INT32(MH_COORDINATE_MAX_MM, place.y_mm);
#endif
    TEST_ASSERT_TRUE(mh_coordinate_valid(MH_COORDINATE_MAX_MM));
    TEST_ASSERT_FALSE(mh_coordinate_valid(-MH_COORDINATE_MAX_MM - 1));
}

/* all remainders of what it divides by, near, far, and beyond what a real holds */
static void metres(void)
{
    const int32_t near[] = {0, -100, 1000000, -20000000, 32767900, 32767999, -32767999, 40000000, INT32_MAX, INT32_MIN};
    for (uint8_t i = 0; i < sizeof near / sizeof near[0]; i++) {
        for (int16_t k = 0; k <= 130; k++) {
            const int32_t mm = near[i] > 0 ? near[i] - k : near[i] + k;
            TEST_ASSERT_TRUE(mh_metres(mm) == mh_real_from_ratio(mm, 1000));
        }
    }
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
    RUN_TEST(metres);
    RUN_TEST(within_includes_the_border);
    RUN_TEST(roots_and_distances_are_rounded_down);
    port_exit(UNITY_END() > 0);
    return 0;
}
