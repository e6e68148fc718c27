/* Bytes of payload that a track's messages take in an ideal network, as published and not as wire.h lays them out. */
#ifndef MOTEHOUND_SIM_IDEAL_MESSAGES_H
#define MOTEHOUND_SIM_IDEAL_MESSAGES_H

enum {
    REQUEST_BYTES = 6, /* to those that are asked */
    FORM_BYTES = 6,    /* from a new head; with a list of members MEMBER_BYTES each more */
    JOIN_BYTES = 3,    /* from a new member */
    ALERT_BYTES = 6,   /* from who finds a lost target */
    MEMBER_BYTES = 2
};

struct message_sizes {
    const char *tracker;
    unsigned answer;    /* of a node that was asked: its range, or that it detects */
    unsigned report;    /* of the position to the sink */
    unsigned hand_over; /* to a new head, without members ... */
    unsigned particle;  /* ... and particles, of which each takes so many */
};

/* Of the tracker called `name`; NULL if it cannot be handed over. */
const struct message_sizes *message_sizes_of(const char *name);

#endif
