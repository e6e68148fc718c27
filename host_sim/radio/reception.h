/* What radios make of what arrives: who is in reach, whether the channel is busy, whether a frame is received. */
#ifndef MOTEHOUND_SIM_RECEPTION_H
#define MOTEHOUND_SIM_RECEPTION_H

#include "radio/radio_mote.h"

enum { MEETINGS_MAX = 256 /* transmissions that one can meet; more than can fit beside each other in a cell */ };

/* Transmissions that one has met. */
struct meetings {
    size_t count;
    struct flight flight[MEETINGS_MAX];
};

/* Who receives `sender` when nothing disturbs, in the order of radio_order. Valid until the next call. */
const uint32_t *reception_receivers(struct radio *radio, uint32_t sender, uint32_t *count);

/* Whether `receiver` does. */
bool reception_in_reach(const struct radio *radio, uint32_t sender, uint32_t receiver);

/* Average power at a mote in [from, now), or HUGE_VAL if it has itself been sending. */
double reception_power(struct radio *radio, uint32_t mote, sim_time from, sim_time now);

/* What `flight`, the air's number `itself`, has met until now, at its end. */
void reception_meetings(struct radio *radio, const struct flight *flight, uint32_t itself, sim_time now,
                        struct meetings *meetings);

/* What a receiver in reach makes of a transmission that ends now: LOSS_NONE if it has it. meetings NULL: nothing disturbs. */
enum loss_reason reception_judge(struct radio *radio, const struct flight *flight, uint32_t receiver,
                                 const struct meetings *meetings, sim_time now);

#endif
