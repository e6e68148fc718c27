#include "prince_node.h"

#define SAME_M                                                                                                         \
    20.0f /* a target found first so near to where another is known to be is that, though it may have drifted farther */

static void say_merge(struct mh_prince *p, const struct mh_prince_row *row, uint32_t other, bool answers)
{
    const struct mh_message message = {.kind = MH_MESSAGE_MERGE,
                                       .as.merge = {.sender = (int32_t)p->node->id,
                                                    .target = (int32_t)row->target,
                                                    .other = (int32_t)other,
                                                    .generation = (int16_t)row->generation,
                                                    .answers = answers}};
    mh_prince_send(p, &message);
}

bool mh_prince_claims(struct mh_prince *p, const mh_awake_t *awake)
{
    const struct mh_place found = {awake->x_mm, awake->y_mm, 0};
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        struct mh_prince_row *row = &p->rows[i];
        if (row->state == MH_PRINCE_HEAD && row->target != (uint32_t)awake->target) {
            const struct mh_vec2 off = mh_prince_expected(p, row, &found);
            const mh_real reach_m = mh_prince_speed(row) > 0 ? SAME_M : mh_prince_drift(p, row);
            if (mh_squared(off.x) + mh_squared(off.y) <= mh_squared(reach_m)) {
                struct mh_prince_row *other = mh_prince_find(p, (uint32_t)awake->target);
                if (other) {
                    mh_prince_drop(p, other);
                }
                say_merge(p, row, (uint32_t)awake->target, true);
                return true;
            }
        }
    }
    return false;
}

void mh_prince_regroup(struct mh_prince *p, struct mh_prince_row *row, const struct mh_estimate *estimate)
{
    (void)p;
    (void)row;
    (void)estimate;
}

void mh_prince_hear_merge(struct mh_prince *p, const mh_merge_t *merge)
{
    struct mh_prince_row *row = mh_prince_find(p, (uint32_t)merge->other);
    if (row && merge->answers) {
        mh_prince_drop(p, row);
    }
}
