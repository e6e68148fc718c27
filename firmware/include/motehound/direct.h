/* Direct: every node stands within radio range of the head and sends to it, once and without a relay.
 *
 * A node learns the head's identifier, and whether it follows a track, from the head's beacons. For ranging anchors and other small
 * cells. Between beacons a node's radio may sleep if the configuration says so; the head's requests then go unheard, so use that
 * only with trackers that never ask. */
#ifndef MOTEHOUND_DIRECT_H
#define MOTEHOUND_DIRECT_H

#include "motehound/protocol.h"

struct mh_direct_config {
    mh_tick beacon_period; /* between the head's beacons, ticks, 1,000 to 3,600,000 */
    bool sleeps;           /* nodes need not listen from one beacon until 1/16 of the period before the next */
};

/* State of one mote; read it, but leave writing to the protocol. */
struct mh_direct {
    const struct mh_direct_config *config;
    const struct mh_protocol_node *node;
    mh_node_id head;
    mh_tick wake_time; /* head: the next beacon; else: when to listen again */
    uint16_t round;
    bool known;    /* head is */
    bool waits;    /* for wake_time */
    bool tracking; /* the head follows a track */
};

extern const struct mh_protocol mh_protocol_direct;

/* nominal configuration: 10 s, no sleep */
void mh_direct_config_default(struct mh_direct_config *config);

#endif
