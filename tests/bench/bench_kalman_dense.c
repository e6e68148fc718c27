/* Linear Kalman filter with 4 states and 2 measurements: the same as bench_kalman.c, with a transition matrix without a zero. */
#include "bench.h"
#include "kalman_step.h"

void bench_setup(void) { bench_kalman_setup_dense(); }

void bench_prepare(unsigned step) { (void)step; }

void bench_step(void) { bench_kalman_step(); }

bool bench_worked(void) { return true; }
