/* The Cramer-Rao bound of a fix from sound: of the places of all targets that are heard, from samples of one instant. The logarithm of a node's energy e = sum over k of
 * C_k / d_k^2 (sound.h) has the variance tau^2 + (eta / e)^2 and the derivative -2 (C_k / d_k^2)(p_k - S) / (e d_k^2) with respect to target k's
 * place; the information J adds up over the nodes. */
#ifndef MOTEHOUND_SIM_FIX_BOUND_H
#define MOTEHOUND_SIM_FIX_BOUND_H

#include "world/trajectory.h"

#include <stdbool.h>

enum { FIX_BOUND_TARGETS_MAX = 16 };

struct heard_target {
    struct point place;
    double loudness_m2;
};

/* J of up to FIX_BOUND_TARGETS_MAX targets: x and y of the first, of the second ... All zero bytes but the count: nothing is known. */
struct fix_information {
    size_t targets;
    double J[2 * FIX_BOUND_TARGETS_MAX][2 * FIX_BOUND_TARGETS_MAX];
};

/* Add what a sample at `node` tells of the targets, whose number is information->targets. */
void fix_information_add(struct fix_information *information, const struct heard_target *targets, struct point node,
                         double source_sd, double background_sd);

/* Variance of both coordinates added up, mean over the targets, m2; NaN where the samples do not determine them. */
double fix_bound_m2(const struct fix_information *information);

#endif
