/* A gas that the wind brings from a leak, and sensors of it: the plume of motehound/plume.h, computed here for itself and in double, that
 * fluctuates. What comes to a node at a time is the mean there times a log-normal number of mean 1, its own for each node and time, and
 * what its sensor makes of that has noise besides. Both are the recipe's, fixed by the seed, the time and the node whoever asks. */
#ifndef MOTEHOUND_SIM_GAS_H
#define MOTEHOUND_SIM_GAS_H

#include "scenario/scenario.h"
#include "world/trajectory.h"

#include <stdint.h>

struct gas {
    double rate_mlps, mixing_m2ps, wind_mps, downwind_x, downwind_y;
    double fluctuation; /* sd, as a share of the mean */
    double noise_ppm;   /* sd */
    double unit_ppm;
    uint64_t seed;
};

/* Of scenario->source, wind and sensor. */
struct gas gas_of(const struct scenario *scenario, uint64_t seed);

/* Mean concentration at a place, ppm (Zhang, Eq. (1)). */
double gas_mean_ppm(const struct gas *gas, struct point source, struct point place);

/* Its gradient with respect to the source's place and to the rate -> gradient[3]. */
void gas_gradient(const struct gas *gas, struct point source, struct point place, double gradient[3]);

/* What the sensor of node number `node` at `place` gives at time_s, to the millisecond, in units of unit_ppm; negative too. */
double gas_reading(const struct gas *gas, struct point source, double time_s, uint32_t node, struct point place);

#endif
