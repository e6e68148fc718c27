/* What both ends keep of a track, and so need not tell each other: where it was at a time, and how it moves from there.
 *
 * Whoever tracks tells whoever follows (time, position, velocity) and both extrapolate at constant velocity; he tells again only when his
 * estimate and the extrapolation differ by more than a tolerance. So the follower is never wrong by more than that, besides the estimate's own
 * error. This is the error-tolerant storing of Zhou, whose two stored fixes are position and velocity, and dual prediction (Jain, Chang
 * and Wang, SIGMOD 2004) where the velocity is a filter's.
 *
 * Coordinates are in metres relative to an origin that its owner keeps.
 *
 * Scaling and overflow (fixed point): Q15.16; an extrapolation is right to 8e-6 m beside the velocity's own 8e-6 m/s, and beyond 32,767 m not finite. Distances are compared as exact squares. */
#ifndef MOTEHOUND_FOLLOWED_H
#define MOTEHOUND_FOLLOWED_H

#include "motehound/geometry.h"
#include "motehound/status.h"
#include "motehound/ticks.h"

struct mh_followed {
    mh_tick time;            /* what the last report told */
    struct mh_vec2 position; /* at `time` */
    struct mh_vec2 velocity; /* m/s */
    bool known;              /* something was told; all zero bytes: nothing yet */
};

/* Take a report, at the one end when it is sent, at the other when it comes. Errors: MH_ERR_NOT_FINITE, MH_ERR_TIME (older than the one
 * known: it was overtaken on its way). */
enum mh_status mh_followed_report(struct mh_followed *followed, mh_tick time, struct mh_vec2 position,
                                  struct mh_vec2 velocity);

/* Where it is at `time` -> *position. Errors: MH_NONE (nothing is known), MH_ERR_NOT_FINITE (farther than mh_real reaches). */
enum mh_status mh_followed_predict(const struct mh_followed *followed, mh_tick time, struct mh_vec2 *position);

/* True if `position` at `time` is more than `tolerance_m` from what is expected there, or nothing is known: it is to be reported. Then
 * follows a report; otherwise what mh_followed_predict says is within the tolerance of `position`. */
bool mh_followed_differs(const struct mh_followed *followed, mh_tick time, struct mh_vec2 position,
                         mh_real tolerance_m);

#endif
