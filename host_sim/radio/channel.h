/* What becomes of a frame between two radios beside physics: losses at random, and whatever breaks in a network. */
#ifndef MOTEHOUND_SIM_CHANNEL_H
#define MOTEHOUND_SIM_CHANNEL_H

#include "engine/event_queue.h"
#include "engine/random.h"
#include "radio/loss.h"
#include "radio/places.h"

#include <stdbool.h>

struct channel {
    double loss; /* probability that a receiver loses a frame, each independently */
    struct random_stream stream;
    uint64_t places; /* their number, to number the draws */
};

/* One frame on its way to one receiver. */
struct passage {
    uint64_t number; /* of the transmission, from 0, acknowledgements included */
    sim_time start, end;
    const struct place *sender, *receiver;
};

/* It does nothing to any frame: the verdict on all is LOSS_NONE. */
static inline bool channel_is_quiet(const struct channel *channel) { return !(channel->loss > 0); }

/* What the channel does to it: LOSS_NONE, or why it is lost. */
enum loss_reason channel_verdict(struct channel *channel, const struct passage *passage);

#endif
