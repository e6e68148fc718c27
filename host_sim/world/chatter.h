/* Chatter: a protocol that carries nothing. Each node broadcasts a frame of 30 bytes once in an interval, at its own phase, and counts those
 * of its neighbours: what a radio and its motes cost by themselves. */
#ifndef MOTEHOUND_SIM_CHATTER_H
#define MOTEHOUND_SIM_CHATTER_H

#include "motehound/protocol.h"

struct chatter_config {
    mh_tick interval; /* at least 1 */
};

struct chatter {
    const struct chatter_config *config;
    const struct mh_protocol_node *node;
    mh_tick next; /* to be sent */
    uint32_t heard;
};

extern const struct mh_protocol chatter_protocol;

#endif
