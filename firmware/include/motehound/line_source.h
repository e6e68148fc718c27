/* The field of a diffusing source that moves straight, at unit release rate: Luo, Eq. (1)-(2) over one segment of its path.
 *
 * S(a, b; t) is the concentration at a node, at time t, of what a source released on its way from a to b at constant speed and 1 g/s:
 *   S = integral over the age s of 1 / (4 pi D s) exp(-|X - x(s)|^2 / (4 D s)) ds,   x(age_a) = a, x(age_b) = b, x linear in between.
 * All lengths in metres, times in seconds, S in g/m2 for 1 g/s. */
#ifndef MOTEHOUND_LINE_SOURCE_H
#define MOTEHOUND_LINE_SOURCE_H

#if MH_REAL_FIXED
#error "motehound/line_source.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/geometry.h"

/* A straight piece of the path, seen at some instant. */
struct mh_segment {
    struct mh_vec2 a, b;
    mh_real age_a,
        age_b; /* time since the source was at a, at b. age_a > age_b; age_b < 0: it is still on its way, and only the part
                             with positive age counts */
};

/* S and its derivatives by the coordinates of a and b. */
struct mh_segment_field {
    mh_real value;
    struct mh_vec2 da, db;
};

/* field += sign * S at `node`, derivatives included. Nothing where age_a <= 0. Relative error below 1e-3 at nodes further from the
 * path than 0.2 sqrt(D age_a); nearer than that the youngest release, of ages below age_a / 300, is cut off, which bounds the logarithmic
 * singularity at the source itself. Costs at most 4 exponentials (8 where age_b < age_a / 4, and 8 more where it lies above age_a / 300). */
void mh_segment_add_field(const struct mh_segment *segment, struct mh_vec2 node, mh_real diffusion_m2ps, mh_real sign,
                          struct mh_segment_field *field);

/* S at `node` without derivatives by the midpoint rule with 1, 2 or 4 points, the fewer the older the segment is (age_b > 0; meant for
 * age_b above a fourth of age_a). */
mh_real mh_segment_old_field(const struct mh_segment *segment, struct mh_vec2 node, mh_real diffusion_m2ps);

#endif
