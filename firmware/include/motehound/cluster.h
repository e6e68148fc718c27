/* Dynamic clusters: the nodes sleep, but those around a moving target, and one of these leads.
 *
 * At each sampling instant the head asks, those asked sample and answer, the head localises, and an election rule (election.h) decides on the
 * cluster of the next instant. The track goes with the lead, from neighbour to neighbour. What the head stores of it is told to the sink,
 * which extrapolates.
 *
 * Who may sleep is reached in wake windows (rendezvous.h). An instant, which is the beginning of a window:
 *   instant            the head asks (ask_t: whom, where the target is expected). Who is asked samples and answers (answer_t), members one
 *                      after the other, others spread over the same time; only who measures something answers.
 *   + 5/9 of `window`  the head asks once more if a member near the target has not answered.
 *   + `window`         the head localises. Whoever is to lead next gets the track (hand_over_t) in the next window, sent until its radio
 *                      acknowledges it; the new head announces its cluster (form_t) in the window after that, and in the next again, and by
 *                      the rules that want it (sac, rho) members answer (join_t). What is to be reported goes to the sink (position_t) by
 *                      geographic routing, a hop or more a window.
 *
 * A cluster is known by its track, the node that began it, and its generation, which goes up whenever a cluster forms, and tells of two
 * heads which is to go on: the higher generation, at equal ones the lower identifier. Whoever hears of a better head of the same track, or of any
 * track within the sensing range of its own, follows.
 *
 * What goes wrong:
 *   - A chosen head does not acknowledge the track: MH_CLUSTER_ATTEMPTS windows later the next best is chosen, and before the next instant the old
 *     head goes on itself. Whoever has failed so is not chosen again for a minute.
 *   - The head falls silent: after two instants without being asked its members take over, in the order in which it chose them, one a window, each only
 *     if none before has. They know where the target was and how it moved, and begin the track anew there.
 *   - Nobody answers: at the next instant all who hear the head are asked, and the track is begun anew about those who answer. If then nobody
 *     does either, the head tells all within MH_CLUSTER_ALERT_HOPS hops (alert_t) and gives the track up. They sample at every instant for a while.
 *   - Nobody follows the target, or knows of it: who has not been asked of late samples once in `watch_period`, each node at an instant of
 *     its own. Who finds the target alerts its neighbours in the next window (alert_t), the nearer the earlier, and leads; the others hear that,
 *     and do not.
 *
 * Hellos go twice in the first MH_CLUSTER_START ticks, in which all listen, once more in a wake window soon after, and then once a hello period, in
 * wake windows. Who hears one of the first three of another, and has been here longer, says hello in one of the next 16 windows, at most every 10 s:
 * so nodes that restart, however many at once, know their neighbours again within about ten seconds.
 *
 * All motes but the sink have a head's configuration, with the same interval and window as here, epoch 0 and some tolerance: who is asked samples
 * when it hears of it.
 *
 * Needs the network's time on all motes (mh_mote_config.clock), to within a quarter of a wake window, and does nothing before it is known. The owner of the
 * mote has to tell the fate of what it sends (mh_mote_sent). Of a form_t's members MH_FORM_MEMBERS are told, so many can be asked by the rules
 * with members. Ticks wrap, so what a node knows of a track is forgotten after a day without news.
 *
 * Memory: a mote that can lead with the tracker `range` takes 8.3 kB and 2.2 kB of stack on a Cortex-M0 (docs/costs.md). On an ATmega128 that is 3.0 kB,
 * 0.3 kB of constants and 1.2 kB of stack with the default capacities: its 4 KB hold such a mote only with smaller ones, e.g. 2.1 kB with MH_REPORTS_MAX 9,
 * MH_NEIGHBOURS_MAX 8, MH_LINK_QUEUE_MAX 2 and MH_LINK_SEEN_MAX 4. */
#ifndef MOTEHOUND_CLUSTER_H
#define MOTEHOUND_CLUSTER_H

#include "motehound/election.h"
#include "motehound/followed.h"
#include "motehound/link.h"
#include "motehound/neighbours.h"
#include "motehound/parcel.h"
#include "motehound/rendezvous.h"
#include "motehound/shunned.h"

#define MH_CLUSTER_START 4500      /* ticks */
#define MH_CLUSTER_ATTEMPTS 2      /* at handing a track to one node, beside what the radio does on its own */
#define MH_CLUSTER_ALERT_HOPS 2    /* of the alert that a target is lost */
#define MH_CLUSTER_SEARCH 10       /* instants for which who heard it samples */
#define MH_CLUSTER_SHUN_TIME 60000 /* ticks, of who has failed to take a track */

/* A track on its way: number of members, their identifiers, what the tracker saves. Nodes take no track with more members than they have room for, so
 * `election.members` is at most the least MH_CLUSTER_MAX of the network. */
#define MH_CLUSTER_CARRIED_MAX                                                                                         \
    (1 + 4 * (MH_CLUSTER_MAX < MH_FORM_MEMBERS ? MH_CLUSTER_MAX : MH_FORM_MEMBERS) + MH_TRACK_BYTES_MAX)

struct mh_cluster_config {
    struct mh_election_config
        election; /* its interval is the network's sampling interval, at least 100 ticks; instants are its whole multiples */
    struct mh_link_config link;
    mh_node_id sink;            /* the mote with this identifier ... */
    struct mh_place sink_place; /* ... and place gets the reports; it listens all the time */
    mh_tick wake_period;        /* of the radios, to a quarter of an hour; 0: they listen all the time */
    mh_tick wake_length;        /* of a wake window, 4 ticks to the period */
    mh_tick window;       /* as in the head's configuration: answers are waited for so long; 20 ticks to interval */
    mh_tick watch_period; /* interval to an hour */
    mh_tick hello_period; /* 10 s to 1,000 s */
    bool faces;           /* face routing where no neighbour is nearer to the sink; else such reports are given up */
};

enum mh_cluster_role { MH_CLUSTER_SLEEPER, MH_CLUSTER_MEMBER, MH_CLUSTER_HEAD, MH_CLUSTER_SINK };

/* What is to be done at a time, in this order if at the same. */
enum mh_cluster_timer {
    MH_CLUSTER_QUIET,     /* stop listening */
    MH_CLUSTER_HELLO,     /* say hello */
    MH_CLUSTER_INSTANT,   /* the next instant that matters to this node */
    MH_CLUSTER_AGAIN,     /* ask once more */
    MH_CLUSTER_ANSWER,    /* answer, or join */
    MH_CLUSTER_FORM,      /* announce the cluster */
    MH_CLUSTER_ALERT,     /* alert */
    MH_CLUSTER_TAKE_OVER, /* take over from a silent head */
    MH_CLUSTER_KEEP,      /* stop looking for a next head */
    MH_CLUSTER_TIMERS
};

/* A cluster as the nodes around it know it. */
struct mh_cluster_of {
    mh_node_id track, head;
    int32_t generation;
    mh_tick heard; /* the last instant of it */
    mh_tick time;  /* where the target was expected at this instant ... */
    int32_t x_mm, y_mm;
    int32_t vx_mmps, vy_mmps; /* ... and how it moved */
};

/* What this node did beside what protocol.h counts of clusters; all saturate. */
struct mh_cluster_events {
    uint16_t begun;      /* tracks begun here */
    uint16_t lost;       /* tracks given up here */
    uint16_t handed;     /* tracks handed to the next head */
    uint16_t refused;    /* times that a node did not take a track */
    uint16_t taken_over; /* times that this node took over from a silent head */
    uint16_t yielded;    /* times that this head gave way to another */
};

/* State of one mote; read it, but leave writing to the protocol. 1.9 kB on an ATmega128, 5.5 kB on a Cortex-M0. */
struct mh_cluster_node {
    const struct mh_cluster_config *config;
    const struct mh_protocol_node *node;
    struct mh_rendezvous rendezvous;
    struct mh_neighbours neighbours;
    struct mh_link link;
    struct mh_cluster_counters counters;
    struct mh_cluster_events events;
    mh_tick now, time;              /* the mote's own time and the network's, of the event that is being handled */
    uint16_t set;                   /* bit k: timer k is set ... */
    mh_tick due[MH_CLUSTER_TIMERS]; /* ... for this network time */
    mh_tick began;                  /* when the network's time became known */
    uint16_t hellos;                /* sent ... */
    mh_tick greeted;                /* ... the last at this network time */
    uint16_t sequence;              /* of messages in envelopes */
    uint8_t role;                   /* enum mh_cluster_role */
    bool running;                   /* the network's time is known */
    bool listening;                 /* whatever is needed else */

    bool knows; /* `of` holds */
    struct mh_cluster_of of;
    struct mh_cluster cluster; /* the head's own; a member's: its head and itself */
    uint8_t rank;              /* a member's, from 0 */
    mh_tick instant;           /* that this node is busy with */
    mh_tick search_until;      /* it samples at every instant */

    /* who has been asked */
    bool answers, joins; /* at MH_CLUSTER_ANSWER */
    uint8_t answer_tries;
    uint8_t answer_ahead; /* frames whose fate is told before that of the answer, and it; 0: it is not on its way */
    mh_node_id asked_by;
    mh_tick asked_for; /* this instant; ... */
    bool asked;        /* ... it holds */
    bool answered;     /* and the head has the answer */
    struct mh_measurement measured;

    /* who has found the target, or is to relay that it is lost */
    mh_alert_t alert;
    uint8_t finds; /* samples of a target that nobody seems to follow */

    /* head */
    bool everyone;             /* all who hear it are asked */
    bool afresh;               /* the first cluster of a track, or after a loss, is to be formed */
    uint8_t last_answers;      /* in this cluster; UINT8_MAX: there was no instant yet */
    uint8_t misses;            /* instants in succession without an answer */
    uint8_t forms;             /* announcements to go */
    uint32_t heard;            /* bit k: member k has answered, or joined */
    bool handing;              /* the track, to ... */
    struct mh_cluster next;    /* ... the head of this cluster ... */
    int32_t next_generation;   /* ... of this generation ... */
    uint8_t parts;             /* ... in so many parts to go */
    struct mh_shunned shunned; /* from taking a track */

    /* who is to be head */
    struct {
        struct mh_parcel parcel;
        uint8_t bytes[MH_CLUSTER_CARRIED_MAX];
    } incoming;

    /* sink */
    struct mh_followed followed;
    struct mh_place followed_origin;
};

extern const struct mh_protocol mh_protocol_cluster;

/* nominal configuration: that of the election rule, 4 link attempts after 100 ticks, the sink `sink` at `place`, windows of 10 in 250 ticks, 150 ticks for answers, a
 * watch period of 10 s, hellos every 300 s, with faces */
void mh_cluster_config_default(struct mh_cluster_config *config, enum mh_election rule, mh_node_id sink,
                               const struct mh_place *place);

#endif
