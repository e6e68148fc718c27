#include "prince_node.h"

#include <string.h>

#define REMIND_PAUSE 500   /* ticks between awake_t that are said again */
#define FAILED_WATCH 10000 /* ticks for which a fail_t makes competitors */
#define HANDED_WATCH 3000  /* ticks for which an old head watches on */
#define UNKNOWN_ARMS 3000  /* ticks after which competitors may contend where it is not known how the target moves */
#define PRINCE_LEAD MH_REAL(0.8f)   /* s, in which a prince learns that it is prince */
#define DOG_WAIT 2500               /* ticks after the prince was due */
#define DOG_HASTE MH_REAL(1.2f)     /* times the largest of the last speeds is what the target may do */
#define DOG_SPEED_MPS MH_REAL(6.0f) /* ... at least */
#define DOG_LATEST MH_REAL(25.0f)   /* s after the fix: later nobody would believe it (mh_prince_is_fresh) */
#define UNGUARDED 15000             /* ticks for which a head without watchdog waits after the prince was due */
#define KEPT 20000                  /* ticks for which a row is kept after that */
#define SLOWEST_MPS MH_REAL(1.0f)   /* a velocity below is none */
#define SPEED_STEPS 4               /* that a speed is told in, a m/s */

/* `value` in `steps` a unit, saturated. */
static int16_t to_i16(mh_real value, int16_t steps)
{
    const mh_real most = MH_REAL_UPTO(1e6f);
    const int32_t number = mh_real_times(mh_clamp(value, -most, most), steps);
    return (int16_t)(number > INT16_MAX - 1 ? INT16_MAX - 1 : number < INT16_MIN + 1 ? INT16_MIN + 1 : number);
}

static struct mh_place fix_of(const struct mh_prince_row *row)
{
    const struct mh_place fix = {row->x_mm, row->y_mm, 0};
    return fix;
}

/* ---- what a head says ---- */

static void say_in_window(struct mh_prince *p, struct mh_prince_row *row, enum mh_message_kind kind)
{
    if (p->config->wake_period > 0 && !mh_rendezvous_open(&p->rendezvous, p->time)) {
        row->announces = (uint8_t)kind;
        mh_prince_set(row, MH_PRINCE_ANNOUNCE, mh_rendezvous_next(&p->rendezvous, p->time));
    }
}

/* From the fix to `time`, in 10 ms. */
static int16_t since_fix_cs(const struct mh_prince_row *row, mh_tick time)
{
    return to_i16(mh_max(mh_seconds_between(row->found, time), 0), 100);
}

/* What did not go into the awake_t, from `first` on. */
static void say_rest(struct mh_prince *p, const struct mh_prince_row *row, uint8_t first)
{
    struct mh_message message = {.kind = MH_MESSAGE_REST,
                                 .as.rest = {.sender = (int32_t)p->node->id,
                                             .target = (int32_t)row->target,
                                             .generation = (int16_t)row->generation,
                                             .length = (uint8_t)(row->length - first)}};
    memcpy(message.as.rest.data, row->bytes + first, message.as.rest.length);
    mh_prince_send(p, &message);
}

static void say_begin(struct mh_prince *p, const struct mh_prince_row *row, uint8_t first)
{
    const struct mh_place fix = fix_of(row);
    const struct mh_vec2 head = mh_place_relative(&p->node->place, &fix);
    struct mh_message message = {.kind = MH_MESSAGE_AWAKE,
                                 .as.awake = {.sender = (int32_t)p->node->id,
                                              .target = (int32_t)row->target,
                                              .generation = (int16_t)row->generation,
                                              .time_ms = (int32_t)row->found,
                                              .x_mm = row->x_mm,
                                              .y_mm = row->y_mm,
                                              .vx_cmps = row->vx_cmps,
                                              .vy_cmps = row->vy_cmps,
                                              .head_x_dm = to_i16(head.x, 10),
                                              .head_y_dm = to_i16(head.y, 10),
                                              .prince = (int32_t)row->prince,
                                              .enters_cs = since_fix_cs(row, row->enters),
                                              .arms_cs = since_fix_cs(row, row->arms),
                                              .extent_cm = (int16_t)row->extent_cm,
                                              .members = row->members,
                                              .length = row->length}};
    memcpy(message.as.awake.speeds, row->speeds, sizeof row->speeds);
    memcpy(message.as.awake.data, row->bytes, first);
    mh_prince_send(p, &message);
}

static void say_awake(struct mh_prince *p, const struct mh_prince_row *row)
{
    const uint8_t first = row->length < MH_AWAKE_BYTES ? row->length : MH_AWAKE_BYTES;
    say_begin(p, row, first);
    if (row->length > first) {
        say_rest(p, row, first);
    }
}

void mh_prince_announce(struct mh_prince *p, struct mh_prince_row *row)
{
    say_awake(p, row);
    say_in_window(p, row, MH_MESSAGE_AWAKE);
}

void mh_prince_remind(struct mh_prince *p, struct mh_prince_row *row)
{
    if (row->state == MH_PRINCE_HEAD && p->time - row->said >= REMIND_PAUSE) {
        row->said = p->time;
        p->counters.repeated++;
        mh_prince_announce(p, row);
    }
}

static void say_fail(struct mh_prince *p, const struct mh_prince_row *row)
{
    const struct mh_message message = {.kind = MH_MESSAGE_FAIL,
                                       .as.fail = {.sender = (int32_t)p->node->id,
                                                   .target = (int32_t)row->target,
                                                   .generation = (int16_t)row->generation,
                                                   .time_ms = (int32_t)(row->fixed ? row->found : p->time),
                                                   .x_mm = row->fixed ? row->x_mm : p->node->place.x_mm,
                                                   .y_mm = row->fixed ? row->y_mm : p->node->place.y_mm,
                                                   .vx_cmps = row->vx_cmps,
                                                   .vy_cmps = row->vy_cmps}};
    mh_prince_send(p, &message);
}

void mh_prince_say_fail(struct mh_prince *p, struct mh_prince_row *row)
{
    say_fail(p, row);
    say_in_window(p, row, MH_MESSAGE_FAIL);
    row->tried = false;
    mh_prince_become_competitor(p, row, FAILED_WATCH);
}

void mh_prince_say_again(struct mh_prince *p, struct mh_prince_row *row)
{
    if (row->announces == MH_MESSAGE_FAIL) {
        say_fail(p, row);
    } else if (row->state == MH_PRINCE_HEAD) {
        say_awake(p, row);
    }
}

void mh_prince_bark(struct mh_prince *p, struct mh_prince_row *row)
{
    if (row->state == MH_PRINCE_HEAD) {
        p->counters.watchdogs++;
        mh_prince_say_fail(p, row);
    }
}

/* ---- a new head ---- */

static void note_speed(struct mh_prince_row *row, const struct mh_place *place, mh_tick time)
{
    const struct mh_place before = fix_of(row);
    const mh_real seconds = mh_seconds_between(row->found, time);
    if (row->fixed && seconds > 0) {
        const mh_real speed_mps =
            mh_div(mh_real_from_ratio((int32_t)mh_place_distance_mm(&before, place), 1000), seconds);
        memmove(row->speeds + 1, row->speeds, sizeof row->speeds - 1);
        row->speeds[0] = (uint8_t)mh_real_times(mh_min(speed_mps, MH_REAL(255.0f / SPEED_STEPS)), SPEED_STEPS);
    }
}

static void take_fix(struct mh_prince_row *row, const struct mh_estimate *estimate)
{
    const struct mh_place place = mh_place_from_offset(&estimate->origin, estimate->position);
    const bool moves = mh_vec2_length(estimate->velocity) >= SLOWEST_MPS;
    note_speed(row, &place, row->asked);
    row->fixed = true;
    row->found = row->asked;
    row->x_mm = place.x_mm;
    row->y_mm = place.y_mm;
    row->vx_cmps = moves ? to_i16(estimate->velocity.x, 100) : 0;
    row->vy_cmps = moves ? to_i16(estimate->velocity.y, 100) : 0;
    row->extent_cm = (uint16_t)to_i16(mh_max(estimate->extent, 0), 100);
    row->members = estimate->members > 1 && estimate->members <= MH_GROUP_MAX ? estimate->members : 1;
}

/* Who is to lead next, and when. */
static void name_prince(struct mh_prince *p, struct mh_prince_row *row)
{
    const struct mh_prince_config *config = p->config;
    const mh_real speed_mps = mh_prince_speed(row);
    row->prince = MH_BROADCAST;
    row->enters = p->time;
    row->arms = speed_mps == 0 ? p->time + UNKNOWN_ARMS
                : config->election == MH_PRINCE_NAMED
                    ? p->time
                    : row->found + (mh_tick)mh_real_times(mh_div(config->step_m, speed_mps), 1000);
    if (speed_mps == 0 || config->election != MH_PRINCE_NAMED) {
        return;
    }
    const struct mh_strips strips =
        mh_strips(config->sensing_range_m, config->margin_m, config->outer_m, mh_real_from_ratio(row->extent_cm, 100));
    const struct mh_prince_rule rule = {config->step_m, PRINCE_LEAD, config->farthest};
    const struct mh_place fix = fix_of(row);
    const struct mh_course course = {.head = mh_place_relative(&p->node->place, &fix),
                                     .velocity = mh_prince_velocity(row)};
    struct mh_prince_choice best = {.found = false};
    for (uint8_t i = 0; i < p->neighbours.count; i++) {
        const struct mh_neighbour *neighbour = &p->neighbours.list[i];
        const struct mh_place place = {neighbour->x_mm, neighbour->y_mm, 0};
        mh_prince_consider(&best, &rule, &strips, &course, mh_seconds_between(row->found, p->time), neighbour->id,
                           mh_place_relative(&place, &fix));
    }
    if (best.found) {
        row->prince = best.id;
        row->enters = row->found + (mh_tick)mh_real_times(best.entry_s, 1000);
    }
}

static void set_dog(struct mh_prince *p, struct mh_prince_row *row)
{
    const struct mh_prince_config *config = p->config;
    mh_real largest = 0;
    for (size_t i = 0; i < sizeof row->speeds; i++) {
        largest = mh_max(largest, mh_real_from_ratio(row->speeds[i], SPEED_STEPS));
    }
    const mh_real away_s =
        mh_div(config->radio_range_m - config->sensing_range_m, mh_max(mh_mul(DOG_HASTE, largest), DOG_SPEED_MPS));
    mh_tick due = row->found + (mh_tick)mh_real_times(mh_min(away_s, DOG_LATEST), 1000);
    if (row->prince != MH_BROADCAST && mh_tick_before(row->enters + DOG_WAIT, due)) {
        due = row->enters + DOG_WAIT;
    }
    mh_prince_clear(row, MH_PRINCE_QUIET);
    mh_prince_clear(row, MH_PRINCE_FORGET);
    if (config->guards & MH_PRINCE_WATCHDOG) {
        mh_prince_set(row, MH_PRINCE_DOG, due);
    } else {
        const mh_tick later = mh_tick_before(row->enters, row->arms) ? row->arms : row->enters;
        mh_prince_set(row, MH_PRINCE_QUIET, later + UNGUARDED);
    }
}

/* A target that has no fix yet is taken for the one that has. */
static void drop_unfixed(struct mh_prince *p)
{
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        if (p->rows[i].state != MH_PRINCE_FREE && !p->rows[i].fixed) {
            mh_prince_drop(p, &p->rows[i]);
        }
    }
}

static void say_succeed(struct mh_prince *p, const struct mh_prince_row *row)
{
    const struct mh_message message = {.kind = MH_MESSAGE_SUCCEED,
                                       .as.succeed = {.sender = (int32_t)p->node->id,
                                                      .head = (int32_t)row->head,
                                                      .target = (int32_t)row->target,
                                                      .generation = (int16_t)row->generation}};
    if (row->head != MH_BROADCAST && row->head != p->node->id) {
        mh_prince_send(p, &message);
    }
}

void mh_prince_lead(struct mh_prince *p, struct mh_prince_row *row, const struct mh_estimate *estimate)
{
    p->counters.located++;
    row->generation++;
    row->state = MH_PRINCE_HEAD;
    say_succeed(p, row);
    mh_prince_regroup(p, row, estimate);
}

void mh_prince_go_ahead(struct mh_prince *p, struct mh_prince_row *row, const struct mh_estimate *estimate)
{
    mh_prince_calm(row);
    take_fix(row, estimate);
    drop_unfixed(p);
    row->state = MH_PRINCE_HEAD;
    row->is_prince = row->is_passive = false;
    row->head = p->node->id;
    name_prince(p, row);
    set_dog(p, row);
    mh_prince_announce(p, row);
    struct mh_estimate told = *estimate;
    told.target = row->target;
    p->node->port->tell(p->node->context, &told);
}

/* ---- what others hear ---- */

/* Of two heads of a generation, does this node's row stay with the one that it knows? */
static bool stands(struct mh_prince *p, struct mh_prince_row *row, const mh_awake_t *awake)
{
    const mh_node_id sender = (mh_node_id)awake->sender;
    if (!row->fixed || row->is_passive || row->head == sender) {
        return row->fixed && row->head == sender && !row->is_passive && row->found == (mh_tick)awake->time_ms &&
               row->gathered > 0;
    }
    if (mh_prince_is_first(row->found, row->head, (mh_tick)awake->time_ms, sender)) {
        mh_prince_remind(p, row);
        return true;
    }
    p->counters.double_heads += row->state == MH_PRINCE_HEAD;
    return false;
}

static void take_awake(struct mh_prince_row *row, const mh_awake_t *awake)
{
    row->generation = (uint16_t)awake->generation;
    row->head = (mh_node_id)awake->sender;
    row->prince = (mh_node_id)awake->prince;
    row->fixed = true;
    row->is_passive = false;
    row->found = (mh_tick)awake->time_ms;
    row->x_mm = awake->x_mm;
    row->y_mm = awake->y_mm;
    row->vx_cmps = awake->vx_cmps;
    row->vy_cmps = awake->vy_cmps;
    row->extent_cm = (uint16_t)awake->extent_cm;
    row->members = awake->members;
    memcpy(row->speeds, awake->speeds, sizeof row->speeds);
    row->enters = row->found + 10u * (mh_tick)awake->enters_cs;
    row->length = awake->length;
    row->gathered = awake->length < MH_AWAKE_BYTES ? awake->length : MH_AWAKE_BYTES;
    memcpy(row->bytes, awake->data, row->gathered);
}

void mh_prince_hear_awake(struct mh_prince *p, const mh_awake_t *awake)
{
    if (!mh_prince_is_fresh(p, (mh_tick)awake->time_ms) || awake->target == 0) {
        return;
    }
    struct mh_prince_row *row = mh_prince_find(p, (uint32_t)awake->target);
    if (row) {
        const int16_t ahead = mh_prince_ahead((uint16_t)awake->generation, row->generation);
        if (ahead < 0) {
            mh_prince_remind(p, row);
            return;
        }
        if (ahead == 0 && stands(p, row, awake)) {
            return;
        }
        mh_prince_calm(row);
        mh_prince_clear(row, MH_PRINCE_DOG);
        mh_prince_clear(row, MH_PRINCE_ANNOUNCE);
        mh_prince_discard(p, row);
    }
    if (awake->generation == 1 && mh_prince_claims(p, awake)) {
        return;
    }
    const bool was_fixed = row && row->fixed;
    if (!was_fixed) {
        drop_unfixed(p);
        row = mh_prince_find_or_make(p, (uint32_t)awake->target, true, p->time + KEPT);
    }
    if (!row) {
        return;
    }
    take_awake(row, awake);
    const struct mh_vec2 head = {mh_real_from_ratio(awake->head_x_dm, 10), mh_real_from_ratio(awake->head_y_dm, 10)};
    mh_prince_classify(p, row, head, row->found + 10u * (mh_tick)awake->arms_cs);
}

void mh_prince_hear_rest(struct mh_prince *p, const mh_rest_t *rest)
{
    struct mh_prince_row *row = mh_prince_find(p, (uint32_t)rest->target);
    if (row && row->head == (mh_node_id)rest->sender && row->generation == (uint16_t)rest->generation &&
        row->gathered == MH_AWAKE_BYTES && row->length == MH_AWAKE_BYTES + rest->length) {
        memcpy(row->bytes + MH_AWAKE_BYTES, rest->data, rest->length);
        row->gathered = row->length;
    }
}

void mh_prince_hear_fail(struct mh_prince *p, const mh_fail_t *fail)
{
    if (!mh_prince_is_fresh(p, (mh_tick)fail->time_ms) || fail->target == 0) {
        return;
    }
    const struct mh_place place = {fail->x_mm, fail->y_mm, 0};
    if (!mh_prince_find(p, (uint32_t)fail->target) && mh_prince_is_known(p, &place)) {
        mh_prince_recognise(p, &place, MH_Q20_ONE);
        return;
    }
    struct mh_prince_row *row = fail->generation == 0 ? mh_prince_find_new(p) : NULL;
    row = row ? row : mh_prince_find_or_make(p, (uint32_t)fail->target, true, p->time + FAILED_WATCH);
    if (!row) {
        return;
    }
    const int16_t ahead = mh_prince_ahead((uint16_t)fail->generation, row->generation);
    if (ahead < 0 && (row->fixed || row->state == MH_PRINCE_HEAD)) {
        mh_prince_remind(p, row);
        return;
    }
    if (row->state == MH_PRINCE_LOCATE) {
        return; /* finds out for itself */
    }
    if (ahead > 0 || !row->fixed) {
        row->fixed = fail->generation != 0;
        row->generation = (uint16_t)fail->generation;
        row->head = MH_BROADCAST;
        row->found = (mh_tick)fail->time_ms;
        row->x_mm = place.x_mm;
        row->y_mm = place.y_mm;
        row->vx_cmps = fail->vx_cmps;
        row->vy_cmps = fail->vy_cmps;
        row->gathered = row->length = 0;
    }
    mh_prince_become_competitor(p, row, FAILED_WATCH);
}

void mh_prince_hear_succeed(struct mh_prince *p, const mh_succeed_t *succeed)
{
    struct mh_prince_row *row = mh_prince_find(p, (uint32_t)succeed->target);
    if (!row || succeed->target == 0 || row->state == MH_PRINCE_SLEEP ||
        mh_prince_ahead((uint16_t)succeed->generation, row->generation) <= 0) {
        return;
    }
    const bool led = row->state == MH_PRINCE_HEAD;
    mh_prince_calm(row);
    mh_prince_discard(p, row);
    mh_prince_clear(row, MH_PRINCE_DOG);
    mh_prince_clear(row, MH_PRINCE_ANNOUNCE);
    row->state = MH_PRINCE_WATCH;
    row->is_prince = false;
    row->is_passive = true;
    if (led || !mh_prince_is_set(row, MH_PRINCE_QUIET)) {
        row->as = MH_NODE_COMPETITOR;
        mh_prince_set(row, MH_PRINCE_QUIET, p->time + HANDED_WATCH);
        mh_prince_set(row, MH_PRINCE_FORGET, p->time + HANDED_WATCH + KEPT);
    }
    if (led && p->config->election == MH_PRINCE_TIMESTAMP) {
        mh_prince_plan(p, row, MH_PRINCE_ACT_RELEASE, HANDED_WATCH / 15);
    }
}
