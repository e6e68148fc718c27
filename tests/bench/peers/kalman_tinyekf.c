/* The step of kalman_step.c with TinyEKF (github.com/simondlevy/TinyEKF, src/tinyekf.h, of 2024). */
#define EKF_N 4
#define EKF_M 2
#include "tinyekf.h"

#include "bench.h"

static ekf_t filter;
static const float dt = 0.1f, intensity = 0.04f;
static float F[16], Q[16];
static const float H[8] = {1, 0, 0, 0, 0, 1, 0, 0}, R[4] = {0.01f, 0, 0, 0.01f};

void bench_setup(void)
{
    static const float P[4] = {1, 1, 1, 1};
    ekf_initialize(&filter, P);
    filter.x[2] = 1;
    filter.x[3] = 0.5f;
    for (int i = 0; i < 2; i++) {
        F[5 * i] = F[5 * (i + 2)] = 1;
        F[4 * i + i + 2] = dt;
        Q[5 * i] = intensity * dt * dt * dt / 3;
        Q[4 * i + i + 2] = Q[4 * (i + 2) + i] = intensity * dt * dt / 2;
        Q[5 * (i + 2)] = intensity * dt;
    }
}

void bench_prepare(unsigned step) { (void)step; }

static bool worked;

void bench_step(void)
{
    static const float z[2] = {0.11f, 0.045f};
    float x[4];
    _mulvec(F, filter.x, x, 4, 4);
    ekf_predict(&filter, x, F, Q);
    worked = ekf_update(&filter, z, filter.x, H, R); /* H x is the first two states */
}

bool bench_worked(void) { return worked; }
