/* The path a diffusing source has left behind, and what its old release does to the readings of today.
 *
 * A bounded list of knots joined by straight segments, each with its release rate. When the list is full, the knot whose loss blurs the
 * path least in proportion to its age is dropped and its two segments become one that holds the same mass: so a few knots cover a long past, ever
 * more coarsely, as diffusion itself forgets. */
#ifndef MOTEHOUND_TRAIL_H
#define MOTEHOUND_TRAIL_H

#if MH_REAL_FIXED
#error "motehound/trail.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/config.h"
#include "motehound/line_source.h"
#include "motehound/ticks.h"

struct mh_trail_knot {
    struct mh_vec2 place; /* metres */
    mh_tick time;
    mh_real rate; /* g/s released on the way here from the knot before */
};

struct mh_trail {
    struct mh_trail_knot knots[MH_TRAIL_KNOTS_MAX]; /* oldest first */
    int count;
};

/* The path goes on to `knot`, whose time is after the newest. What happened more than 12 days before is forgotten. */
void mh_trail_append(struct mh_trail *trail, const struct mh_trail_knot *knot);

/* What the trail adds to the increment at `node` between `time` - interval and `time`, in g/m2. The newest knot is not after `time` - interval.
 * Costs up to 4 exponentials a segment. */
mh_real mh_trail_increment(const struct mh_trail *trail, struct mh_vec2 node, mh_tick time, mh_tick interval,
                           mh_real diffusion_m2ps);

/* The same of one segment alone, from knot `a` to knot `b`. */
mh_real mh_trail_segment_increment(const struct mh_trail_knot *a, const struct mh_trail_knot *b, struct mh_vec2 node,
                                   mh_tick time, mh_tick interval, mh_real diffusion_m2ps);

#endif
