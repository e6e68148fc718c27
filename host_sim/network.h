/* A running network: motes and their radio in simulated time. What the motes sense is the caller's business.
 *
 * Time passes in windows. A mote's radio begins with a frame no sooner than the lookahead, radio.delay_s, after the mote's decision (the
 * way from its software to the air), so nothing that a mote does can reach another mote within so short a time. Each window
 * begins when something happens next and ends a lookahead later, or at a sampling instant: first the radio runs to its end,
 * which gives what the motes hear; then the motes run, wherever they live; what they did is put in order and given to the
 * radio and to the observer. */
#ifndef MOTEHOUND_SIM_NETWORK_H
#define MOTEHOUND_SIM_NETWORK_H

#include "energy/account.h"
#include "engine/arena.h"
#include "engine/event_queue.h"
#include "frame_kinds.h"
#include "hosts/host.h"
#include "radio/radio.h"
#include "record/clock_errors.h"
#include "roster.h"
#include "simulation.h"

struct network_config {
    const struct scenario *scenario;
    const struct roster *roster;
    const struct host_provider *hosts; /* NULL: the motes live in this process */
    double range_m;                    /* of the radio */
    uint64_t seed;
    const struct observer *observer;
    double start_s; /* what the observer takes simulated time 0 for */
    void *context;
    /* An instant asked for with network_schedule has come. Returns 0, or -1 to end the run for want of memory. */
    int (*instant)(void *context);
    /* Mote `mote` lets its sensor sample, now: a lookahead after it said so. Whatever comes of it, it is charged. May be NULL. */
    void (*sense)(void *context, uint32_t mote);
    /* By the protocol `prince`, a new head tells those around it of its target (once, however often it does), which it found at the instant found_s. May be NULL. */
    void (*awake)(void *context, double time_s, double found_s, const mh_awake_t *awake);
    /* An estimate of mote `mote` for the instant `time_s`. */
    void (*report)(void *context, uint32_t mote, double now_s, double time_s, const struct mh_estimate *estimate);
};

enum { NETWORK_FORMS = 8, NETWORK_ANSWERS = 256 };

struct network {
    struct network_config config;
    sim_time lookahead, mote_interval;
    struct event_queue instants;
    struct radio radio;
    struct host host;
    sim_time now; /* beginning of the window; after its end, that */
    bool sensing; /* config.sense is being called */
    /* of the window: what happens to the motes, what they did, which frames went on the air */
    struct host_event *events;
    size_t event_count, event_capacity;
    struct host_actions actions;
    struct network_frame *frames;
    size_t frame_count, frame_capacity;
    struct arena arena;                                  /* bytes and receivers of the window's frames */
    uint64_t windows, frames_sent[MH_MESSAGE_KINDS + 1]; /* the last: of no known kind */
    struct frame_kinds kinds;
    mh_form_t formed[NETWORK_FORMS]; /* the clusters told last, the n-th of all in place n modulo their number */
    uint64_t forms;
    struct network_answer {
        uint32_t head; /* a mote */
        mh_node_id node;
    } answers
        [NETWORK_ANSWERS]; /* in a search, or by `prince`, those that have come to a head that has said nothing since */
    size_t answer_count;
    struct network_told {
        mh_node_id head;
        uint32_t target;
        uint16_t generation;
    } awakes[NETWORK_FORMS]; /* told last, likewise */
    uint64_t awake_count;
    uint64_t double_heads; /* of these, heads of a target's generation that another one had */
    uint64_t heads;        /* of searches, told */
    struct account account;
    double *clock_error_s; /* of each mote, NaN where it does not know the time; NULL if all clocks are ideal */
    struct clock_errors clock_errors;
    bool out_of_memory;
};

/* Make all of it and power up the motes at simulated time 0. `config` is copied; what it points to outlives the network. Returns 0,
 * or -1 with one line in `error` and nothing to free. */
int network_make(struct network *network, const struct network_config *config, char *error, size_t error_size);

void network_free(struct network *network);

/* Now, as the observer is told: the time in seconds of an instant is the same number in all that it hears. */
double network_time_s(const struct network *network);

/* Have config.instant called at `time`. Returns 0, or -1 if there is no memory. */
int network_schedule(struct network *network, sim_time time);

/* For config.instant and config.sense: mote `mote` has a reading, now. Readings that it refuses it counts. In `instant` it is charged for it. */
void network_reading(struct network *network, uint32_t mote, int32_t counts, uint8_t target);

/* For config.instant: power mote `mote` up, with cleared memory, or down, now. One with an empty battery stays down. */
void network_power(struct network *network, uint32_t mote, bool on);

/* Let everything happen that happens before `end`. Returns 0, or -1 with one line in `error`: stopped, a mote that does not come
 * up, out of memory. */
int network_run(struct network *network, sim_time end, const volatile sig_atomic_t *stop, char *error,
                size_t error_size);

/* Totals so far; `samples` is left alone. Returns 0, or -1 with one line in `error`. */
int network_count(struct network *network, struct simulation_counters *counters, char *error, size_t error_size);

#endif
