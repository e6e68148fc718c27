/* Where the target is, as a tracker answers and a protocol carries it. */
#ifndef MOTEHOUND_ESTIMATE_H
#define MOTEHOUND_ESTIMATE_H

#include "motehound/config.h"
#include "motehound/geometry.h"
#include "motehound/ticks.h"

/* One position of the target. Coordinates are metres relative to `origin`. */
struct mh_estimate {
    struct mh_place origin;
    mh_tick time;              /* the sampling instant the estimate belongs to */
    struct mh_vec2 position;   /* the tracker's answer at `time` */
    struct mh_vec2 velocity;   /* m/s */
    struct mh_sym2 covariance; /* of position, m2; all zero where the tracker states none */
    /* The further columns of the packed covariance of all `states`, which begins with `covariance`. */
    mh_real covariance_more[7];
    mh_real rate;       /* at which the source releases, in the tracker's unit; 0 where it has no such state */
    struct mh_vec2 raw; /* the position before filtering; equals position where there is no such thing */
    /* What is stored of the track, which whoever follows it from afar knows too: where that has it at `time`, and how it moves from there.
     * Of trackers that can be handed from head to head. */
    struct mh_vec2 stored, stored_velocity;
    mh_real age;     /* seconds: the position belongs to time - age where the tracker says so (Luo's tau), else 0 */
    uint32_t target; /* its identifier; 0 where there is only one */
    uint32_t near;   /* MH_ESTIMATE_MERGE: the target it has come near to */
    mh_real extent;  /* of a group: root mean square distance of its targets from the centroid, m */
    uint32_t of[MH_GROUP_MAX]; /* of a group: the identifiers of its targets, ascending */
    uint16_t measurements;     /* how many measurements were used */
    uint16_t flags;            /* MH_ESTIMATE_* */
    uint8_t states;  /* that a covariance is stated of: 0, 2 (position), 3 (position, rate) or 4 (position, velocity) */
    uint8_t members; /* targets in the group whose centroid `position` is; 0 or 1: no group */
    uint8_t mode;    /* enum mh_target_mode, of trackers for several targets */
};

/* How a target is followed among others. */
enum mh_target_mode { MH_TARGET_SINGLE, MH_TARGET_SPARSE, MH_TARGET_GROUP };

enum {
    MH_ESTIMATE_STARTED = 1,      /* the track begins, or begins again, here */
    MH_ESTIMATE_COASTED = 2,      /* no measurement was used: prediction only */
    MH_ESTIMATE_FILTERED = 4,     /* Luo: the Sage-Husa step ran */
    MH_ESTIMATE_AGE_LOW = 8,      /* Luo: the bound age = 0 was active */
    MH_ESTIMATE_AGE_HIGH = 16,    /* Luo: the bound age = largest age was active */
    MH_ESTIMATE_REFRESHED = 32,   /* what is stored was set anew: those who follow it are to be told */
    MH_ESTIMATE_CALM = 64,        /* gas: the estimate has hardly moved, and is as sure as it is wanted */
    MH_ESTIMATE_MERGE = 128,      /* it has come so near to target `near` that both should go on as one group */
    MH_ESTIMATE_SPLIT = 256,      /* the group has fallen into parts that should go on by themselves */
    MH_ESTIMATE_UNRESOLVED = 512, /* which of the targets is which cannot be told, since they were together */
    MH_ESTIMATE_MIRRORED = 1024   /* the position was far from the prediction, and its mirror image was taken */
};

#endif
