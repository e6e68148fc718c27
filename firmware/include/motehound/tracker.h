/* A tracker answers "where is it?": measurements in, estimates out. It knows nothing of frames, routes or alarms.
 *
 * Every tracker is one table of functions over a state that its owner allocates (state_size bytes, aligned for any scalar),
 * so that a mote, a test and the simulator use all of them alike and an image holds only the ones it names. */
#ifndef MOTEHOUND_TRACKER_H
#define MOTEHOUND_TRACKER_H

#include "motehound/config.h"
#include "motehound/estimate.h"
#include "motehound/measurement.h"
#include "motehound/status.h"

#include <stddef.h>

/* A track as save() writes it, and whose it is. */
struct mh_saved_track {
    uint32_t target;
    const uint8_t *bytes;
    size_t length;
};

struct mh_tracker {
    const char *name;
    size_t state_size;  /* bytes of the state that init() fills */
    size_t config_size; /* bytes of the configuration that init() reads */

    /* Begin. `config` is the tracker's own structure (see its header), copied into the state; `interval` is the sampling
     * interval in ticks, 1 to 3,600,000. Errors: MH_ERR_ARGUMENT (a value outside the range its header gives). */
    enum mh_status (*init)(void *state, const void *config, mh_tick interval);

    /* The sampling instant `time` is complete. `measurements` are those taken after the instant before and up to this
     * one, each node at most once per target, ordered by time, then by node; from a head that passes late ones on (head.h), of instants before as well. An
     * empty set is normal: the tracker coasts. At most 8,000, what fixed point can divide a variance by; a head passes MH_REPORTS_MAX on.
     * Errors: MH_NONE (state advanced, but no position at this instant), MH_ERR_TIME (not after the last instant). */
    enum mh_status (*step)(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate);

    /* Position expected at `time`, at or after the last step. Errors: MH_NONE (no track). */
    enum mh_status (*predict)(const void *state, mh_tick time, struct mh_estimate *estimate);

    /* Where to hear every node, silent ones too, at the next instant. Errors: MH_NONE (nobody in particular). NULL if the tracker never asks. */
    enum mh_status (*interest)(const void *state, struct mh_interest *interest);

    /* All that another head needs to go on with the track -> bytes[0 .. *length), at most MH_TRACK_BYTES_MAX, the same on every
     * machine. Errors: MH_NONE (no track). NULL if the tracker stays where it is. */
    enum mh_status (*save)(const void *state, uint8_t *bytes, size_t *length);

    /* After init: go on with a track that was saved. Errors: MH_ERR_CORRUPT (not what save writes; the state is as after init). With save. */
    enum mh_status (*load)(void *state, const uint8_t *bytes, size_t length);

    /* The target is not where the track has it: the next step looks for it about the nodes that measure it. NULL if the tracker finds out
     * for itself. */
    void (*restart)(void *state);

    /* How good a next head node `candidate` would be, at places[0], with neighbours at places[1 .. count): the larger the better -> *score.
     * Errors: MH_NONE (no track). NULL if it does not matter to the tracker. */
    enum mh_status (*score)(const void *state, mh_node_id candidate, const struct mh_place *places, size_t count,
                            mh_real *score);

    /* What a fusion centre (centre.h) is to know of the track at `time`, at or after the last step -> bytes[0 .. *length), at most
     * MH_SUMMARY_BYTES_MAX, the same on every machine. Errors: MH_NONE (no track). NULL if the tracker has no such thing. */
    enum mh_status (*summarise)(void *state, mh_tick time, uint8_t *bytes, size_t *length);
    /* The centre has the summary of `time`. With summarise. */
    void (*summary_taken)(void *state, mh_tick time);
    /* What the centre has made of all summaries of `time` -> the track. Errors: MH_ERR_CORRUPT (not what a centre writes), MH_ERR_TIME (too old to
     * be of use); the state is as it was. With summarise. */
    enum mh_status (*correct)(void *state, mh_tick time, const uint8_t *bytes, size_t length);

    /* For several targets, each with a state of its own; NULL where the tracker knows of one only. */

    /* Before a step: this track is that of `target`, and `others` are followed nearby, as they were last saved; the next step reckons with their
     * share in what was measured. The bytes stay valid until then. Without this call a step takes everything for its own target's. Errors: MH_ERR_CORRUPT (not what save writes;
     * the others are not reckoned with). */
    enum mh_status (*among)(void *state, uint32_t target, const struct mh_saved_track *others, size_t count);
    /* This track and `other` go on as one group, under the lower identifier. Errors: MH_ERR_CAPACITY (more than MH_GROUP_MAX targets), MH_ERR_CORRUPT,
     * MH_NONE (no track). */
    enum mh_status (*join)(void *state, const struct mh_saved_track *other);
    /* Of a group whose last estimate has MH_ESTIMATE_SPLIT: the track of part `part`, from 0 -> its identifier, bytes[0 .. *length) as save writes them.
     * Errors: MH_NONE (it has no such part). */
    enum mh_status (*part)(const void *state, uint8_t part, uint32_t *target, uint8_t *bytes, size_t *length);
};

#endif
