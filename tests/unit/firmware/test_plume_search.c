#include "motehound/plume_search.h"
#include "port.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

enum { SENSORS = 6 };

static const struct mh_plume air = {30, 1, {1, 0}};
static struct mh_vec2 places[SENSORS];
static mh_real z[SENSORS], weight[SENSORS], gains[SENSORS];
static struct mh_plume_search search;

/* Sensors in a bow about (210, 0), samples of a leak of `rate` at (x, y), in standard deviations. */
static struct mh_plume_problem leak(mh_real x, mh_real y, mh_real rate, mh_real scale)
{
    const struct mh_vec2 source = {x, y};
    const struct mh_plume_problem problem = {.plume = &air,
                                             .low = {0, -200},
                                             .high = {500, 200},
                                             .prior = {250, 0, 3.7f},
                                             .variance = {22500, 14400, 0.3f},
                                             .count = SENSORS,
                                             .places = places,
                                             .z = z,
                                             .weight = weight,
                                             .scale = scale};
    for (int i = 0; i < SENSORS; i++) {
        mh_real c;
        places[i].x = 210 + 7 * (mh_real)(i * i);
        places[i].y = 30 * (mh_real)i - 80;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(&air, places[i], source, 0, &c, NULL));
        z[i] = scale * rate * c;
        weight[i] = (mh_real)(1 + i % 3);
    }
    return problem;
}

static mh_real cost_at(const struct mh_plume_problem *problem, mh_real x, mh_real y, mh_real log_rate)
{
    const struct mh_vec2 source = {x, y};
    mh_real cost = mh_squared(x - problem->prior[0]) / problem->variance[0] +
                   mh_squared(y - problem->prior[1]) / problem->variance[1] +
                   mh_squared(log_rate - problem->prior[2]) / problem->variance[2];
    for (uint16_t k = 0; k < problem->count; k++) {
        mh_real c;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(problem->plume, problem->places[k], source, 0, &c, NULL));
        cost += problem->weight[k] * mh_squared(problem->z[k] - problem->scale * mh_exp(log_rate) * c);
    }
    return cost;
}

/* The rate eliminated at each start is the best one there: no other within four standard deviations of the prior does better. */
static void the_rate_is_the_best_there(void)
{
    static const mh_real scales[] = {300, 1e4f};
    for (int s = 0; s < 2; s++) {
        const struct mh_plume_problem problem = leak(90, 20, 30, scales[s]);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_search(&problem, gains, &search));
        for (int i = 0; i < search.starts; i++) {
            const mh_real *x = search.start[i];
            TEST_ASSERT_FLOAT_WITHIN(1e-3f * (1 + search.cost[i]), cost_at(&problem, x[0], x[1], x[2]), search.cost[i]);
            for (int j = -20; j <= 20; j++) {
                TEST_ASSERT_TRUE(cost_at(&problem, x[0], x[1], x[2] + 0.1f * (mh_real)j) >
                                 0.99f * search.cost[i] - 0.02f);
            }
        }
    }
}

/* The best start is the best cell of all, the others are apart from it, and worse in turn. */
static void the_starts_are_the_best_cells_apart(void)
{
    const struct mh_plume_problem problem = leak(90, 30, 30, 3e4f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_search(&problem, gains, &search));
    TEST_ASSERT_EQUAL_INT(3, search.starts);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 90, search.start[0][0]); /* the leak is at the middle of a cell */
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 30, search.start[0][1]);
    for (int i = 1; i < 3; i++) {
        TEST_ASSERT_TRUE(search.cost[i] >= search.cost[i - 1]);
        for (int j = 0; j < i; j++) {
            const mh_real x = mh_abs(search.start[i][0] - search.start[j][0]);
            const mh_real y = mh_abs(search.start[i][1] - search.start[j][1]);
            TEST_ASSERT_TRUE(mh_max(x, y) > 2.5f * 20);
        }
    }
}

/* Samples that say nothing leave the prior: its moments, as far as the area goes. */
static void moments_are_those_of_the_prior(void)
{
    struct mh_plume_problem problem = leak(90, 20, 30, 1e-6f);
    problem.prior[0] = 260;
    problem.variance[0] = 900;
    problem.variance[1] = 1600;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_search(&problem, gains, &search));
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 260, search.mean[0]);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 0, search.mean[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 3.7f, search.mean[2]);
    TEST_ASSERT_FLOAT_WITHIN(5, 900, search.variance[0]);
    TEST_ASSERT_FLOAT_WITHIN(8, 1600, search.variance[1]);
}

/* Where the data settle the place, nearly all the weight is on its cell, however far off the costs of the others are. */
static void moments_where_all_but_one_cell_are_excluded(void)
{
    const struct mh_plume_problem problem = leak(90, 10, 30, 3e5f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_search(&problem, gains, &search));
    TEST_ASSERT_FLOAT_WITHIN(20, 90, search.mean[0]);
    TEST_ASSERT_FLOAT_WITHIN(20, 10, search.mean[1]);
    TEST_ASSERT_TRUE(search.variance[0] >= 0 && search.variance[0] < 400);
    TEST_ASSERT_TRUE(search.variance[1] >= 0 && search.variance[1] < 400);
}

/* Two places that explain a lone sensor as well, on either side of the axis: both are starts. */
static void two_places_alike(void)
{
    struct mh_plume_problem problem = leak(90, 100, 30, 1e4f);
    places[0].x = 300;
    places[0].y = 0;
    problem.count = 1;
    problem.variance[1] = 1e8f;
    mh_real mirrored = 0;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_search(&problem, gains, &search));
    for (int i = 1; i < search.starts; i++) {
        if (mh_abs(search.start[i][1] + search.start[0][1]) < 1) {
            mirrored = search.cost[i];
        }
    }
    TEST_ASSERT_FLOAT_WITHIN(0.02f * search.cost[0] + 0.01f, search.cost[0], mirrored);
    TEST_ASSERT_FLOAT_WITHIN(5, 0, search.mean[1]);
}

static void areas_of_any_shape(void)
{
    static const struct mh_vec2 sizes[] = {{1000, 1}, {1, 1000}, {3, 2}, {1e5f, 1e5f}};
    for (int i = 0; i < 4; i++) {
        struct mh_plume_problem problem = leak(90, 20, 30, 1e-3f);
        problem.low.x = 250 - sizes[i].x / 2;
        problem.high.x = 250 + sizes[i].x / 2;
        problem.low.y = -sizes[i].y / 2;
        problem.high.y = sizes[i].y / 2;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_search(&problem, gains, &search));
        TEST_ASSERT_FLOAT_WITHIN(0.05f * sizes[i].x, 250, search.mean[0]);
        TEST_ASSERT_FLOAT_WITHIN(0.05f * sizes[i].y, 0, search.mean[1]);
    }
}

static void bad_samples_change_nothing(void)
{
    const struct mh_plume_problem problem = leak(90, 20, 30, 3000);
    z[2] = NAN;
    search.starts = 77;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_plume_search(&problem, gains, &search));
    TEST_ASSERT_EQUAL_INT(77, search.starts);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_rate_is_the_best_there);
    RUN_TEST(the_starts_are_the_best_cells_apart);
    RUN_TEST(moments_are_those_of_the_prior);
    RUN_TEST(moments_where_all_but_one_cell_are_excluded);
    RUN_TEST(two_places_alike);
    RUN_TEST(areas_of_any_shape);
    RUN_TEST(bad_samples_change_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
