/* An iterated EKF on the same ranges: see ukf_step.c. */
#include "bench.h"
#include "ukf_step.h"

void bench_setup(void) { bench_ukf_setup(); }

void bench_prepare(unsigned step) { bench_ukf_prepare(step); }

void bench_step(void) { bench_iterated_ekf_step(); }

bool bench_worked(void) { return bench_ukf_worked(); }
