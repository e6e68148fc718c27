/* The Cramer-Rao bound of a leak's place and rate of release from the samples that were used: the information
 * J = prior^-1 + sum h h' / sigma^2 of (x, y, rate), h at the truth. No unbiased estimator is better; fluctuations of the plume are not in
 * it. */
#ifndef MOTEHOUND_SIM_LEAK_H
#define MOTEHOUND_SIM_LEAK_H

#include "world/gas.h"

struct leak_information {
    double J[6]; /* packed as motehound/matrix.h says */
};

/* What is expected beforehand, scenario_prior. */
struct leak_information leak_information_of(const struct scenario_prior *prior);

/* Add one sample taken at `place`; gas->noise_ppm > 0. */
void leak_information_add(struct leak_information *information, const struct gas *gas, struct point source,
                          struct point place);

struct leak_bound {
    double position_m; /* root of the sum of both variances */
    double rate;       /* standard deviation */
};

struct leak_bound leak_bound(const struct leak_information *information);

#endif
