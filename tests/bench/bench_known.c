/* Work of a known size, to check the counting itself: 1,000 instructions in a function with a large frame and 1,000 after it. */
#include "bench.h"

#define NOP1000 __asm__ volatile(".rept 1000\n\tnop\n\t.endr")

static volatile uint8_t seen;

/* The frame is removed before the second half: an emulator that took that for the return would count the first half only. */
static __attribute__((noinline)) void with_a_frame(uint8_t index)
{
    volatile uint8_t frame[400];
    frame[index] = index;
    frame[399] = 1;
    NOP1000;
    seen = frame[index];
}

void bench_setup(void) {}

void bench_prepare(unsigned step) { (void)step; }

void bench_step(void)
{
    with_a_frame(7);
    NOP1000;
}

bool bench_worked(void) { return seen == 7; }
