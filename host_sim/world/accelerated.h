/* A target at constant velocity but for an acceleration that is white noise, drawn anew each sampling interval T and constant over it
 * (discrete white noise acceleration; Xu, Eqs. (1)-(6)):
 *
 *   p(k + 1) = p(k) + T v(k) + T^2 / 2 a(k),   v(k + 1) = v(k) + T a(k),   a ~ N(0, diag(sd_x^2, sd_y^2))
 *
 * from a start that is normal about a mean, its coordinates independent. Numbers 0 to 3 of the stream RANDOM_TARGET are the start's (x, y, vx, vy), 4 + 2k and
 * 5 + 2k are a(k)'s. */
#ifndef MOTEHOUND_SIM_ACCELERATED_H
#define MOTEHOUND_SIM_ACCELERATED_H

#include "world/trajectory.h"

#include <stddef.h>

struct accelerated {
    double interval_s; /* T */
    struct point mean, mean_velocity;
    double position_sd_m, velocity_sd_mps; /* of the start */
    struct point acceleration_sd;          /* m/s2 */
};

struct accelerated_state {
    struct point at, velocity;
    struct point acceleration; /* from here to the next */
};

/* That of scenario->target; T is sensor.interval_s. */
struct accelerated accelerated_of(const struct scenario *scenario);

/* Its states at steps 0 ... steps for `seed`, so states holds steps + 1 of them; the last one's acceleration is zero. */
void accelerated_states(const struct accelerated *target, uint64_t seed, size_t steps,
                        struct accelerated_state *states);

#endif
