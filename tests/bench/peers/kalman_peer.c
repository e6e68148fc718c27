#include "kalman_peer.h"

#include "bench.h"
#include "kalman_step.h"
#include "motehound/kalman.h"

#include <math.h>

#define DT_S 0.1f
#define DENSITY 0.04f
#define DT2 (DENSITY * DT_S * DT_S / 2)
#define DT3 (DENSITY * DT_S * DT_S * DT_S / 3)
#define AGREES 0.01f

const float peer_F[16] = {1, 0, DT_S, 0, 0, 1, 0, DT_S, 0, 0, 1, 0, 0, 0, 0, 1};
const float peer_Q[16] = {DT3, 0, DT2, 0, 0, DT3, 0, DT2, DT2, 0, DENSITY *DT_S, 0, 0, DT2, 0, DENSITY *DT_S};
const float peer_H[8] = {1, 0, 0, 0, 0, 1, 0, 0};
const float peer_R[4] = {0.01f, 0, 0, 0.01f};
const float peer_x[4] = {0, 0, 1, 0.5f};
const float peer_P[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
const float peer_z[2] = {0.11f, 0.045f};

void bench_setup(void)
{
    bench_kalman_setup();
    peer_setup();
}

void bench_prepare(unsigned step)
{
    (void)step;
    bench_kalman_step();
}

bool bench_worked(void)
{
    const float *own = bench_kalman_state();
    float x[PEER_STATES];
    peer_state(x);
    for (int i = 0; i < PEER_STATES; i++) {
        if (!(fabsf(x[i] - own[i]) < AGREES)) {
            return false;
        }
    }
    return true;
}
