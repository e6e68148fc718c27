/* When a sensor hears a target that goes on at constant velocity: the two instants at which the line of its motion crosses the circle of radius R about the
 * node (Han, section 3.2.2; Eq. (3-5) is the same distance, computed from the position itself). */
#ifndef MOTEHOUND_TIME_WINDOW_H
#define MOTEHOUND_TIME_WINDOW_H

#include "motehound/geometry.h"
#include "motehound/status.h"

struct mh_time_window {
    mh_real in, out;   /* s after the target was at its position, in <= out; negative: before */
    mh_real closest_s; /* when it is nearest to the node, (in + out) / 2 */
    mh_real closest_m; /* how near then: |q|, the node's distance from the line, <= R */
};

/* Of a node at `node`, m, relative to the target's position, for a velocity in m/s and `radius` in m. With u = v / |v|, s = node . u, q = node x u and h = sqrt(R^2 - q^2):
 * in = (s - h) / |v|, out = (s + h) / |v|. Cost: two roots, three divisions.
 * Scaling and overflow (fixed point): Q15.16; u is rounded, so s and q are right to 1.5e-5 of |node|, and in and out to that over |v|; products are wide, and times beyond 32,767 s infinite.
 * Errors: MH_NONE (q >= R: the line passes it by), MH_ERR_SINGULAR (speed below 1e-3: it stays where it is), MH_ERR_NOT_FINITE, MH_ERR_RANGE (radius not above 0). */
enum mh_status mh_time_window(struct mh_vec2 node, struct mh_vec2 velocity, mh_real radius,
                              struct mh_time_window *window);

#endif
