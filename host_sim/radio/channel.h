/* What becomes of a frame between two radios beside physics: losses at random, alone or in bursts, and whatever breaks in a network.
 *
 * Bursts are the two-state process of Gilbert and Elliott in continuous time: each receiver alternates between a good and a bad state, both of
 * exponential duration, and loses a frame with the state's probability. All that it hears shares its state, as with a disturbance near by. */
#ifndef MOTEHOUND_SIM_CHANNEL_H
#define MOTEHOUND_SIM_CHANNEL_H

#include "engine/event_queue.h"
#include "engine/random.h"
#include "radio/loss.h"
#include "radio/places.h"
#include "world/faults.h"

#include <stdbool.h>

struct channel_config {
    double loss;          /* probability that a receiver loses a frame, each independently */
    double burst_loss;    /* the same in a burst */
    double good_s, bad_s; /* mean duration of a time without a burst, > 0, and of a burst; bad_s 0: no bursts */
    struct faults faults; /* partition, jam and mute */
};

/* Where a receiver's process is. */
struct channel_burst {
    sim_time until;  /* of this state */
    uint32_t states; /* passed */
    bool bad;
};

struct channel {
    struct channel_config config;
    struct random_stream loss_stream, burst_stream;
    uint64_t places;              /* their number, to number the draws; the last is the head's */
    struct channel_burst *bursts; /* of each receiver; NULL without bursts */
    bool quiet;
};

/* One frame on its way to one receiver. */
struct passage {
    uint64_t number; /* of the transmission, from 0, acknowledgements included */
    sim_time start, end;
    const struct place *sender, *receiver;
};

/* Returns 0, or -1 if there is no memory (nothing to free). */
int channel_make(struct channel *channel, const struct channel_config *config, size_t places, uint64_t seed);

void channel_free(struct channel *channel);

/* It does nothing to any frame: the verdict on all is LOSS_NONE. */
static inline bool channel_is_quiet(const struct channel *channel) { return channel->quiet; }

/* What the channel does to it: LOSS_NONE, or why it is lost. A receiver's frames in the order of their ends. */
enum loss_reason channel_verdict(struct channel *channel, const struct passage *passage);

#endif
