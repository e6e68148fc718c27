#include "prince_node.h"

#include <string.h>

#define PART_STAYS 10000u /* ticks that a part is taken to stay near, until it is known */

#define SAME_M MH_REAL(25.0f) /* a target found first so near to where another is known to be is that */

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
    bool known = false;
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        struct mh_prince_row *row = &p->rows[i];
        if (row->state == MH_PRINCE_FREE || !row->fixed || row->target == (uint32_t)awake->target) {
            continue;
        }
        const struct mh_vec2 off = mh_prince_expected(p, row, &found);
        const mh_real reach_m = mh_prince_speed(row) > 0 ? SAME_M : mh_prince_drift(p, row);
        if (mh_vec2_square(off) <= mh_wide_mul(reach_m, reach_m)) {
            known = true;
            if (row->state == MH_PRINCE_HEAD) {
                say_merge(p, row, (uint32_t)awake->target, true);
            }
        }
    }
    struct mh_prince_row *other = mh_prince_find(p, (uint32_t)awake->target);
    if (known && other) {
        mh_prince_drop(p, other);
    }
    return known;
}

/* What the row's track, as saved, says -> estimate, with the flags that it was found with. */
static bool look(const struct mh_prince *p, const struct mh_prince_row *row, const struct mh_estimate *found,
                 struct mh_estimate *estimate)
{
    const struct mh_saved_track track = {row->target, row->bytes, row->length};
    if (p->config->port->expect(p->node->context, &track, row->asked, estimate) != MH_OK) {
        return false;
    }
    estimate->flags =
        (uint16_t)((found->flags & ~(unsigned)MH_ESTIMATE_SPLIT) | (estimate->flags & MH_ESTIMATE_UNRESOLVED));
    estimate->measurements = found->measurements;
    return true;
}

static void keep(struct mh_prince_row *row, const uint8_t *bytes, size_t length)
{
    memset(row->bytes, 0, sizeof row->bytes);
    memcpy(row->bytes, bytes, length);
    row->length = row->gathered = (uint8_t)length;
}

/* The row's target and another one become a group: no answer is waited for. Whoever leads the other and has not heard of it is told when the group next meets it. */
static void take_in(struct mh_prince *p, struct mh_prince_row *row, struct mh_estimate *estimate)
{
    struct mh_prince_row *other = mh_prince_find(p, estimate->near);
    if (!other || other == row || !mh_prince_has_track(other)) {
        return;
    }
    const struct mh_saved_track own = {row->target, row->bytes, row->length},
                                second = {other->target, other->bytes, other->length};
    uint8_t bytes[MH_PRINCE_TRACK_BYTES];
    size_t length;
    const enum mh_status status = p->config->port->join(p->node->context, &own, &second, bytes, &length);
    uint32_t gone = other->target;
    if (status == MH_OK) {
        if (mh_prince_ahead(other->generation, row->generation) >= 0) {
            row->generation = (uint16_t)(other->generation + 1u);
        }
        if (other->target < row->target) {
            gone = row->target;
            row->target = other->target;
        }
        mh_prince_drop(p, other);
        keep(row, bytes, length);
        p->counters.merged++;
        struct mh_estimate whole;
        if (look(p, row, estimate, &whole)) {
            whole.near = estimate->near;
            *estimate = whole;
        }
    } else if (status == MH_ERR_CORRUPT) { /* it is in the group already */
        mh_prince_drop(p, other);
    } else {
        return;
    }
    say_merge(p, row, gone, false);
}

/* A group into its parts, each with a row of its own, as far as there is room; the row itself goes on with the part that has its identifier. */
static void part(struct mh_prince *p, struct mh_prince_row *row, const struct mh_estimate *estimate)
{
    struct mh_prince_row *parts[MH_GROUP_MAX];
    uint8_t count = 0, bytes[MH_PRINCE_TRACK_BYTES];
    uint32_t target;
    size_t length;
    const uint16_t generation = row->generation;
    for (uint8_t k = 0; k < MH_GROUP_MAX; k++) {
        if (p->config->port->part(p->node->context, k, &target, bytes, &length) != MH_OK) {
            break;
        }
        struct mh_prince_row *one =
            target == row->target ? row : mh_prince_find_or_make(p, target, true, row->asked + PART_STAYS);
        if (one) {
            if (one != row) {
                const bool newer = one->fixed && mh_prince_ahead(one->generation, generation) >= 0;
                one->generation = newer ? (uint16_t)(one->generation + 1u) : generation;
                one->found = one->asked = row->asked; /* no speed between this and what was known before */
                one->fixed = true;
            }
            one->state = MH_PRINCE_HEAD; /* does not give way to the next part */
            keep(one, bytes, length);
            parts[count++] = one;
        }
    }
    for (uint8_t i = 0; i < count; i++) {
        struct mh_estimate one;
        if (look(p, parts[i], estimate, &one)) {
            mh_prince_go_ahead(p, parts[i], &one);
        } else {
            mh_prince_drop(p, parts[i]);
        }
    }
    p->counters.split += count > 1;
}

void mh_prince_regroup(struct mh_prince *p, struct mh_prince_row *row, const struct mh_estimate *estimate)
{
    if (estimate->flags & MH_ESTIMATE_SPLIT) {
        part(p, row, estimate);
        return;
    }
    struct mh_estimate told = *estimate;
    if (row->generation == 1 && estimate->members > 1) { /* the identifiers after its own are taken */
        p->founded = (uint8_t)(p->founded + estimate->members - 1);
    }
    if (estimate->flags & MH_ESTIMATE_MERGE) {
        take_in(p, row, &told);
    }
    mh_prince_go_ahead(p, row, &told);
}

/* Its head says that it leads it no more; all others forget it. */
void mh_prince_hear_merge(struct mh_prince *p, const mh_merge_t *merge)
{
    struct mh_prince_row *row = mh_prince_find(p, (uint32_t)merge->other);
    if (!row || merge->other == 0 || merge->other == merge->target) {
        return;
    }
    if (row->state == MH_PRINCE_HEAD && !merge->answers) {
        const struct mh_message answer = {.kind = MH_MESSAGE_MERGE,
                                          .as.merge = {.sender = (int32_t)p->node->id,
                                                       .target = merge->target,
                                                       .other = merge->other,
                                                       .generation = merge->generation,
                                                       .answers = 1}};
        mh_prince_send(p, &answer);
    }
    mh_prince_drop(p, row);
}
