/* The sound of targets and sensors that take its energy: the model of motehound/sound.h, computed here for itself and in double.
 *
 *   y = e exp(tau g1) + eta g2,   e = sum over the targets of C_k / max(d_k^2, 1 m2),   C_k = loudness_k sensor.range_m^2
 *
 * The noise is the recipe's, fixed by the seed, the millisecond and the node whoever asks, so y may be negative. A target is detected where y is 1 or more. */
#ifndef MOTEHOUND_SIM_SOUND_H
#define MOTEHOUND_SIM_SOUND_H

#include "world/targets.h"

#include <stdint.h>

struct sound {
    double range_m;
    double source_noise, background_noise; /* tau, eta */
    uint64_t seed;
};

/* Of scenario->sensor. */
struct sound sound_of(const struct scenario *scenario, uint64_t seed);

/* e at a place, of the targets that are there at time_s. */
double sound_energy(const struct sound *sound, const struct targets *targets, double time_s, struct point place);

/* y of the sensor of node number `node` at `place`, at time_s to the millisecond. */
double sound_reading(const struct sound *sound, const struct targets *targets, double time_s, uint32_t node,
                     struct point place);

#endif
