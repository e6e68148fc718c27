/* The targets of a run: one, as source.* says, or several. Each moves on a way of its own, from when it begins until it ends.
 *
 * Several begin at source.start_s. Where source.path generates them, target.count of them move along the first leg of source.points, from A to B, at source.speed_mps. s is
 * target.spacing_m; i = 0 ... n - 1 counts from the right of the leg to its left; all come past its middle together.
 *
 * parallel:  i is (i - (n - 1) / 2) s to the left of the leg.
 * crossing:  straight lines through the middle of the leg, of its length, turned against it by (i - (n - 1) / 2) target.turn_deg.
 * bounce:    two, or one above the other if there are more: as crossing, but mirrored there: they draw near at that angle until s apart, and part again.
 * lanes:     (i - (n - 1) / 2) w to the left, where w is target.apart_m in the first and the last sixth of the leg, s in the middle third, and goes from one to
 *            the other in between; the speed is that along the leg.
 * turn:      as parallel, up to the middle; there, and again after legs of the same length, all turn by target.turn_deg, to the left and to the right by turns,
 *            target.turns times. They keep their places, so that the formation does not turn with them.
 * ring:      evenly on a circle of radius s about the leg, each keeping its place; the first one's direction is the seed's.
 * random:    from one place to the next, each at random in the field but for a margin of sensor.range_m, for source.duration_s (random waypoints).
 * scattered: one alone, at each sampling instant at another such place, for source.duration_s. The places, x then y, are one sequence of splitmix.h.
 * scripted:  those of scenario->targets. */
#ifndef MOTEHOUND_SIM_TARGETS_H
#define MOTEHOUND_SIM_TARGETS_H

#include "world/trajectory.h"

struct target {
    struct trajectory path;
    double start_s;
    double loudness; /* as source.loudness */
};

struct targets {
    struct target *list;
    size_t count;
    double duration_s; /* until the last one has ended */
};

/* Where a target is, at a time at which it is. */
struct target_state {
    bool present; /* else all is 0 */
    struct point at, velocity;
};

/* True of the paths that have target.count targets, and of scripted. */
bool targets_are_several(enum path_kind path);

/* The targets of `scenario`; none where source.path is none. Returns 0, or -1 with one line in `error` (as trajectory_make; too few points) and nothing to free. */
int targets_make(struct targets *targets, const struct scenario *scenario, uint64_t seed, char *error,
                 size_t error_size);

void targets_free(struct targets *targets);

struct target_state targets_at(const struct targets *targets, size_t target, double time_s);

#endif
