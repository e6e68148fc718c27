/* Where motes run. The simulator knows them by number and through this table alone, so that they may as well live in another process
 * or in an emulator.
 *
 * Time passes in windows so short that nothing a mote does in one can reach another mote in the same one. So a host is handed all that
 * happens to its motes in a window, runs them to its end, alarms included, and hands back all that they did. What a mote does depends
 * on its own events alone: how motes are spread over hosts changes nothing. */
#ifndef MOTEHOUND_SIM_HOST_H
#define MOTEHOUND_SIM_HOST_H

#include "engine/event_queue.h"
#include "motehound/mote.h"
#include "world/local_clock.h"

/* What one mote is. All that the pointers point to outlives the host; state memory is the host's. */
struct host_mote {
    mh_node_id id;
    struct mh_place place;
    const struct mh_sensor_config *sensor; /* NULL: none */
    const struct mh_head_config *head;     /* NULL: does not compute; tracker_state is ignored */
    const struct mh_centre *centre;        /* NULL: joins no tracks */
    const void *centre_config;
    const struct mh_protocol *protocol;
    const void *protocol_config;
    struct local_clock clock;
    const struct mh_clock_config *sync; /* NULL: keeps no network time */
    const char *board;                  /* that it lives on (boards.h); NULL: none */
};

enum host_event_kind {
    HOST_START, /* power up: the mote begins with cleared memory; later than at 0 its clock, unless ideal, begins at zero */
    HOST_STOP,    /* it dies: no events and no alarms reach it until it starts again */
    HOST_READING, /* its sensor has sampled; stamped by the mote's own clock */
    HOST_FRAME,   /* all of `receivers` have heard a frame; `mote` has no meaning */
    HOST_SENT,    /* what became of the oldest frame transmitted of which this has not been told */
    HOST_PROBE    /* answered with HOST_CLOCK */
};

struct host_event {
    sim_time time;
    enum host_event_kind kind;
    uint32_t mote;
    union {
        struct {
            int32_t counts;
            uint8_t target;
        } reading;
        struct {
            const uint8_t *bytes;
            const uint32_t *receivers; /* each once */
            uint32_t count;
            uint8_t length;
        } frame;
        enum mh_sent sent;
    } as;
};

enum host_action_kind { HOST_TRANSMIT, HOST_REPORT, HOST_SLEEP, HOST_CLOCK, HOST_SENSE, HOST_WORK };

/* What a mote did; as in struct mh_port but for HOST_CLOCK, and HOST_WORK: what an event has cost a mote on a board, told after all else of it. */
struct host_action {
    sim_time time;
    enum host_action_kind kind;
    uint32_t mote;
    union {
        struct {
            mh_node_id destination;
            uint8_t length, bytes[MH_FRAME_MAX];
        } transmit;
        struct mh_estimate estimate;
        bool may_sleep;
        /* what the mote takes for the network's time, as exactly as it knows it in the middle of its tick, minus simulated time; NaN where it
         * does not know it yet */
        double clock_error_s;
        struct {
            uint32_t duration_us; /* at its processor's rate */
            uint8_t message;      /* enum mh_message_kind of the frame heard, or else sent; MH_MESSAGE_KINDS: none */
            bool localises;       /* a sample, or a position */
        } work;
    } as;
};

/* All zero bytes: none. */
struct host_actions {
    struct host_action *list;
    size_t count, capacity;
};

struct board_results;

/* Totals of a host's motes, those of motes that have started anew included. */
struct host_totals {
    uint64_t events; /* starts, stops, readings, frames heard, fates of frames, probes and alarms */
    struct mh_mote_counters motes;
    struct mh_head_counters heads;
    struct mh_protocol_counters protocols;
    struct board_results *boards; /* gets those of motes on boards; NULL: nobody asks */
};

struct host {
    void *state;
    /* Mote `mote` is `what`, which is copied; it waits for HOST_START. Each mote once, before the first window. Returns 0, or -1 if there is
     * no memory. */
    int (*add)(void *state, uint32_t mote, const struct host_mote *what);
    /* The earliest alarm; SIM_TIME_NEVER if there is none. */
    sim_time (*next)(const void *state);
    /* Let the motes run until just before `until`. `events` are those of the window, in order of time; at equal times events come
     * before alarms. Appends to `actions`, each mote's in the order in which it did them. Returns 0, or -1 with one line in `error`: a
     * mote does not come up, no memory. */
    int (*run)(void *state, sim_time until, const struct host_event *events, size_t count, struct host_actions *actions,
               char *error, size_t error_size);
    /* Add to `totals`. Returns 0, or -1 with one line in `error`. */
    int (*count)(void *state, struct host_totals *totals, char *error, size_t error_size);
    void (*destroy)(void *state);
};

/* Motes of this process: the firmware library's own, `count` of them in one block of memory, each beside its protocol's state. Mote
 * i lies at place order[i] of the block, a permutation of 0 ... count - 1: where motes that hear each other lie side by side, a
 * broadcast finds them in few pages of memory. `order` outlives the host. Returns 0, or -1 if there is no memory. */
int host_in_process(struct host *host, uint32_t count, const uint32_t *order, const struct mh_protocol *protocol);

struct emulation;

/* Where the motes of a run live, if not in this process: open() makes their host, as host_in_process does. `seed` is the run's. */
struct host_provider {
    void *context;
    int (*open)(void *context, struct host *host, uint32_t count, const uint32_t *order,
                const struct mh_protocol *protocol, uint64_t seed);
    const struct emulation *emulation; /* motes that live on boards, and how these did, both NULL: none */
    struct board_results *boards;
};

/* When a mote's clock will show `tick`: not before `now`. */
sim_time host_alarm_time(const struct local_clock *clock, sim_time now, mh_tick tick);

/* As in HOST_CLOCK: a mote takes the time `now` for tick `shown` and 1/256 of it. */
double host_clock_error_s(mh_tick shown, uint8_t fraction, sim_time now);

/* One more action, to be filled in; NULL if there is no memory. */
struct host_action *host_actions_add(struct host_actions *actions);

/* Order them by time, then by mote; what one mote did at one time stays in its order. So the order does not depend on where
 * the motes run. Returns 0, or -1 if there is no memory. */
int host_actions_sort(struct host_actions *actions);

void host_actions_free(struct host_actions *actions);

/* Add one set of counters to another. */
void host_totals_add(struct host_totals *totals, const struct mh_mote_counters *motes,
                     const struct mh_head_counters *heads, const struct mh_protocol_counters *protocols);

#endif
