#include "motehound/shunned.h"

void mh_shun(struct mh_shunned *shunned, mh_node_id id, mh_tick until)
{
    shunned->list[shunned->next].id = id;
    shunned->list[shunned->next].until = until;
    shunned->next = (uint8_t)((shunned->next + 1) % MH_SHUNNED_MAX);
    shunned->count = (uint8_t)(shunned->count + (shunned->count < MH_SHUNNED_MAX));
}

bool mh_is_shunned(const struct mh_shunned *shunned, mh_node_id id, mh_tick now)
{
    for (uint8_t i = 0; i < shunned->count; i++) {
        if (shunned->list[i].id == id && mh_tick_before(now, shunned->list[i].until)) {
            return true;
        }
    }
    return false;
}

void mh_shunned_age(struct mh_shunned *shunned, mh_tick now)
{
    for (uint8_t i = 0; i < shunned->count; i++) {
        if (!mh_tick_before(now, shunned->list[i].until)) {
            shunned->list[i].until = now;
        }
    }
}
