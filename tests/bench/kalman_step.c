/* One step of a linear Kalman filter: 4 states, 2 measurements, predict and update, F dense in memory.
 *
 * The workload on which TinyEKF, kalman-clib, libfixkalman and CMSIS-DSP are counted: constant velocity in the plane at
 * 10 Hz with both positions measured. bench_kalman_setup() is not part of the step. */
#include "kalman_step.h"

#include "motehound/kalman.h"

static struct mh_kalman filter;
static mh_real F[16], Q[10];
static const mh_real H[2][4] = {{MH_REAL(1.0f), 0, 0, 0}, {0, MH_REAL(1.0f), 0, 0}};

void bench_kalman_setup(void)
{
    static const mh_real x[4] = {0, 0, MH_REAL(1.0f), MH_REAL(0.5f)};
    static const mh_real P[10] = {MH_REAL(1.0f), 0, MH_REAL(1.0f), 0, 0, MH_REAL(1.0f), 0, 0, 0, MH_REAL(1.0f)};
    mh_kalman_init(&filter, 4, x, P);
    mh_kalman_constant_velocity(MH_REAL(0.1f), MH_REAL(0.04f), F, Q);
}

void bench_kalman_setup_dense(void)
{
    bench_kalman_setup();
    for (int i = 0; i < 16; i++) {
        F[i] += mh_mul(MH_REAL(0.01f), mh_real_from_int(i - 7));
    }
}

void bench_kalman_step(void)
{
    static const mh_real z[2] = {MH_REAL(0.11f), MH_REAL(0.045f)};
    mh_kalman_predict(&filter, F, Q);
    for (int m = 0; m < 2; m++) {
        mh_real innovation = z[m];
        for (int i = 0; i < 4; i++) {
            innovation -= mh_mul(H[m][i], filter.x[i]);
        }
        mh_kalman_update(&filter, H[m], innovation, MH_REAL(0.01f), 0);
    }
}

const mh_real *bench_kalman_state(void) { return filter.x; }
