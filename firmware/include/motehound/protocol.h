/* A protocol answers "who finds out?": it carries measurements to the node that computes, and that node's requests back.
 * It knows nothing of how a position is computed.
 *
 * Like a tracker it is one table of functions over a state that its owner allocates.
 *
 * `now` and timers are in the mote's own time, which runs evenly. The times in measurements and requests, and of the instants that ask and
 * asked speak of, are the network's (clock.h): compare them with each other, not with `now`. */
#ifndef MOTEHOUND_PROTOCOL_H
#define MOTEHOUND_PROTOCOL_H

#include "motehound/estimate.h"
#include "motehound/measurement.h"
#include "motehound/status.h"
#include "motehound/wire.h"

/* What became of a frame that was put on the air. */
enum mh_sent {
    MH_SENT_OK,     /* sent to one: the neighbour has acknowledged it; sent to all: it is out */
    MH_SENT_NO_ACK, /* the neighbour did not acknowledge it, however often the radio tried */
    MH_SENT_BUSY    /* it never went out: the channel was not free, or the radio was full or off */
};

/* Why a message went no farther than a node. */
enum mh_loss {
    MH_LOSS_QUEUE_FULL,
    MH_LOSS_NOT_ACKNOWLEDGED, /* however often it was sent */
    MH_LOSS_NO_ROUTE,         /* no next hop */
    MH_LOSS_LOOP,             /* it came back: there is no way from here, or two nodes take each other for the way */
    MH_LOSS_HOPS,             /* too many */
    MH_LOSS_DUPLICATE,        /* taken before; no loss to the network */
    MH_LOSSES
};

/* What one node or many did in clusters. */
struct mh_cluster_counters {
    uint32_t formed;     /* clusters, the first of a track left out */
    uint32_t recoveries; /* of these because the target was lost */
    uint32_t reports;    /* of the target's position, sent to the sink */
    uint32_t asked;      /* nodes asked to sample, each counted at each instant */
    uint32_t answered;   /* of these such that measured the target */
};

/* What one node or many did in searches that walk from head to head (token.h). */
struct mh_search_counters {
    uint32_t begun;
    uint32_t sent_for;             /* times that a sink that heard nothing sent for a node to begin */
    uint32_t heads;                /* instants that somebody led */
    uint32_t handed;               /* tokens taken by the next head */
    uint32_t refused;              /* times that a node did not take one */
    uint32_t resumed;              /* times that a head fell silent, and the one before led again */
    uint32_t yielded;              /* times that a head gave way to another */
    uint32_t corrupt;              /* messages with absurd content, not used */
    uint32_t converged, exhausted; /* searches that were over */
};

/* What one node or many did in fixed clusters (fixed.h). */
struct mh_fixed_counters {
    uint32_t led;         /* times that a node began to lead ... */
    uint32_t taken_over;  /* ... of these because the head had fallen silent */
    uint32_t yielded;     /* times that a head gave way to another */
    uint32_t misdirected; /* samples that came to who leads no more */
    uint32_t summaries;   /* sent by heads */
    uint32_t taken;       /* summaries that the centre has taken */
    uint32_t repeated;    /* ... that it had, as far as it can tell: the acknowledgement was lost */
    uint32_t overdue;     /* ... of a time that had been fused already */
    uint32_t refused;     /* what is no summary, or of no cluster */
    uint32_t fused;       /* estimates of the centre */
    uint32_t corrected;   /* tracks that took the centre's feedback, ... */
    uint32_t uncorrected; /* ... and that did not */
};

/* What one node or many did with targets that have a head each (prince.h). */
struct mh_prince_counters {
    uint32_t founded;       /* targets */
    uint32_t located;       /* fixes, each of which begins a cluster */
    uint32_t princes;       /* of these by the prince, ... */
    uint32_t exceptions;    /* ... by an outer node, ... */
    uint32_t regents;       /* ... by a regent, ... */
    uint32_t competitions;  /* ... by who won a competition, or detected the target first */
    uint32_t retries;       /* queries sent again */
    uint32_t fails;         /* fail_t said by locators, ... */
    uint32_t watchdogs;     /* ... by heads, ... */
    uint32_t relays;        /* ... again, by winners without answers */
    uint32_t repeated;      /* awake_t said again, to who had not heard it */
    uint32_t double_heads;  /* heads that yielded to another of their generation */
    uint32_t lost;          /* targets that their head, or last locator, gave up */
    uint32_t evicted;       /* rows that gave way, or that there was no room for */
    uint32_t refused;       /* messages with absurd content, or of no time about now */
    uint32_t merged, split; /* groups */
};

/* What happened to the messages of one node or of many. */
struct mh_protocol_counters {
    uint32_t lost[MH_LOSSES];
    uint32_t retries; /* messages sent once more, beside what the radio does on its own */
    struct mh_cluster_counters clusters;
    struct mh_search_counters searches;
    struct mh_fixed_counters fixed;
    struct mh_prince_counters princes;
};

/* What a protocol asks of the mote that runs it. `context` is the mote's own. */
struct mh_protocol_port {
    /* Send to one neighbour, or to all in range (MH_BROADCAST). sent() tells what became of it, in the order of sending. */
    void (*send)(void *context, mh_node_id destination, const struct mh_message *message);
    /* Call timer() at `time`; a new call replaces the earlier one. */
    void (*set_timer)(void *context, mh_tick time);
    /* A measurement has arrived at this mote, which computes. */
    void (*deliver)(void *context, mh_tick now, const struct mh_measurement *measurement);
    /* A head asks the nodes in `interest` for the sample of instant `time`. */
    void (*asked)(void *context, mh_tick now, const struct mh_interest *interest, mh_tick time);
    /* The head has begun (true) or lost (false) a track. */
    void (*tracking)(void *context, bool tracking);
    /* The radio must be able to receive (true, and so from the start) or need not (false). */
    void (*listen)(void *context, bool needed);

    /* What follows is for protocols in which motes take turns as heads; others leave it alone. */

    /* The network's time at the mote's own time `own` -> *network. Returns false if it is not known yet. And the other way round. */
    bool (*network)(void *context, mh_tick own, mh_tick *network);
    mh_tick (*own)(void *context, mh_tick network);
    /* Sample now, for instant `time`. What the sensor senses comes to publish(), or on a head to closed(), whether it is worth a report or not; at
     * once, during the call, if the sample was taken before. */
    void (*sense)(void *context, mh_tick now, mh_tick time);
    /* This mote is head from the first instant after `now`, with a track that was saved (length 0: none); it goes on gathering measurements and
     * closing instants until it is told not to be. Not to be called from closed(). Errors: MH_ERR_ARGUMENT (it cannot compute), or what load() returns:
     * then it is no head. */
    enum mh_status (*lead)(void *context, mh_tick now, const uint8_t *track, size_t length);
    void (*follow)(void *context);
    /* This head's track, as the tracker saves it; what the tracker expects at `time`; and its restart. Errors: MH_NONE (no track). */
    enum mh_status (*save)(void *context, uint8_t *track, size_t *length);
    enum mh_status (*expect)(void *context, mh_tick time, struct mh_estimate *estimate);
    void (*restart)(void *context);
    /* How good a next head `candidate` would be, at places[0], with neighbours at places[1 .. count), as the tracker scores it. Errors: MH_NONE (no track, or
     * it does not matter to the tracker). */
    enum mh_status (*score)(void *context, mh_node_id candidate, const struct mh_place *places, size_t count,
                            mh_real *score);
    /* This mote, which need not compute, knows where the target is: to its owner. */
    void (*tell)(void *context, const struct mh_estimate *estimate);
};

/* The mote as its protocol sees it. Outlives the protocol's state. */
struct mh_protocol_node {
    mh_node_id id;
    struct mh_place place;
    bool is_head; /* this mote computes, or can where motes take turns */
    const struct mh_protocol_port *port;
    void *context;
};

struct mh_protocol {
    const char *name;
    size_t state_size;    /* bytes of the state that init() fills */
    size_t config_size;   /* bytes of the configuration that init() reads */
    mh_wire_types *types; /* all that it sends and takes */
    bool in_turns;        /* a mote that can compute is head only while it is told to lead() */

    /* `config` and `node` outlive the state. Errors: MH_ERR_ARGUMENT (a configuration value outside the range its header
     * gives). */
    enum mh_status (*init)(void *state, const void *config, const struct mh_protocol_node *node);
    /* The mote is up. Called before any of the following. */
    void (*start)(void *state, mh_tick now);
    /* A sound message of one of `types` came in, sent to this mote or to all. */
    void (*message)(void *state, mh_tick now, const struct mh_message *message);
    /* What became of the oldest message sent of which this has not been told. May be NULL. */
    void (*sent)(void *state, mh_tick now, enum mh_sent outcome);
    /* The time set with set_timer has come. Early and repeated calls do no harm. */
    void (*timer)(void *state, mh_tick now);
    /* Hand on what this node measured. Errors: MH_ERR_NO_ROUTE, MH_ERR_CAPACITY (no more can wait to be sent). */
    enum mh_status (*publish)(void *state, mh_tick now, const struct mh_measurement *measurement);
    /* Head: ask the nodes in `interest` for the sample of instant `time`. Errors: MH_ERR_ARGUMENT (not a head). May
     * be NULL: heads ask by themselves, or all is reported unasked. */
    enum mh_status (*ask)(void *state, mh_tick now, const struct mh_interest *interest, mh_tick time);
    /* Head: tell the network that a track has begun or is lost. No effect on other motes. May be NULL. */
    void (*tell_tracking)(void *state, mh_tick now, bool tracking);
    /* Head: an instant is closed: `estimate` is what the tracker made of the measurements, NULL if it has no position. May be NULL. The
     * head's own is among the measurements. */
    void (*closed)(void *state, mh_tick now, mh_tick instant, const struct mh_estimate *estimate,
                   const struct mh_measurement *measurements, size_t count);
    /* The network's time has become known, or has jumped: no instant of before means anything, and the mote leads no more. May be NULL. */
    void (*time_jumped)(void *state, mh_tick now);
    /* Add to `counters`. May be NULL. */
    void (*count)(const void *state, struct mh_protocol_counters *counters);
};

#endif
