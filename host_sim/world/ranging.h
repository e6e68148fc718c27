/* Sensors that measure how far the target is: within their range all of them detect it, beyond it none. The noise of a node's range at a
 * sample is the recipe's, fixed by the seed, the sample and the node whoever asks, so a range may be negative. Where the noise of different nodes is
 * correlated, a share of its variance is common to all ranges of a sample, in their nodes' standard deviations. */
#ifndef MOTEHOUND_SIM_RANGING_H
#define MOTEHOUND_SIM_RANGING_H

#include "scenario/scenario.h"
#include "world/clusters.h"

#include <stdbool.h>
#include <stdint.h>

struct ranging {
    double range_m;                  /* the farthest that is detected */
    double noise_m;                  /* standard deviation, but for nodes ... */
    const struct clusters *clusters; /* ... of fixed clusters, which have their own; NULL if there are none */
    double correlation;              /* of the noise of any two ranges of a sample */
    bool noisy;                      /* it is the noisy range that decides whether the target is detected */
    uint64_t seed;
};

/* Of scenario->sensor and its clusters, which may be none, or NULL for none; they outlive it. */
struct ranging ranging_of(const struct scenario *scenario, const struct clusters *clusters, uint64_t seed);

/* Node number `node`, `distance_m` from the target at sample `sample`, detects it; then *range_m is what it measures. Else *range_m
 * stays as it is. */
bool ranging_detects(const struct ranging *ranging, uint64_t sample, uint32_t node, double distance_m, double *range_m);

#endif
