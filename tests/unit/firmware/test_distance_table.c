#include "motehound/distance_table.h"
#include "port.h"
#include "unity.h"

#define R mh_real_from_float
#define F mh_real_to_float

void setUp(void) {}
void tearDown(void) {}

static const float range_m = 40;

static float distance(uint8_t intervals, enum mh_distance_mode mode, float energy)
{
    const struct mh_distance_table table = {R(range_m), intervals, (uint8_t)mode};
    return F(mh_distance(&table, R(energy)));
}

/* y = n_k belongs to interval k, and what is a little less to the next; for tables in flash (n divides 40) and computed ones */
static void intervals_begin_where_the_distance_says(void)
{
    static const uint8_t sizes[] = {1, 2, 3, 4, 5, 7, 8, 10, 20, 33, 40, 41, 100, 255};
    for (unsigned s = 0; s < sizeof sizes; s++) {
        const uint8_t n = sizes[s];
        for (uint16_t k = 1; k <= n; k++) {
            const float root = (float)n / (float)k;
            /* fixed point: energies are saturated at 32,768, and rounded as the table's are */
            const float off = MH_REAL_FIXED ? 1e-5f + 2e-5f / (root * root) : 1e-5f;
            if (root < 181) {
                TEST_ASSERT_EQUAL_UINT16(k, mh_distance_interval(n, R(root * root * (1 + off))));
                TEST_ASSERT_EQUAL_UINT16(k + 1, mh_distance_interval(n, R(root * root * (1 - off))));
            }
        }
        TEST_ASSERT_EQUAL_UINT16(n, mh_distance_interval(n, R(1)));
        TEST_ASSERT_EQUAL_UINT16(1, mh_distance_interval(n, R(1e9f)));
    }
}

static void known_answers(void)
{
    static const struct {
        float energy, far_four, four, linear_four, eight, linear_eight, forty, linear_forty, undivided;
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
        const float y = known[i].energy;
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].far_four, distance(4, MH_DISTANCE_OUTER, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].four, distance(4, MH_DISTANCE_MIDDLE, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].linear_four, distance(4, MH_DISTANCE_LINEAR, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].eight, distance(8, MH_DISTANCE_MIDDLE, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].linear_eight, distance(8, MH_DISTANCE_LINEAR, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].forty, distance(40, MH_DISTANCE_MIDDLE, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].linear_forty, distance(40, MH_DISTANCE_LINEAR, y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, known[i].undivided, distance(0, MH_DISTANCE_MIDDLE, y));
    }
    TEST_ASSERT_FLOAT_WITHIN(2e-4f, 20.0f / 3, distance(4, MH_DISTANCE_CENTROID, 20));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 15, distance(4, MH_DISTANCE_CENTROID, 10));
}

/* Every mode of every table within one interval of the undivided distance, and never less for less energy; another range is another scale. */
static void a_table_is_off_by_an_interval_at_most(void)
{
    static const uint8_t sizes[] = {1, 4, 7, 40};
    for (unsigned s = 0; s < sizeof sizes; s++) {
        for (uint8_t mode = MH_DISTANCE_OUTER; mode <= MH_DISTANCE_LINEAR; mode++) {
            float before = 0;
            for (float d = 1.05f; d < 40; d += 0.37f) {
                const float energy = range_m * range_m / (d * d);
                const float told = distance(sizes[s], (enum mh_distance_mode)mode, energy);
                TEST_ASSERT_FLOAT_WITHIN(1.0001f * range_m / (float)sizes[s], d, told);
                TEST_ASSERT_TRUE(told >= before);
                const struct mh_distance_table wide = {R(3 * range_m), sizes[s], mode};
                TEST_ASSERT_FLOAT_WITHIN(3e-5f * told + (MH_REAL_FIXED ? 3e-3f : 0), 3 * told,
                                         F(mh_distance(&wide, R(energy))));
                before = told;
            }
        }
    }
}

/* A node that hears less than the least is told nothing but the range. */
static void energies_out_of_the_table(void)
{
    for (uint8_t mode = MH_DISTANCE_OUTER; mode <= MH_DISTANCE_LINEAR; mode++) {
        const float low[] = {0.999f, 0.25f, 0, -1e-6f, -5, -1e9f};
        for (unsigned i = 0; i < sizeof low / sizeof low[0]; i++) {
            TEST_ASSERT_EQUAL_FLOAT(range_m, distance(8, (enum mh_distance_mode)mode, low[i]));
            TEST_ASSERT_EQUAL_FLOAT(range_m, distance(0, (enum mh_distance_mode)mode, low[i]));
        }
        TEST_ASSERT_TRUE(distance(8, (enum mh_distance_mode)mode, 2047.99f) <= 5); /* saturated */
        TEST_ASSERT_TRUE(distance(8, (enum mh_distance_mode)mode, 1e9f) <= 5);
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
