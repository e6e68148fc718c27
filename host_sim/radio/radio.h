/* The radio: who hears a frame, and when.
 *
 * A mote hands its radio frames, which wait in a queue. The radio listens before it sends (csma.h), and a receiver makes of what arrives
 * (propagation.h) what signal, noise and interference allow:
 *
 *   a frame is received if it arrives at least as strong as the sensitivity, its receiver listened from its first bit to its last without
 *   sending, at no instant noise plus all interference exceeded signal / capture ratio, and the channel (channel.h) lets it pass.
 *
 * Each frame is judged so by itself: of two that overlap the stronger one is received if it is stronger by the capture ratio, whichever came
 * first. Transmissions that arrive more than 10 dB below the noise floor are not felt. A frame sent to one is acknowledged and repeated if the
 * acknowledgement does not come, also if it was the acknowledgement that was lost: the addressee's radio knows a frame by its number and hands it over once.
 * A radio that sleeps may open for a short window once in a period: what begins then it receives to its end, and acknowledges. The one radio that a
 * frame is sent to stays open after it for as long as a window, for the frame to be repeated or another to follow.
 * Profile `ideal` knows none of this: a frame goes out at once and all in range hear it; one that is sent to one needs no
 * acknowledgement, and a radio's frames follow each other without a gap.
 *
 * Receivers are found through a grid of cells and kept per sender, those who disturb through another grid: a frame costs time in
 * those about it, not in the network's size. Memory: about 120 bytes a
 * mote and 4 for each of its receivers once it has sent to all. */
#ifndef MOTEHOUND_SIM_RADIO_H
#define MOTEHOUND_SIM_RADIO_H

#include "engine/event_queue.h"
#include "engine/random.h"
#include "motehound/protocol.h"
#include "radio/air.h"
#include "radio/channel.h"
#include "radio/csma.h"
#include "radio/places.h"
#include "radio/profile.h"
#include "radio/propagation.h"
#include "scenario/scenario.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RADIO_ALL UINT32_MAX

struct radio_config {
    struct radio_profile profile;
    struct propagation_config propagation;
    struct channel_config channel;
    unsigned queue; /* frames a radio holds, the one being sent included; further ones are refused */
    sim_time wake_period,
        wake_length; /* one that sleeps is open in [k period, k period + length), k = 0, 1 ...; 0, 0: it is not */
};

/* What scenario->radio says; `range_m` stands in for its range. HUGE_VAL: all hear all, whatever the propagation. */
struct radio_config radio_config_of(const struct scenario *scenario, double range_m);

/* How far a frame is received in the mean, without shadowing: what motes are told of their radios. */
double radio_nominal_range_m(const struct scenario *scenario);

/* What a radio does; draws power accordingly. */
enum radio_state { RADIO_SLEEP, RADIO_LISTEN, RADIO_RECEIVE, RADIO_TRANSMIT, RADIO_OFF };

/* What a mote asks of its radio. Asleep it does not hear, but for what begins in a wake window; it wakes to send and goes back to sleep. What is off
 * drops all it had. */
enum radio_power { RADIO_POWER_ON, RADIO_POWER_ASLEEP, RADIO_POWER_OFF };

/* Who is told, in order of time. Any of the functions may be NULL. bytes and receivers are valid during the call. */
struct radio_sink {
    void *context;
    /* The first bit of a frame, at each of its transmissions. */
    void (*on_air)(void *context, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *bytes,
                   size_t length);
    /* The last bit has arrived at all these, at least one, each once, in the order of radio_order. */
    void (*heard)(void *context, sim_time time, const uint8_t *bytes, size_t length, const uint32_t *receivers,
                  uint32_t count);
    /* What became of a frame: once for each, a sender's in the order of sending, but for those of a radio that was switched off. */
    void (*sent)(void *context, sim_time time, uint32_t sender, enum mh_sent outcome);
    /* A radio changes its state, for a frame of that cause; 0 when it rests. Before the first call all listen. A radio receives while the
     * signal of any frame is above its sensitivity, whoever it is for. One that sleeps sleeps through its wake windows too, as long as no frame
     * begins in them: so windows are no changes. */
    void (*state)(void *context, sim_time time, uint32_t mote, enum radio_state state, uint8_t cause);
};

struct radio_counters {
    uint64_t frames_sent;      /* transmissions, repetitions included */
    uint64_t frames_repeated;  /* of those */
    uint64_t frames_received;  /* once per receiver */
    uint64_t frames_duplicate; /* received again, and not handed over */
    uint64_t acks_sent, acks_lost;
    uint64_t lost[LOSS_REASONS];
};

struct radio {
    struct radio_config config;
    struct propagation propagation;
    struct channel channel;
    struct radio_counters counters;
    struct random_stream backoff_stream;
    struct places places;
    struct air air;
    struct event_queue events;
    double sensitivity, noise, capture, cca_threshold, disturbance; /* powers as of propagation.h, and the ratio */
    sim_time turnaround;
    double reach_m; /* how far a frame may be received */
    struct radio_mote *motes;
    sim_time *open; /* since when a mote listens and neither sends nor turns round; SIM_TIME_NEVER: it does not */
    struct radio_receivers **receivers; /* of each mote, once it has sent to all */
    struct radio_frame *frames;         /* waiting or being sent */
    uint32_t frames_capacity, free_frame;
    uint32_t *found; /* room for all motes */
    uint64_t transmissions;
    sim_time now;
    bool out_of_memory;
};

/* Radios at places 0 ... count - 1, each finite; all on, from time 0. Returns 0, or -1 if there is no memory (nothing to
 * free). */
int radio_make(struct radio *radio, const struct radio_config *config, const double *x_m, const double *y_m,
               size_t count, uint64_t seed);

void radio_free(struct radio *radio);

/* At `time` the radio of `sender` gets a frame of at most MH_FRAME_MAX bytes for `destination` (an index, or RADIO_ALL). `cause` comes back with the
 * states. Returns 0, or -1 if there is no memory. */
int radio_send(struct radio *radio, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *bytes,
               size_t length, uint8_t cause);

/* At `time` the radio of `mote` is switched. Returns 0, or -1 if there is no memory. */
int radio_power(struct radio *radio, sim_time time, uint32_t mote, enum radio_power power);

/* An order of the radios in which those that hear each other lie side by side: radio i is at number radio_order()[i]. */
const uint32_t *radio_order(const struct radio *radio);

/* When something happens next; SIM_TIME_NEVER: nothing does. */
sim_time radio_next(const struct radio *radio);

/* Let everything happen that happens before `until`. What is sent or switched during the calls of `sink`, or later, for a
 * time that is already past, happens at once. Returns 0, or -1 if there is no memory. */
int radio_run(struct radio *radio, sim_time until, const struct radio_sink *sink);

#endif
