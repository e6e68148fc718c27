/* Collection to a sink: every measurement travels hop by hop up a tree that the sink's beacons build.
 *
 * Beacons flood outwards from the sink, round after round, and say whether it follows a track; when that changes a new round begins
 * at once. A node takes as parent the sender with the fewest hops of the newest round, and relays the beacon after a short
 * pseudo-random wait unless it has meanwhile heard `suppress_after` others relay it with no more hops than its own would carry:
 * so the number of relays depends on the area, not on how many nodes stand in it (counter-based suppression, Ni et al., "The
 * broadcast storm problem", 1999). A path of the same round that turns out shorter is taken, but relayed again only where it saves
 * an eighth of the hops. A node that two rounds have missed broadcasts a beacon of no sink; its neighbours answer
 * with theirs. So do the neighbours of a sink that has been restarted and counts its rounds from 1: it goes on from the round they know.
 *
 * Requests travel from the head towards a place: of all that hear one, the node nearest to the centre waits least and relays,
 * the others hear that and stay silent (contention-based forwarding, Fuessler et al., 2003), until one broadcast covers the
 * whole radius. Nodes within about 30 degrees of the straight line go first: they all hear each other. A radius that no single broadcast covers is flooded with suppression, inside the radius only. Where no node
 * is nearer to the centre than the last relay, the request ends.
 *
 * Several sinks divide the field: each node belongs to the one with the fewest hops. Every mote relays, so every radio
 * listens all the time. Acknowledgements are the radio's business: a report that it could not deliver is sent again after a while, to whoever is the
 * parent then, and lost, and counted, after the last attempt. A node whose parent has not acknowledged three in a row, or sends
 * it reports, asks its neighbours for another path of the same round or a newer one. */
#ifndef MOTEHOUND_COLLECTION_H
#define MOTEHOUND_COLLECTION_H

#include "motehound/protocol.h"

struct mh_collection_config {
    mh_tick beacon_period; /* between the sink's rounds of beacons, ticks, 1,000 to 3,600,000 */
    /* longest wait before a beacon is relayed, ticks, 1 to 1,000; the radio should be able to send many frames in it */
    mh_tick beacon_wait;
    mh_tick request_wait;   /* longest wait before a request is relayed, ticks, 1 to 1,000 */
    uint8_t suppress_after; /* copies heard that make a relay needless, >= 1 */
    /* nominal radio range, 1 to 1e9: scales the waits of requests, and tells whether one covers its radius */
    uint32_t range_mm;
    uint8_t attempts; /* of a report, at each node, 1 to 100, beside those that the radio makes on its own */
    mh_tick backoff; /* before the second attempt, ticks, 1 to 1,000; up to twice as long before the third, and so on */
};

/* A report that the parent may not have. */
struct mh_collection_kept {
    struct mh_measurement measurement;
    uint8_t hops;
    uint8_t frame; /* number of the one that it is in the air with */
    bool in_air : 1;
    unsigned attempts : 7; /* made; 0: the place is free */
    mh_tick due;           /* when it is to be sent again; in the air, when the radio has forgotten it */
};

/* State of one mote; read it, but leave writing to the protocol. */
struct mh_collection {
    const struct mh_collection_config *config;
    const struct mh_protocol_node *node;
    mh_node_id sink;
    mh_node_id parent;                        /* next hop towards the sink */
    uint16_t round;                           /* newest heard (or, at the sink, begun) */
    uint8_t hops;                             /* to the sink; 0 there */
    bool joined : 1;                          /* sink, parent, round and hops are known */
    bool stale : 1;                           /* ... but two rounds have not come, or the parent is lost */
    bool tracking : 1;                        /* the sink follows a track */
    bool beacon_waits : 1, request_waits : 1; /* to be relayed at ... */
    unsigned refused : 2;                     /* unicasts to the parent in a row that were not acknowledged */
    mh_tick beacon_time, request_time;
    mh_tick upkeep_time;                   /* the sink's next round; elsewhere when to ask the neighbours for a path */
    uint8_t beacon_copies, request_copies; /* heard meanwhile */
    struct {
        mh_node_id origin;
        mh_tick time;
        int32_t x_mm, y_mm, radius_mm;
        uint8_t hops;
    } request; /* the one that waits */
    struct {
        mh_node_id origin;
        mh_tick time;
    } seen[MH_COLLECTION_SEEN_MAX]; /* origin is MH_BROADCAST in a free place */
    uint8_t seen_next;
    uint8_t sent, told; /* frames handed to the radio, and those of them whose fate is known; wrap */
    struct mh_collection_kept kept[MH_COLLECTION_KEPT_MAX];
    uint16_t retries;
    uint16_t lost[MH_LOSSES]; /* reports, by reason; saturates */
};

extern const struct mh_protocol mh_protocol_collection;

/* nominal configuration: 30 s, 100 ms, 40 ms, 3 copies, 15 m, 5 attempts, 20 ms */
void mh_collection_config_default(struct mh_collection_config *config);

#endif
