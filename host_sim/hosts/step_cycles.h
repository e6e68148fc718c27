/* How long a board's steps took: those of its events that led to an estimate. In classes of an eighth of an octave, so that boards, runs and workers
 * add up; the longest is exact. */
#ifndef MOTEHOUND_SIM_STEP_CYCLES_H
#define MOTEHOUND_SIM_STEP_CYCLES_H

#include <stdint.h>

enum { STEP_CLASSES = 256 };

/* All zero bytes is none. */
struct step_cycles {
    int32_t classes[STEP_CLASSES]; /* how many of each; class i begins at 2^(8 + i / 8) cycles, the first at 0 */
    uint64_t longest;
};

void step_cycles_count(struct step_cycles *steps, uint64_t cycles);
void step_cycles_add(struct step_cycles *steps, const struct step_cycles *more);

int64_t step_cycles_number(const struct step_cycles *steps);

/* So many cycles, within 5 % (above 256), took the share 0 < p < 1 of the steps at most; 0 where there is none. */
double step_cycles_quantile(const struct step_cycles *steps, double p);

#endif
