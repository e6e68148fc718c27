#include "motehound/kalman.h"
#include "port.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static uint32_t seed;

/* uniform in -1 to 1 */
static mh_real draw(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (mh_real)(int32_t)(seed >> 8) * (2.0f / 16777216.0f) - 1.0f;
}

/* P = 4, R = 1: the gain is 4/5, the variance after it 4/5 */
static void one_state_by_hand(void)
{
    struct mh_kalman filter;
    const mh_real x = 10, P = 4, h = 1, F = 2, Q = 0.5f;
    mh_real after;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 1, &x, &P));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&filter, &h, 5.0f, 1.0f, NULL));
    mh_kalman_covariance(&filter, &after);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 14.0f, filter.x[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.8f, after);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&filter, &F, &Q));
    mh_kalman_covariance(&filter, &after);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 28.0f, filter.x[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 3.7f, after);
}

static void covariance_goes_in_and_comes_out(void)
{
    struct mh_kalman filter;
    const mh_real x[3] = {1, 2, 3};
    const mh_real P[6] = {4, 1, 3, -0.5f, 0.25f, 2};
    mh_real out[6];
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 3, x, P));
    mh_kalman_covariance(&filter, out);
    for (int i = 0; i < 6; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, P[i], out[i]);
    }
}

static mh_real full(const mh_real *P, int i, int j) { return i <= j ? P[MH_PACKED(i, j)] : P[MH_PACKED(j, i)]; }

/* F P F' + Q and P - P h h' P / (h' P h + R), written out, with F, Q and h full of random numbers */
static void agrees_with_the_textbook(void)
{
    seed = 7;
    for (int round = 0; round < 20; round++) {
        struct mh_kalman filter;
        mh_real x[4], expected_x[4], F[16], Q[10] = {0}, P[10] = {0}, out[10], h[4], Ph[4] = {0};
        mh_real FP[4][4], expected[4][4];
        for (int i = 0; i < 4; i++) {
            x[i] = 10 * draw();
            h[i] = draw();
            Q[MH_PACKED(i, i)] = 0.1f;
            P[MH_PACKED(i, i)] = 2 + draw();
        }
        P[MH_PACKED(0, 2)] = 0.5f;
        P[MH_PACKED(1, 2)] = -0.3f;
        for (int i = 0; i < 16; i++) {
            F[i] = i < 4 * (round % 5) ? 0 : draw(); /* with rows of zeros too */
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 4, x, P));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&filter, F, Q));
        for (int i = 0; i < 4; i++) {
            expected_x[i] = 0;
            for (int j = 0; j < 4; j++) {
                expected_x[i] += F[4 * i + j] * x[j];
                FP[i][j] = 0;
                for (int k = 0; k < 4; k++) {
                    FP[i][j] += F[4 * i + k] * full(P, k, j);
                }
            }
        }
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++) {
                expected[i][j] = full(Q, i, j);
                for (int k = 0; k < 4; k++) {
                    expected[i][j] += FP[i][k] * F[4 * j + k];
                }
            }
        }
        mh_real s = 0.5f;
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++) {
                Ph[i] += expected[i][j] * h[j];
            }
            s += h[i] * Ph[i];
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&filter, h, 3.0f, 0.5f, NULL));
        mh_kalman_covariance(&filter, out);
        for (int i = 0; i < 4; i++) {
            TEST_ASSERT_FLOAT_WITHIN(2e-4f, expected_x[i] + Ph[i] * 3.0f / s, filter.x[i]);
            for (int j = 0; j <= i; j++) {
                TEST_ASSERT_FLOAT_WITHIN(2e-5f, expected[i][j] - Ph[i] * Ph[j] / s, full(out, i, j));
            }
        }
    }
}

/* positive and finite pivots are a positive definite P */
static void assert_definite(const struct mh_kalman *filter)
{
    for (uint8_t i = 0; i < filter->n; i++) {
        TEST_ASSERT_TRUE(filter->ud[MH_PACKED(i, i)] > 0);
        TEST_ASSERT_TRUE(mh_finite(filter->ud[MH_PACKED(i, i)]));
    }
}

static void diffuse_prior(void)
{
    const mh_real zero[4] = {0};
    const mh_real P[10] = {1e6f, 0, 1e6f, 0, 0, 1e6f, 0, 0, 0, 1e6f};
    mh_real F[16], Q[10], out[10];
    mh_kalman_constant_velocity(0.1f, 1e-6f, F, Q);
    for (int moving = 0; moving < 2; moving++) {
        struct mh_kalman filter;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 4, zero, P));
        seed = 3;
        for (int i = 0; i < 200; i++) {
            for (int m = 0; m < 2; m++) {
                const mh_real h[4] = {draw(), draw(), moving ? 0 : draw(), moving ? 0 : draw()};
                TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&filter, h, 0, 1e-4f, NULL));
                assert_definite(&filter);
            }
            if (moving) {
                TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&filter, F, Q));
                assert_definite(&filter);
            }
        }
        mh_kalman_covariance(&filter, out);
        /* a hundred times what 400 measurements of this noise leave at most */
        TEST_ASSERT_TRUE(out[MH_PACKED(0, 0)] < 1e-3f && out[MH_PACKED(1, 1)] < 1e-3f);
    }
}

static void constant_velocity_model(void)
{
    mh_real F[16], Q[10];
    mh_kalman_constant_velocity(2.0f, 3.0f, F, Q);
    TEST_ASSERT_EQUAL_FLOAT(2, F[2]);
    TEST_ASSERT_EQUAL_FLOAT(2, F[7]);
    TEST_ASSERT_EQUAL_FLOAT(8, Q[MH_PACKED(0, 0)]);
    TEST_ASSERT_EQUAL_FLOAT(6, Q[MH_PACKED(0, 2)]);
    TEST_ASSERT_EQUAL_FLOAT(6, Q[MH_PACKED(1, 3)]);
    TEST_ASSERT_EQUAL_FLOAT(6, Q[MH_PACKED(3, 3)]);
    TEST_ASSERT_EQUAL_FLOAT(0, Q[MH_PACKED(0, 1)]);
    /* two half steps are one whole step */
    const mh_real zero[4] = {0};
    const mh_real P[10] = {1, 0, 1, 0, 0, 1, 0, 0, 0, 1};
    mh_real once[10], twice[10];
    struct mh_kalman a, b;
    mh_kalman_init(&a, 4, zero, P);
    mh_kalman_init(&b, 4, zero, P);
    mh_kalman_predict(&a, F, Q);
    mh_kalman_constant_velocity(1.0f, 3.0f, F, Q);
    mh_kalman_predict(&b, F, Q);
    mh_kalman_predict(&b, F, Q);
    mh_kalman_covariance(&a, once);
    mh_kalman_covariance(&b, twice);
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, once[i], twice[i]);
    }
}

/* two states that move and two that do not, against a filter to which all four move, two of them by an identity; with one variance read */
static void states_that_do_not_move(void)
{
    const mh_real x[4] = {1, 2, 0, 0}, P2[3] = {4, 1, 3}, F2[4] = {1, 0.5f, -0.25f, 1}, Q2[3] = {0.5f, 0.25f, 0.5f};
    const mh_real P4[10] = {4, 1, 3, 0, 0, 2, 0, 0, 0, 0.5f};
    const mh_real F4[16] = {1, 0.5f, 0, 0, -0.25f, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const mh_real Q4[10] = {0.5f, 0.25f, 0.5f, 0, 0, 0, 0, 0, 0, 0};
    struct mh_kalman a, b;
    mh_real left[10], right[10];
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&a, 2, x, P2));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_append(&a, 0, 2));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_append(&a, 0, 0.5f));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&b, 4, x, P4));
    seed = 5;
    for (int i = 0; i < 20; i++) {
        const mh_real h[4] = {draw(), draw(), 1, draw()}, innovation = draw();
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&a, h, innovation, 0.5f, NULL));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&b, h, innovation, 0.5f, NULL));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&a, F2, Q2));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&b, F4, Q4));
        mh_kalman_covariance(&a, left);
        mh_kalman_covariance(&b, right);
        for (int k = 0; k < 10; k++) {
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, right[k], left[k]);
        }
        for (int k = 0; k < 4; k++) {
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, b.x[k], a.x[k]);
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, right[MH_PACKED(k, k)], mh_kalman_variance(&a, (uint8_t)k));
        }
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&a, 2, x, P2));
    const struct mh_kalman before = a;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_append(&a, NAN, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_append(&a, 0, INFINITY));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_kalman_append(&a, 0, 0));
    TEST_ASSERT_EQUAL_MEMORY(&before, &a, sizeof a);
    while (a.n < MH_KALMAN_STATES_MAX) {
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_append(&a, 0, 1));
    }
    TEST_ASSERT_EQUAL_INT(MH_ERR_CAPACITY, mh_kalman_append(&a, 0, 1));
}

static void bad_input_changes_nothing(void)
{
    struct mh_kalman filter, before;
    const mh_real x[2] = {1, 2}, bad_x[2] = {1, NAN};
    const mh_real P[3] = {1, 0.5f, 1}, indefinite[3] = {1, 2, 1}, semidefinite[3] = {1, 1, 1}, bad_P[3] = {1, NAN, 1};
    const mh_real h[2] = {1, 0}, bad_h[2] = {1, INFINITY};
    const mh_real F[4] = {1, 1, 0, 1}, bad_F[4] = {1, NAN, 0, 1}, huge_F[4] = {1e30f, 0, 0, 1};
    const mh_real Q[3] = {1, 0, 1}, bad_Q[3] = {1, NAN, 1};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 2, x, P));
    memcpy(&before, &filter, sizeof filter);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_kalman_init(&filter, 0, x, P));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_kalman_init(&filter, MH_KALMAN_MOVING_MAX + 1, x, P));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_init(&filter, 2, bad_x, P));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_init(&filter, 2, x, bad_P));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_kalman_init(&filter, 2, x, indefinite));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_kalman_init(&filter, 2, x, semidefinite));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_predict(&filter, bad_F, Q));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_predict(&filter, huge_F, Q));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_predict(&filter, F, bad_Q));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_update(&filter, h, NAN, 1, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_update(&filter, h, INFINITY, 1, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_update(&filter, bad_h, 0, 1, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_kalman_update(&filter, h, 0, 0, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_kalman_update(&filter, h, 0, NAN, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof filter);
}

/* Finite inputs whose result is too large, or too small, for a float. */
static void what_does_not_fit_changes_nothing(void)
{
    struct mh_kalman filter, before;
    struct mh_gate gate = {.sigmas = 3, .patience = 1, .refused = 1};
    const mh_real x[2] = {0, 0}, P[3] = {1e-10f, 0, 1e20f};
    const mh_real first[2] = {1, 0}, second[2] = {0, 1}, small[2] = {1e-10f, 0}, large[2] = {1e19f, 0};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 2, x, P));
    memcpy(&before, &filter, sizeof filter);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_kalman_update(&filter, second, 0, 1e-40f, NULL));      /* 1 / R */
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_update(&filter, small, 3e38f, 1e-30f, NULL)); /* x */
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_update(&filter, large, 0, 1e-20f, NULL));     /* P */
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_kalman_update(&filter, first, 1e8f, 1, &gate)); /* P, by widening */
    TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof filter);
    TEST_ASSERT_EQUAL_UINT8(1, gate.refused);
}

static void gate_keeps_outliers_out_but_not_for_good(void)
{
    struct mh_kalman filter, before;
    struct mh_gate gate = {.sigmas = 3, .patience = 4};
    const mh_real x[2] = {0, 0}, P[3] = {1, 0, 1}, h[2] = {1, 0};
    mh_real out[3];
    mh_kalman_init(&filter, 2, x, P);
    memcpy(&before, &filter, sizeof filter);
    for (int i = 0; i < 4; i++) { /* 100 is 50 standard deviations */
        TEST_ASSERT_EQUAL_INT(MH_NONE, mh_kalman_update(&filter, h, 100.0f, 3.0f, &gate));
        TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof filter);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&filter, h, 100.0f, 3.0f, &gate));
    TEST_ASSERT_EQUAL_UINT8(0, gate.refused);
    /* widened to s = (100 / 3)^2, of which 3 are noise */
    const mh_real s = 10000.0f / 9.0f;
    mh_kalman_covariance(&filter, out);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 100.0f * (s - 3.0f) / s, filter.x[0]);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 3.0f * (s - 3.0f) / s, out[0]);
    TEST_ASSERT_FLOAT_WITHIN(1.0f, s - 3.0f, out[2]);
    /* three in a row, one good, three in a row: never believed */
    for (int i = 0; i < 7; i++) {
        const mh_real innovation = i == 3 ? 0 : 1000.0f;
        TEST_ASSERT_EQUAL_INT(i == 3 ? MH_OK : MH_NONE, mh_kalman_update(&filter, h, innovation, 3.0f, &gate));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(one_state_by_hand);
    RUN_TEST(covariance_goes_in_and_comes_out);
    RUN_TEST(agrees_with_the_textbook);
    RUN_TEST(diffuse_prior);
    RUN_TEST(constant_velocity_model);
    RUN_TEST(bad_input_changes_nothing);
    RUN_TEST(what_does_not_fit_changes_nothing);
    RUN_TEST(gate_keeps_outliers_out_but_not_for_good);
    RUN_TEST(states_that_do_not_move);
    port_exit(UNITY_END() > 0);
    return 0;
}
