/* The fusion centre (centre.h) of clusters that follow one target in the plane, each with a filter of its own: by any rule of fusion.h but MH_FUSION_CENTRAL.
 *
 * **Estimates** (all rules but the two of increments): the last summary of each cluster, predicted to the time that is fused. So a report that is lost costs
 * little, and one that comes late still counts. A summary older than config.keep says nothing any more; with keep 0 only those of the very time count.
 * When none is left the last fused estimate is predicted. Rules of pairs take the clusters in their order.
 *
 * **Increments**: the estimate, at first config.start, is predicted from summary to summary, in the order of time and cluster, and each adds to it what it has learned. An
 * increment waits until it is fused; each cluster has room for one. One that began before the last that was taken of its cluster holds measurements for the
 * second time (the acknowledgement was lost): it is MH_ERR_REPEATED.
 *
 * **What to tell the heads** of a summary, by what take() returns: after MH_OK that it is taken (tracker.h, summary_taken), after MH_ERR_REPEATED which was the last that is. After the
 * others nothing: MH_ERR_TIME (before the cluster's last, before what is fused for increments, or more than MH_FUSION_AHEAD after it), MH_ERR_CAPACITY (an increment of the cluster
 * waits), MH_ERR_CORRUPT (not a summary of the rule's kind), MH_ERR_ARGUMENT (no such cluster). Increments are not lost then: the head counts on from its
 * last one that was acknowledged.
 *
 * fuse() fails with MH_NONE (no cluster has ever been heard; not with increments) or MH_ERR_TIME (not after the last, with increments not after config.start_time). Estimates: position and velocity with the covariance of all
 * four; `measurements` = summaries that were new, COASTED if none. What cannot be fused (an increment that takes information away, or leads to an absurd state; numbers beyond mh_real) is left out and counted.
 *
 * Cost: docs/costs.md. Several targets need a centre each. */
#ifndef MOTEHOUND_FUSION_CENTRE_H
#define MOTEHOUND_FUSION_CENTRE_H

#if MH_REAL_FIXED
#error "motehound/fusion_centre.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/centre.h"
#include "motehound/summary.h"
#include "motehound/white_acceleration.h"

/* A summary from further in the future than this after the last fused instant has a wrong time. */
#define MH_FUSION_AHEAD 600000u

struct mh_fusion_centre_config {
    enum mh_fusion_rule rule;            /* any but MH_FUSION_CENTRAL. Nominal MH_FUSION_CI */
    uint8_t clusters;                    /* 1 to MH_FUSED_MAX. Nominal 4 */
    struct mh_place origin;              /* of all coordinates */
    struct mh_white_acceleration motion; /* tick 1 to 3,600,000. Nominal 500, (5e-5, 1e-4) */
    mh_tick keep;                        /* 0 to 3,600,000. Nominal 30,000 */
    struct mh_gaussian start;            /* (x, vx, y, vy): the prior of increments, which their senders share, ... */
    mh_tick start_time;                  /* ... and its time */
};

/* Of summaries. */
struct mh_fusion_counters {
    uint32_t taken;
    uint32_t repeated, late, waiting, corrupt,
        unknown;    /* refused: in the order REPEATED, TIME, CAPACITY, CORRUPT, ARGUMENT */
    uint32_t unfit; /* could not be fused */
};

/* The last summary of a cluster. */
struct mh_fusion_slot {
    mh_tick time;
    bool heard;                                                         /* `time` is set */
    bool fresh;                                                         /* it has not been fused yet */
    bool held;                                                          /* the numbers are set */
    mh_real x[MH_SUMMARY_STATES], P[MH_PACKED_SIZE(MH_SUMMARY_STATES)]; /* or those of an increment */
    mh_real own[MH_PACKED_SIZE(MH_SUMMARY_STATES)];                     /* the independent part of a split one */
};

/* The state, in the header so that it can be allocated statically; its members are the centre's own but for the counters. */
struct mh_fusion_centre {
    struct mh_fusion_centre_config config;
    bool fused;   /* `time` is that of an estimate */
    mh_tick time; /* of the last fusion */
    struct mh_gaussian state;
    uint16_t clusters; /* whose increments of `time` are in it */
    struct mh_fusion_slot slots[MH_FUSED_MAX];
    struct mh_fusion_counters counters;
};

extern const struct mh_centre mh_centre_fusion;

/* Xu's clusters: origin (0, 0, 0), start (10, 0.8, 20, 0.6) with variances (1, 0.04, 1, 0.04) at time 0, and the nominal values above. */
void mh_fusion_centre_config_default(struct mh_fusion_centre_config *config);

#endif
