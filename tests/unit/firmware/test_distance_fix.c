/* The localisation by distances alone, of sound_fix.h, in either arithmetic. */
#include "motehound/sound_fix.h"
#include "port.h"
#include "unity.h"

#include <math.h>

#define R mh_real_from_float
#define F mh_real_to_float
#define TOLERANCE (MH_REAL_FIXED ? 3e-3f : 1e-3f)

void setUp(void) {}
void tearDown(void) {}

static const struct mh_distance_table table = {MH_REAL(40.0f), 40, MH_DISTANCE_MIDDLE};

static void assert_at(float tolerance, float x, float y, struct mh_vec2 point)
{
    TEST_ASSERT_FLOAT_WITHIN(tolerance, x, F(point.x));
    TEST_ASSERT_FLOAT_WITHIN(tolerance, y, F(point.y));
}

/* What nodes heard, and where the target is by that, computed with 64 bits; the first node is the origin. */
static const struct {
    struct {
        float x, y, energy;
    } heard[6];
    uint8_t count;
    float three_x, three_y, median_x, median_y;
} known[] = {
    {{{0, 0, 5.661283f},
      {-3.232219f, 0.543692f, 5.250398f},
      {16.410204f, 28.894264f, 3.966938f},
      {-33.157829f, 18.429631f, 1.810566f},
      {1.146757f, 52.188557f, 1.299117f},
      {24.980493f, -3.831813f, 1.095736f}},
     6,
     0.360235f,
     16.926731f,
     -2.319457f,
     17.040032f},
    {{{0, 0, 13.28843f},
      {-28.080502f, -0.169693f, 6.072341f},
      {-26.211049f, -9.071769f, 5.910761f},
      {7.857290f, -4.719355f, 4.630811f},
      {0.703865f, -24.458754f, 1.648991f}},
     5,
     -11.171171f,
     -1.331748f,
     -11.000022f,
     1.895841f},
    {{{0, 0, 51.60624f},
      {-24.942515f, 13.194578f, 2.229653f},
      {13.507936f, -23.885769f, 1.695384f},
      {23.081960f, 20.323381f, 1.219923f},
      {-33.848978f, -28.967553f, 1.070277f}},
     5,
     0.853314f,
     4.592328f,
     -4.605310f,
     -1.462642f},
};

static struct mh_heard heard[6];

/* Moved by (x, y). */
static void hear(unsigned i, float x, float y)
{
    for (unsigned k = 0; k < known[i].count; k++) {
        heard[k].place.x = R(known[i].heard[k].x + x);
        heard[k].place.y = R(known[i].heard[k].y + y);
        heard[k].energy = R(known[i].heard[k].energy);
    }
}

/* The origin may be kilometres away. */
static void known_fixes(void)
{
    for (unsigned i = 0; i < sizeof known / sizeof known[0]; i++) {
        for (unsigned far = 0; far < 2; far++) {
            const float x = far ? 9000 : 0, y = far ? -8000 : 0, tolerance = far ? 0.05f : TOLERANCE;
            struct mh_vec2 p;
            hear(i, x, y);
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_distance_fix(heard, known[i].count, &table, MH_CIRCLES_UNIFORM, &p));
            assert_at(tolerance, known[i].three_x + x, known[i].three_y + y, p);
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_median_fix(heard, known[i].count, &table, &p));
            assert_at(tolerance, known[i].median_x + x, known[i].median_y + y, p);
        }
    }
}

static void one_and_two_nodes(void)
{
    struct mh_vec2 p;
    hear(1, 0, 0);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_distance_fix(heard, 1, &table, MH_CIRCLES_CASES, &p));
    assert_at(TOLERANCE, 0, 0, p);
    heard[1].place.x = R(24);
    heard[1].place.y = 0;
    heard[0].energy = heard[1].energy = R(5.0f); /* the same distance to both */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_distance_fix(heard, 2, &table, MH_CIRCLES_UNIFORM, &p));
    assert_at(TOLERANCE, 12, 0, p);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_heard_centroid(heard, 2, &p));
    assert_at(TOLERANCE, 12, 0, p);
}

static void strongest_first(void)
{
    const struct mh_place origin = {900000000, -900000000, 0};
    struct mh_measurement measured[4] = {
        {.value = MH_Q20(2.0f)}, {.value = MH_Q20(9.0f)}, {.value = MH_Q20(-1.0f)}, {.value = MH_Q20(4.0f)}};
    for (int32_t i = 0; i < 4; i++) {
        measured[i].place.x_mm = origin.x_mm + 1000 * i;
        measured[i].place.y_mm = origin.y_mm - 2000 * i;
    }
    TEST_ASSERT_EQUAL_size_t(3, mh_strongest(measured, 4, &origin, heard, 3));
    for (uint8_t i = 0; i < 3; i++) {
        static const float x[] = {1, 3, 0}, energy[] = {9, 4, 2};
        assert_at(1e-4f, x[i], -2 * x[i], heard[i].place);
        TEST_ASSERT_EQUAL_FLOAT(energy[i], F(heard[i].energy));
    }
}

static void errors_leave_the_position_alone(void)
{
    const struct mh_vec2 before = {R(7), R(8)};
    struct mh_vec2 p = before;
    const struct mh_distance_table small = {MH_REAL(0.9f), 8, MH_DISTANCE_MIDDLE};
    const struct mh_distance_table large = {R(MH_REAL_FIXED ? 91.0f : 10001.0f), 8, MH_DISTANCE_MIDDLE};
    hear(0, 0, 0);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_distance_fix(heard, 0, &table, MH_CIRCLES_UNIFORM, &p));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_heard_centroid(heard, 0, &p));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_distance_fix(heard, 3, &small, MH_CIRCLES_UNIFORM, &p));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_median_fix(heard, 5, &large, &p));
    heard[1].place.y = R(MH_REAL_FIXED ? -10001.0f : -1.1e6f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_distance_fix(heard, 3, &table, MH_CIRCLES_UNIFORM, &p));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_heard_centroid(heard, 3, &p));
    heard[1].place.y = R(INFINITY);
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_median_fix(heard, 3, &table, &p));
    hear(0, 0, 0);
    heard[2].energy = R(INFINITY);
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_distance_fix(heard, 3, &table, MH_CIRCLES_CASES, &p));
    TEST_ASSERT_TRUE(p.x == before.x && p.y == before.y);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(known_fixes);
    RUN_TEST(one_and_two_nodes);
    RUN_TEST(strongest_first);
    RUN_TEST(errors_leave_the_position_alone);
    port_exit(UNITY_END() > 0);
    return 0;
}
