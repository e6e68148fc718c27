/* How the targets were followed, from what the recorder has: which were lost, or taken for one another. Targets are told apart by track_t.number; a group's fix is one
 * of all targets that its extent reaches. */
#ifndef MOTEHOUND_SIM_FOLLOWED_H
#define MOTEHOUND_SIM_FOLLOWED_H

#include "record/truths.h"
#include "scenario/scenario.h"

struct followed {
    bool
        lost; /* a target: there was no fix within metrics.lost_m of it on the last 150 m of its way, or on all of it where that is shorter */
    bool
        coalesced; /* two targets: their tracks were within half of the targets' distance in metrics.lost_samples successive estimates */
    unsigned
        swaps; /* exchanges of identifiers that would set right the tracks that are with each other's targets in the end, and
                       have been in metrics.lost_samples successive estimates */
    unsigned swaps_claimed; /* of these between tracks that do not say that they cannot tell (MH_ESTIMATE_UNRESOLVED) */
    bool unresolved;        /* a target's track says so in the end */
    double longest_gap_m;   /* that a target travels between two fixes, or after the last; NaN without targets */
};

/* Cost: estimates x targets. */
struct followed followed_of(const struct recorder *recorder, const struct scenario *scenario);

#endif
