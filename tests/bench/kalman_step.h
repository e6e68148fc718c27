#ifndef KALMAN_STEP_H
#define KALMAN_STEP_H

#include "motehound/real.h"

void bench_kalman_setup(void);       /* F of constant velocity: 10 of its 16 elements are zero */
void bench_kalman_setup_dense(void); /* F without a zero */
void bench_kalman_step(void);
const mh_real *bench_kalman_state(void);

#endif
