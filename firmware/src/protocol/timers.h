/* A set of at most 16 timers, which are numbered from 0: bit k of `set` says that timer k is set, due[k] for when. Both are the owner's, and so is what the
 * times mean. */
#ifndef MOTEHOUND_TIMERS_H
#define MOTEHOUND_TIMERS_H

#include "motehound/ticks.h"

static inline void mh_timers_clear(uint16_t *set, unsigned timer) { *set = (uint16_t)(*set & ~(1u << timer)); }

static inline bool mh_timers_is_set(uint16_t set, unsigned timer) { return ((unsigned)set >> timer & 1u) != 0; }

static inline void mh_timers_set(uint16_t *set, mh_tick *due, unsigned timer, mh_tick time)
{
    due[timer] = time;
    *set = (uint16_t)(*set | 1u << timer);
}

/* Is the timer set for `time` or before? Then it is no more. */
static inline bool mh_timers_take(uint16_t *set, const mh_tick *due, unsigned timer, mh_tick time)
{
    const bool rings = mh_timers_is_set(*set, timer) && !mh_tick_before(time, due[timer]);
    if (rings) {
        mh_timers_clear(set, timer);
    }
    return rings;
}

/* When the first of `count` timers is due -> *time. Returns false if none is set. */
static inline bool mh_timers_earliest(uint16_t set, const mh_tick *due, unsigned count, mh_tick *time)
{
    bool any = false;
    for (unsigned timer = 0; timer < count; timer++) {
        if (mh_timers_is_set(set, timer) && (!any || mh_tick_before(due[timer], *time))) {
            *time = due[timer];
            any = true;
        }
    }
    return any;
}

#endif
