/* The state (x, vx, y, vy) as an estimate. */
#ifndef MOTEHOUND_PLANE_ESTIMATE_H
#define MOTEHOUND_PLANE_ESTIMATE_H

#include "motehound/estimate.h"
#include "motehound/gaussian.h"

/* Position and velocity with the covariance of all four; `raw` and `stored` equal position; no measurements, no flags. */
void mh_plane_estimate(const struct mh_gaussian *state, const struct mh_place *origin, mh_tick time,
                       struct mh_estimate *estimate);

#endif
