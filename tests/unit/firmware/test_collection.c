/* One mote's side of `collection`, message by message. Whole networks: tests/network. */
#include "motehound/collection.h"
#include "motehound/retry.h"
#include "port.h"
#include "unity.h"

#include <string.h>

static struct {
    unsigned sent, asked, delivered, told;
    mh_node_id destination;
    struct mh_message message; /* the last one sent */
    mh_tick timer;
    bool tracking;
} saw;

static void send(void *context, mh_node_id destination, const struct mh_message *message)
{
    (void)context;
    saw.sent++;
    saw.destination = destination;
    saw.message = *message;
}

static void set_timer(void *context, mh_tick time)
{
    (void)context;
    saw.timer = time;
}

static void deliver(void *context, mh_tick now, const struct mh_measurement *measurement)
{
    (void)context;
    (void)now;
    (void)measurement;
    saw.delivered++;
}

static void asked(void *context, mh_tick now, const struct mh_interest *interest, mh_tick time)
{
    (void)context;
    (void)now;
    (void)interest;
    (void)time;
    saw.asked++;
}

static void tracking(void *context, bool now_tracking)
{
    (void)context;
    saw.told++;
    saw.tracking = now_tracking;
}

static const struct mh_protocol_port port = {
    .send = send, .set_timer = set_timer, .deliver = deliver, .asked = asked, .tracking = tracking};
static const struct mh_protocol *const collection = &mh_protocol_collection;
static struct mh_collection_config config;
static struct mh_protocol_node node;
static struct mh_collection state;

static void come_up(bool is_head)
{
    memset(&saw, 0, sizeof saw);
    node.is_head = is_head;
    TEST_ASSERT_EQUAL(MH_OK, collection->init(&state, &config, &node));
    collection->start(&state, 0);
}

void setUp(void)
{
    const struct mh_protocol_node plain = {.id = 10, .port = &port};
    node = plain;
    mh_collection_config_default(&config);
    come_up(false);
}

void tearDown(void) {}

static void hear_beacon(mh_node_id sender, mh_node_id sink, int16_t round, uint8_t hops)
{
    const struct mh_message message = {
        .kind = MH_MESSAGE_BEACON,
        .as.beacon = {.sender = (int32_t)sender, .sink = (int32_t)sink, .round = round, .hops = hops}};
    collection->message(&state, 100, &message);
}

static void hear_request(mh_node_id origin, int32_t time, int32_t sender_x_mm)
{
    const struct mh_message message = {.kind = MH_MESSAGE_REQUEST,
                                       .as.request = {.sender = 3,
                                                      .origin = (int32_t)origin,
                                                      .time_ms = time,
                                                      .x_mm = 40000,
                                                      .radius_mm = 8000,
                                                      .sender_x_mm = sender_x_mm}};
    collection->message(&state, 100, &message);
}

static void bad_configurations_are_refused(void)
{
    struct mh_collection_config bad = config;
    bad.beacon_period = 999;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, collection->init(&state, &bad, &node));
    bad = config;
    bad.beacon_wait = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, collection->init(&state, &bad, &node));
    bad = config;
    bad.request_wait = 1001;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, collection->init(&state, &bad, &node));
    bad = config;
    bad.suppress_after = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, collection->init(&state, &bad, &node));
    bad = config;
    bad.range_mm = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, collection->init(&state, &bad, &node));
    bad = config;
    bad.attempts = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, collection->init(&state, &bad, &node));
    bad = config;
    bad.backoff = 1001;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, collection->init(&state, &bad, &node));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, collection->init(&state, NULL, &node));
}

static void the_parent_has_the_fewest_hops_of_the_newest_round(void)
{
    hear_beacon(5, 1, 7, 3);
    TEST_ASSERT_EQUAL_UINT32(5, state.parent);
    TEST_ASSERT_EQUAL_UINT8(4, state.hops);
    hear_beacon(6, 1, 7, 3); /* no better */
    TEST_ASSERT_EQUAL_UINT32(5, state.parent);
    hear_beacon(6, 1, 7, 2);
    TEST_ASSERT_EQUAL_UINT32(6, state.parent);
    hear_beacon(7, 1, 6, 0); /* a stale round */
    TEST_ASSERT_EQUAL_UINT32(6, state.parent);
    hear_beacon(8, 1, 8, 5); /* a newer one, though longer */
    TEST_ASSERT_EQUAL_UINT32(8, state.parent);
    TEST_ASSERT_EQUAL_UINT8(6, state.hops);
    hear_beacon(9, 1, 9, MH_HOPS_MAX); /* too long */
    TEST_ASSERT_EQUAL_UINT32(8, state.parent);
}

static void rounds_wrap(void)
{
    hear_beacon(5, 1, INT16_MAX, 3);
    hear_beacon(6, 1, INT16_MIN, 4);
    TEST_ASSERT_EQUAL_UINT32(6, state.parent);
    hear_beacon(7, 1, INT16_MAX, 0);
    TEST_ASSERT_EQUAL_UINT32(6, state.parent);
}

/* The sink has rebooted: its neighbours tell it how far its rounds had come, and it goes on from there. */
static void a_sink_that_begins_anew_is_told_its_round(void)
{
    hear_beacon(1, 1, 900, 0);
    collection->timer(&state, saw.timer);
    hear_beacon(5, 1, 899, 1); /* a relay that is late tells nothing */
    TEST_ASSERT_FALSE(state.beacon_waits);
    hear_beacon(1, 1, 2, 0);
    TEST_ASSERT_TRUE(state.beacon_waits);
    collection->timer(&state, saw.timer);
    TEST_ASSERT_EQUAL_INT16(900, saw.message.as.beacon.round);
    come_up(true);
    hear_beacon(5, 10, 900, 1);
    TEST_ASSERT_EQUAL(1, saw.sent);
    TEST_ASSERT_EQUAL_INT16(901, saw.message.as.beacon.round);
    hear_beacon(6, 10, 900, 1); /* the next neighbour's answer */
    TEST_ASSERT_EQUAL(1, saw.sent);
    TEST_ASSERT_EQUAL_UINT8(0, state.hops);
}

static void the_nearer_of_two_sinks_wins(void)
{
    hear_beacon(5, 1, 7, 3);
    hear_beacon(6, 2, 99, 3);
    TEST_ASSERT_EQUAL_UINT32(1, state.sink);
    hear_beacon(6, 2, 99, 2);
    TEST_ASSERT_EQUAL_UINT32(2, state.sink);
    hear_beacon(5, 1, 8, 3);
    TEST_ASSERT_EQUAL_UINT32(2, state.sink);
}

static void a_beacon_is_relayed_unless_others_do(void)
{
    hear_beacon(5, 1, 7, 3);
    TEST_ASSERT_TRUE(mh_ticks_between(100, saw.timer) >= 1 && mh_ticks_between(100, saw.timer) <= 100);
    collection->timer(&state, saw.timer - 1);
    TEST_ASSERT_EQUAL(0, saw.sent);
    collection->timer(&state, saw.timer);
    TEST_ASSERT_EQUAL(1, saw.sent);
    TEST_ASSERT_EQUAL_UINT32(MH_BROADCAST, saw.destination);
    TEST_ASSERT_EQUAL_INT32(10, saw.message.as.beacon.sender);
    TEST_ASSERT_EQUAL_INT32(1, saw.message.as.beacon.sink);
    TEST_ASSERT_EQUAL_INT16(7, saw.message.as.beacon.round);
    TEST_ASSERT_EQUAL_UINT8(4, saw.message.as.beacon.hops);
    hear_beacon(5, 1, 8, 3);
    hear_beacon(21, 1, 8, 4);
    hear_beacon(22, 1, 8, 5); /* does not count: its hops are more */
    hear_beacon(23, 1, 8, 4);
    TEST_ASSERT_TRUE(state.beacon_waits);
    hear_beacon(24, 1, 8, 3);
    TEST_ASSERT_FALSE(state.beacon_waits);
}

static void a_path_hardly_shorter_is_taken_and_not_relayed_again(void)
{
    hear_beacon(1, 7, 1, 20);
    collection->timer(&state, 1000);
    TEST_ASSERT_EQUAL_UINT(1, saw.sent);
    hear_beacon(2, 7, 1, 18); /* 19 hops instead of 21 */
    TEST_ASSERT_EQUAL_UINT32(2, state.parent);
    TEST_ASSERT_EQUAL_UINT8(19, state.hops);
    collection->timer(&state, 2000);
    TEST_ASSERT_EQUAL_UINT(1, saw.sent);
    hear_beacon(3, 7, 1, 15); /* 16 instead of 19 */
    collection->timer(&state, 3000);
    TEST_ASSERT_EQUAL_UINT(2, saw.sent);
    TEST_ASSERT_EQUAL_UINT8(16, saw.message.as.beacon.hops);
    hear_beacon(3, 7, 2, 15); /* a new round is news whatever the path */
    collection->timer(&state, 4000);
    TEST_ASSERT_EQUAL_UINT(3, saw.sent);
}

static void a_node_without_a_path_asks_and_is_answered(void)
{
    const mh_tick patience = saw.timer;
    collection->timer(&state, patience);
    TEST_ASSERT_EQUAL(1, saw.sent);
    TEST_ASSERT_EQUAL_INT32(-1, saw.message.as.beacon.sink);
    hear_beacon(11, MH_BROADCAST, 0, 0); /* neither can help the other */
    TEST_ASSERT_FALSE(state.beacon_waits);
    hear_beacon(5, 1, 7, 3);
    collection->timer(&state, saw.timer);
    TEST_ASSERT_FALSE(state.beacon_waits);
    hear_beacon(11, MH_BROADCAST, 0, 0);
    TEST_ASSERT_TRUE(state.beacon_waits);
    /* two rounds later: any other path is welcome, but not one of the round that its own children have */
    state.beacon_waits = false;
    collection->timer(&state, state.upkeep_time);
    TEST_ASSERT_TRUE(state.stale);
    hear_beacon(12, 1, 7, 4);
    TEST_ASSERT_EQUAL_UINT32(5, state.parent);
    hear_beacon(12, 1, 3, 4); /* the sink has begun anew */
    TEST_ASSERT_EQUAL_UINT32(12, state.parent);
    TEST_ASSERT_FALSE(state.stale);
}

static void reports_go_up_and_never_in_circles(void)
{
    struct mh_message report = {.kind = MH_MESSAGE_REPORT, .as.report = {.sender = 30, .origin = 31, .hops = 2}};
    const struct mh_measurement own = {.node = 10};
    TEST_ASSERT_EQUAL(MH_ERR_NO_ROUTE, collection->publish(&state, 100, &own));
    collection->message(&state, 100, &report);
    TEST_ASSERT_EQUAL(0, saw.sent);
    TEST_ASSERT_EQUAL_UINT16(1, state.lost[MH_LOSS_NO_ROUTE]);
    hear_beacon(5, 1, 7, 3);
    TEST_ASSERT_EQUAL(MH_OK, collection->publish(&state, 100, &own));
    TEST_ASSERT_EQUAL_UINT32(5, saw.destination);
    TEST_ASSERT_EQUAL_UINT8(0, saw.message.as.report.hops);
    collection->message(&state, 100, &report);
    TEST_ASSERT_EQUAL(2, saw.sent);
    TEST_ASSERT_EQUAL_UINT32(5, saw.destination);
    TEST_ASSERT_EQUAL_INT32(10, saw.message.as.report.sender);
    TEST_ASSERT_EQUAL_INT32(31, saw.message.as.report.origin);
    TEST_ASSERT_EQUAL_UINT8(3, saw.message.as.report.hops);
    report.as.report.hops = MH_HOPS_MAX;
    collection->message(&state, 100, &report);
    report.as.report.hops = 2;
    report.as.report.origin = 10; /* its own, come back */
    collection->message(&state, 100, &report);
    TEST_ASSERT_EQUAL(2, saw.sent);
    TEST_ASSERT_EQUAL_UINT16(1, state.lost[MH_LOSS_HOPS]);
    TEST_ASSERT_EQUAL_UINT16(1, state.lost[MH_LOSS_LOOP]);
    struct mh_protocol_counters counters = {.retries = 0};
    collection->count(&state, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.lost[MH_LOSS_NO_ROUTE]);
    TEST_ASSERT_EQUAL_UINT32(1, counters.lost[MH_LOSS_LOOP]);
}

static void publish(mh_tick time)
{
    const struct mh_measurement measurement = {.node = 10, .time = time};
    TEST_ASSERT_EQUAL(MH_OK, collection->publish(&state, time, &measurement));
}

/* The fates come in the order of sending; the waits double, and half of each is chance. */
static void a_report_that_the_radio_gives_up_is_sent_again(void)
{
    config.backoff = 100;
    config.attempts = 3;
    hear_beacon(5, 1, 7, 3);
    collection->timer(&state, saw.timer); /* relays the beacon: the first fate is its own */
    publish(1000);
    const unsigned before = saw.sent;
    collection->sent(&state, 1001, MH_SENT_BUSY);
    TEST_ASSERT_EQUAL(0, state.retries);
    for (unsigned again = 0; again < 2; again++) {
        const mh_tick now = 1010 + again * 1000, longest = 100u << again;
        collection->sent(&state, now, again ? MH_SENT_BUSY : MH_SENT_NO_ACK);
        TEST_ASSERT_TRUE(saw.timer - now >= longest / 2 && saw.timer - now <= longest);
        collection->timer(&state, saw.timer - 1);
        TEST_ASSERT_EQUAL(before + again, saw.sent);
        collection->timer(&state, saw.timer);
        TEST_ASSERT_EQUAL(before + again + 1, saw.sent);
        TEST_ASSERT_EQUAL_INT32(1000, saw.message.as.report.time_ms);
        TEST_ASSERT_EQUAL_UINT32(5, saw.destination);
    }
    TEST_ASSERT_EQUAL(0, state.lost[MH_LOSS_NOT_ACKNOWLEDGED]);
    collection->sent(&state, 3000, MH_SENT_BUSY);
    TEST_ASSERT_EQUAL(1, state.lost[MH_LOSS_NOT_ACKNOWLEDGED]);
    TEST_ASSERT_EQUAL(2, state.retries);
    publish(4000); /* acknowledged, so not sent again */
    collection->sent(&state, 4005, MH_SENT_OK);
    collection->timer(&state, 10000);
    TEST_ASSERT_EQUAL(before + 3, saw.sent);
}

/* A radio that was reset tells nothing any more of what it had; of what it is given later it does. */
static void a_fate_that_is_never_told_does_not_block(void)
{
    hear_beacon(5, 1, 7, 3);
    collection->timer(&state, saw.timer); /* relays the beacon, whose fate is not told either */
    publish(1000);
    hear_beacon(6, 1, 7, 9);
    const unsigned before = saw.sent;
    TEST_ASSERT_EQUAL_UINT32(1000 + MH_RETRY_PATIENCE, saw.timer);
    collection->timer(&state, saw.timer - 1);
    TEST_ASSERT_EQUAL(before, saw.sent);
    collection->timer(&state, 1000 + MH_RETRY_PATIENCE);
    TEST_ASSERT_EQUAL(1, state.retries);
    const mh_tick again = saw.timer;
    TEST_ASSERT_TRUE(again > 1000 + MH_RETRY_PATIENCE && again <= 1000 + MH_RETRY_PATIENCE + config.backoff);
    collection->timer(&state, again);
    TEST_ASSERT_EQUAL(before + 1, saw.sent);
    TEST_ASSERT_EQUAL_INT32(1000, saw.message.as.report.time_ms);
    collection->sent(&state, again + 5, MH_SENT_OK);
    collection->sent(&state, again + 6, MH_SENT_NO_ACK); /* too late */
    collection->timer(&state, again + 2 * MH_RETRY_PATIENCE);
    publish(40000);
    collection->sent(&state, 40001, MH_SENT_OK);
    collection->timer(&state, 40000 + 2 * MH_RETRY_PATIENCE);
    TEST_ASSERT_EQUAL(before + 2, saw.sent);
    TEST_ASSERT_EQUAL(1, state.retries);
}

static void what_cannot_be_kept_is_sent_once(void)
{
    hear_beacon(5, 1, 7, 3);
    collection->timer(&state, saw.timer);
    collection->sent(&state, 300, MH_SENT_OK); /* the beacon */
    const unsigned before = saw.sent;
    for (mh_tick i = 0; i <= MH_COLLECTION_KEPT_MAX; i++) {
        publish(1000 + i);
    }
    TEST_ASSERT_EQUAL(before + MH_COLLECTION_KEPT_MAX + 1, saw.sent);
    for (unsigned i = 0; i < MH_COLLECTION_KEPT_MAX; i++) {
        collection->sent(&state, 1100, MH_SENT_OK);
    }
    collection->sent(&state, 1100, MH_SENT_NO_ACK);
    TEST_ASSERT_EQUAL(1, state.lost[MH_LOSS_NOT_ACKNOWLEDGED]);
    TEST_ASSERT_EQUAL(0, state.retries);
}

/* Three in a row that were not acknowledged: any path as short as the parent's is taken instead, but not the parent's own. */
static void a_parent_that_is_gone_is_replaced(void)
{
    static const enum mh_sent fates[] = {
        MH_SENT_NO_ACK, MH_SENT_NO_ACK, MH_SENT_OK, MH_SENT_NO_ACK, MH_SENT_BUSY /* not the parent's fault */,
        MH_SENT_NO_ACK, MH_SENT_NO_ACK};
    config.attempts = 1;
    hear_beacon(5, 1, 7, 3);
    collection->timer(&state, saw.timer);
    collection->sent(&state, 200, MH_SENT_OK); /* the beacon */
    for (size_t i = 0; i < sizeof fates / sizeof *fates; i++) {
        TEST_ASSERT_FALSE(state.stale);
        publish(200);
        TEST_ASSERT_EQUAL(MH_MESSAGE_REPORT, saw.message.kind);
        collection->sent(&state, 200, fates[i]);
    }
    TEST_ASSERT_EQUAL_UINT32(MH_BROADCAST, saw.destination);
    TEST_ASSERT_EQUAL_INT32(-1, saw.message.as.beacon.sink);
    TEST_ASSERT_EQUAL_UINT16(6, state.lost[MH_LOSS_NOT_ACKNOWLEDGED]);
    hear_beacon(5, 1, 7, 3);
    TEST_ASSERT_TRUE(state.stale);
    hear_beacon(6, 1, 7, 4); /* could be its own child's */
    TEST_ASSERT_TRUE(state.stale);
    hear_beacon(7, 1, 7, 3);
    TEST_ASSERT_FALSE(state.stale);
    TEST_ASSERT_EQUAL_UINT32(7, state.parent);
    TEST_ASSERT_EQUAL_UINT8(4, state.hops);
}

/* That broadcasts go out says nothing about the parent. */
static void broadcasts_do_not_excuse_a_parent(void)
{
    const struct mh_measurement measurement = {.node = 10};
    hear_beacon(5, 1, 7, 3);
    collection->timer(&state, saw.timer); /* relays the beacon */
    collection->sent(&state, 200, MH_SENT_OK);
    for (int32_t i = 0; i < 3; i++) {
        TEST_ASSERT_FALSE(state.stale);
        TEST_ASSERT_EQUAL(MH_OK, collection->publish(&state, 300, &measurement));
        collection->sent(&state, 310, MH_SENT_NO_ACK);
        const unsigned before = saw.sent;
        hear_request(1, 1000 * i, -20000);
        collection->timer(&state, state.request_time);
        if (saw.sent > before && saw.message.kind == MH_MESSAGE_REQUEST) {
            collection->sent(&state, 320, MH_SENT_OK);
        }
    }
    TEST_ASSERT_TRUE(state.stale);
}

static void two_nodes_that_take_each_other_for_parents_notice(void)
{
    hear_beacon(5, 1, 7, 3);
    collection->timer(&state, saw.timer);
    const unsigned before = saw.sent;
    const struct mh_message report = {.kind = MH_MESSAGE_REPORT, .as.report = {.sender = 5, .origin = 31, .hops = 2}};
    collection->message(&state, 300, &report);
    collection->message(&state, 300, &report);
    TEST_ASSERT_EQUAL_UINT16(2, state.lost[MH_LOSS_LOOP]);
    TEST_ASSERT_EQUAL(before + 1, saw.sent); /* asks once */
    TEST_ASSERT_EQUAL_UINT32(MH_BROADCAST, saw.destination);
    TEST_ASSERT_TRUE(state.stale);
}

static void a_request_is_relayed_once_and_only_where_it_helps(void)
{
    node.place.x_mm = 20000;
    hear_request(1, 1000, 30000); /* from a node nearer to the centre */
    TEST_ASSERT_EQUAL(1, saw.asked);
    TEST_ASSERT_FALSE(state.request_waits);
    hear_request(1, 2000, 6000); /* 14 m of progress of 15 possible */
    TEST_ASSERT_TRUE(state.request_waits);
    const int32_t soon = mh_ticks_between(100, state.request_time);
    hear_request(1, 2000, 19000); /* another relay, but farther from the centre */
    TEST_ASSERT_TRUE(state.request_waits);
    collection->timer(&state, state.request_time);
    TEST_ASSERT_EQUAL(1, saw.sent);
    TEST_ASSERT_EQUAL_INT32(20000, saw.message.as.request.sender_x_mm);
    TEST_ASSERT_EQUAL_UINT8(1, saw.message.as.request.hops);
    hear_request(1, 2000, 6000); /* done already */
    TEST_ASSERT_FALSE(state.request_waits);
    hear_request(1, 3000, 12000); /* 8 m of progress */
    TEST_ASSERT_TRUE(mh_ticks_between(100, state.request_time) > soon);
    hear_request(1, 3000, 21000); /* somebody nearer was first */
    TEST_ASSERT_FALSE(state.request_waits);
    TEST_ASSERT_EQUAL(3, saw.asked);
}

static void the_broadcast_that_covers_the_place_is_the_last(void)
{
    node.place.x_mm = 40000;
    hear_request(1, 1000, 33000); /* 7 m off, reaches 15 m: covers 8 m around the centre */
    TEST_ASSERT_EQUAL(1, saw.asked);
    TEST_ASSERT_FALSE(state.request_waits);
    hear_request(1, 2000, 32999);
    TEST_ASSERT_TRUE(state.request_waits);
    hear_request(1, 2000, 47000);
    TEST_ASSERT_FALSE(state.request_waits);
}

static void requests_of_several_heads_are_told_apart(void)
{
    for (mh_node_id head = 1; head <= MH_COLLECTION_SEEN_MAX; head++) {
        hear_request(head, 1000, 90000);
    }
    TEST_ASSERT_EQUAL(MH_COLLECTION_SEEN_MAX, saw.asked);
    for (mh_node_id head = 1; head <= MH_COLLECTION_SEEN_MAX; head++) {
        hear_request(head, 1000, 90000);
    }
    TEST_ASSERT_EQUAL(MH_COLLECTION_SEEN_MAX, saw.asked);
    hear_request(10, 1000, 90000); /* its own */
    TEST_ASSERT_EQUAL(MH_COLLECTION_SEEN_MAX, saw.asked);
}

static void the_sink_begins_rounds_and_takes_reports(void)
{
    come_up(true);
    const struct mh_message report = {.kind = MH_MESSAGE_REPORT};
    const struct mh_interest interest = {{1, 2, 3}, 4};
    collection->timer(&state, saw.timer);
    TEST_ASSERT_EQUAL(1, saw.sent);
    TEST_ASSERT_EQUAL_UINT8(0, saw.message.as.beacon.hops);
    const int16_t round = saw.message.as.beacon.round;
    collection->tell_tracking(&state, 200, false); /* no change */
    TEST_ASSERT_EQUAL(1, saw.sent);
    collection->tell_tracking(&state, 200, true);
    TEST_ASSERT_EQUAL(2, saw.sent);
    TEST_ASSERT_EQUAL_INT16(round + 1, saw.message.as.beacon.round);
    TEST_ASSERT_EQUAL_UINT8(1, saw.message.as.beacon.tracking);
    TEST_ASSERT_EQUAL_UINT32(200 + 30000, saw.timer);
    collection->message(&state, 300, &report);
    TEST_ASSERT_EQUAL(1, saw.delivered);
    TEST_ASSERT_EQUAL(MH_OK, collection->ask(&state, 300, &interest, 1000));
    TEST_ASSERT_EQUAL(MH_MESSAGE_REQUEST, saw.message.kind);
    come_up(false);
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, collection->ask(&state, 300, &interest, 1000));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bad_configurations_are_refused);
    RUN_TEST(the_parent_has_the_fewest_hops_of_the_newest_round);
    RUN_TEST(rounds_wrap);
    RUN_TEST(a_sink_that_begins_anew_is_told_its_round);
    RUN_TEST(the_nearer_of_two_sinks_wins);
    RUN_TEST(a_beacon_is_relayed_unless_others_do);
    RUN_TEST(a_path_hardly_shorter_is_taken_and_not_relayed_again);
    RUN_TEST(a_node_without_a_path_asks_and_is_answered);
    RUN_TEST(reports_go_up_and_never_in_circles);
    RUN_TEST(a_parent_that_is_gone_is_replaced);
    RUN_TEST(broadcasts_do_not_excuse_a_parent);
    RUN_TEST(a_report_that_the_radio_gives_up_is_sent_again);
    RUN_TEST(a_fate_that_is_never_told_does_not_block);
    RUN_TEST(what_cannot_be_kept_is_sent_once);
    RUN_TEST(two_nodes_that_take_each_other_for_parents_notice);
    RUN_TEST(a_request_is_relayed_once_and_only_where_it_helps);
    RUN_TEST(the_broadcast_that_covers_the_place_is_the_last);
    RUN_TEST(requests_of_several_heads_are_told_apart);
    RUN_TEST(the_sink_begins_rounds_and_takes_reports);
    port_exit(UNITY_END() > 0);
    return 0;
}
