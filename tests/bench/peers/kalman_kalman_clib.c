/* The step of kalman_step.c with kalman-clib (github.com/sunsided/kalman-clib, with the buffers of 2014 on). Its process noise is B Q B', here with B = I. */
#define EXTERN_INLINE_MATRIX static INLINE
#define EXTERN_INLINE_KALMAN static INLINE
#include "kalman.h"

#include "bench.h"
#include "kalman_peer.h"

#include <string.h>

static kalman_t filter;
static kalman_measurement_t measurement;
/* buffers that may lie over one another do, as in its kalman_factory_*.h */
static float F[16], x[4], B[16], u[4], P[16], Q[16], column[4], square[16];
static float H[8], z[2], R[4], innovation[2], S[4], K[8], wide[8];

void peer_setup(void)
{
    kalman_filter_initialize(&filter, 4, 4, F, x, B, u, P, Q, column, column, square, square);
    kalman_measurement_initialize(&measurement, 4, 2, H, z, R, innovation, S, K, column, square, wide, wide, square);
    memcpy(F, peer_F, sizeof F);
    memcpy(x, peer_x, sizeof x);
    memcpy(P, peer_P, sizeof P);
    memcpy(Q, peer_Q, sizeof Q);
    memcpy(H, peer_H, sizeof H);
    memcpy(R, peer_R, sizeof R);
    for (int i = 0; i < 4; i++) {
        B[5 * i] = 1;
    }
}

void bench_step(void)
{
    memcpy(z, peer_z, sizeof z);
    kalman_predict(&filter);
    kalman_correct(&filter, &measurement);
}

void peer_state(float state[4]) { memcpy(state, x, sizeof x); }
