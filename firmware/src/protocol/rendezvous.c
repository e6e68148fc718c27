#include "motehound/rendezvous.h"

/* Begin of the window that `time` is in, or of the last one before it. */
static mh_tick window_of(const struct mh_rendezvous *rendezvous, mh_tick time)
{
    const mh_tick begin = mh_tick_aligned(0, rendezvous->period, time);
    return begin == time ? begin : begin - rendezvous->period;
}

static bool is_for_asking(const struct mh_rendezvous *rendezvous, mh_tick window)
{
    return rendezvous->period < rendezvous->interval && mh_tick_aligned(0, rendezvous->interval, window) == window;
}

bool mh_rendezvous_open(const struct mh_rendezvous *rendezvous, mh_tick time)
{
    if (rendezvous->period == 0) {
        return true;
    }
    const mh_tick window = window_of(rendezvous, time);
    return time - window <= rendezvous->length / 2 && !is_for_asking(rendezvous, window);
}

mh_tick mh_rendezvous_next(const struct mh_rendezvous *rendezvous, mh_tick time)
{
    if (mh_rendezvous_open(rendezvous, time)) {
        return time;
    }
    const mh_tick window = window_of(rendezvous, time) + rendezvous->period;
    return is_for_asking(rendezvous, window) ? window + rendezvous->period : window;
}

mh_tick mh_rendezvous_after(const struct mh_rendezvous *rendezvous, mh_tick time, uint8_t windows)
{
    if (rendezvous->period == 0) {
        return time + (windows + 1u) * (rendezvous->interval / 8 + 1);
    }
    mh_tick window = mh_rendezvous_next(rendezvous, window_of(rendezvous, time) + rendezvous->period);
    for (uint8_t i = 0; i < windows; i++) {
        window = mh_rendezvous_next(rendezvous, window + rendezvous->period);
    }
    return window;
}
