#include "motehound/distance_table.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static const mh_real range_m = 40;

static mh_real distance(uint8_t intervals, enum mh_distance_mode mode, mh_real energy)
{
    const struct mh_distance_table table = {range_m, intervals, (uint8_t)mode};
    return mh_distance(&table, energy);
}

/* y = n_k belongs to interval k, and what is a little less to the next; for tables in flash (n divides 40) and computed ones */
static void intervals_begin_where_the_distance_says(void)
{
    static const uint8_t sizes[] = {1, 2, 3, 4, 5, 7, 8, 10, 20, 33, 40, 41, 100, 255};
    for (unsigned s = 0; s < sizeof sizes; s++) {
        const uint8_t n = sizes[s];
        for (uint16_t k = 1; k <= n; k++) {
            const mh_real root = (mh_real)n / (mh_real)k;
            TEST_ASSERT_EQUAL_UINT16(k, mh_distance_interval(n, root * root * 1.00001f));
            TEST_ASSERT_EQUAL_UINT16(k + 1, mh_distance_interval(n, root * root * 0.99999f));
        }
        TEST_ASSERT_EQUAL_UINT16(n, mh_distance_interval(n, 1));
        TEST_ASSERT_EQUAL_UINT16(1, mh_distance_interval(n, 1e9f));
    }
}

static void known_answers(void)
{
    static const struct {
        mh_real energy, far_four, four, linear_four, eight, linear_eight, forty, linear_forty, undivided;
    } known[] = {
        {1, 35, 35, 40, 37.5f, 40, 39.5f, 40, 40},
        {1.3f, 35, 35, 36.1428571f, 37.5f, 35.1f, 35.5f, 35.0855634f, 35.0823208f},
        {2, 25, 25, 29, 27.5f, 28.5795455f, 28.5f, 28.2950877f, 28.2842712f},
        {3.99f, 25, 25, 20.045f, 22.5f, 20.0347222f, 20.5f, 20.0268902f, 20.0250470f},
        {4, 15, 15, 20, 17.5f, 20, 19.5f, 20, 20},
        {7, 15, 15, 17.5f, 17.5f, 15.1785714f, 15.5f, 15.1290323f, 15.1185789f},
        {16, 10, 5, 10, 7.5f, 10, 9.5f, 10, 10},
        {64, 10, 5, 2.5f, 2.5f, 5, 4.5f, 5, 5},
        {1600, 10, 5, 0.1f, 2.5f, 0.2f, 0.5f, 1, 1},
    };
    for (unsigned i = 0; i < sizeof known / sizeof known[0]; i++) {
        const mh_real y = known[i].energy;
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].far_four, distance(4, MH_DISTANCE_OUTER, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].four, distance(4, MH_DISTANCE_MIDDLE, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].linear_four, distance(4, MH_DISTANCE_LINEAR, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].eight, distance(8, MH_DISTANCE_MIDDLE, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].linear_eight, distance(8, MH_DISTANCE_LINEAR, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].forty, distance(40, MH_DISTANCE_MIDDLE, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].linear_forty, distance(40, MH_DISTANCE_LINEAR, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].undivided, distance(0, MH_DISTANCE_MIDDLE, y));
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 20.0f / 3, distance(4, MH_DISTANCE_CENTROID, 20));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 15, distance(4, MH_DISTANCE_CENTROID, 10));
}

/* Every mode of every table within one interval of the undivided distance, and never less for less energy; another range is another scale. */
static void a_table_is_off_by_an_interval_at_most(void)
{
    static const uint8_t sizes[] = {1, 4, 7, 40};
    for (unsigned s = 0; s < sizeof sizes; s++) {
        for (uint8_t mode = MH_DISTANCE_OUTER; mode <= MH_DISTANCE_LINEAR; mode++) {
            mh_real before = 0;
            for (mh_real d = 1.05f; d < 40; d += 0.37f) {
                const mh_real energy = range_m * range_m / (d * d);
                const mh_real told = distance(sizes[s], (enum mh_distance_mode)mode, energy);
                TEST_ASSERT_FLOAT_WITHIN(1.0001f * range_m / (mh_real)sizes[s], d, told);
                TEST_ASSERT_TRUE(told >= before);
                const struct mh_distance_table wide = {3 * range_m, sizes[s], mode};
                TEST_ASSERT_FLOAT_WITHIN(1e-5f * 3 * told, 3 * told, mh_distance(&wide, energy));
                before = told;
            }
        }
    }
}

/* A node that hears less than the least is told nothing but the range. */
static void energies_out_of_the_table(void)
{
    for (uint8_t mode = MH_DISTANCE_OUTER; mode <= MH_DISTANCE_LINEAR; mode++) {
        const mh_real low[] = {0.999f, 0.25f, 0, -1e-6f, -5, -1e9f};
        for (unsigned i = 0; i < sizeof low / sizeof low[0]; i++) {
            TEST_ASSERT_EQUAL_FLOAT(range_m, distance(8, (enum mh_distance_mode)mode, low[i]));
            TEST_ASSERT_EQUAL_FLOAT(range_m, distance(0, (enum mh_distance_mode)mode, low[i]));
        }
        TEST_ASSERT_TRUE(mh_within(distance(8, (enum mh_distance_mode)mode, 2047.99f), 0, 5)); /* saturated */
        TEST_ASSERT_TRUE(mh_within(distance(8, (enum mh_distance_mode)mode, 1e9f), 0, 5));
    }
    TEST_ASSERT_EQUAL_FLOAT(1, distance(0, MH_DISTANCE_MIDDLE, 1e9f));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(intervals_begin_where_the_distance_says);
    RUN_TEST(known_answers);
    RUN_TEST(a_table_is_off_by_an_interval_at_most);
    RUN_TEST(energies_out_of_the_table);
    port_exit(UNITY_END() > 0);
    return 0;
}
