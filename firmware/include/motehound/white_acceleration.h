/* How a target moves in the plane: at constant velocity, but for an acceleration that is white noise, drawn anew each tick and constant over it
 * (discrete white noise acceleration; Xu, Eqs. (1)-(2)).
 *
 * State (x, vx, y, vy), metres and m/s. With noise of given variance the motion depends on how long a tick is, so all who predict one target must
 * share it: m ticks are m chained predictions, here in closed form. */
#ifndef MOTEHOUND_WHITE_ACCELERATION_H
#define MOTEHOUND_WHITE_ACCELERATION_H

#if MH_REAL_FIXED
#error "motehound/white_acceleration.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/geometry.h"
#include "motehound/ticks.h"

enum { MH_WHITE_ACCELERATION_STATES = 4 };

struct mh_white_acceleration {
    mh_tick tick;            /* > 0 */
    struct mh_vec2 variance; /* of the acceleration's components, (m/s2)^2, > 0 */
};

/* Over `elapsed`: x = F x, P = F P F' + Q; F 4 x 4, row by row, Q packed (matrix.h). Q is zero where elapsed is, and positive definite from
 * the second tick on. What is left over after whole ticks T, r < T, counts as a tick of r whose variance is larger by T / r, so that the
 * velocity's variance grows evenly with time. */
void mh_white_acceleration(const struct mh_white_acceleration *model, mh_tick elapsed, mh_real *F, mh_real *Q);

#endif
