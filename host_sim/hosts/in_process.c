#include "hosts/host.h"

#include <stdlib.h>

/* Aligned for whatever a tracker or a protocol keeps. */
union any {
    long long integer;
    double real;
    void *pointer;
};

/* What a mote that computes needs besides; only few do. */
struct head_memory {
    struct mh_head_config config;
    struct mh_head head;
    struct head_memory *next;
    union any tracker_state[];
};

struct in_process;

struct slot {
    struct mh_mote mote;
    struct mh_mote_config config;
    struct in_process *host;
    uint32_t index;
    union any protocol_state[];
};

struct in_process {
    struct host_port port;
    void *context;
    struct head_memory *heads;
    uint32_t count;
    const uint32_t *order;
    size_t slot_size;
    unsigned char *slots;
};

static struct slot *slot_of(const struct in_process *host, uint32_t mote)
{
    return (struct slot *)(void *)(host->slots + host->order[mote] * host->slot_size);
}

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    const struct slot *slot = context;
    slot->host->port.transmit(slot->host->context, slot->index, destination, frame, length);
}

static void set_alarm(void *context, mh_tick time)
{
    const struct slot *slot = context;
    slot->host->port.set_alarm(slot->host->context, slot->index, time);
}

static void report(void *context, const struct mh_estimate *estimate)
{
    const struct slot *slot = context;
    slot->host->port.report(slot->host->context, slot->index, estimate);
}

static const struct mh_port mote_port = {.transmit = transmit, .set_alarm = set_alarm, .report = report};

static struct head_memory *new_head(struct in_process *host, const struct mh_head_config *config)
{
    struct head_memory *memory = calloc(1, sizeof *memory + config->tracker->state_size);
    if (memory) {
        memory->config = *config;
        memory->config.tracker_state = memory->tracker_state;
        memory->next = host->heads;
        host->heads = memory;
    }
    return memory;
}

static enum mh_status init(void *state, uint32_t mote, const struct host_mote *what, mh_tick now)
{
    struct in_process *host = state;
    struct slot *slot = slot_of(host, mote);
    slot->host = host;
    slot->index = mote;
    slot->config = (struct mh_mote_config){.id = what->id,
                                           .place = what->place,
                                           .sensor = what->sensor,
                                           .protocol = what->protocol,
                                           .protocol_config = what->protocol_config,
                                           .protocol_state = slot->protocol_state};
    if (what->head) {
        struct head_memory *memory = new_head(host, what->head);
        if (!memory) {
            return MH_ERR_CAPACITY;
        }
        slot->config.head = &memory->config;
        slot->config.head_state = &memory->head;
    }
    return mh_mote_init(&slot->mote, &slot->config, &mote_port, slot, now);
}

static enum mh_status reading(void *state, uint32_t mote, mh_tick now, const struct mh_reading *what)
{
    return mh_mote_reading(&slot_of(state, mote)->mote, now, what);
}

static enum mh_status frame(void *state, uint32_t mote, mh_tick now, const uint8_t *bytes, size_t length)
{
    return mh_mote_frame(&slot_of(state, mote)->mote, now, bytes, length);
}

static void alarm_due(void *state, uint32_t mote, mh_tick now) { mh_mote_alarm(&slot_of(state, mote)->mote, now); }

static void count(const void *state, struct mh_mote_counters *motes, struct mh_head_counters *heads)
{
    const struct in_process *host = state;
    for (uint32_t i = 0; i < host->count; i++) {
        const struct mh_mote_counters *from = &slot_of(host, i)->mote.counters;
        motes->readings += from->readings;
        motes->readings_refused += from->readings_refused;
        motes->readings_repeated += from->readings_repeated;
        motes->reports += from->reports;
        motes->reports_asked += from->reports_asked;
        motes->reports_no_route += from->reports_no_route;
        motes->frames_sent += from->frames_sent;
        motes->frames_received += from->frames_received;
        motes->frames_corrupt += from->frames_corrupt;
        motes->frames_unknown += from->frames_unknown;
    }
    for (const struct head_memory *memory = host->heads; memory; memory = memory->next) {
        const struct mh_head_counters *from = &memory->head.counters;
        heads->measurements += from->measurements;
        heads->late += from->late;
        heads->repeated += from->repeated;
        heads->overflowed += from->overflowed;
        heads->estimates += from->estimates;
    }
}

static void destroy(void *state)
{
    struct in_process *host = state;
    while (host->heads) {
        struct head_memory *next = host->heads->next;
        free(host->heads);
        host->heads = next;
    }
    free(host->slots);
    free(host);
}

int host_in_process(struct host *host, uint32_t mote_count, const uint32_t *order, const struct mh_protocol *protocol,
                    const struct host_port *port, void *context)
{
    struct in_process *state = calloc(1, sizeof *state);
    if (!state) {
        return -1;
    }
    const size_t units = (protocol->state_size + sizeof(union any) - 1) / sizeof(union any);
    state->port = *port;
    state->context = context;
    state->count = mote_count;
    state->order = order;
    state->slot_size = sizeof(struct slot) + units * sizeof(union any);
    state->slots = calloc(mote_count, state->slot_size);
    if (!state->slots) {
        free(state);
        return -1;
    }
    *host = (struct host){state, init, reading, frame, alarm_due, count, destroy};
    return 0;
}
