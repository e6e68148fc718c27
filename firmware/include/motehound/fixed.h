/* Fixed clusters: each sensor belongs to one for good and reports every sample to its head, at its own rate; each head follows the target with a tracker of its own and
 * tells a fusion centre (centre.h) at the sink at a rate of its own; the centre joins what it is told and tells the sink's owner.
 *
 * - Everybody knows the clusters by configuration. Of a cluster the member with the lowest identifier that is alive leads. All members can compute; a member is a
 *   plain sensor until it leads.
 * - Messages travel from neighbour to neighbour by places (geographic.h, greedily), acknowledged hop by hop and tried again (link.h). A cluster's members are within reach of each
 *   other's radios.
 * - Members send each sample (report_t) to the head as soon as it is taken. The head steps its tracker at each instant of its configuration; how late a sample may be the
 *   tracker says.
 * - At the first instant after each whole `report_interval` (of network time) that is closed the head sends what its tracker summarises for it (summary_t), in one or two parts.
 * - At T + `wait`, T a whole fuse_interval, the centre joins what came for T; the sink tells its owner. The sink tells the head of a summary that it has been taken (centre_t) if
 *   `acknowledges`, and what the centre feeds back, if it does, after each fusion.
 * - The head tells its cluster that it is there once a report interval (lead_t).
 *
 * What goes wrong:
 *   - The head falls silent: who has not heard it for `patience` report intervals, and one more for each member that is before it, leads, and begins a new track. Samples that were
 *     sent to the dead head meanwhile are lost.
 *   - A member with a lower identifier comes back: it waits `patience` report intervals to hear a head. Whoever leads goes on, so that its track is not lost for
 *     nothing; of two that lead the higher identifier follows.
 *   - A summary is lost: the centre goes on without it, as its rule has it. If only its acknowledgement is, see summary.h.
 *   - A summary that is not what a tracker writes, or of a cluster that does not exist, or not from one of that cluster's members, is refused and counted.
 *   - The network's time jumps, or becomes known: heads stop to lead, and all begin anew.
 *
 * The motes of the clusters have a head's configuration, the sink has a centre (mote.h); others relay. Needs the network's time on all motes where clocks differ. */
#ifndef MOTEHOUND_FIXED_H
#define MOTEHOUND_FIXED_H

#include "motehound/estimate.h"
#include "motehound/link.h"
#include "motehound/neighbours.h"

struct mh_fixed_member {
    mh_node_id id;
    struct mh_place place;
};

struct mh_fixed_cluster {
    const struct mh_fixed_member *members; /* by identifier, ascending */
    uint8_t count;                         /* 1 to 250 */
};

/* What the protocol asks of the mote besides protocol.h: of its tracker (tracker.h), if it leads, and of its centre (centre.h), at the sink. `context` is the node's. The same
 * errors; MH_NONE without such a thing. */
struct mh_fixed_port {
    enum mh_status (*summarise)(void *context, mh_tick time, uint8_t *bytes, size_t *length);
    void (*summary_taken)(void *context, mh_tick time);
    enum mh_status (*correct)(void *context, mh_tick time, const uint8_t *bytes, size_t length);
    enum mh_status (*take)(void *context, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length);
    enum mh_status (*fuse)(void *context, mh_tick time, struct mh_estimate *estimate);
    enum mh_status (*feedback)(void *context, uint8_t *bytes, size_t *length);
};

struct mh_fixed_config {
    struct mh_link_config link;
    const struct mh_fixed_port *port; /* &mh_mote_fixed (mote.h) */
    mh_node_id sink;                  /* the mote with this identifier ... */
    struct mh_place sink_place;       /* ... and place has the centre */
    const struct mh_fixed_cluster *clusters;
    uint8_t cluster_count;   /* 1 to 250 */
    mh_tick report_interval; /* T_f, a whole multiple of the head's interval, 20 ticks to an hour. Nominal 1,000 */
    mh_tick fuse_interval;   /* 20 ticks to an hour. Nominal 1,000 */
    mh_tick wait;            /* 1 to fuse_interval. Nominal 500 */
    uint8_t patience;        /* 1 to 100. Nominal 3 */
    bool acknowledges;       /* the rule needs to know which summaries the centre has */
    mh_tick hello_period;    /* 1,000 to 600,000. Nominal 10,000 */
};

extern const struct mh_protocol mh_protocol_fixed;

/* nominal configuration: that of link.h, the values above; `port`, sink and clusters remain to be filled in */
void mh_fixed_config_default(struct mh_fixed_config *config);

#endif
