/* A mote of the protocol `geographic` with as many neighbours as it can hold. */
#ifndef GEOGRAPHIC_H
#define GEOGRAPHIC_H

#include "motehound/geographic_collection.h"
#include "motehound/mote.h"

enum { GEOGRAPHIC_SINK = 9, GEOGRAPHIC_MOTE = 5 };

struct geographic_state {
    struct mh_mote mote;
    struct mh_geographic_collection protocol;
};

/* The last frame transmitted to one neighbour. */
struct geographic_sent {
    mh_node_id destination;
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
};

void geographic_setup(struct geographic_state *state, struct geographic_sent *sent);

/* Encode and hand in. */
void geographic_hear(struct geographic_state *state, mh_tick now, const struct mh_message *message);

#endif
