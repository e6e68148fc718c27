/* Fixed clusters: each sensor belongs to one for good and reports every sample to its head, at its own rate; each head follows the target with a tracker of its own and
 * tells a fusion centre (centre.h) at the sink, at a rate of its own; the centre joins what it is told and tells the sink's owner.
 *
 * Everybody knows the clusters by configuration. All members of a cluster have a head's configuration, but are plain sensors until they lead; they are within reach of each other's
 * radios, and have sensors that report always. The sink has a centre; motes of no cluster relay. What goes between heads and sink travels by places, greedily (geographic.h), acknowledged
 * hop by hop and tried again (link.h): each mote but the sink needs a neighbour that is nearer to the sink, and the other way round.
 *
 * - Members send each sample (report_t) to their head as soon as it is to be reported. The head closes an instant after the other (head.h); how late a sample may be the head's
 *   configuration and the tracker say.
 * - At each instant that is a whole number of report intervals, at once or up to a tenth of the interval after it is closed, the head sends what its tracker summarises for it (a parcel of one or two hand_over_t: `track` is the cluster,
 *   `generation` and `time_ms` the instant).
 * - `wait` after each whole number of fuse intervals the centre joins what has come for it, and the sink tells its owner. If it feeds back, that goes to the heads as summaries come.
 * - With `acknowledges` the sink tells a head of a summary that the centre has taken it (taken_t).
 * - The head says that it is there (lead_t), and where it has the target, as far as its tracker saves that in MH_LEAD_BYTES, once a report interval; its radio's acknowledgement of a sample stands for that, four times `patience` intervals long. Before anything is heard the first member is taken for
 *   the head; it leads at once.
 *
 * What goes wrong:
 *   - The head falls silent: a member that has heard nothing of it for `patience` report intervals, and one more for each member before it, leads, and goes on with the track
 *     that the head has said last, or begins anew if it has said none. What was sent to the head meanwhile is lost.
 *   - The head restarts: it leads again when a member sends it a sample, or if another is faster, follows that, as all do.
 *   - Two heads hear of each other: the one that has led longer goes on, of two equal ones the lower identifier. So a first member that restarts leads until it hears the head; it
 *     sends no summary in its first report interval.
 *   - A summary is lost: the centre does without it, as its rule has it. If only its acknowledgement is, the centre refuses the next one, which counts from before (MH_ERR_REPEATED),
 *     and the head is told again which one is the last that the centre has.
 *   - What is not from a member of the cluster, of no cluster, or not what a tracker writes is refused and counted.
 *   - The network's time becomes known, or jumps: heads lead no more, and all begin anew, the centre too.
 *
 * Needs the network's time on all motes (mh_mote_config.clock), if their own clocks do not agree. The owner of the mote has to tell the fate of what it sends (mh_mote_sent). */
#ifndef MOTEHOUND_FIXED_H
#define MOTEHOUND_FIXED_H

#include "motehound/link.h"
#include "motehound/neighbours.h"
#include "motehound/parcel.h"

struct mh_fixed_member {
    mh_node_id id;
    struct mh_place place;
};

struct mh_fixed_cluster {
    const struct mh_fixed_member *members; /* by identifier, ascending */
    uint8_t count;                         /* 1 to 250 */
};

/* What the protocol asks of the mote besides protocol.h: of its tracker (tracker.h) if it leads, and of its centre (centre.h) at the sink. `context` is the node's. The errors are
 * theirs; MH_NONE without such a thing. */
struct mh_fixed_port {
    enum mh_status (*summarise)(void *context, mh_tick time, uint8_t *bytes, size_t *length);
    void (*summary_taken)(void *context, mh_tick time);
    /* What the centre made of all summaries of `time`, this head being that of `cluster`. */
    enum mh_status (*correct)(void *context, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length);
    /* The centre begins. */
    enum mh_status (*begin)(void *context);
    enum mh_status (*take)(void *context, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length);
    enum mh_status (*fuse)(void *context, mh_tick time, struct mh_estimate *estimate);
    enum mh_status (*feedback)(void *context, uint8_t *bytes, size_t *length);
};

struct mh_fixed_config {
    struct mh_link_config link;
    const struct mh_fixed_port *port; /* &mh_mote_fixed (mote.h) */
    mh_node_id sink;                  /* the mote with this identifier ... */
    struct mh_place sink_place;       /* ... and place */
    const struct mh_fixed_cluster *clusters;
    uint8_t cluster_count; /* 1 to MH_FIXED_CLUSTERS_MAX */
    mh_tick
        report_interval; /* a whole number of the heads' intervals, at most ten, 100 ticks to an hour. Nominal 1,000 */
    mh_tick fuse_interval; /* 100 ticks to an hour. Nominal 1,000 */
    mh_tick wait;          /* 1 to fuse_interval. Nominal 500 */
    uint8_t patience;      /* 2 to 100. Nominal 3 */
    bool acknowledges;     /* the rule needs to know which summaries the centre has */
    mh_tick hello_period;  /* 1,000 to 600,000. Nominal 10,000 */
};

enum mh_fixed_role { MH_FIXED_RELAY, MH_FIXED_MEMBER, MH_FIXED_HEAD, MH_FIXED_SINK };

/* What is to be done at a network time, in this order if at the same. */
enum mh_fixed_timer {
    MH_FIXED_HELLO,
    MH_FIXED_SAY,   /* head: that it leads */
    MH_FIXED_WATCH, /* member: the head has been silent for too long */
    MH_FIXED_TELL,  /* head: the sink of its track */
    MH_FIXED_FUSE,  /* sink */
    MH_FIXED_TIMERS
};

/* State of one mote; read it, but leave writing to the protocol. */
struct mh_fixed {
    const struct mh_fixed_config *config;
    const struct mh_protocol_node *node;
    struct mh_neighbours neighbours;
    struct mh_link link;
    mh_tick now, time; /* the mote's own time and the network's, of the event that is being handled */
    bool running;      /* the network's time is known */
    uint16_t set;      /* bit k: timer k is set ... */
    mh_tick due[MH_FIXED_TIMERS];
    uint16_t hellos, sequence;
    uint8_t role;          /* enum mh_fixed_role */
    uint8_t cluster, rank; /* of a member: its cluster, and its number in that */
    uint8_t head;          /* the member that leads ... */
    mh_tick since;         /* ... since then, ... */
    bool heard;            /* ... as it has said, ... */
    mh_tick said;          /* ... the last time then */
    uint8_t track_length;  /* of its track: 0 if there is none */
    uint8_t track[MH_LEAD_BYTES];
    mh_tick told, fused; /* what a head is to tell the sink of, what that is to fuse */
    /* what comes in parts: at the sink of each cluster, at a head from the sink */
    struct mh_fixed_incoming {
        struct mh_parcel parcel;
        uint8_t head;  /* sink: the member that the last summary came from, ... */
        mh_tick taken; /* ... and the last that the centre has taken */
        bool has_head, has_taken;
        uint8_t bytes[MH_SUMMARY_BYTES_MAX];
    } incoming[MH_FIXED_CLUSTERS_MAX];
    struct mh_fixed_counters counters;
};

extern const struct mh_protocol mh_protocol_fixed;

/* nominal configuration: that of link.h, the values above; `port`, the sink and the clusters remain to be filled in */
void mh_fixed_config_default(struct mh_fixed_config *config);

#endif
