#include "hosts/step_cycles.h"

#include <math.h>

enum { PER_OCTAVE = 8, FIRST_OCTAVE = 8 };

void step_cycles_count(struct step_cycles *steps, uint64_t cycles)
{
    const double at = cycles > 0 ? floor((log2((double)cycles) - FIRST_OCTAVE) * PER_OCTAVE) : 0;
    steps->classes[(int)fmin(fmax(at, 0), STEP_CLASSES - 1)]++;
    steps->longest = steps->longest > cycles ? steps->longest : cycles;
}

void step_cycles_add(struct step_cycles *steps, const struct step_cycles *more)
{
    for (int i = 0; i < STEP_CLASSES; i++) {
        steps->classes[i] += more->classes[i];
    }
    steps->longest = steps->longest > more->longest ? steps->longest : more->longest;
}

int64_t step_cycles_number(const struct step_cycles *steps)
{
    int64_t number = 0;
    for (int i = 0; i < STEP_CLASSES; i++) {
        number += steps->classes[i];
    }
    return number;
}

double step_cycles_quantile(const struct step_cycles *steps, double p)
{
    const double wanted = p * (double)step_cycles_number(steps);
    double below = 0;
    for (int i = 0; i < STEP_CLASSES; i++) {
        below += steps->classes[i];
        if (below > 0 && below >= wanted) {
            return fmin(exp2(FIRST_OCTAVE + (i + 0.5) / PER_OCTAVE), (double)steps->longest);
        }
    }
    return 0;
}
