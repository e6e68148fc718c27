/* Linear Kalman filter with 4 states and 2 measurements: see kalman_step.c. */
#include "bench.h"
#include "kalman_step.h"

void bench_setup(void) { bench_kalman_setup(); }

void bench_prepare(unsigned step) { (void)step; }

void bench_step(void) { bench_kalman_step(); }

bool bench_worked(void) { return true; }
