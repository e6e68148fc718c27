/* The step of kalman_step.c with TinyEKF (github.com/simondlevy/TinyEKF, src/tinyekf.h since 2024). */
#define EKF_N 4
#define EKF_M 2
#include "tinyekf.h"

#include "bench.h"
#include "kalman_peer.h"

static ekf_t filter;

void peer_setup(void)
{
    static const float P[4] = {1, 1, 1, 1};
    ekf_initialize(&filter, P);
    memcpy(filter.x, peer_x, sizeof filter.x);
}

void bench_step(void)
{
    float x[4];
    _mulvec(peer_F, filter.x, x, 4, 4);
    ekf_predict(&filter, x, peer_F, peer_Q);
    ekf_update(&filter, peer_z, filter.x, peer_H, peer_R); /* H x is the first two states */
}

void peer_state(float x[4]) { memcpy(x, filter.x, sizeof filter.x); }
