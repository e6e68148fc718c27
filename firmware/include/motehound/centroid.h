/* The tracker `centroid`: the mean place of the nodes that measure the target, whatever they measure, or of those that measure most. The baseline of every other method.
 *
 * Without a measurement it stays where it was. Nothing is predicted, so every position is reported.
 *
 * What an estimate holds: `position`, `raw` and `stored` the centroid; velocities 0; `covariance` sensing_range^2 / (4 n) in each axis, which is that of the
 * mean of n nodes uniform in the disc about the target, all zero without a measurement; `age` 0; `flags` STARTED, COASTED, REFRESHED (always).
 * `origin` is the first node's place, its z 0; mh_real resolves 1 mm 10 km from it. step() gives MH_NONE until the first measurement. interest() does
 * not exist. save() writes 12 bytes. restart() does nothing: it begins anew at every step.
 *
 * Scaling and overflow (fixed point): the mean is made of integers, in millimetres, and does not overflow; it is right to 1 mm as far as 32.7 km from the origin, beyond which
 * step() gives MH_ERR_NOT_FINITE, the track as it was. */
#ifndef MOTEHOUND_CENTROID_H
#define MOTEHOUND_CENTROID_H

#include "motehound/tracker.h"

#define MH_CENTROID_STRONGEST_MAX 8

#if MH_REAL_FIXED
#define MH_CENTROID_RANGE_MAX MH_REAL(300.0f) /* its covariance is a number */
#else
#define MH_CENTROID_RANGE_MAX 1e4f
#endif

struct mh_centroid_config {
    mh_real sensing_range_m; /* how far a node measures, 1e-2 to MH_CENTROID_RANGE_MAX; nominal 50 */
    uint8_t
        strongest; /* only so many nodes, of the largest values, at most MH_CENTROID_STRONGEST_MAX; nominal 0: all */
};

/* The state, in the header so that it can be allocated statically; its members are the tracker's own. */
struct mh_centroid_state {
    struct mh_centroid_config config;
    struct mh_place origin;
    struct mh_vec2 position;
    mh_tick time;  /* of the last step */
    bool stepped;  /* `time` is set */
    bool tracking; /* position and origin are */
};

extern const struct mh_tracker mh_tracker_centroid;

void mh_centroid_config_default(struct mh_centroid_config *config);

#endif
