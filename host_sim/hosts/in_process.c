#include "hosts/host.h"

#include "engine/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PREFETCH_AHEAD = 6 };

/* Aligned for whatever a tracker or a protocol keeps. */
union any {
    long long integer;
    double real;
    void *pointer;
};

/* What a mote that computes needs besides: one of them, or in a network that takes turns nearly all. It is large and reserved, so that a mote that
 * never leads costs the beginning of it and the end. */
struct head_memory {
    struct mh_head_config config;
    struct mh_head head;
    struct head_memory *next;
    size_t size;
    union any tracker_state[];
};

struct in_process;

/* What a frame touches lies together, from the beginning to the mote's counters of frames. */
struct slot {
    struct local_clock clock;
    uint32_t index;
    bool up;
    struct mh_mote_config config;
    struct mh_mote mote;
    sim_time alarm, alarm_queued; /* when the mote wants it, and when the queue will remember it */
    struct in_process *host;
    struct head_memory *head;       /* NULL on a mote that does not compute */
    struct mh_clock *network_clock; /* NULL on a mote that keeps no network time; the host's to free */
    void *centre_state;             /* NULL on a mote that joins no tracks; likewise */
    union any protocol_state[];
};

struct in_process {
    struct event_queue alarms; /* of slots by the number of their mote */
    struct head_memory *heads;
    uint32_t count;
    const uint32_t *order;
    size_t slot_size, protocol_size;
    unsigned char *slots;
    struct host_totals past; /* events, and the counters of motes that have started anew */
    /* during run() */
    sim_time now;
    struct host_actions *actions;
    enum mh_status refused; /* what a mote that did not come up said */
    bool out_of_memory;
};

static struct slot *slot_of(const struct in_process *host, uint32_t mote)
{
    return (struct slot *)(void *)(host->slots + host->order[mote] * host->slot_size);
}

/* ---- what a mote asks of its owner ---- */

static struct host_action *act(struct slot *slot, enum host_action_kind kind)
{
    struct host_action *action = host_actions_add(slot->host->actions);
    if (!action) {
        slot->host->out_of_memory = true;
        return NULL;
    }
    action->time = slot->host->now;
    action->kind = kind;
    action->mote = slot->index;
    return action;
}

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    struct host_action *action = act(context, HOST_TRANSMIT);
    if (action) {
        action->as.transmit.destination = destination;
        action->as.transmit.length = (uint8_t)length;
        memcpy(action->as.transmit.bytes, frame, length);
    }
}

static void report(void *context, const struct mh_estimate *estimate)
{
    struct host_action *action = act(context, HOST_REPORT);
    if (action) {
        action->as.estimate = *estimate;
    }
}

static void may_sleep(void *context, bool may_sleep)
{
    struct host_action *action = act(context, HOST_SLEEP);
    if (action) {
        action->as.may_sleep = may_sleep;
    }
}

static void queue_alarm(struct slot *slot)
{
    slot->alarm_queued = slot->alarm;
    if (event_queue_push(&slot->host->alarms, slot->alarm, slot->index)) {
        slot->host->out_of_memory = true;
    }
}

/* The queue remembers the earliest time that was ever asked for; when it comes and the mote has meanwhile asked for a later one, that is
 * remembered next. So a mote that puts its alarm off again and again does not fill the queue. */
static void set_alarm(void *context, mh_tick tick)
{
    struct slot *slot = context;
    slot->alarm = host_alarm_time(&slot->clock, slot->host->now, tick);
    if (slot->alarm < slot->alarm_queued) {
        queue_alarm(slot);
    }
}

static void sense(void *context) { (void)act(context, HOST_SENSE); }

static const struct mh_port port = {
    .transmit = transmit, .set_alarm = set_alarm, .report = report, .sleep = may_sleep, .sense = sense};

/* ---- what happens to a mote ---- */

static mh_tick tick_now(const struct slot *slot) { return local_clock_tick(&slot->clock, slot->host->now); }

static void count_mote(const struct slot *slot, struct host_totals *totals)
{
    static const struct mh_head_counters no_head;
    struct mh_protocol_counters protocol = {.retries = 0};
    if (slot->mote.config && slot->config.protocol->count) { /* it has come up */
        slot->config.protocol->count(slot->protocol_state, &protocol);
    }
    host_totals_add(totals, &slot->mote.counters, slot->head ? &slot->head->head.counters : &no_head, &protocol);
}

static void start(struct slot *slot)
{
    struct in_process *host = slot->host;
    count_mote(slot, &host->past);
    memset(slot->protocol_state, 0, host->protocol_size);
    if (slot->head && slot->mote.config) { /* anew */
        memset(&slot->head->head, 0, sizeof slot->head->head);
        memset(slot->head->tracker_state, 0, slot->head->config.tracker->state_size);
    }
    if (slot->centre_state) {
        memset(slot->centre_state, 0, slot->config.centre->state_size);
    }
    memset(&slot->mote, 0, sizeof slot->mote);
    if (host->now > 0) {
        local_clock_restart(&slot->clock, host->now);
    }
    slot->alarm = SIM_TIME_NEVER;
    slot->up = true;
    const enum mh_status status = mh_mote_init(&slot->mote, &slot->config, &port, slot, tick_now(slot));
    if (status != MH_OK) {
        slot->up = false;
        host->refused = status;
    }
}

static void stop(struct slot *slot)
{
    slot->up = false;
    slot->alarm = SIM_TIME_NEVER;
}

static void read_sensor(struct slot *slot, const struct host_event *event)
{
    const mh_tick now = tick_now(slot);
    const struct mh_reading reading = {
        .time = now, .counts = event->as.reading.counts, .target = event->as.reading.target};
    (void)mh_mote_reading(&slot->mote, now, &reading); /* counts what it refuses */
}

static double clock_error_s(const struct slot *slot)
{
    uint8_t fraction = 128;
    mh_tick shown = tick_now(slot);
    if (slot->network_clock) {
        if (!mh_clock_synchronised(slot->network_clock)) {
            return (double)NAN;
        }
        shown = mh_clock_network(slot->network_clock, shown, &fraction);
    }
    return host_clock_error_s(shown, fraction, slot->host->now);
}

static void answer_probe(struct slot *slot)
{
    struct host_action *action = act(slot, HOST_CLOCK);
    if (action) {
        action->as.clock_error_s = clock_error_s(slot);
    }
}

/* Call for the slot's memory, so that it comes all at once and while others are at work: most time goes by waiting for it. */
static void prefetch(const struct slot *slot)
{
    for (size_t at = 0; at < offsetof(struct slot, mote.counters.readings); at += CACHE_LINE) {
        __builtin_prefetch((const char *)slot + at, 1);
    }
    __builtin_prefetch(slot->protocol_state, 1);
}

static void hear(struct in_process *host, const struct host_event *event)
{
    const uint32_t count = event->as.frame.count, *receivers = event->as.frame.receivers;
    for (uint32_t i = 0; i < count; i++) {
        __builtin_prefetch(&host->order[receivers[i]]);
    }
    for (uint32_t i = 0; i < count + PREFETCH_AHEAD; i++) {
        if (i < count) {
            prefetch(slot_of(host, receivers[i]));
        }
        if (i >= PREFETCH_AHEAD) {
            struct slot *slot = slot_of(host, receivers[i - PREFETCH_AHEAD]);
            if (slot->up) {
                (void)mh_mote_frame(&slot->mote, tick_now(slot), event->as.frame.bytes, event->as.frame.length);
            }
        }
    }
    host->past.events += count;
}

static void happen(struct in_process *host, const struct host_event *event)
{
    host->now = event->time;
    if (event->kind == HOST_FRAME) {
        hear(host, event);
        return;
    }
    host->past.events++;
    struct slot *slot = slot_of(host, event->mote);
    if (event->kind == HOST_START) {
        start(slot);
    } else if (slot->up) {
        switch (event->kind) {
        case HOST_STOP:
            stop(slot);
            break;
        case HOST_READING:
            read_sensor(slot, event);
            break;
        case HOST_SENT:
            mh_mote_sent(&slot->mote, tick_now(slot), event->as.sent);
            break;
        case HOST_PROBE:
            answer_probe(slot);
            break;
        default:
            break;
        }
    }
}

static void alarm_comes(struct in_process *host, const struct event *event)
{
    struct slot *slot = slot_of(host, event->content);
    prefetch(slot);
    if (slot->alarm_queued != event->time) {
        return; /* an earlier one has taken its place */
    }
    slot->alarm_queued = SIM_TIME_NEVER;
    if (slot->alarm == event->time) {
        slot->alarm = SIM_TIME_NEVER;
        host->now = event->time;
        host->past.events++;
        mh_mote_alarm(&slot->mote, tick_now(slot));
    } else if (slot->alarm != SIM_TIME_NEVER) {
        queue_alarm(slot);
    }
}

/* ---- the table ---- */

static int add(void *state, uint32_t mote, const struct host_mote *what)
{
    struct in_process *host = state;
    struct slot *slot = slot_of(host, mote);
    slot->host = host;
    slot->index = mote;
    slot->clock = what->clock;
    slot->alarm = slot->alarm_queued = SIM_TIME_NEVER;
    slot->config = (struct mh_mote_config){.id = what->id,
                                           .place = what->place,
                                           .sensor = what->sensor,
                                           .protocol = what->protocol,
                                           .protocol_config = what->protocol_config,
                                           .protocol_state = slot->protocol_state};
    if (what->sync) {
        slot->network_clock = malloc(sizeof *slot->network_clock);
        if (!slot->network_clock) {
            return -1;
        }
        slot->config.clock = &mh_clock_flooding;
        slot->config.clock_config = what->sync;
        slot->config.clock_state = slot->network_clock;
    }
    if (what->centre) {
        slot->centre_state = malloc(what->centre->state_size);
        if (!slot->centre_state) {
            return -1;
        }
        slot->config.centre = what->centre;
        slot->config.centre_config = what->centre_config;
        slot->config.centre_state = slot->centre_state;
    }
    if (what->head) {
        const size_t size = sizeof(struct head_memory) + what->head->tracker->state_size;
        struct head_memory *memory = memory_reserve(size);
        if (!memory) {
            return -1;
        }
        memory->size = size;
        memory->config = *what->head;
        memory->config.tracker_state = memory->tracker_state;
        memory->next = host->heads;
        host->heads = memory;
        slot->head = memory;
        slot->config.head = &memory->config;
        slot->config.head_state = &memory->head;
    }
    return 0;
}

static sim_time next(const void *state)
{
    const struct in_process *host = state;
    return event_queue_next(&host->alarms);
}

static int run(void *state, sim_time until, const struct host_event *events, size_t count, struct host_actions *actions,
               char *error, size_t error_size)
{
    struct in_process *host = state;
    host->actions = actions;
    host->refused = MH_OK;
    host->out_of_memory = false;
    for (size_t i = 0;;) {
        const sim_time alarm = event_queue_next(&host->alarms);
        if (i < count && events[i].time <= alarm) {
            if (i + PREFETCH_AHEAD < count && events[i + PREFETCH_AHEAD].kind != HOST_FRAME) {
                prefetch(slot_of(host, events[i + PREFETCH_AHEAD].mote));
            }
            happen(host, &events[i++]);
        } else if (alarm < until) {
            struct event event;
            (void)event_queue_pop(&host->alarms, &event);
            alarm_comes(host, &event);
        } else {
            break;
        }
    }
    if (host->refused != MH_OK) {
        snprintf(error, error_size,
                 "a mote does not come up (status %d): tracker.*, sensor.* or radio.* has a value outside its range",
                 host->refused);
        return -1;
    }
    if (host->out_of_memory) {
        snprintf(error, error_size, "out of memory");
        return -1;
    }
    return 0;
}

static int count(void *state, struct host_totals *totals, char *error, size_t error_size)
{
    (void)error;
    (void)error_size;
    const struct in_process *host = state;
    totals->events += host->past.events;
    host_totals_add(totals, &host->past.motes, &host->past.heads, &host->past.protocols);
    for (uint32_t i = 0; i < host->count; i++) {
        const struct slot *slot = slot_of(host, i);
        count_mote(slot, totals);
    }
    return 0;
}

static void destroy(void *state)
{
    struct in_process *host = state;
    while (host->heads) {
        struct head_memory *following = host->heads->next;
        memory_release(host->heads, host->heads->size);
        host->heads = following;
    }
    for (uint32_t i = 0; i < host->count; i++) {
        free(slot_of(host, i)->network_clock);
        free(slot_of(host, i)->centre_state);
    }
    event_queue_free(&host->alarms);
    free(host->slots);
    free(host);
}

int host_in_process(struct host *host, uint32_t mote_count, const uint32_t *order, const struct mh_protocol *protocol)
{
    struct in_process *state = calloc(1, sizeof *state);
    if (!state) {
        return -1;
    }
    state->count = mote_count;
    state->order = order;
    state->protocol_size = protocol->state_size;
    state->slot_size = (sizeof(struct slot) + protocol->state_size + CACHE_LINE - 1) / CACHE_LINE * CACHE_LINE;
    state->slots = memory_array(mote_count, state->slot_size);
    if (!state->slots) {
        free(state);
        return -1;
    }
    *host = (struct host){state, add, next, run, count, destroy};
    return 0;
}
