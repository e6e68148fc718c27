/* A search that walks: a token with all that is known of the target goes from head to head, and each head adds what it and its neighbours measure (Zhang,
 * Fig. 2). For targets at rest; the trackers of gas.h.
 *
 * All motes are alike but the sink: they have a sensor and a head's configuration (in_turns), and each leads when the token comes to it. The sink neither
 * samples nor leads; it is told what the heads find, and watches. At each sampling instant, while there is a token:
 *   instant            the head asks all who hear it (ask_t), and samples. Who is asked samples and answers (answer_t), spread over half the window.
 *   + 5/9 of `window`  the head asks once more each neighbour that has not answered, alone, so that the radio acknowledges it.
 *   + `window`         the tracker takes the head's own sample, then those of the neighbours by identifier. What it finds goes to the sink (leak_t) by
 *                      geographic routing. If the estimate was calm in `calm` successive heads, or this was head number `heads_max`, the search is over.
 *                      Else the token goes (hand_over_t, in as many parts as it takes, each acknowledged by the radio) to the neighbour that the tracker
 *                      scores highest; where it has no score, to that nearest to the estimate. At equal scores the lowest identifier.
 *
 * The score of a neighbour depends on the places of its neighbours, which are this node's neighbours' neighbours: after each hello (hello_t) a node
 * tells whom it hears, and where they are (vicinity_t).
 *
 * The token has a generation, which goes up with each head. Of two tokens the higher generation goes on, at equal ones the head with the lower
 * identifier. Whoever hears a head ask that is outranked tells it so (token_t), and so does the sink when it is told by one; that head gives up.
 *
 * What goes wrong, and what is guaranteed:
 *   - A chosen head does not acknowledge a part: after MH_TOKEN_ATTEMPTS attempts the next best is chosen; if there is none left, or no time, the head
 *     leads at the next instant too. Who has failed so is not chosen for MH_TOKEN_SHUNNED instants.
 *   - The head dies, or restarts, with the token: who handed it over has kept a copy until it is told (token_t, acknowledged) that the token has gone
 *     on. If it hears no ask at the next instant, or one but nothing more until the instant after, it leads again with its copy, and chooses another.
 *     So the search goes on, one or two instants later, as long as of the head and its predecessor one survives.
 *   - Both are lost, or the node that is to begin is dead, or does not know its neighbours: the sink, hearing nothing for `patience` instants, sends for
 *     whoever stands nearest to where the last head was, or to where the search was to begin, and that begins anew, MH_TOKEN_RESTARTS times at most.
 *     This needs the sink, and a way to it.
 *   - Who is to begin restarts: it does not begin again, if a neighbour's hello shows that that has been up for longer.
 *   - A predecessor takes a living head for dead, or a node begins again all the same: there are two tokens until they come within reach of one node, or
 *     the sink hears of both.
 *
 * Needs the network's time on all motes (mh_mote_config.clock), and does nothing before it is known. The radios listen all the time. The heads' configuration
 * (head.h) has the same interval and window as here, epoch 0, some tolerance, and own_first. The owner of the mote has to tell the fate of what it sends
 * (mh_mote_sent). What is known of a token is believed for three instants without news; the sink remembers a search that is over. */
#ifndef MOTEHOUND_TOKEN_H
#define MOTEHOUND_TOKEN_H

#include "motehound/link.h"
#include "motehound/neighbours.h"
#include "motehound/parcel.h"
#include "motehound/shunned.h"
#include "motehound/vicinity.h"

#define MH_TOKEN_START 9000 /* ticks for the first hellos, before a search begins */
#define MH_TOKEN_ATTEMPTS 3 /* at handing a part to one node, beside what the radio does on its own */
#define MH_TOKEN_SHUNNED 12 /* instants, of who has failed to take a token */
#define MH_TOKEN_REPORTS 3  /* of the end of a search */
#define MH_TOKEN_RESTARTS 3 /* of a search, by the sink */
#define MH_TOKEN_CARRIED_MAX                                                                                           \
    (2 + MH_TRACK_BYTES_MAX) /* heads so far, calm ones in succession, what the tracker saves */

struct mh_token_config {
    struct mh_link_config link;
    mh_node_id sink;            /* the mote with this identifier ... */
    struct mh_place sink_place; /* ... and place is told */
    mh_node_id start; /* who begins; MH_BROADCAST: whoever stands nearest to the place, when the sink sends for it */
    struct mh_place start_place;
    uint32_t range_mm;    /* two nodes this near hear each other, 1 to 1e9: the radios' nominal range */
    mh_tick interval;     /* between sampling instants, which are its whole multiples; 500 ticks to an hour */
    mh_tick window;       /* answers are waited for so long; 100 ticks to half the interval */
    mh_tick hello_period; /* 10 s to 1,000 s */
    uint8_t calm;         /* heads in succession with MH_ESTIMATE_CALM after which the search is over, 1 to 100 */
    uint8_t heads_max;    /* ... and after so many, 1 to 250 */
    uint8_t patience;     /* instants without news after which the sink begins anew, 4 to 250; 0: never */
    bool faces;           /* face routing where no neighbour is nearer to the sink; else such reports are given up */
};

enum mh_token_role { MH_TOKEN_NODE, MH_TOKEN_HEAD, MH_TOKEN_SINK };

/* What is to be done at a time, in this order if at the same. */
enum mh_token_timer {
    MH_TOKEN_HELLO,    /* say hello */
    MH_TOKEN_VICINITY, /* tell of some neighbours */
    MH_TOKEN_BEGIN,    /* the search */
    MH_TOKEN_INSTANT,  /* head: ask */
    MH_TOKEN_AGAIN,    /* head: ask once more */
    MH_TOKEN_ANSWER,   /* who was asked */
    MH_TOKEN_KEEP,     /* stop looking for a next head */
    MH_TOKEN_GUARD,    /* nothing was heard of the token that was handed over */
    MH_TOKEN_REPORT,   /* report the end again */
    MH_TOKEN_WATCH,    /* sink: nothing was heard of the search */
    MH_TOKEN_TIMERS
};

/* A token as others know it. */
struct mh_token_of {
    mh_node_id holder;
    int32_t generation;
    mh_tick heard; /* the last time */
    uint8_t state; /* MH_SEARCH_* */
};

/* What this node did; all saturate. */
struct mh_token_events {
    uint16_t begun;    /* searches */
    uint16_t sent_for; /* sink: times that it sent for a node to begin */
    uint16_t heads;    /* instants that this node led */
    uint16_t handed;   /* tokens handed over */
    uint16_t refused;  /* times that a node did not take a token */
    uint16_t resumed;  /* times that this node led again since its successor was silent */
    uint16_t yielded;  /* times that this head gave way to another token */
    uint16_t corrupt;  /* tokens, parts and requests of which the content was wrong, or of no time about now */
    uint16_t converged, exhausted; /* searches that were over here */
};

/* State of one mote; read it, but leave writing to the protocol. */
struct mh_token_node {
    const struct mh_token_config *config;
    const struct mh_protocol_node *node;
    struct mh_neighbours neighbours;
    struct mh_vicinity vicinity;
    struct mh_link link;
    struct mh_token_events events;
    mh_tick now, time;            /* the mote's own time and the network's, of the event that is being handled */
    uint16_t set;                 /* bit k: timer k is set ... */
    mh_tick due[MH_TOKEN_TIMERS]; /* ... for this network time */
    mh_tick began;                /* when the network's time became known */
    uint16_t hellos;              /* sent ... */
    mh_tick greeted;              /* ... the last at this network time */
    uint8_t told;                 /* neighbours told of after that */
    uint16_t sequence;            /* of messages in envelopes */
    uint8_t role;                 /* enum mh_token_role */
    bool running;                 /* the network's time is known */
    bool knows;                   /* `of` holds */
    struct mh_token_of of;

    /* who has been asked */
    bool asked, answers; /* asked_for holds; the answer goes at MH_TOKEN_ANSWER, or is on its way */
    mh_node_id asked_by;
    mh_tick asked_for;
    bool sampled; /* measured holds */
    struct mh_measurement measured;

    /* head */
    mh_tick instant;
    uint8_t heads, calm;
    uint8_t answered[(MH_NEIGHBOURS_MAX + 7) / 8]; /* bit k: neighbour k of the table has */
    uint8_t again;                                 /* the neighbour of the table that is asked once more next */
    mh_node_id guard;          /* who has handed over the token, and keeps it; MH_BROADCAST: nobody */
    struct mh_shunned shunned; /* from taking the token */

    /* who hands a token over, and then keeps it */
    bool handing, guarding;
    struct mh_token_of next;
    uint8_t part; /* to go */
    uint16_t carried_length;
    uint8_t carried[MH_TOKEN_CARRIED_MAX];

    /* who is to be head */
    struct mh_parcel parcel;
    uint8_t incoming[MH_TOKEN_CARRIED_MAX];

    /* who has brought a search to its end; the sink */
    mh_leak_t leak;
    uint8_t reports; /* to go */
    bool found;      /* sink: leak holds */
    uint8_t sent_for;
    struct mh_place head_place; /* of the last head heard of */
};

extern const struct mh_protocol mh_protocol_token;

/* nominal configuration: 12 link attempts after 20 ticks, the sink `sink` at `place`, nobody to begin, 80 m, 5 s, 1 s, hellos every 60 s, 3 calm heads of at
 * most 60, patience of 12 instants, with faces */
void mh_token_config_default(struct mh_token_config *config, mh_node_id sink, const struct mh_place *place);

#endif
