#include "motehound/iterated_ekf.h"

#include "filter_models.h"
#include "motehound/kalman.h"
#include "port.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static const struct mh_iterated_ekf_config config = {30, 0.01f, 1e-6f};

/* Zhang: the most probable source, with ln q as the state */
static void published_source(void)
{
    const mh_real answer[9] = {148.6576f,  28.45232f,  3.17242f,   12164.75f, 3943.321f,
                               0.1320473f, -334.9039f, -37.44344f, 6.114638f};
    struct gas gas;
    struct mh_gaussian g;
    const struct mh_observations observations = gas_begin(&gas, &g, true);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_iterated_ekf_update(&g, &config, NULL, &observations, NULL));
    assert_gas(answer, &g, 5e-3f);
}

/* Where the models are linear it is the Kalman filter, from wherever it starts; f at the minimum is the sum of the squared innovations
 * over their variances. */
static void linear_is_kalmans(void)
{
    seed = 14;
    for (int round = 0; round < 10; round++) {
        mh_real h[3][4], z[3], variance[3], P[10], cost = 0, f;
        struct forms forms = {(const mh_real(*)[4])h, 4, 0};
        const struct mh_observations observations = {3, z, variance, &forms, predict_form, NULL};
        const mh_real start[4] = {10 * draw(), 10 * draw(), 10 * draw(), 10 * draw()};
        struct mh_gaussian g;
        struct mh_kalman kalman;
        draw_gaussian(&g, 4);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&kalman, 4, g.x, g.P));
        for (int k = 0; k < 3; k++) {
            struct mh_gate gate = {.sigmas = 1e9f};
            mh_real innovation = z[k] = 10 * draw();
            variance[k] = 0.6f + 0.5f * draw();
            for (int i = 0; i < 4; i++) {
                h[k][i] = draw();
                innovation -= h[k][i] * kalman.x[i];
            }
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&kalman, h[k], innovation, variance[k], &gate));
            cost += gate.surprise;
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_iterated_ekf_update(&g, &config, round % 2 ? start : NULL, &observations, &f));
        mh_kalman_covariance(&kalman, P);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f * (1 + cost), cost, f);
        for (int i = 0; i < 4; i++) {
            TEST_ASSERT_FLOAT_WITHIN(2e-3f, kalman.x[i], g.x[i]);
        }
        for (int i = 0; i < 10; i++) {
            TEST_ASSERT_FLOAT_WITHIN(2e-5f, P[i], g.P[i]);
        }
    }
}

/* f, as its definition says, for a prior of diagonal covariance */
static mh_real objective(const struct mh_gaussian *prior, const struct mh_observations *observations, const mh_real *x)
{
    mh_real f = 0;
    for (int i = 0; i < prior->n; i++) {
        f += mh_squared(x[i] - prior->x[i]) / prior->P[MH_PACKED(i, i)];
    }
    for (uint16_t k = 0; k < observations->count; k++) {
        mh_real z;
        TEST_ASSERT_EQUAL_INT(MH_OK, observations->predict(observations->context, k, x, &z, NULL));
        f += mh_squared(observations->z[k] - z) / observations->variance[k];
    }
    return f;
}

/* Four ranges, a prior 40 m off that an EKF would be misled by: no place of a grid over 60 m has a lower f than the one that is found. */
static void finds_the_minimum(void)
{
    const struct mh_vec2 at[4] = {{0, 0}, {30, 0}, {0, 30}, {30, 30}};
    const mh_real truth[4] = {12, 0, 21, 0};
    struct places places = {at};
    mh_real z[4], variance[4], f, least = 1e30f;
    const struct mh_observations observations = {4, z, variance, &places, predict_range, NULL};
    const struct mh_gaussian prior = {4, {45, 0, 45, 0}, {900, 0, 1, 0, 0, 900, 0, 0, 0, 1}};
    struct mh_gaussian g = prior;
    seed = 15;
    for (uint16_t k = 0; k < 4; k++) {
        predict_range(&places, k, truth, &z[k], NULL);
        z[k] += draw();
        variance[k] = 0.33f;
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_iterated_ekf_update(&g, &config, NULL, &observations, &f));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f * f, objective(&prior, &observations, g.x), f);
    for (int i = 0; i < 30; i++) {
        for (int j = 0; j < 30; j++) {
            const mh_real x[4] = {2 * (mh_real)i + 0.5f, 0, 2 * (mh_real)j + 0.5f, 0};
            least = mh_min(least, objective(&prior, &observations, x));
        }
    }
    TEST_ASSERT_TRUE(f < least);
    TEST_ASSERT_FLOAT_WITHIN(3 * mh_sqrt(g.P[MH_PACKED(0, 0)]), truth[0], g.x[0]);
    TEST_ASSERT_FLOAT_WITHIN(3 * mh_sqrt(g.P[MH_PACKED(2, 2)]), truth[2], g.x[2]);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1, g.P[MH_PACKED(1, 1)]); /* nothing was learned of the velocity */
}

/* Variances of 1e6, measurements of 1e-4, fewer of them than states: what was measured is known, what was not is as before. */
static void diffuse_prior(void)
{
    for (uint16_t count = 1; count <= 4; count++) {
        const mh_real h[4][4] = {{1, 1, 0, 0}, {1, -1, 0, 0}, {0, 0, 1, 0.5f}, {0, 0, 0.5f, 1}};
        const mh_real z[4] = {3, 1, 2, 2.5f}, variance[4] = {1e-4f, 1e-4f, 1e-4f, 1e-4f};
        const struct forms forms = {h, 4, 0};
        const struct mh_observations observations = {count, z, variance, &forms, predict_form, NULL};
        struct mh_gaussian g = {4, {0}, {1e6f, 0, 1e6f, 0, 0, 1e6f, 0, 0, 0, 1e6f}};
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_iterated_ekf_update(&g, &config, NULL, &observations, NULL));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_check(&g));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, 3, g.x[0] + g.x[1]);
        TEST_ASSERT_FLOAT_WITHIN(count < 4 ? 1e6f : 1e-3f, 2, g.x[3]);
        TEST_ASSERT_TRUE(count == 4 ? g.P[MH_PACKED(3, 3)] < 1e-3f : g.P[MH_PACKED(3, 3)] > 1e5f);
    }
}

#if UINTPTR_MAX > 0xffffffffu /* where there is memory for the numbers */
/* So many equal measurements of one number: its variance is theirs over the count. */
static void as_many_as_can_be_counted(void)
{
    static mh_real z[UINT16_MAX], variance[UINT16_MAX];
    static const mh_real h[UINT16_MAX][4];
    const struct forms forms = {h, 1, 1};
    const struct mh_observations observations = {UINT16_MAX, z, variance, &forms, predict_form, NULL};
    struct mh_gaussian g = {1, {5}, {1}};
    for (unsigned k = 0; k < UINT16_MAX; k++) {
        z[k] = 16;
        variance[k] = 64;
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_iterated_ekf_update(&g, &config, NULL, &observations, NULL));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 4, g.x[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f / 65536.0f, g.P[0]);
}
#endif

/* A target to the west, where the bearing jumps */
static void bearings_wrap(void)
{
    const struct mh_vec2 at[1] = {{0, 0}};
    const struct places places = {at};
    const mh_real z = -MH_PI + 0.02f, variance = 1e-4f;
    const struct mh_observations observations = {1, &z, &variance, &places, predict_bearing, wrap_angle};
    struct mh_gaussian g = {4, {-10, 0, 0.1f, 0}, {1, 0, 1, 0, 0, 1, 0, 0, 0, 1}};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_iterated_ekf_update(&g, &config, NULL, &observations, NULL));
    TEST_ASSERT_FLOAT_WITHIN(0.02f, -0.2f, g.x[2]);
}

/* Fails, or says NaN, beyond x = 3: the way to z = 100 is barred there, but that is no error. At the start it is. */
struct barrier {
    enum mh_status status;
};

static enum mh_status barred(const void *context, uint16_t k, const mh_real *x, mh_real *z, mh_real *gradient)
{
    const struct barrier *barrier = context;
    (void)k;
    *z = x[0] > 3 ? (mh_real)NAN : x[0];
    gradient[0] = 1;
    return x[0] > 3 ? barrier->status : MH_OK;
}

static void a_model_with_limits(void)
{
    const mh_real z = 100, variance = 1;
    struct barrier barrier = {MH_ERR_RANGE};
    const struct mh_observations observations = {1, &z, &variance, &barrier, barred, NULL};
    mh_real f = 0;
    for (int i = 0; i < 2; i++) {
        struct mh_gaussian g = {1, {0}, {1}}, before;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_iterated_ekf_update(&g, &config, NULL, &observations, &f));
        TEST_ASSERT_TRUE(g.x[0] > 0.1f && g.x[0] <= 3);
        TEST_ASSERT_TRUE(f < 10000);
        g.x[0] = 4;
        before = g;
        TEST_ASSERT_EQUAL_INT(i == 0 ? MH_ERR_RANGE : MH_ERR_NOT_FINITE,
                              mh_iterated_ekf_update(&g, &config, NULL, &observations, &f));
        TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
        barrier.status = MH_OK;
    }
}

static void bad_input_changes_nothing(void)
{
    const mh_real h[1][4] = {{1, 0}};
    const struct forms forms = {h, 2, 0};
    struct mh_gaussian g = {2, {1, 2}, {1, 0.5f, 1}};
    struct mh_gaussian before = g;
    const struct {
        mh_real z, variance;
        enum mh_status status;
    } bad[] = {{NAN, 1, MH_ERR_NOT_FINITE},   {INFINITY, 1, MH_ERR_NOT_FINITE},  {1, NAN, MH_ERR_ARGUMENT},
               {1, 0, MH_ERR_ARGUMENT},       {1, -1, MH_ERR_ARGUMENT},          {1, 1e-40f, MH_ERR_ARGUMENT},
               {3e38f, 1, MH_ERR_NOT_FINITE}, {3e38f, 1e-30f, MH_ERR_NOT_FINITE}};
    const struct mh_iterated_ekf_config bad_configs[] = {
        {0, 0.01f, 1e-6f}, {30, -1, 1e-6f}, {30, NAN, 1e-6f}, {30, 0.01f, -1}, {30, 0.01f, NAN}};
    const mh_real z = 1, variance = 1, bad_start[2] = {1, NAN};
    const struct mh_observations good = {1, &z, &variance, &forms, predict_form, NULL};
    mh_real cost = 7;
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        const struct mh_observations one = {1, &bad[i].z, &bad[i].variance, &forms, predict_form, NULL};
        TEST_ASSERT_EQUAL_INT(bad[i].status, mh_iterated_ekf_update(&g, &config, NULL, &one, &cost));
    }
    for (unsigned i = 0; i < sizeof bad_configs / sizeof bad_configs[0]; i++) {
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_iterated_ekf_update(&g, &bad_configs[i], NULL, &good, &cost));
    }
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_iterated_ekf_update(&g, &config, bad_start, &good, &cost));
    TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
    g.P[1] = before.P[1] = 2;
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_iterated_ekf_update(&g, &config, NULL, &good, &cost));
    TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
    TEST_ASSERT_EQUAL_FLOAT(7, cost);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(published_source);
    RUN_TEST(linear_is_kalmans);
    RUN_TEST(finds_the_minimum);
    RUN_TEST(diffuse_prior);
#if UINTPTR_MAX > 0xffffffffu
    RUN_TEST(as_many_as_can_be_counted);
#endif
    RUN_TEST(bearings_wrap);
    RUN_TEST(a_model_with_limits);
    RUN_TEST(bad_input_changes_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
