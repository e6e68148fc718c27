#include "network.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
}

void network_power(struct network *network, uint32_t mote, bool on)
{
    const struct host_event event = {.time = network->now, .kind = on ? HOST_START : HOST_STOP, .mote = mote};
    happen(network, &event);
    if (radio_power(&network->radio, network->now, mote, on ? RADIO_POWER_ON : RADIO_POWER_OFF)) {
        network->out_of_memory = true;
    }
}

static void count_kind(struct network *network, const uint8_t *frame)
{
    for (int kind = 0; kind < MH_MESSAGE_KINDS; kind++) {
        if (memcmp(frame, network->fingerprints[kind], sizeof network->fingerprints[kind]) == 0) {
            network->frames_sent[kind]++;
        }
    }
}

static void on_air(void *context, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *bytes,
                   size_t length)
{
    struct network *network = context;
    count_kind(network, bytes);
    if (!network->config.observer->frame) {
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

static void heard(void *context, sim_time time, const uint8_t *bytes, size_t length, const uint32_t *receivers,
                  uint32_t count)
{
    struct network *network = context;
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

/* ---- what the motes did ---- */

static void transmit(struct network *network, const struct host_action *action)
{
    const mh_node_id destination = action->as.transmit.destination;
    const uint32_t to = destination == MH_BROADCAST ? RADIO_ALL : roster_find(network->config.roster, destination);
    if (radio_send(&network->radio, action->time + network->lookahead, action->mote, to, action->as.transmit.bytes,
                   action->as.transmit.length, 0)) {
        network->out_of_memory = true;
    }
}

static void act(struct network *network, const struct host_action *action)
{
    const struct network_config *config = &network->config;
    switch (action->kind) {
    case HOST_TRANSMIT:
        transmit(network, action);
        break;
    case HOST_REPORT:
        config->report(config->context, seconds(network, (int64_t)action->time),
                       seconds(network, time_of(action->as.estimate.time, action->time)), &action->as.estimate);
        break;
    case HOST_SLEEP:
        if (radio_power(&network->radio, action->time + network->lookahead, action->mote,
                        action->as.may_sleep ? RADIO_POWER_ASLEEP : RADIO_POWER_ON)) {
            network->out_of_memory = true;
        }
        break;
    case HOST_CLOCK:
        break;
    }
}

static void tell_frame(const struct network *network, const struct network_frame *frame)
{
    const struct observer *observer = network->config.observer;
    const struct roster *roster = network->config.roster;
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
    return earlier(earlier(first, world), network->host.next(network->host.state));
}

static int window(struct network *network, sim_time end, char *error, size_t error_size)
{
    const struct radio_sink sink = {.context = network, .on_air = on_air, .heard = heard, .sent = sent};
    struct host *host = &network->host;
    struct event event;
    network->windows++;
    while (event_queue_next(&network->instants) == network->now && event_queue_pop(&network->instants, &event)) {
        network->out_of_memory |= network->config.instant(network->config.context) != 0;
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

static void learn_fingerprints(struct network *network)
{
    for (int kind = 0; kind < MH_MESSAGE_KINDS; kind++) {
        const struct mh_message message = {.kind = (enum mh_message_kind)kind};
        uint8_t frame[MH_FRAME_MAX];
        size_t length;
        if (mh_wire_encode(&message, frame, &length) == MH_OK) {
            memcpy(network->fingerprints[kind], frame, sizeof network->fingerprints[kind]);
        }
    }
}

static int bring_up(struct network *network)
{
    const struct roster *roster = network->config.roster;
    const struct observer *observer = network->config.observer;
    for (uint32_t i = 0; i < roster->count; i++) {
        const struct host_mote what = roster_mote(roster, i);
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

int network_make(struct network *network, const struct network_config *config, char *error, size_t error_size)
{
    const struct roster *roster = config->roster;
    const double lookahead_us = round(config->scenario->radio.delay_s * SIM_TIME_PER_S);
    *network = (struct network){.config = *config, .lookahead = lookahead_us > 1 ? (sim_time)lookahead_us : 1};
    learn_fingerprints(network);
    if (make_radio(network) ||
        host_in_process(&network->host, roster->count, radio_order(&network->radio), roster->kit.protocol.protocol) ||
        bring_up(network)) {
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
    radio_free(&network->radio);
    event_queue_free(&network->instants);
    host_actions_free(&network->actions);
    arena_free(&network->arena);
    free(network->events);
    free(network->frames);
    *network = (struct network){0};
}

int network_schedule(struct network *network, sim_time time) { return event_queue_push(&network->instants, time, 0); }

int network_count(struct network *network, struct simulation_counters *counters, char *error, size_t error_size)
{
    struct host_totals totals = {0};
    if (network->host.count(network->host.state, &totals, error, error_size)) {
        return -1;
    }
    counters->events = totals.events;
    counters->energy = energy_total_unknown();
    counters->clock_error_p99_ms = (double)NAN;
    counters->motes = totals.motes;
    counters->head = totals.heads;
    memcpy(counters->frames_sent, network->frames_sent, sizeof counters->frames_sent);
    const struct radio_counters *radio = &network->radio.counters;
    counters->frames_repeated = radio->frames_repeated;
    counters->frames_received = radio->frames_received;
    memcpy(counters->frames_lost_by, radio->lost, sizeof counters->frames_lost_by);
    for (int reason = 0; LOSS_AT_RECEIVER(reason); reason++) {
        counters->frames_lost += radio->lost[reason];
    }
    return 0;
}
