#include "prince_node.h"
#include "timers.h"

#include "motehound/spread.h"

#include <string.h>

#define HELLOS_AT_START 3
#define ENTRY_TIME 30000 /* ticks for which an entry is watched */
#define NEW_TIME 10000   /* ... and a target that is not yet named */
#define SAMPLE_OFF 5     /* ticks that a sample may be off the time for which it was wanted */
#define OLDEST 30000     /* ticks, of what a message tells of */

/* ---- timers ---- */

void mh_prince_set(struct mh_prince_row *row, enum mh_prince_timer timer, mh_tick time)
{
    uint16_t set = row->set;
    mh_timers_set(&set, row->due, timer, time);
    row->set = (uint8_t)set;
}

void mh_prince_clear(struct mh_prince_row *row, enum mh_prince_timer timer)
{
    row->set = (uint8_t)(row->set & ~(1u << timer));
}

bool mh_prince_is_set(const struct mh_prince_row *row, enum mh_prince_timer timer)
{
    return mh_timers_is_set(row->set, timer);
}

void mh_prince_plan(struct mh_prince *p, struct mh_prince_row *row, enum mh_prince_act act, mh_tick wait)
{
    row->act = (uint8_t)act;
    mh_prince_set(row, MH_PRINCE_ACT, p->time + wait);
}

void mh_prince_calm(struct mh_prince_row *row)
{
    row->wants = 0;
    row->tried = false;
    if (row->act != MH_PRINCE_ACT_RELEASE) { /* which is due whatever comes */
        row->act = MH_PRINCE_ACT_NONE;
        mh_prince_clear(row, MH_PRINCE_ACT);
    }
    mh_prince_clear(row, MH_PRINCE_REPLY);
    mh_prince_clear(row, MH_PRINCE_CLOSE);
}

mh_tick mh_prince_wait(struct mh_prince *p, mh_tick limit) { return mh_random_below(&p->random, (uint16_t)limit); }

/* ---- what all know ---- */

int16_t mh_prince_ahead(uint16_t a, uint16_t b)
{
    const uint16_t ahead = (uint16_t)(a - b);
    return ahead > INT16_MAX ? (int16_t)((int32_t)ahead - 65536) : (int16_t)ahead;
}

bool mh_prince_is_fresh(struct mh_prince *p, mh_tick time)
{
    const int32_t age = mh_ticks_between(time, p->time);
    const bool fresh = age <= OLDEST && age >= -(int32_t)MH_PRINCE_SECOND;
    p->counters.refused += !fresh;
    return fresh;
}

bool mh_prince_is_first(mh_tick a_time, mh_node_id a_id, mh_tick b_time, mh_node_id b_id)
{
    return a_time != b_time ? mh_tick_before(a_time, b_time) : a_id < b_id;
}

void mh_prince_send(struct mh_prince *p, const struct mh_message *message)
{
    p->on_way = (uint8_t)(p->on_way + (p->on_way < UINT8_MAX));
    p->node->port->send(p->node->context, MH_BROADCAST, message);
}

/* ---- the table ---- */

uint8_t mh_prince_number(const struct mh_prince *p, const struct mh_prince_row *row)
{
    return (uint8_t)(row - p->rows);
}

struct mh_prince_row *mh_prince_find(struct mh_prince *p, uint32_t target)
{
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        if (p->rows[i].state != MH_PRINCE_FREE && p->rows[i].target == target) {
            return &p->rows[i];
        }
    }
    return NULL;
}

void mh_prince_drop(struct mh_prince *p, struct mh_prince_row *row)
{
    mh_prince_discard(p, row);
    memset(row, 0, sizeof *row);
}

/* Row a gives way rather than b. Free ones first, then those asleep, and of equals the one whose target is out of range first. */
static bool gives_way(const struct mh_prince_row *a, const struct mh_prince_row *b)
{
    return a->state != b->state ? a->state < b->state : mh_tick_before(a->out, b->out);
}

static struct mh_prince_row *make(struct mh_prince *p, uint32_t target, bool watched, mh_tick out)
{
    const struct mh_prince_row newcomer = {.target = target,
                                           .state = watched ? MH_PRINCE_WATCH : MH_PRINCE_SLEEP,
                                           .members = 1,
                                           .head = MH_BROADCAST,
                                           .prince = MH_BROADCAST,
                                           .in = p->time,
                                           .out = out,
                                           .arms = p->time,
                                           .hold = p->time,
                                           .queried = p->time - NEW_TIME,
                                           .kind = MH_LOCATE_COMPETITION};
    struct mh_prince_row *first = &p->rows[0];
    for (uint8_t i = 1; i < MH_TARGETS_MAX; i++) {
        if (gives_way(&p->rows[i], first)) {
            first = &p->rows[i];
        }
    }
    if (first->state != MH_PRINCE_FREE) {
        p->counters.evicted++;
        if (first->state > MH_PRINCE_WATCH || !gives_way(first, &newcomer)) {
            return NULL;
        }
        mh_prince_drop(p, first);
    }
    *first = newcomer;
    first->state = MH_PRINCE_SLEEP;
    return first;
}

struct mh_prince_row *mh_prince_find_or_make(struct mh_prince *p, uint32_t target, bool watched, mh_tick out)
{
    struct mh_prince_row *row = mh_prince_find(p, target);
    return row ? row : make(p, target, watched, out);
}

static void forget(struct mh_prince *p, struct mh_prince_row *row) { mh_prince_drop(p, row); }

/* ---- samples ---- */

static void serve(struct mh_prince *p)
{
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        struct mh_prince_row *row = &p->rows[i];
        const uint8_t wants = row->wants;
        row->wants = 0;
        if (wants & MH_PRINCE_WANTS_QUERY) {
            mh_prince_query(p, row);
        }
        if (wants & MH_PRINCE_WANTS_REPLY) {
            mh_prince_prepare_reply(p, row);
        }
        if (wants & MH_PRINCE_WANTS_CONTEND) {
            mh_prince_contend(p, row);
        }
        if (wants & MH_PRINCE_WANTS_OWN) {
            mh_prince_take_own(p, row);
        }
    }
}

static void sense(struct mh_prince *p)
{
    if (!p->sampling || p->sampled != p->time) {
        p->sampling = true;
        p->heard = false;
        p->sampled = p->time;
        p->node->port->sense(p->node->context, p->now, p->time);
    }
}

void mh_prince_sample(struct mh_prince *p, struct mh_prince_row *row, uint8_t wants)
{
    row->wants |= wants;
    if (p->heard && p->sampled == p->time) {
        serve(p);
    } else {
        sense(p);
    }
}

/* ---- who samples, and when ---- */

static bool is_entered(const struct mh_prince *p, const struct mh_prince_entry *entry)
{
    const uint32_t range_mm = (uint32_t)mh_real_times(p->config->radio_range_m, 1000);
    return mh_place_within(&p->node->place, &entry->place, range_mm);
}

/* New targets are looked for here. If not, they are from *next on, if any are. */
static bool searches(const struct mh_prince *p, bool *later, mh_tick *next)
{
    *later = false;
    for (uint8_t i = 0; i < p->config->entry_count; i++) {
        const struct mh_prince_entry *entry = &p->config->entries[i];
        const int32_t since = mh_ticks_between(entry->time, p->time);
        if (since >= ENTRY_TIME || !is_entered(p, entry)) {
            continue;
        }
        if (since >= 0) {
            return true;
        }
        if (!*later || mh_tick_before(entry->time, *next)) {
            *next = entry->time;
            *later = true;
        }
    }
    return false;
}

/* Who does not watch looks for new targets at an instant of its own in each watch period -> the first of these after `time`. */
static mh_tick own_instant(const struct mh_prince *p, mh_tick time)
{
    const mh_tick tick = p->config->tick, turns = p->config->watch_period / tick;
    return mh_tick_aligned(mh_spread(p->node->id, 0, turns) * tick, turns * tick, time + 1);
}

/* A target that is not yet named. */
static struct mh_prince_row *begin_new(struct mh_prince *p)
{
    struct mh_prince_row *row = mh_prince_find_or_make(p, 0, true, p->time + NEW_TIME);
    if (row) {
        mh_prince_become_competitor(p, row, NEW_TIME);
    }
    return row;
}

struct mh_prince_row *mh_prince_find_new(struct mh_prince *p)
{
    struct mh_prince_row *row = NULL;
    bool later;
    mh_tick next;
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        if (p->rows[i].state != MH_PRINCE_FREE && !p->rows[i].fixed) {
            row = &p->rows[i];
        }
    }
    if (!row && searches(p, &later, &next)) {
        row = begin_new(p);
    }
    return row;
}

/* Whoever looks for new targets now, and hears one that no row explains. */
static void find(struct mh_prince *p)
{
    bool later;
    mh_tick next;
    const bool looks =
        searches(p, &later, &next) || (p->config->watch_period > 0 && own_instant(p, p->sampled - 1) == p->sampled);
    if (looks && mh_prince_is_new(p)) {
        (void)begin_new(p);
    }
}

static bool watches(const struct mh_prince *p)
{
    bool any = false;
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        any = any || p->rows[i].state == MH_PRINCE_WATCH;
    }
    return any;
}

static bool is_idle(const struct mh_prince *p)
{
    bool idle = true;
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        idle = idle && p->rows[i].state <= MH_PRINCE_SLEEP;
    }
    return idle;
}

/* When the next tick is for this node -> *next. Returns false if there is none. */
static bool next_tick(const struct mh_prince *p, mh_tick *next)
{
    const mh_tick tick = p->config->tick;
    mh_tick entry;
    bool later;
    if (watches(p) || searches(p, &later, &entry)) {
        *next = mh_tick_aligned(0, tick, p->time + 1);
        return true;
    }
    bool any = false;
    if (p->config->watch_period > 0) {
        *next = own_instant(p, p->time);
        any = true;
    }
    if (later && (!any || mh_tick_before(entry, *next))) {
        *next = entry;
        any = true;
    }
    return any;
}

static void arm(struct mh_prince *p)
{
    mh_tick next = p->hello, time;
    p->ticks = next_tick(p, &p->tick);
    if (p->ticks && mh_tick_before(p->tick, next)) {
        next = p->tick;
    }
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        if (mh_timers_earliest(p->rows[i].set, p->rows[i].due, MH_PRINCE_TIMERS, &time) && mh_tick_before(time, next)) {
            next = time;
        }
    }
    const mh_tick started = p->began + MH_PRINCE_START;
    const bool starts = p->time - p->began < MH_PRINCE_START;
    if (starts && mh_tick_before(started, next)) {
        next = started;
    }
    bool later;
    const bool needed = p->config->wake_period == 0 || starts || !is_idle(p) || searches(p, &later, &time);
    p->node->port->set_timer(p->node->context, p->node->port->own(p->node->context, next));
    p->node->port->listen(p->node->context, needed);
}

/* ---- neighbours ---- */

static void say_hello(struct mh_prince *p)
{
    const struct mh_message message = {.kind = MH_MESSAGE_HELLO,
                                       .as.hello = {.sender = (int32_t)p->node->id,
                                                    .x_mm = p->node->place.x_mm,
                                                    .y_mm = p->node->place.y_mm,
                                                    .sequence = (int16_t)p->hellos}};
    const mh_tick part = MH_PRINCE_START / HELLOS_AT_START, period = p->config->hello_period;
    mh_prince_send(p, &message);
    mh_neighbours_age(&p->neighbours, p->now);
    p->hellos = (uint16_t)(p->hellos < UINT16_MAX ? p->hellos + 1 : UINT8_MAX + 1);
    p->hello =
        p->hellos < HELLOS_AT_START
            ? p->began + part * p->hellos + mh_spread(p->node->id, p->hellos, part)
            : mh_rendezvous_next(&p->rendezvous, p->time + period - mh_spread(p->node->id, p->hellos, period / 4));
}

/* ---- the table of functions ---- */

void mh_prince_config_default(struct mh_prince_config *config, enum mh_prince_election election, bool guarded,
                              mh_real sensing_range_m, mh_real radio_range_m)
{
    const mh_real margin_m = mh_mul(MH_REAL(0.2f), sensing_range_m);
    const struct mh_prince_config nominal = {
        .election = election,
        .guards = guarded ? MH_PRINCE_ALL : MH_PRINCE_EXCEPTION,
        .replies = 2,
        .sensing_range_m = sensing_range_m,
        .radio_range_m = radio_range_m,
        .margin_m = margin_m,
        .outer_m = guarded ? 2 * sensing_range_m : sensing_range_m + margin_m,
        .exception = guarded ? mh_squared(mh_div(sensing_range_m, sensing_range_m - margin_m)) : MH_REAL(1.0f),
        .loudness_m2 = mh_squared(sensing_range_m),
        .step_m = mh_mul(MH_REAL(1.5f), sensing_range_m),
        .tick = 250,
        .window = 300,
        .contest = 350,
        .hello_period = 300000,
    };
    *config = nominal;
}

static bool sound(const struct mh_prince_config *config)
{
    const struct mh_prince_port *port = config->port;
    const mh_real one = MH_REAL(1.0f);
    bool sound =
        port && port->localise && port->expect && port->join && port->part && config->election <= MH_PRINCE_TIMESTAMP &&
        config->guards <= MH_PRINCE_ALL && config->replies >= 2 && config->replies <= 100 &&
        mh_within(config->sensing_range_m, one, MH_REAL(1000.0f)) && config->radio_range_m > config->sensing_range_m &&
        config->radio_range_m <= MH_REAL(10000.0f) && mh_within(config->margin_m, 0, config->sensing_range_m) &&
        mh_within(config->outer_m, config->sensing_range_m, 10 * config->sensing_range_m) &&
        mh_within(config->exception, one, MH_REAL(100.0f)) && mh_within(config->loudness_m2, one, MH_REAL_UPTO(1e8f)) &&
        mh_within(config->step_m, one, MH_REAL(10000.0f)) && config->tick >= 20 && config->tick <= 60000u &&
        config->window >= 20 && config->window <= 10000 && config->contest >= 1 && config->contest <= 10000 &&
        (config->watch_period == 0 || config->watch_period >= config->tick) && config->watch_period <= 3600000u &&
        config->wake_period <= 900000u &&
        (config->wake_period == 0 || (config->wake_length >= 4 && config->wake_length < config->wake_period)) &&
        config->hello_period >= 10000 && config->hello_period <= 1000000u &&
        (config->entries || config->entry_count == 0);
    for (uint8_t i = 0; sound && i < config->entry_count; i++) {
        sound =
            mh_coordinate_valid(config->entries[i].place.x_mm) && mh_coordinate_valid(config->entries[i].place.y_mm);
    }
    return sound;
}

static enum mh_status init(void *state, const void *config, const struct mh_protocol_node *node)
{
    struct mh_prince *p = state;
    const struct mh_prince_config *chosen = config;
    if (!p || !chosen || !node || !sound(chosen)) {
        return MH_ERR_ARGUMENT;
    }
    memset(p, 0, sizeof *p);
    p->config = chosen;
    p->node = node;
    const struct mh_rendezvous rendezvous = {chosen->wake_period, chosen->wake_length, chosen->wake_period};
    p->rendezvous = rendezvous;
    return mh_neighbours_init(&p->neighbours, node->id, &node->place, MH_NEIGHBOURS_MAX, chosen->hello_period / 2 * 7);
}

/* The network's time is known. */
static void begin(struct mh_prince *p)
{
    p->running = true;
    p->began = p->time;
    p->hellos = 0;
    p->founded = (uint8_t)(p->time / MH_PRINCE_SECOND); /* after a restart the identifiers are others than before */
    p->hello = p->time + mh_spread(p->node->id, 0, MH_PRINCE_START / HELLOS_AT_START);
    mh_random_init(&p->random, p->node->id * 0x9E3779B1u ^ p->time);
}

/* What is the time? Returns false if nothing can be done, since it is not known. */
static bool comes(struct mh_prince *p, mh_tick now)
{
    p->now = now;
    return p->running && p->node->port->network(p->node->context, now, &p->time);
}

static void time_jumped(void *state, mh_tick now)
{
    struct mh_prince *p = state;
    p->now = now;
    memset(p->rows, 0, sizeof p->rows);
    p->reply_count = 0;
    p->sampling = p->ticking = p->heard = false;
    if (p->node->port->network(p->node->context, now, &p->time)) {
        begin(p);
        arm(p);
    }
}

static void start(void *state, mh_tick now) { time_jumped(state, now); }

static void message(void *state, mh_tick now, const struct mh_message *heard)
{
    struct mh_prince *p = state;
    if (heard->envelope != MH_ENVELOPE_NONE) {
        return;
    }
    if (heard->kind == MH_MESSAGE_HELLO) {
        (void)mh_neighbours_hello(&p->neighbours, now, &heard->as.hello);
        return;
    }
    if (!comes(p, now)) {
        return;
    }
    switch (heard->kind) {
    case MH_MESSAGE_AWAKE:
        mh_prince_hear_awake(p, &heard->as.awake);
        break;
    case MH_MESSAGE_REST:
        mh_prince_hear_rest(p, &heard->as.rest);
        break;
    case MH_MESSAGE_LOCATE:
        mh_prince_hear_locate(p, &heard->as.locate);
        break;
    case MH_MESSAGE_SOUND:
        mh_prince_hear_sound(p, &heard->as.sound);
        break;
    case MH_MESSAGE_FAIL:
        mh_prince_hear_fail(p, &heard->as.fail);
        break;
    case MH_MESSAGE_SUCCEED:
        mh_prince_hear_succeed(p, &heard->as.succeed);
        break;
    case MH_MESSAGE_COMPETE:
        mh_prince_hear_compete(p, &heard->as.compete);
        break;
    case MH_MESSAGE_DETECTION:
        mh_prince_hear_detection(p, &heard->as.detection);
        break;
    case MH_MESSAGE_SUPPRESS:
        mh_prince_hear_suppress(p, &heard->as.suppress);
        break;
    case MH_MESSAGE_MERGE:
        mh_prince_hear_merge(p, &heard->as.merge);
        break;
    default:
        break;
    }
    arm(p);
}

static void act(struct mh_prince *p, struct mh_prince_row *row)
{
    const enum mh_prince_act act = (enum mh_prince_act)row->act;
    row->act = MH_PRINCE_ACT_NONE;
    switch (act) {
    case MH_PRINCE_ACT_LOCATE:
        mh_prince_ask(p, row, (enum mh_locate)row->kind);
        break;
    case MH_PRINCE_ACT_CONTEND:
        mh_prince_say_compete(p, row);
        break;
    case MH_PRINCE_ACT_DECIDE:
        mh_prince_decide(p, row);
        break;
    case MH_PRINCE_ACT_RELEASE:
        mh_prince_release(p, row);
        break;
    default:
        break;
    }
}

static void (*const at[MH_PRINCE_TIMERS])(struct mh_prince *p, struct mh_prince_row *row) = {
    [MH_PRINCE_ACT] = act,
    [MH_PRINCE_REPLY] = mh_prince_reply,
    [MH_PRINCE_CLOSE] = mh_prince_close,
    [MH_PRINCE_DOG] = mh_prince_bark,
    [MH_PRINCE_ANNOUNCE] = mh_prince_say_again,
    [MH_PRINCE_QUIET] = mh_prince_quiet,
    [MH_PRINCE_FORGET] = forget,
};

static void ring(struct mh_prince *p, struct mh_prince_row *row)
{
    for (unsigned timer = 0; timer < MH_PRINCE_TIMERS; timer++) {
        uint16_t set = row->set;
        if (row->state != MH_PRINCE_FREE && mh_timers_take(&set, row->due, timer, p->time)) {
            row->set = (uint8_t)set;
            at[timer](p, row);
        }
    }
}

static void timer(void *state, mh_tick now)
{
    struct mh_prince *p = state;
    if (!comes(p, now)) {
        return;
    }
    if (!mh_tick_before(p->time, p->hello)) {
        say_hello(p);
    }
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        ring(p, &p->rows[i]);
    }
    if (p->ticks && !mh_tick_before(p->time, p->tick)) {
        p->ticking = true;
        sense(p);
    }
    arm(p);
}

static enum mh_status publish(void *state, mh_tick now, const struct mh_measurement *measurement)
{
    struct mh_prince *p = state;
    const int32_t off = mh_ticks_between(p->sampled, measurement->time);
    if (!comes(p, now) || !p->sampling || off > SAMPLE_OFF || off < -SAMPLE_OFF) {
        return MH_OK;
    }
    const bool ticking = p->ticking;
    p->value = measurement->value;
    p->heard = true;
    p->sampling = p->ticking = false;
    serve(p);
    if (ticking) {
        find(p);
    }
    /* who wants a sample of now has it: to ask for it would hand it over once more, during this call */
    p->sampled = measurement->time;
    if (ticking) {
        mh_prince_watch(p);
    }
    arm(p);
    return MH_OK;
}

/* The locator samples when its locate_t is out, as those do who hear it. */
static void sent(void *state, mh_tick now, enum mh_sent outcome)
{
    struct mh_prince *p = state;
    (void)outcome;
    p->on_way = (uint8_t)(p->on_way - (p->on_way > 0));
    if (!comes(p, now)) {
        return;
    }
    for (uint8_t i = 0; i < MH_TARGETS_MAX; i++) {
        struct mh_prince_row *row = &p->rows[i];
        if (row->state == MH_PRINCE_LOCATE && row->unsent > 0 && --row->unsent == 0) {
            mh_prince_sample(p, row, MH_PRINCE_WANTS_OWN);
        }
    }
    arm(p);
}

static void count(const void *state, struct mh_protocol_counters *counters)
{
    const struct mh_prince *p = state;
    const uint32_t *from = (const uint32_t *)&p->counters;
    uint32_t *to = (uint32_t *)&counters->princes;
    for (size_t i = 0; i < sizeof p->counters / sizeof *from; i++) {
        to[i] += from[i];
    }
}

static mh_wire_types types[] = {&mh_wire_hello,     &mh_wire_awake,    &mh_wire_rest,    &mh_wire_locate,
                                &mh_wire_sound,     &mh_wire_fail,     &mh_wire_succeed, &mh_wire_compete,
                                &mh_wire_detection, &mh_wire_suppress, &mh_wire_merge,   NULL};

const struct mh_protocol mh_protocol_prince = {
    .name = "prince",
    .state_size = sizeof(struct mh_prince),
    .config_size = sizeof(struct mh_prince_config),
    .types = types,
    .in_turns = true,
    .init = init,
    .start = start,
    .message = message,
    .sent = sent,
    .timer = timer,
    .publish = publish,
    .time_jumped = time_jumped,
    .count = count,
};
