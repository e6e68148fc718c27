#include "motehound/ekf.h"

#include "filter_models.h"
#include "motehound/kalman.h"
#include "port.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static const struct cluster clusters[] = {
    {
        .count = 3,
        .at = {{40, 25}, {17.5f, 37.9903811f}, {17.5f, 12.0096189f}},
        .variance = 0.02f,
        .answer = {10.8788931f, 0.803035275f, 20.4348867f, 0.593645615f, 0.0132934214f, 0.000511441374f,
                   1.84671892e-05f, 7.10709754e-07f, 0.0385052652f, 7.10493133e-07f, 2.73433273e-08f, 0.0130382214f,
                   0.000501775934f, 0.0385289488f},
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
        .answer = {10.8422264f, 0.80162459f, 20.5658011f, 0.598683855f, 0.103860974f, 0.00399587115f, -0.116601811f,
                   -0.00448742055f, 0.0386393226f, -0.0044860528f, -0.000172645736f, 0.142660422f, 0.00549028615f,
                   0.0387209316f},
    }};

/* Xu: every range linearised at the predicted state */
static void published_clusters(void)
{
    for (int i = 0; i < 2; i++) {
        struct mh_gaussian g;
        struct places places;
        mh_real z[6], variance[6];
        const struct mh_observations observations = cluster_begin(&clusters[i], &places, z, variance, &g);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_ekf_update_stacked(&g, &observations));
        assert_cluster(&clusters[i], &g, 1e-4f);
    }
}

/* Zhang: the same six readings, taken one by one and at once */
static void published_source(void)
{
    const mh_real in_turn[9] = {246.6031f, 19.15364f,  13.63065f,  3079.892f, 3863.635f,
                                8.974283f, -3255.532f, -132.4483f, 119.6474f};
    const mh_real at_once[9] = {231.7493f, 6.535348f,  19.80969f, 3735.922f, 200.3462f,
                                208.0399f, -153.1942f, -875.479f, 29.59304f};
    struct gas gas;
    struct mh_gaussian g;
    struct mh_observations observations = gas_begin(&gas, &g, false);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_ekf_update(&g, &observations));
    assert_gas(in_turn, &g, 2e-3f);
    observations = gas_begin(&gas, &g, false);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_ekf_update_stacked(&g, &observations));
    assert_gas(at_once, &g, 2e-3f);
}

/* Where the models are linear both updates are the Kalman filter's, and the order of the elements does not matter. */
static void linear_is_kalmans(void)
{
    seed = 11;
    for (int round = 0; round < 10; round++) {
        mh_real h[3][4], z[3], variance[3], P[10];
        struct forms forms = {(const mh_real(*)[4])h, 4, 0};
        const struct mh_observations observations = {3, z, variance, &forms, predict_form, NULL};
        struct mh_gaussian a, b;
        struct mh_kalman kalman;
        draw_gaussian(&a, 4);
        b = a;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&kalman, 4, a.x, a.P));
        for (int k = 0; k < 3; k++) {
            z[k] = 10 * draw();
            variance[k] = 0.6f + 0.5f * draw();
            for (int i = 0; i < 4; i++) {
                h[k][i] = draw();
            }
        }
        for (int k = 2; k >= 0; k--) {
            mh_real innovation = z[k];
            for (int i = 0; i < 4; i++) {
                innovation -= h[k][i] * kalman.x[i];
            }
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&kalman, h[k], innovation, variance[k], NULL));
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_ekf_update(&a, &observations));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_ekf_update_stacked(&b, &observations));
        mh_kalman_covariance(&kalman, P);
        for (int i = 0; i < 4; i++) {
            TEST_ASSERT_FLOAT_WITHIN(2e-4f, kalman.x[i], a.x[i]);
            TEST_ASSERT_FLOAT_WITHIN(2e-4f, kalman.x[i], b.x[i]);
        }
        for (int i = 0; i < 10; i++) {
            TEST_ASSERT_FLOAT_WITHIN(2e-5f, P[i], a.P[i]);
            TEST_ASSERT_FLOAT_WITHIN(2e-5f, P[i], b.P[i]);
        }
    }
}

/* Polar motion: (r, phi) -> the same place in x and y. Its Jacobian is exact, so P is J P J'. */
static enum mh_status to_cartesian(const void *context, const mh_real *x, mh_real *next, mh_real *F)
{
    (void)context;
    next[0] = x[0] * cosine(x[1]);
    next[1] = x[0] * sine(x[1]);
    if (F) {
        F[0] = cosine(x[1]);
        F[1] = -next[1];
        F[2] = sine(x[1]);
        F[3] = next[0];
    }
    return MH_OK;
}

static void prediction_by_the_jacobian(void)
{
    const struct mh_transition transition = {NULL, to_cartesian};
    const mh_real Q[3] = {0.01f, 0, 0.02f};
    struct mh_gaussian g = {2, {2, MH_PI / 2}, {0.25f, 0, 0.09f}};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_ekf_predict(&g, &transition, Q));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, g.x[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 2, g.x[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 4 * 0.09f + 0.01f, g.P[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, g.P[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.25f + 0.02f, g.P[2]);
}

/* Variances of 1e6 meet measurements of 1e-4, with and without motion between. */
static void diffuse_prior(void)
{
    mh_real F[16], Q[10];
    mh_kalman_constant_velocity(0.1f, 1e-6f, F, Q);
    for (int moving = 0; moving < 2; moving++) {
        struct mh_gaussian g = {4, {0}, {1e6f, 0, 1e6f, 0, 0, 1e6f, 0, 0, 0, 1e6f}};
        const mh_real z = 0, variance = 1e-4f;
        seed = 3;
        for (int i = 0; i < 200; i++) {
            for (int m = 0; m < 2; m++) {
                const mh_real h[1][4] = {{draw(), draw(), moving ? 0 : draw(), moving ? 0 : draw()}};
                const struct forms forms = {h, 4, 0};
                const struct mh_observations observations = {1, &z, &variance, &forms, predict_form, NULL};
                TEST_ASSERT_EQUAL_INT(MH_OK, mh_ekf_update(&g, &observations));
                TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_check(&g));
            }
            if (moving) {
                TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_predict(&g, F, Q));
                TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_check(&g));
            }
        }
        /* a hundred times what 400 measurements of this noise leave at most */
        TEST_ASSERT_TRUE(g.P[MH_PACKED(0, 0)] < 1e-3f && g.P[MH_PACKED(1, 1)] < 1e-3f);
    }
}

/* A target to the west, where the bearing jumps: the measured one is on the other side of the jump. */
static void bearings_wrap(void)
{
    const struct mh_vec2 at[1] = {{0, 0}};
    const struct places places = {at};
    const mh_real z = -MH_PI + 0.02f, variance = 1e-4f;
    struct mh_observations observations = {1, &z, &variance, &places, predict_bearing, wrap_angle};
    const struct mh_gaussian prior = {4, {-10, 0, 0.1f, 0}, {1, 0, 1, 0, 0, 1, 0, 0, 0, 1}};
    struct mh_gaussian g = prior, stacked = prior, unwrapped = prior;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_ekf_update(&g, &observations));
    TEST_ASSERT_FLOAT_WITHIN(0.02f, -0.2f, g.x[2]); /* 10 m away, 0.02 rad beyond */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_ekf_update_stacked(&stacked, &observations));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, g.x[2], stacked.x[2]);
    observations.wrap = NULL;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_ekf_update(&unwrapped, &observations));
    TEST_ASSERT_TRUE(unwrapped.x[2] > 10);
}

/* Gives NaN as the gradient of element 1, or fails there. */
static enum mh_status bad_model(const void *context, uint16_t k, const mh_real *x, mh_real *z, mh_real *gradient)
{
    *z = x[0];
    gradient[0] = k == 1 ? (mh_real)NAN : 1;
    gradient[1] = 0;
    return k == 1 ? *(const enum mh_status *)context : MH_OK;
}

static void bad_input_changes_nothing(void)
{
    const mh_real h[1][4] = {{1, 0}};
    const struct forms forms = {h, 2, 0};
    struct mh_gaussian g = {2, {1, 2}, {1, 0.5f, 1}};
    struct mh_gaussian before;
    const struct {
        mh_real z, variance;
        enum mh_status status;
    } bad[] = {{NAN, 1, MH_ERR_NOT_FINITE},     {INFINITY, 1, MH_ERR_NOT_FINITE}, {1, NAN, MH_ERR_ARGUMENT},
               {1, 0, MH_ERR_ARGUMENT},         {1, -1, MH_ERR_ARGUMENT},         {1, 1e-40f, MH_ERR_ARGUMENT},
               {1, INFINITY, MH_ERR_NOT_FINITE}};
    enum mh_status (*const updates[])(struct mh_gaussian *, const struct mh_observations *) = {mh_ekf_update,
                                                                                               mh_ekf_update_stacked};
    const mh_real z[3] = {1, 1, 1}, variance[3] = {1, 1, 1};
    enum mh_status told;
    struct mh_observations observations = {1, z, variance, &told, bad_model, NULL};
    before = g;
    for (int u = 0; u < 2; u++) {
        for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
            const struct mh_observations one = {1, &bad[i].z, &bad[i].variance, &forms, predict_form, NULL};
            TEST_ASSERT_EQUAL_INT(bad[i].status, updates[u](&g, &one));
        }
        observations.count = 3;
        told = MH_OK;
        TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, updates[u](&g, &observations));
        told = MH_ERR_RANGE;
        TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, updates[u](&g, &observations));
        TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
        observations.count = 0;
        TEST_ASSERT_EQUAL_INT(MH_OK, updates[u](&g, &observations));
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, before.P[1], g.P[1]);
        g = before;
        g.P[1] = 2;
        TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, updates[u](&g, &observations));
        g = before;
    }
    const struct mh_transition transition = {NULL, to_cartesian};
    const mh_real Q[3] = {1, 0, 1}, bad_Q[3] = {1, NAN, 1};
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_ekf_predict(&g, &transition, bad_Q));
    g.x[0] = before.x[0] = 3e38f; /* its Jacobian's square overflows */
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_ekf_predict(&g, &transition, Q));
    g.n = before.n = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_ekf_predict(&g, &transition, Q));
    TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(published_clusters);
    RUN_TEST(published_source);
    RUN_TEST(linear_is_kalmans);
    RUN_TEST(prediction_by_the_jacobian);
    RUN_TEST(diffuse_prior);
    RUN_TEST(bearings_wrap);
    RUN_TEST(bad_input_changes_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
