#include "motehound/geographic_collection.h"

#include "motehound/geographic.h"
#include "motehound/spread.h"

#include <string.h>

#define HURRIED_HELLOS 3 /* after the first, at an eighth, a quarter and half of the period */

static const struct mh_protocol *const collection = &mh_protocol_collection;

static bool has_come(mh_tick time, mh_tick now) { return !mh_tick_before(now, time); }

static void arm(const struct mh_geographic_collection *g)
{
    mh_tick next = g->hello_time, retry;
    if (g->collection_waits && mh_tick_before(g->collection_time, next)) {
        next = g->collection_time;
    }
    if (mh_link_alarm(&g->link, &retry) && mh_tick_before(retry, next)) {
        next = retry;
    }
    g->node->port->set_timer(g->node->context, next);
}

/* ---- what `collection` asks of the mote it sees ---- */

/* Its only unicasts are reports, and it has none to send. Beacons become landmarks. */
static void inner_send(void *context, mh_node_id destination, const struct mh_message *message)
{
    struct mh_geographic_collection *g = context;
    (void)destination;
    if (message->kind == MH_MESSAGE_BEACON) {
        const struct mh_message landmark = {
            .kind = MH_MESSAGE_LANDMARK,
            .as.landmark = {.beacon = message->as.beacon, .x_mm = g->sink_place.x_mm, .y_mm = g->sink_place.y_mm}};
        mh_link_broadcast(&g->link, &landmark);
    } else {
        mh_link_broadcast(&g->link, message);
    }
}

static void inner_set_timer(void *context, mh_tick time)
{
    struct mh_geographic_collection *g = context;
    g->collection_time = time;
    g->collection_waits = true;
}

static void inner_deliver(void *context, mh_tick now, const struct mh_measurement *measurement)
{
    const struct mh_geographic_collection *g = context;
    g->node->port->deliver(g->node->context, now, measurement);
}

static void inner_asked(void *context, mh_tick now, const struct mh_interest *interest, mh_tick time)
{
    const struct mh_geographic_collection *g = context;
    g->node->port->asked(g->node->context, now, interest, time);
}

static void inner_tracking(void *context, bool tracking)
{
    const struct mh_geographic_collection *g = context;
    g->node->port->tracking(g->node->context, tracking);
}

static void inner_listen(void *context, bool needed)
{
    const struct mh_geographic_collection *g = context;
    g->node->port->listen(g->node->context, needed);
}

static const struct mh_protocol_port inner_port = {
    .send = inner_send,
    .set_timer = inner_set_timer,
    .deliver = inner_deliver,
    .asked = inner_asked,
    .tracking = inner_tracking,
    .listen = inner_listen,
};

/* ---- reports ---- */

static void hand_over(const struct mh_geographic_collection *g, mh_tick now, const struct mh_message *message)
{
    if (g->node->is_head && message->kind == MH_MESSAGE_REPORT) {
        struct mh_measurement measurement;
        mh_report_to_measurement(&message->as.report, &measurement);
        g->node->port->deliver(g->node->context, now, &measurement);
    }
}

/* Send what is due. Whatever does not go on the air leaves the queue, so this ends. */
static void pump(struct mh_geographic_collection *g, mh_tick now)
{
    const struct mh_message *due;
    while ((due = mh_link_due(&g->link, now)) != NULL) {
        const enum mh_hop hop = mh_geographic_send(&g->link, &g->neighbours, g->config->faces, due);
        if (hop == MH_HOP_ARRIVED) {
            hand_over(g, now, due);
            mh_link_finish(&g->link);
        } else if (hop != MH_HOP_NEXT) {
            mh_link_drop(&g->link, mh_geographic_loss(hop));
        }
    }
}

static void hear_envelope(struct mh_geographic_collection *g, mh_tick now, const struct mh_message *heard)
{
    if (heard->header.route.destination != (int32_t)g->node->id) {
        (void)mh_link_take(&g->link, heard); /* counts what it refuses */
    } else if (mh_link_arrive(&g->link, heard) == MH_OK) {
        hand_over(g, now, heard);
    }
}

/* ---- neighbours ---- */

static void say_hello(struct mh_geographic_collection *g, mh_tick now)
{
    const mh_tick period =
        g->hellos < HURRIED_HELLOS ? g->config->hello_period >> (HURRIED_HELLOS - g->hellos) : g->config->hello_period;
    mh_link_hello(&g->link, &g->hellos);
    mh_neighbours_age(&g->neighbours, now);
    /* neighbours that have spoken at the same time do not do so again */
    g->hello_time = now + period - mh_spread(g->node->id, g->hellos, period / 4);
}

static void hear_landmark(struct mh_geographic_collection *g, mh_tick now, const mh_landmark_t *landmark)
{
    const struct mh_message beacon = {.kind = MH_MESSAGE_BEACON, .as.beacon = landmark->beacon};
    collection->message(&g->collection, now, &beacon);
    const bool of_my_sink = g->collection.joined && (mh_node_id)landmark->beacon.sink == g->collection.sink &&
                            (uint16_t)landmark->beacon.round == g->collection.round;
    if (of_my_sink && !g->node->is_head) {
        g->sink_place.x_mm = landmark->x_mm;
        g->sink_place.y_mm = landmark->y_mm;
        g->sink_placed = true;
        mh_neighbours_keep(&g->neighbours, g->collection.sink);
    }
}

/* ---- the table ---- */

static enum mh_status init(void *state, const void *config, const struct mh_protocol_node *node)
{
    struct mh_geographic_collection *g = state;
    const struct mh_geographic_collection_config *chosen = config;
    if (!g || !chosen || !node || chosen->hello_period < 1000 || chosen->hello_period > 600000u) {
        return MH_ERR_ARGUMENT;
    }
    memset(g, 0, sizeof *g);
    g->config = chosen;
    g->node = node;
    g->inner = *node;
    g->inner.port = &inner_port;
    g->inner.context = g;
    g->sink_place = node->place;
    enum mh_status status = collection->init(&g->collection, &chosen->collection, &g->inner);
    if (status == MH_OK) {
        status = mh_link_init(&g->link, &chosen->link, node);
    }
    if (status == MH_OK) {
        status =
            mh_neighbours_init(&g->neighbours, node->id, &node->place, MH_NEIGHBOURS_MAX, chosen->hello_period / 2 * 7);
    }
    return status;
}

static void start(void *state, mh_tick now)
{
    struct mh_geographic_collection *g = state;
    g->hello_time = now + mh_spread(g->node->id, 0, g->config->hello_period >> HURRIED_HELLOS);
    collection->start(&g->collection, now);
    arm(g);
}

static void message(void *state, mh_tick now, const struct mh_message *heard)
{
    struct mh_geographic_collection *g = state;
    if (heard->envelope != MH_ENVELOPE_NONE) {
        hear_envelope(g, now, heard);
    } else if (heard->kind == MH_MESSAGE_HELLO) {
        (void)mh_neighbours_hello(&g->neighbours, now, &heard->as.hello);
    } else if (heard->kind == MH_MESSAGE_LANDMARK) {
        hear_landmark(g, now, &heard->as.landmark);
    } else if (heard->kind == MH_MESSAGE_REQUEST) {
        collection->message(&g->collection, now, heard);
    }
    pump(g, now);
    arm(g);
}

static void sent(void *state, mh_tick now, enum mh_sent outcome)
{
    struct mh_geographic_collection *g = state;
    const mh_node_id to = g->link.to;
    const enum mh_link_outcome found = mh_link_sent(&g->link, now, outcome);
    if (found == MH_LINK_TAKEN || found == MH_LINK_LOST) {
        mh_neighbours_acked(&g->neighbours, to, found == MH_LINK_TAKEN);
    }
    pump(g, now);
    arm(g);
}

static void timer(void *state, mh_tick now)
{
    struct mh_geographic_collection *g = state;
    if (has_come(g->hello_time, now)) {
        say_hello(g, now);
    }
    if (g->collection_waits && has_come(g->collection_time, now)) {
        g->collection_waits = false;
        collection->timer(&g->collection, now);
    }
    pump(g, now);
    arm(g);
}

static enum mh_status publish(void *state, mh_tick now, const struct mh_measurement *measurement)
{
    struct mh_geographic_collection *g = state;
    if (!g->sink_placed) {
        return MH_ERR_NO_ROUTE;
    }
    struct mh_message report = {.kind = MH_MESSAGE_REPORT};
    mh_report_from_measurement(measurement, &report.as.report);
    /* The network's time, unlike the mote's own, goes on over a restart, so the numbers are not those from before it. */
    g->sequence = g->published ? (uint16_t)(g->sequence + 1) : (uint16_t)measurement->time;
    g->published = true;
    mh_geographic_address(&report, g->node->id, (int16_t)g->sequence, g->collection.sink, &g->sink_place);
    const enum mh_status status = mh_link_take(&g->link, &report);
    pump(g, now);
    arm(g);
    return status;
}

static enum mh_status ask(void *state, mh_tick now, const struct mh_interest *interest, mh_tick time)
{
    struct mh_geographic_collection *g = state;
    return collection->ask(&g->collection, now, interest, time);
}

static void tell_tracking(void *state, mh_tick now, bool tracking)
{
    struct mh_geographic_collection *g = state;
    collection->tell_tracking(&g->collection, now, tracking);
    arm(g);
}

static void count(const void *state, struct mh_protocol_counters *counters)
{
    const struct mh_geographic_collection *g = state;
    mh_link_count(&g->link, counters);
}

static mh_wire_types types[] = {
    &mh_wire_landmark, &mh_wire_report, &mh_wire_request, &mh_wire_hello, &mh_wire_route, &mh_wire_face, NULL};

const struct mh_protocol mh_protocol_geographic = {
    .name = "geographic",
    .state_size = sizeof(struct mh_geographic_collection),
    .config_size = sizeof(struct mh_geographic_collection_config),
    .types = types,
    .init = init,
    .start = start,
    .message = message,
    .sent = sent,
    .timer = timer,
    .publish = publish,
    .ask = ask,
    .tell_tracking = tell_tracking,
    .count = count,
};

void mh_geographic_collection_config_default(struct mh_geographic_collection_config *config)
{
    mh_collection_config_default(&config->collection);
    mh_link_config_default(&config->link);
    config->hello_period = 10000;
    config->faces = true;
}
