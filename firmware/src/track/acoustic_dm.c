#include "acoustic_parts.h"

#define STRONGEST 3 /* circles */

static enum mh_status locate_dm(const struct mh_acoustic_config *config, const struct mh_heard *heard, size_t count,
                                struct mh_acoustic_fix *fix)
{
    const struct mh_distance_table table = {config->sensing_range_m, config->intervals, (uint8_t)config->distances};
    const size_t used = mh_acoustic_strongest(config, count, STRONGEST);
    mh_acoustic_state_nominal(config, fix);
    return used <= STRONGEST ? mh_distance_fix(heard, used, &table, config->variant, &fix->position)
                             : mh_median_fix(heard, used, &table, &fix->position);
}

static const struct mh_acoustic_kind kind = {.locate = locate_dm};

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    return mh_acoustic_init(state, &kind, config, interval);
}

const struct mh_tracker mh_tracker_dm = {.name = "dm", .init = init, MH_ACOUSTIC_TRACKER};
