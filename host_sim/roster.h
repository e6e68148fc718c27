/* Who is in the network: what each mote of a run is. The nodes with sensors are motes 0, 1, 2 ... in the order of their identifiers; one
 * more, the sink, has no sensor, and the largest node's identifier plus one. It is the head, unless the protocol lets the nodes take turns.
 *
 * It follows from the scenario and the seed alone, so every process that hosts motes of a run can make it for itself. */
#ifndef MOTEHOUND_SIM_ROSTER_H
#define MOTEHOUND_SIM_ROSTER_H

#include "hosts/host.h"
#include "scenario/scenario.h"
#include "trackers.h"
#include "world/deployment.h"

/* What all motes of a run have in common. Points into itself: not to be copied or moved once it is complete. */
struct mote_kit {
    struct mh_sensor_config sensor;
    struct clusters clusters; /* fixed ones */
    struct tracker_choice tracker;
    struct protocol_choice protocol;
    struct centre_choice centre; /* of the sink of fixed clusters */
    struct mh_head_config head;
    bool synchronised;                  /* motes keep the network's time ... */
    struct mh_clock_config root, other; /* ... which is the head's */
};

struct roster {
    struct mote_kit kit;
    struct deployment deployment;
    uint64_t seed;
    double clock_offset_s, clock_drift_ppm, clock_wander_ppm; /* bounds; the sink's clock is ideal */
    double sink_x_m, sink_y_m;
    uint32_t count; /* of motes, the sink included */
    mh_node_id sink_id;
};

/* The kit of a simulated run of `scenario`. Returns 0, or -1 with one line in `error`. */
int mote_kit_make(struct mote_kit *kit, const struct scenario *scenario, char *error, size_t error_size);

/* Complete the kit where the caller has filled in sensor, tracker and protocol; `epoch` is a sampling instant. */
void mote_kit_complete(struct mote_kit *kit, const struct scenario *scenario, mh_tick epoch);

/* Reports go to mote `sink` at `place`, which some protocols want to know beforehand. */
void mote_kit_tell_sink(struct mote_kit *kit, mh_node_id sink, struct mh_place place);

/* Mote `start` at `place` begins the search, if it is one. */
void mote_kit_tell_start(struct mote_kit *kit, mh_node_id start, struct mh_place place);

/* Mote `id` at `place`: the sink, or a node with a sensor; its clock is ideal. It points into the kit. */
struct host_mote mote_kit_mote(const struct mote_kit *kit, mh_node_id id, struct mh_place place, bool is_sink);

/* The motes of `scenario` run with `seed`. Returns 0, or -1 with one line in `error`; roster_free it in any case. */
int roster_make(struct roster *roster, const struct scenario *scenario, uint64_t seed, char *error, size_t error_size);

/* The same where the caller has filled in the seed, the deployment and the kit. */
int roster_complete(struct roster *roster, const struct scenario *scenario, char *error, size_t error_size);

void roster_free(struct roster *roster);

/* What mote `mote` is. It points into the roster. */
struct host_mote roster_mote(const struct roster *roster, uint32_t mote);

/* It can be a head. */
bool roster_computes(const struct roster *roster, uint32_t mote);

/* Some mote's idea of the network's time may be wrong. */
bool roster_has_clocks(const struct roster *roster);

mh_node_id roster_id(const struct roster *roster, uint32_t mote);

/* The mote with identifier `id`; the sink's number where no node has it. */
uint32_t roster_find(const struct roster *roster, mh_node_id id);

/* Metres to a mote's millimetres. */
struct mh_place place_from_metres(double x_m, double y_m, double z_m);

#endif
