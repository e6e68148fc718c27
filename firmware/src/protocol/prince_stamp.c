#include "prince_node.h"

#define SUPPRESSED 2000 /* ticks for which who is suppressed keeps silent, if nobody releases it */

void mh_prince_detect(struct mh_prince *p, struct mh_prince_row *row)
{
    row->value = p->value;
    row->asked = row->localised = p->time;
    mh_prince_discard(p, row);
    mh_prince_collect(p, row, p->node->id, &p->node->place, p->value);
    mh_prince_enter(p, row);
}

static void retire(struct mh_prince *p, struct mh_prince_row *row)
{
    mh_prince_discard(p, row);
    mh_prince_hold_back(p, row);
}

void mh_prince_say_detection(struct mh_prince *p, struct mh_prince_row *row)
{
    if (row->contenders >= MH_PRINCE_CONTENDERS) { /* nobody has heard of this node: it cannot be the first */
        retire(p, row);
        return;
    }
    const struct mh_message message = {.kind = MH_MESSAGE_DETECTION,
                                       .as.detection = {.sender = (int32_t)p->node->id,
                                                        .target = (int32_t)row->target,
                                                        .generation = (int16_t)(uint16_t)(row->generation + 1u),
                                                        .detected_ms = (int32_t)row->asked,
                                                        .x_mm = p->node->place.x_mm,
                                                        .y_mm = p->node->place.y_mm,
                                                        .value_q20 = row->value}};
    mh_prince_send(p, &message);
    mh_prince_plan_decision(p, row, row->asked);
}

static void say_suppress(struct mh_prince *p, const struct mh_prince_row *row, uint16_t generation, bool released)
{
    const struct mh_message message = {.kind = MH_MESSAGE_SUPPRESS,
                                       .as.suppress = {.sender = (int32_t)p->node->id,
                                                       .target = (int32_t)row->target,
                                                       .generation = (int16_t)generation,
                                                       .released = released}};
    mh_prince_send(p, &message);
}

void mh_prince_decide_first(struct mh_prince *p, struct mh_prince_row *row)
{
    if (row->best != p->node->id) {
        retire(p, row);
        return;
    }
    if (mh_prince_collected(p, row) >= MH_PRINCE_ANSWERS) {
        say_suppress(p, row, (uint16_t)(row->generation + 1u), false);
    }
    mh_prince_name(p, row);
    row->state = MH_PRINCE_LOCATE; /* as if the detections were answers */
    row->kind = MH_LOCATE_COMPETITION;
    mh_prince_close(p, row);
}

void mh_prince_hear_detection(struct mh_prince *p, const mh_detection_t *detection)
{
    const mh_tick detected = (mh_tick)detection->detected_ms;
    const struct mh_place place = {detection->x_mm, detection->y_mm, 0};
    if (detection->generation == 1) {
        mh_prince_recognise(p, &place, detection->value_q20);
    }
    struct mh_prince_row *row =
        mh_prince_contest(p, (uint32_t)detection->target, (uint16_t)detection->generation, detected);
    if (!row) {
        return;
    }
    const mh_node_id sender = (mh_node_id)detection->sender;
    mh_prince_collect(p, row, sender, &place, detection->value_q20);
    if (mh_prince_is_first(detected, sender, row->best_time, row->best)) {
        row->best = sender;
        row->best_time = detected;
    }
}

void mh_prince_hear_suppress(struct mh_prince *p, const mh_suppress_t *suppress)
{
    struct mh_prince_row *row = mh_prince_find(p, (uint32_t)suppress->target);
    if (!row || row->state != MH_PRINCE_WATCH) {
        return;
    }
    if (suppress->released) {
        row->hold = p->time;
    } else if (mh_prince_ahead((uint16_t)suppress->generation, row->generation) > 0) {
        mh_prince_calm(row);
        mh_prince_discard(p, row);
        row->hold = p->time + SUPPRESSED;
    }
}

void mh_prince_release(struct mh_prince *p, struct mh_prince_row *row) { say_suppress(p, row, row->generation, true); }
