#include "network.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What an event is: two bits of kind, thirty of index (a mote, a flight). */
enum { EVENT_INSTANT, EVENT_ALARM, EVENT_FRAME };

#define EVENT(kind, index) ((uint32_t)(kind) << 30 | (uint32_t)(index))
#define NEVER UINT64_MAX
#define MICROSECONDS_PER_TICK (SIM_TIME_PER_S / MH_TICKS_PER_S)

static mh_tick tick_of(sim_time time) { return (mh_tick)(time / MICROSECONDS_PER_TICK); }

/* The simulated time at which a mote's clock shows `tick`, the one nearest to now. */
static int64_t time_of(const struct network *network, mh_tick tick)
{
    const int64_t ahead = mh_ticks_between(tick_of(network->now), tick);
    return ((int64_t)(network->now / MICROSECONDS_PER_TICK) + ahead) * MICROSECONDS_PER_TICK;
}

static double seconds(const struct network *network, int64_t time)
{
    return network->config.start_s + (double)time / SIM_TIME_PER_S;
}

double network_time_s(const struct network *network) { return seconds(network, (int64_t)network->now); }

static void push(struct network *network, sim_time time, uint32_t event)
{
    if (event_queue_push(&network->queue, time, event)) {
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

static void transmit(void *context, uint32_t mote, mh_node_id destination, const uint8_t *frame, size_t length)
{
    struct network *network = context;
    const struct deployment *deployment = network->config.deployment;
    const struct observer *observer = network->config.observer;
    /* An identifier that no node has is the sink's: deployment_find gives the index after the last node's. */
    const uint32_t to = destination == MH_BROADCAST ? RADIO_ALL : (uint32_t)deployment_find(deployment, destination);
    uint32_t flight;
    sim_time takes;
    if (radio_send(&network->radio, mote, to, frame, length, &flight, &takes)) {
        network->out_of_memory = true;
        return;
    }
    push(network, network->now + takes, EVENT(EVENT_FRAME, flight));
    count_kind(network, frame);
    if (observer->frame) {
        const mh_node_id sender = mote < deployment->count ? deployment->nodes[mote].id : network->sink_id;
        observer->frame(observer->context, network_time_s(network), sender, destination, frame, length);
    }
}

/* The queue remembers the earliest time that was ever asked for; when it comes and the mote has meanwhile asked for a later one, that is
 * remembered next. So a mote that puts its alarm off again and again does not fill the queue. */
static void set_alarm(void *context, uint32_t mote, mh_tick tick)
{
    struct network *network = context;
    struct network_alarm *alarm = &network->alarms[mote];
    const int64_t time = time_of(network, tick);
    alarm->wanted = time < (int64_t)network->now ? network->now : (sim_time)time;
    if (alarm->wanted < alarm->queued) {
        alarm->queued = alarm->wanted;
        push(network, alarm->queued, EVENT(EVENT_ALARM, mote));
    }
}

static void alarm_comes(struct network *network, uint32_t mote)
{
    struct network_alarm *alarm = &network->alarms[mote];
    if (alarm->queued != network->now) {
        return; /* an earlier event has taken its place */
    }
    alarm->queued = NEVER;
    if (alarm->wanted > network->now) {
        if (alarm->wanted != NEVER) {
            alarm->queued = alarm->wanted;
            push(network, alarm->queued, EVENT(EVENT_ALARM, mote));
        }
        return;
    }
    alarm->wanted = NEVER;
    network->host.alarm(network->host.state, mote, tick_of(network->now));
}

static void report(void *context, uint32_t mote, const struct mh_estimate *estimate)
{
    (void)mote;
    struct network *network = context;
    network->config.report(network->config.context, network_time_s(network),
                           seconds(network, time_of(network, estimate->time)), estimate);
}

static const struct host_port port = {transmit, set_alarm, report};

static void receive(void *context, uint32_t receiver, const uint8_t *bytes, size_t length)
{
    struct network *network = context;
    network->host.frame(network->host.state, receiver, tick_of(network->now), bytes, length);
}

struct mh_place place_from_metres(double x_m, double y_m, double z_m)
{
    return (struct mh_place){(int32_t)lround(x_m * 1000), (int32_t)lround(y_m * 1000), (int32_t)lround(z_m * 1000)};
}

static int make_radio(struct network *network)
{
    const struct scenario *scenario = network->config.scenario;
    const struct deployment *deployment = network->config.deployment;
    double *x_m = malloc(2 * sizeof *x_m * network->count);
    if (!x_m) {
        return -1;
    }
    double *y_m = x_m + network->count;
    for (size_t i = 0; i < deployment->count; i++) {
        x_m[i] = deployment->nodes[i].x_m;
        y_m[i] = deployment->nodes[i].y_m;
    }
    x_m[deployment->count] = scenario->network.sink_x_m;
    y_m[deployment->count] = scenario->network.sink_y_m;
    const struct radio_config config = {network->config.range_m, scenario->radio.delay_s, scenario->radio.bitrate_bps,
                                        scenario->radio.loss};
    const int result = radio_make(&network->radio, &config, x_m, y_m, network->count, network->config.seed);
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

static enum mh_status bring_up(struct network *network)
{
    const struct network_config *config = &network->config;
    struct host_mote what = {.protocol = config->protocol.protocol,
                             .protocol_config = &network->config.protocol.config};
    for (uint32_t i = 0; i < network->count; i++) {
        const bool is_sink = i == config->deployment->count;
        const struct recorded_node *node = &config->deployment->nodes[i];
        what.id = is_sink ? network->sink_id : node->id;
        what.place = is_sink
                         ? place_from_metres(config->scenario->network.sink_x_m, config->scenario->network.sink_y_m, 0)
                         : place_from_metres(node->x_m, node->y_m, node->z_m);
        what.sensor = is_sink ? NULL : &network->config.sensor;
        what.head = is_sink ? &network->head : NULL;
        const enum mh_status status = network->host.init(network->host.state, i, &what, 0);
        if (status != MH_OK) {
            return status;
        }
        if (config->observer->node) {
            config->observer->node(config->observer->context, what.id, &what.place);
        }
    }
    return MH_OK;
}

int network_make(struct network *network, const struct network_config *config, char *error, size_t error_size)
{
    const struct scenario *scenario = config->scenario;
    const size_t nodes = config->deployment->count;
    *network = (struct network){.config = *config, .count = (uint32_t)nodes + 1};
    if (nodes < 1 || nodes >= UINT32_C(1) << 30 || config->deployment->nodes[nodes - 1].id >= MH_BROADCAST - 1) {
        snprintf(error, error_size, "%zu nodes, expected 1 to 1,073,741,823 with identifiers below 4294967294", nodes);
        return -1;
    }
    network->sink_id = config->deployment->nodes[nodes - 1].id + 1;
    const mh_tick interval = config->sensor.interval;
    const double window_s = scenario->tracker.window_s;
    network->head = (struct mh_head_config){
        .tracker = config->tracker.tracker,
        .tracker_config = &network->config.tracker.config,
        .epoch = config->epoch,
        .interval = interval,
        .window = window_s > 0 ? (mh_tick)lround(window_s * MH_TICKS_PER_S) : interval / 2,
    };
    learn_fingerprints(network);
    network->alarms = malloc(network->count * sizeof *network->alarms);
    if (!network->alarms || make_radio(network) ||
        host_in_process(&network->host, network->count, network->radio.position, config->protocol.protocol, &port,
                        network)) {
        snprintf(error, error_size, "out of memory for %zu nodes", nodes);
        network_free(network);
        return -1;
    }
    for (uint32_t i = 0; i < network->count; i++) {
        network->alarms[i] = (struct network_alarm){NEVER, NEVER};
    }
    const enum mh_status status = bring_up(network);
    if (status != MH_OK) {
        snprintf(error, error_size,
                 "a mote does not come up (status %d): tracker.*, sensor.* or radio.* has a value outside its range",
                 status);
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
    event_queue_free(&network->queue);
    free(network->alarms);
    *network = (struct network){0};
}

int network_schedule(struct network *network, sim_time time)
{
    return event_queue_push(&network->queue, time, EVENT(EVENT_INSTANT, 0));
}

void network_reading(struct network *network, uint32_t mote, int32_t counts, uint8_t target)
{
    const mh_tick now = tick_of(network->now);
    const struct mh_reading reading = {.time = now, .counts = counts, .target = target};
    network->host.reading(network->host.state, mote, now, &reading);
}

int network_run(struct network *network, sim_time end, const volatile sig_atomic_t *stop, char *error,
                size_t error_size)
{
    struct event event;
    while (event_queue_pop(&network->queue, &event) && event.time < end) {
        network->now = event.time;
        network->events++;
        const uint32_t index = event.content & UINT32_C(0x3FFFFFFF);
        switch (event.content >> 30) {
        case EVENT_INSTANT:
            if (network->config.instant(network->config.context)) {
                network->out_of_memory = true;
            }
            break;
        case EVENT_ALARM:
            alarm_comes(network, index);
            break;
        case EVENT_FRAME:
            radio_land(&network->radio, index, receive, network);
            break;
        }
        if (stop && __atomic_load_n(stop, __ATOMIC_RELAXED)) {
            snprintf(error, error_size, "stopped at %.3f s", network_time_s(network));
            return -1;
        }
        if (network->out_of_memory) {
            snprintf(error, error_size, "out of memory at %.3f s", network_time_s(network));
            return -1;
        }
    }
    return 0;
}

void network_count(const struct network *network, struct simulation_counters *counters)
{
    counters->events = network->events;
    counters->energy = energy_total_unknown();
    counters->clock_error_p99_ms = (double)NAN;
    memcpy(counters->frames_sent, network->frames_sent, sizeof counters->frames_sent);
    counters->frames_received = network->radio.received;
    counters->frames_lost = network->radio.lost;
    network->host.count(network->host.state, &counters->motes, &counters->head);
}
