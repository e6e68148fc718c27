/* Collection to a sink: every measurement travels hop by hop up a tree that the sink's beacons build.
 *
 * Beacons flood outwards from the sink. A node takes as parent the sender with the fewest hops, and relays the beacon
 * after a short pseudo-random wait unless it has meanwhile heard `suppress_after` others relay it with no more hops than its
 * own would carry: so the number of relays depends on the area, not on how many nodes stand in it (counter-based suppression, Ni et
 * al., "The broadcast storm problem", 1999). Requests travel from the head towards a place: of all that hear one,
 * the node nearest to the centre waits least and relays, the others hear that and stay silent (contention-based forwarding,
 * Fuessler et al., 2003). */
#ifndef MOTEHOUND_COLLECTION_H
#define MOTEHOUND_COLLECTION_H

#include "motehound/protocol.h"

struct mh_collection_config {
    mh_tick beacon_period; /* between the sink's rounds of beacons, ticks, >= 1,000 */
    mh_tick relay_wait;    /* longest wait before a relay, ticks, 1 to 1,000 */
    uint8_t suppress_after; /* copies heard that make a relay needless, >= 1 */
    uint32_t range_mm;     /* nominal radio range: scales the wait of contention-based forwarding */
};

extern const struct mh_protocol mh_protocol_collection;

/* nominal configuration: 30 s, 20 ms, 3 copies, 15 m */
void mh_collection_config_default(struct mh_collection_config *config);

#endif
