#include "motehound/ukf.h"

#include "filter_models.h"
#include "motehound/kalman.h"
#include "port.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static const struct mh_ukf_weights published = {1, 2, 0}, plain = {1, 0, 0}, near_points = {0.5f, 2, 0};

static const struct cluster clusters[] = {
    {
        .count = 3,
        .at = {{40, 25}, {17.5f, 37.9903811f}, {17.5f, 12.0096189f}},
        .variance = 0.02f,
        .answer = {10.896747f, 0.803722172f, 20.4301199f, 0.593462164f, 0.0171143629f, 0.000658445481f,
                   -0.000693243604f, -2.66794792e-05f, 0.0385109209f, -2.66713474e-05f, -1.02644677e-06f, 0.0132805673f,
                   0.000511102614f, 0.0385293077f},
    },
    {
        .count = 6,
        .at = {{78.337814f, 89.6239187f},
               {64.0042219f, 85.2025911f},
               {60.6664079f, 70.5786724f},
               {71.662186f, 60.3760813f},
               {85.9957781f, 64.7974089f},
               {89.3335921f, 79.4213276f}},
        .variance = 0.03f,
        .answer = {10.846979f, 0.801807434f, 20.5698273f, 0.598838803f, 0.103996465f, 0.00400108394f, -0.116606723f,
                   -0.00448760957f, 0.0386395231f, -0.00448624177f, -0.000172653009f, 0.142771803f, 0.00549457267f,
                   0.0387210965f},
    }};

/* Xu: the ranges stacked */
static void published_clusters(void)
{
    for (int i = 0; i < 2 && clusters[i].count <= MH_STACKED_MAX; i++) {
        struct mh_gaussian g;
        struct places places;
        mh_real z[6], variance[6];
        const struct mh_observations observations = cluster_begin(&clusters[i], &places, z, variance, &g);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_ukf_update_stacked(&g, &published, &observations));
        assert_cluster(&clusters[i], &g, 1e-4f);
    }
}

/* Zhang: the same six readings one by one, stacked, and one by one with ln q as the state */
static void published_source(void)
{
    const mh_real in_turn[9] = {146.9226f, -1.743313f, 33.63632f,  4769.683f, 14007.19f,
                                50.36075f, -188.0299f, -125.4161f, -68.49363f};
    const mh_real with_logarithm[9] = {160.1114f,   -3.863032f, 3.425235f,  5398.687f,  14118.67f,
                                       0.03635965f, -464.8847f, -4.359014f, -0.3945043f};
    struct gas gas;
    struct mh_gaussian g;
    struct mh_observations observations = gas_begin(&gas, &g, false);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_ukf_update(&g, &plain, &observations));
    assert_gas(in_turn, &g, 2e-3f);
    observations = gas_begin(&gas, &g, true);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_ukf_update(&g, &plain, &observations));
    assert_gas(with_logarithm, &g, 2e-3f);
    observations = gas_begin(&gas, &g, false);
#if MH_STACKED_MAX >= 6
    const mh_real at_once[9] = {188.7396f, 26.29284f,  39.77884f,  9279.246f, 7859.247f,
                                221.6767f, -461.8685f, -234.5131f, 55.17713f};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_ukf_update_stacked(&g, &plain, &observations));
    assert_gas(at_once, &g, 2e-3f);
#endif
}

/* A linear motion, row by row in `context`. */
static enum mh_status move_linearly(const void *context, const mh_real *x, mh_real *next, mh_real *F)
{
    const mh_real *row = context;
    TEST_ASSERT_NULL(F);
    for (int i = 0; i < 4; i++) {
        next[i] = 0;
        for (int j = 0; j < 4; j++) {
            next[i] += *row++ * x[j];
        }
    }
    return MH_OK;
}

/* Where the models are linear, predictions and both updates are the Kalman filter's, whatever the weights. */
static void linear_is_kalmans(void)
{
    const struct mh_ukf_weights weights[] = {{1, 2, 0}, {0.1f, 2, 0}, {0.5f, 2, -1}, {1, 0, 2}};
    seed = 12;
    for (int round = 0; round < 8; round++) {
        mh_real F[16], Q[10] = {0.1f, 0, 0.2f, 0, 0, 0.3f, 0, 0, 0.1f, 0.4f}, h[3][4], z[3], variance[3], P[10];
        const struct forms forms = {(const mh_real(*)[4])h, 4, 0};
        const struct mh_observations observations = {3, z, variance, &forms, predict_form, NULL};
        const struct mh_transition transition = {F, move_linearly};
        struct mh_gaussian a, b;
        struct mh_kalman kalman;
        draw_gaussian(&a, 4);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&kalman, 4, a.x, a.P));
        for (int i = 0; i < 16; i++) {
            F[i] = draw();
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&kalman, F, Q));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_ukf_predict(&a, &weights[round % 4], &transition, Q));
        mh_kalman_covariance(&kalman, P);
        for (int i = 0; i < 10; i++) {
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, P[i], a.P[i]);
        }
        b = a;
        for (int k = 0; k < 3; k++) {
            mh_real innovation = z[k] = 10 * draw();
            variance[k] = 0.6f + 0.5f * draw();
            for (int i = 0; i < 4; i++) {
                h[k][i] = draw();
                innovation -= h[k][i] * kalman.x[i];
            }
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&kalman, h[k], innovation, variance[k], NULL));
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_ukf_update(&a, &weights[round % 4], &observations));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_ukf_update_stacked(&b, &weights[round % 4], &observations));
        mh_kalman_covariance(&kalman, P);
        for (int i = 0; i < 4; i++) {
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, kalman.x[i], a.x[i]);
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, kalman.x[i], b.x[i]);
        }
        for (int i = 0; i < 10; i++) {
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, P[i], a.P[i]);
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, P[i], b.P[i]);
        }
    }
}

/* The published sums with their weights, of a range measured by a place that is known to 2 m, 10 m away */
static void as_the_weighted_sums(void)
{
    const struct mh_ukf_weights all[] = {{1, 0, 0}, {1, 2, 0}, {0.5f, 2, 0}, {1, 0, 2}, {0.8f, 1, 1}};
    const struct mh_vec2 at[1] = {{0, 0}};
    const struct places places = {at};
    const mh_real z = 11, variance = 0.3f;
    const struct mh_observations observations = {1, &z, &variance, &places, predict_range, NULL};
    for (unsigned w = 0; w < sizeof all / sizeof all[0]; w++) {
        struct mh_gaussian g = {4, {6, 1, 8, 1}, {4, 0, 1, 2, 0, 4, 0, 0.5f, 0, 1}};
        const struct mh_gaussian before = g;
        const mh_real n = 4, a2 = all[w].alpha * all[w].alpha, lambda = a2 * (n + all[w].kappa) - n;
        mh_real L[10], points[9][4], ranges[9], mean = 0, Pzz = variance, Pxz[4] = {0};
        memcpy(L, g.P, sizeof L);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_cholesky_factor(4, L));
        for (int p = 0; p < 9; p++) {
            for (int i = 0; i < 4; i++) {
                const int column = (p - 1) / 2;
                const mh_real step = p > 0 && i >= column ? mh_sqrt(n + lambda) * L[MH_PACKED(column, i)] : 0;
                points[p][i] = g.x[i] + (p % 2 ? step : -step);
            }
            predict_range(&places, 0, points[p], &ranges[p], NULL);
            mean += ranges[p] * (p ? 0.5f / (n + lambda) : lambda / (n + lambda));
        }
        for (int p = 0; p < 9; p++) {
            const mh_real weight =
                p ? 0.5f / (n + lambda) : lambda / (n + lambda) + 1 - a2 + all[w].beta; /* of covariances */
            Pzz += weight * (ranges[p] - mean) * (ranges[p] - mean);
            for (int i = 0; i < 4; i++) {
                Pxz[i] += weight * (points[p][i] - g.x[i]) * (ranges[p] - mean);
            }
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_ukf_update(&g, &all[w], &observations));
        for (int i = 0; i < 4; i++) {
            TEST_ASSERT_FLOAT_WITHIN(1e-5f, before.x[i] + Pxz[i] / Pzz * (z - mean), g.x[i]);
            for (int j = 0; j <= i; j++) {
                const int element = MH_PACKED(j, i);
                TEST_ASSERT_FLOAT_WITHIN(2e-5f, before.P[element] - Pxz[i] * Pxz[j] / Pzz, g.P[element]);
            }
        }
    }
}

/* next = (x0^2, x0 x1) */
static enum mh_status squares(const void *context, const mh_real *x, mh_real *next, mh_real *F)
{
    (void)context;
    (void)F;
    next[0] = x[0] * x[0];
    next[1] = x[0] * x[1];
    return MH_OK;
}

/* E x0^2 = m0^2 + P00, E x0 x1 = m0 m1 + P01 for any weights; of one state, var x^2 = 4 m^2 P + 2 P^2 with beta = 2 */
static void quadratics_have_their_mean(void)
{
    const struct mh_ukf_weights weights[] = {{1, 2, 0}, {0.1f, 2, 0}, {0.5f, 2, 0}, {1, 0, 1}};
    const struct mh_transition transition = {NULL, squares};
    const mh_real Q[3] = {0.25f, 0, 0.25f};
    for (int w = 0; w < 4; w++) {
        struct mh_gaussian g = {2, {3, -2}, {2, 0.5f, 1}};
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_ukf_predict(&g, &weights[w], &transition, Q));
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 9 + 2, g.x[0]);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, -6 + 0.5f, g.x[1]);
    }
    for (int w = 0; w < 3; w++) {
        struct mh_gaussian g = {1, {3}, {2}};
        const struct forms forms = {(const mh_real[1][4]){{0}}, 1, 1}; /* the same through a measurement */
        const mh_real z = 14, variance = 0.5f, s = 4 * 9 * 2 + 2 * 4 + 0.5f, covariance = 2 * 3 * 2;
        const struct mh_observations observations = {1, &z, &variance, &forms, predict_form, NULL};
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_ukf_update(&g, &weights[w], &observations));
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 3 + covariance / s * (14 - 11), g.x[0]);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 2 - covariance * covariance / s, g.P[0]);
    }
}

/* Variances of 1e6 meet measurements of 1e-4: forms with and without curvature, one by one and stacked. */
static void diffuse_prior(void)
{
    for (int kind = 0; kind < 4; kind++) {
        struct mh_gaussian g = {4, {0}, {1e6f, 0, 1e6f, 0, 0, 1e6f, 0, 0, 0, 1e6f}};
        const mh_real z[2] = {0, 0}, variance[2] = {1e-4f, 1e-4f};
        seed = 3;
        for (int i = 0; i < 100; i++) {
            const mh_real h[2][4] = {{draw(), draw(), draw(), draw()}, {draw(), draw(), draw(), draw()}};
            const struct forms forms = {h, 4, kind % 2 ? 0.01f : 0};
            const struct mh_observations observations = {2, z, variance, &forms, predict_form, NULL};
            TEST_ASSERT_EQUAL_INT(MH_OK, kind < 2 ? mh_ukf_update(&g, &near_points, &observations)
                                                  : mh_ukf_update_stacked(&g, &near_points, &observations));
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_check(&g));
        }
        /* a curved form is known with one sign or the other at first: what is claimed must hold, however slowly it shrinks */
        for (int i = 0; i < 4; i++) {
            const mh_real sd = mh_sqrt(g.P[MH_PACKED(i, i)]);
            TEST_ASSERT_FLOAT_WITHIN(5 * sd, 0, g.x[i]);
            TEST_ASSERT_TRUE(kind % 2 || sd < 1e-2f);
        }
    }
}

/* Any values at all at the sigma points, from 1e-10 to 1e10, with the weights at the limit of what is allowed: what is left is a covariance, and
 * no variance has grown. */
static enum mh_status predict_noise(const void *context, uint16_t k, const mh_real *x, mh_real *z, mh_real *gradient)
{
    (void)context;
    (void)k;
    (void)x;
    (void)gradient;
    *z = draw() * mh_exp(23 * draw());
    return MH_OK;
}

static void covariance_survives_any_model(void)
{
    const struct mh_ukf_weights weights[] = {{1, 0, 0}, {0.1f, 0, 0}, {1, 0.75f, -3}, {1, -0.25f, 1}};
    const mh_real z[3] = {0, 1, 2}, variance[3] = {1, 1e-3f, 1e3f};
    const struct mh_observations observations = {3, z, variance, NULL, predict_noise, NULL};
    seed = 13;
    for (int round = 0; round < 100; round++) {
        struct mh_gaussian g, before;
        draw_gaussian(&g, 4);
        before = g;
        const enum mh_status status = round % 2 ? mh_ukf_update(&g, &weights[round / 2 % 4], &observations)
                                                : mh_ukf_update_stacked(&g, &weights[round / 2 % 4], &observations);
        TEST_ASSERT_EQUAL_INT(MH_OK, status);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_check(&g));
        for (int i = 0; i < 4; i++) {
            TEST_ASSERT_TRUE(g.P[MH_PACKED(i, i)] <= 1.00001f * before.P[MH_PACKED(i, i)]);
        }
    }
}

static void weights_out_of_range_are_refused(void)
{
    const struct mh_ukf_weights bad[] = {{0.0999f, 2, 0}, {1e-3f, 2, 0}, {0, 2, 0},        {-1, 2, 0},  {1.01f, 2, 0},
                                         {NAN, 2, 0},     {1, NAN, 0},   {1, INFINITY, 0}, {1, 2, NAN}, {1, 2, -1.75f},
                                         {1, 0, -0.1f},   {1, -0.1f, 0}, {0.5f, -0.2f, 1}};
    const struct mh_transition transition = {NULL, squares};
    const mh_real Q[3] = {1, 0, 1}, z = 1, variance = 1, h[1][4] = {{1, 0}};
    const struct forms forms = {h, 2, 0};
    const struct mh_observations observations = {1, &z, &variance, &forms, predict_form, NULL};
    struct mh_gaussian g = {2, {1, 2}, {1, 0.5f, 1}};
    const struct mh_gaussian before = g;
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_ukf_predict(&g, &bad[i], &transition, Q));
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_ukf_update(&g, &bad[i], &observations));
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_ukf_update_stacked(&g, &bad[i], &observations));
    }
    TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
}

/* A target to the west, where the bearing jumps: some sigma points and the measured bearing lie beyond the jump. Turned by half a circle, where
 * nothing jumps, the answer is the same. */
static void bearings_wrap(void)
{
    const struct mh_vec2 at[2] = {{0, 0}, {0, 1}};
    const struct places places = {at};
    const mh_real west[2] = {-MH_PI + 0.02f, -MH_PI + 0.12f}, east[2] = {0.02f, 0.12f}, variance[2] = {1e-3f, 1e-3f};
    const struct mh_observations beyond = {2, west, variance, &places, predict_bearing, wrap_angle};
    const struct mh_vec2 turned_at[2] = {{0, 0}, {0, -1}};
    const struct places turned_places = {turned_at};
    const struct mh_observations turned = {2, east, variance, &turned_places, predict_bearing, NULL};
    for (int stacked = 0; stacked < 2; stacked++) {
        struct mh_gaussian a = {4, {-10, 0, 0.1f, 0}, {1, 0, 1, 0, 0, 1, 0, 0, 0, 1}};
        struct mh_gaussian b = {4, {10, 0, -0.1f, 0}, {1, 0, 1, 0, 0, 1, 0, 0, 0, 1}};
        TEST_ASSERT_EQUAL_INT(MH_OK, stacked ? mh_ukf_update_stacked(&a, &published, &beyond)
                                             : mh_ukf_update(&a, &published, &beyond));
        TEST_ASSERT_EQUAL_INT(MH_OK, stacked ? mh_ukf_update_stacked(&b, &published, &turned)
                                             : mh_ukf_update(&b, &published, &turned));
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, -b.x[0], a.x[0]);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, -b.x[2], a.x[2]);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, b.P[MH_PACKED(2, 2)], a.P[MH_PACKED(2, 2)]);
        TEST_ASSERT_TRUE(b.x[2] > 0.1f);
    }
}

/* Gives NaN at the sigma points beyond the middle. */
static enum mh_status bad_model(const void *context, uint16_t k, const mh_real *x, mh_real *z, mh_real *gradient)
{
    (void)gradient;
    *z = x[0] > 1 && k == 1 ? (mh_real)NAN : 1;
    return x[0] > 1 && k == 2 ? *(const enum mh_status *)context : MH_OK;
}

static enum mh_status bad_motion(const void *context, const mh_real *x, mh_real *next, mh_real *F)
{
    (void)F;
    next[0] = next[1] = x[0] > 1 ? (mh_real)NAN : 1;
    return x[0] < 1 ? *(const enum mh_status *)context : MH_OK;
}

static void bad_input_changes_nothing(void)
{
    const mh_real h[1][4] = {{1, 0}};
    const struct forms forms = {h, 2, 0};
    struct mh_gaussian g = {2, {1, 2}, {1, 0.5f, 1}};
    const struct mh_gaussian before = g;
    const struct {
        mh_real z, variance;
        enum mh_status status;
    } bad[] = {{NAN, 1, MH_ERR_NOT_FINITE}, {-INFINITY, 1, MH_ERR_NOT_FINITE}, {1, NAN, MH_ERR_ARGUMENT},
               {1, 0, MH_ERR_ARGUMENT},     {1, -1, MH_ERR_ARGUMENT},          {1, 1e-40f, MH_ERR_ARGUMENT}};
    enum mh_status (*const updates[])(struct mh_gaussian *, const struct mh_ukf_weights *,
                                      const struct mh_observations *) = {mh_ukf_update, mh_ukf_update_stacked};
    const mh_real z[MH_STACKED_MAX + 1] = {1, 1, 1}, variance[3] = {1, 1, 1};
    enum mh_status told = MH_ERR_RANGE;
    struct mh_observations observations = {1, z, variance, &told, bad_model, NULL};
    for (int u = 0; u < 2; u++) {
        for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
            const struct mh_observations one = {1, &bad[i].z, &bad[i].variance, &forms, predict_form, NULL};
            TEST_ASSERT_EQUAL_INT(bad[i].status, updates[u](&g, &plain, &one));
        }
        observations.count = 2;
        TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, updates[u](&g, &plain, &observations));
        observations.count = 3;
        TEST_ASSERT_NOT_EQUAL(MH_OK, updates[u](&g, &plain, &observations));
        TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
    }
    observations.count = MH_STACKED_MAX + 1;
    TEST_ASSERT_EQUAL_INT(MH_ERR_CAPACITY, mh_ukf_update_stacked(&g, &plain, &observations));
    const struct mh_transition transition = {&told, bad_motion}, squared = {NULL, squares};
    const mh_real Q[3] = {1, 0, 1}, bad_Q[3] = {1, NAN, 1};
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_ukf_predict(&g, &plain, &transition, Q));
    told = MH_OK;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_ukf_predict(&g, &plain, &transition, Q));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_ukf_predict(&g, &plain, &squared, bad_Q));
    TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
    g.P[1] = 2;
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_ukf_predict(&g, &plain, &squared, Q));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_ukf_update(&g, &plain, &observations));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_ukf_update_stacked(&g, &plain, &observations));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(published_clusters);
    RUN_TEST(published_source);
    RUN_TEST(linear_is_kalmans);
    RUN_TEST(as_the_weighted_sums);
    RUN_TEST(quadratics_have_their_mean);
    RUN_TEST(diffuse_prior);
    RUN_TEST(covariance_survives_any_model);
    RUN_TEST(weights_out_of_range_are_refused);
    RUN_TEST(bearings_wrap);
    RUN_TEST(bad_input_changes_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
