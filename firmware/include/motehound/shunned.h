/* Neighbours that failed to take something lately, and are left alone for a while: the last few, older ones are forgotten first. */
#ifndef MOTEHOUND_SHUNNED_H
#define MOTEHOUND_SHUNNED_H

#include "motehound/measurement.h"

#define MH_SHUNNED_MAX 4

struct mh_shunned {
    struct {
        mh_node_id id;
        mh_tick until;
    } list[MH_SHUNNED_MAX];
    uint8_t count, next;
};

/* Leave node `id` alone until then. */
void mh_shun(struct mh_shunned *shunned, mh_node_id id, mh_tick until);

bool mh_is_shunned(const struct mh_shunned *shunned, mh_node_id id, mh_tick now);

/* What is long past is not to come back when the ticks wrap: to be called at least every 24 days. */
void mh_shunned_age(struct mh_shunned *shunned, mh_tick now);

#endif
