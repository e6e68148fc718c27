#include "motehound/collection.h"

#include "motehound/retry.h"

#include <string.h>

#define REFUSALS_MAX 3 /* in a row, of a parent */
#define NEWS_SHARE 8   /* a path shorter by this part of its hops is worth another relay within a round */

static mh_tick earlier(mh_tick a, mh_tick b) { return mh_tick_before(a, b) ? a : b; }

static bool has_come(mh_tick time, mh_tick now) { return !mh_tick_before(now, time); }

static mh_tick spread(const struct mh_collection *c, mh_tick limit)
{
    return mh_spread(c->node->id, (uint32_t)c->round << 16 | c->hops, limit);
}

static void arm(struct mh_collection *c)
{
    mh_tick next = c->upkeep_time;
    if (c->beacon_waits) {
        next = earlier(next, c->beacon_time);
    }
    if (c->request_waits) {
        next = earlier(next, c->request_time);
    }
    for (uint8_t i = 0; i < MH_COLLECTION_KEPT_MAX; i++) {
        if (c->kept[i].attempts > 0) {
            next = earlier(next, c->kept[i].due);
        }
    }
    c->node->port->set_timer(c->node->context, next);
}

static void send(struct mh_collection *c, mh_node_id destination, const struct mh_message *message)
{
    c->sent++;
    c->node->port->send(c->node->context, destination, message);
}

static void count(uint16_t *counter)
{
    if (*counter < UINT16_MAX) {
        (*counter)++;
    }
}

static void drop(struct mh_collection *c, enum mh_loss reason) { count(&c->lost[reason]); }

/* ---- the tree ---- */

static void send_beacon(struct mh_collection *c, mh_node_id sink)
{
    const struct mh_message message = {.kind = MH_MESSAGE_BEACON,
                                       .as.beacon = {.sender = (int32_t)c->node->id,
                                                     .sink = (int32_t)sink,
                                                     .round = (int16_t)c->round,
                                                     .hops = c->hops,
                                                     .tracking = c->tracking}};
    send(c, MH_BROADCAST, &message);
}

static void begin_round(struct mh_collection *c, mh_tick now)
{
    c->round++;
    c->beacon_waits = false;
    c->upkeep_time = now + c->config->beacon_period;
    send_beacon(c, c->node->id);
}

static void wait_to_relay_beacon(struct mh_collection *c, mh_tick now)
{
    c->beacon_waits = true;
    c->beacon_copies = 0;
    c->beacon_time = now + 1 + spread(c, c->config->beacon_wait);
}

static int16_t rounds_newer(const struct mh_collection *c, const mh_beacon_t *beacon)
{
    return (int16_t)((uint16_t)beacon->round - c->round);
}

static bool is_better(const struct mh_collection *c, const mh_beacon_t *beacon)
{
    const bool nearer = beacon->hops + 1 < c->hops;
    if (!c->joined) {
        return true;
    }
    if ((mh_node_id)beacon->sink != c->sink) {
        return nearer || c->stale;
    }
    /* In the same round a path as short as the lost one is welcome too: it cannot lead back here. */
    const bool instead = c->stale && (mh_node_id)beacon->sender != c->parent && beacon->hops < c->hops;
    const int16_t newer = rounds_newer(c, beacon);
    return newer == 0 ? nearer || instead : newer > 0 || c->stale;
}

/* Where many relay, paths get shorter hop by hop as later beacons come in. Those farther out need not hear of each: they
 * want a parent nearer than themselves, and that it stays. */
static bool is_news(const struct mh_collection *c, const mh_beacon_t *beacon)
{
    const bool same =
        c->joined && !c->stale && (mh_node_id)beacon->sink == c->sink && (uint16_t)beacon->round == c->round;
    return !same || c->beacon_waits || (c->hops - (beacon->hops + 1)) * NEWS_SHARE >= c->hops;
}

static void join(struct mh_collection *c, mh_tick now, const mh_beacon_t *beacon)
{
    const bool news = is_news(c, beacon);
    c->sink = (mh_node_id)beacon->sink;
    c->parent = (mh_node_id)beacon->sender;
    c->round = (uint16_t)beacon->round;
    c->hops = (uint8_t)(beacon->hops + 1);
    c->joined = true;
    c->stale = false;
    c->refused = 0;
    c->upkeep_time = now + 2 * c->config->beacon_period + spread(c, c->config->beacon_period);
    if (news) {
        wait_to_relay_beacon(c, now);
    }
    if (c->tracking != (beacon->tracking != 0)) {
        c->tracking = !c->tracking;
        c->node->port->tracking(c->node->context, c->tracking);
    }
}

static void ask_for_a_path(struct mh_collection *c, mh_tick now)
{
    c->stale = true;
    c->refused = 0;
    c->beacon_waits = false;
    c->upkeep_time = now + c->config->beacon_period;
    send_beacon(c, MH_BROADCAST);
}

/* A sink that has been restarted counts from 1 while its field remembers more. Its neighbours answer with the round they know,
 * as they answer a neighbour without a path, and the sink goes on from there; else the old tree would outlive it. */
static void hear_beacon(struct mh_collection *c, mh_tick now, const mh_beacon_t *beacon)
{
    const bool of_my_sink = c->joined && (mh_node_id)beacon->sink == c->sink;
    const bool begun_anew = of_my_sink && beacon->hops == 0 && rounds_newer(c, beacon) < 0;
    if (c->node->is_head && of_my_sink) {
        if (rounds_newer(c, beacon) > 0) {
            c->round = (uint16_t)beacon->round;
            begin_round(c, now);
        }
    } else if ((mh_node_id)beacon->sink == MH_BROADCAST || (begun_anew && !c->stale)) {
        if (c->joined && !c->stale && !c->beacon_waits) {
            wait_to_relay_beacon(c, now);
        }
    } else if (!c->node->is_head && beacon->hops < MH_HOPS_MAX && is_better(c, beacon)) {
        join(c, now, beacon);
    } else if (c->beacon_waits && of_my_sink && (uint16_t)beacon->round == c->round && beacon->hops <= c->hops) {
        c->beacon_waits = ++c->beacon_copies < c->config->suppress_after;
    }
}

/* ---- reports, up the tree ---- */

static void send_up(struct mh_collection *c, const struct mh_measurement *measurement, uint8_t hops)
{
    struct mh_message message = {.kind = MH_MESSAGE_REPORT};
    mh_report_from_measurement(measurement, &message.as.report);
    message.as.report.sender = (int32_t)c->node->id;
    message.as.report.hops = hops;
    send(c, c->parent, &message);
}

static void send_kept(struct mh_collection *c, mh_tick now, struct mh_collection_kept *kept)
{
    kept->in_air = true;
    kept->frame = c->sent;
    kept->due = now + MH_RETRY_PATIENCE;
    kept->attempts++;
    send_up(c, &kept->measurement, kept->hops);
}

/* A report goes out at once, whether or not there is room to keep it. */
static void send_report(struct mh_collection *c, mh_tick now, const struct mh_measurement *measurement, uint8_t hops)
{
    for (uint8_t i = 0; i < MH_COLLECTION_KEPT_MAX; i++) {
        if (c->kept[i].attempts == 0) {
            c->kept[i].measurement = *measurement;
            c->kept[i].hops = hops;
            send_kept(c, now, &c->kept[i]);
            return;
        }
    }
    send_up(c, measurement, hops);
}

/* The radio could not deliver it. */
static void wait_or_drop(struct mh_collection *c, mh_tick now, struct mh_collection_kept *kept)
{
    kept->in_air = false;
    if (kept->attempts >= c->config->attempts) {
        kept->attempts = 0;
        drop(c, MH_LOSS_NOT_ACKNOWLEDGED);
    } else {
        count(&c->retries);
        kept->due = now + mh_retry_wait(c->config->backoff, kept->attempts, c->node->id, c->retries);
    }
}

/* A radio that has forgotten a frame has forgotten those before it too. */
static void forget(struct mh_collection *c, mh_tick now, struct mh_collection_kept *kept)
{
    const uint8_t after_it = (uint8_t)(c->sent - kept->frame - 1);
    if (after_it < (uint8_t)(c->sent - c->told)) {
        c->told = (uint8_t)(c->sent - after_it);
    }
    wait_or_drop(c, now, kept);
}

static void send_again(struct mh_collection *c, mh_tick now)
{
    for (uint8_t i = 0; i < MH_COLLECTION_KEPT_MAX; i++) {
        struct mh_collection_kept *kept = &c->kept[i];
        if (kept->attempts == 0 || !has_come(kept->due, now)) {
            continue;
        }
        if (!kept->in_air) {
            send_kept(c, now, kept);
            return; /* others that are due set off the alarm at once */
        }
        forget(c, now, kept);
    }
}

/* The report in the frame whose fate is told, or NULL. */
static struct mh_collection_kept *find_sent(struct mh_collection *c)
{
    for (uint8_t i = 0; i < MH_COLLECTION_KEPT_MAX; i++) {
        if (c->kept[i].attempts > 0 && c->kept[i].in_air && c->kept[i].frame == c->told) {
            return &c->kept[i];
        }
    }
    return NULL;
}

static void hear_report(struct mh_collection *c, mh_tick now, const mh_report_t *report)
{
    if (c->node->is_head) {
        struct mh_measurement measurement;
        mh_report_to_measurement(report, &measurement);
        c->node->port->deliver(c->node->context, now, &measurement);
        return;
    }
    if (!c->joined || report->hops >= MH_HOPS_MAX) {
        drop(c, c->joined ? MH_LOSS_HOPS : MH_LOSS_NO_ROUTE);
        return;
    }
    const bool from_parent = (mh_node_id)report->sender == c->parent;
    if (from_parent || (mh_node_id)report->origin == c->node->id) {
        drop(c, MH_LOSS_LOOP);
        if (from_parent && !c->stale) {
            ask_for_a_path(c, now);
        }
        return;
    }
    struct mh_measurement measurement;
    mh_report_to_measurement(report, &measurement);
    send_report(c, now, &measurement, (uint8_t)(report->hops + 1));
}

/* Broadcasts are not acknowledged: only the parent can refuse, and that they are out does not speak for it. */
static void sent(void *state, mh_tick now, enum mh_sent outcome)
{
    struct mh_collection *c = state;
    struct mh_collection_kept *kept = find_sent(c);
    c->told = (uint8_t)(c->told + (c->told != c->sent));
    if (kept && outcome == MH_SENT_OK) {
        kept->attempts = 0;
    } else if (kept) {
        wait_or_drop(c, now, kept);
    } else if (outcome == MH_SENT_NO_ACK) {
        drop(c, MH_LOSS_NOT_ACKNOWLEDGED);
    }
    if (outcome == MH_SENT_OK) {
        c->refused = kept ? 0 : c->refused;
    } else if (outcome == MH_SENT_NO_ACK && ++c->refused == REFUSALS_MAX) {
        ask_for_a_path(c, now);
    }
    arm(c);
}

/* ---- requests, towards a place ---- */

static bool remember(struct mh_collection *c, const mh_request_t *request)
{
    for (uint8_t i = 0; i < MH_COLLECTION_SEEN_MAX; i++) {
        if (c->seen[i].origin == (mh_node_id)request->origin && c->seen[i].time == (mh_tick)request->time_ms) {
            return false;
        }
    }
    c->seen[c->seen_next].origin = (mh_node_id)request->origin;
    c->seen[c->seen_next].time = (mh_tick)request->time_ms;
    c->seen_next = (uint8_t)((c->seen_next + 1) % MH_COLLECTION_SEEN_MAX);
    return true;
}

/* The first copy: pass it on upwards in this mote and, if that helps, to the neighbours. */
static void consider_request(struct mh_collection *c, mh_tick now, const mh_request_t *request,
                             const struct mh_place *sender, const struct mh_interest *interest, bool covered)
{
    c->node->port->asked(c->node->context, now, interest, (mh_tick)request->time_ms);
    const uint32_t range = c->config->range_mm;
    const uint32_t from_sender = mh_place_distance_mm(sender, &interest->centre);
    const uint32_t from_here = mh_place_distance_mm(&c->node->place, &interest->centre);
    if (covered || request->hops >= MH_HOPS_MAX || (from_here >= from_sender && from_here > interest->radius_mm)) {
        return;
    }
    const uint32_t progress = from_here < from_sender ? from_sender - from_here : 0;
    mh_tick wait = 0;
    if (progress < range) { /* the square root spreads the few that are nearly the best */
        wait =
            (mh_tick)((uint64_t)c->config->request_wait * mh_square_root((uint64_t)(range - progress) * range) / range);
    }
    /* progress at least cos 30 degrees of the hop: such nodes stand in a sector as wide as its radius, so they hear each other */
    const bool ahead = (uint64_t)8 * progress >= (uint64_t)7 * mh_place_distance_mm(&c->node->place, sender);
    if (!ahead && from_here > interest->radius_mm) {
        wait += c->config->request_wait;
        if (progress < range / 2) {
            return;
        }
    }
    c->request.origin = (mh_node_id)request->origin;
    c->request.time = (mh_tick)request->time_ms;
    c->request.x_mm = request->x_mm;
    c->request.y_mm = request->y_mm;
    c->request.radius_mm = request->radius_mm;
    c->request.hops = (uint8_t)(request->hops + 1);
    c->request_waits = true;
    c->request_copies = 0;
    c->request_time = now + 1 + wait;
}

static void hear_request(struct mh_collection *c, mh_tick now, const mh_request_t *request)
{
    if ((mh_node_id)request->origin == c->node->id) {
        return;
    }
    const struct mh_interest interest = {{request->x_mm, request->y_mm, 0}, (uint32_t)request->radius_mm};
    const struct mh_place sender = {request->sender_x_mm, request->sender_y_mm, 0};
    const uint32_t range = c->config->range_mm;
    const bool covered =
        interest.radius_mm <= range && mh_place_within(&sender, &interest.centre, range - interest.radius_mm);
    if (remember(c, request)) {
        consider_request(c, now, request, &sender, &interest, covered);
    } else if (c->request_waits && c->request.origin == (mh_node_id)request->origin &&
               c->request.time == (mh_tick)request->time_ms) {
        const bool inside = mh_place_within(&c->node->place, &interest.centre, interest.radius_mm);
        const bool needless = inside ? ++c->request_copies >= c->config->suppress_after
                                     : mh_place_distance_mm(&sender, &interest.centre) <=
                                           mh_place_distance_mm(&c->node->place, &interest.centre);
        c->request_waits = !covered && !needless;
    }
}

static void send_request(struct mh_collection *c, const mh_request_t *request)
{
    struct mh_message message = {.kind = MH_MESSAGE_REQUEST, .as.request = *request};
    message.as.request.sender = (int32_t)c->node->id;
    message.as.request.sender_x_mm = c->node->place.x_mm;
    message.as.request.sender_y_mm = c->node->place.y_mm;
    send(c, MH_BROADCAST, &message);
}

/* ---- the table ---- */

static enum mh_status init(void *state, const void *config, const struct mh_protocol_node *node)
{
    struct mh_collection *c = state;
    const struct mh_collection_config *chosen = config;
    if (!c || !chosen || !node || chosen->beacon_period < 1000 || chosen->beacon_period > 3600000u ||
        chosen->beacon_wait < 1 || chosen->beacon_wait > 1000 || chosen->request_wait < 1 ||
        chosen->request_wait > 1000 || chosen->suppress_after < 1 || chosen->range_mm < 1 ||
        chosen->range_mm > 1000000000u || chosen->attempts < 1 || chosen->attempts > 100 || chosen->backoff < 1 ||
        chosen->backoff > 1000) {
        return MH_ERR_ARGUMENT;
    }
    memset(c, 0, sizeof *c);
    c->config = chosen;
    c->node = node;
    for (uint8_t i = 0; i < MH_COLLECTION_SEEN_MAX; i++) {
        c->seen[i].origin = MH_BROADCAST;
    }
    return MH_OK;
}

static void start(void *state, mh_tick now)
{
    struct mh_collection *c = state;
    if (c->node->is_head) {
        c->sink = c->node->id;
        c->joined = true;
        c->upkeep_time = now + c->config->beacon_wait; /* the others need a moment to come up */
    } else {
        /* soon: a node that the first round does not reach should not wait for the second */
        c->upkeep_time = now + c->config->beacon_period / 8 + spread(c, c->config->beacon_period / 8);
    }
    arm(c);
}

static void message(void *state, mh_tick now, const struct mh_message *heard)
{
    struct mh_collection *c = state;
    if (heard->envelope != MH_ENVELOPE_NONE) {
        return;
    }
    switch (heard->kind) {
    case MH_MESSAGE_BEACON:
        hear_beacon(c, now, &heard->as.beacon);
        break;
    case MH_MESSAGE_REPORT:
        hear_report(c, now, &heard->as.report);
        break;
    case MH_MESSAGE_REQUEST:
        hear_request(c, now, &heard->as.request);
        break;
    default:
        break;
    }
    arm(c);
}

static void timer(void *state, mh_tick now)
{
    struct mh_collection *c = state;
    if (c->beacon_waits && has_come(c->beacon_time, now)) {
        c->beacon_waits = false;
        send_beacon(c, c->sink);
    }
    if (c->request_waits && has_come(c->request_time, now)) {
        c->request_waits = false;
        const mh_request_t request = {.origin = (int32_t)c->request.origin,
                                      .time_ms = (int32_t)c->request.time,
                                      .x_mm = c->request.x_mm,
                                      .y_mm = c->request.y_mm,
                                      .radius_mm = c->request.radius_mm,
                                      .hops = c->request.hops};
        send_request(c, &request);
    }
    send_again(c, now);
    if (has_come(c->upkeep_time, now)) {
        if (c->node->is_head) {
            begin_round(c, now);
        } else {
            ask_for_a_path(c, now);
        }
    }
    arm(c);
}

static enum mh_status publish(void *state, mh_tick now, const struct mh_measurement *measurement)
{
    struct mh_collection *c = state;
    if (!c->joined || c->node->is_head) {
        return MH_ERR_NO_ROUTE;
    }
    send_report(c, now, measurement, 0);
    return MH_OK;
}

static enum mh_status ask(void *state, mh_tick now, const struct mh_interest *interest, mh_tick time)
{
    struct mh_collection *c = state;
    (void)now;
    if (!c->node->is_head) {
        return MH_ERR_ARGUMENT;
    }
    const mh_request_t request = {
        .origin = (int32_t)c->node->id,
        .time_ms = (int32_t)time,
        .x_mm = interest->centre.x_mm,
        .y_mm = interest->centre.y_mm,
        .radius_mm = interest->radius_mm < INT32_MAX ? (int32_t)interest->radius_mm : INT32_MAX,
    };
    send_request(c, &request);
    return MH_OK;
}

static void tell_tracking(void *state, mh_tick now, bool tracking)
{
    struct mh_collection *c = state;
    if (c->node->is_head && c->tracking != tracking) {
        c->tracking = tracking;
        begin_round(c, now);
        arm(c);
    }
}

static void add_counters(const void *state, struct mh_protocol_counters *counters)
{
    const struct mh_collection *c = state;
    for (int reason = 0; reason < MH_LOSSES; reason++) {
        counters->lost[reason] += c->lost[reason];
    }
    counters->retries += c->retries;
}

static mh_wire_types types[] = {&mh_wire_beacon, &mh_wire_report, &mh_wire_request, NULL};

const struct mh_protocol mh_protocol_collection = {
    .name = "collection",
    .state_size = sizeof(struct mh_collection),
    .config_size = sizeof(struct mh_collection_config),
    .types = types,
    .init = init,
    .start = start,
    .message = message,
    .sent = sent,
    .timer = timer,
    .publish = publish,
    .ask = ask,
    .tell_tracking = tell_tracking,
    .count = add_counters,
};

void mh_collection_config_default(struct mh_collection_config *config)
{
    const struct mh_collection_config nominal = {.beacon_period = 30000,
                                                 .beacon_wait = 100,
                                                 .request_wait = 40,
                                                 .suppress_after = 3,
                                                 .range_mm = 15000,
                                                 .attempts = 5,
                                                 .backoff = 20};
    *config = nominal;
}
