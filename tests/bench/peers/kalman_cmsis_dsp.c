/* The step of kalman_step.c with the matrix functions of CMSIS-DSP (github.com/ARM-software/CMSIS-DSP), which has no filter of its own. */
#include "dsp/matrix_functions.h"

#include "bench.h"
#include "kalman_peer.h"

#define MATRIX(name, rows, columns)                                                                                    \
    static float name##_data[(rows) * (columns)];                                                                      \
    static arm_matrix_instance_f32 name = {rows, columns, name##_data}

MATRIX(F, 4, 4);
MATRIX(Ft, 4, 4);
MATRIX(Q, 4, 4);
MATRIX(H, 2, 4);
MATRIX(Ht, 4, 2);
MATRIX(R, 2, 2);
MATRIX(P, 4, 4);
MATRIX(work, 4, 4);
MATRIX(product, 4, 4);
MATRIX(PHt, 4, 2);
MATRIX(HP, 2, 4);
MATRIX(S, 2, 2);
MATRIX(S_inverse, 2, 2);
MATRIX(K, 4, 2);
static float x[4];

void peer_setup(void)
{
    memcpy(F_data, peer_F, sizeof F_data);
    memcpy(Q_data, peer_Q, sizeof Q_data);
    memcpy(H_data, peer_H, sizeof H_data);
    memcpy(R_data, peer_R, sizeof R_data);
    memcpy(P_data, peer_P, sizeof P_data);
    memcpy(x, peer_x, sizeof x);
    arm_mat_trans_f32(&F, &Ft);
    arm_mat_trans_f32(&H, &Ht);
}

void bench_step(void)
{
    float moved[4], expected[2], innovation[2], correction[4];
    arm_mat_vec_mult_f32(&F, x, moved);
    arm_mat_mult_f32(&F, &P, &work);
    arm_mat_mult_f32(&work, &Ft, &product);
    arm_mat_add_f32(&product, &Q, &P);

    arm_mat_mult_f32(&P, &Ht, &PHt);
    arm_mat_mult_f32(&H, &PHt, &S_inverse);
    arm_mat_add_f32(&S_inverse, &R, &S);
    arm_mat_inverse_f32(&S, &S_inverse);
    arm_mat_mult_f32(&PHt, &S_inverse, &K);
    arm_mat_vec_mult_f32(&H, moved, expected);
    for (int i = 0; i < 2; i++) {
        innovation[i] = peer_z[i] - expected[i];
    }
    arm_mat_vec_mult_f32(&K, innovation, correction);
    for (int i = 0; i < 4; i++) {
        x[i] = moved[i] + correction[i];
    }
    arm_mat_trans_f32(&PHt, &HP); /* P is symmetric */
    arm_mat_mult_f32(&K, &HP, &work);
    arm_mat_sub_f32(&P, &work, &P);
}

void peer_state(float state[4]) { memcpy(state, x, sizeof x); }
