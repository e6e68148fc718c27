/* A tracker answers "where is it?": measurements in, estimates out. It knows nothing of frames, routes or alarms.
 *
 * Every tracker is one table of functions over a state that its owner allocates (state_size bytes, aligned for any scalar),
 * so that a mote, a test and the simulator use all of them alike and an image holds only the ones it names. */
#ifndef MOTEHOUND_TRACKER_H
#define MOTEHOUND_TRACKER_H

#include "motehound/geometry.h"
#include "motehound/measurement.h"
#include "motehound/status.h"
#include "motehound/ticks.h"

#include <stddef.h>

/* One position of the target. Coordinates are metres relative to `origin`. */
struct mh_estimate {
    struct mh_place origin;
    mh_tick time;              /* the sampling instant the estimate belongs to */
    struct mh_vec2 position;   /* the tracker's answer at `time` */
    struct mh_vec2 velocity;   /* m/s */
    struct mh_sym2 covariance; /* of position, m2; all zero where the tracker states none */
    struct mh_vec2 raw;        /* the position before filtering; equals position where there is no such thing */
    mh_real age; /* seconds: the position belongs to time - age where the tracker says so (Luo's tau), else 0 */
    uint16_t measurements; /* how many measurements were used */
    uint8_t target;
    uint8_t flags; /* MH_ESTIMATE_* */
};

enum {
    MH_ESTIMATE_STARTED = 1,  /* the track begins, or begins again, here */
    MH_ESTIMATE_COASTED = 2,  /* no measurement was used: prediction only */
    MH_ESTIMATE_FILTERED = 4, /* Luo: the Sage-Husa step ran */
    MH_ESTIMATE_AGE_LOW = 8,  /* Luo: the bound age = 0 was active */
    MH_ESTIMATE_AGE_HIGH = 16 /* Luo: the bound age = largest age was active */
};

struct mh_tracker {
    const char *name;
    size_t state_size;  /* bytes of the state that init() fills */
    size_t config_size; /* bytes of the configuration that init() reads */

    /* Begin. `config` is the tracker's own structure (see its header), copied into the state; `interval` is the sampling
     * interval in ticks, 1 to 3,600,000. Errors: MH_ERR_ARGUMENT (a value outside the range its header gives). */
    enum mh_status (*init)(void *state, const void *config, mh_tick interval);

    /* The sampling instant `time` is complete. `measurements` are those taken after the instant before and up to this
     * one, each node at most once per target, ordered by time, then by node. An empty set is normal: the tracker coasts.
     * Errors: MH_NONE (state advanced, but no position at this instant), MH_ERR_TIME (not after the last instant). */
    enum mh_status (*step)(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate);

    /* Position expected at `time`, at or after the last step. Errors: MH_NONE (no track). */
    enum mh_status (*predict)(const void *state, mh_tick time, struct mh_estimate *estimate);

    /* Where to hear every node, silent ones too, at the next instant. Errors: MH_NONE (nobody in particular). NULL if the tracker never asks. */
    enum mh_status (*interest)(const void *state, struct mh_interest *interest);
};

#endif
