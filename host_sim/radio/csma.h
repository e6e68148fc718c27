/* Medium access of one radio with one frame: unslotted CSMA/CA as IEEE Std 802.15.4-2006, 7.5.1.4, has it, and B-MAC's carrier
 * sense as another set of numbers. Two counters and a rule; who is on the air the radio knows. */
#ifndef MOTEHOUND_SIM_CSMA_H
#define MOTEHOUND_SIM_CSMA_H

#include "engine/event_queue.h"
#include "engine/random.h"
#include "radio/profile.h"

#include <stdbool.h>
#include <stdint.h>

struct csma {
    uint32_t busy;  /* times that the channel was found busy, of this transmission */
    uint32_t tries; /* transmissions of this frame so far that were not acknowledged */
    uint32_t draws; /* random numbers used up so far, of this radio */
};

/* A new frame. */
static inline void csma_begin(struct csma *csma) { csma->busy = csma->tries = 0; }

/* From now to the end of the channel's assessment. Takes the next draw of radio `mote`. */
sim_time csma_wait(struct csma *csma, const struct radio_profile *profile, struct random_stream stream, uint32_t mote);

/* The channel was busy. True: try again; false: give the frame up. */
bool csma_was_busy(struct csma *csma, const struct radio_profile *profile);

/* No acknowledgement came. True: try again, from the first backoff; false: give the frame up. */
bool csma_not_acknowledged(struct csma *csma, const struct radio_profile *profile);

#endif
