#include "motehound/kalman.h"
#include "port.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

#if MH_REAL_FIXED
#define BAD MH_REAL_INFINITE
#define INFINITE MH_REAL_INFINITE
#define WORSE (-ONE) /* than a variance of 0 */
#define HUGE_REAL MH_REAL(30000.0f)
#define COARSER 5 /* times the rounding of a float that these tests allow */
#else
#define BAD NAN
#define INFINITE INFINITY
#define WORSE NAN
#define HUGE_REAL 1e30f
#define COARSER 1
#endif
#define ONE MH_REAL(1.0f)

/* reals within a tolerance */
static void assert_near(float tolerance, float expected, mh_real actual)
{
    TEST_ASSERT_FLOAT_WITHIN(COARSER * tolerance, expected, mh_real_to_float(actual));
}

static uint32_t seed;

/* uniform in -1 to 1 */
static mh_real draw(void)
{
    seed = seed * 1664525u + 1013904223u;
    return mh_real_from_float((float)(int32_t)(seed >> 8) * (2.0f / 16777216.0f) - 1.0f);
}

/* P = (5 1; 1 2) = U D U' with D = (4.5, 2), U_12 = 1/2: exact in 8 bits, so the same bytes in both arithmetics, and the same P after them */
static void factors_as_bytes(void)
{
    static const uint8_t expected[] = {0x40, 0x90, 0x3f, 0x00, 0x40, 0x00};
    static const uint8_t wrong[][2] = {
        {0, 0x80}, {0, 0}, {0, 0x7f}, {2, 0x7f}}; /* below 0, 0, beyond all numbers, U too */
    struct mh_kalman filter, read = {.n = 2, .moving = 2};
    const mh_real x[] = {0, 0}, P[] = {MH_REAL(5.0f), ONE, MH_REAL(2.0f)};
    uint8_t bytes[MH_KALMAN_FACTOR_BYTES(2)], *end = bytes;
    const uint8_t *at = bytes;
    mh_real after[3];
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 2, x, P));
    mh_kalman_write_factors(&filter, &end);
    TEST_ASSERT_EQUAL_UINT(sizeof expected, end - bytes);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, bytes, sizeof expected);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_read_factors(&read, &at));
    TEST_ASSERT_TRUE(at == end);
    mh_kalman_covariance(&read, after);
    assert_near(1e-5f, 5, after[0]);
    assert_near(1e-5f, 1, after[1]);
    assert_near(1e-5f, 2, after[2]);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        memcpy(bytes, expected, sizeof bytes);
        bytes[wrong[i][0]] = wrong[i][1];
        bytes[wrong[i][0] + 1] = i == 1 ? 0 : 0xff;
        at = bytes;
        TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_kalman_read_factors(&read, &at));
    }
}

/* P = 4, R = 1: the gain is 4/5, the variance after it 4/5 */
static void one_state_by_hand(void)
{
    struct mh_kalman filter;
    const mh_real x = MH_REAL(10.0f), P = MH_REAL(4.0f), h = ONE, F = MH_REAL(2.0f), Q = MH_REAL(0.5f);
    mh_real after;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 1, &x, &P));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&filter, &h, MH_REAL(5.0f), ONE, NULL));
    mh_kalman_covariance(&filter, &after);
    assert_near(1e-5f, 14.0f, filter.x[0]);
    assert_near(2e-6f, 0.8f, after);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&filter, &F, &Q));
    mh_kalman_covariance(&filter, &after);
    assert_near(1e-5f, 28.0f, filter.x[0]);
    assert_near(1e-5f, 3.7f, after);
}

static void covariance_goes_in_and_comes_out(void)
{
    struct mh_kalman filter;
    const mh_real x[3] = {MH_REAL(1.0f), MH_REAL(2.0f), MH_REAL(3.0f)};
    const mh_real P[6] = {MH_REAL(4.0f), MH_REAL(1.0f), MH_REAL(3.0f), MH_REAL(-0.5f), MH_REAL(0.25f), MH_REAL(2.0f)};
    mh_real out[6];
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 3, x, P));
    mh_kalman_covariance(&filter, out);
    for (int i = 0; i < 6; i++) {
        assert_near(3e-6f, mh_real_to_float(P[i]), out[i]);
    }
}

static float full(const mh_real *P, int i, int j)
{
    return mh_real_to_float(i <= j ? P[MH_PACKED(i, j)] : P[MH_PACKED(j, i)]);
}

/* F P F' + Q and P - P h h' P / (h' P h + R), written out, with F, Q and h full of random numbers */
static void agrees_with_the_textbook(void)
{
    seed = 7;
    for (int round = 0; round < 20; round++) {
        struct mh_kalman filter;
        mh_real x[4], F[16], Q[10] = {0}, P[10] = {0}, out[10], h[4];
        float expected_x[4], Ph[4] = {0}, FP[4][4], expected[4][4];
        for (int i = 0; i < 4; i++) {
            x[i] = 10 * draw();
            h[i] = draw();
            Q[MH_PACKED(i, i)] = MH_REAL(0.1f);
            P[MH_PACKED(i, i)] = MH_REAL(2.0f) + draw();
        }
        P[MH_PACKED(0, 2)] = MH_REAL(0.5f);
        P[MH_PACKED(1, 2)] = MH_REAL(-0.3f);
        for (int i = 0; i < 16; i++) {
            F[i] = i < 4 * (round % 5) ? 0 : draw(); /* with rows of zeros too */
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 4, x, P));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&filter, F, Q));
        for (int i = 0; i < 4; i++) {
            expected_x[i] = 0;
            for (int j = 0; j < 4; j++) {
                expected_x[i] += mh_real_to_float(F[4 * i + j]) * mh_real_to_float(x[j]);
                FP[i][j] = 0;
                for (int k = 0; k < 4; k++) {
                    FP[i][j] += mh_real_to_float(F[4 * i + k]) * full(P, k, j);
                }
            }
        }
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++) {
                expected[i][j] = full(Q, i, j);
                for (int k = 0; k < 4; k++) {
                    expected[i][j] += FP[i][k] * mh_real_to_float(F[4 * j + k]);
                }
            }
        }
        float s = 0.5f;
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++) {
                Ph[i] += expected[i][j] * mh_real_to_float(h[j]);
            }
            s += mh_real_to_float(h[i]) * Ph[i];
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&filter, h, MH_REAL(3.0f), MH_REAL(0.5f), NULL));
        mh_kalman_covariance(&filter, out);
        for (int i = 0; i < 4; i++) {
            assert_near(2e-4f, expected_x[i] + Ph[i] * 3.0f / s, filter.x[i]);
            for (int j = 0; j <= i; j++) {
                TEST_ASSERT_FLOAT_WITHIN(2e-5f * COARSER, expected[i][j] - Ph[i] * Ph[j] / s, full(out, i, j));
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

/* In fixed point 1e6 is no number; the largest is 3e4. */
static void diffuse_prior(void)
{
#if MH_REAL_FIXED
    const float prior = 3e4f;
#else
    const float prior = 1e6f;
#endif
    const mh_real zero[4] = {0}, variance = mh_real_from_float(prior), noise = MH_REAL(1e-4f);
    const mh_real P[10] = {variance, 0, variance, 0, 0, variance, 0, 0, 0, variance};
    mh_real F[16], Q[10], out[10];
    mh_kalman_constant_velocity(MH_REAL(0.1f), MH_REAL(1e-6f), F, Q);
    for (int moving = 0; moving < 2; moving++) {
        struct mh_kalman filter;
#if MH_REAL_FIXED
        const mh_real larger = mh_real_from_float(1e6f), Q1[10] = {larger, 0, larger, 0, 0, larger, 0, 0, 0, larger};
        TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_init(&filter, 4, zero, Q1));
#endif
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 4, zero, P));
        seed = 3;
        for (int i = 0; i < 200; i++) {
            for (int m = 0; m < 2; m++) {
                const mh_real h[4] = {draw(), draw(), moving ? 0 : draw(), moving ? 0 : draw()};
                TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&filter, h, 0, noise, NULL));
                assert_definite(&filter);
            }
            if (moving) {
                TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&filter, F, Q));
                assert_definite(&filter);
            }
        }
        mh_kalman_covariance(&filter, out);
        /* a hundred times what 400 measurements of this noise leave at most */
        TEST_ASSERT_TRUE(out[MH_PACKED(0, 0)] < MH_REAL(1e-3f) && out[MH_PACKED(1, 1)] < MH_REAL(1e-3f));
    }
}

static void constant_velocity_model(void)
{
    mh_real F[16], Q[10];
    mh_kalman_constant_velocity(MH_REAL(2.0f), MH_REAL(3.0f), F, Q);
    assert_near(0, 2, F[2]);
    assert_near(0, 2, F[7]);
    assert_near(1e-5f, 8, Q[MH_PACKED(0, 0)]);
    assert_near(0, 6, Q[MH_PACKED(0, 2)]);
    assert_near(0, 6, Q[MH_PACKED(1, 3)]);
    assert_near(0, 6, Q[MH_PACKED(3, 3)]);
    assert_near(0, 0, Q[MH_PACKED(0, 1)]);
    /* two half steps are one whole step */
    const mh_real zero[4] = {0};
    const mh_real P[10] = {ONE, 0, ONE, 0, 0, ONE, 0, 0, 0, ONE};
    mh_real once[10], twice[10];
    struct mh_kalman a, b;
    mh_kalman_init(&a, 4, zero, P);
    mh_kalman_init(&b, 4, zero, P);
    mh_kalman_predict(&a, F, Q);
    mh_kalman_constant_velocity(ONE, MH_REAL(3.0f), F, Q);
    mh_kalman_predict(&b, F, Q);
    mh_kalman_predict(&b, F, Q);
    mh_kalman_covariance(&a, once);
    mh_kalman_covariance(&b, twice);
    for (int i = 0; i < 10; i++) {
        assert_near(1e-5f, mh_real_to_float(once[i]), twice[i]);
    }
}

/* two states that move and two that do not, against a filter to which all four move, two of them by an identity; with one variance read */
static void states_that_do_not_move(void)
{
    const mh_real half = MH_REAL(0.5f), quarter = MH_REAL(0.25f), two = MH_REAL(2.0f);
    const mh_real x[4] = {ONE, two, 0, 0}, P2[3] = {2 * two, ONE, 3 * ONE}, F2[4] = {ONE, half, -quarter, ONE};
    const mh_real Q2[3] = {half, quarter, half}, P4[10] = {2 * two, ONE, 3 * ONE, 0, 0, two, 0, 0, 0, half};
    const mh_real F4[16] = {ONE, half, 0, 0, -quarter, ONE, 0, 0, 0, 0, ONE, 0, 0, 0, 0, ONE};
    const mh_real Q4[10] = {half, quarter, half, 0, 0, 0, 0, 0, 0, 0};
    struct mh_kalman a, b;
    mh_real left[10], right[10];
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&a, 2, x, P2));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_append(&a, 0, two));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_append(&a, 0, half));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&b, 4, x, P4));
    seed = 5;
    for (int i = 0; i < 20; i++) {
        const mh_real h[4] = {draw(), draw(), ONE, draw()}, innovation = draw();
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&a, h, innovation, half, NULL));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&b, h, innovation, half, NULL));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&a, F2, Q2));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&b, F4, Q4));
        mh_kalman_covariance(&a, left);
        mh_kalman_covariance(&b, right);
        for (int k = 0; k < 10; k++) {
            assert_near(1e-4f, mh_real_to_float(right[k]), left[k]);
        }
        for (int k = 0; k < 4; k++) {
            assert_near(1e-4f, mh_real_to_float(b.x[k]), a.x[k]);
            assert_near(1e-4f, mh_real_to_float(right[MH_PACKED(k, k)]), mh_kalman_variance(&a, (uint8_t)k));
        }
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&a, 2, x, P2));
    const struct mh_kalman before = a;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_append(&a, BAD, ONE));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_append(&a, 0, INFINITE));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_kalman_append(&a, 0, 0));
    TEST_ASSERT_EQUAL_MEMORY(&before, &a, sizeof a);
    while (a.n < MH_KALMAN_STATES_MAX) {
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_append(&a, 0, ONE));
    }
    TEST_ASSERT_EQUAL_INT(MH_ERR_CAPACITY, mh_kalman_append(&a, 0, ONE));
}

static void bad_input_changes_nothing(void)
{
    struct mh_kalman filter, before;
    const mh_real x[2] = {ONE, 2 * ONE}, bad_x[2] = {ONE, BAD};
    const mh_real P[3] = {ONE, ONE / 2, ONE}, indefinite[3] = {ONE, 2 * ONE, ONE}, semidefinite[3] = {ONE, ONE, ONE},
                  bad_P[3] = {ONE, BAD, ONE};
    const mh_real h[2] = {ONE, 0}, bad_h[2] = {ONE, INFINITE};
    const mh_real F[4] = {ONE, ONE, 0, ONE}, bad_F[4] = {ONE, BAD, 0, ONE}, huge_F[4] = {HUGE_REAL, 0, 0, ONE};
    const mh_real Q[3] = {ONE, 0, ONE}, bad_Q[3] = {ONE, BAD, ONE};
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
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_update(&filter, h, BAD, ONE, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_update(&filter, h, INFINITE, ONE, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_update(&filter, bad_h, 0, ONE, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_kalman_update(&filter, h, 0, 0, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_kalman_update(&filter, h, 0, WORSE, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof filter);
}

#if !MH_REAL_FIXED
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
#endif

static void gate_keeps_outliers_out_but_not_for_good(void)
{
    struct mh_kalman filter, before;
    struct mh_gate gate = {.sigmas = MH_REAL(3.0f), .patience = 4};
    const mh_real x[2] = {0, 0}, P[3] = {ONE, 0, ONE}, h[2] = {ONE, 0};
    mh_real out[3];
    mh_kalman_init(&filter, 2, x, P);
    memcpy(&before, &filter, sizeof filter);
    for (int i = 0; i < 4; i++) { /* 100 is 50 standard deviations */
        TEST_ASSERT_EQUAL_INT(MH_NONE, mh_kalman_update(&filter, h, MH_REAL(100.0f), MH_REAL(3.0f), &gate));
        TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof filter);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&filter, h, MH_REAL(100.0f), MH_REAL(3.0f), &gate));
    TEST_ASSERT_EQUAL_UINT8(0, gate.refused);
    /* widened to s = (100 / 3)^2, of which 3 are noise */
    const float s = 10000.0f / 9.0f;
    mh_kalman_covariance(&filter, out);
    assert_near(0.01f, 100.0f * (s - 3.0f) / s, filter.x[0]);
    assert_near(0.01f, 3.0f * (s - 3.0f) / s, out[0]);
    assert_near(1.0f, s - 3.0f, out[2]);
    /* three in a row, one good, three in a row: never believed */
    for (int i = 0; i < 7; i++) {
        const mh_real innovation = i == 3 ? 0 : MH_REAL(1000.0f);
        TEST_ASSERT_EQUAL_INT(i == 3 ? MH_OK : MH_NONE, mh_kalman_update(&filter, h, innovation, MH_REAL(3.0f), &gate));
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
    RUN_TEST(factors_as_bytes);
    RUN_TEST(bad_input_changes_nothing);
#if !MH_REAL_FIXED
    RUN_TEST(what_does_not_fit_changes_nothing);
#endif
    RUN_TEST(gate_keeps_outliers_out_but_not_for_good);
    RUN_TEST(states_that_do_not_move);
    port_exit(UNITY_END() > 0);
    return 0;
}
