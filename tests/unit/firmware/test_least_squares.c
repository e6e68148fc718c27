#include "motehound/least_squares.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void add(struct mh_least_squares *problem, mh_real a, mh_real b, mh_real right)
{
    const mh_real row[2] = {a, b};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_least_squares_add(problem, row, right));
}

/* A line through (0, 0), (1, 1), (2, 3), (3, 4): intercept -0.1, slope 1.4 by the textbook's formulas. */
static void line_through_points(struct mh_least_squares *problem)
{
    mh_least_squares_begin(problem, 2);
    add(problem, 1, 0, 0);
    add(problem, 1, 1, 1);
    add(problem, 1, 2, 3);
    add(problem, 1, 3, 4);
}

static void free_minimum(void)
{
    struct mh_least_squares problem;
    line_through_points(&problem);
    mh_real z[2];
    enum mh_bound bound;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_least_squares_solve(&problem, -10, 10, z, &bound));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -0.1f, z[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.4f, z[1]);
    TEST_ASSERT_EQUAL_INT(MH_BOUND_NONE, bound);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.4472136f, problem.residual); /* residuals 0.1, -0.3, 0.3, -0.1 */
}

/* With the slope on a bound the best intercept is the mean of y - slope x. */
static void bounded_minimum(void)
{
    struct mh_least_squares problem;
    line_through_points(&problem);
    mh_real z[2];
    enum mh_bound bound;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_least_squares_solve(&problem, 0, 1, z, &bound));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_HIGH, bound);
    TEST_ASSERT_EQUAL_FLOAT(1, z[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.5f, z[0]);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_least_squares_solve(&problem, 2, 3, z, &bound));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_LOW, bound);
    TEST_ASSERT_EQUAL_FLOAT(2, z[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -1.0f, z[0]);
}

static void rank(void)
{
    struct mh_least_squares problem;
    mh_real z[2] = {7, 7};
    enum mh_bound bound = MH_BOUND_NONE;
    mh_least_squares_begin(&problem, 2);
    add(&problem, 1, 2, 3);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_least_squares_solve(&problem, 0, 1, z, &bound));
    /* the columns are parallel: the last unknown takes its upper bound, the other one fits the rest */
    add(&problem, 2, 4, 6);
    TEST_ASSERT_EQUAL_FLOAT(7, z[0]);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_least_squares_solve(&problem, 0, 1, z, &bound));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_HIGH, bound);
    TEST_ASSERT_EQUAL_FLOAT(1, z[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1, z[0]);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_least_squares_solve(&problem, 1, 0, z, &bound));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_least_squares_solve(&problem, 0, NAN, z, &bound));
    /* a first column of zeros */
    mh_least_squares_begin(&problem, 2);
    add(&problem, 0, 1, 1);
    add(&problem, 0, 2, 1);
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_least_squares_solve(&problem, 0, 1, z, &bound));
}

static void a_solution_that_is_not_finite_is_none(void)
{
    struct mh_least_squares problem;
    mh_real z[2] = {7, 7};
    enum mh_bound bound = MH_BOUND_NONE;
    mh_least_squares_begin(&problem, 2);
    add(&problem, 1e-30f, 0, 1e15f); /* z = 1e45 */
    add(&problem, 0, 1, 1);
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_least_squares_solve(&problem, 0, 2, z, &bound));
    mh_least_squares_begin(&problem, 2);
    add(&problem, 1, 2, 3);
    add(&problem, 2, 4, 6); /* undetermined, and no bound to put it on */
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_least_squares_solve(&problem, 0, INFINITY, z, &bound));
    TEST_ASSERT_EQUAL_FLOAT(7, z[0]);
    TEST_ASSERT_EQUAL_FLOAT(7, z[1]);
}

static void bad_rows_change_nothing(void)
{
    struct mh_least_squares problem;
    line_through_points(&problem);
    const mh_real nan[2] = {1, NAN}, infinite[2] = {INFINITY, 1}, huge[2] = {1, 1e16f}, fine[2] = {1, 1};
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_least_squares_add(&problem, nan, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_least_squares_add(&problem, infinite, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_least_squares_add(&problem, fine, -INFINITY));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_least_squares_add(&problem, huge, 1));
    TEST_ASSERT_EQUAL_UINT16(4, problem.rows);
    mh_real z[2];
    enum mh_bound bound;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_least_squares_solve(&problem, -10, 10, z, &bound));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.4f, z[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(free_minimum);
    RUN_TEST(bounded_minimum);
    RUN_TEST(rank);
    RUN_TEST(a_solution_that_is_not_finite_is_none);
    RUN_TEST(bad_rows_change_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
