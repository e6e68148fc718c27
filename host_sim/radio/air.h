/* What is in the air: transmissions that are going on or ended so recently that they may have met one that still does.
 * They hang in a coarse grid, so that those which matter at a place are found in time that depends on their number alone. */
#ifndef MOTEHOUND_SIM_AIR_H
#define MOTEHOUND_SIM_AIR_H

#include "engine/event_queue.h"
#include "radio/places.h"

#include <stdbool.h>

/* A transmission. */
struct flight {
    sim_time start, end;
    uint64_t number;
    uint32_t sender, destination;
    uint32_t frame; /* the owner's; AIR_NO_FRAME: an acknowledgement */
    uint32_t next;  /* in its cell, or among the free ones */
    uint8_t cause;
    bool cut; /* its sender went off before it was out */
};

#define AIR_NO_FRAME UINT32_MAX

struct air {
    const struct places *places;
    struct flight *flights;
    size_t capacity;
    uint32_t free; /* list of free flights */
    double reach_m, cell_m;
    size_t columns, rows;
    uint32_t *cells;
    sim_time keep; /* how long a flight that has ended is remembered */
};

/* For flights that matter up to `reach_m` from their sender (HUGE_VAL: everywhere) and are remembered `keep` after their end. `places`
 * outlives it. Returns 0, or -1 if there is no memory (nothing to free). */
int air_make(struct air *air, const struct places *places, double reach_m, sim_time keep);

void air_free(struct air *air);

/* A transmission begins at what->start, which is now; `next` is ignored. Its index stays valid until `keep` after its end. Returns 0, or -1 if
 * there is no memory. */
int air_put(struct air *air, const struct flight *what, uint32_t *index);

/* The transmissions in the air at any time in (from, now) whose senders are within reach of `place`. `found` has
 * room for `capacity`; beyond that they are not written. Returns their number. */
size_t air_find(struct air *air, const struct place *place, sim_time from, sim_time now, uint32_t *found,
                size_t capacity);

#endif
