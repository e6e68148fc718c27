/* The trackers and protocols that a scenario can name, set up as it says. */
#ifndef MOTEHOUND_SIM_TRACKERS_H
#define MOTEHOUND_SIM_TRACKERS_H

#include "motehound/acoustic.h"
#include "motehound/centroid.h"
#include "motehound/cluster.h"
#include "motehound/collection.h"
#include "motehound/direct.h"
#include "motehound/election.h"
#include "motehound/fixed.h"
#include "motehound/geographic_collection.h"
#include "motehound/luo.h"
#include "motehound/mote.h"
#include "motehound/pftl.h"
#include "motehound/prince.h"
#include "motehound/token.h"
#include "scenario/recording.h"
#include "scenario/scenario.h"
#include "world/chatter.h"
#include "world/clusters.h"

#include <string.h>

#if !MH_REAL_FIXED
#include "motehound/cv.h"
#include "motehound/diffusion.h"
#include "motehound/fusion_centre.h"
#include "motehound/gas.h"
#include "motehound/gas_wind.h"
#include "motehound/msl.h"
#include "motehound/range.h"
#endif

/* Points into itself: not to be copied or moved. */
struct tracker_choice {
    const struct mh_tracker *tracker;
    enum quantity measures;
    union {
        struct mh_luo_config luo;
        struct mh_pftl_config pftl;
        struct mh_centroid_config centroid;
        struct mh_acoustic_config acoustic;
#if !MH_REAL_FIXED
        struct mh_diffusion_config diffusion;
        struct mh_range_config range;
        struct mh_msl_config msl;
        struct mh_gas_config gas;
        struct mh_cv_config cv;
        struct mh_gas_wind_config gas_wind;
#endif
    } config;                             /* the tracker's own */
    uint32_t *seed;                       /* in it, of the random numbers; NULL: there are none */
    uint32_t (*draws)(const void *state); /* of particles, since the state was begun; NULL: there are none */
    bool wants_wind;                      /* readings of the wind are for it too */
#if !MH_REAL_FIXED
    struct mh_cv_noise noise[CLUSTERED_NODES_MAX]; /* of fixed clusters' nodes */
#endif
};

/* What joins the tracks of fixed clusters; no `centre` where one tracker has all samples. */
struct centre_choice {
    const struct mh_centre *centre;
#if !MH_REAL_FIXED
    struct mh_fusion_centre_config config;
#else
    char config; /* no centre is in this build */
#endif
};

/* Points into itself where clusters are fixed or targets expected: not to be copied or moved. */
struct protocol_choice {
    const struct mh_protocol *protocol;
    /* Each node with a sensor can be head, the sink is none, and sensors sample when they are asked; else the sink is the only head, and
     * sensors sample at every instant. */
    bool in_turns;
    /* The nodes are heads likewise, each of a cluster of its own; the sink has a centre. */
    bool fixed;
    /* Sensors sample at rates of their own: those of fixed clusters, also where the sink is the only head and has all their samples. */
    bool own_rates;
    union {
        struct mh_collection_config collection;
        struct mh_geographic_collection_config geographic;
        struct mh_direct_config direct;
        struct mh_cluster_config cluster; /* but for the sink, which the roster knows */
        struct mh_fixed_config fixed;     /* likewise */
        struct mh_token_config token;     /* likewise, and but for the node that begins */
        struct mh_prince_config prince;   /* but for where targets are expected */
        struct chatter_config chatter;
    } config;
    struct mh_fixed_cluster clusters[SCENARIO_NUMBERS_MAX]; /* of `fixed` */
    struct mh_fixed_member members[CLUSTERED_NODES_MAX];
    struct mh_prince_entry entries[TARGETS_MAX]; /* of `prince` */
};

/* The tracker that scenario->tracker names. `region` is where the source can be; NULL: unbounded. Returns 0, or -1 with one line in
 * `error` (no such tracker: names those there are). */
int tracker_choose(const struct scenario *scenario, const struct mh_region *region, struct tracker_choice *choice,
                   char *error, size_t error_size);

/* Let the tracker cv_ukf or cv_ekf know the noise of fixed clusters' nodes. Returns how late samples may come to it. */
mh_tick tracker_tell_clusters(struct tracker_choice *choice, const struct clusters *clusters);

/* The fusion centre that scenario->fusion names, of `count` clusters. */
void centre_choose(const struct scenario *scenario, size_t count, struct centre_choice *choice);

/* The tracker that scenario->tracker names, for a recording with readings each interval_s. Where the winds are measured `gas` looks for the leak with them:
 * among the candidates, or else on a grid over the rectangle in which the nodes stand. Returns as tracker_choose, or -1 too where there are candidates and
 * the tracker is another or has no winds. */
int tracker_choose_of_recording(const struct scenario *scenario, const struct recording *recording, double interval_s,
                                struct tracker_choice *choice, char *error, size_t error_size);

/* Its random numbers, if it has any, come from `seed`. */
void tracker_seed(struct tracker_choice *choice, uint32_t seed);

/* Particles that the tracker in `state` has drawn since it was begun; 0 for one that has none. */
uint32_t tracker_draws(const struct tracker_choice *choice, const void *state);

/* How clusters are chosen, as scenario->protocol says. */
struct mh_election_config election_config_of(const struct scenario *scenario);

/* Name and meaning of tracker `i`, from 0; false after the last. */
bool tracker_describe(size_t i, const char **name, const char **meaning);

/* Let the protocol `fixed` know its clusters; no other has any. */
void protocol_tell_clusters(struct protocol_choice *choice, const struct clusters *clusters);

/* Let the protocol `prince` know where and when targets begin in the run with `seed`, if scenario->protocol says so. Returns as tracker_choose. */
int protocol_tell_entries(struct protocol_choice *choice, const struct scenario *scenario, uint64_t seed, char *error,
                          size_t error_size);

static inline bool protocol_is(const struct mh_protocol *protocol, const char *name)
{
    return strcmp(protocol->name, name) == 0;
}

/* The protocol called `name`; `fixed` is still to be told its clusters, `prince` its entries. Returns as tracker_choose. */
int protocol_choose(const char *name, const struct scenario *scenario, struct protocol_choice *choice, char *error,
                    size_t error_size);

#endif
