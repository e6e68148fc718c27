/* Four estimates of four states become one. BENCH_FUSE_* says how. */
#include "bench.h"
#include "motehound/fusion.h"

#include <string.h>

enum { ESTIMATES = 4 };

static struct mh_gaussian told[ESTIMATES];
static struct mh_split_gaussian split[ESTIMATES];
static struct mh_information increments[ESTIMATES];
struct mh_gaussian bench_state; /* the result */
static bool worked;

void bench_setup(void) {}

static mh_real draw(void)
{
    static uint32_t seed = 7;
    seed = seed * 1664525u + 1013904223u;
    return mh_real_from_float((float)(int32_t)(seed >> 8) * (2.0f / 16777216.0f) - 1.0f);
}

/* Covariances A A' + 0.1 I, means near to one another. */
void bench_prepare(unsigned step)
{
    (void)step;
    memset(split, 0, sizeof split);
    for (int e = 0; e < ESTIMATES; e++) {
        mh_real A[4][4];
        struct mh_gaussian *estimate = &told[e];
        estimate->n = increments[e].n = 4;
        for (int i = 0; i < 4; i++) {
            estimate->x[i] = MH_REAL(10.0f) + draw();
            for (int k = 0; k < 4; k++) {
                A[i][k] = draw();
            }
        }
        for (int j = 0; j < 4; j++) {
            increments[e].vector[j] = 0;
            for (int i = 0; i <= j; i++) {
                const int at = MH_PACKED(i, j);
                estimate->P[at] = i == j ? MH_REAL(0.1f) : 0;
                for (int k = 0; k < 4; k++) {
                    estimate->P[at] += mh_mul(A[i][k], A[j][k]);
                }
                split[e].independent[at] = mh_mul(MH_REAL(0.5f), estimate->P[at]);
                increments[e].matrix[at] = mh_mul(A[i][0], A[j][0]) + mh_mul(A[i][1], A[j][1]);
            }
        }
        split[e].dependent = *estimate;
        memcpy(split[e].dependent.P, split[e].independent, sizeof split[e].independent);
    }
}

#if defined(BENCH_FUSE_CI)
#define WEIGHTS mh_fusion_weights
#elif defined(BENCH_FUSE_CI_TRACE)
#define WEIGHTS mh_fusion_weights_trace
#elif defined(BENCH_FUSE_CI_DET)
#define WEIGHTS mh_fusion_weights_determinant
#elif defined(BENCH_FUSE_ICI)
#define PAIR mh_fusion_inverse
#elif defined(BENCH_FUSE_EI)
#define PAIR mh_fusion_ellipsoidal
#endif

void bench_step(void)
{
#if defined(WEIGHTS)
    mh_real w[ESTIMATES];
    worked = WEIGHTS(told, ESTIMATES, w) == MH_OK && mh_fusion_intersect(told, ESTIMATES, w, &bench_state) == MH_OK;
#elif defined(PAIR)
    worked = PAIR(&told[0], &told[1], &bench_state) == MH_OK && PAIR(&bench_state, &told[2], &bench_state) == MH_OK &&
             PAIR(&bench_state, &told[3], &bench_state) == MH_OK;
#elif defined(BENCH_FUSE_SCI)
    struct mh_split_gaussian joined;
    worked = mh_fusion_split(&split[0], &split[1], &joined) == MH_OK &&
             mh_fusion_split(&joined, &split[2], &joined) == MH_OK &&
             mh_fusion_split(&joined, &split[3], &joined) == MH_OK;
#elif defined(BENCH_FUSE_HIF)
    worked = mh_fusion_add(&told[0], increments, ESTIMATES, &bench_state) == MH_OK;
#else
    worked = mh_fusion_naive(told, ESTIMATES, &bench_state) == MH_OK;
#endif
}

bool bench_worked(void) { return worked; }
