/* Covariance intersection in fixed point beside its formula in floating point, with the same numbers. */
#include "motehound/fusion.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

#if UINTPTR_MAX > 0xFFFFFFFF
typedef double wide_float;
enum { ROUNDS = 300 };
#else
typedef float wide_float;
enum { ROUNDS = 20 };
#endif
enum { ESTIMATES = 4 };

static uint32_t seed;

/* uniform in -1 to 1 */
static float draw(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (float)(int32_t)(seed >> 8) * (2.0f / 16777216.0f) - 1.0f;
}

static wide_float value(mh_real a) { return (wide_float)a / 65536; }

static struct mh_gaussian told[ESTIMATES], out;

/* Covariances of positions of some 10 m, velocities of some 1 m/s, as they are after a few seconds, of estimates of unlike quality. */
static void tell(uint8_t n)
{
    for (int e = 0; e < ESTIMATES; e++) {
        float A[4][4];
        const float quality = 0.4f + 0.75f * (1 + draw());
        told[e].n = n;
        for (int i = 0; i < n; i++) {
            const float size = quality * (i < 2 ? 5 : 0.5f);
            told[e].x[i] = mh_real_from_float(size * draw() + (i < 2 ? 100 : 1));
            for (int k = 0; k < n; k++) {
                A[i][k] = size * (draw() + (i == k));
            }
        }
        for (int j = 0; j < n; j++) {
            for (int i = 0; i <= j; i++) {
                float sum = i == j ? (i < 2 ? 1 : 0.01f) : 0;
                for (int k = 0; k < n; k++) {
                    sum += A[i][k] * A[j][k];
                }
                told[e].P[MH_PACKED(i, j)] = mh_real_from_float(sum);
            }
        }
    }
}

/* a := a^-1, symmetric positive definite, by Gauss and Jordan */
static void invert(int n, wide_float a[4][4])
{
    for (int p = 0; p < n; p++) {
        const wide_float pivot = a[p][p];
        a[p][p] = 1;
        for (int k = 0; k < n; k++) {
            a[p][k] /= pivot;
        }
        for (int i = 0; i < n; i++) {
            if (i != p) {
                const wide_float factor = a[i][p];
                a[i][p] = 0;
                for (int k = 0; k < n; k++) {
                    a[i][k] -= factor * a[p][k];
                }
            }
        }
    }
}

/* Xu, Eqs. (29)-(30) */
static void formula(const mh_real *w, wide_float P[4][4], wide_float x[4])
{
    const int n = told[0].n;
    wide_float vector[4] = {0}, I[4][4];
    memset(P, 0, 16 * sizeof P[0][0]);
    for (int e = 0; e < ESTIMATES; e++) {
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++) {
                I[i][j] = value(told[e].P[mh_packed_index(i, j)]);
            }
        }
        invert(n, I);
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++) {
                P[i][j] += value(w[e]) * I[i][j];
                vector[i] += value(w[e]) * I[i][j] * value(told[e].x[j] - told[0].x[j]);
            }
        }
    }
    invert(n, P);
    for (int i = 0; i < n; i++) {
        x[i] = value(told[0].x[i]);
        for (int j = 0; j < n; j++) {
            x[i] += P[i][j] * vector[j];
        }
    }
}

/* States within 0.2 % of a standard deviation; the covariance within 0.2 % of its variances, and in no direction below the formula's. */
static void as_the_formula(void)
{
    seed = 1;
    for (int round = 0; round < ROUNDS; round++) {
        mh_real w[ESTIMATES];
        wide_float P[4][4], x[4];
        const uint8_t n = (uint8_t)(2 + round % 3);
        tell(n);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights(told, ESTIMATES, w));
        TEST_ASSERT_EQUAL_INT32(MH_REAL(1.0f), w[0] + w[1] + w[2] + w[3]);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(told, ESTIMATES, w, &out));
        formula(w, P, x);
        wide_float excess[4][4];
        for (int i = 0; i < n; i++) {
            TEST_ASSERT_FLOAT_WITHIN(0.002f * sqrtf((float)P[i][i]), (float)x[i], mh_real_to_float(out.x[i]));
            for (int j = 0; j < n; j++) {
                const float size = sqrtf((float)(P[i][i] * P[j][j]));
                const wide_float found = value(out.P[mh_packed_index(i, j)]);
                TEST_ASSERT_FLOAT_WITHIN(0.002f * size + 1e-4f, (float)P[i][j], (float)found);
                excess[i][j] = found - P[i][j];
            }
        }
        for (int p = 0; p < n; p++) { /* its pivots */
            TEST_ASSERT_TRUE(excess[p][p] > 0);
            for (int i = p + 1; i < n; i++) {
                for (int j = p + 1; j < n; j++) {
                    excess[i][j] -= excess[i][p] * excess[p][j] / excess[p][p];
                }
            }
        }
    }
}

static void weights_by_the_traces(void)
{
    mh_real w[ESTIMATES];
    memset(told, 0, sizeof told);
    for (int e = 0; e < ESTIMATES; e++) {
        told[e].n = 2;
        told[e].P[0] = told[e].P[2] = MH_REAL(1.0f) * (1 << e);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights(told, ESTIMATES, w));
    for (int e = 0; e < ESTIMATES; e++) {
        TEST_ASSERT_FLOAT_WITHIN(2e-5f, 8.0f / (float)(15 * (1 << e)), mh_real_to_float(w[e]));
    }
}

static void of_identical_estimates_it_is_that_estimate(void)
{
    const mh_real w[3] = {MH_REAL(0.2f), MH_REAL(0.5f), MH_REAL(0.3f)}, none[2] = {0, MH_REAL(1.0f)};
    seed = 2;
    tell(4);
    const struct mh_gaussian other = told[0], same = told[2];
    told[0] = told[1] = same;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(told, 3, w, &out));
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-3f + 2e-3f * mh_real_to_float(mh_abs(same.P[i])), mh_real_to_float(same.P[i]),
                                 mh_real_to_float(out.P[i]));
    }
    TEST_ASSERT_EQUAL_INT32(same.x[0], out.x[0]);
    told[0] = other; /* without a weight it has no say */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(told, 2, none, &told[0]));
    TEST_ASSERT_EQUAL_INT32(same.x[0], told[0].x[0]);
}

static void what_it_cannot_do_is_refused(void)
{
    mh_real w[2] = {MH_REAL(0.5f), MH_REAL(0.5f)}, half[2] = {MH_REAL(0.5f), MH_REAL(0.3f)};
    struct mh_gaussian before;
    seed = 3;
    tell(2);
    memset(&out, 0, sizeof out);
    before = out;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_weights_trace(told, 2, w));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_inverse(&told[0], &told[1], &out));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_intersect(told, 2, half, &out));
    told[1].n = 3;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_intersect(told, 2, w, &out));
    told[1].n = 2;
    told[1].P[1] = told[1].P[0];
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_fusion_intersect(told, 2, w, &out));
    told[1].P[1] = MH_REAL_INFINITE;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_fusion_intersect(told, 2, w, &out));
    TEST_ASSERT_EQUAL_MEMORY(&before, &out, sizeof out);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(as_the_formula);
    RUN_TEST(weights_by_the_traces);
    RUN_TEST(of_identical_estimates_it_is_that_estimate);
    RUN_TEST(what_it_cannot_do_is_refused);
    port_exit(UNITY_END() > 0);
    return 0;
}
