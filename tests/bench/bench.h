/* One benchmark image: a workload that main.c runs and the emulator counts. tools/cost-table builds and reads them. */
#ifndef BENCH_H
#define BENCH_H

#include <stdbool.h>
#include <stdint.h>

enum { BENCH_WARM_UP = 6, BENCH_COUNTED = 10 };

/* Before the first step. */
void bench_setup(void);

/* Make the inputs of step number `step`; neither counted nor part of the flash figure. */
void bench_prepare(unsigned step);

/* What is measured. Each workload keeps the state that the library needs for it in a variable `bench_state`. */
void bench_step(void);

/* Optional: how many particles have been drawn so far. */
uint32_t bench_draws(void) __attribute__((weak));

/* True if the last step did the work that is to be measured. */
bool bench_worked(void);

#endif
