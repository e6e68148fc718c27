/* Where the target is, as a tracker answers and a protocol carries it. */
#ifndef MOTEHOUND_ESTIMATE_H
#define MOTEHOUND_ESTIMATE_H

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
    mh_real age; /* seconds: the position belongs to time - age where the tracker says so (Luo's tau), else 0 */
    uint16_t measurements; /* how many measurements were used */
    uint8_t target;
    uint8_t states; /* that a covariance is stated of: 0, 2 (position), 3 (position, rate) or 4 (position, velocity) */
    uint8_t flags;  /* MH_ESTIMATE_* */
};

enum {
    MH_ESTIMATE_STARTED = 1,    /* the track begins, or begins again, here */
    MH_ESTIMATE_COASTED = 2,    /* no measurement was used: prediction only */
    MH_ESTIMATE_FILTERED = 4,   /* Luo: the Sage-Husa step ran */
    MH_ESTIMATE_AGE_LOW = 8,    /* Luo: the bound age = 0 was active */
    MH_ESTIMATE_AGE_HIGH = 16,  /* Luo: the bound age = largest age was active */
    MH_ESTIMATE_REFRESHED = 32, /* what is stored was set anew: those who follow it are to be told */
    MH_ESTIMATE_CALM = 64       /* gas: the estimate has hardly moved, and is as sure as it is wanted */
};

#endif
