/* Collection to a sink, with reports that travel to the sink's place instead of up a tree.
 *
 * Beacons and requests are those of `collection` (collection.h); the beacons go as landmarks, which also say where the sink stands. Every node
 * tells its neighbours by hellos where it stands. Reports go from neighbour to neighbour (geographic.h), each hop acknowledged, tried again
 * and taken once (link.h); each attempt goes to whoever is the best next hop then, so a neighbour that has died is soon left out. What is lost
 * is counted by reason.
 *
 * Hellos come at once after the start, then after an eighth of the period, a quarter, half of it, and then once a period; a neighbour is
 * forgotten after three and a half periods without one. The owner of the mote has to tell the fate of what it sends (mh_mote_sent). */
#ifndef MOTEHOUND_GEOGRAPHIC_COLLECTION_H
#define MOTEHOUND_GEOGRAPHIC_COLLECTION_H

#include "motehound/collection.h"
#include "motehound/link.h"
#include "motehound/neighbours.h"

struct mh_geographic_collection_config {
    struct mh_collection_config collection;
    struct mh_link_config link;
    mh_tick hello_period; /* ticks, 1,000 to 600,000 */
    bool faces;           /* face routing where no neighbour is nearer to the sink; else such reports are given up */
};

/* State of one mote; read it, but leave writing to the protocol. 1,229 bytes on an ATmega128. */
struct mh_geographic_collection {
    const struct mh_geographic_collection_config *config;
    const struct mh_protocol_node *node;
    struct mh_protocol_node inner; /* the mote as `collection` sees it */
    struct mh_collection collection;
    struct mh_neighbours neighbours;
    struct mh_link link;
    struct mh_place sink_place;
    bool sink_placed;
    bool collection_waits; /* for ... */
    mh_tick collection_time;
    mh_tick hello_time;
    uint16_t hellos;   /* sent */
    uint16_t sequence; /* of the last report published, if one was */
    bool published;
};

extern const struct mh_protocol mh_protocol_geographic;

/* nominal configuration: those of collection.h and link.h, 10 s, with faces */
void mh_geographic_collection_config_default(struct mh_geographic_collection_config *config);

#endif
