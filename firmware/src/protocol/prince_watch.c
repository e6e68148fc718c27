#include "prince_node.h"

#include "motehound/decomposition.h"
#include "motehound/time_window.h"

#define AFTER_OUT 3000      /* ticks for which a watcher stays when the target should be out of range */
#define LEAST_WATCH 2000    /* ticks, of a watcher */
#define UNKNOWN_WATCH 15000 /* ... where it is not known how the target moves */
#define LINGERING 2000      /* ticks for which a watcher stays at least that hears the target when its time is over */
#define LONGEST_WATCH 300000
#define KEPT 20000                 /* ticks for which a row is kept after that */
#define REGENT_WAIT 1000           /* ticks after the prince is due ... */
#define REGENT_SPREAD 500          /* ... and up to so many more, ... */
#define BORDER_WAIT 300            /* ... and these in the border */
#define OTHERS_WAIT 200            /* ticks in which somebody else may ask first */
#define QUERY_REST 200             /* ticks after the window of a query that was heard, until the next */
#define SLACK_M 10                 /* that a target may be off where it is expected */
#define FIX_SLACK_M MH_REAL(25.0f) /* ... where the fix is a mirror image */
#define NEAR_SLACK_M MH_REAL(5.0f) /* ... as far as a competitor and an outer node care */
#define UNKNOWN_MPS MH_REAL(20.0f) /* that a target may go where nothing is known of it */
#define EXPLAINED                                                                                                      \
    MH_REAL(1.5f) /* times the energy expected of the targets that are known, and what is heard is one more */

mh_real mh_prince_speed(const struct mh_prince_row *row)
{
    const struct mh_vec2 cmps = {mh_real_from_int(row->vx_cmps), mh_real_from_int(row->vy_cmps)};
    return mh_real_over(mh_vec2_length(cmps), 100);
}

struct mh_vec2 mh_prince_expected(const struct mh_prince *p, const struct mh_prince_row *row,
                                  const struct mh_place *origin)
{
    const struct mh_place fix = {row->x_mm, row->y_mm, 0};
    const mh_real seconds = mh_seconds_between(row->found, p->time);
    return mh_vec2_along(mh_place_relative(&fix, origin), seconds, mh_prince_velocity(row));
}

mh_real mh_prince_energy(const struct mh_prince *p, const struct mh_prince_row *row, mh_real *share, uint8_t *others)
{
    const struct mh_vec2 here = {0, 0};
    const mh_real range_m = 3 * p->config->sensing_range_m;
    struct mh_vec2 sources[MH_TARGETS_MAX];
    uint8_t count = 1;
    mh_real own = MH_REAL(1.0f);
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        const struct mh_prince_row *other = &p->rows[i];
        if (other != row && other->state != MH_PRINCE_FREE && other->fixed) {
            const struct mh_vec2 at = mh_prince_expected(p, other, &p->node->place);
            if (mh_vec2_square(at) <= mh_wide_mul(range_m, range_m)) {
                sources[count++] = at;
            }
        }
    }
    if (row->fixed) {
        sources[0] = mh_prince_expected(p, row, &p->node->place);
        own = mh_sound_share(sources, count, 0, here, range_m);
    }
    if (share) {
        *share = own;
    }
    if (others) {
        *others = (uint8_t)(count - 1);
    }
    return mh_mul(own, mh_q20_to_real(p->value));
}

mh_real mh_prince_drift(const struct mh_prince *p, const struct mh_prince_row *row)
{
    const mh_real speed_mps = mh_prince_speed(row), drift_mps = speed_mps > 0 ? speed_mps : UNKNOWN_MPS;
    return mh_add(FIX_SLACK_M, mh_mul(drift_mps, mh_seconds_between(row->found, p->time)));
}

/* What is expected at `place` of a target that is `slack_m` nearer than expected. */
static mh_real explained_by(const struct mh_prince *p, const struct mh_prince_row *row, const struct mh_place *place,
                            mh_real slack_m)
{
    const struct mh_vec2 at = mh_prince_expected(p, row, place);
    const mh_real distance_m = mh_max(mh_add(mh_vec2_length(at), -slack_m), MH_REAL(1.0f));
    return mh_wide_ratio(mh_wide_mul(p->config->loudness_m2, mh_real_from_int(row->members)),
                         mh_wide_mul(distance_m, distance_m));
}

/* What is expected here of all targets but `own`. */
static mh_real explained_by_others(const struct mh_prince *p, const struct mh_prince_row *own)
{
    mh_real sum = 0;
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        const struct mh_prince_row *row = &p->rows[i];
        if (row != own && row->state != MH_PRINCE_FREE && row->fixed) {
            sum = mh_add(sum, explained_by(p, row, &p->node->place, NEAR_SLACK_M));
        }
    }
    return sum;
}

/* p->value is more than all targets with a fix explain. */
static bool is_unexplained(const struct mh_prince *p)
{
    mh_real sum = 0;
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        const struct mh_prince_row *row = &p->rows[i];
        if (row->state != MH_PRINCE_FREE && row->fixed) {
            sum = mh_add(sum, explained_by(p, row, &p->node->place, mh_prince_drift(p, row)));
        }
    }
    const mh_real energy = mh_q20_to_real(p->value);
    return energy >= MH_REAL(1.0f) && energy > mh_mul(EXPLAINED, sum);
}

bool mh_prince_is_new(const struct mh_prince *p)
{
    bool waiting = false; /* there is one already */
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        waiting = waiting || (p->rows[i].state != MH_PRINCE_FREE && !p->rows[i].fixed);
    }
    return !waiting && is_unexplained(p);
}

void mh_prince_recognise(struct mh_prince *p, const struct mh_place *place, mh_q20 value)
{
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        struct mh_prince_row *row = &p->rows[i];
        if (row->state == MH_PRINCE_HEAD &&
            mh_q20_to_real(value) <= mh_mul(EXPLAINED, explained_by(p, row, place, mh_prince_drift(p, row)))) {
            mh_prince_remind(p, row);
        }
    }
}

bool mh_prince_is_known(const struct mh_prince *p, const struct mh_place *place)
{
    bool known = false;
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        const struct mh_prince_row *row = &p->rows[i];
        if (row->state != MH_PRINCE_FREE && row->fixed) {
            known = known || explained_by(p, row, place, mh_prince_drift(p, row)) >= MH_REAL(1.0f);
        }
    }
    return known;
}

/* The target may be within range, by where it was. */
static bool is_in_time(const struct mh_prince *p, const struct mh_prince_row *row)
{
    const mh_real speed_mps = mh_prince_speed(row);
    const mh_tick slack =
        (mh_tick)mh_real_times(mh_div(MH_REAL(SLACK_M * 1000.0f), mh_max(speed_mps, MH_REAL(1.0f))), 1);
    return !mh_tick_before(p->time, row->in - slack) && !mh_tick_before(row->out + slack, p->time);
}

bool mh_prince_hears(const struct mh_prince *p, const struct mh_prince_row *row)
{
    uint8_t others;
    mh_real share;
    const mh_real energy = mh_q20_to_real(p->value), own = mh_prince_energy(p, row, &share, &others);
    if (!row->fixed) {
        return is_unexplained(p);
    }
    if (energy < MH_REAL(1.0f) || others == 0) {
        return energy >= MH_REAL(1.0f);
    }
    switch (row->as) {
    case MH_NODE_COMPETITOR:
        return share >= MH_PRINCE_SHARE && energy > mh_mul(EXPLAINED, explained_by_others(p, row));
    case MH_NODE_OUTER:
        return own >= MH_REAL(1.0f) && energy > mh_mul(EXPLAINED, explained_by_others(p, row));
    default:
        return own >= MH_REAL(1.0f) && is_in_time(p, row);
    }
}

/* Watch for at least `ticks` from now. */
static void stay(struct mh_prince *p, struct mh_prince_row *row, mh_tick ticks)
{
    mh_tick until = p->time + ticks;
    if (row->state == MH_PRINCE_WATCH && mh_prince_is_set(row, MH_PRINCE_QUIET) &&
        mh_tick_before(until, row->due[MH_PRINCE_QUIET])) {
        until = row->due[MH_PRINCE_QUIET];
    }
    row->state = MH_PRINCE_WATCH;
    mh_prince_set(row, MH_PRINCE_QUIET, until);
    mh_prince_set(row, MH_PRINCE_FORGET, until + KEPT);
}

void mh_prince_become_competitor(struct mh_prince *p, struct mh_prince_row *row, mh_tick ticks)
{
    stay(p, row, ticks);
    row->as = MH_NODE_COMPETITOR;
    row->is_prince = row->is_passive = false;
    row->arms = p->time;
    mh_prince_clear(row, MH_PRINCE_DOG);
}

/* `seconds` after the fix, not past what a watcher waits for. */
static mh_tick after_fix(const struct mh_prince_row *row, mh_real seconds)
{
    const mh_real longest = MH_REAL(LONGEST_WATCH * 1e-3f);
    return row->found + (mh_tick)mh_real_times(mh_clamp(seconds, -longest, longest), 1000);
}

/* When the target passes within `radius_m`, or where it never is so near, is nearest. */
static void set_passage(const struct mh_prince *p, struct mh_prince_row *row, struct mh_vec2 node, mh_real radius_m)
{
    const struct mh_vec2 velocity = mh_prince_velocity(row);
    const mh_wide square = mh_vec2_square(velocity);
    struct mh_time_window window;
    if (mh_time_window(node, velocity, radius_m, &window) == MH_OK) {
        row->in = after_fix(row, window.in);
        row->out = after_fix(row, window.out);
    } else if (square > 0) {
        row->in = row->out = after_fix(row, mh_wide_ratio(mh_vec2_dot(node, velocity), square));
    } else {
        row->in = p->time;
        row->out = p->time + UNKNOWN_WATCH;
    }
}

static void sleep_on(struct mh_prince *p, struct mh_prince_row *row)
{
    const bool gone = mh_tick_before(row->out, p->time);
    row->state = MH_PRINCE_SLEEP;
    row->is_prince = false;
    mh_prince_clear(row, MH_PRINCE_QUIET);
    mh_prince_set(row, MH_PRINCE_FORGET, (gone ? p->time : row->out) + KEPT);
}

void mh_prince_classify(struct mh_prince *p, struct mh_prince_row *row, struct mh_vec2 head, mh_tick arms)
{
    const struct mh_prince_config *config = p->config;
    const mh_real extent_m = mh_real_from_ratio(row->extent_cm, 100);
    const struct mh_strips strips = mh_strips(config->sensing_range_m, config->margin_m, config->outer_m, extent_m);
    const struct mh_place fix = {row->x_mm, row->y_mm, 0};
    const struct mh_vec2 node = mh_place_relative(&p->node->place, &fix);
    const struct mh_course course = {.head = head, .velocity = mh_prince_velocity(row)};
    enum mh_node_class as = mh_node_class(&strips, &course, node);
    row->is_prince = row->prince == p->node->id;
    row->arms = arms;
    if (row->is_prince) {
        as = MH_NODE_INNER;
    } else if (row->prince == MH_BROADCAST && (as == MH_NODE_INNER || as == MH_NODE_BORDER)) {
        as = MH_NODE_COMPETITOR;
    } else if (as == MH_NODE_INNER || as == MH_NODE_BORDER) {
        row->arms =
            row->enters + REGENT_WAIT + mh_prince_wait(p, REGENT_SPREAD) + (as == MH_NODE_BORDER ? BORDER_WAIT : 0);
    }
    row->as = (uint8_t)as;
    set_passage(p, row, node, as == MH_NODE_OUTER ? strips.outer_m : strips.border_m);
    if (as == MH_NODE_NONE) {
        sleep_on(p, row);
        return;
    }
    const int32_t left = mh_ticks_between(p->time, row->out + AFTER_OUT);
    row->state = MH_PRINCE_SLEEP; /* what was to be watched before does not matter any more */
    stay(p, row, left > LEAST_WATCH ? (mh_tick)left : LEAST_WATCH);
}

static void watch_row(struct mh_prince *p, struct mh_prince_row *row)
{
    const struct mh_prince_config *config = p->config;
    const bool queried = p->time - row->queried < mh_prince_window(p, row) + QUERY_REST;
    if (row->act != MH_PRINCE_ACT_NONE || row->wants != 0 || row->is_passive || queried ||
        mh_tick_before(p->time, row->hold) || !mh_prince_hears(p, row)) {
        return;
    }
    const bool armed = !mh_tick_before(p->time, row->arms);
    if (row->is_prince) {
        mh_prince_ask(p, row, MH_LOCATE_PRINCE);
    } else if (row->as == MH_NODE_OUTER) {
        if ((config->guards & MH_PRINCE_EXCEPTION) && mh_prince_energy(p, row, NULL, NULL) >= config->exception) {
            row->kind = MH_LOCATE_EXCEPTION;
            mh_prince_plan(p, row, MH_PRINCE_ACT_LOCATE, mh_prince_wait(p, OTHERS_WAIT));
        }
    } else if (armed && row->as == MH_NODE_COMPETITOR) {
        mh_prince_contend(p, row);
    } else if (armed && (config->guards & MH_PRINCE_REGENT)) {
        row->kind = MH_LOCATE_REGENT;
        mh_prince_plan(p, row, MH_PRINCE_ACT_LOCATE, mh_prince_wait(p, OTHERS_WAIT));
    }
}

void mh_prince_watch(struct mh_prince *p)
{
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        if (p->rows[i].state == MH_PRINCE_WATCH) {
            watch_row(p, &p->rows[i]);
        }
    }
}

void mh_prince_quiet(struct mh_prince *p, struct mh_prince_row *row)
{
    if (row->state != MH_PRINCE_WATCH && row->state != MH_PRINCE_HEAD) {
        return;
    }
    if (row->state == MH_PRINCE_WATCH && (p->config->guards & MH_PRINCE_RELAY) && row->fixed && p->heard &&
        mh_prince_hears(p, row)) { /* perhaps nobody else knows of it */
        mh_prince_become_competitor(p, row, LINGERING);
        return;
    }
    p->counters.lost += row->fixed && row->head == p->node->id;
    mh_prince_calm(row);
    if (row->fixed) {
        sleep_on(p, row);
    } else {
        mh_prince_drop(p, row);
    }
}
