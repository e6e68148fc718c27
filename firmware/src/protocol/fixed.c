#include "fixed_node.h"
#include "timers.h"

#include "motehound/geographic.h"
#include "motehound/spread.h"

#include <string.h>

/* ---- timers ---- */

void mh_fixed_set(struct mh_fixed *f, enum mh_fixed_timer timer, mh_tick time)
{
    mh_timers_set(&f->set, f->due, timer, time);
}

void mh_fixed_clear(struct mh_fixed *f, enum mh_fixed_timer timer) { mh_timers_clear(&f->set, timer); }

static void arm(struct mh_fixed *f)
{
    mh_tick next = f->time, retry;
    bool wanted = mh_timers_earliest(f->set, f->due, MH_FIXED_TIMERS, &next);
    next = f->node->port->own(f->node->context, next);
    if (mh_link_alarm(&f->link, &retry) && (!wanted || mh_tick_before(retry, next))) {
        next = retry;
        wanted = true;
    }
    if (wanted) {
        f->node->port->set_timer(f->node->context, next);
    }
}

/* ---- messages in envelopes ---- */

uint8_t mh_fixed_member_of(const struct mh_fixed_cluster *cluster, mh_node_id id)
{
    uint8_t i = 0;
    while (i < cluster->count && cluster->members[i].id != id) {
        i++;
    }
    return i < cluster->count ? i : MH_FIXED_NOBODY;
}

enum mh_status mh_fixed_send(struct mh_fixed *f, struct mh_message *message, mh_node_id destination,
                             const struct mh_place *place)
{
    mh_geographic_address(message, f->node->id, (int16_t)f->sequence++, destination, place);
    return mh_link_take(&f->link, message);
}

void mh_fixed_send_bytes(struct mh_fixed *f, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length,
                         mh_node_id destination, const struct mh_place *place)
{
    struct mh_message message = {
        .kind = MH_MESSAGE_HAND_OVER,
        .as.hand_over = {.track = cluster, .generation = (int32_t)time, .time_ms = (int32_t)time}};
    const uint8_t parts = (uint8_t)MH_PARCEL_PARTS(length);
    for (uint8_t part = 0; part < parts; part++) {
        mh_parcel_cut(bytes, length, part, &message.as.hand_over);
        (void)mh_fixed_send(f, &message, destination, place); /* counts what it refuses */
    }
}

static void take_in(struct mh_fixed *f, const struct mh_message *message)
{
    const mh_node_id from = (mh_node_id)message->header.route.origin;
    if (f->role == MH_FIXED_SINK) {
        if (message->kind == MH_MESSAGE_HAND_OVER) {
            mh_fixed_hear_summary(f, from, &message->as.hand_over);
        }
    } else if (message->kind == MH_MESSAGE_REPORT) {
        mh_fixed_hear_report(f, &message->as.report);
    } else if (from == f->config->sink) {
        if (message->kind == MH_MESSAGE_HAND_OVER) {
            mh_fixed_hear_feedback(f, from, &message->as.hand_over);
        } else if (message->kind == MH_MESSAGE_TAKEN) {
            mh_fixed_hear_taken(f, &message->as.taken);
        }
    }
}

/* A sample of this node goes to whoever leads by now, who may be this node. */
static void pass_report(struct mh_fixed *f, const struct mh_message *due)
{
    if (f->role != MH_FIXED_MEMBER) {
        mh_fixed_hear_report(f, &due->as.report);
        mh_link_finish(&f->link);
        return;
    }
    const struct mh_fixed_member *head = mh_fixed_head(f);
    mh_face_t header = due->header;
    header.route.destination = (int32_t)head->id;
    header.route.x_mm = head->place.x_mm;
    header.route.y_mm = head->place.y_mm;
    mh_link_send(&f->link, head->id, due->envelope, &header);
}

static void send_on(struct mh_fixed *f, const struct mh_message *due)
{
    const enum mh_hop hop = mh_geographic_send(&f->link, &f->neighbours, false, due);
    if (hop != MH_HOP_NEXT) {
        mh_link_drop(&f->link, mh_geographic_loss(hop));
    }
}

/* Send what is due. Whatever does not go on the air leaves the queue, so this ends. */
static void pump(struct mh_fixed *f)
{
    const struct mh_message *due;
    while ((due = mh_link_due(&f->link, f->now)) != NULL) {
        if (due->kind == MH_MESSAGE_REPORT) {
            pass_report(f, due);
        } else {
            send_on(f, due);
        }
    }
}

static void hear_envelope(struct mh_fixed *f, const struct mh_message *heard)
{
    if (heard->header.route.destination == (int32_t)f->node->id) {
        if (mh_link_arrive(&f->link, heard) == MH_OK) {
            take_in(f, heard);
        }
    } else if (heard->kind != MH_MESSAGE_REPORT) {
        (void)mh_link_take(&f->link, heard); /* counts what it refuses */
    }
}

/* ---- neighbours ---- */

/* The first ones come as fast as summaries, which need to know the way. */
static void say_hello(struct mh_fixed *f)
{
    mh_tick period = f->config->report_interval;
    for (uint16_t i = 0; i < f->hellos && period < f->config->hello_period; i++) {
        period *= 2;
    }
    if (period > f->config->hello_period) {
        period = f->config->hello_period;
    }
    mh_link_hello(&f->link, &f->hellos);
    mh_neighbours_age(&f->neighbours, f->now);
    mh_fixed_set(f, MH_FIXED_HELLO, f->time + period - mh_spread(f->node->id, f->hellos, period / 4));
}

/* ---- the table ---- */

void mh_fixed_config_default(struct mh_fixed_config *config)
{
    const struct mh_fixed_config nominal = {
        .report_interval = 1000, .fuse_interval = 1000, .wait = 500, .patience = 3, .hello_period = 10000};
    *config = nominal;
    mh_link_config_default(&config->link);
}

static bool clusters_sound(const struct mh_fixed_config *config)
{
    bool sound = config->clusters && config->cluster_count >= 1 && config->cluster_count <= MH_FIXED_CLUSTERS_MAX;
    for (uint8_t i = 0; sound && i < config->cluster_count; i++) {
        const struct mh_fixed_cluster *cluster = &config->clusters[i];
        sound = cluster->members && cluster->count >= 1 && cluster->count <= 250;
        for (uint8_t k = 0; sound && k < cluster->count; k++) {
            const struct mh_fixed_member *member = &cluster->members[k];
            sound = member->id < MH_BROADCAST && member->id != config->sink &&
                    mh_coordinate_valid(member->place.x_mm) && mh_coordinate_valid(member->place.y_mm) &&
                    (k == 0 || cluster->members[k - 1].id < member->id);
        }
    }
    return sound;
}

static bool sound(const struct mh_fixed_config *config)
{
    const struct mh_fixed_port *port = config->port;
    return port && port->summarise && port->summary_taken && port->correct && port->begin && port->take && port->fuse &&
           port->feedback && config->sink != MH_BROADCAST && mh_coordinate_valid(config->sink_place.x_mm) &&
           mh_coordinate_valid(config->sink_place.y_mm) && clusters_sound(config) && config->report_interval >= 100 &&
           config->report_interval <= 3600000u && config->fuse_interval >= 100 && config->fuse_interval <= 3600000u &&
           config->wait >= 1 && config->wait <= config->fuse_interval && config->patience >= 2 &&
           config->patience <= 100 && config->hello_period >= 1000 && config->hello_period <= 600000u;
}

/* Whose member this node is. */
static void find_cluster(struct mh_fixed *f)
{
    f->cluster = MH_CLUSTER_NONE;
    for (uint8_t i = 0; i < f->config->cluster_count; i++) {
        const uint8_t rank = mh_fixed_member_of(&f->config->clusters[i], f->node->id);
        if (rank != MH_FIXED_NOBODY) {
            f->cluster = i;
            f->rank = rank;
        }
    }
}

static enum mh_status init(void *state, const void *config, const struct mh_protocol_node *node)
{
    struct mh_fixed *f = state;
    const struct mh_fixed_config *chosen = config;
    if (!f || !chosen || !node || !sound(chosen)) {
        return MH_ERR_ARGUMENT;
    }
    memset(f, 0, sizeof *f);
    f->config = chosen;
    f->node = node;
    find_cluster(f);
    if (f->cluster != MH_CLUSTER_NONE && !node->is_head) {
        return MH_ERR_ARGUMENT;
    }
    enum mh_status status = mh_link_init(&f->link, &chosen->link, node);
    if (status == MH_OK) {
        status =
            mh_neighbours_init(&f->neighbours, node->id, &node->place, MH_NEIGHBOURS_MAX, chosen->hello_period / 2 * 7);
    }
    return status;
}

/* The network's time is known. */
static void begin(struct mh_fixed *f)
{
    f->running = true;
    f->hellos = 0;
    /* unlike the mote's own it goes on over a restart: the numbers are not those from before */
    f->sequence = (uint16_t)f->time;
    mh_neighbours_keep(&f->neighbours, f->config->sink);
    mh_fixed_set(f, MH_FIXED_HELLO, f->time + mh_spread(f->node->id, 0, f->config->report_interval / 2));
    if (f->node->id == f->config->sink) {
        f->role = MH_FIXED_SINK;
        mh_fixed_begin_sink(f);
    } else if (f->cluster != MH_CLUSTER_NONE) {
        mh_fixed_begin_member(f);
    }
}

/* What is the time? Returns false if nothing can be done, since it is not known. */
static bool comes(struct mh_fixed *f, mh_tick now)
{
    f->now = now;
    return f->running && f->node->port->network(f->node->context, now, &f->time);
}

static void done(struct mh_fixed *f)
{
    pump(f);
    arm(f);
}

static void time_jumped(void *state, mh_tick now)
{
    struct mh_fixed *f = state;
    f->now = now;
    f->set = 0;
    f->running = false;
    if (f->node->port->network(f->node->context, now, &f->time)) {
        begin(f);
        done(f);
    }
}

static void start(void *state, mh_tick now) { time_jumped(state, now); }

static void message(void *state, mh_tick now, const struct mh_message *heard)
{
    struct mh_fixed *f = state;
    if (!comes(f, now)) {
        return;
    }
    if (heard->envelope != MH_ENVELOPE_NONE) {
        hear_envelope(f, heard);
    } else if (heard->kind == MH_MESSAGE_HELLO) {
        (void)mh_neighbours_hello(&f->neighbours, now, &heard->as.hello);
    } else if (heard->kind == MH_MESSAGE_LEAD) {
        mh_fixed_hear_lead(f, &heard->as.lead);
    }
    done(f);
}

static void sent(void *state, mh_tick now, enum mh_sent outcome)
{
    struct mh_fixed *f = state;
    const mh_node_id to = f->link.to;
    const bool is_report = f->link.count > 0 && f->link.queue[f->link.first].message.kind == MH_MESSAGE_REPORT;
    const enum mh_link_outcome found = mh_link_sent(&f->link, now, outcome);
    if (found == MH_LINK_TAKEN || found == MH_LINK_LOST) {
        mh_neighbours_acked(&f->neighbours, to, found == MH_LINK_TAKEN);
    }
    if (comes(f, now)) {
        if (is_report && found == MH_LINK_TAKEN) {
            mh_fixed_report_taken(f, to);
        }
        done(f);
    }
}

static void (*const at[MH_FIXED_TIMERS])(struct mh_fixed *f) = {
    [MH_FIXED_HELLO] = say_hello,    [MH_FIXED_SAY] = mh_fixed_say,   [MH_FIXED_WATCH] = mh_fixed_watch,
    [MH_FIXED_TELL] = mh_fixed_tell, [MH_FIXED_FUSE] = mh_fixed_fuse,
};

static void timer(void *state, mh_tick now)
{
    struct mh_fixed *f = state;
    if (!comes(f, now)) {
        return;
    }
    for (unsigned k = 0; k < MH_FIXED_TIMERS; k++) {
        if (mh_timers_take(&f->set, f->due, k, f->time)) {
            at[k](f);
        }
    }
    done(f);
}

static enum mh_status publish(void *state, mh_tick now, const struct mh_measurement *measurement)
{
    struct mh_fixed *f = state;
    struct mh_message report = {.kind = MH_MESSAGE_REPORT};
    if (!comes(f, now) || f->role != MH_FIXED_MEMBER) {
        return MH_ERR_NO_ROUTE;
    }
    mh_report_from_measurement(measurement, &report.as.report);
    const struct mh_fixed_member *head = mh_fixed_head(f);
    const enum mh_status status = mh_fixed_send(f, &report, head->id, &head->place);
    done(f);
    return status;
}

static void closed(void *state, mh_tick now, mh_tick instant, const struct mh_estimate *estimate,
                   const struct mh_measurement *measurements, size_t count)
{
    struct mh_fixed *f = state;
    (void)estimate;
    (void)measurements;
    (void)count;
    if (comes(f, now)) {
        mh_fixed_closed(f, instant);
        done(f);
    }
}

static void count(const void *state, struct mh_protocol_counters *counters)
{
    const struct mh_fixed *f = state;
    struct mh_fixed_counters *sum = &counters->fixed;
    const struct mh_fixed_counters *more = &f->counters;
    mh_link_count(&f->link, counters);
    sum->led += more->led;
    sum->taken_over += more->taken_over;
    sum->yielded += more->yielded;
    sum->misdirected += more->misdirected;
    sum->summaries += more->summaries;
    sum->taken += more->taken;
    sum->repeated += more->repeated;
    sum->overdue += more->overdue;
    sum->refused += more->refused;
    sum->fused += more->fused;
    sum->corrected += more->corrected;
    sum->uncorrected += more->uncorrected;
}

static mh_wire_types types[] = {&mh_wire_hello, &mh_wire_lead, &mh_wire_report, &mh_wire_hand_over, &mh_wire_taken,
                                &mh_wire_route, NULL};

const struct mh_protocol mh_protocol_fixed = {
    .name = "fixed",
    .state_size = sizeof(struct mh_fixed),
    .config_size = sizeof(struct mh_fixed_config),
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
