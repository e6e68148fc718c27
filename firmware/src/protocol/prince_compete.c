#include "prince_node.h"

#define DECIDE_WAIT 150   /* ticks after the back-offs of all, ... */
#define DECIDE_SPREAD 200 /* ... and up to so many more, until the winner acts */
#define ASK_WAIT 100      /* ticks until it has been heard to ask */
#define HOLD 750          /* ticks for which who has lost does not compete, ... */
#define HOLD_SPREAD 500   /* ... and up to so many more */

void mh_prince_enter(struct mh_prince *p, struct mh_prince_row *row)
{
    row->contenders = 0;
    row->best = p->node->id;
    row->best_value = row->value;
    row->best_time = p->time;
    mh_prince_plan(p, row, MH_PRINCE_ACT_CONTEND, mh_prince_wait(p, p->config->contest));
}

void mh_prince_plan_decision(struct mh_prince *p, struct mh_prince_row *row, mh_tick began)
{
    const mh_tick decides = began + p->config->contest + DECIDE_WAIT + mh_prince_wait(p, DECIDE_SPREAD);
    mh_prince_plan(p, row, MH_PRINCE_ACT_DECIDE, decides - p->time);
}

void mh_prince_hold_back(struct mh_prince *p, struct mh_prince_row *row)
{
    row->hold = p->time + HOLD + mh_prince_wait(p, HOLD_SPREAD);
}

struct mh_prince_row *mh_prince_contest(struct mh_prince *p, uint32_t target, uint16_t generation, mh_tick time)
{
    struct mh_prince_row *row = generation == 1 ? mh_prince_find_new(p) : mh_prince_find(p, target);
    if (!row || !mh_prince_is_fresh(p, time)) {
        return NULL;
    }
    if (mh_prince_ahead(generation, row->generation) <= 0) {
        mh_prince_remind(p, row);
        return NULL;
    }
    if (row->act != MH_PRINCE_ACT_CONTEND && row->act != MH_PRINCE_ACT_DECIDE) {
        const mh_tick over = time + p->config->contest + DECIDE_WAIT + DECIDE_SPREAD + ASK_WAIT;
        row->hold = mh_tick_before(row->hold, over) ? over : row->hold; /* too late for this one */
        return NULL;
    }
    row->contenders = (uint8_t)(row->contenders + (row->contenders < UINT8_MAX));
    return row;
}

void mh_prince_contend(struct mh_prince *p, struct mh_prince_row *row)
{
    if (p->config->election == MH_PRINCE_TIMESTAMP) {
        mh_prince_detect(p, row);
        return;
    }
    row->value = p->value;
    mh_prince_enter(p, row);
}

void mh_prince_say_compete(struct mh_prince *p, struct mh_prince_row *row)
{
    if (p->config->election == MH_PRINCE_TIMESTAMP) {
        mh_prince_say_detection(p, row);
        return;
    }
    if (row->contenders < MH_PRINCE_CONTENDERS) {
        const struct mh_message message = {.kind = MH_MESSAGE_COMPETE,
                                           .as.compete = {.sender = (int32_t)p->node->id,
                                                          .target = (int32_t)row->target,
                                                          .generation = (int16_t)(uint16_t)(row->generation + 1u),
                                                          .time_ms = (int32_t)row->best_time,
                                                          .x_mm = p->node->place.x_mm,
                                                          .y_mm = p->node->place.y_mm,
                                                          .value_q20 = row->value}};
        mh_prince_send(p, &message);
        mh_prince_plan_decision(p, row, row->best_time);
    } else {
        mh_prince_hold_back(p, row);
    }
}

void mh_prince_decide(struct mh_prince *p, struct mh_prince_row *row)
{
    if (p->config->election == MH_PRINCE_TIMESTAMP) {
        mh_prince_decide_first(p, row);
    } else if (row->best == p->node->id) {
        mh_prince_ask(p, row, MH_LOCATE_COMPETITION);
    } else {
        mh_prince_hold_back(p, row);
    }
}

void mh_prince_hear_compete(struct mh_prince *p, const mh_compete_t *compete)
{
    const struct mh_place place = {compete->x_mm, compete->y_mm, 0};
    if (compete->generation == 1) {
        mh_prince_recognise(p, &place, compete->value_q20);
    }
    struct mh_prince_row *row =
        mh_prince_contest(p, (uint32_t)compete->target, (uint16_t)compete->generation, (mh_tick)compete->time_ms);
    const mh_node_id sender = (mh_node_id)compete->sender;
    if (row &&
        (compete->value_q20 > row->best_value || (compete->value_q20 == row->best_value && sender < row->best))) {
        row->best = sender;
        row->best_value = compete->value_q20;
    }
}
