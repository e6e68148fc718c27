#include "acoustic_parts.h"

static enum mh_status locate_ml(const struct mh_acoustic_config *config, const struct mh_heard *heard, size_t count,
                                struct mh_acoustic_fix *fix)
{
    mh_acoustic_state_nominal(config, fix);
    return mh_likeliest(&config->sound, heard, mh_acoustic_strongest(config, count, count), MH_LIKELIHOOD_CONSTANT,
                        &fix->position);
}

static const struct mh_acoustic_kind kind = {.locate = locate_ml};

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    return mh_acoustic_init(state, &kind, config, interval);
}

const struct mh_tracker mh_tracker_ml = {.name = "ml", .init = init, MH_ACOUSTIC_TRACKER};
