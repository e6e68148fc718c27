/* The step of kalman_step.c with libfixkalman (github.com/sunsided/libfixkalman), and libfixmatrix and libfixmath below it: Q16.16. */
#include "fixkalman.h"

#include "bench.h"
#include "kalman_peer.h"

static kalman16_uc_t filter;
static kalman16_observation_t observation;

static void fill(mf16 *matrix, const float *elements)
{
    for (int i = 0; i < matrix->rows; i++) {
        for (int j = 0; j < matrix->columns; j++) {
            matrix->data[i][j] = fix16_from_float(elements[i * matrix->columns + j]);
        }
    }
}

void peer_setup(void)
{
    kalman_filter_initialize_uc(&filter, PEER_STATES);
    kalman_observation_initialize(&observation, PEER_STATES, PEER_MEASUREMENTS);
    fill(&filter.A, peer_F);
    fill(&filter.x, peer_x);
    fill(&filter.P, peer_P);
    fill(&filter.Q, peer_Q);
    fill(&observation.H, peer_H);
    fill(&observation.R, peer_R);
    fill(&observation.z, peer_z);
}

void bench_step(void)
{
    kalman_predict_uc(&filter);
    kalman_correct_uc(&filter, &observation);
}

void peer_state(float x[4])
{
    for (int i = 0; i < PEER_STATES; i++) {
        x[i] = fix16_to_float(filter.x.data[i][0]);
    }
}
