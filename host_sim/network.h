/* A running network: motes, their radio and their alarms, in simulated time. What the motes sense is the caller's business. */
#ifndef MOTEHOUND_SIM_NETWORK_H
#define MOTEHOUND_SIM_NETWORK_H

#include "engine/event_queue.h"
#include "hosts/host.h"
#include "radio/radio.h"
#include "simulation.h"
#include "trackers.h"
#include "world/deployment.h"

struct network_config {
    const struct scenario *scenario;
    const struct deployment *deployment; /* the nodes with sensors: motes 0, 1, 2 ... */
    struct mh_sensor_config sensor;
    struct tracker_choice tracker;
    struct protocol_choice protocol;
    mh_tick epoch;  /* a sampling instant */
    double range_m; /* of the radio */
    uint64_t seed;
    const struct observer *observer;
    double start_s; /* what the observer takes simulated time 0 for */
    void *context;
    /* An instant asked for with network_schedule has come. Returns 0, or -1 to end the run. */
    int (*instant)(void *context);
    /* The head's estimate for the instant `time_s`. */
    void (*report)(void *context, double now_s, double time_s, const struct mh_estimate *estimate);
};

struct network_alarm {
    sim_time wanted, queued; /* when the mote wants it, and when the queue will remember it; NEVER for not at all */
};

struct network {
    struct network_config config;
    struct mh_head_config head;
    struct event_queue queue;
    struct radio radio;
    struct host host;
    struct network_alarm *alarms;
    uint32_t count; /* of motes: the nodes, then the sink */
    mh_node_id sink_id;
    sim_time now;
    uint64_t events, frames_sent[MH_MESSAGE_KINDS];
    uint8_t fingerprints[MH_MESSAGE_KINDS][8]; /* how the frames of a kind begin */
    bool out_of_memory;
};

/* Bring up a mote for each node and one more, the sink at scenario->network.sink_*: without a sensor, with the head, its id the largest
 * node's plus one. `config` is copied; what it points to outlives the network. Returns 0, or -1 with one line in
 * `error` and nothing to free. */
int network_make(struct network *network, const struct network_config *config, char *error, size_t error_size);

void network_free(struct network *network);

/* Now, as the observer is told: the time in seconds of an instant is the same number in all that it hears. */
double network_time_s(const struct network *network);

/* Have config.instant called at `time`. Returns 0, or -1 if there is no memory. */
int network_schedule(struct network *network, sim_time time);

/* Mote `mote` has a reading, now. Readings that it refuses it counts. */
void network_reading(struct network *network, uint32_t mote, int32_t counts, uint8_t target);

/* Let everything happen that happens before `end`. Returns 0, or -1 with one line in `error`: stopped, or out of memory. */
int network_run(struct network *network, sim_time end, const volatile sig_atomic_t *stop, char *error,
                size_t error_size);

/* Totals so far; `samples` is left alone. */
void network_count(const struct network *network, struct simulation_counters *counters);

/* Metres to a mote's millimetres. */
struct mh_place place_from_metres(double x_m, double y_m, double z_m);

#endif
