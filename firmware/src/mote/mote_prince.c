#include "motehound/mote.h"

#include <string.h>

/* The tracker's state is a place to work in: between the calls the tracks are in the protocol's table. */
static enum mh_status begin(const struct mh_mote *mote, const struct mh_saved_track *track)
{
    const struct mh_head_config *head = mote->config->head;
    if (!head || !head->tracker->save) {
        return MH_ERR_ARGUMENT;
    }
    enum mh_status status = head->tracker->init(head->tracker_state, head->tracker_config, head->interval);
    if (status == MH_OK && head->tracker->among) { /* whose track it is counts for what is loaded */
        status = head->tracker->among(head->tracker_state, track->target, NULL, 0);
    }
    return status == MH_OK && track->length > 0 ? head->tracker->load(head->tracker_state, track->bytes, track->length)
                                                : status;
}

static enum mh_status save(const struct mh_mote *mote, uint8_t *bytes, size_t *length)
{
    const struct mh_head_config *head = mote->config->head;
    uint8_t track[MH_TRACK_BYTES_MAX];
    size_t taken;
    const enum mh_status status = head->tracker->save(head->tracker_state, track, &taken);
    if (status != MH_OK || taken > MH_PRINCE_TRACK_BYTES) {
        return status != MH_OK ? status : MH_ERR_CAPACITY;
    }
    memcpy(bytes, track, taken);
    *length = taken;
    return MH_OK;
}

static enum mh_status localise(void *context, const struct mh_saved_track *own, const struct mh_saved_track *others,
                               size_t count, mh_tick time, const struct mh_measurement *measurements,
                               size_t measurement_count, struct mh_estimate *estimate, uint8_t *bytes, size_t *length)
{
    const struct mh_mote *mote = context;
    enum mh_status status = begin(mote, own);
    if (status != MH_OK) {
        return status;
    }
    const struct mh_head_config *head = mote->config->head;
    if (head->tracker->among) {
        status = head->tracker->among(head->tracker_state, own->target, others, count);
    }
    if (status == MH_OK) {
        status = head->tracker->step(head->tracker_state, time, measurements, measurement_count, estimate);
    }
    return status == MH_OK ? save(mote, bytes, length) : status;
}

static enum mh_status expect(void *context, const struct mh_saved_track *track, mh_tick time,
                             struct mh_estimate *estimate)
{
    const struct mh_mote *mote = context;
    const enum mh_status status = begin(mote, track);
    return status == MH_OK ? mote->config->head->tracker->predict(mote->config->head->tracker_state, time, estimate)
                           : status;
}

static enum mh_status join(void *context, const struct mh_saved_track *own, const struct mh_saved_track *other,
                           uint8_t *bytes, size_t *length)
{
    const struct mh_mote *mote = context;
    enum mh_status status = begin(mote, own);
    if (status != MH_OK) {
        return status;
    }
    const struct mh_head_config *head = mote->config->head;
    if (!head->tracker->join) {
        return MH_NONE;
    }
    status = head->tracker->join(head->tracker_state, other);
    return status == MH_OK ? save(mote, bytes, length) : status;
}

static enum mh_status part(void *context, uint8_t part, uint32_t *target, uint8_t *bytes, size_t *length)
{
    const struct mh_mote *mote = context;
    const struct mh_head_config *head = mote->config->head;
    uint8_t track[MH_TRACK_BYTES_MAX];
    size_t taken;
    uint32_t name;
    const enum mh_status status =
        head && head->tracker->part ? head->tracker->part(head->tracker_state, part, &name, track, &taken) : MH_NONE;
    if (status != MH_OK || taken > MH_PRINCE_TRACK_BYTES) {
        return status != MH_OK ? status : MH_ERR_CAPACITY;
    }
    memcpy(bytes, track, taken);
    *target = name;
    *length = taken;
    return MH_OK;
}

const struct mh_prince_port mh_mote_prince = {
    .localise = localise,
    .expect = expect,
    .join = join,
    .part = part,
};
