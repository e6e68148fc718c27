#include "motehound/direct.h"

#include <string.h>

static void wake_at(struct mh_direct *d, mh_tick time)
{
    d->waits = true;
    d->wake_time = time;
    d->node->port->set_timer(d->node->context, time);
}

static void send_beacon(struct mh_direct *d, mh_tick now)
{
    const struct mh_message message = {.kind = MH_MESSAGE_BEACON,
                                       .as.beacon = {.sender = (int32_t)d->node->id,
                                                     .sink = (int32_t)d->node->id,
                                                     .round = (int16_t)++d->round,
                                                     .tracking = d->tracking}};
    d->node->port->send(d->node->context, MH_BROADCAST, &message);
    wake_at(d, now + d->config->beacon_period);
}

static void hear_beacon(struct mh_direct *d, mh_tick now, const mh_beacon_t *beacon)
{
    if (beacon->sink != beacon->sender) {
        return; /* not a head's own */
    }
    d->head = (mh_node_id)beacon->sink;
    d->known = true;
    if (d->tracking != (beacon->tracking != 0)) {
        d->tracking = !d->tracking;
        d->node->port->tracking(d->node->context, d->tracking);
    }
    if (d->config->sleeps) {
        d->node->port->listen(d->node->context, false);
        wake_at(d, now + d->config->beacon_period - d->config->beacon_period / 16);
    }
}

static enum mh_status init(void *state, const void *config, const struct mh_protocol_node *node)
{
    struct mh_direct *d = state;
    const struct mh_direct_config *chosen = config;
    if (!d || !chosen || !node || chosen->beacon_period < 1000 || chosen->beacon_period > 3600000u) {
        return MH_ERR_ARGUMENT;
    }
    memset(d, 0, sizeof *d);
    d->config = chosen;
    d->node = node;
    return MH_OK;
}

static void start(void *state, mh_tick now)
{
    struct mh_direct *d = state;
    if (d->node->is_head) {
        wake_at(d, now + 1); /* the others need a moment to come up */
    }
}

static void message(void *state, mh_tick now, const struct mh_message *heard)
{
    struct mh_direct *d = state;
    if (heard->envelope != MH_ENVELOPE_NONE) {
        return;
    }
    if (d->node->is_head) {
        if (heard->kind == MH_MESSAGE_REPORT) {
            struct mh_measurement measurement;
            mh_report_to_measurement(&heard->as.report, &measurement);
            d->node->port->deliver(d->node->context, now, &measurement);
        }
    } else if (heard->kind == MH_MESSAGE_BEACON) {
        hear_beacon(d, now, &heard->as.beacon);
    } else if (heard->kind == MH_MESSAGE_REQUEST) {
        const mh_request_t *request = &heard->as.request;
        const struct mh_interest interest = {{request->x_mm, request->y_mm, 0}, (uint32_t)request->radius_mm};
        d->node->port->asked(d->node->context, now, &interest, (mh_tick)request->time_ms);
    }
}

static void timer(void *state, mh_tick now)
{
    struct mh_direct *d = state;
    if (!d->waits || mh_tick_before(now, d->wake_time)) {
        return;
    }
    d->waits = false;
    if (d->node->is_head) {
        send_beacon(d, now);
    } else {
        d->node->port->listen(d->node->context, true);
    }
}

static enum mh_status publish(void *state, mh_tick now, const struct mh_measurement *measurement)
{
    const struct mh_direct *d = state;
    (void)now;
    if (!d->known) {
        return MH_ERR_NO_ROUTE;
    }
    struct mh_message report = {.kind = MH_MESSAGE_REPORT};
    mh_report_from_measurement(measurement, &report.as.report);
    d->node->port->send(d->node->context, d->head, &report);
    return MH_OK;
}

static enum mh_status ask(void *state, mh_tick now, const struct mh_interest *interest, mh_tick time)
{
    const struct mh_direct *d = state;
    (void)now;
    if (!d->node->is_head) {
        return MH_ERR_ARGUMENT;
    }
    const struct mh_message request = {
        .kind = MH_MESSAGE_REQUEST,
        .as.request = {.sender = (int32_t)d->node->id,
                       .origin = (int32_t)d->node->id,
                       .time_ms = (int32_t)time,
                       .x_mm = interest->centre.x_mm,
                       .y_mm = interest->centre.y_mm,
                       .radius_mm = interest->radius_mm < INT32_MAX ? (int32_t)interest->radius_mm : INT32_MAX,
                       .sender_x_mm = d->node->place.x_mm,
                       .sender_y_mm = d->node->place.y_mm}};
    d->node->port->send(d->node->context, MH_BROADCAST, &request);
    return MH_OK;
}

static void tell_tracking(void *state, mh_tick now, bool tracking)
{
    struct mh_direct *d = state;
    if (d->node->is_head && d->tracking != tracking) {
        d->tracking = tracking;
        send_beacon(d, now);
    }
}

static mh_wire_types types[] = {&mh_wire_beacon, &mh_wire_report, &mh_wire_request, NULL};

const struct mh_protocol mh_protocol_direct = {
    .name = "direct",
    .state_size = sizeof(struct mh_direct),
    .config_size = sizeof(struct mh_direct_config),
    .types = types,
    .init = init,
    .start = start,
    .message = message,
    .timer = timer,
    .publish = publish,
    .ask = ask,
    .tell_tracking = tell_tracking,
};

void mh_direct_config_default(struct mh_direct_config *config)
{
    const struct mh_direct_config nominal = {.beacon_period = 10000, .sleeps = false};
    *config = nominal;
}
