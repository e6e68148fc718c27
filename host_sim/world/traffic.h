/* Synthetic traffic: what nodes report where there is nothing to sense. Each source takes a sample once in an interval, at its own phase. */
#ifndef MOTEHOUND_SIM_TRAFFIC_H
#define MOTEHOUND_SIM_TRAFFIC_H

#include "engine/event_queue.h"

struct traffic_source {
    sim_time phase;
    uint32_t mote;
};

struct traffic {
    struct traffic_source *sources; /* by phase */
    size_t count;
    sim_time interval; /* microseconds, at least 1 */
    uint64_t taken;
};

/* `count` sources (at most `motes`) spread evenly over motes 0 ... motes - 1, their phases uniform in the interval and fixed by `seed`.
 * Returns 0, or -1 if there is no memory (nothing to free). */
int traffic_make(struct traffic *traffic, size_t count, size_t motes, sim_time interval, uint64_t seed);

void traffic_free(struct traffic *traffic);

/* When the next sample is taken; SIM_TIME_NEVER without sources. */
sim_time traffic_next(const struct traffic *traffic);

/* The mote that takes it; on to the one after. There is a source. */
uint32_t traffic_take(struct traffic *traffic);

#endif
