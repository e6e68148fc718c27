/* The fusion centre (centre.h) of clusters that follow one target in the plane, each with a filter of its own: by any rule of fusion.h but MH_FUSION_CENTRAL.
 *
 * **A summary is taken or refused at once.** What heads are told of it:
 * - MH_OK and MH_ERR_REPEATED: acknowledge it. The head may take it for settled (tracker.h, summary_taken).
 * - MH_ERR_TIME: older than what is fused, or further in the future than `keep`; MH_ERR_CAPACITY (increments only): an earlier one of the cluster waits to be fused.
 *   Do not acknowledge it: an increment is not lost, its head goes on counting from its last acknowledged one.
 * - MH_ERR_CORRUPT, MH_ERR_ARGUMENT: do not acknowledge it.
 *
 * Increments say since when they count. One that begins before the last that was taken of its cluster holds measurements for the second time (its acknowledgement
 * was lost) and is MH_ERR_REPEATED: what is new in it is given up for the sake of honesty. After a summary of another kind than the rule's: MH_ERR_CORRUPT.
 *
 * **Silent clusters** (by all rules but the two of increments): their last summary, predicted, stands for them until it is older than `keep`; with keep = 0 only
 * summaries of the very time that is fused count. **Without any** the last fused estimate is predicted (MH_ESTIMATE_COASTED).
 *
 * Increments need a prior that centre and heads share, `start` at `start_time`; the other rules do not look at it.
 *
 * Estimates: position and velocity with the covariance of all four, `measurements` = summaries joined. The rules of pairs take clusters in their order. */
#ifndef MOTEHOUND_FUSION_CENTRE_H
#define MOTEHOUND_FUSION_CENTRE_H

#include "motehound/centre.h"
#include "motehound/summary.h"
#include "motehound/white_acceleration.h"

struct mh_fusion_centre_config {
    enum mh_fusion_rule rule; /* any but MH_FUSION_CENTRAL */
    uint8_t clusters;         /* 1 to MH_FUSED_MAX */
    struct mh_place origin;   /* of all coordinates */
    struct mh_white_acceleration motion;
    mh_tick keep;             /* see above */
    struct mh_gaussian start; /* (x, vx, y, vy): the prior of increments ... */
    mh_tick start_time;       /* ... and its time */
};

extern const struct mh_centre mh_centre_fusion;

/* What has come and what became of it. */
struct mh_fusion_counters {
    uint32_t taken, repeated, late, corrupt, unknown;
};

void mh_fusion_centre_counters(const void *state, struct mh_fusion_counters *counters);

/* Xu's: CI, 4 clusters, origin (0, 0), ticks of 0.5 s, variances 5e-5 and 1e-4, start (10, 0.8, 20, 0.6) with variances (1, 0.04, 1, 0.04) at 0, keep 0. */
void mh_fusion_centre_config_default(struct mh_fusion_centre_config *config);

#endif
