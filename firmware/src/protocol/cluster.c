#include "cluster_node.h"
#include "timers.h"

#include "motehound/geographic.h"
#include "motehound/spread.h"

#include <string.h>

#define HELLOS_AT_START 3
#define WELCOME_WINDOWS 16        /* over so many windows the neighbours of a newcomer spread their hellos */
#define WELCOME_PAUSE 10000       /* ticks: nobody says hello to newcomers more often */
#define MEMORY ((int32_t)1 << 30) /* ticks: what is known of a track is kept so long */

/* ---- timers ---- */

void mh_cluster_set(struct mh_cluster_node *c, enum mh_cluster_timer timer, mh_tick time)
{
    mh_timers_set(&c->set, c->due, timer, time);
}

void mh_cluster_clear(struct mh_cluster_node *c, enum mh_cluster_timer timer) { mh_timers_clear(&c->set, timer); }

bool mh_cluster_is_set(const struct mh_cluster_node *c, enum mh_cluster_timer timer)
{
    return mh_timers_is_set(c->set, timer);
}

void mh_cluster_listen(struct mh_cluster_node *c, mh_tick until)
{
    if (!c->listening || mh_tick_before(c->due[MH_CLUSTER_QUIET], until)) {
        mh_cluster_set(c, MH_CLUSTER_QUIET, until);
    }
    c->listening = true;
}

void mh_cluster_quiet(struct mh_cluster_node *c)
{
    if (c->time - c->began >= MH_CLUSTER_START) {
        c->listening = false;
        mh_cluster_clear(c, MH_CLUSTER_QUIET);
    }
}

mh_tick mh_cluster_window(const struct mh_cluster_node *c, uint8_t windows)
{
    const mh_tick begin = mh_rendezvous_after(&c->rendezvous, c->time, windows);
    return begin + mh_spread(c->node->id, begin, c->config->wake_length / 4 + 1);
}

void mh_cluster_plan(struct mh_cluster_node *c)
{
    const mh_tick interval = c->config->election.interval, next = c->time + 1;
    if (c->role != MH_CLUSTER_SLEEPER || mh_tick_before(c->time, c->search_until)) {
        c->instant = mh_tick_aligned(0, interval, next);
    } else {
        const mh_tick turns = c->config->watch_period / interval;
        c->instant = mh_tick_aligned(mh_spread(c->node->id, 0, turns) * interval, turns * interval, next);
    }
    /* who asks waits for the others' windows to have opened by their own clocks */
    const bool waits = c->role == MH_CLUSTER_HEAD && c->config->wake_period > 0;
    mh_cluster_set(c, MH_CLUSTER_INSTANT, c->instant + waits);
}

/* What is waiting to be sent goes in the next window. */
static bool next_sending(const struct mh_cluster_node *c, mh_tick *time)
{
    mh_tick retry, from = c->time;
    if (c->link.count == 0 || c->link.in_air) {
        return false;
    }
    if (mh_link_alarm(&c->link, &retry) && c->node->port->network(c->node->context, retry, &retry) &&
        mh_tick_before(from, retry)) {
        from = retry;
    }
    *time = mh_rendezvous_next(&c->rendezvous, from);
    if (*time != from) {
        *time += mh_spread(c->node->id, *time, c->config->wake_length / 4 + 1);
    }
    return true;
}

static void arm(struct mh_cluster_node *c)
{
    mh_tick next = c->time, sending;
    bool wanted = mh_timers_earliest(c->set, c->due, MH_CLUSTER_TIMERS, &next);
    if (next_sending(c, &sending) && (!wanted || mh_tick_before(sending, next))) {
        next = sending;
        wanted = true;
    }
    if (wanted) {
        c->node->port->set_timer(c->node->context, c->node->port->own(c->node->context, next));
    }
    c->node->port->listen(c->node->context, c->listening || c->role == MH_CLUSTER_SINK || c->config->wake_period == 0);
}

/* ---- what all know ---- */

void mh_cluster_note(uint16_t *events) { *events = (uint16_t)(*events + (*events < UINT16_MAX)); }

bool mh_cluster_outranks(const struct mh_cluster_of *a, const struct mh_cluster_of *b)
{
    const int32_t ahead = (int32_t)((uint32_t)a->generation - (uint32_t)b->generation);
    return ahead != 0 ? ahead > 0 : a->head < b->head;
}

struct mh_place mh_cluster_expected(const struct mh_cluster_of *of, mh_tick time)
{
    const struct mh_place from = {of->x_mm, of->y_mm, 0};
#if MH_REAL_FIXED /* a thousandth of a second more or less is as much as 16 fractional bits tell of the scale below */
    const mh_real seconds = mh_seconds_between(of->time, time);
    const struct mh_vec2 moved = {mh_mul(mh_real_from_ratio(of->vx_mmps, 1000), seconds),
                                  mh_mul(mh_real_from_ratio(of->vy_mmps, 1000), seconds)};
#else
    const mh_real scale = mh_seconds_between(of->time, time) * 1e-3f;
    const struct mh_vec2 moved = {(mh_real)of->vx_mmps * scale, (mh_real)of->vy_mmps * scale};
#endif
    return mh_place_from_offset(&from, moved);
}

int16_t mh_cluster_number(struct mh_cluster_node *c) { return (int16_t)c->sequence++; }

/* ---- messages in envelopes ---- */

static void take_in(struct mh_cluster_node *c, const struct mh_message *message)
{
    if (message->kind == MH_MESSAGE_HAND_OVER) {
        mh_cluster_hear_part(c, (mh_node_id)message->header.route.origin, &message->as.hand_over);
    } else if (message->kind == MH_MESSAGE_POSITION) {
        mh_cluster_hear_position(c, &message->as.position);
    }
}

static bool is_of_present_offer(const struct mh_cluster_node *c, const struct mh_message *message)
{
    return c->handing && message->as.hand_over.generation == c->next_generation &&
           message->header.route.destination == (int32_t)c->next.head.id;
}

/* A track goes to the next head itself, or not at all. Returns false if the message has left the queue. */
static bool send_part(struct mh_cluster_node *c, const struct mh_message *part)
{
    if (!is_of_present_offer(c, part)) {
        mh_link_finish(&c->link);
        return false;
    }
    mh_link_send(&c->link, c->next.head.id, part->envelope, &part->header);
    return true;
}

static void send_on(struct mh_cluster_node *c, const struct mh_message *message)
{
    const enum mh_hop hop = mh_geographic_send(&c->link, &c->neighbours, c->config->faces, message);
    if (hop == MH_HOP_ARRIVED) {
        mh_cluster_hear_position(c, &message->as.position); /* tracks are not sent on */
        mh_link_finish(&c->link);
    } else if (hop != MH_HOP_NEXT) {
        mh_link_drop(&c->link, mh_geographic_loss(hop));
    }
}

/* Send what is due, in windows. Whatever does not go on the air leaves the queue, so this ends. */
static void pump(struct mh_cluster_node *c)
{
    const struct mh_message *due;
    while (mh_rendezvous_open(&c->rendezvous, c->time) && (due = mh_link_due(&c->link, c->now)) != NULL) {
        if (due->kind == MH_MESSAGE_HAND_OVER) {
            (void)send_part(c, due);
        } else {
            send_on(c, due);
        }
    }
}

static void hear_envelope(struct mh_cluster_node *c, const struct mh_message *heard)
{
    if (heard->header.route.destination == (int32_t)c->node->id) {
        if (mh_link_arrive(&c->link, heard) == MH_OK) {
            take_in(c, heard);
        }
    } else if (heard->kind == MH_MESSAGE_POSITION) {
        (void)mh_link_take(&c->link, heard); /* counts what it refuses */
    }
}

/* ---- neighbours ---- */

/* Before the differences of times lose their meaning, after 24.8 days. */
static void forget(struct mh_cluster_node *c)
{
    if (c->role != MH_CLUSTER_HEAD && mh_ticks_between(c->of.heard, c->time) > MEMORY) {
        c->knows = c->followed.known = false;
    }
    if (!mh_tick_before(c->time, c->search_until)) {
        c->search_until = c->time;
    }
    mh_shunned_age(&c->shunned, c->time);
}

static void hello_in_window(struct mh_cluster_node *c, mh_tick from, uint8_t windows)
{
    const mh_tick window = mh_rendezvous_after(&c->rendezvous, from, windows);
    mh_cluster_set(c, MH_CLUSTER_HELLO, window + mh_spread(c->node->id, c->hellos, c->config->wake_length / 2 + 1));
}

/* The last of the first hellos goes in a window: whoever has been here longer sleeps. */
static void say_hello(struct mh_cluster_node *c)
{
    const mh_tick period = c->config->hello_period, part = MH_CLUSTER_START / HELLOS_AT_START;
    mh_link_hello(&c->link, &c->hellos);
    mh_neighbours_age(&c->neighbours, c->now);
    forget(c);
    c->greeted = c->time;
    if (c->hellos < HELLOS_AT_START - 1) {
        mh_cluster_set(c, MH_CLUSTER_HELLO, c->began + part * c->hellos + mh_spread(c->node->id, c->hellos, part));
    } else if (c->hellos < HELLOS_AT_START) {
        hello_in_window(c, c->began + part * c->hellos + mh_spread(c->node->id, c->hellos, 2 * part), 0);
    } else {
        hello_in_window(c, c->time + period - mh_spread(c->node->id, c->hellos, period / 4), 0);
    }
}

/* Who has restarted knows nobody: says hello to it soon. Not while the network starts, when all say hello by themselves. */
static void welcome(struct mh_cluster_node *c, const mh_hello_t *hello)
{
    if ((uint16_t)hello->sequence >= HELLOS_AT_START || c->hellos < HELLOS_AT_START ||
        c->time - c->began < 2 * MH_CLUSTER_START) {
        return;
    }
    const mh_tick planned = c->due[MH_CLUSTER_HELLO], pause_ends = c->greeted + WELCOME_PAUSE;
    const mh_tick from = mh_tick_before(c->time, pause_ends) ? pause_ends : c->time;
    hello_in_window(c, from, (uint8_t)mh_spread(c->node->id, c->hellos, WELCOME_WINDOWS));
    if (mh_tick_before(planned, c->due[MH_CLUSTER_HELLO])) {
        mh_cluster_set(c, MH_CLUSTER_HELLO, planned);
    }
}

/* ---- the table ---- */

void mh_cluster_config_default(struct mh_cluster_config *config, enum mh_election rule, mh_node_id sink,
                               const struct mh_place *place)
{
    mh_election_config_default(&config->election, rule);
    mh_link_config_default(&config->link);
    config->sink = sink;
    config->sink_place = *place;
    config->wake_period = 250;
    config->wake_length = 10;
    config->window = 150;
    config->watch_period = 10000;
    config->hello_period = 300000;
    config->faces = true;
}

static bool sound(const struct mh_cluster_config *config)
{
    const mh_tick interval = config->election.interval;
    const bool wakes = config->wake_period > 0;
    return mh_election_check(&config->election) == MH_OK && interval >= 100 && config->sink != MH_BROADCAST &&
           mh_coordinate_valid(config->sink_place.x_mm) && mh_coordinate_valid(config->sink_place.y_mm) &&
           config->wake_period <= 900000u &&
           (!wakes || (config->wake_length >= 4 && config->wake_length < config->wake_period)) &&
           config->window >= 20 && config->window < interval && config->watch_period >= interval &&
           config->watch_period <= 3600000u && config->hello_period >= 10000 && config->hello_period <= 1000000u;
}

static enum mh_status init(void *state, const void *config, const struct mh_protocol_node *node)
{
    struct mh_cluster_node *c = state;
    const struct mh_cluster_config *chosen = config;
    if (!c || !chosen || !node || !sound(chosen)) {
        return MH_ERR_ARGUMENT;
    }
    memset(c, 0, sizeof *c);
    c->config = chosen;
    c->node = node;
    c->role = node->id == chosen->sink ? MH_CLUSTER_SINK : MH_CLUSTER_SLEEPER;
    const struct mh_rendezvous rendezvous = {chosen->wake_period, chosen->wake_length, chosen->election.interval};
    c->rendezvous = rendezvous;
    const enum mh_status status = mh_link_init(&c->link, &chosen->link, node);
    return status == MH_OK ? mh_neighbours_init(&c->neighbours, node->id, &node->place, MH_NEIGHBOURS_MAX,
                                                chosen->hello_period / 2 * 7)
                           : status;
}

/* The network's time is known. */
static void begin(struct mh_cluster_node *c)
{
    c->running = true;
    c->began = c->time;
    c->hellos = 0;
    c->sequence =
        (uint16_t)c->time; /* unlike the mote's own it goes on over a restart: the numbers are not those from before */
    c->search_until = c->time + 2 * c->config->election.interval;
    mh_neighbours_keep(&c->neighbours, c->config->sink);
    mh_cluster_set(c, MH_CLUSTER_HELLO, c->time + mh_spread(c->node->id, 0, MH_CLUSTER_START / HELLOS_AT_START));
    mh_cluster_listen(c, c->time + MH_CLUSTER_START);
    mh_cluster_plan(c);
}

/* What is the time? Returns false if nothing can be done, since it is not known. */
static bool comes(struct mh_cluster_node *c, mh_tick now)
{
    c->now = now;
    return c->running && c->node->port->network(c->node->context, now, &c->time);
}

static void done(struct mh_cluster_node *c)
{
    pump(c);
    arm(c);
}

static void time_jumped(void *state, mh_tick now)
{
    struct mh_cluster_node *c = state;
    c->now = now;
    if (c->role != MH_CLUSTER_SINK) {
        c->role = MH_CLUSTER_SLEEPER;
    }
    c->set = 0;
    c->knows = c->asked = c->handing = c->listening = c->incoming.parcel.begun = false;
    c->answer_ahead = c->shunned.count = c->shunned.next = 0;
    c->followed.known = false;
    if (c->node->port->network(c->node->context, now, &c->time)) {
        begin(c);
        done(c);
    }
}

static void start(void *state, mh_tick now) { time_jumped(state, now); }

static void message(void *state, mh_tick now, const struct mh_message *heard)
{
    struct mh_cluster_node *c = state;
    if (heard->kind == MH_MESSAGE_HELLO && heard->envelope == MH_ENVELOPE_NONE) {
        (void)mh_neighbours_hello(&c->neighbours, now, &heard->as.hello);
    }
    if (!comes(c, now)) {
        return;
    }
    if (heard->envelope != MH_ENVELOPE_NONE) {
        hear_envelope(c, heard);
    } else if (heard->kind == MH_MESSAGE_HELLO) {
        welcome(c, &heard->as.hello);
    } else if (heard->kind == MH_MESSAGE_ANSWER) {
        mh_cluster_hear_answer(c, &heard->as.answer);
    } else if (heard->kind == MH_MESSAGE_JOIN) {
        mh_cluster_hear_join(c, &heard->as.join);
    } else if (c->role != MH_CLUSTER_SINK) {
        switch (heard->kind) {
        case MH_MESSAGE_ASK:
            mh_cluster_hear_ask(c, &heard->as.ask);
            break;
        case MH_MESSAGE_FORM:
            mh_cluster_hear_form(c, &heard->as.form);
            break;
        case MH_MESSAGE_ALERT:
            mh_cluster_hear_alert(c, &heard->as.alert);
            break;
        default:
            break;
        }
    }
    done(c);
}

/* A track that one node cannot take is soon wanted elsewhere. */
static void part_sent(struct mh_cluster_node *c, enum mh_link_outcome found, uint8_t waiting)
{
    if (found == MH_LINK_TAKEN) {
        mh_cluster_part_taken(c);
    } else if (c->link.count < waiting || c->link.queue[c->link.first].attempts >= MH_CLUSTER_ATTEMPTS) {
        mh_cluster_part_refused(c);
    }
}

static void sent(void *state, mh_tick now, enum mh_sent outcome)
{
    struct mh_cluster_node *c = state;
    const mh_node_id to = c->link.to;
    const uint8_t waiting = c->link.count;
    const struct mh_message *first = &c->link.queue[c->link.first].message;
    const bool is_part = waiting > 0 && first->kind == MH_MESSAGE_HAND_OVER && is_of_present_offer(c, first);
    const enum mh_link_outcome found = mh_link_sent(&c->link, now, outcome);
    if (!comes(c, now)) {
        return;
    }
    if (found == MH_LINK_TAKEN || found == MH_LINK_LOST) {
        mh_neighbours_acked(&c->neighbours, to, found == MH_LINK_TAKEN);
    }
    if (found == MH_LINK_OTHER) {
        mh_cluster_answer_sent(c, outcome);
    } else if (is_part) {
        part_sent(c, found, waiting);
    }
    done(c);
}

static void (*const at[MH_CLUSTER_TIMERS])(struct mh_cluster_node *c) = {
    [MH_CLUSTER_HELLO] = say_hello,          [MH_CLUSTER_AGAIN] = mh_cluster_ask_again,
    [MH_CLUSTER_ANSWER] = mh_cluster_answer, [MH_CLUSTER_FORM] = mh_cluster_announce,
    [MH_CLUSTER_ALERT] = mh_cluster_alert,   [MH_CLUSTER_TAKE_OVER] = mh_cluster_take_over,
    [MH_CLUSTER_QUIET] = mh_cluster_missed,  [MH_CLUSTER_KEEP] = mh_cluster_keep,
    [MH_CLUSTER_INSTANT] = mh_cluster_watch,
};

static void timer(void *state, mh_tick now)
{
    struct mh_cluster_node *c = state;
    if (!comes(c, now)) {
        return;
    }
    for (unsigned k = 0; k < MH_CLUSTER_TIMERS; k++) {
        if (mh_timers_take(&c->set, c->due, k, c->time)) {
            at[k](c);
        }
    }
    done(c);
}

static enum mh_status publish(void *state, mh_tick now, const struct mh_measurement *measurement)
{
    struct mh_cluster_node *c = state;
    if (!comes(c, now)) {
        return MH_ERR_NO_ROUTE;
    }
    mh_cluster_sampled(c, measurement);
    arm(c);
    return MH_OK;
}

static void closed(void *state, mh_tick now, mh_tick instant, const struct mh_estimate *estimate,
                   const struct mh_measurement *measurements, size_t count)
{
    struct mh_cluster_node *c = state;
    if (comes(c, now) && c->role == MH_CLUSTER_HEAD) {
        mh_cluster_closed(c, instant, estimate, measurements, count);
        done(c);
    }
}

static void count(const void *state, struct mh_protocol_counters *counters)
{
    const struct mh_cluster_node *c = state;
    mh_link_count(&c->link, counters);
    counters->clusters.formed += c->counters.formed;
    counters->clusters.recoveries += c->counters.recoveries;
    counters->clusters.reports += c->counters.reports;
    counters->clusters.asked += c->counters.asked;
    counters->clusters.answered += c->counters.answered;
}

static mh_wire_types types[] = {
    &mh_wire_hello,    &mh_wire_ask,       &mh_wire_answer, &mh_wire_form, &mh_wire_join, &mh_wire_alert,
    &mh_wire_position, &mh_wire_hand_over, &mh_wire_route,  &mh_wire_face, NULL};

const struct mh_protocol mh_protocol_cluster = {
    .name = "cluster",
    .state_size = sizeof(struct mh_cluster_node),
    .config_size = sizeof(struct mh_cluster_config),
    .types = types,
    .in_turns = true,
    .init = init,
    .start = start,
    .message = message,
    .sent = sent,
    .timer = timer,
    .publish = publish,
    .closed = closed,
    .time_jumped = time_jumped,
    .count = count,
};
