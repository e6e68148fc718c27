#include "motehound/multilateration.h"
#include "port.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static const struct mh_place yard[5] = {{1000000, 2000000, 2000},
                                        {1010000, 2000000, 1000},
                                        {1010000, 2010000, 3000},
                                        {1000000, 2010000, 0},
                                        {1005000, 2004000, 500}};

/* the exact ranges from `anchors` to (x, y) m from the first one, at 1 m above ground */
static void range_all(struct mh_measurement *out, const struct mh_place *anchors, size_t count, mh_real x, mh_real y)
{
    memset(out, 0, count * sizeof *out);
    for (size_t i = 0; i < count; i++) {
        const struct mh_vec2 a = mh_place_relative(&anchors[i], &anchors[0]);
        const mh_real dz = 1.0f - (mh_real)anchors[i].z_mm * 0.001f;
        out[i].node = (mh_node_id)i;
        out[i].place = anchors[i];
        out[i].value = mh_q20_from_real(mh_sqrt((x - a.x) * (x - a.x) + (y - a.y) * (y - a.y) + dz * dz));
    }
}

static void exact_ranges_give_the_place(void)
{
    static const mh_real places[][2] = {{3, 4}, {5, 5}, {0, 0}, {-6, 12}, {25, -18}, {5, 4}};
    struct mh_measurement m[5];
    struct mh_fix fix;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        range_all(m, yard, 5, places[i][0], places[i][1]);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_multilaterate(m, 5, &yard[0], 1.0f, 0.1f, &fix));
        TEST_ASSERT_FLOAT_WITHIN(2e-3f, places[i][0], fix.position.x);
        TEST_ASSERT_FLOAT_WITHIN(2e-3f, places[i][1], fix.position.y);
        TEST_ASSERT_EQUAL_UINT16(5, fix.agreeing);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0, fix.rms_m);
    }
}

/* in the middle of four anchors in the corners the variance of each axis is half that of a range, all in one plane */
static void covariance_of_the_square(void)
{
    struct mh_place flat[4];
    struct mh_measurement m[4];
    struct mh_fix fix;
    for (int i = 0; i < 4; i++) {
        flat[i] = yard[i];
        flat[i].z_mm = 1000;
    }
    range_all(m, flat, 4, 5, 5);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_multilaterate(m, 4, &flat[0], 1.0f, 0.2f, &fix));
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.02f, fix.covariance.xx);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.02f, fix.covariance.yy);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0, fix.covariance.xy);
}

static void one_false_range_of_five(void)
{
    struct mh_measurement m[5];
    struct mh_fix fix;
    for (int wrong = 0; wrong < 5; wrong++) {
        range_all(m, yard, 5, 3, 6);
        m[wrong].value += MH_Q20(4.0f);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_multilaterate(m, 5, &yard[0], 1.0f, 0.1f, &fix));
        TEST_ASSERT_FLOAT_WITHIN(0.1f, 3, fix.position.x);
        TEST_ASSERT_FLOAT_WITHIN(0.1f, 6, fix.position.y);
        TEST_ASSERT_EQUAL_UINT16(4, fix.agreeing);
    }
}

/* three anchors on a line along x: (4, 7) and (4, -7) fit alike, the start towards +y comes first */
static void mirror_image(void)
{
    const struct mh_place line[3] = {{0, 0, 1000}, {6000, 0, 1000}, {12000, 0, 1000}};
    struct mh_measurement m[3];
    struct mh_fix fix;
    range_all(m, line, 3, 4, -7);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_multilaterate(m, 3, &line[0], 1.0f, 0.1f, &fix));
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 4, fix.position.x);
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 7, mh_abs(fix.position.y));
}

static void what_cannot_be_located(void)
{
    struct mh_measurement m[5];
    struct mh_fix fix, before;
    memset(&fix, 0x5a, sizeof fix);
    before = fix;
    range_all(m, yard, 5, 3, 6);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_multilaterate(m, 2, &yard[0], 1.0f, 0.1f, &fix));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_multilaterate(m, 0, &yard[0], 1.0f, 0.1f, &fix));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_multilaterate(m, 5, &yard[0], 1.0f, 0, &fix));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_multilaterate(m, 5, &yard[0], NAN, 0.1f, &fix));
    m[1].value = 0; /* no range */
    m[2].value = -1;
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_multilaterate(m, 4, &yard[0], 1.0f, 0.1f, &fix));
    /* spheres that do not meet */
    range_all(m, yard, 3, 3, 6);
    for (int i = 0; i < 3; i++) {
        m[i].value = MH_Q20(1.5f);
    }
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_multilaterate(m, 3, &yard[0], 1.0f, 0.1f, &fix));
    /* three anchors within 10 cm see a target 50 m away in one direction only */
    const struct mh_place close[3] = {{0, 0, 1000}, {100, 0, 1000}, {0, 100, 1000}};
    range_all(m, close, 3, 30, 40);
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_multilaterate(m, 3, &close[0], 1.0f, 0.1f, &fix));
    TEST_ASSERT_EQUAL_MEMORY(&before, &fix, sizeof fix);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(exact_ranges_give_the_place);
    RUN_TEST(covariance_of_the_square);
    RUN_TEST(one_false_range_of_five);
    RUN_TEST(mirror_image);
    RUN_TEST(what_cannot_be_located);
    port_exit(UNITY_END() > 0);
    return 0;
}
