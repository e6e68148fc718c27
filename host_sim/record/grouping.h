/* How well the network knew which targets form groups (enum mh_target_mode), from what the recorder has.
 *
 * What the targets truly are to one another is judged at every sampling instant: two are together from when a chain of targets, each within 20 m of the
 * next, leads from one to the other, until no chain with steps within 30 m does; so the thresholds of groups (group.h) by default. */
#ifndef MOTEHOUND_SIM_GROUPING_H
#define MOTEHOUND_SIM_GROUPING_H

#include "record/truths.h"
#include "scenario/scenario.h"

/* All are NaN where there is nothing that they could be of. */
struct grouping {
    double
        extent_bias_m; /* mean of what groups have for their extent, less the root mean square distance of their targets from the centroid */
    double
        merge_delay_s; /* mean time from when two targets come together until they are in one group; until the end where they never are */
    double split_delay_s;     /* ... from when they come apart until they are not in one */
    double mode_changes_pmin; /* instants a minute at which the mode of a target changes */
    double
        spurious_splits_pmin; /* instants a minute at which a group loses targets that are together; of the time that targets are */
    double
        count_right; /* share of the instants at which the targets that are followed, those in groups with them, are as many as there are; from
                            metrics.skip_first on, and in an ideal network, where all are told of at every instant */
    double apart_at_end; /* 1 if every target is followed by itself in the end (on the last 150 m of its way), else 0 */
};

/* Cost: instants x targets cubed. */
struct grouping grouping_of(const struct recorder *recorder, const struct scenario *scenario);

#endif
