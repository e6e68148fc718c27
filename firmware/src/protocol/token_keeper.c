/* The token on its way: who has it chooses the next head and hands it over in parts; who has handed it over keeps it, until it has gone on from there. */
#include "token_node.h"

#include "motehound/geographic.h"

#define OVERHEAD 2 /* bytes carried before the track: heads so far, calm ones in succession */
#if MH_REAL_FIXED
#define METRE 1000 /* mm: distances in m, so that they fit */
#else
#define METRE 1
#endif
#define LATE 2 /* instants: a part that is older is none of this token */

/* ---- whom to ---- */

/* Where the tracker does not mind: the nearer to the estimate the better. */
static mh_real score(const struct mh_token_node *t, const struct mh_neighbour *n, const struct mh_place *estimated)
{
    struct mh_place places[MH_VICINITY_MAX] = {{n->x_mm, n->y_mm, 0}};
    mh_real found;
    size_t count = mh_vicinity_around(&t->vicinity, n->id, t->config->range_mm, places);
    count = count > 0 ? count : 1;
    return t->node->port->score(t->node->context, n->id, places, count, &found) == MH_OK && mh_finite(found)
               ? found
               : -mh_real_from_ratio((int32_t)mh_place_distance_mm(&places[0], estimated), METRE);
}

static const struct mh_neighbour *best(const struct mh_token_node *t)
{
    const struct mh_neighbour *chosen = NULL;
    struct mh_estimate expected;
    struct mh_place estimated = t->node->place;
    mh_real highest = 0;
    if (t->node->port->expect(t->node->context, t->instant, &expected) == MH_OK) {
        estimated = mh_place_from_offset(&expected.origin, expected.position);
    }
    for (uint8_t i = 0; i < t->neighbours.count; i++) {
        const struct mh_neighbour *n = &t->neighbours.list[i];
        if (n->id == t->config->sink || !mh_neighbour_usable(n) || mh_is_shunned(&t->shunned, n->id, t->time)) {
            continue;
        }
        const mh_real value = score(t, n, &estimated);
        if (!chosen || value > highest || (value == highest && n->id < chosen->id)) {
            chosen = n;
            highest = value;
        }
    }
    return chosen;
}

/* ---- handed over ---- */

bool mh_token_is_offered(const struct mh_token_node *t, const struct mh_message *message)
{
    return t->handing && message->as.hand_over.generation == t->next.generation &&
           message->header.route.destination == (int32_t)t->next.holder;
}

static bool post_part(struct mh_token_node *t)
{
    struct mh_message message = {.kind = MH_MESSAGE_HAND_OVER,
                                 .as.hand_over = {.track = (int32_t)t->config->sink,
                                                  .generation = t->next.generation,
                                                  .time_ms = (int32_t)t->instant}};
    mh_parcel_cut(t->carried, t->carried_length, t->part, &message.as.hand_over);
    return mh_token_post(t, &message, t->next.holder, &t->node->place);
}

/* This node leads at the next instant too, with a generation above all that it has offered. */
static void stay(struct mh_token_node *t)
{
    t->handing = false;
    mh_token_clear(t, MH_TOKEN_KEEP);
    t->of.generation = (int32_t)((uint32_t)t->next.generation + 1);
}

static void offer_to_the_best(struct mh_token_node *t)
{
    const struct mh_neighbour *next = best(t);
    t->next.holder = next ? next->id : MH_BROADCAST;
    t->next.generation = (int32_t)((uint32_t)t->next.generation + 1);
    t->next.heard = t->time;
    t->part = 0;
    if (!next || !post_part(t)) {
        stay(t);
    }
}

void mh_token_offer(struct mh_token_node *t)
{
    size_t length;
    if (t->node->port->save(t->node->context, t->carried + OVERHEAD, &length) != MH_OK) {
        return;
    }
    t->carried[0] = t->heads;
    t->carried[1] = t->calm;
    t->carried_length = (uint16_t)(OVERHEAD + length);
    t->handing = true;
    t->next = t->of;
    mh_token_set(t, MH_TOKEN_KEEP, t->instant + t->config->interval / 8 * 7);
    offer_to_the_best(t);
}

void mh_token_part_taken(struct mh_token_node *t)
{
    t->part++;
    if (t->part < MH_PARCEL_PARTS(t->carried_length)) {
        if (!post_part(t)) {
            stay(t);
        }
        return;
    }
    mh_token_note(&t->events.handed);
    mh_token_follow(t, &t->next);
    t->of = t->next;
    t->guarding = true;
    mh_token_set(t, MH_TOKEN_GUARD, mh_tick_aligned(0, t->config->interval, t->time + 1) + t->config->window);
}

void mh_token_part_refused(struct mh_token_node *t)
{
    mh_token_note(&t->events.refused);
    mh_token_shun(t, t->next.holder);
    offer_to_the_best(t);
}

void mh_token_keep(struct mh_token_node *t)
{
    if (t->handing) {
        stay(t);
    }
}

/* ---- kept ---- */

/* As long as the next head has the token, it asks at every instant. It has passed it on, or found an end, if there is one above it. */
void mh_token_guard(struct mh_token_node *t, const struct mh_token_of *other)
{
    if (!t->guarding) {
        return;
    }
    if (other->holder == t->next.holder && other->state == MH_SEARCH_GOES_ON) {
        t->next = *other;
        mh_token_set(t, MH_TOKEN_GUARD, other->heard + t->config->interval + t->config->window);
    } else if (!mh_token_outranks(&t->next, other)) {
        t->guarding = false;
        mh_token_clear(t, MH_TOKEN_GUARD);
    }
}

void mh_token_resume(struct mh_token_node *t)
{
    const int32_t generation = (int32_t)((uint32_t)t->next.generation + 1);
    mh_token_note(&t->events.resumed);
    mh_token_shun(t, t->next.holder);
    if (mh_token_lead(t, generation, t->carried + OVERHEAD, (size_t)(t->carried_length - OVERHEAD))) {
        t->heads = t->carried[0];
        t->calm = t->carried[1];
    }
}

/* ---- taken ---- */

static void take_token(struct mh_token_node *t)
{
    const uint8_t *bytes = t->incoming;
    const size_t length = t->parcel.length;
    if (length <= OVERHEAD || bytes[0] >= t->config->heads_max || bytes[1] >= t->config->calm ||
        !mh_token_lead(t, t->parcel.generation, bytes + OVERHEAD, length - OVERHEAD)) {
        mh_token_note(&t->events.corrupt);
        return;
    }
    t->heads = bytes[0];
    t->calm = bytes[1];
    t->guard = t->parcel.from;
}

void mh_token_hear_part(struct mh_token_node *t, mh_node_id from, const mh_hand_over_t *part)
{
    const struct mh_token_of offered = {.holder = t->node->id, .generation = part->generation, .heard = t->time};
    if (!t->node->is_head || t->role == MH_TOKEN_SINK || (mh_node_id)part->track != t->config->sink ||
        !mh_token_is_fresh(t, (mh_tick)part->time_ms, LATE)) {
        mh_token_note(&t->events.corrupt);
        return;
    }
    if (mh_token_believes(t) && !mh_token_outranks(&offered, &t->of)) {
        return;
    }
    switch (mh_parcel_join(&t->parcel, t->incoming, sizeof t->incoming, from, part)) {
    case MH_OK:
        take_token(t);
        break;
    case MH_ERR_CORRUPT:
    case MH_ERR_CAPACITY:
        mh_token_note(&t->events.corrupt);
        break;
    default:
        break;
    }
}
