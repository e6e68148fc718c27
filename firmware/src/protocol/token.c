#include "timers.h"
#include "token_node.h"

#include "motehound/geographic.h"
#include "motehound/spread.h"

#include <string.h>

#define HELLOS_AT_START                                                                                                \
    5 /* face routing needs two of each neighbour; where a tenth is lost, 1 pair in 2,000 lacks them */
#define WELCOME_SPREAD 4000       /* ticks: over so many the neighbours of a newcomer spread their hellos */
#define WELCOME_PAUSE 10000       /* ticks: nobody says hello to newcomers more often */
#define LIST_PAUSE 50             /* ticks between a hello and the neighbours told of, and between lists of these */
#define BELIEVED 3                /* instants for which a token counts without news */
#define MEMORY ((int32_t)1 << 30) /* ticks: before the differences of times lose their meaning */

/* ---- timers ---- */

void mh_token_set(struct mh_token_node *t, enum mh_token_timer timer, mh_tick time)
{
    mh_timers_set(&t->set, t->due, timer, time);
}

void mh_token_clear(struct mh_token_node *t, enum mh_token_timer timer) { mh_timers_clear(&t->set, timer); }

static void arm(struct mh_token_node *t)
{
    const struct mh_protocol_port *port = t->node->port;
    mh_tick next = t->time, retry;
    bool wanted = mh_timers_earliest(t->set, t->due, MH_TOKEN_TIMERS, &next);
    next = port->own(t->node->context, next);
    if (mh_link_alarm(&t->link, &retry) && (!wanted || mh_tick_before(retry, next))) {
        next = retry;
        wanted = true;
    }
    if (wanted) {
        port->set_timer(t->node->context, next);
    }
}

/* ---- what is known of the token ---- */

void mh_token_note(uint16_t *events) { *events = (uint16_t)(*events + (*events < UINT16_MAX)); }

bool mh_token_is_fresh(const struct mh_token_node *t, mh_tick time, uint8_t instants)
{
    const int32_t age = mh_ticks_between(time, t->time), interval = (int32_t)t->config->interval;
    return age >= -interval / 4 && age <= instants * interval;
}

bool mh_token_outranks(const struct mh_token_of *a, const struct mh_token_of *b)
{
    const int32_t ahead = (int32_t)((uint32_t)a->generation - (uint32_t)b->generation);
    return ahead != 0 ? ahead > 0 : a->holder < b->holder;
}

bool mh_token_believes(const struct mh_token_node *t)
{
    const int32_t limit = (int32_t)(BELIEVED * t->config->interval + t->config->interval / 2);
    return t->knows && (t->role != MH_TOKEN_NODE || mh_ticks_between(t->of.heard, t->time) <= limit);
}

bool mh_token_hear_of(struct mh_token_node *t, const struct mh_token_of *other)
{
    if (mh_token_believes(t) && mh_token_outranks(&t->of, other)) {
        return false;
    }
    if (t->role == MH_TOKEN_HEAD && other->holder != t->node->id) {
        mh_token_note(&t->events.yielded);
        mh_token_follow(t, other);
    }
    mh_token_guard(t, other);
    t->of = *other;
    t->knows = true;
    return true;
}

/* ---- messages in envelopes ---- */

bool mh_token_post(struct mh_token_node *t, struct mh_message *message, mh_node_id to, const struct mh_place *place)
{
    mh_geographic_address(message, t->node->id, (int16_t)t->sequence++, to, place);
    return mh_link_take(&t->link, message) == MH_OK;
}

void mh_token_tell(struct mh_token_node *t, mh_node_id to, const struct mh_place *place, const struct mh_token_of *of)
{
    struct mh_message message = {.kind = MH_MESSAGE_TOKEN,
                                 .as.token = {.sender = (int32_t)t->node->id,
                                              .track = (int32_t)t->config->sink,
                                              .generation = of->generation,
                                              .holder = (int32_t)of->holder,
                                              .state = of->state}};
    (void)mh_token_post(t, &message, to, place); /* counts what it refuses */
}

static void hear_token(struct mh_token_node *t, const mh_token_t *token)
{
    const struct mh_token_of of = {
        .holder = (mh_node_id)token->holder, .generation = token->generation, .heard = t->time, .state = token->state};
    if ((mh_node_id)token->track != t->config->sink) {
        mh_token_note(&t->events.corrupt);
    } else if (of.holder == MH_BROADCAST) {
        mh_token_begin(t);
    } else if (of.holder != t->node->id) {
        (void)mh_token_hear_of(t, &of);
    }
}

static void take_in(struct mh_token_node *t, const struct mh_message *message)
{
    const mh_node_id from = (mh_node_id)message->header.route.origin;
    switch (message->kind) {
    case MH_MESSAGE_HAND_OVER:
        mh_token_hear_part(t, from, &message->as.hand_over);
        break;
    case MH_MESSAGE_ANSWER:
        mh_token_hear_answer(t, &message->as.answer);
        break;
    case MH_MESSAGE_TOKEN:
        hear_token(t, &message->as.token);
        break;
    case MH_MESSAGE_LEAK:
        mh_token_hear_leak(t, from, &message->as.leak);
        break;
    default:
        break;
    }
}

/* Sinks and heads speak to each other across the network, the others to their neighbours. */
static bool is_for_a_neighbour(const struct mh_token_node *t, const struct mh_message *message)
{
    return message->kind != MH_MESSAGE_LEAK && message->header.route.origin == (int32_t)t->node->id &&
           t->role != MH_TOKEN_SINK;
}

static void arrive(struct mh_token_node *t, const struct mh_message *message)
{
    const struct mh_message arrived = *message;
    mh_link_finish(&t->link);
    take_in(t, &arrived);
}

static void send_on(struct mh_token_node *t, const struct mh_message *message)
{
    const enum mh_hop hop = mh_geographic_send(&t->link, &t->neighbours, t->config->faces, message);
    if (hop == MH_HOP_ARRIVED) {
        arrive(t, message);
    } else if (hop != MH_HOP_NEXT) {
        mh_link_drop(&t->link, mh_geographic_loss(hop));
    }
}

/* Send what is due. Whatever does not go on the air leaves the queue, so this ends. */
static void pump(struct mh_token_node *t)
{
    const struct mh_message *due;
    while ((due = mh_link_due(&t->link, t->now)) != NULL) {
        if (due->kind == MH_MESSAGE_HAND_OVER && !mh_token_is_offered(t, due)) {
            mh_link_finish(&t->link);
        } else if (is_for_a_neighbour(t, due)) {
            mh_link_send(&t->link, (mh_node_id)due->header.route.destination, due->envelope, &due->header);
        } else {
            send_on(t, due);
        }
    }
}

static void hear_envelope(struct mh_token_node *t, const struct mh_message *heard)
{
    if (heard->header.route.destination == (int32_t)t->node->id) {
        if (mh_link_arrive(&t->link, heard) == MH_OK) {
            take_in(t, heard);
        }
    } else if (heard->kind == MH_MESSAGE_LEAK || heard->kind == MH_MESSAGE_TOKEN) {
        (void)mh_link_take(&t->link, heard); /* counts what it refuses */
    }
}

/* ---- neighbours ---- */

static mh_tick not_past(const struct mh_token_node *t, mh_tick time)
{
    return mh_tick_before(t->time, time) ? time : t->time;
}

/* What is long past is not to come back when the ticks wrap. */
static void forget(struct mh_token_node *t)
{
    t->knows = t->knows && mh_ticks_between(t->of.heard, t->time) < MEMORY;
    t->asked = t->asked && mh_ticks_between(t->asked_for, t->time) < MEMORY;
    t->sampled = t->sampled && mh_ticks_between(t->measured.time, t->time) < MEMORY;
    mh_shunned_age(&t->shunned, t->time);
}

static void say_hello(struct mh_token_node *t)
{
    const mh_tick period = t->config->hello_period, slot = MH_TOKEN_START / HELLOS_AT_START;
    mh_link_hello(&t->link, &t->hellos);
    mh_neighbours_age(&t->neighbours, t->now);
    mh_vicinity_age(&t->vicinity, t->now);
    forget(t);
    t->greeted = t->time;
    if (t->hellos < HELLOS_AT_START) {
        mh_token_set(t, MH_TOKEN_HELLO, t->began + slot * t->hellos + mh_spread(t->node->id, t->hellos, slot / 2));
    } else {
        mh_token_set(t, MH_TOKEN_HELLO, t->time + period - mh_spread(t->node->id, t->hellos, period / 4));
    }
    if (t->hellos >= HELLOS_AT_START - 1) {
        t->told = 0;
        mh_token_set(t, MH_TOKEN_VICINITY, t->time + LIST_PAUSE);
    }
}

static void tell_of_neighbours(struct mh_token_node *t)
{
    struct mh_message message = {.kind = MH_MESSAGE_VICINITY, .as.vicinity = {.sender = (int32_t)t->node->id}};
    mh_vicinity_t *list = &message.as.vicinity;
    for (; t->told < t->neighbours.count && list->count < MH_VICINITY_NODES; t->told++) {
        const struct mh_neighbour *n = &t->neighbours.list[t->told];
        if (n->id != t->config->sink && mh_neighbour_usable(n)) {
            list->id[list->count] = (int32_t)n->id;
            list->x_mm[list->count] = n->x_mm;
            list->y_mm[list->count] = n->y_mm;
            list->count++;
        }
    }
    for (uint8_t i = list->count; i < MH_VICINITY_NODES; i++) {
        list->id[i] = -1;
    }
    if (list->count > 0) {
        mh_link_broadcast(&t->link, &message);
    }
    if (t->told < t->neighbours.count) {
        mh_token_set(t, MH_TOKEN_VICINITY, t->time + LIST_PAUSE);
    }
}

/* Who has restarted knows nobody: says hello to it soon. Not while the network starts, when all say hello by themselves. */
static void welcome(struct mh_token_node *t, const mh_hello_t *hello)
{
    if ((uint16_t)hello->sequence >= HELLOS_AT_START || t->hellos < HELLOS_AT_START ||
        t->time - t->began < 2 * MH_TOKEN_START) {
        return;
    }
    const mh_tick soon = not_past(t, t->greeted + WELCOME_PAUSE) + mh_spread(t->node->id, t->hellos, WELCOME_SPREAD);
    if (mh_tick_before(soon, t->due[MH_TOKEN_HELLO])) {
        mh_token_set(t, MH_TOKEN_HELLO, soon);
    }
}

static void hear_of_neighbours(struct mh_token_node *t, const struct mh_message *heard)
{
    if (heard->kind == MH_MESSAGE_HELLO) {
        const mh_hello_t *hello = &heard->as.hello;
        (void)mh_neighbours_hello(&t->neighbours, t->now, hello);
        if ((mh_node_id)hello->sender != t->config->sink) {
            mh_vicinity_hear(&t->vicinity, t->now, (mh_node_id)hello->sender, hello->x_mm, hello->y_mm);
        }
        if ((uint16_t)hello->sequence >= HELLOS_AT_START) { /* this node has restarted, and may have begun before */
            mh_token_clear(t, MH_TOKEN_BEGIN);
        }
    } else if (heard->kind == MH_MESSAGE_VICINITY) {
        const mh_vicinity_t *list = &heard->as.vicinity;
        for (uint8_t i = 0; i < list->count; i++) {
            if ((mh_node_id)list->id[i] != t->config->sink) {
                mh_vicinity_hear(&t->vicinity, t->now, (mh_node_id)list->id[i], list->x_mm[i], list->y_mm[i]);
            }
        }
    }
}

/* ---- the table ---- */

void mh_token_config_default(struct mh_token_config *config, mh_node_id sink, const struct mh_place *place)
{
    const struct mh_token_config nominal = {.sink = sink,
                                            .sink_place = *place,
                                            .start = MH_BROADCAST,
                                            .start_place = *place,
                                            .range_mm = 80000,
                                            .interval = 5000,
                                            .window = 1000,
                                            .hello_period = 60000,
                                            .calm = 3,
                                            .heads_max = 60,
                                            .patience = 12,
                                            .faces = true};
    *config = nominal;
    mh_link_config_default(&config->link);
    config->link.attempts =
        12; /* a neighbour that does not acknowledge five is left out: so the way around two dead ones is found */
}

static bool place_valid(const struct mh_place *place)
{
    return mh_coordinate_valid(place->x_mm) && mh_coordinate_valid(place->y_mm);
}

static bool sound(const struct mh_token_config *config)
{
    return config->sink != MH_BROADCAST && place_valid(&config->sink_place) && place_valid(&config->start_place) &&
           config->range_mm >= 1 && config->range_mm <= 1000000000u && config->interval >= 500 &&
           config->interval <= 3600000u && config->window >= 100 && config->window <= config->interval / 2 &&
           config->hello_period >= 10000 && config->hello_period <= 1000000u && config->calm >= 1 &&
           config->calm <= 100 && config->heads_max >= 1 && config->heads_max <= 250 &&
           (config->patience == 0 || (config->patience >= 4 && config->patience <= 250));
}

static enum mh_status init(void *state, const void *config, const struct mh_protocol_node *node)
{
    struct mh_token_node *t = state;
    const struct mh_token_config *chosen = config;
    if (!t || !chosen || !node || !sound(chosen)) {
        return MH_ERR_ARGUMENT;
    }
    memset(t, 0, sizeof *t);
    t->config = chosen;
    t->node = node;
    t->role = node->id == chosen->sink ? MH_TOKEN_SINK : MH_TOKEN_NODE;
    const mh_tick lifetime = chosen->hello_period / 2 * 7;
    enum mh_status status = mh_link_init(&t->link, &chosen->link, node);
    if (status == MH_OK) {
        status = mh_neighbours_init(&t->neighbours, node->id, &node->place, MH_NEIGHBOURS_MAX, lifetime);
    }
    return status == MH_OK ? mh_vicinity_init(&t->vicinity, node->id, &node->place, lifetime) : status;
}

/* The network's time is known. */
static void come_up(struct mh_token_node *t)
{
    const mh_tick ready = t->time + MH_TOKEN_START;
    t->running = true;
    t->began = t->time;
    t->hellos = 0;
    /* unlike the mote's own it goes on over a restart: the numbers are not those from before */
    t->sequence = (uint16_t)t->time;
    mh_neighbours_keep(&t->neighbours, t->config->sink);
    mh_token_set(t, MH_TOKEN_HELLO, t->time + mh_spread(t->node->id, 0, MH_TOKEN_START / HELLOS_AT_START / 2));
    if (t->role == MH_TOKEN_SINK && t->config->start == MH_BROADCAST) {
        mh_token_set(t, MH_TOKEN_WATCH, ready);
    } else if (t->role == MH_TOKEN_SINK && t->config->patience > 0) {
        mh_token_set(t, MH_TOKEN_WATCH, ready + t->config->patience * t->config->interval);
    } else if (t->node->id == t->config->start) {
        mh_token_set(t, MH_TOKEN_BEGIN, ready);
    }
}

/* What is the time? Returns false if nothing can be done, since it is not known. */
static bool comes(struct mh_token_node *t, mh_tick now)
{
    t->now = now;
    return t->running && t->node->port->network(t->node->context, now, &t->time);
}

static void done(struct mh_token_node *t)
{
    pump(t);
    arm(t);
}

static void time_jumped(void *state, mh_tick now)
{
    struct mh_token_node *t = state;
    t->now = now;
    if (t->role != MH_TOKEN_SINK) {
        t->role = MH_TOKEN_NODE;
    }
    t->set = 0;
    t->knows = t->asked = t->answers = t->sampled = t->handing = t->guarding = t->parcel.begun = false;
    t->guard = MH_BROADCAST;
    t->shunned.count = t->shunned.next = 0;
    t->head_place = t->config->start_place;
    if (t->node->port->network(t->node->context, now, &t->time)) {
        come_up(t);
        done(t);
    }
}

static void start(void *state, mh_tick now)
{
    struct mh_token_node *t = state;
    t->node->port->listen(t->node->context, true);
    time_jumped(state, now);
}

static void message(void *state, mh_tick now, const struct mh_message *heard)
{
    struct mh_token_node *t = state;
    t->now = now;
    hear_of_neighbours(t, heard);
    if (!comes(t, now)) {
        return;
    }
    if (heard->envelope != MH_ENVELOPE_NONE) {
        hear_envelope(t, heard);
    } else if (heard->kind == MH_MESSAGE_HELLO) {
        welcome(t, &heard->as.hello);
    } else if (heard->kind == MH_MESSAGE_ASK) {
        mh_token_hear_ask(t, &heard->as.ask);
    }
    done(t);
}

/* A token that one node cannot take is soon wanted elsewhere. */
static void part_sent(struct mh_token_node *t, enum mh_link_outcome found, uint8_t waiting)
{
    if (found == MH_LINK_TAKEN) {
        mh_token_part_taken(t);
    } else if (t->link.count < waiting || t->link.queue[t->link.first].attempts >= MH_TOKEN_ATTEMPTS) {
        mh_token_part_refused(t);
    }
}

static void sent(void *state, mh_tick now, enum mh_sent outcome)
{
    struct mh_token_node *t = state;
    const mh_node_id to = t->link.to;
    const uint8_t waiting = t->link.count;
    const struct mh_message *first = &t->link.queue[t->link.first].message;
    const bool is_part = waiting > 0 && first->kind == MH_MESSAGE_HAND_OVER && mh_token_is_offered(t, first);
    const enum mh_link_outcome found = mh_link_sent(&t->link, now, outcome);
    if (!comes(t, now)) {
        return;
    }
    if (found == MH_LINK_TAKEN || found == MH_LINK_LOST) {
        mh_neighbours_acked(&t->neighbours, to, found == MH_LINK_TAKEN);
    }
    if (is_part && found != MH_LINK_OTHER) {
        part_sent(t, found, waiting);
    }
    done(t);
}

static void (*const at[MH_TOKEN_TIMERS])(struct mh_token_node *t) = {
    [MH_TOKEN_HELLO] = say_hello,      [MH_TOKEN_VICINITY] = tell_of_neighbours, [MH_TOKEN_BEGIN] = mh_token_begin,
    [MH_TOKEN_INSTANT] = mh_token_ask, [MH_TOKEN_AGAIN] = mh_token_ask_again,    [MH_TOKEN_ANSWER] = mh_token_answer,
    [MH_TOKEN_KEEP] = mh_token_keep,   [MH_TOKEN_GUARD] = mh_token_resume,       [MH_TOKEN_REPORT] = mh_token_report,
    [MH_TOKEN_WATCH] = mh_token_watch,
};

static void timer(void *state, mh_tick now)
{
    struct mh_token_node *t = state;
    if (!comes(t, now)) {
        return;
    }
    for (unsigned k = 0; k < MH_TOKEN_TIMERS; k++) {
        if (mh_timers_take(&t->set, t->due, k, t->time)) {
            at[k](t);
        }
    }
    done(t);
}

static enum mh_status publish(void *state, mh_tick now, const struct mh_measurement *measurement)
{
    struct mh_token_node *t = state;
    if (!comes(t, now)) {
        return MH_ERR_NO_ROUTE;
    }
    mh_token_sampled(t, measurement);
    arm(t);
    return MH_OK;
}

static void closed(void *state, mh_tick now, mh_tick instant, const struct mh_estimate *estimate,
                   const struct mh_measurement *measurements, size_t measured)
{
    struct mh_token_node *t = state;
    (void)measurements;
    (void)measured;
    if (comes(t, now) && t->role == MH_TOKEN_HEAD) {
        mh_token_closed(t, instant, estimate);
        done(t);
    }
}

static void count(const void *state, struct mh_protocol_counters *counters)
{
    const struct mh_token_node *t = state;
    struct mh_search_counters *searches = &counters->searches;
    mh_link_count(&t->link, counters);
    searches->begun += t->events.begun;
    searches->sent_for += t->events.sent_for;
    searches->heads += t->events.heads;
    searches->handed += t->events.handed;
    searches->refused += t->events.refused;
    searches->resumed += t->events.resumed;
    searches->yielded += t->events.yielded;
    searches->corrupt += t->events.corrupt;
    searches->converged += t->events.converged;
    searches->exhausted += t->events.exhausted;
}

static mh_wire_types types[] = {&mh_wire_hello,     &mh_wire_vicinity, &mh_wire_ask,   &mh_wire_answer, &mh_wire_token,
                                &mh_wire_hand_over, &mh_wire_leak,     &mh_wire_route, &mh_wire_face,   NULL};

const struct mh_protocol mh_protocol_token = {
    .name = "token",
    .state_size = sizeof(struct mh_token_node),
    .config_size = sizeof(struct mh_token_config),
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
