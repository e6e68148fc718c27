#include "token_node.h"

#include "motehound/bytes.h"
#include "motehound/gaussian.h"
#include "motehound/geographic.h"

#include <string.h>

#define OLD 12 /* instants after which a report is none of about now */

static void watch(struct mh_token_node *t)
{
    if (t->config->patience > 0) {
        mh_token_set(t, MH_TOKEN_WATCH, t->time + t->config->patience * t->config->interval);
    }
}

/* The covariance of a report -> estimate; all zeros for none. Returns false if it is no covariance. */
static bool read_spread(const mh_leak_t *leak, struct mh_estimate *estimate)
{
    const uint8_t *bytes = leak->spread;
    struct mh_gaussian gaussian = {.n = 3};
    bool any = false;
    for (int i = 0; i < MH_PACKED_SIZE(3); i++) {
        gaussian.P[i] = mh_get_real(&bytes);
        any = any || gaussian.P[i] != 0;
    }
    gaussian.n = gaussian.P[MH_PACKED(2, 2)] != 0 ? 3 : 2;
    if (any && mh_gaussian_check(&gaussian) != MH_OK) {
        return false;
    }
    estimate->states = any ? gaussian.n : 0;
    estimate->covariance.xx = gaussian.P[MH_PACKED(0, 0)];
    estimate->covariance.xy = gaussian.P[MH_PACKED(0, 1)];
    estimate->covariance.yy = gaussian.P[MH_PACKED(1, 1)];
    memcpy(estimate->covariance_more, &gaussian.P[MH_PACKED_SIZE(2)], 3 * sizeof gaussian.P[0]);
    return true;
}

void mh_token_hear_leak(struct mh_token_node *t, mh_node_id head, const mh_leak_t *leak)
{
    const uint8_t *rate = leak->rate;
    const mh_tick time = (mh_tick)leak->time_ms;
    const struct mh_place place = {leak->head_x_mm, leak->head_y_mm, 0};
    const struct mh_token_of of = {
        .holder = head, .generation = leak->generation, .heard = t->time, .state = leak->state};
    struct mh_estimate estimate = {.origin = {leak->x_mm, leak->y_mm, 0}, .time = time, .rate = mh_get_real(&rate)};
    if (t->role != MH_TOKEN_SINK || (mh_node_id)leak->track != t->config->sink || !mh_token_is_fresh(t, time, OLD) ||
        !read_spread(leak, &estimate)) {
        mh_token_note(&t->events.corrupt);
        return;
    }
    const bool later = t->found && mh_tick_before((mh_tick)t->leak.time_ms, time);
    const bool repeated = t->knows && t->found && t->of.holder == head && t->of.state == leak->state && !later;
    if (!mh_token_hear_of(t, &of)) {
        if (later) {
            mh_token_tell(t, head, &place, &t->of);
        }
        return;
    }
    watch(t);
    if (of.state != MH_SEARCH_GOES_ON) {
        mh_token_clear(t, MH_TOKEN_WATCH);
    }
    t->found = true;
    t->leak = *leak;
    t->head_place = place;
    if (!repeated) {
        estimate.flags = leak->state == MH_SEARCH_CONVERGED ? MH_ESTIMATE_CALM : 0;
        t->node->port->tell(t->node->context, &estimate);
    }
}

/* Of the neighbours the nearest to a place -> *least_mm. NULL if there is none. */
static const struct mh_neighbour *nearest(const struct mh_token_node *t, const struct mh_place *place,
                                          uint32_t *least_mm)
{
    const struct mh_neighbour *found = NULL;
    for (uint8_t i = 0; i < t->neighbours.count; i++) {
        const struct mh_neighbour *n = &t->neighbours.list[i];
        const struct mh_place at = {n->x_mm, n->y_mm, 0};
        const uint32_t mm = mh_place_distance_mm(&at, place);
        if (mh_neighbour_usable(n) && (!found || mm < *least_mm)) {
            found = n;
            *least_mm = mm;
        }
    }
    return found;
}

/* Whoever stands nearest to where the last head was is to begin. If that is the sink itself, its nearest neighbour. */
static void send_for_a_head(struct mh_token_node *t)
{
    const struct mh_token_of nobody = {.holder = MH_BROADCAST};
    uint32_t least_mm = 0;
    const struct mh_neighbour *n = nearest(t, &t->head_place, &least_mm);
    if (n && least_mm >= mh_place_distance_mm(&t->node->place, &t->head_place)) {
        const struct mh_place at = {n->x_mm, n->y_mm, 0};
        mh_token_tell(t, n->id, &at, &nobody);
    } else {
        mh_token_tell(t, MH_BROADCAST, &t->head_place, &nobody);
    }
}

void mh_token_watch(struct mh_token_node *t)
{
    const uint8_t most = (uint8_t)(MH_TOKEN_RESTARTS + (t->config->start == MH_BROADCAST));
    if (t->sent_for < most) {
        t->sent_for++;
        mh_token_note(&t->events.sent_for);
        t->knows = false;
        send_for_a_head(t);
        watch(t);
    }
}
