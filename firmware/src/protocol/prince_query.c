#include "prince_node.h"

#include <string.h>

#define RETRY_WAIT 500   /* ticks */
#define RETRY_WATCH 2000 /* ticks for which who tries again stays at least */
#define RELAY_PAUSE 3000 /* ticks between fail_t of who wins and gets no answers */
#define RELAY_TIME 20000 /* ticks after the last fix, in which they do so */
#define PASSING 2000     /* ticks for which a target that was only heard of is remembered */
#define RANKS 8          /* of a window: between answers of nodes by rank */
#define SLOTS_SHARE                                                                                                    \
    MH_REAL(                                                                                                           \
        0.85f) /* of a window, over which answers spread by energy: evenly, since the square of the distance is 1 / energy */
#define SLOT_SPREAD 8              /* ticks by which those of equal energy differ */
#define LEAST_ENERGY MH_REAL(0.6f) /* of a target in an answer: less tells nothing of it */

/* ---- answers ---- */

static uint8_t first_of(const struct mh_prince *p, uint8_t number)
{
    uint8_t i = 0;
    while (i < p->reply_count && p->replies[i].target < number) {
        i++;
    }
    return i;
}

void mh_prince_collect(struct mh_prince *p, const struct mh_prince_row *row, mh_node_id id,
                       const struct mh_place *place, mh_q20 value)
{
    const uint8_t number = mh_prince_number(p, row);
    const struct mh_measurement measurement = {
        .node = id, .place = *place, .time = row->localised, .value = value, .target = number};
    const uint8_t begin = first_of(p, number), end = first_of(p, (uint8_t)(number + 1));
    uint8_t weakest = begin;
    for (uint8_t i = begin; i < end; i++) {
        if (p->replies[i].node == id) {
            return;
        }
        weakest = p->replies[i].value < p->replies[weakest].value ? i : weakest;
    }
    if (p->reply_count < MH_PRINCE_REPLIES_MAX) {
        memmove(&p->replies[end + 1], &p->replies[end], (size_t)(p->reply_count - end) * sizeof *p->replies);
        p->replies[end] = measurement;
        p->reply_count++;
    } else if (begin < end && p->replies[weakest].value < value) {
        p->replies[weakest] = measurement;
    }
}

void mh_prince_discard(struct mh_prince *p, const struct mh_prince_row *row)
{
    const uint8_t number = mh_prince_number(p, row);
    const uint8_t begin = first_of(p, number), end = first_of(p, (uint8_t)(number + 1));
    memmove(&p->replies[begin], &p->replies[end], (size_t)(p->reply_count - end) * sizeof *p->replies);
    p->reply_count = (uint8_t)(p->reply_count - (end - begin));
}

uint8_t mh_prince_collected(const struct mh_prince *p, const struct mh_prince_row *row)
{
    const uint8_t number = mh_prince_number(p, row);
    uint8_t others = 0;
    for (uint8_t i = 0; i < p->reply_count; i++) {
        others = (uint8_t)(others + (p->replies[i].target == number && p->replies[i].node != p->node->id));
    }
    return others;
}

bool mh_prince_has_track(const struct mh_prince_row *row)
{
    return row->state != MH_PRINCE_FREE && row->length > 0 && row->gathered == row->length;
}

bool mh_prince_localise(struct mh_prince *p, struct mh_prince_row *row)
{
    const uint8_t number = mh_prince_number(p, row);
    const uint8_t begin = first_of(p, number), end = first_of(p, (uint8_t)(number + 1));
    struct mh_saved_track own = {row->target, row->bytes, mh_prince_has_track(row) ? row->length : 0},
                          others[MH_TARGETS_MAX];
    size_t count = 0;
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        if (i != number && mh_prince_has_track(&p->rows[i])) {
            const struct mh_saved_track other = {p->rows[i].target, p->rows[i].bytes, p->rows[i].length};
            others[count++] = other;
        }
    }
    for (uint8_t i = begin; i < end; i++) {
        p->replies[i].target = 0;
    }
    struct mh_estimate estimate;
    uint8_t bytes[MH_PRINCE_TRACK_BYTES];
    size_t length;
    const struct mh_prince_port *port = p->config->port;
    enum mh_status status = port->localise(p->node->context, &own, others, count, row->localised, &p->replies[begin],
                                           (size_t)(end - begin), &estimate, bytes, &length);
    if (status == MH_ERR_CORRUPT) { /* what somebody said is no track: begin anew */
        own.length = 0;
        status = port->localise(p->node->context, &own, others, 0, row->localised, &p->replies[begin],
                                (size_t)(end - begin), &estimate, bytes, &length);
    }
    for (uint8_t i = begin; i < end; i++) {
        p->replies[i].target = number;
    }
    mh_prince_discard(p, row);
    if (status != MH_OK) {
        return false;
    }
    memset(row->bytes, 0, sizeof row->bytes);
    memcpy(row->bytes, bytes, length);
    row->length = row->gathered = (uint8_t)length;
    row->asked = row->localised;
    mh_prince_lead(p, row, &estimate);
    return true;
}

/* ---- the locator ---- */

void mh_prince_ask(struct mh_prince *p, struct mh_prince_row *row, enum mh_locate kind)
{
    row->kind = (uint8_t)kind;
    mh_prince_sample(p, row, MH_PRINCE_WANTS_QUERY);
}

mh_tick mh_prince_window(const struct mh_prince *p, const struct mh_prince_row *row)
{
    return row->members > 1 ? 2 * p->config->window : p->config->window;
}

/* The founder's number and a count from 1: never 0, and followed by as many as a group that is found as such takes, to 15. */
void mh_prince_name(struct mh_prince *p, struct mh_prince_row *row)
{
    if (row->target == 0) {
        p->founded = (uint8_t)(p->founded % (16 - MH_GROUP_MAX) + 1);
        p->counters.founded++;
        row->target = p->node->id * 16 + p->founded;
    }
}

static void fail(struct mh_prince *p, struct mh_prince_row *row)
{
    p->counters.fails++;
    mh_prince_say_fail(p, row);
}

void mh_prince_query(struct mh_prince *p, struct mh_prince_row *row)
{
    if (row->state != MH_PRINCE_WATCH || row->is_passive) {
        return;
    }
    if (!mh_prince_hears(p, row)) {
        if (row->tried) {
            fail(p, row);
        }
        return;
    }
    mh_prince_name(p, row);
    row->state = MH_PRINCE_LOCATE;
    row->asker = p->node->id;
    row->asked = p->sampled;
    row->localised = p->sampled;
    row->asked_for = (uint16_t)(row->generation + 1u);
    row->queried = p->time;
    mh_prince_clear(row, MH_PRINCE_ACT);
    row->act = MH_PRINCE_ACT_NONE;
    mh_prince_discard(p, row);
    mh_prince_collect(p, row, p->node->id, &p->node->place, p->value);
    const struct mh_message message = {.kind = MH_MESSAGE_LOCATE,
                                       .as.locate = {.sender = (int32_t)p->node->id,
                                                     .target = (int32_t)row->target,
                                                     .generation = (int16_t)(uint16_t)(row->generation + 1u),
                                                     .time_ms = (int32_t)row->asked,
                                                     .kind = row->kind}};
    mh_prince_send(p, &message);
    row->unsent = p->on_way;
    p->counters.retries += row->tried;
    mh_prince_set(row, MH_PRINCE_CLOSE, p->time + mh_prince_window(p, row));
}

/* What made the locator ask was the first of many samples to be large enough, so its noise is too, and the target has moved on since: what counts is a sample taken with those
 * of the others. That may have fallen below 1 again: then the target is about as far as a node can hear it. */
void mh_prince_take_own(struct mh_prince *p, struct mh_prince_row *row)
{
    if (row->state != MH_PRINCE_LOCATE) {
        return;
    }
    const uint8_t number = mh_prince_number(p, row);
    row->localised = p->sampled;
    for (uint8_t i = 0; i < p->reply_count; i++) {
        struct mh_measurement *reply = &p->replies[i];
        if (reply->target == number) {
            reply->time = p->sampled;
        }
        if (reply->target == number && reply->node == p->node->id) {
            reply->value = p->value > MH_Q20_ONE ? p->value : MH_Q20_ONE;
        }
    }
}

static void count_kind(struct mh_prince *p, uint8_t kind)
{
    p->counters.princes += kind == MH_LOCATE_PRINCE;
    p->counters.exceptions += kind == MH_LOCATE_EXCEPTION;
    p->counters.regents += kind == MH_LOCATE_REGENT;
    p->counters.competitions += kind == MH_LOCATE_COMPETITION;
}

/* Who has won, but is not answered, is perhaps out of reach of the others: they are kept awake. */
static void lose(struct mh_prince *p, struct mh_prince_row *row)
{
    mh_prince_hold_back(p, row);
    const bool stale = row->fixed && p->time - row->found > RELAY_TIME;
    if ((p->config->guards & MH_PRINCE_RELAY) && !stale && p->time - row->said >= RELAY_PAUSE) {
        row->said = p->time;
        p->counters.relays++;
        mh_prince_say_fail(p, row);
    } else {
        mh_prince_become_competitor(p, row, RETRY_WATCH);
    }
}

void mh_prince_close(struct mh_prince *p, struct mh_prince_row *row)
{
    if (row->state != MH_PRINCE_LOCATE) {
        return;
    }
    const uint8_t kind = row->kind;
    row->state = MH_PRINCE_WATCH;
    if (mh_prince_collected(p, row) >= MH_PRINCE_ANSWERS && mh_prince_localise(p, row)) {
        count_kind(p, kind);
        return;
    }
    mh_prince_discard(p, row);
    const int32_t left =
        mh_prince_is_set(row, MH_PRINCE_QUIET) ? mh_ticks_between(p->time, row->due[MH_PRINCE_QUIET]) : 0;
    if (left < RETRY_WATCH) {
        mh_prince_set(row, MH_PRINCE_QUIET, p->time + RETRY_WATCH);
    }
    if (kind == MH_LOCATE_COMPETITION) {
        lose(p, row);
    } else if (!row->tried && (p->config->guards & MH_PRINCE_RETRY)) {
        row->tried = true;
        mh_prince_plan(p, row, MH_PRINCE_ACT_LOCATE, RETRY_WAIT);
    } else {
        fail(p, row);
    }
}

/* ---- who is asked ---- */

/* Several ask about one target: the first of them goes on, and is answered. A query that is over, or for a generation before, does not count. */
static bool yields(const struct mh_prince *p, const struct mh_prince_row *row, const mh_locate_t *locate)
{
    const bool open = row->state == MH_PRINCE_LOCATE || p->time - row->queried < mh_prince_window(p, row);
    const int16_t ahead = mh_prince_ahead((uint16_t)locate->generation, row->asked_for);
    return !open || ahead > 0 ||
           (ahead == 0 &&
            mh_prince_is_first((mh_tick)locate->time_ms, (mh_node_id)locate->sender, row->asked, row->asker));
}

/* A target that was not known here, or not by that name: this node may have named it, too, or be about to. */
static struct mh_prince_row *row_of_stranger(struct mh_prince *p, const mh_locate_t *locate)
{
    struct mh_prince_row *row = locate->generation == 1 ? mh_prince_find_new(p) : NULL;
    if (!row) {
        row = mh_prince_find_or_make(p, (uint32_t)locate->target, false, p->time + PASSING);
        if (row) {
            mh_prince_become_competitor(p, row, PASSING);
            row->generation = (uint16_t)(locate->generation - 1);
        }
    } else if (yields(p, row, locate)) {
        row->target = (uint32_t)locate->target;
    }
    return row && row->target == (uint32_t)locate->target ? row : NULL;
}

void mh_prince_hear_locate(struct mh_prince *p, const mh_locate_t *locate)
{
    if (!mh_prince_is_fresh(p, (mh_tick)locate->time_ms) || locate->target == 0) {
        return;
    }
    struct mh_prince_row *row = mh_prince_find(p, (uint32_t)locate->target);
    row = row ? row : row_of_stranger(p, locate);
    if (!row || row->state == MH_PRINCE_SLEEP) {
        return;
    }
    if (mh_prince_ahead((uint16_t)locate->generation, row->generation) <= 0) {
        mh_prince_remind(p, row);
        return;
    }
    if (!yields(p, row, locate)) {
        return;
    }
    if (row->state == MH_PRINCE_LOCATE) {
        mh_prince_discard(p, row);
        row->state = MH_PRINCE_WATCH;
        if (!mh_prince_is_set(row, MH_PRINCE_QUIET)) {
            mh_prince_set(row, MH_PRINCE_QUIET, p->time + RETRY_WATCH);
        }
    }
    mh_prince_calm(row);
    row->queried = p->time;
    row->is_prince = row->is_prince && locate->kind != MH_LOCATE_EXCEPTION;
    row->kind = locate->kind;
    row->asker = (mh_node_id)locate->sender;
    row->asked = (mh_tick)locate->time_ms;
    row->asked_for = (uint16_t)locate->generation;
    row->overheard = 0;
    mh_prince_sample(p, row, MH_PRINCE_WANTS_REPLY);
}

/* How many of the neighbours are expected to be nearer to the target than this node is, but for who asks. */
static uint8_t rank(const struct mh_prince *p, const struct mh_prince_row *row)
{
    const struct mh_vec2 here = mh_prince_expected(p, row, &p->node->place);
    const mh_wide own = mh_vec2_square(here);
    uint8_t nearer = 0;
    for (uint8_t i = 0; i < p->neighbours.count; i++) {
        const struct mh_neighbour *neighbour = &p->neighbours.list[i];
        const struct mh_place place = {neighbour->x_mm, neighbour->y_mm, 0};
        const struct mh_vec2 there = mh_prince_expected(p, row, &place);
        const mh_wide square = mh_vec2_square(there);
        nearer = (uint8_t)(nearer + (neighbour->id != row->asker &&
                                     (square < own || (square == own && neighbour->id < p->node->id))));
    }
    return nearer;
}

/* The nearer the sooner: by rank where the target is where it is expected, else by the energy. */
static mh_tick reply_wait(struct mh_prince *p, const struct mh_prince_row *row, mh_real energy)
{
    const mh_tick window = mh_prince_window(p, row);
    const bool foreseen = row->kind == MH_LOCATE_PRINCE || row->kind == MH_LOCATE_REGENT ||
                          (row->kind == MH_LOCATE_COMPETITION && p->config->election != MH_PRINCE_NAMED);
    if (mh_prince_speed(row) > 0 && foreseen) {
        const uint8_t slot = rank(p, row);
        if (slot < RANKS) {
            return window / RANKS * slot;
        }
    }
    return (mh_tick)mh_real_times(
               mh_div(mh_mul(SLOTS_SHARE, mh_real_from_int((int32_t)window)), mh_max(energy, MH_REAL(1.0f))), 1) +
           mh_prince_wait(p, SLOT_SPREAD);
}

void mh_prince_prepare_reply(struct mh_prince *p, struct mh_prince_row *row)
{
    mh_real share;
    const mh_real energy = mh_prince_energy(p, row, &share, NULL);
    const bool heard =
        row->fixed ? mh_q20_to_real(p->value) >= MH_REAL(1.0f) && energy >= LEAST_ENERGY && share >= MH_PRINCE_SHARE
                   : mh_prince_hears(p, row);
    if (!heard || row->state == MH_PRINCE_LOCATE) {
        return;
    }
    row->value = p->value;
    mh_prince_set(row, MH_PRINCE_REPLY, p->time + reply_wait(p, row, energy));
}

void mh_prince_reply(struct mh_prince *p, struct mh_prince_row *row)
{
    mh_real share;
    uint8_t others;
    (void)mh_prince_energy(p, row, &share, &others);
    const struct mh_message message = {.kind = MH_MESSAGE_SOUND,
                                       .as.sound = {.sender = (int32_t)p->node->id,
                                                    .asker = (int32_t)row->asker,
                                                    .target = (int32_t)row->target,
                                                    .time_ms = (int32_t)row->asked,
                                                    .x_mm = p->node->place.x_mm,
                                                    .y_mm = p->node->place.y_mm,
                                                    .value_q20 = row->value,
                                                    .share = (uint8_t)mh_real_times(share, 255),
                                                    .others = others}};
    mh_prince_send(p, &message);
}

void mh_prince_hear_sound(struct mh_prince *p, const mh_sound_t *sound)
{
    struct mh_prince_row *row = mh_prince_find(p, (uint32_t)sound->target);
    if (!row || row->asker != (mh_node_id)sound->asker || row->asked != (mh_tick)sound->time_ms) {
        return;
    }
    if (row->state == MH_PRINCE_LOCATE) {
        const struct mh_place place = {sound->x_mm, sound->y_mm, 0};
        mh_prince_collect(p, row, (mh_node_id)sound->sender, &place, sound->value_q20);
        return;
    }
    row->overheard = (uint8_t)(row->overheard + (row->overheard < UINT8_MAX));
    if (row->overheard >= p->config->replies && row->members <= 1) {
        mh_prince_clear(row, MH_PRINCE_REPLY);
    }
}
