/* Who stands within two hops, and where: a bounded table, filled by hellos and by what neighbours tell of their own neighbours (vicinity_t).
 *
 * So a node can tell who would hear a neighbour of its: two nodes count as neighbours if they are within one horizontal distance of each other.
 * Where the table is full, whoever is farthest from here gives way. */
#ifndef MOTEHOUND_VICINITY_H
#define MOTEHOUND_VICINITY_H

#include "motehound/protocol.h"

struct mh_vicinity {
    mh_node_id id; /* of the node itself, which is in the table */
    struct mh_place place;
    mh_coarse lifetime;
    uint8_t count;
    uint16_t crowded; /* entries that gave way, or were not made, for want of room; saturates */
    struct mh_vicinity_entry {
        mh_node_id id;
        int32_t x_mm, y_mm;
        mh_coarse heard_at;
    } list[MH_VICINITY_MAX]; /* by identifier */
};

/* A table of the node `id` at `place`, and nobody else. An entry dies when nobody has told of it for `lifetime`, 512 ticks to an hour.
 * Errors: MH_ERR_ARGUMENT. */
enum mh_status mh_vicinity_init(struct mh_vicinity *vicinity, mh_node_id id, const struct mh_place *place,
                                mh_tick lifetime);

/* Node `id` stands there. Cost: linear in the table. */
void mh_vicinity_hear(struct mh_vicinity *vicinity, mh_tick now, mh_node_id id, int32_t x_mm, int32_t y_mm);

/* Node `id` is gone. */
void mh_vicinity_forget(struct mh_vicinity *vicinity, mh_node_id id);

/* Forget whom nobody has told of for too long. To be called at least every two hours. */
void mh_vicinity_age(struct mh_vicinity *vicinity, mh_tick now);

/* The place of `candidate`, then those of all within `range_mm` of it, this node among them, by identifier -> places[MH_VICINITY_MAX]. Returns how many; 0 if
 * the candidate is not in the table. */
size_t mh_vicinity_around(const struct mh_vicinity *vicinity, mh_node_id candidate, uint32_t range_mm,
                          struct mh_place *places);

#endif
