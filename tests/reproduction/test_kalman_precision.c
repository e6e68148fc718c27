/* The filter in mh_real against the same filter in double precision, from a diffuse prior: P0 = 1e6, R = 1e-4. */
#include "motehound/kalman.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

void setUp(void) {}
void tearDown(void) {}

static uint32_t seed;

static mh_real draw(void) /* uniform in -1 to 1 */
{
    seed = seed * 1664525u + 1013904223u;
    return (mh_real)(int32_t)(seed >> 8) * (2.0f / 16777216.0f) - 1.0f;
}

/* U D U', in double, without rounding worth the name */
static void covariance(const struct mh_kalman *filter, double P[4][4])
{
    double U[4][4] = {{0}};
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < j; i++) {
            U[i][j] = (double)filter->ud[MH_PACKED(i, j)];
        }
        U[j][j] = 1;
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            P[i][j] = 0;
            for (int k = 0; k < 4; k++) {
                P[i][j] += U[i][k] * (double)filter->ud[MH_PACKED(k, k)] * U[j][k];
            }
        }
    }
}

static bool cholesky_exists(double P[4][4])
{
    double L[4][4] = {{0}};
    for (int j = 0; j < 4; j++) {
        for (int i = j; i < 4; i++) {
            double sum = P[i][j];
            for (int k = 0; k < j; k++) {
                sum -= L[i][k] * L[j][k];
            }
            if (i == j && !(sum > 0)) {
                return false;
            }
            L[i][j] = i == j ? sqrt(sum) : sum / L[j][j];
        }
    }
    return true;
}

static void reference_update(double P[4][4], const mh_real *h, double R) /* Joseph's form */
{
    double K[4], A[4][4], AP[4][4], s = R;
    for (int i = 0; i < 4; i++) {
        K[i] = 0;
        for (int j = 0; j < 4; j++) {
            K[i] += P[i][j] * (double)h[j];
        }
        s += (double)h[i] * K[i];
    }
    for (int i = 0; i < 4; i++) {
        K[i] /= s;
        for (int j = 0; j < 4; j++) {
            A[i][j] = (i == j) - K[i] * (double)h[j];
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            AP[i][j] = 0;
            for (int k = 0; k < 4; k++) {
                AP[i][j] += A[i][k] * P[k][j];
            }
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            P[i][j] = K[i] * R * K[j];
            for (int k = 0; k < 4; k++) {
                P[i][j] += AP[i][k] * A[j][k];
            }
        }
    }
}

static void reference_predict(double P[4][4], const mh_real *F, const mh_real *Q)
{
    double FP[4][4];
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            FP[i][j] = 0;
            for (int k = 0; k < 4; k++) {
                FP[i][j] += (double)F[4 * i + k] * P[k][j];
            }
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            P[i][j] = (double)(i <= j ? Q[MH_PACKED(i, j)] : Q[MH_PACKED(j, i)]);
            for (int k = 0; k < 4; k++) {
                P[i][j] += FP[i][k] * (double)F[4 * j + k];
            }
        }
    }
}

/* 200 updates of two scalars, in 100 filters a kind: at rest, at constant velocity with positions measured, and with full random F.
 * Every covariance on the way is positive definite; the last variances are right. */
static void diffuse_prior(void)
{
    static const mh_real zero[4] = {0};
    static const mh_real P0[10] = {1e6f, 0, 1e6f, 0, 0, 1e6f, 0, 0, 0, 1e6f};
    const mh_real R = 1e-4f;
    for (int kind = 0; kind < 3; kind++) {
        double worst = 0;
        seed = 11;
        for (int round = 0; round < 100; round++) {
            struct mh_kalman filter;
            mh_real F[16], Q[10];
            double P[4][4] = {{1e6, 0, 0, 0}, {0, 1e6, 0, 0}, {0, 0, 1e6, 0}, {0, 0, 0, 1e6}}, got[4][4];
            mh_kalman_constant_velocity(0.1f, 1e-3f, F, Q);
            for (int i = 0; kind == 2 && i < 16; i++) {
                F[i] = 0.5f * draw() + (i % 5 == 0 ? 0.5f : 0);
            }
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 4, zero, P0));
            for (int i = 0; i < 200; i++) {
                for (int m = 0; m < 2; m++) {
                    const mh_real h[4] = {draw(), draw(), kind == 1 ? 0 : draw(), kind == 1 ? 0 : draw()};
                    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&filter, h, draw(), R, NULL));
                    reference_update(P, h, (double)R);
                    covariance(&filter, got);
                    TEST_ASSERT_TRUE(cholesky_exists(got));
                }
                if (kind > 0) {
                    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&filter, F, Q));
                    reference_predict(P, F, Q);
                    covariance(&filter, got);
                    TEST_ASSERT_TRUE(cholesky_exists(got));
                }
            }
            for (int i = 0; i < 4; i++) {
                TEST_ASSERT_TRUE(mh_finite(filter.x[i]));
                worst = fmax(worst, fabs(got[i][i] / P[i][i] - 1));
            }
        }
        char message[80];
        snprintf(message, sizeof message, "kind %d: largest relative error of a variance %.1e", kind, worst);
        TEST_MESSAGE(message);
        TEST_ASSERT_TRUE_MESSAGE(worst < 1e-3, message);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(diffuse_prior);
    port_exit(UNITY_END() > 0);
    return 0;
}
