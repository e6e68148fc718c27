#include "motehound/mote.h"
#include "motehound/summary.h"

static const struct mh_tracker *tracker_of(const struct mh_mote *mote)
{
    return mote->leads ? mote->config->head->tracker : NULL;
}

static enum mh_status summarise(void *context, mh_tick time, uint8_t *bytes, size_t *length)
{
    const struct mh_mote *mote = context;
    const struct mh_tracker *tracker = tracker_of(mote);
    return tracker && tracker->summarise ? tracker->summarise(mote->config->head->tracker_state, time, bytes, length)
                                         : MH_NONE;
}

static void summary_taken(void *context, mh_tick time)
{
    const struct mh_mote *mote = context;
    const struct mh_tracker *tracker = tracker_of(mote);
    if (tracker && tracker->summary_taken) {
        tracker->summary_taken(mote->config->head->tracker_state, time);
    }
}

static enum mh_status correct(void *context, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length)
{
    const struct mh_mote *mote = context;
    const struct mh_tracker *tracker = tracker_of(mote);
    if (!tracker || !tracker->correct) {
        return MH_NONE;
    }
    if (mh_summary_holds(bytes, length, cluster)) {
        summary_taken(context, time);
    }
    return tracker->correct(mote->config->head->tracker_state, time, bytes, length);
}

static enum mh_status begin(void *context)
{
    const struct mh_mote_config *config = ((const struct mh_mote *)context)->config;
    return config->centre ? config->centre->init(config->centre_state, config->centre_config) : MH_NONE;
}

static enum mh_status take(void *context, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length)
{
    const struct mh_mote_config *config = ((const struct mh_mote *)context)->config;
    return config->centre ? config->centre->take(config->centre_state, cluster, time, bytes, length) : MH_NONE;
}

static enum mh_status fuse(void *context, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_mote_config *config = ((const struct mh_mote *)context)->config;
    return config->centre ? config->centre->fuse(config->centre_state, time, estimate) : MH_NONE;
}

static enum mh_status feedback(void *context, uint8_t *bytes, size_t *length)
{
    const struct mh_mote_config *config = ((const struct mh_mote *)context)->config;
    return config->centre ? config->centre->feedback(config->centre_state, bytes, length) : MH_NONE;
}

const struct mh_fixed_port mh_mote_fixed = {
    .summarise = summarise,
    .summary_taken = summary_taken,
    .correct = correct,
    .begin = begin,
    .take = take,
    .fuse = fuse,
    .feedback = feedback,
};
