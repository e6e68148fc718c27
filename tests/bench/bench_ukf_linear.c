/* A UKF whose motion is linear and whose ranges come one by one: see ukf_step.c. */
#include "bench.h"
#include "ukf_step.h"

void bench_setup(void) { bench_ukf_setup(); }

void bench_prepare(unsigned step) { bench_ukf_prepare(step); }

void bench_step(void) { bench_ukf_step_linear(); }

bool bench_worked(void) { return bench_ukf_worked(); }
