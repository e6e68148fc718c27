/* Time on a mote: unsigned ticks of 1 ms that wrap after 49.7 days. Only differences below 24.8 days have a meaning. */
#ifndef MOTEHOUND_TICKS_H
#define MOTEHOUND_TICKS_H

#include "motehound/real.h"

#include <stdbool.h>
#include <stdint.h>

typedef uint32_t mh_tick;

#define MH_TICKS_PER_S 1000u

/* later - earlier in ticks, negative when `later` is in fact earlier; right across the wrap. */
static inline int32_t mh_ticks_between(mh_tick earlier, mh_tick later) { return (int32_t)(later - earlier); }

/* The same in seconds. */
static inline mh_real mh_seconds_between(mh_tick earlier, mh_tick later)
{
    return mh_real_from_ratio(mh_ticks_between(earlier, later), (int32_t)MH_TICKS_PER_S);
}

/* True if a is strictly before b. */
static inline bool mh_tick_before(mh_tick a, mh_tick b) { return mh_ticks_between(a, b) > 0; }

/* A time without its last eight bits, in 16: only differences below 2.3 hours have a meaning. */
typedef uint16_t mh_coarse;

static inline mh_coarse mh_coarse_of(mh_tick time) { return (mh_coarse)(time >> 8); }

/* True if more than `lifetime` has passed since. */
static inline bool mh_coarse_over(mh_tick now, mh_coarse since, mh_coarse lifetime)
{
    return (int16_t)(uint16_t)(mh_coarse_of(now) - since) > (int16_t)lifetime;
}

/* The first tick at or after `time` that is a whole number of periods from `epoch`, which may lie before or after it. */
static inline mh_tick mh_tick_aligned(mh_tick epoch, mh_tick period, mh_tick time)
{
    const uint32_t since = time - epoch, until = epoch - time;
    return mh_tick_before(epoch, time) ? epoch + (since + period - 1) / period * period
                                       : epoch - until / period * period;
}

#endif
