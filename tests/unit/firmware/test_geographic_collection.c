/* One mote's side of `geographic`, message by message. Whole networks: tests/network. */
#include "motehound/geographic.h"
#include "motehound/geographic_collection.h"
#include "port.h"
#include "unity.h"

#include <string.h>

enum { NODE = 10, SINK = 1 };

static struct {
    unsigned sent, hellos, asked, delivered, told;
    mh_node_id destination;
    struct mh_message message; /* the last one sent */
    mh_tick timer;
} saw;

static void send(void *context, mh_node_id destination, const struct mh_message *message)
{
    (void)context;
    saw.sent++;
    saw.hellos += message->kind == MH_MESSAGE_HELLO;
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
    (void)now_tracking;
    saw.told++;
}

static const struct mh_protocol_port port = {
    .send = send, .set_timer = set_timer, .deliver = deliver, .asked = asked, .tracking = tracking};
static const struct mh_protocol *const geographic = &mh_protocol_geographic;
static struct mh_geographic_collection_config config;
static struct mh_protocol_node node;
static struct mh_geographic_collection state;

static void come_up(mh_node_id id, bool is_head)
{
    const struct mh_protocol_node plain = {.id = id, .place = {20000, 0, 0}, .is_head = is_head, .port = &port};
    memset(&saw, 0, sizeof saw);
    node = plain;
    TEST_ASSERT_EQUAL(MH_OK, geographic->init(&state, &config, &node));
    geographic->start(&state, 0);
}

void setUp(void)
{
    mh_geographic_collection_config_default(&config);
    come_up(NODE, false);
}

void tearDown(void) {}

static void hear(mh_tick now, const struct mh_message *message) { geographic->message(&state, now, message); }

static void hear_hello(mh_node_id sender, int32_t x_mm)
{
    const struct mh_message message = {.kind = MH_MESSAGE_HELLO, .as.hello = {.sender = (int32_t)sender, .x_mm = x_mm}};
    hear(100, &message);
}

static void hear_landmark(int16_t round, bool of_tracking, int32_t x_mm)
{
    const struct mh_message message = {
        .kind = MH_MESSAGE_LANDMARK,
        .as.landmark = {.beacon = {.sender = 5, .sink = SINK, .round = round, .hops = 2, .tracking = of_tracking},
                        .x_mm = x_mm}};
    hear(100, &message);
}

static enum mh_status publish(mh_tick now)
{
    const struct mh_measurement measurement = {.node = node.id, .time = now};
    return geographic->publish(&state, now, &measurement);
}

static struct mh_message travelling(mh_node_id destination, int16_t sequence)
{
    const struct mh_place sink = {0, 0, 0};
    struct mh_message message = {.kind = MH_MESSAGE_REPORT};
    mh_geographic_address(&message, 30, sequence, destination, &sink);
    message.header.route.hops = 2;
    return message;
}

static void bad_configurations_are_refused(void)
{
    config.hello_period = 999;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, geographic->init(&state, &config, &node));
    config.hello_period = 600001;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, geographic->init(&state, &config, &node));
    config.hello_period = 10000;
    config.link.attempts = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, geographic->init(&state, &config, &node));
    config.link.attempts = 1;
    config.collection.beacon_wait = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, geographic->init(&state, &config, &node));
}

/* Soon after the start, in a hurry at first, then once a period; no node at quite the same time as another. */
static void hellos_come_with_the_period(void)
{
    mh_tick last = 0;
    for (uint8_t i = 0; i < 8; i++) {
        while (saw.hellos == i) {
            geographic->timer(&state, saw.timer);
            TEST_ASSERT_TRUE(saw.timer < 200000);
        }
        const mh_tick now = state.hello_time, longest = 10000u >> (i < 3 ? 3 - i : 0);
        TEST_ASSERT_EQUAL(MH_BROADCAST, saw.destination);
        TEST_ASSERT_TRUE(i == 0 || (now - last <= longest && now - last >= longest * 3 / 4 - 1));
        last = now;
    }
}

static void a_report_goes_to_the_neighbour_nearest_to_the_sink(void)
{
    TEST_ASSERT_EQUAL(MH_ERR_NO_ROUTE, publish(90)); /* where is the sink? */
    hear_hello(5, 11000);
    hear_hello(6, 8000);
    hear_hello(7, 30000);
    hear_landmark(1, false, -5000);
    TEST_ASSERT_EQUAL(MH_OK, publish(100));
    TEST_ASSERT_EQUAL_UINT32(6, saw.destination);
    TEST_ASSERT_EQUAL(MH_ENVELOPE_ROUTE, saw.message.envelope);
    TEST_ASSERT_EQUAL(MH_MESSAGE_REPORT, saw.message.kind);
    TEST_ASSERT_EQUAL_INT32(SINK, saw.message.header.route.destination);
    TEST_ASSERT_EQUAL_INT32(-5000, saw.message.header.route.x_mm);
    TEST_ASSERT_EQUAL_INT16(1, saw.message.header.route.hops);
    const int16_t sequence = saw.message.header.route.sequence;
    TEST_ASSERT_EQUAL(MH_OK, publish(200));
    TEST_ASSERT_EQUAL(1, saw.sent); /* waits for the first one's fate */
    geographic->sent(&state, 210, MH_SENT_OK);
    TEST_ASSERT_EQUAL(2, saw.sent);
    TEST_ASSERT_EQUAL_INT16((int16_t)(sequence + 1), saw.message.header.route.sequence);
    hear_landmark(2, false, 100000); /* the sink has moved */
    geographic->sent(&state, 220, MH_SENT_OK);
    TEST_ASSERT_EQUAL(MH_OK, publish(300));
    TEST_ASSERT_EQUAL_UINT32(7, saw.destination);
}

/* What is not acknowledged is sent again, and as the neighbour's quality falls, to another. */
static void a_neighbour_that_has_died_is_left_out(void)
{
    hear_hello(5, 11000);
    hear_hello(6, 8000);
    hear_landmark(1, false, 0);
    publish(100);
    mh_tick now = 100;
    unsigned attempts = 1;
    while (saw.destination == 6 && attempts < config.link.attempts) {
        geographic->sent(&state, now, MH_SENT_NO_ACK);
        TEST_ASSERT_EQUAL(attempts, saw.sent);
        now = saw.timer;
        geographic->timer(&state, now - 1);
        TEST_ASSERT_EQUAL(attempts, saw.sent);
        geographic->timer(&state, now);
        TEST_ASSERT_EQUAL(++attempts, saw.sent);
    }
    TEST_ASSERT_EQUAL_UINT32(5, saw.destination);
    geographic->sent(&state, now, MH_SENT_OK);
    struct mh_protocol_counters counters = {.retries = 0};
    geographic->count(&state, &counters);
    TEST_ASSERT_EQUAL_UINT32(attempts - 1, counters.retries);
    TEST_ASSERT_EQUAL_UINT32(0, counters.lost[MH_LOSS_NOT_ACKNOWLEDGED]);
}

static void others_reports_are_relayed_once(void)
{
    hear_hello(5, 11000);
    const struct mh_message message = travelling(SINK, 77);
    hear(200, &message);
    TEST_ASSERT_EQUAL(1, saw.sent);
    TEST_ASSERT_EQUAL_UINT32(5, saw.destination);
    TEST_ASSERT_EQUAL_INT32(NODE, saw.message.header.route.sender);
    TEST_ASSERT_EQUAL_INT32(30, saw.message.header.route.origin);
    TEST_ASSERT_EQUAL_INT16(3, saw.message.header.route.hops);
    geographic->sent(&state, 200, MH_SENT_OK);
    hear(201, &message); /* the acknowledgement got lost */
    TEST_ASSERT_EQUAL(1, saw.sent);
    TEST_ASSERT_EQUAL_UINT16(1, state.link.lost[MH_LOSS_DUPLICATE]);
    struct mh_message last_hop = travelling(SINK, 78);
    last_hop.header.route.hops = MH_ROUTE_HOPS_MAX;
    hear(202, &last_hop);
    TEST_ASSERT_EQUAL_UINT16(1, state.link.lost[MH_LOSS_HOPS]);
    const struct mh_message to_me = travelling(NODE, 79);
    hear(203, &to_me); /* and what should it do with that? */
    TEST_ASSERT_EQUAL(1, saw.sent);
    TEST_ASSERT_EQUAL(0, saw.delivered);
}

/* Its own time begins anew with the mote, the network's does not. */
static void a_restarted_node_does_not_repeat_its_numbers(void)
{
    int16_t sequences[2];
    for (unsigned boot = 0; boot < 2; boot++) {
        come_up(NODE, false);
        hear_hello(5, 11000);
        hear_landmark(1, false, 0);
        const struct mh_measurement measurement = {.node = NODE, .time = 70000 + (mh_tick)10000 * boot};
        TEST_ASSERT_EQUAL(MH_OK, geographic->publish(&state, 500, &measurement));
        sequences[boot] = saw.message.header.route.sequence;
    }
    TEST_ASSERT_TRUE((uint16_t)(sequences[1] - sequences[0]) > MH_LINK_SEEN_MAX);
}

/* Neighbours see the low byte alone; a gap in it is hellos missed. */
static void numbers_of_hellos_have_no_gap(void)
{
    state.hellos = UINT16_MAX;
    while (saw.hellos < 2) {
        const unsigned before = saw.hellos;
        geographic->timer(&state, saw.timer);
        if (saw.hellos > before) {
            TEST_ASSERT_EQUAL_UINT8(before == 0 ? UINT8_MAX : 0, (uint8_t)saw.message.as.hello.sequence);
        }
    }
}

static void nobody_near_is_counted(void)
{
    const struct mh_message message = travelling(SINK, 77);
    hear(200, &message);
    TEST_ASSERT_EQUAL_UINT16(1, state.link.lost[MH_LOSS_NO_ROUTE]);
    TEST_ASSERT_EQUAL(0, saw.sent);
}

static void a_sink_takes_each_report_once(void)
{
    come_up(SINK, true);
    TEST_ASSERT_EQUAL(MH_ERR_NO_ROUTE, publish(100));
    struct mh_message message = travelling(SINK, 77);
    hear(200, &message);
    message.header.route.hops = 9; /* by another way */
    hear(220, &message);
    TEST_ASSERT_EQUAL(1, saw.delivered);
    message.header.route.sequence++;
    hear(230, &message);
    TEST_ASSERT_EQUAL(2, saw.delivered);
}

/* Beacons are landmarks, which say where the sink stands; requests are as in `collection`. */
static void the_rest_is_collection(void)
{
    come_up(SINK, true);
    while (saw.message.kind != MH_MESSAGE_LANDMARK || saw.sent == 0) {
        geographic->timer(&state, saw.timer);
    }
    TEST_ASSERT_EQUAL_INT32(20000, saw.message.as.landmark.x_mm);
    TEST_ASSERT_EQUAL_INT32(SINK, saw.message.as.landmark.beacon.sink);
    const int16_t round = saw.message.as.landmark.beacon.round;
    geographic->tell_tracking(&state, 5000, true);
    TEST_ASSERT_EQUAL_INT16((int16_t)(round + 1), saw.message.as.landmark.beacon.round);
    TEST_ASSERT_EQUAL_UINT8(1, saw.message.as.landmark.beacon.tracking);
    const struct mh_interest interest = {{0, 0, 0}, 5000};
    TEST_ASSERT_EQUAL(MH_OK, geographic->ask(&state, 6000, &interest, 7000));
    TEST_ASSERT_EQUAL(MH_MESSAGE_REQUEST, saw.message.kind);
    const struct mh_message request = saw.message;

    come_up(NODE, false);
    hear_landmark(1, true, -7000);
    TEST_ASSERT_EQUAL(1, saw.told);
    while (saw.message.kind != MH_MESSAGE_LANDMARK || saw.sent == 0) {
        geographic->timer(&state, saw.timer);
    }
    TEST_ASSERT_EQUAL_INT32(-7000, saw.message.as.landmark.x_mm);
    TEST_ASSERT_EQUAL_UINT8(3, saw.message.as.landmark.beacon.hops);
    hear(500, &request);
    TEST_ASSERT_EQUAL(1, saw.asked);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bad_configurations_are_refused);
    RUN_TEST(hellos_come_with_the_period);
    RUN_TEST(a_report_goes_to_the_neighbour_nearest_to_the_sink);
    RUN_TEST(a_neighbour_that_has_died_is_left_out);
    RUN_TEST(others_reports_are_relayed_once);
    RUN_TEST(a_restarted_node_does_not_repeat_its_numbers);
    RUN_TEST(numbers_of_hellos_have_no_gap);
    RUN_TEST(nobody_near_is_counted);
    RUN_TEST(a_sink_takes_each_report_once);
    RUN_TEST(the_rest_is_collection);
    port_exit(UNITY_END() > 0);
    return 0;
}
