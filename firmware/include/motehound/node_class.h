/* How the nodes about a cluster's head stand to the path that a target is predicted to take (Han, 2.2.1), and which of them is to lead next.
 *
 * The head stands at h; the target was found at p and moves with velocity v. The predicted path is the line through p along v, and q the distance of a node
 * from it. Ahead of the perpendicular to the path through h lie three strips:
 *
 *     q <= R - r          inner    will detect the target
 *     R - r < q <= R      border   may detect it (2-12; mh_sound_detected in sound.h)
 *     R < q <= d_outer    outer    will not, unless the target leaves the path
 *
 * with R the sensing range. Nodes farther off, and those behind the perpendicular, have nothing to do with the target. For a group of extent rho (the
 * largest distance of a member from its centre, which p and v are of) every strip is wider by rho.
 *
 * Scaling and overflow (fixed point): Q15.16, so all within 32,767 m, or the class is none; the products that are compared are exact.
 *
 * The prince, who is to lead next, is the inner node that the target comes within range of after a path nearest to a wanted length, or the longest. */
#ifndef MOTEHOUND_NODE_CLASS_H
#define MOTEHOUND_NODE_CLASS_H

#include "motehound/measurement.h"

enum mh_node_class {
    MH_NODE_NONE,
    MH_NODE_INNER,
    MH_NODE_BORDER,
    MH_NODE_OUTER,
    MH_NODE_COMPETITOR /* nothing is predicted: may contend for the lead if it detects the target */
};

/* Half the widths of the strips, m; inner_m <= border_m <= outer_m. */
struct mh_strips {
    mh_real inner_m, border_m, outer_m;
};

/* Where a target was found, by whom, and how it moves. All relative to one origin near the work. */
struct mh_course {
    struct mh_vec2 head, fix; /* m */
    struct mh_vec2 velocity;  /* m/s; 0: not known */
};

/* Who is wanted as prince: entered a path nearest to step_m after the fix (`farthest`: the longest path), and no earlier than lead_s from now, so that it
 * can be told in time. */
struct mh_prince_rule {
    mh_real step_m, lead_s;
    bool farthest;
};

/* The best so far: begin with all 0. */
struct mh_prince_choice {
    bool found; /* there is one */
    mh_node_id id;
    mh_real path_m;  /* that the target goes from the fix until it is within the prince's range ... */
    mh_real entry_s; /* ... and how long after the fix */
};

/* Strips for sensing range R, margin r, and outer strip up to d_outer, for a target of extent rho (0: a single one). All m. */
static inline struct mh_strips mh_strips(mh_real sensing_range_m, mh_real margin_m, mh_real outer_m, mh_real extent_m)
{
    const struct mh_strips strips = {sensing_range_m - margin_m + extent_m, sensing_range_m + extent_m,
                                     outer_m + extent_m};
    return strips;
}

/* Class of a node at `place`; MH_NODE_COMPETITOR where the velocity is not known. MH_NODE_NONE if something is not finite. One square root. */
enum mh_node_class mh_node_class(const struct mh_strips *strips, const struct mh_course *course, struct mh_vec2 place);

/* Node `id` at `place`, in radio range of the head, takes the place of the best so far if it is inner, in time and better, `elapsed_s` after the fix. At
 * equal paths the lower identifier is better, so that the order of the calls is all the same. */
void mh_prince_consider(struct mh_prince_choice *best, const struct mh_prince_rule *rule,
                        const struct mh_strips *strips, const struct mh_course *course, mh_real elapsed_s,
                        mh_node_id id, struct mh_vec2 place);

#endif
