#include "token_node.h"

#include "motehound/spread.h"

#define ANSWER_TIME 12 /* ticks that an answer takes, acknowledged */

/* The sample is that of the instant asked for. */
static bool is_asked(const struct mh_token_node *t)
{
    const int32_t off = mh_ticks_between(t->asked_for, t->measured.time), limit = (int32_t)(t->config->interval / 4);
    return t->asked && t->sampled && off >= -limit && off <= limit;
}

/* In the part of the window that is left before the head asks again, or before it ends. */
static void answer_soon(struct mh_token_node *t)
{
    const mh_tick ninth = t->config->window / 9;
    const mh_tick first = t->asked_for + 4 * ninth, last = t->asked_for + 8 * ninth;
    const int32_t left = mh_ticks_between(t->time, mh_tick_before(t->time, first) ? first : last) - ANSWER_TIME;
    t->answers = true;
    mh_token_set(t, MH_TOKEN_ANSWER, t->time + mh_spread(t->node->id, t->asked_for, left > 1 ? (uint32_t)left : 1));
}

void mh_token_hear_ask(struct mh_token_node *t, const mh_ask_t *ask)
{
    const struct mh_token_of of = {
        .holder = (mh_node_id)ask->sender, .generation = ask->generation, .heard = (mh_tick)ask->time_ms};
    if ((mh_node_id)ask->track != t->config->sink || !mh_token_is_fresh(t, of.heard, 1)) {
        mh_token_note(&t->events.corrupt);
        return;
    }
    if (!mh_token_hear_of(t, &of)) {
        mh_token_tell(t, of.holder, &t->node->place, &t->of);
        return;
    }
    const bool again = t->asked && t->asked_for == of.heard && t->asked_by == of.holder;
    if (t->role == MH_TOKEN_SINK || (again && t->answers)) {
        return;
    }
    t->asked = true;
    t->answers = false;
    t->asked_for = of.heard;
    t->asked_by = of.holder;
    t->node->port->sense(t->node->context, t->now, of.heard);
    if (!t->answers && is_asked(t)) {
        answer_soon(t);
    }
}

void mh_token_sampled(struct mh_token_node *t, const struct mh_measurement *measurement)
{
    t->measured = *measurement;
    t->sampled = true;
    if (!t->answers && is_asked(t)) {
        answer_soon(t);
    }
}

void mh_token_answer(struct mh_token_node *t)
{
    struct mh_message message = {.kind = MH_MESSAGE_ANSWER};
    mh_answer_from_measurement(&t->measured, &message.as.answer);
    t->answers = mh_token_post(t, &message, t->asked_by, &t->node->place);
}
