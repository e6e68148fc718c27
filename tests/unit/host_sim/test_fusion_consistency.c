/* Fusion against what it promises, by brute force in double precision over random estimates. */
#include "motehound/fusion.h"
#include "port.h"
#include "unity.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { N = 4, ESTIMATES = 4, ALL = N * ESTIMATES };

void setUp(void) {}
void tearDown(void) {}

static uint64_t seed;

static uint32_t draw_bits(void)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(seed >> 32);
}

static double uniform(void) { return (double)draw_bits() / 4294967296.0; }

static double normal(void)
{
    double sum = 0;
    for (int i = 0; i < 12; i++) {
        sum += uniform();
    }
    return sum - 6;
}

/* Lower factor of the symmetric n x n matrix at `a`, rows `stride` apart, in place. Returns whether it is positive definite. */
static bool factor(int n, int stride, double *a)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = a[i * stride + j];
            for (int k = 0; k < j; k++) {
                sum -= a[i * stride + k] * a[j * stride + k];
            }
            if (i == j) {
                if (!(sum > 0)) {
                    return false;
                }
                a[i * stride + i] = sqrt(sum);
            } else {
                a[i * stride + j] = sum / a[j * stride + j];
            }
        }
    }
    return true;
}

static void unpack(const mh_real *packed, double a[N][N])
{
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            a[i][j] = (double)packed[mh_packed_index(i, j)];
        }
    }
}

static double trace(double a[N][N])
{
    double sum = 0;
    for (int i = 0; i < N; i++) {
        sum += a[i][i];
    }
    return sum;
}

/* a := a^-1; returns det a */
static double invert(double a[N][N])
{
    double b[N][N] = {{0}}, det = 1;
    for (int i = 0; i < N; i++) {
        b[i][i] = 1;
    }
    for (int k = 0; k < N; k++) {
        const double pivot = a[k][k];
        det *= pivot;
        for (int j = 0; j < N; j++) {
            a[k][j] /= pivot;
            b[k][j] /= pivot;
        }
        for (int i = 0; i < N; i++) {
            const double f = a[i][k];
            for (int j = 0; i != k && j < N; j++) {
                a[i][j] -= f * a[k][j];
                b[i][j] -= f * b[k][j];
            }
        }
    }
    memcpy(a, b, sizeof b);
    return det;
}

/* (sum w_i a_i^-1)^-1; returns its determinant */
static double harmonic(int count, const mh_real *const *packed, const double *w, double fused[N][N])
{
    memset(fused, 0, N * N * sizeof(double));
    for (int e = 0; e < count; e++) {
        double a[N][N];
        unpack(packed[e], a);
        invert(a);
        for (int i = 0; i < N * N; i++) {
            (&fused[0][0])[i] += w[e] * (&a[0][0])[i];
        }
    }
    return 1 / invert(fused);
}

/* A covariance with deviations from 0.1 to 10 and any correlations. */
static void random_estimate(struct mh_gaussian *estimate)
{
    double A[N][N], scale[N];
    memset(estimate, 0, sizeof *estimate);
    estimate->n = N;
    for (int i = 0; i < N; i++) {
        estimate->x[i] = (mh_real)(100 + normal());
        scale[i] = pow(10, 2 * uniform() - 1);
        for (int k = 0; k < N; k++) {
            A[i][k] = normal();
        }
    }
    for (int j = 0; j < N; j++) {
        for (int i = 0; i <= j; i++) {
            double sum = i == j ? 0.05 : 0;
            for (int k = 0; k < N; k++) {
                sum += A[i][k] * A[j][k];
            }
            estimate->P[MH_PACKED(i, j)] = (mh_real)(sum * scale[i] * scale[j]);
        }
    }
}

/* A joint covariance of all errors whose diagonal blocks are the parts given: L_i C_i^-1 C_ij C_j^-T L_j', where C C' is a random one and
 * L_i L_i' a part. With `tight` the errors hang together as closely as they can. */
static void random_joint(int count, const mh_real *const *parts, bool tight, double joint[ALL][ALL])
{
    static double B[ALL][ALL], C[ALL][ALL], T[ESTIMATES][N][N];
    const int size = count * N, rank = tight ? N : size;
    for (int i = 0; i < size; i++) {
        for (int k = 0; k < rank; k++) {
            B[i][k] = normal();
        }
    }
    for (int i = 0; i < size; i++) {
        for (int j = 0; j < size; j++) {
            C[i][j] = 0;
            for (int k = 0; k < rank; k++) {
                C[i][j] += B[i][k] * B[j][k];
            }
        }
    }
    for (int e = 0; e < count; e++) {
        double block[N][N], L[N][N];
        for (int i = 0; i < N; i++) {
            for (int j = 0; j < N; j++) {
                block[i][j] = C[e * N + i][e * N + j];
            }
        }
        unpack(parts[e], L);
        TEST_ASSERT_TRUE(factor(N, N, &block[0][0]));
        TEST_ASSERT_TRUE(factor(N, N, &L[0][0]));
        for (int i = 0; i < N; i++) { /* T = L block^-1, both lower triangular: T block = L */
            for (int j = N - 1; j >= 0; j--) {
                double sum = j <= i ? L[i][j] : 0;
                for (int k = j + 1; k < N; k++) {
                    sum -= T[e][i][k] * (k >= j ? block[k][j] : 0);
                }
                T[e][i][j] = sum / block[j][j];
            }
        }
    }
    for (int a = 0; a < size; a++) {
        for (int b = 0; b < size; b++) {
            joint[a][b] = 0;
            for (int i = 0; i < N; i++) {
                for (int j = 0; j < N; j++) {
                    joint[a][b] += T[a / N][a % N][i] * C[a / N * N + i][b / N * N + j] * T[b / N][b % N][j];
                }
            }
        }
    }
}

typedef bool (*fuse_function)(const struct mh_gaussian *estimates, int count, struct mh_gaussian *fused);

/* The true covariance of what `fuse` makes of errors with that joint covariance: what it does to means is linear, and asked for unit by unit. */
static void true_covariance(fuse_function fuse, const struct mh_gaussian *estimates, int count, double joint[ALL][ALL],
                            double truth[N][N])
{
    static double K[N][ALL];
    struct mh_gaussian zero[ESTIMATES], fused;
    memcpy(zero, estimates, (size_t)count * sizeof *zero);
    for (int e = 0; e < count; e++) {
        memset(zero[e].x, 0, sizeof zero[e].x);
    }
    for (int a = 0; a < count * N; a++) {
        zero[a / N].x[a % N] = 1;
        TEST_ASSERT_TRUE(fuse(zero, count, &fused));
        for (int i = 0; i < N; i++) {
            K[i][a] = (double)fused.x[i];
        }
        zero[a / N].x[a % N] = 0;
    }
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            truth[i][j] = 0;
            for (int a = 0; a < count * N; a++) {
                for (int b = 0; b < count * N; b++) {
                    truth[i][j] += K[i][a] * joint[a][b] * K[j][b];
                }
            }
        }
    }
}

/* Whether (1 + slack) claimed - truth is positive definite. */
static bool covers(const mh_real *claimed, double truth[N][N], double slack)
{
    double rest[N][N];
    unpack(claimed, rest);
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            rest[i][j] = (1 + slack) * rest[i][j] - truth[i][j];
        }
    }
    return factor(N, N, &rest[0][0]);
}

static bool fuse_ci(const struct mh_gaussian *estimates, int count, struct mh_gaussian *fused)
{
    mh_real w[ESTIMATES];
    return mh_fusion_weights(estimates, (uint8_t)count, w) == MH_OK &&
           mh_fusion_intersect(estimates, (uint8_t)count, w, fused) == MH_OK;
}

static bool fuse_ci_trace(const struct mh_gaussian *estimates, int count, struct mh_gaussian *fused)
{
    mh_real w[ESTIMATES];
    return mh_fusion_weights_trace(estimates, (uint8_t)count, w) == MH_OK &&
           mh_fusion_intersect(estimates, (uint8_t)count, w, fused) == MH_OK;
}

static bool fuse_ci_determinant(const struct mh_gaussian *estimates, int count, struct mh_gaussian *fused)
{
    mh_real w[ESTIMATES];
    return mh_fusion_weights_determinant(estimates, (uint8_t)count, w) == MH_OK &&
           mh_fusion_intersect(estimates, (uint8_t)count, w, fused) == MH_OK;
}

static bool fuse_naive(const struct mh_gaussian *estimates, int count, struct mh_gaussian *fused)
{
    return mh_fusion_naive(estimates, (uint8_t)count, fused) == MH_OK;
}

static bool fuse_inverse(const struct mh_gaussian *estimates, int count, struct mh_gaussian *fused)
{
    (void)count;
    return mh_fusion_inverse(&estimates[0], &estimates[1], fused) == MH_OK;
}

static bool fuse_ellipsoidal(const struct mh_gaussian *estimates, int count, struct mh_gaussian *fused)
{
    (void)count;
    return mh_fusion_ellipsoidal(&estimates[0], &estimates[1], fused) == MH_OK;
}

/* Covariance intersection is never too sure of itself, whatever the errors have in common. Naive fusion is, so the test can tell. */
static void covers_every_correlation(void)
{
    static double joint[ALL][ALL];
    static const fuse_function rules[] = {fuse_ci, fuse_ci_trace, fuse_ci_determinant};
    int naive_fails = 0;
    seed = 1;
    for (int round = 0; round < 300; round++) {
        struct mh_gaussian estimates[ESTIMATES], fused;
        const mh_real *parts[ESTIMATES];
        double truth[N][N];
        const int count = 2 + round % 3;
        for (int e = 0; e < count; e++) {
            random_estimate(&estimates[e]);
            parts[e] = estimates[e].P;
        }
        random_joint(count, parts, round % 2, joint);
        for (int r = 0; r < 3; r++) {
            TEST_ASSERT_TRUE(rules[r](estimates, count, &fused));
            true_covariance(rules[r], estimates, count, joint, truth);
            TEST_ASSERT_TRUE(covers(fused.P, truth, 1e-3));
        }
        TEST_ASSERT_TRUE(fuse_naive(estimates, count, &fused));
        true_covariance(fuse_naive, estimates, count, joint, truth);
        naive_fails += !covers(fused.P, truth, 1e-3);
    }
    TEST_ASSERT_TRUE(naive_fails > 250);
}

static struct mh_split_gaussian split_of[ESTIMATES];

/* The estimates give the means, split_of the covariances. */
static bool fuse_split(const struct mh_gaussian *estimates, int count, struct mh_gaussian *fused)
{
    struct mh_split_gaussian joined = split_of[0];
    for (int e = 0; e < count; e++) {
        struct mh_split_gaussian next = split_of[e];
        memcpy(next.dependent.x, estimates[e].x, sizeof next.dependent.x);
        if (e > 0 && mh_fusion_split(&joined, &next, &joined) != MH_OK) {
            return false;
        }
        if (e == 0) {
            joined = next;
        }
    }
    *fused = joined.dependent;
    for (int i = 0; i < MH_PACKED_SIZE(N); i++) {
        fused->P[i] += joined.independent[i];
    }
    return true;
}

/* Split covariance intersection is not, whatever the dependent parts have in common; and it is surer than covariance intersection of the whole. */
static void split_covers_what_depends(void)
{
    static double joint[ALL][ALL];
    double tighter = 0;
    const int rounds = 100;
    seed = 2;
    for (int round = 0; round < rounds; round++) {
        struct mh_gaussian estimates[ESTIMATES], fused, plain;
        const mh_real *parts[ESTIMATES];
        double truth[N][N], whole[N][N];
        const int count = 2 + round % 3;
        for (int e = 0; e < count; e++) {
            random_estimate(&estimates[e]);
            split_of[e].dependent = estimates[e];
            parts[e] = split_of[e].dependent.P;
            random_estimate(&plain);
            memcpy(split_of[e].independent, plain.P, sizeof plain.P);
            for (int i = 0; i < MH_PACKED_SIZE(N); i++) {
                estimates[e].P[i] += plain.P[i];
            }
        }
        random_joint(count, parts, round % 2, joint);
        for (int e = 0; e < count; e++) {
            for (int i = 0; i < N; i++) {
                for (int j = 0; j < N; j++) {
                    joint[e * N + i][e * N + j] += (double)split_of[e].independent[mh_packed_index(i, j)];
                }
            }
        }
        TEST_ASSERT_TRUE(fuse_split(estimates, count, &fused));
        true_covariance(fuse_split, estimates, count, joint, truth);
        TEST_ASSERT_TRUE(covers(fused.P, truth, 2e-3));
        TEST_ASSERT_TRUE(fuse_ci_trace(estimates, count, &plain));
        unpack(fused.P, truth);
        unpack(plain.P, whole);
        tighter += trace(truth) / trace(whole) / rounds;
    }
    TEST_ASSERT_TRUE(tighter < 0.9);
}

/* Inverse covariance intersection is not where both are made of one common estimate and news of their own. */
static void inverse_covers_common_information(void)
{
    static double joint[ALL][ALL];
    seed = 3;
    for (int round = 0; round < 200; round++) {
        struct mh_gaussian made[3], estimates[2], fused; /* 0: common; 1, 2: own */
        double own[3][N][N], P[2][N][N], truth[N][N];
        for (int k = 0; k < 3; k++) {
            random_estimate(&made[k]);
            unpack(made[k].P, own[k]);
            invert(own[k]);
        }
        for (int e = 0; e < 2; e++) {
            for (int i = 0; i < N * N; i++) {
                (&P[e][0][0])[i] = (&own[0][0][0])[i] + (&own[e + 1][0][0])[i];
            }
            invert(P[e]);
            estimates[e] = made[e];
            for (int j = 0; j < N; j++) {
                for (int i = 0; i <= j; i++) {
                    estimates[e].P[MH_PACKED(i, j)] = (mh_real)P[e][i][j];
                }
            }
        }
        /* what they have in common: Pa G^-1 Pb */
        for (int a = 0; a < 2; a++) {
            for (int b = 0; b < 2; b++) {
                for (int i = 0; i < N; i++) {
                    for (int j = 0; j < N; j++) {
                        double sum = 0;
                        for (int k = 0; k < N; k++) {
                            for (int m = 0; m < N; m++) {
                                sum += P[a][i][k] * own[0][k][m] * P[b][m][j];
                            }
                        }
                        joint[a * N + i][b * N + j] = a == b ? P[a][i][j] : sum;
                    }
                }
            }
        }
        TEST_ASSERT_TRUE(fuse_inverse(estimates, 2, &fused));
        true_covariance(fuse_inverse, estimates, 2, joint, truth);
        TEST_ASSERT_TRUE(covers(fused.P, truth, 2e-3));
    }
}

/* Against every weight on a grid of the simplex. */
static void weights_are_optimal(void)
{
    enum { GRID = 40 };
    seed = 4;
    for (int round = 0; round < 40; round++) {
        struct mh_gaussian estimates[3];
        const mh_real *parts[3];
        mh_real w[3];
        double found[3], P[N][N], least_trace = DBL_MAX, least_det = DBL_MAX;
        for (int e = 0; e < 3; e++) {
            random_estimate(&estimates[e]);
            parts[e] = estimates[e].P;
        }
        for (int i = 0; i <= GRID; i++) {
            for (int k = 0; k <= GRID - i; k++) {
                const double on_grid[3] = {(double)i / GRID, (double)k / GRID, (double)(GRID - i - k) / GRID};
                const double det = harmonic(3, parts, on_grid, P);
                least_trace = fmin(least_trace, trace(P));
                least_det = fmin(least_det, det);
            }
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights_trace(estimates, 3, w));
        for (int e = 0; e < 3; e++) {
            found[e] = (double)w[e];
        }
        harmonic(3, parts, found, P);
        TEST_ASSERT_TRUE(trace(P) < least_trace * (1 + 1e-3));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights_determinant(estimates, 3, w));
        for (int e = 0; e < 3; e++) {
            found[e] = (double)w[e];
        }
        TEST_ASSERT_TRUE(harmonic(3, parts, found, P) < least_det * (1 + 1e-3));
    }
}

/* The covariance of ellipsoidal intersection: L U min(1, D) U' L', where Pa = L L' and L^-1 Pb L^-T = U D U', by Jacobi's rotations of that matrix. */
static void ellipsoid(const struct mh_gaussian *e, double P[N][N])
{
    double L[N][N], C[N][N], T[N][N];
    unpack(e[0].P, L);
    unpack(e[1].P, C);
    TEST_ASSERT_TRUE(factor(N, N, &L[0][0]));
    for (int side = 0; side < 2; side++) { /* L^-1 from the left, then of the transposed */
        for (int column = 0; column < N; column++) {
            for (int i = 0; i < N; i++) {
                for (int k = 0; k < i; k++) {
                    C[i][column] -= L[i][k] * C[k][column];
                }
                C[i][column] /= L[i][i];
            }
        }
        for (int i = 0; i < N; i++) {
            for (int j = 0; j < i; j++) {
                const double swapped = C[i][j];
                C[i][j] = C[j][i];
                C[j][i] = swapped;
            }
        }
    }
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            T[i][j] = j <= i ? L[i][j] : 0;
        }
    }
    for (int turn = 0; turn < 30 * N * N; turn++) {
        const int p = turn / N % N, q = turn % N;
        if (p >= q || C[p][q] == 0) {
            continue;
        }
        const double angle = 0.5 * atan2(2 * C[p][q], C[q][q] - C[p][p]), c = cos(angle), s = sin(angle);
        for (int k = 0; k < N; k++) {
            const double left = C[p][k], right = C[q][k];
            C[p][k] = c * left - s * right;
            C[q][k] = s * left + c * right;
        }
        for (int k = 0; k < N; k++) {
            const double left = C[k][p], right = C[k][q], of_t = T[k][p];
            C[k][p] = c * left - s * right;
            C[k][q] = s * left + c * right;
            T[k][p] = c * of_t - s * T[k][q];
            T[k][q] = s * of_t + c * T[k][q];
        }
    }
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            P[i][j] = 0;
            for (int k = 0; k < N; k++) {
                P[i][j] += T[i][k] * fmin(C[k][k], 1) * T[j][k];
            }
        }
    }
}

/* The largest difference between two covariances, as a share of the deviations' product. */
static double distance(const struct mh_gaussian *a, double P[N][N])
{
    double largest = 0;
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            largest = fmax(largest, fabs((double)a->P[mh_packed_index(i, j)] - P[i][j]) / sqrt(P[i][i] * P[j][j]));
        }
    }
    return largest;
}

/* Of inverse covariance intersection by the formula and a grid of w; of ellipsoidal intersection by what defines it. */
static void pairs_are_as_defined(void)
{
    enum { GRID = 2000 };
    seed = 5;
    for (int round = 0; round < 60; round++) {
        struct mh_gaussian e[2], fused;
        double Ia[N][N], Ib[N][N], P[N][N], least = DBL_MAX, nearest = DBL_MAX;
        random_estimate(&e[0]);
        random_estimate(&e[1]);
        unpack(e[0].P, Ia);
        unpack(e[1].P, Ib);
        invert(Ia);
        invert(Ib);
        TEST_ASSERT_TRUE(fuse_inverse(e, 2, &fused));
        for (int step = 0; step <= GRID; step++) {
            const double w = (double)step / GRID;
            for (int i = 0; i < N; i++) {
                for (int j = 0; j < N; j++) {
                    const int k = mh_packed_index(i, j);
                    P[i][j] = w * (double)e[0].P[k] + (1 - w) * (double)e[1].P[k];
                }
            }
            invert(P);
            for (int i = 0; i < N * N; i++) {
                (&P[0][0])[i] = (&Ia[0][0])[i] + (&Ib[0][0])[i] - (&P[0][0])[i];
            }
            invert(P);
            least = fmin(least, trace(P));
            nearest = fmin(nearest, distance(&fused, P));
        }
        unpack(fused.P, P);
        TEST_ASSERT_TRUE(trace(P) < least * (1 + 1e-5));
        TEST_ASSERT_TRUE(nearest < 1e-2); /* between two places of the grid */
        TEST_ASSERT_TRUE(fuse_ellipsoidal(e, 2, &fused));
        ellipsoid(e, P);
        TEST_ASSERT_TRUE(distance(&fused, P) < 1e-4);
    }
}

static void assert_same(const struct mh_gaussian *a, const struct mh_gaussian *b, const mh_real *scale, mh_real share)
{
    for (int j = 0; j < N; j++) {
        const mh_real sd = mh_sqrt(b->P[MH_PACKED(j, j)]);
        TEST_ASSERT_FLOAT_WITHIN(share * sd + 1e-5f * mh_abs(b->x[j]), b->x[j], a->x[j] / scale[j]);
        for (int i = 0; i <= j; i++) {
            const int k = MH_PACKED(i, j);
            TEST_ASSERT_FLOAT_WITHIN(share * sd * mh_sqrt(b->P[MH_PACKED(i, i)]), b->P[k],
                                     a->P[k] / scale[i] / scale[j]);
        }
    }
}

/* The order does not matter; of two, to no rule. */
static void order_does_not_matter(void)
{
    static const mh_real ones[N] = {1, 1, 1, 1};
    static const fuse_function rules[] = {fuse_ci, fuse_ci_trace, fuse_ci_determinant, fuse_naive};
    seed = 6;
    for (int round = 0; round < 50; round++) {
        struct mh_gaussian e[ESTIMATES], turned[ESTIMATES], a, b;
        for (int k = 0; k < ESTIMATES; k++) {
            random_estimate(&e[k]);
        }
        for (int k = 0; k < ESTIMATES; k++) {
            turned[k] = e[(k + 1 + round % 3) % ESTIMATES];
        }
        for (int r = 0; r < 4; r++) {
            TEST_ASSERT_TRUE(rules[r](e, ESTIMATES, &a) && rules[r](turned, ESTIMATES, &b));
            assert_same(&a, &b, ones, 2e-3f);
        }
        turned[0] = e[1];
        turned[1] = e[0];
        TEST_ASSERT_TRUE(fuse_inverse(e, 2, &a) && fuse_inverse(turned, 2, &b));
        assert_same(&a, &b, ones, 2e-3f);
        TEST_ASSERT_TRUE(fuse_ellipsoidal(e, 2, &a) && fuse_ellipsoidal(turned, 2, &b));
        assert_same(&a, &b, ones, 2e-3f);
    }
}

/* Other units, each state its own: given weights, and those by the determinant, mean the same; so do naive and ellipsoidal fusion. Common units: all rules. */
static void units_do_not_matter(void)
{
    static const mh_real units[2][N] = {{1000, 0.01f, 60, 1}, {1000, 1000, 1000, 1000}};
    static const fuse_function rules[] = {fuse_ci_determinant, fuse_naive,  fuse_ellipsoidal, fuse_ci,
                                          fuse_ci_trace,       fuse_inverse};
    seed = 7;
    for (int round = 0; round < 50; round++) {
        const mh_real *unit = units[round % 2];
        struct mh_gaussian e[2], scaled[2], a, b;
        for (int k = 0; k < 2; k++) {
            random_estimate(&e[k]);
            scaled[k] = e[k];
            for (int j = 0; j < N; j++) {
                scaled[k].x[j] *= unit[j];
                for (int i = 0; i <= j; i++) {
                    scaled[k].P[MH_PACKED(i, j)] *= unit[i] * unit[j];
                }
            }
        }
        for (int r = 0; r < (round % 2 ? 6 : 3); r++) {
            TEST_ASSERT_TRUE(rules[r](scaled, 2, &a) && rules[r](e, 2, &b));
            assert_same(&a, &b, unit, 3e-3f);
        }
    }
}

static mh_real any_real(void)
{
    const uint32_t bits = draw_bits();
    mh_real value;
    memcpy(&value, &bits, sizeof value);
    return draw_bits() % 4 ? (mh_real)normal() : value;
}

/* A covariance that is one now and then, of any size. */
static void any_estimate(struct mh_gaussian *estimate)
{
    if (draw_bits() % 2) {
        random_estimate(estimate);
        const mh_real scale = (mh_real)pow(10, 36 * uniform() - 18);
        for (int i = 0; i < MH_PACKED_SIZE(N); i++) {
            estimate->P[i] *= scale;
        }
        return;
    }
    estimate->n = (uint8_t)(draw_bits() % 16 ? N : draw_bits() % 256);
    for (int i = 0; i < MH_STATES_MAX; i++) {
        estimate->x[i] = any_real();
    }
    for (int i = 0; i < MH_PACKED_SIZE(MH_STATES_MAX); i++) {
        estimate->P[i] = any_real();
    }
    for (int i = 0; i < MH_STATES_MAX; i++) {
        estimate->P[MH_PACKED(i, i)] += draw_bits() % 2 ? 5.0f : 0.0f;
    }
}

static int assert_sound(enum mh_status status, const struct mh_gaussian *fused)
{
    static const struct mh_gaussian untouched;
    if (status == MH_OK) {
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_check(fused));
        return 1;
    }
    TEST_ASSERT_EQUAL_MEMORY(&untouched, fused, sizeof untouched);
    return 0;
}

/* Whatever comes in: an error and nothing else, or a mean and a covariance. */
static void nothing_unsound_comes_out(void)
{
    int sound = 0;
    seed = 8;
    for (int round = 0; round < 30000; round++) {
        struct mh_gaussian e[3], fused[6];
        struct mh_split_gaussian split[2], joined;
        struct mh_information increment;
        mh_real w[3];
        memset(fused, 0, sizeof fused);
        memset(&joined, 0, sizeof joined);
        memset(&increment, 0, sizeof increment);
        for (int k = 0; k < 3; k++) {
            any_estimate(&e[k]);
        }
        for (int k = 0; k < 2; k++) {
            split[k].dependent = e[k];
            memcpy(split[k].independent, e[k + 1].P, sizeof split[k].independent);
        }
        if (mh_fusion_weights(e, 3, w) == MH_OK) {
            sound += assert_sound(mh_fusion_intersect(e, 3, w, &fused[0]), &fused[0]);
        }
        if (mh_fusion_weights_trace(e, 3, w) == MH_OK) {
            sound += assert_sound(mh_fusion_intersect(e, 3, w, &fused[1]), &fused[1]);
        }
        sound += assert_sound(mh_fusion_naive(e, 3, &fused[2]), &fused[2]);
        sound += assert_sound(mh_fusion_inverse(&e[0], &e[1], &fused[3]), &fused[3]);
        sound += assert_sound(mh_fusion_ellipsoidal(&e[1], &e[2], &fused[4]), &fused[4]);
        if (mh_fusion_split(&split[0], &split[1], &joined) == MH_OK) {
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_split_check(&joined));
            sound++;
        }
        if (mh_fusion_increment(&e[0], &e[1], &increment) == MH_OK) {
            sound += assert_sound(mh_fusion_add(&e[2], &increment, 1, &fused[5]), &fused[5]);
        }
    }
    TEST_ASSERT_TRUE(sound > 30000); /* it is not that everything is refused */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(covers_every_correlation);
    RUN_TEST(split_covers_what_depends);
    RUN_TEST(inverse_covers_common_information);
    RUN_TEST(weights_are_optimal);
    RUN_TEST(pairs_are_as_defined);
    RUN_TEST(order_does_not_matter);
    RUN_TEST(units_do_not_matter);
    RUN_TEST(nothing_unsound_comes_out);
    port_exit(UNITY_END() > 0);
    return 0;
}
