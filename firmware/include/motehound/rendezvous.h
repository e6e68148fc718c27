/* When a neighbour that sleeps can be reached: wake windows.
 *
 * A radio that may sleep opens by itself for a short time once in a period, all radios of the network at the same times: the whole multiples of the
 * period in the network's time, as mh_tick_aligned(0, period, time) counts them: since ticks wrap, one window every 49.7 days comes after another time
 * than a period, unless that is a power of 2, and a radio that opens by itself has to be told. A frame that begins in a window is received. Who has something for a neighbour that may be asleep sends it
 * in the first half of a window, so that it begins within it though the channel is busy for a while.
 *
 * Windows at which a sampling instant falls are left to those who ask for samples, unless all are of that kind. All times are the network's. */
#ifndef MOTEHOUND_RENDEZVOUS_H
#define MOTEHOUND_RENDEZVOUS_H

#include "motehound/ticks.h"

struct mh_rendezvous {
    mh_tick period;   /* between the beginnings of windows; 0: everybody listens all the time */
    mh_tick length;   /* of a window, below the period; at least 4 ticks */
    mh_tick interval; /* between sampling instants */
};

/* A frame handed to the radio at `time` begins within a window. */
bool mh_rendezvous_open(const struct mh_rendezvous *rendezvous, mh_tick time);

/* The first time at or after `time` for which that is so. */
mh_tick mh_rendezvous_next(const struct mh_rendezvous *rendezvous, mh_tick time);

/* The beginning of the window after `windows` others that follow `time`. Where there are none, an eighth of the interval stands for their period. */
mh_tick mh_rendezvous_after(const struct mh_rendezvous *rendezvous, mh_tick time, uint8_t windows);

#endif
