/* The radio: who hears a frame, and when.
 *
 * A unit disc: every node within range hears a broadcast, the addressee alone is handed a unicast. Each receiver loses a frame
 * independently, nothing collides, and whether a unicast got through its sender knows when it has landed. A mote's radio sends one frame at a
 * time; the others wait.
 *
 * Receivers are found through a grid of cells, so a frame costs time in the nodes about its range, not in the network's size. */
#ifndef MOTEHOUND_SIM_RADIO_H
#define MOTEHOUND_SIM_RADIO_H

#include "engine/event_queue.h"
#include "engine/random.h"
#include "motehound/config.h"
#include "motehound/protocol.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Preamble, start of frame and length of IEEE 802.15.4, sent before every frame. */
#define RADIO_HEADER_BYTES 6

#define RADIO_ALL UINT32_MAX

enum radio_state { RADIO_SLEEP, RADIO_LISTEN, RADIO_RECEIVE, RADIO_TRANSMIT, RADIO_OFF };

/* On: it listens whenever it does not send. Asleep: it only sends. */
enum radio_power { RADIO_POWER_ON, RADIO_POWER_ASLEEP, RADIO_POWER_OFF };

/* Why a receiver, or the addressee, did not get a frame. */
enum loss_reason { LOSS_RANDOM, LOSS_RANGE, LOSS_ASLEEP, LOSS_DEAD, LOSS_REASONS };

struct radio_config {
    double range_m; /* HUGE_VAL: all hear all */
    double bitrate_bps, loss;
};

/* What the radio tells, in order of time. Bytes and receivers are valid during the call. The functions may not call the radio. */
struct radio_sink {
    void *context;
    /* The sender begins to transmit. */
    void (*on_air)(void *context, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *bytes,
                   size_t length);
    /* All of `receivers`, each once, have heard the frame to its end. */
    void (*heard)(void *context, sim_time time, const uint8_t *bytes, size_t length, const uint32_t *receivers,
                  uint32_t count);
    /* What became of the sender's oldest frame of which this has not been told; of one that it was given while off, nothing. */
    void (*sent)(void *context, sim_time time, uint32_t sender, enum mh_sent outcome);
    /* The radio of a mote has changed its state. `cause` is the frame's, as given to radio_send; 0 without one. May be NULL. */
    void (*state)(void *context, sim_time time, uint32_t mote, enum radio_state state, uint8_t cause);
};

struct radio_frame {
    uint64_t number;              /* of the transmission, from 0 */
    uint32_t sender, destination; /* index of a place, or RADIO_ALL */
    uint8_t cause, length, bytes[MH_FRAME_MAX];
};

/* A place, kept in the order of the cells. */
struct radio_place {
    double x_m, y_m;
    uint32_t index;
};

struct radio {
    struct radio_config config;
    struct random_stream loss_stream;
    size_t count;
    struct radio_place *sorted;
    uint32_t *position; /* of place i in `sorted` */
    double x_min_m, y_min_m, cell_m;
    size_t columns, rows;
    size_t *cell_start;       /* columns x rows + 1 */
    struct event_queue queue; /* begin and end of flights, changes of power */
    struct radio_frame *flights;
    uint32_t *free_flights;
    size_t flights_capacity, free_count;
    sim_time *free_from;                         /* of each mote: when it has sent all that it was given so far */
    uint8_t *power;                              /* of each mote: enum radio_power */
    uint32_t *receivers;                         /* of the frame that is landing */
    uint64_t sent, received, lost[LOSS_REASONS]; /* received and lost: once per receiver */
};

/* Places 0 ... count - 1, at most 2^28; each finite. All radios are on. Returns 0, or -1 if there is no memory (nothing to free). */
int radio_make(struct radio *radio, const struct radio_config *config, const double *x_m, const double *y_m,
               size_t count, uint64_t seed);

void radio_free(struct radio *radio);

/* Hand `sender`'s radio a frame of at most MH_FRAME_MAX bytes at `time`, not before the time that radio_run has come to. Returns 0,
 * or -1 if there is no memory. */
int radio_send(struct radio *radio, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *bytes,
               size_t length, uint8_t cause);

/* Switch `mote`'s radio at `time`, not before the time that radio_run has come to. Returns as radio_send. */
int radio_power(struct radio *radio, sim_time time, uint32_t mote, enum radio_power power);

/* When the next event is; SIM_TIME_NEVER if there is none. */
sim_time radio_next(const struct radio *radio);

/* Let everything happen that happens before `until`. Returns 0, or -1 if there is no memory. */
int radio_run(struct radio *radio, sim_time until, const struct radio_sink *sink);

/* The places in an order in which those that hear each other lie side by side: place i is at number radio_order()[i]. */
const uint32_t *radio_order(const struct radio *radio);

#endif
