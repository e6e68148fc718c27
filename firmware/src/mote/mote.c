#include "motehound/mote.h"

#include "motehound/spread.h"

#include <string.h>

static void *protocol_state(const struct mh_mote *mote) { return mote->config->protocol_state; }

/* ---- the network's time and this mote's own ---- */

static bool knows_time(const struct mh_mote *mote)
{
    return !mote->config->clock || mh_clock_synchronised(mote->config->clock_state);
}

static mh_tick network_time(const struct mh_mote *mote, mh_tick own)
{
    return mote->config->clock ? mote->config->clock->network(mote->config->clock_state, own, NULL) : own;
}

static mh_tick own_time(const struct mh_mote *mote, mh_tick network)
{
    return mote->config->clock ? mote->config->clock->local(mote->config->clock_state, network) : network;
}

/* Gather from the first instant at or after `now`, the mote's own time. */
static enum mh_status begin_head(const struct mh_mote *mote, mh_tick now)
{
    struct mh_head *head = mote->config->head_state;
    const enum mh_status status = mh_head_init(head, mote->config->head, network_time(mote, now));
    head->own = mote->node.id;
    return status;
}

/* ---- the alarm ---- */

struct earliest {
    bool wanted;
    mh_tick time;
};

static void want(struct earliest *alarm, mh_tick time)
{
    if (!alarm->wanted || mh_tick_before(time, alarm->time)) {
        alarm->time = time;
    }
    alarm->wanted = true;
}

/* One alarm of the port serves the protocol's timer, the report that waits, the clock's and the head's deadline, which moves with the network's time. The
 * port hears of it when it changes, and after an alarm, which has used it up. */
static void set_alarm(struct mh_mote *mote, bool used_up)
{
    struct earliest alarm = {mote->protocol_alarm_set, mote->protocol_alarm};
    mh_tick time;
    if (mote->report_waits) {
        want(&alarm, mote->report_time);
    }
    if (mote->config->clock && mote->config->clock->due(mote->config->clock_state, &time)) {
        want(&alarm, time);
    }
    if (mote->leads && knows_time(mote)) {
        want(&alarm, own_time(mote, mh_head_deadline(mote->config->head_state)));
    }
    const mh_tick next = alarm.time;
    if (alarm.wanted && (used_up || !mote->alarm_set || mote->alarm != next)) {
        mote->alarm = next;
        mote->alarm_set = true;
        mote->port->set_alarm(mote->port_context, next);
    }
}

static void report(struct mh_mote *mote, mh_tick now, const struct mh_sample *sample, uint8_t flags)
{
    const struct mh_measurement measurement = {
        .node = mote->node.id,
        .place = mote->node.place,
        .time = sample->time,
        .value = sample->value,
        .increment = sample->increment,
        .flags = (uint8_t)(flags | (sample->has_increment ? MH_MEASUREMENT_HAS_INCREMENT : 0)),
        .target = sample->target,
    };
    mote->counters.reports++;
    mote->counters.reports_asked += (flags & MH_MEASUREMENT_ASKED) != 0;
    if (mote->leads) {
        (void)mh_head_measurement(mote->config->head_state, &measurement); /* counts what it refuses */
    } else if (mote->config->protocol->publish(protocol_state(mote), now, &measurement) != MH_OK) {
        mote->counters.reports_no_route++;
        return;
    }
    mh_sensor_mark_reported(&mote->sensor, sample);
}

/* Report the sample if it is worth it or asked for. */
static void report_if_wanted(struct mh_mote *mote, mh_tick now, const struct mh_sample *sample)
{
    const bool asked = mote->asked && mh_sensor_is_of(&mote->sensor, sample, mote->asked_time);
    if (mh_sensor_reports(&mote->sensor, sample, mote->tracking)) {
        report(mote, now, sample, 0);
    } else if (asked) {
        report(mote, now, sample, MH_MEASUREMENT_ASKED);
    }
    /* answered, or the sample asked for is so long overdue that nobody waits for it */
    if (asked || mh_ticks_between(mote->asked_time, sample->time) > 2 * (int32_t)mote->config->sensor->interval) {
        mote->asked = false;
    }
}

static void report_waiting(struct mh_mote *mote, mh_tick now)
{
    struct mh_sample sample;
    mote->report_waits = false;
    if (mh_sensor_recall(&mote->sensor, mote->report_instant, &sample) == MH_OK && !sample.reported) {
        report_if_wanted(mote, now, &sample);
    }
}

/* The same after a wait, if reports are spread. */
static void report_soon(struct mh_mote *mote, mh_tick now, const struct mh_sample *sample)
{
    const mh_tick spread = mote->config->sensor->report_spread;
    if (spread == 0 || mote->leads) {
        report_if_wanted(mote, now, sample);
    } else {
        mote->report_waits = true;
        mote->report_time = now + mh_spread(mote->node.id, sample->time, spread);
        mote->report_instant = sample->time;
    }
}

static void transmit(struct mh_mote *mote, mh_wire_types *types, mh_node_id destination,
                     const struct mh_message *message)
{
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    if (mh_wire_encode(types, message, frame, &length) == MH_OK) {
        mote->counters.frames_sent++;
        mote->port->transmit(mote->port_context, destination, frame, length);
    }
}

/* ---- what the protocol asks of the mote ---- */

static void protocol_send(void *context, mh_node_id destination, const struct mh_message *message)
{
    struct mh_mote *mote = context;
    if (mote->config->clock) {
        mote->config->clock->other_frame(mote->config->clock_state);
    }
    transmit(mote, mote->config->protocol->types, destination, message);
}

static void protocol_set_timer(void *context, mh_tick time)
{
    struct mh_mote *mote = context;
    mote->protocol_alarm = time;
    mote->protocol_alarm_set = true;
}

static void protocol_deliver(void *context, mh_tick now, const struct mh_measurement *measurement)
{
    struct mh_mote *mote = context;
    (void)now;
    if (mote->leads) {
        (void)mh_head_measurement(mote->config->head_state, measurement); /* counts what it refuses */
    }
}

/* The sample of instant `time` is to be reported. Returns true if it is still to be taken. */
static bool ask_for_sample(struct mh_mote *mote, mh_tick now, mh_tick time)
{
    struct mh_sample sample;
    const bool taken = mh_sensor_recall(&mote->sensor, time, &sample) == MH_OK;
    if (taken && sample.reported) {
        return false;
    }
    mote->asked = true;
    mote->asked_time = time;
    if (taken && !mote->report_waits) {
        report_soon(mote, now, &sample);
    }
    return !taken;
}

static void protocol_asked(void *context, mh_tick now, const struct mh_interest *interest, mh_tick time)
{
    struct mh_mote *mote = context;
    if (mote->config->sensor && mh_place_within(&mote->node.place, &interest->centre, interest->radius_mm)) {
        (void)ask_for_sample(mote, now, time);
    }
}

static void protocol_tracking(void *context, bool tracking)
{
    struct mh_mote *mote = context;
    mote->tracking = tracking;
}

static void protocol_listen(void *context, bool needed)
{
    struct mh_mote *mote = context;
    if (mote->may_sleep == needed && !mote->config->clock) {
        mote->may_sleep = !needed;
        if (mote->port->sleep) {
            mote->port->sleep(mote->port_context, mote->may_sleep);
        }
    }
}

/* ---- what a protocol in which motes take turns asks besides ---- */

static bool protocol_network(void *context, mh_tick own, mh_tick *network)
{
    const struct mh_mote *mote = context;
    if (!knows_time(mote)) {
        return false;
    }
    *network = network_time(mote, own);
    return true;
}

static mh_tick protocol_own(void *context, mh_tick network) { return own_time(context, network); }

static void protocol_sense(void *context, mh_tick now, mh_tick time)
{
    struct mh_mote *mote = context;
    if (mote->config->sensor && ask_for_sample(mote, now, time) && mote->port->sense) {
        mote->port->sense(mote->port_context);
    }
}

static enum mh_status protocol_lead(void *context, mh_tick now, const uint8_t *track, size_t length)
{
    struct mh_mote *mote = context;
    const struct mh_head_config *config = mote->config->head;
    struct mh_head *head = mote->config->head_state;
    if (!config || !knows_time(mote) || (length > 0 && !config->tracker->load)) {
        return MH_ERR_ARGUMENT;
    }
    const struct mh_head_counters counters = head->counters;
    enum mh_status status = mh_head_init(head, config, network_time(mote, now) + 1);
    head->own = mote->node.id;
    head->counters = counters;
    if (status == MH_OK && length > 0) {
        status = config->tracker->load(config->tracker_state, track, length);
    }
    mote->leads = status == MH_OK;
    return status;
}

static void protocol_follow(void *context)
{
    struct mh_mote *mote = context;
    mote->leads = false;
}

static enum mh_status protocol_save(void *context, uint8_t *track, size_t *length)
{
    const struct mh_mote *mote = context;
    return mote->leads && mote->config->head->tracker->save
               ? mote->config->head->tracker->save(mote->config->head->tracker_state, track, length)
               : MH_NONE;
}

static enum mh_status protocol_expect(void *context, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_mote *mote = context;
    return mote->leads ? mote->config->head->tracker->predict(mote->config->head->tracker_state, time, estimate)
                       : MH_NONE;
}

static void protocol_restart(void *context)
{
    const struct mh_mote *mote = context;
    if (mote->leads && mote->config->head->tracker->restart) {
        mote->config->head->tracker->restart(mote->config->head->tracker_state);
    }
}

static enum mh_status protocol_score(void *context, mh_node_id candidate, const struct mh_place *places, size_t count,
                                     mh_real *score)
{
    const struct mh_mote *mote = context;
    return mote->leads && mote->config->head->tracker->score
               ? mote->config->head->tracker->score(mote->config->head->tracker_state, candidate, places, count, score)
               : MH_NONE;
}

static void protocol_tell(void *context, const struct mh_estimate *estimate)
{
    const struct mh_mote *mote = context;
    if (mote->port->report) {
        mote->port->report(mote->port_context, estimate);
    }
}

static const struct mh_protocol_port protocol_port = {
    .send = protocol_send,
    .set_timer = protocol_set_timer,
    .deliver = protocol_deliver,
    .asked = protocol_asked,
    .tracking = protocol_tracking,
    .listen = protocol_listen,
    .network = protocol_network,
    .own = protocol_own,
    .sense = protocol_sense,
    .lead = protocol_lead,
    .follow = protocol_follow,
    .save = protocol_save,
    .expect = protocol_expect,
    .restart = protocol_restart,
    .score = protocol_score,
    .tell = protocol_tell,
};

/* ---- the events ---- */

enum mh_status mh_mote_init(struct mh_mote *mote, const struct mh_mote_config *config, const struct mh_port *port,
                            void *port_context, mh_tick now)
{
    if (!mote || !config || !port || !port->transmit || !port->set_alarm || config->id >= MH_BROADCAST ||
        !mh_coordinate_valid(config->place.x_mm) || !mh_coordinate_valid(config->place.y_mm) ||
        !mh_coordinate_valid(config->place.z_mm) || !config->protocol || !config->protocol_state ||
        (config->head && (!config->head_state || !port->report)) || (config->clock && !config->clock_state)) {
        return MH_ERR_ARGUMENT;
    }
    memset(mote, 0, sizeof *mote);
    mote->config = config;
    mote->port = port;
    mote->port_context = port_context;
    const struct mh_protocol_node node = {config->id, config->place, config->head != NULL, &protocol_port, mote};
    mote->node = node;
    mote->leads = config->head && !config->protocol->in_turns;
    enum mh_status status = MH_OK;
    if (config->clock) {
        status = config->clock->init(config->clock_state, config->clock_config, config->id, now);
    }
    if (status == MH_OK && config->sensor) {
        status = mh_sensor_init(&mote->sensor, config->sensor);
    }
    if (status == MH_OK && config->head) {
        status = begin_head(mote, now);
    }
    if (status == MH_OK) {
        status = config->protocol->init(config->protocol_state, config->protocol_config, &mote->node);
    }
    if (status == MH_OK) {
        config->protocol->start(config->protocol_state, now);
        set_alarm(mote, true);
    }
    return status;
}

enum mh_status mh_mote_reading(struct mh_mote *mote, mh_tick now, const struct mh_reading *reading)
{
    if (!mote->config->sensor) {
        return MH_ERR_ARGUMENT;
    }
    if (!knows_time(mote)) {
        mote->counters.readings_unsynchronised++;
        return MH_ERR_TIME;
    }
    if (mote->report_waits) {
        report_waiting(mote, now); /* late, or of another target */
    }
    struct mh_sample sample;
    struct mh_reading stamped = *reading;
    stamped.time = network_time(mote, reading->time);
    const enum mh_status status =
        mh_tick_before(now, reading->time) ? MH_ERR_TIME : mh_sensor_take(&mote->sensor, &stamped, &sample);
    if (status != MH_OK) {
        if (status == MH_ERR_REPEATED) {
            mote->counters.readings_repeated++;
        } else {
            mote->counters.readings_refused++;
        }
        return status;
    }
    mote->counters.readings++;
    report_soon(mote, now, &sample);
    set_alarm(mote, false);
    return MH_OK;
}

static void tell_tracking(struct mh_mote *mote, mh_tick now)
{
    if (mote->config->protocol->tell_tracking) {
        mote->config->protocol->tell_tracking(protocol_state(mote), now, mote->tracking);
    }
}

/* What was kept under the time before means nothing now. */
static void time_jumped(struct mh_mote *mote, mh_tick now)
{
    const struct mh_mote_config *config = mote->config;
    mote->asked = false;
    mote->report_waits = false;
    if (config->sensor) {
        (void)mh_sensor_init(&mote->sensor, config->sensor);
    }
    if (mote->leads && !config->protocol->in_turns) {
        (void)begin_head(mote, now);
        if (mote->tracking) {
            mote->tracking = false;
            tell_tracking(mote, now);
        }
    }
    mote->leads = mote->leads && !config->protocol->in_turns;
    if (config->protocol->time_jumped) {
        config->protocol->time_jumped(protocol_state(mote), now);
    }
}

/* What neither the protocol nor the clock speaks is nothing to this mote. */
static enum mh_status decode(const struct mh_mote *mote, const uint8_t *frame, size_t length,
                             struct mh_message *message)
{
    const enum mh_status status = mh_wire_decode(mote->config->protocol->types, frame, length, message);
    return status == MH_ERR_UNKNOWN && mote->config->clock
               ? mh_wire_decode(mote->config->clock->types, frame, length, message)
               : status;
}

/* -> jumped: whether the network's time has. A function of its own: the message is off the stack before all begins anew. */
static enum mh_status hear(struct mh_mote *mote, mh_tick now, const uint8_t *frame, size_t length, bool *jumped)
{
    struct mh_message message;
    const enum mh_status status = decode(mote, frame, length, &message);
    *jumped = false;
    if (status == MH_OK && message.kind != MH_MESSAGE_SYNC) {
        mote->config->protocol->message(protocol_state(mote), now, &message);
    } else if (status == MH_OK && mote->config->clock) {
        *jumped = mote->config->clock->message(mote->config->clock_state, now, &message.as.sync);
    }
    return status;
}

enum mh_status mh_mote_frame(struct mh_mote *mote, mh_tick now, const uint8_t *frame, size_t length)
{
    bool jumped;
    const enum mh_status status = hear(mote, now, frame, length, &jumped);
    if (status == MH_OK) {
        mote->counters.frames_received++;
        if (jumped) {
            time_jumped(mote, now);
        }
        set_alarm(mote, false);
    } else if (status == MH_ERR_UNKNOWN) {
        mote->counters.frames_unknown++;
    } else {
        mote->counters.frames_corrupt++;
    }
    return status;
}

void mh_mote_sent(struct mh_mote *mote, mh_tick now, enum mh_sent outcome)
{
    const bool of_clock = mote->config->clock && mote->config->clock->sent(mote->config->clock_state, now, outcome);
    if (!of_clock && mote->config->protocol->sent) {
        mote->config->protocol->sent(protocol_state(mote), now, outcome);
    }
    set_alarm(mote, false);
}

static void close_instant(struct mh_mote *mote, mh_tick now)
{
    struct mh_head *head = mote->config->head_state;
    const struct mh_protocol *protocol = mote->config->protocol;
    struct mh_estimate estimate;
    uint16_t used;
    const bool found = mh_head_step(head, &estimate, &used) == MH_OK;
    if (found) {
        mote->port->report(mote->port_context, &estimate);
    }
    if (mote->tracking != head->tracking) {
        mote->tracking = head->tracking;
        tell_tracking(mote, now);
    }
    if (protocol->closed) {
        protocol->closed(protocol_state(mote), now, head->instant, found ? &estimate : NULL, head->measurements, used);
    }
    mh_head_go_on(head, used);
}

/* Whom the tracker wants to hear of at the next instant. */
static void ask_for_interest(struct mh_mote *mote, mh_tick now)
{
    const struct mh_head *head = mote->config->head_state;
    const struct mh_protocol *protocol = mote->config->protocol;
    const struct mh_tracker *tracker = mote->config->head->tracker;
    struct mh_interest interest;
    if (mote->leads && tracker->interest && tracker->interest(mote->config->head->tracker_state, &interest) == MH_OK) {
        if (protocol->ask) {
            (void)protocol->ask(protocol_state(mote), now, &interest, head->instant);
        }
        protocol_asked(mote, now, &interest, head->instant);
    }
}

static void ring_clock(struct mh_mote *mote, mh_tick now)
{
    struct mh_message message;
    if (mote->config->clock && mote->config->clock->timer(mote->config->clock_state, now, &message)) {
        transmit(mote, mote->config->clock->types, MH_BROADCAST, &message);
    }
}

void mh_mote_alarm(struct mh_mote *mote, mh_tick now)
{
    if (mote->protocol_alarm_set && !mh_tick_before(now, mote->protocol_alarm)) {
        mote->protocol_alarm_set = false;
        mote->config->protocol->timer(protocol_state(mote), now);
    }
    if (mote->report_waits && !mh_tick_before(now, mote->report_time)) {
        report_waiting(mote, now);
    }
    ring_clock(mote, now);
    if (mote->leads && knows_time(mote) &&
        !mh_tick_before(network_time(mote, now), mh_head_deadline(mote->config->head_state))) {
        close_instant(mote, now);
        ask_for_interest(mote, now);
    }
    set_alarm(mote, true);
}
