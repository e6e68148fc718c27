/* A fusion centre: joins what several cluster heads say of one target. It knows nothing of frames or routes.
 *
 * Like a tracker it is a table of functions over a state that its owner allocates; heads answer for it with the tracker's summarise(),
 * summary_taken() and correct(). Whatever comes over the air is checked: what is no summary is refused and counted, and never enters the state. */
#ifndef MOTEHOUND_CENTRE_H
#define MOTEHOUND_CENTRE_H

#include "motehound/estimate.h"
#include "motehound/status.h"

#include <stddef.h>

struct mh_centre {
    const char *name;
    size_t state_size, config_size;

    /* Errors: MH_ERR_ARGUMENT. */
    enum mh_status (*init)(void *state, const void *config);
    /* Cluster `cluster`, counted from 0, says this of `time`. Errors, each counted: MH_ERR_CORRUPT (not what summarise writes), MH_ERR_ARGUMENT (no such
     * cluster), MH_ERR_REPEATED, MH_ERR_TIME (older than what was fused already). */
    enum mh_status (*take)(void *state, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length);
    /* Join what has come for `time`, which is after the last. Errors: MH_NONE (nothing is known yet), MH_ERR_TIME. */
    enum mh_status (*fuse)(void *state, mh_tick time, struct mh_estimate *estimate);
    /* What is to be told to the heads after fuse() -> bytes[0 .. *length), at most MH_SUMMARY_BYTES_MAX. Errors: MH_NONE (nothing). */
    enum mh_status (*feedback)(const void *state, uint8_t *bytes, size_t *length);
};

#endif
