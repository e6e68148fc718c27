#include "motehound/least_squares.h"
#include "port.h"
#include "reals.h"

void setUp(void) {}
void tearDown(void) {}

static enum mh_status add(struct mh_least_squares *problem, float a, float b, float right)
{
    const mh_real row[2] = {mh_real_from_float(a), mh_real_from_float(b)};
    return mh_least_squares_add(problem, row, mh_real_from_float(right));
}

static void take(struct mh_least_squares *problem, float a, float b, float right)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, add(problem, a, b, right));
}

static mh_real z[2];
static enum mh_bound bound;

static enum mh_status solve(const struct mh_least_squares *problem, float low, float high)
{
    return mh_least_squares_solve(problem, mh_real_from_float(low), mh_real_from_float(high), z, &bound);
}

/* A line through (0, 0), (1, 1), (2, 3), (3, 4): intercept -0.1, slope 1.4 by the textbook's formulas. */
static void line_through_points(struct mh_least_squares *problem)
{
    mh_least_squares_begin(problem, 2);
    take(problem, 1, 0, 0);
    take(problem, 1, 1, 1);
    take(problem, 1, 2, 3);
    take(problem, 1, 3, 4);
}

static void free_minimum(void)
{
    struct mh_least_squares problem;
    line_through_points(&problem);
    TEST_ASSERT_EQUAL_INT(MH_OK, solve(&problem, -10, 10));
    EXPECT_REAL(1e-6f, 2e-5f, -0.1f, z[0]);
    EXPECT_REAL(1e-6f, 2e-5f, 1.4f, z[1]);
    TEST_ASSERT_EQUAL_INT(MH_BOUND_NONE, bound);
}

#if !MH_REAL_FIXED
/* The line through the points leaves 0.1, -0.3, 0.3, -0.1, of which two rows, as many as there are unknowns, leave nothing when they come. */
static void what_rows_leave(void)
{
    struct mh_least_squares problem;
    mh_real square = 0;
    mh_least_squares_begin(&problem, 2);
    for (uint8_t i = 0; i < 4; i++) {
        static const float rights[] = {0, 1, 3, 4};
        take(&problem, 1, i, rights[i]);
        square += mh_squared(problem.left);
        if (i == 1) {
            TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, square);
        }
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.2f, square);
}
#endif

/* With the slope on a bound the best intercept is the mean of y - slope x. */
static void bounded_minimum(void)
{
    struct mh_least_squares problem;
    line_through_points(&problem);
    TEST_ASSERT_EQUAL_INT(MH_OK, solve(&problem, 0, 1));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_HIGH, bound);
    EXPECT_REAL(0, 0, 1, z[1]);
    EXPECT_REAL(1e-6f, 2e-5f, 0.5f, z[0]);
    TEST_ASSERT_EQUAL_INT(MH_OK, solve(&problem, 2, 3));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_LOW, bound);
    EXPECT_REAL(0, 0, 2, z[1]);
    EXPECT_REAL(1e-6f, 2e-5f, -1.0f, z[0]);
}

static void rank(void)
{
    struct mh_least_squares problem;
    z[0] = z[1] = MH_REAL(7.0f);
    mh_least_squares_begin(&problem, 2);
    take(&problem, 1, 2, 3);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, solve(&problem, 0, 1));
    /* the columns are parallel: the last unknown takes its upper bound, the other one fits the rest */
    take(&problem, 2, 4, 6);
    EXPECT_REAL(0, 0, 7, z[0]);
    TEST_ASSERT_EQUAL_INT(MH_OK, solve(&problem, 0, 1));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_HIGH, bound);
    EXPECT_REAL(0, 0, 1, z[1]);
    EXPECT_REAL(1e-6f, 2e-5f, 1, z[0]);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, solve(&problem, 1, 0));
#if !MH_REAL_FIXED
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, solve(&problem, 0, NAN));
#endif
    /* a first column of zeros */
    mh_least_squares_begin(&problem, 2);
    take(&problem, 0, 1, 1);
    take(&problem, 0, 2, 1);
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, solve(&problem, 0, 1));
}

static void a_solution_that_is_not_finite_is_none(void)
{
    struct mh_least_squares problem;
    z[0] = z[1] = MH_REAL(7.0f);
    mh_least_squares_begin(&problem, 2);
    take(&problem, FLOAT_FIXED(1e-30f, 1e-3f), 0, FLOAT_FIXED(1e15f, 3e4f)); /* z = 1e45, or 3e7 */
    take(&problem, 0, 1, 1);
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, solve(&problem, 0, 2));
    mh_least_squares_begin(&problem, 2);
    take(&problem, 1, 2, 3);
    take(&problem, 2, 4, 6); /* undetermined, and no bound to put it on */
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, solve(&problem, 0, INFINITY));
    EXPECT_REAL(0, 0, 7, z[0]);
    EXPECT_REAL(0, 0, 7, z[1]);
}

static void bad_rows_change_nothing(void)
{
    struct mh_least_squares problem;
    line_through_points(&problem);
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, add(&problem, 1, NAN, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, add(&problem, INFINITY, 1, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, add(&problem, 1, 1, -INFINITY));
    TEST_ASSERT_EQUAL_INT(FLOAT_FIXED(MH_ERR_RANGE, MH_ERR_NOT_FINITE), add(&problem, 1, 1e16f, 1));
    TEST_ASSERT_EQUAL_UINT16(4, problem.rows);
    TEST_ASSERT_EQUAL_INT(MH_OK, solve(&problem, -10, 10));
    EXPECT_REAL(1e-6f, 2e-5f, 1.4f, z[1]);
}

/* Rows whose sums are larger and larger, to the ends of both formats: the line y = 2 + 0.5 x through 3,000 points, then far away. A fixed-point factor
 * gives up fractional bits instead of wrapping. */
static void many_large_rows(void)
{
    struct mh_least_squares problem;
    mh_least_squares_begin(&problem, 2);
    for (uint16_t i = 0; i < 3000; i++) {
        const float x = (float)(i % 100) - 49.5f;
        take(&problem, 1, x, 2 + 0.5f * x);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, solve(&problem, -10, 10));
    EXPECT_REAL(1e-5f, 2e-5f, 2, z[0]);
    EXPECT_REAL(1e-5f, 2e-5f, 0.5f, z[1]);
    for (uint16_t i = 0; i < 1000; i++) {
        const float x = (float)i * 32;
        take(&problem, 1, x, 2 + 0.5f * x);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, solve(&problem, -10, 10));
    EXPECT_REAL(2e-3f, 0.1f, 2, z[0]); /* 2^-17 in the slope, at the mean x of 12,000 */
    EXPECT_REAL(1e-6f, 2e-5f, 0.5f, z[1]);
    TEST_ASSERT_EQUAL_UINT16(4000, problem.rows);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(free_minimum);
#if !MH_REAL_FIXED
    RUN_TEST(what_rows_leave);
#endif
    RUN_TEST(bounded_minimum);
    RUN_TEST(rank);
    RUN_TEST(a_solution_that_is_not_finite_is_none);
    RUN_TEST(many_large_rows);
    RUN_TEST(bad_rows_change_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
