/* Who is near, where, and how good the link to it is: a bounded table, filled by hellos.
 *
 * Link quality is the expected number of transmissions (ETX; De Couto et al., "A high-throughput path metric for multi-hop wireless
 * routing", 2003): 1 / (share of its hellos that came x share of our frames that it acknowledged), both exponentially weighted
 * over about the last four. A neighbour of which either share is below a quarter is not used, and tried again when its hellos keep coming.
 *
 * The table also knows which neighbours are so in the Gabriel graph (Gabriel and Sokal, 1969), the planar graph that face routing walks:
 * v is, unless a common neighbour w, its witness, stands strictly inside the circle on the diameter from here to v. A witness need not be in
 * the table: each hello heard marks the neighbours that its sender witnesses, and the mark holds as long as an entry would. A neighbour counts as
 * one of the Gabriel graph from its second hello on, when all others had the time to say hello since it was entered. So one that has a witness
 * may always give way, whoever the witness is, and what the table says of the rest stays exact.
 *
 * Where the table is full, this decides ("least reach of the fullest octant"): first goes a neighbour that is not used; else, among those with a
 * witness, those of the octant (45 degrees around here) that has most of them, there the one with the least distance x quality, which may
 * be the newcomer. What is kept are thus all Gabriel neighbours and, in every direction, those that bring a message farthest. Only
 * where all have no witness a newcomer without one is refused: MH_NEIGHBOUR_PLANAR counts it, and face routing (geographic.h) may then fail.
 *
 * Nodes at one and the same place: the one with the lowest identifier stands for all in the Gabriel graph; the others are always kept, and
 * are its neighbours outside that graph. Heights are ignored. */
#ifndef MOTEHOUND_NEIGHBOURS_H
#define MOTEHOUND_NEIGHBOURS_H

#include "motehound/protocol.h"

enum mh_edge { MH_EDGE_NEW, MH_EDGE_GABRIEL, MH_EDGE_WITNESSED };

struct mh_neighbour {
    mh_node_id id;
    int32_t x_mm, y_mm;
    mh_coarse heard_at, witnessed_at;
    uint8_t sequence;     /* of its last hello, the low byte */
    uint8_t heard, acked; /* shares, of 255 */
    uint8_t edge;         /* enum mh_edge */
};

/* Why an entry was lost, or not made. */
enum mh_neighbour_loss {
    MH_NEIGHBOUR_SILENT,  /* not heard for the lifetime */
    MH_NEIGHBOUR_UNUSED,  /* of poor quality, gave way to a newcomer */
    MH_NEIGHBOUR_CROWDED, /* gave way by the rule above */
    MH_NEIGHBOUR_REFUSED, /* a newcomer, not taken by the rule above: the usual thing in a dense field */
    MH_NEIGHBOUR_PLANAR,  /* a newcomer of the Gabriel graph, for which there was no room */
    MH_NEIGHBOUR_LOSSES
};

struct mh_neighbours {
    mh_node_id id; /* of the node itself */
    struct mh_place place;
    mh_coarse lifetime;
    uint8_t capacity, count;
    mh_node_id kept;                    /* gives way to nobody: see mh_neighbours_keep */
    uint16_t lost[MH_NEIGHBOUR_LOSSES]; /* saturating */
    struct mh_neighbour list[MH_NEIGHBOURS_MAX];
};

/* An empty table of the node `id` at `place`. An entry dies when its neighbour was not heard for `lifetime`, 512 ticks to an hour: a few hello
 * periods. Errors: MH_ERR_ARGUMENT (lifetime, a capacity of 0 or above MH_NEIGHBOURS_MAX). */
enum mh_status mh_neighbours_init(struct mh_neighbours *table, mh_node_id id, const struct mh_place *place,
                                  uint8_t capacity, mh_tick lifetime);

/* A hello came in. Cost: linear in the table; on an ATmega128 about 4 ms. Returns MH_OK, or MH_NONE if its sender is not kept.
 * Errors: MH_ERR_ARGUMENT (it bears this node's own identifier). */
enum mh_status mh_neighbours_hello(struct mh_neighbours *table, mh_tick now, const mh_hello_t *hello);

/* Keep `id`, the goal of many messages, whenever it is near, rather than a neighbour that is better by the rule above; its quality does not
 * matter either. One identifier at a time; MH_BROADCAST, as after the start, for none. */
void mh_neighbours_keep(struct mh_neighbours *table, mh_node_id id);

/* Forget whoever was not heard for too long. To be called at least every two hours. */
void mh_neighbours_age(struct mh_neighbours *table, mh_tick now);

/* A frame to neighbour `id` was acknowledged, or was not. No effect for others. */
void mh_neighbours_acked(struct mh_neighbours *table, mh_node_id id, bool acked);

/* The entry of `id`, or NULL. */
const struct mh_neighbour *mh_neighbours_find(const struct mh_neighbours *table, mh_node_id id);

/* heard x acked, 0 to 65,025: the expected number of transmissions is 65,025 over this. */
uint16_t mh_neighbour_quality(const struct mh_neighbour *neighbour);

/* True if the link may be used. */
bool mh_neighbour_usable(const struct mh_neighbour *neighbour);

/* True if the link may be used and belongs to the Gabriel graph. */
bool mh_neighbour_planar(const struct mh_neighbours *table, const struct mh_neighbour *neighbour);

#endif
