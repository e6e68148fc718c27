#include "motehound/trail.h"

#define OLDEST_TICKS ((int32_t)1 << 30) /* ages stay well inside what a tick difference can hold */

static void remove_knot(struct mh_trail *trail, int index)
{
    for (int i = index; i + 1 < trail->count; i++) {
        trail->knots[i] = trail->knots[i + 1];
    }
    trail->count--;
}

/* Join two neighbouring segments, those whose joint duration is the smallest share of their age at `now`. */
static void coarsen(struct mh_trail *trail, mh_tick now)
{
    int best = 1;
    mh_real best_share = 0.0f;
    for (int i = 1; i + 1 < trail->count; i++) {
        const mh_real share = mh_seconds_between(trail->knots[i - 1].time, trail->knots[i + 1].time) /
                              mh_seconds_between(trail->knots[i - 1].time, now);
        if (i == 1 || share < best_share) {
            best = i;
            best_share = share;
        }
    }
    const struct mh_trail_knot *middle = &trail->knots[best];
    struct mh_trail_knot *end = &trail->knots[best + 1];
    const mh_real before = mh_seconds_between(trail->knots[best - 1].time, middle->time);
    const mh_real after = mh_seconds_between(middle->time, end->time);
    end->rate = (before * middle->rate + after * end->rate) / (before + after);
    remove_knot(trail, best);
}

void mh_trail_append(struct mh_trail *trail, const struct mh_trail_knot *knot)
{
    if (trail->count == MH_TRAIL_KNOTS_MAX) {
        coarsen(trail, knot->time);
    }
    if (trail->count > 0 && mh_ticks_between(trail->knots[0].time, knot->time) > OLDEST_TICKS) {
        remove_knot(trail, 0);
    }
    trail->knots[trail->count++] = *knot;
}

mh_real mh_trail_segment_increment(const struct mh_trail_knot *a, const struct mh_trail_knot *b, struct mh_vec2 node,
                                   mh_tick time, mh_tick interval, mh_real diffusion_m2ps)
{
    struct mh_segment segment = {a->place, b->place, mh_seconds_between(a->time, time),
                                 mh_seconds_between(b->time, time)};
    mh_real increment = mh_segment_old_field(&segment, node, diffusion_m2ps);
    segment.age_a = mh_seconds_between(a->time, time - interval);
    segment.age_b = mh_seconds_between(b->time, time - interval);
    increment -= mh_segment_old_field(&segment, node, diffusion_m2ps);
    return b->rate * increment;
}

mh_real mh_trail_increment(const struct mh_trail *trail, struct mh_vec2 node, mh_tick time, mh_tick interval,
                           mh_real diffusion_m2ps)
{
    mh_real sum = 0.0f;
    for (int i = 1; i < trail->count; i++) {
        sum += mh_trail_segment_increment(&trail->knots[i - 1], &trail->knots[i], node, time, interval, diffusion_m2ps);
    }
    return sum;
}
