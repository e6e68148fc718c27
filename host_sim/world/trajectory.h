/* Where the source is: a path of legs, each a straight line or a circular arc at constant speed, or at constant acceleration. */
#ifndef MOTEHOUND_SIM_TRAJECTORY_H
#define MOTEHOUND_SIM_TRAJECTORY_H

#include "scenario/scenario.h"

#include <stddef.h>

struct point {
    double x_m, y_m;
};

struct leg {
    double start_s, duration_s;
    double speed_mps; /* 0: stands still */
    struct point start;
    double heading_rad;        /* at its start, counter-clockwise from the x axis */
    double curvature_radpm;    /* positive turns left; 0: straight */
    struct point acceleration; /* m/s2; on top of that */
};

/* The legs follow each other without a gap from time 0. Their ends are where the path, or its derivatives, may jump: whoever
 * integrates along it breaks the integral there. */
struct trajectory {
    struct leg *legs;
    size_t count;
    double duration_s;
};

/* The path of scenario->source, where there is one source (targets.h has the others).
 * PATH_ARCS: from the first point A to the second B along two arcs of 90 degrees, left then right, radius |AB| / (4 sin 45deg), at
 * source.speed_mps; the source sets out 45 degrees to the right of B.
 * PATH_GAUSS_MARKOV: straight from each place of mobility.h to the next, one in a sampling interval; `seed` matters for it and the next alone.
 * PATH_WHITE_ACCELERATION: that of accelerated.h, likewise.
 * Returns 0, or -1 with one line in `error` (too few points, a speed that is not positive, no memory) and nothing to free. */
int trajectory_make(struct trajectory *trajectory, const struct scenario *scenario, uint64_t seed, char *error,
                    size_t error_size);

void trajectory_free(struct trajectory *trajectory);

/* Position `elapsed_s` after the leg began. */
struct point leg_position(const struct leg *leg, double elapsed_s);

/* Position at `time_s`; before and after the path, its first and last point. */
struct point trajectory_position(const struct trajectory *trajectory, double time_s);

/* Velocity there, m/s; before and after the path none. */
struct point trajectory_velocity(const struct trajectory *trajectory, double time_s);

double trajectory_length_m(const struct trajectory *trajectory);

#endif
