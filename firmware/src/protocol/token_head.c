#include "token_node.h"

#include "motehound/bytes.h"
#include "motehound/geographic.h"

#include <string.h>

#define AGAIN_PAUSE 20 /* ticks between two nodes that are asked again: the radio tries each a few times */

static struct mh_token_of own_token(const struct mh_token_node *t, int32_t generation, uint8_t state)
{
    const struct mh_token_of of = {.holder = t->node->id, .generation = generation, .heard = t->time, .state = state};
    return of;
}

/* ---- to lead and to follow ---- */

bool mh_token_lead(struct mh_token_node *t, int32_t generation, const uint8_t *track, size_t length)
{
    const struct mh_token_of of = own_token(t, generation, MH_SEARCH_GOES_ON);
    if (t->role == MH_TOKEN_HEAD) {
        mh_token_follow(t, &of);
    }
    if (t->node->port->lead(t->node->context, t->now, track, length) != MH_OK) {
        return false;
    }
    t->role = MH_TOKEN_HEAD;
    t->of = of;
    t->knows = true;
    t->asked = t->answers = t->guarding = false;
    t->guard = MH_BROADCAST;
    mh_token_clear(t, MH_TOKEN_ANSWER);
    mh_token_clear(t, MH_TOKEN_GUARD);
    mh_token_clear(t, MH_TOKEN_REPORT);
    mh_token_set(t, MH_TOKEN_INSTANT, mh_tick_aligned(0, t->config->interval, t->time + 1));
    return true;
}

void mh_token_follow(struct mh_token_node *t, const struct mh_token_of *of)
{
    t->node->port->follow(t->node->context);
    t->role = MH_TOKEN_NODE;
    t->handing = false;
    mh_token_clear(t, MH_TOKEN_INSTANT);
    mh_token_clear(t, MH_TOKEN_AGAIN);
    mh_token_clear(t, MH_TOKEN_KEEP);
    if (t->guard != MH_BROADCAST && t->guard != of->holder) {
        mh_token_tell(t, t->guard, &t->node->place, of);
    }
    t->guard = MH_BROADCAST;
}

/* Not if there is a search already. */
void mh_token_begin(struct mh_token_node *t)
{
    if (t->role != MH_TOKEN_NODE || !t->node->is_head || mh_token_believes(t)) {
        return;
    }
    if (mh_token_lead(t, 1, NULL, 0)) {
        t->heads = t->calm = 0;
        mh_token_note(&t->events.begun);
    }
}

/* ---- who may be head ---- */

void mh_token_shun(struct mh_token_node *t, mh_node_id id)
{
    mh_shun(&t->shunned, id, t->time + MH_TOKEN_SHUNNED * t->config->interval);
    mh_vicinity_forget(&t->vicinity, id);
}

/* ---- an instant ---- */

static void ask(struct mh_token_node *t, mh_node_id whom)
{
    struct mh_estimate expected;
    struct mh_place about = t->node->place;
    if (t->node->port->expect(t->node->context, t->instant, &expected) == MH_OK && mh_finite(expected.position.x) &&
        mh_finite(expected.position.y)) {
        about = mh_place_from_offset(&expected.origin, expected.position);
    }
    const struct mh_message message = {.kind = MH_MESSAGE_ASK,
                                       .as.ask = {.sender = (int32_t)t->node->id,
                                                  .track = (int32_t)t->config->sink,
                                                  .generation = t->of.generation,
                                                  .time_ms = (int32_t)t->instant,
                                                  .x_mm = about.x_mm,
                                                  .y_mm = about.y_mm,
                                                  .everyone = 1}};
    mh_link_direct(&t->link, whom, &message);
}

void mh_token_ask(struct mh_token_node *t)
{
    t->instant = t->due[MH_TOKEN_INSTANT];
    t->of.heard = t->instant;
    t->again = 0;
    memset(t->answered, 0, sizeof t->answered);
    ask(t, MH_BROADCAST);
    mh_token_set(t, MH_TOKEN_AGAIN, t->instant + t->config->window / 9 * 5);
    mh_token_set(t, MH_TOKEN_INSTANT, t->instant + t->config->interval);
    t->node->port->sense(t->node->context, t->now, t->instant);
}

static bool has_answered(const struct mh_token_node *t, uint8_t neighbour)
{
    return (t->answered[neighbour / 8] & 1u << neighbour % 8) != 0;
}

/* One of those that have not answered; the others soon. */
void mh_token_ask_again(struct mh_token_node *t)
{
    for (; t->again < t->neighbours.count; t->again++) {
        const struct mh_neighbour *n = &t->neighbours.list[t->again];
        if (n->id != t->config->sink && mh_neighbour_usable(n) && !has_answered(t, t->again)) {
            ask(t, n->id);
            t->again++;
            mh_token_set(t, MH_TOKEN_AGAIN, t->time + AGAIN_PAUSE);
            return;
        }
    }
}

void mh_token_hear_answer(struct mh_token_node *t, const mh_answer_t *answer)
{
    struct mh_measurement measurement;
    if (t->role != MH_TOKEN_HEAD) {
        return;
    }
    mh_answer_to_measurement(answer, &measurement);
    t->node->port->deliver(t->node->context, t->now, &measurement);
    for (uint8_t i = 0; i < t->neighbours.count; i++) {
        if (t->neighbours.list[i].id == measurement.node) {
            t->answered[i / 8] = (uint8_t)(t->answered[i / 8] | 1u << i % 8);
        }
    }
}

/* ---- what is found ---- */

/* Covariance of position and rate, as far as the tracker states it; none if it is beyond all numbers. */
static void put_spread(const struct mh_estimate *estimate, uint8_t *bytes)
{
    const mh_real spread[6] = {estimate->covariance.xx,      estimate->covariance.xy,
                               estimate->covariance.yy,      estimate->covariance_more[0],
                               estimate->covariance_more[1], estimate->covariance_more[2]};
    const uint8_t stated = estimate->states == 3 ? 6 : estimate->states >= 2 ? 3 : 0;
    bool finite = true;
    for (uint8_t i = 0; i < stated; i++) {
        finite = finite && mh_finite(spread[i]);
    }
    for (uint8_t i = 0; i < 6; i++) {
        mh_put_real(&bytes, finite && i < stated ? spread[i] : 0);
    }
}

static void post_leak(struct mh_token_node *t)
{
    struct mh_message message = {.kind = MH_MESSAGE_LEAK, .as.leak = t->leak};
    (void)mh_token_post(t, &message, t->config->sink, &t->config->sink_place); /* counts what it refuses */
}

static void report(struct mh_token_node *t, const struct mh_estimate *estimate, uint8_t state)
{
    const struct mh_place place = mh_place_from_offset(&estimate->origin, estimate->position);
    const mh_leak_t leak = {.track = (int32_t)t->config->sink,
                            .generation = t->of.generation,
                            .time_ms = (int32_t)t->instant,
                            .head_x_mm = t->node->place.x_mm,
                            .head_y_mm = t->node->place.y_mm,
                            .x_mm = place.x_mm,
                            .y_mm = place.y_mm,
                            .heads = t->heads,
                            .state = state};
    uint8_t *rate = t->leak.rate;
    t->leak = leak;
    mh_put_real(&rate, estimate->rate);
    put_spread(estimate, t->leak.spread);
    post_leak(t);
}

/* The end of a search is reported more than once. */
void mh_token_report(struct mh_token_node *t)
{
    post_leak(t);
    t->reports--;
    if (t->reports > 0) {
        mh_token_set(t, MH_TOKEN_REPORT, t->time + t->config->interval);
    }
}

static void finish(struct mh_token_node *t, uint8_t state, bool found)
{
    const struct mh_token_of of = own_token(t, t->of.generation, state);
    mh_token_note(state == MH_SEARCH_CONVERGED ? &t->events.converged : &t->events.exhausted);
    mh_token_follow(t, &of);
    t->of = of;
    t->reports = MH_TOKEN_REPORTS - 1;
    if (found) {
        mh_token_set(t, MH_TOKEN_REPORT, t->time + t->config->interval);
    }
}

static bool is_usable(const struct mh_estimate *estimate)
{
    return estimate && mh_finite(estimate->position.x) && mh_finite(estimate->position.y) && mh_finite(estimate->rate);
}

void mh_token_closed(struct mh_token_node *t, mh_tick instant, const struct mh_estimate *estimate)
{
    mh_token_clear(t, MH_TOKEN_AGAIN);
    t->instant = instant;
    t->heads++;
    mh_token_note(&t->events.heads);
    const bool found = is_usable(estimate);
    t->calm = (uint8_t)(found && (estimate->flags & MH_ESTIMATE_CALM) ? t->calm + 1 : 0);
    const enum mh_search state = t->calm >= t->config->calm         ? MH_SEARCH_CONVERGED
                                 : t->heads >= t->config->heads_max ? MH_SEARCH_EXHAUSTED
                                                                    : MH_SEARCH_GOES_ON;
    /* the token first, which is in more of a hurry */
    if (state == MH_SEARCH_GOES_ON && found) {
        mh_token_offer(t);
    }
    if (found) {
        report(t, estimate, (uint8_t)state);
    }
    if (state != MH_SEARCH_GOES_ON) {
        finish(t, (uint8_t)state, found);
    }
}
