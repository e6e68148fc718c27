#include "network.h"

#include "hosts/boards.h"
#include "scenario/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Why there is an instant: the caller asked for it, the observer is to be told of the motes, they are asked for their time, or a mote samples. */
enum {
    INSTANT_OF_WORLD,
    INSTANT_OF_MOTES,
    INSTANT_OF_CLOCKS,
    INSTANT_OF_SENSOR /* of mote 0; then those of all others */
};

#define MICROSECONDS_PER_TICK (SIM_TIME_PER_S / MH_TICKS_PER_S)

/* A frame that went on the air, to be told to the observer. */
struct network_frame {
    sim_time time;
    uint32_t sender, destination;
    const uint8_t *bytes;
    size_t length;
};

static double seconds(const struct network *network, int64_t time)
{
    return network->config.start_s + (double)time / SIM_TIME_PER_S;
}

double network_time_s(const struct network *network) { return seconds(network, (int64_t)network->now); }

/* The simulated time of a tick of the network's time, the one nearest to `now`. */
static int64_t time_of(mh_tick tick, sim_time now)
{
    const int64_t ticks = (int64_t)(now / MICROSECONDS_PER_TICK);
    return (ticks + mh_ticks_between((mh_tick)ticks, tick)) * MICROSECONDS_PER_TICK;
}

/* ---- what happens to the motes ---- */

/* Room for one more element of a list; NULL if there is no memory. */
static void *extend(struct network *network, void *list, size_t count, size_t *capacity, size_t size)
{
    if (count < *capacity) {
        return list;
    }
    const size_t larger = *capacity ? 2 * *capacity : 64;
    void *moved = realloc(list, larger * size);
    if (moved) {
        *capacity = larger;
    } else {
        network->out_of_memory = true;
    }
    return moved;
}

static void happen(struct network *network, const struct host_event *event)
{
    struct host_event *events =
        extend(network, network->events, network->event_count, &network->event_capacity, sizeof *events);
    if (events) {
        network->events = events;
        events[network->event_count++] = *event;
    }
}

static const void *keep(struct network *network, const void *bytes, size_t size)
{
    void *kept = arena_take(&network->arena, size);
    if (!kept) {
        network->out_of_memory = true;
        return NULL;
    }
    return memcpy(kept, bytes, size);
}

void network_reading(struct network *network, uint32_t mote, int32_t counts, uint8_t target)
{
    const struct host_event event = {network->now, HOST_READING, mote, {.reading = {counts, target}}};
    happen(network, &event);
    if (!network->sensing) {
        account_sample(&network->account, mote, network->now);
    }
}

static void sense(struct network *network, uint32_t mote)
{
    account_sample(&network->account, mote, network->now);
    network->sensing = true;
    if (network->config.sense) {
        network->config.sense(network->config.context, mote);
    }
    network->sensing = false;
}

void network_power(struct network *network, uint32_t mote, bool on)
{
    if (on && network->account.open && energy_is_dead(&network->account.ledger, mote)) {
        return;
    }
    const struct host_event event = {.time = network->now, .kind = on ? HOST_START : HOST_STOP, .mote = mote};
    happen(network, &event);
    if (radio_power(&network->radio, network->now, mote, on ? RADIO_POWER_ON : RADIO_POWER_OFF)) {
        network->out_of_memory = true;
    }
}

static void on_air(void *context, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *bytes,
                   size_t length)
{
    struct network *network = context;
    const enum mh_message_kind kind = frame_kind(&network->kinds, bytes, length);
    network->frames_sent[kind]++;
    account_frame(&network->account, sender, time, account_cause(kind));
    const struct observer *observer = network->config.observer;
    const bool followed = kind == MH_MESSAGE_FORM || kind == MH_MESSAGE_AWAKE || kind == MH_MESSAGE_LOCATE;
    if (!observer->frame && !followed) {
        return;
    }
    struct network_frame *frames =
        extend(network, network->frames, network->frame_count, &network->frame_capacity, sizeof *frames);
    const uint8_t *kept = keep(network, bytes, length);
    if (frames) {
        network->frames = frames;
        if (kept) {
            frames[network->frame_count++] = (struct network_frame){time, sender, destination, kept, length};
        }
    }
}

static bool follows_search(const struct network *network)
{
    return network->config.observer->cluster && protocol_is(network->config.roster->kit.protocol.protocol, "token");
}

/* An answer to a head has come to mote `receiver`: to a token's whoever it is for, by `prince` to who has asked. */
static void take_answer(struct network *network, uint32_t receiver, const uint8_t *bytes, size_t length)
{
    struct mh_message message;
    if (network->answer_count == NETWORK_ANSWERS || mh_wire_decode(mh_wire_all, bytes, length, &message) != MH_OK) {
        return;
    }
    const bool to_asker = message.kind == MH_MESSAGE_SOUND;
    if (to_asker && (mh_node_id)message.as.sound.asker != roster_id(network->config.roster, receiver)) {
        return;
    }
    const uint32_t head = receiver;
    const struct network_answer answer = {head,
                                          (mh_node_id)(to_asker ? message.as.sound.sender : message.as.answer.sender)};
    for (size_t i = 0; i < network->answer_count; i++) {
        if (network->answers[i].head == head && network->answers[i].node == answer.node) {
            return;
        }
    }
    network->answers[network->answer_count++] = answer;
}

static void heard(void *context, sim_time time, const uint8_t *bytes, size_t length, const uint32_t *receivers,
                  uint32_t count)
{
    struct network *network = context;
    const enum mh_message_kind kind = frame_kind(&network->kinds, bytes, length);
    const enum energy_cause cause = account_cause(kind);
    for (uint32_t i = 0; i < count && network->account.open; i++) {
        account_frame(&network->account, receivers[i], time, cause);
    }
    const bool answers = (kind == MH_MESSAGE_ANSWER && follows_search(network)) ||
                         (kind == MH_MESSAGE_SOUND && network->config.observer->cluster);
    for (uint32_t i = 0; i < count && answers; i++) {
        take_answer(network, receivers[i], bytes, length);
    }
    const uint8_t *kept_bytes = keep(network, bytes, length);
    const uint32_t *kept_receivers = keep(network, receivers, count * sizeof *receivers);
    if (kept_bytes && kept_receivers) {
        const struct host_event event = {
            .time = time, .kind = HOST_FRAME, .as.frame = {kept_bytes, kept_receivers, count, (uint8_t)length}};
        happen(network, &event);
    }
}

static void sent(void *context, sim_time time, uint32_t sender, enum mh_sent outcome)
{
    const struct host_event event = {time, HOST_SENT, sender, {.sent = outcome}};
    happen(context, &event);
}

static void state(void *context, sim_time time, uint32_t mote, enum radio_state radio_state, uint8_t cause)
{
    struct network *network = context;
    account_radio(&network->account, mote, time, radio_state, cause);
}

static void dies(void *context, uint32_t mote, sim_time at)
{
    (void)at;
    network_power(context, mote, false);
}

/* ---- what the motes did ---- */

static void transmit(struct network *network, const struct host_action *action)
{
    const mh_node_id destination = action->as.transmit.destination;
    const uint32_t to = destination == MH_BROADCAST ? RADIO_ALL : roster_find(network->config.roster, destination);
    const uint8_t *bytes = action->as.transmit.bytes;
    const size_t length = action->as.transmit.length;
    const enum energy_cause cause = account_cause(frame_kind(&network->kinds, bytes, length));
    if (radio_send(&network->radio, action->time + network->lookahead, action->mote, to, bytes, length,
                   (uint8_t)cause)) {
        network->out_of_memory = true;
    }
}

static void take_clock_error(struct network *network, uint32_t mote, double error_s)
{
    network->clock_error_s[mote] = error_s;
    if (network_time_s(network) >= network->config.scenario->metrics.clock_settle_s &&
        clock_errors_add(&network->clock_errors, error_s)) {
        network->out_of_memory = true;
    }
}

/* Head `head` has an estimate of track `track`, of its own sample and of the answers that have come to it. */
static void tell_heard(struct network *network, uint32_t head, uint32_t track, double time_s)
{
    const struct observer *observer = network->config.observer;
    mh_node_id members[NETWORK_ANSWERS];
    size_t count = 0, left = 0;
    for (size_t i = 0; i < network->answer_count; i++) {
        if (network->answers[i].head == head) {
            members[count++] = network->answers[i].node;
        } else {
            network->answers[left++] = network->answers[i];
        }
    }
    network->answer_count = left;
    observer->cluster(observer->context, time_s, track, roster_id(network->config.roster, head), members, count,
                      network->heads++ > 0);
}

static void act(struct network *network, const struct host_action *action)
{
    const struct network_config *config = &network->config;
    switch (action->kind) {
    case HOST_TRANSMIT:
        transmit(network, action);
        break;
    case HOST_REPORT:
        if (follows_search(network) && roster_computes(config->roster, action->mote)) {
            tell_heard(network, action->mote, 0, seconds(network, (int64_t)action->time));
        }
        if (roster_computes(config->roster, action->mote)) {
            account_step(&network->account, action->mote, action->time, action->as.estimate.measurements);
        }
        config->report(config->context, action->mote, seconds(network, (int64_t)action->time),
                       seconds(network, time_of(action->as.estimate.time, action->time)), &action->as.estimate);
        break;
    case HOST_SLEEP:
        if (radio_power(&network->radio, action->time + network->lookahead, action->mote,
                        action->as.may_sleep ? RADIO_POWER_ASLEEP : RADIO_POWER_ON)) {
            network->out_of_memory = true;
        }
        break;
    case HOST_CLOCK:
        take_clock_error(network, action->mote, action->as.clock_error_s);
        break;
    case HOST_SENSE:
        if (event_queue_push(&network->instants, action->time + network->lookahead, INSTANT_OF_SENSOR + action->mote)) {
            network->out_of_memory = true;
        }
        break;
    case HOST_WORK:
        account_work(&network->account, action->mote, action->time,
                     action->as.work.localises ? ENERGY_LOCALISATION
                                               : account_cause((enum mh_message_kind)action->as.work.message),
                     action->as.work.duration_us);
        break;
    }
}

/* A head tells its members of a cluster more than once, and other heads may speak in between; the observer hears of it once. */
static bool is_told(const struct network *network, const mh_form_t *form)
{
    for (int i = 0; i < NETWORK_FORMS && (uint64_t)i < network->forms; i++) {
        const mh_form_t *told = &network->formed[i];
        if (told->sender == form->sender && told->track == form->track && told->generation == form->generation) {
            return true;
        }
    }
    return false;
}

static void tell_cluster(struct network *network, const struct network_frame *frame)
{
    const struct observer *observer = network->config.observer;
    struct mh_message message;
    if (!observer->cluster || frame_kind(&network->kinds, frame->bytes, frame->length) != MH_MESSAGE_FORM ||
        mh_wire_decode(mh_wire_all, frame->bytes, frame->length, &message) != MH_OK ||
        is_told(network, &message.as.form)) {
        return;
    }
    const mh_form_t *form = &message.as.form;
    mh_node_id members[sizeof form->members / sizeof form->members[0]];
    for (int i = 0; i < form->count; i++) {
        members[i] = (mh_node_id)form->members[i];
    }
    observer->cluster(observer->context, seconds(network, (int64_t)frame->time), (uint32_t)form->track,
                      (mh_node_id)form->sender, members, form->count, network->forms > 0);
    network->formed[network->forms++ % NETWORK_FORMS] = *form;
}

/* By `prince`: who asks anew has no answers yet. */
static void forget_answers(struct network *network, uint32_t head)
{
    size_t left = 0;
    for (size_t i = 0; i < network->answer_count; i++) {
        if (network->answers[i].head != head) {
            network->answers[left++] = network->answers[i];
        }
    }
    network->answer_count = left;
}

/* Likewise a head of the protocol `prince`. */
static void tell_awake(struct network *network, const struct network_frame *frame)
{
    const struct network_config *config = &network->config;
    const enum mh_message_kind kind = frame_kind(&network->kinds, frame->bytes, frame->length);
    struct mh_message message;
    if (kind == MH_MESSAGE_LOCATE) {
        forget_answers(network, frame->sender);
    }
    if (kind != MH_MESSAGE_AWAKE || mh_wire_decode(mh_wire_all, frame->bytes, frame->length, &message) != MH_OK) {
        return;
    }
    const mh_awake_t *awake = &message.as.awake;
    const struct network_told now = {(mh_node_id)awake->sender, (uint32_t)awake->target, (uint16_t)awake->generation};
    bool has_other = false;
    for (uint64_t i = 0; i < NETWORK_FORMS && i < network->awake_count; i++) {
        const struct network_told *told = &network->awakes[i];
        if (told->target == now.target && told->generation == now.generation) {
            if (told->head == now.head) {
                return;
            }
            has_other = true;
        }
    }
    network->double_heads += has_other;
    network->awakes[network->awake_count++ % NETWORK_FORMS] = now;
    const double time_s = seconds(network, (int64_t)frame->time);
    if (config->observer->cluster) {
        tell_heard(network, frame->sender, now.target, time_s);
    }
    if (config->awake) {
        config->awake(config->context, time_s, seconds(network, time_of((mh_tick)awake->time_ms, frame->time)), awake);
    }
}

static void tell_frame(struct network *network, const struct network_frame *frame)
{
    const struct observer *observer = network->config.observer;
    const struct roster *roster = network->config.roster;
    tell_cluster(network, frame);
    tell_awake(network, frame);
    if (!observer->frame) {
        return;
    }
    const mh_node_id destination =
        frame->destination == RADIO_ALL ? MH_BROADCAST : roster_id(roster, frame->destination);
    observer->frame(observer->context, seconds(network, (int64_t)frame->time), roster_id(roster, frame->sender),
                    destination, frame->bytes, frame->length);
}

/* Frames and actions of the window, in order of time. */
static void conclude(struct network *network)
{
    size_t told = 0;
    for (size_t i = 0; i < network->actions.count; i++) {
        const struct host_action *action = &network->actions.list[i];
        while (told < network->frame_count && network->frames[told].time <= action->time) {
            tell_frame(network, &network->frames[told++]);
        }
        act(network, action);
    }
    while (told < network->frame_count) {
        tell_frame(network, &network->frames[told++]);
    }
    network->event_count = network->frame_count = network->actions.count = 0;
    arena_reset(&network->arena);
}

/* ---- windows ---- */

static sim_time earlier(sim_time a, sim_time b) { return a < b ? a : b; }

static sim_time begin_of_window(const struct network *network)
{
    const sim_time first = network->event_count > 0 ? network->events[0].time : SIM_TIME_NEVER;
    const sim_time world = earlier(event_queue_next(&network->instants), radio_next(&network->radio));
    const sim_time battery = network->account.open ? energy_next(&network->account.ledger) : SIM_TIME_NEVER;
    return earlier(earlier(first, world), earlier(battery, network->host.next(network->host.state)));
}

/* All but the sink, whose clock is the true one. */
static int ask_for_time(struct network *network)
{
    for (uint32_t i = 0; i + 1 < network->config.roster->count; i++) {
        const struct host_event probe = {.time = network->now, .kind = HOST_PROBE, .mote = i};
        network->clock_error_s[i] = (double)NAN;
        happen(network, &probe);
    }
    return event_queue_push(&network->instants, network->now + network->mote_interval, INSTANT_OF_CLOCKS);
}

static int tell_motes(struct network *network)
{
    const struct network_config *config = &network->config;
    const bool accounted = network->account.open;
    const struct energy *ledger = &network->account.ledger;
    for (uint32_t i = 0; i < config->roster->count && config->observer->mote; i++) {
        const struct mote_state told = {.energy_mj =
                                            accounted ? 1e3 * energy_used_j(ledger, i, network->now) : (double)NAN,
                                        .battery_left = accounted ? energy_battery_left(ledger, i, network->now) : 1,
                                        .alive = !accounted || energy_is_on(ledger, i),
                                        .clock_error_ms = network->clock_error_s ? 1e3 * network->clock_error_s[i] : 0};
        config->observer->mote(config->observer->context, network_time_s(network), roster_id(config->roster, i), &told);
    }
    return event_queue_push(&network->instants, network->now + network->mote_interval, INSTANT_OF_MOTES);
}

static int instant_comes(struct network *network, uint32_t why)
{
    switch (why) {
    case INSTANT_OF_MOTES:
        return tell_motes(network);
    case INSTANT_OF_CLOCKS:
        return ask_for_time(network);
    case INSTANT_OF_WORLD:
        return network->config.instant(network->config.context);
    default:
        sense(network, why - INSTANT_OF_SENSOR);
        return 0;
    }
}

static int window(struct network *network, sim_time end, char *error, size_t error_size)
{
    const struct radio_sink sink = {.context = network,
                                    .on_air = on_air,
                                    .heard = heard,
                                    .sent = sent,
                                    .state = network->account.open ? state : NULL};
    struct host *host = &network->host;
    struct event event;
    network->windows++;
    if (network->account.open) {
        energy_run(&network->account.ledger, network->now, dies, network);
    }
    while (event_queue_next(&network->instants) == network->now && event_queue_pop(&network->instants, &event)) {
        network->out_of_memory |= instant_comes(network, event.content) != 0;
    }
    const sim_time until =
        earlier(earlier(network->now + network->lookahead, event_queue_next(&network->instants)), end);
    network->out_of_memory |= radio_run(&network->radio, until, &sink) != 0;
    if (!network->out_of_memory && (network->event_count > 0 || host->next(host->state) < until)) {
        if (host->run(host->state, until, network->events, network->event_count, &network->actions, error,
                      error_size)) {
            return -1;
        }
        network->out_of_memory |= host_actions_sort(&network->actions) != 0;
    }
    conclude(network);
    if (network->out_of_memory) {
        snprintf(error, error_size, "out of memory at %.3f s", network_time_s(network));
        return -1;
    }
    return 0;
}

int network_run(struct network *network, sim_time end, const volatile sig_atomic_t *stop, char *error,
                size_t error_size)
{
    while ((network->now = begin_of_window(network)) < end) {
        if (window(network, end, error, error_size)) {
            return -1;
        }
        if (stop && __atomic_load_n(stop, __ATOMIC_RELAXED)) {
            snprintf(error, error_size, "stopped at %.3f s", network_time_s(network));
            return -1;
        }
    }
    network->now = end;
    return 0;
}

/* ---- from the beginning to the end ---- */

static int make_radio(struct network *network)
{
    const struct roster *roster = network->config.roster;
    const size_t nodes = roster->deployment.count;
    double *x_m = malloc(2 * sizeof *x_m * roster->count);
    if (!x_m) {
        return -1;
    }
    double *y_m = x_m + roster->count;
    for (size_t i = 0; i < nodes; i++) {
        x_m[i] = roster->deployment.nodes[i].x_m;
        y_m[i] = roster->deployment.nodes[i].y_m;
    }
    x_m[nodes] = roster->sink_x_m;
    y_m[nodes] = roster->sink_y_m;
    const struct radio_config config = radio_config_of(network->config.scenario, network->config.range_m);
    const int result = radio_make(&network->radio, &config, x_m, y_m, roster->count, network->config.seed);
    free(x_m);
    return result;
}

static int make_host(struct network *network)
{
    const struct roster *roster = network->config.roster;
    const struct host_provider *hosts = network->config.hosts;
    const uint32_t *order = radio_order(&network->radio);
    const struct mh_protocol *protocol = roster->kit.protocol.protocol;
    return hosts ? hosts->open(hosts->context, &network->host, roster->count, order, protocol, network->config.seed)
                 : host_in_process(&network->host, roster->count, order, protocol);
}

static int bring_up(struct network *network)
{
    const struct roster *roster = network->config.roster;
    const struct observer *observer = network->config.observer;
    const struct emulation *emulation = network->config.hosts ? network->config.hosts->emulation : NULL;
    for (uint32_t i = 0; i < roster->count; i++) {
        struct host_mote what = roster_mote(roster, i);
        what.board = emulation_board(emulation, what.id);
        if (what.board) {
            account_measured(&network->account, i);
        }
        const struct host_event start = {.kind = HOST_START, .mote = i};
        if (network->host.add(network->host.state, i, &what)) {
            return -1;
        }
        happen(network, &start);
        if (observer->node) {
            observer->node(observer->context, what.id, &what.place);
        }
    }
    return network->out_of_memory ? -1 : 0;
}

static int schedule_motes(struct network *network)
{
    const double interval_s = network->config.scenario->metrics.mote_interval_s;
    network->mote_interval = (sim_time)llround(interval_s * SIM_TIME_PER_S);
    if (network->mote_interval == 0) {
        return 0;
    }
    if (roster_has_clocks(network->config.roster)) {
        network->clock_error_s = calloc(network->config.roster->count, sizeof *network->clock_error_s);
        const sim_time half_a_tick = MICROSECONDS_PER_TICK / 2; /* then an ideal clock has no error */
        const sim_time first = network->mote_interval > half_a_tick ? network->mote_interval - half_a_tick : 0;
        if (!network->clock_error_s || event_queue_push(&network->instants, first, INSTANT_OF_CLOCKS)) {
            return -1;
        }
    }
    /* whether anyone listens or not, so that windows begin and end alike */
    return event_queue_push(&network->instants, network->mote_interval, INSTANT_OF_MOTES);
}

/* Every node that is to live on a board is one of the network. */
static int check_emulation(const struct network_config *config, char *error, size_t error_size)
{
    const struct emulation *emulation = config->hosts ? config->hosts->emulation : NULL;
    const struct roster *roster = config->roster;
    for (size_t i = 0; emulation && i < emulation->count; i++) {
        const mh_node_id node = emulation->list[i].node;
        if (roster_id(roster, roster_find(roster, node)) != node) {
            return fail(error, error_size, "--emulate: expected a node of the network, %lu to %lu, found %lu",
                        (unsigned long)roster_id(roster, 0), (unsigned long)roster->sink_id, (unsigned long)node);
        }
    }
    return 0;
}

int network_make(struct network *network, const struct network_config *config, char *error, size_t error_size)
{
    const struct roster *roster = config->roster;
    const double lookahead_us = round(config->scenario->radio.delay_s * SIM_TIME_PER_S);
    *network = (struct network){.config = *config, .lookahead = lookahead_us > 1 ? (sim_time)lookahead_us : 1};
    frame_kinds_learn(&network->kinds);
    if (check_emulation(config, error, error_size)) {
        return -1;
    }
    if (make_radio(network) ||
        account_open(&network->account, config->scenario, radio_order(&network->radio), roster->count,
                     roster->count - 1) ||
        make_host(network) || bring_up(network) || schedule_motes(network)) {
        snprintf(error, error_size, "out of memory for %u nodes", (unsigned)roster->count);
        network_free(network);
        return -1;
    }
    return 0;
}

void network_free(struct network *network)
{
    if (network->host.destroy) {
        network->host.destroy(network->host.state);
    }
    account_close(&network->account);
    radio_free(&network->radio);
    event_queue_free(&network->instants);
    host_actions_free(&network->actions);
    arena_free(&network->arena);
    clock_errors_free(&network->clock_errors);
    free(network->clock_error_s);
    free(network->events);
    free(network->frames);
    *network = (struct network){0};
}

int network_schedule(struct network *network, sim_time time)
{
    return event_queue_push(&network->instants, time, INSTANT_OF_WORLD);
}

int network_count(struct network *network, struct simulation_counters *counters, char *error, size_t error_size)
{
    struct host_totals totals = {.boards = network->config.hosts ? network->config.hosts->boards : NULL};
    if (network->host.count(network->host.state, &totals, error, error_size)) {
        return -1;
    }
    counters->events = totals.events;
    counters->energy = energy_total_unknown();
    counters->windows = network->windows;
    if (network->account.open && energy_total(&network->account.ledger, network->now, &counters->energy)) {
        snprintf(error, error_size, "out of memory");
        return -1;
    }
    counters->clock_error_median_ms = clock_errors_quantile_ms(&network->clock_errors, 0.5);
    counters->clock_error_p99_ms = clock_errors_quantile_ms(&network->clock_errors, 0.99);
    counters->clock_known_share = clock_errors_known_share(&network->clock_errors);
    counters->motes = totals.motes;
    counters->head = totals.heads;
    counters->protocol = totals.protocols;
    counters->clusters.total = totals.protocols.clusters;
    counters->double_heads = network->double_heads;
    memcpy(counters->frames_sent, network->frames_sent, sizeof counters->frames_sent);
    const struct radio_counters *radio = &network->radio.counters;
    counters->frames_repeated = radio->frames_repeated;
    counters->frames_received = radio->frames_received;
    counters->frames_duplicate = radio->frames_duplicate;
    memcpy(counters->frames_lost_by, radio->lost, sizeof counters->frames_lost_by);
    for (int reason = 0; LOSS_AT_RECEIVER(reason); reason++) {
        counters->frames_lost += radio->lost[reason];
    }
    return 0;
}
