/* The queue to the neighbours: what it sends and when, what it gives up, what it takes twice. */
#include "motehound/geographic.h"
#include "motehound/link.h"
#include "port.h"
#include "unity.h"

#include <string.h>

static struct {
    unsigned sent;
    mh_node_id destination;
    int16_t sequence;
} saw;

static void send(void *context, mh_node_id destination, const struct mh_message *message)
{
    (void)context;
    saw.sent++;
    saw.destination = destination;
    saw.sequence = message->header.route.sequence;
}

static const struct mh_protocol_port port = {.send = send};
static const struct mh_protocol_node node = {.id = 10, .port = &port};
static struct mh_link_config config;
static struct mh_link link;

void setUp(void)
{
    memset(&saw, 0, sizeof saw);
    mh_link_config_default(&config);
    TEST_ASSERT_EQUAL(MH_OK, mh_link_init(&link, &config, &node));
}

void tearDown(void) {}

static struct mh_message numbered(int16_t sequence)
{
    static const struct mh_place place = {1000, 2000, 0};
    struct mh_message message = {.kind = MH_MESSAGE_REPORT};
    mh_geographic_address(&message, 3, sequence, 4, &place);
    return message;
}

static enum mh_status take(int16_t sequence)
{
    const struct mh_message message = numbered(sequence);
    return mh_link_take(&link, &message);
}

/* As the owner does: whatever is due goes to neighbour 20. */
static void pump(mh_tick now)
{
    for (const struct mh_message *due = mh_link_due(&link, now); due; due = mh_link_due(&link, now)) {
        mh_link_send(&link, 20, due->envelope, &due->header);
    }
}

static void broadcast(void)
{
    const struct mh_message hello = {.kind = MH_MESSAGE_HELLO};
    mh_link_broadcast(&link, &hello);
}

static void bad_configurations_are_refused(void)
{
    config.attempts = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_link_init(&link, &config, &node));
    config.attempts = 101;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_link_init(&link, &config, &node));
    config.attempts = 1;
    config.backoff = 1001;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_link_init(&link, &config, &node));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_link_init(&link, NULL, &node));
}

static void one_message_is_in_the_air_at_a_time_in_the_order_taken(void)
{
    for (int16_t i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL(MH_OK, take(i));
        pump(0);
    }
    for (int16_t i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL(i + 1, saw.sent);
        TEST_ASSERT_EQUAL(i, saw.sequence);
        TEST_ASSERT_EQUAL_UINT32(20, saw.destination);
        TEST_ASSERT_EQUAL(MH_LINK_TAKEN, mh_link_sent(&link, 1, MH_SENT_OK));
        pump(1);
    }
    TEST_ASSERT_EQUAL(3, saw.sent);
    TEST_ASSERT_NULL(mh_link_due(&link, 2));
}

/* A radio that was reset tells nothing any more. */
static void a_fate_that_is_never_told_does_not_block(void)
{
    broadcast();
    take(1);
    pump(100);
    TEST_ASSERT_NULL(mh_link_due(&link, 100 + MH_RETRY_PATIENCE));
    TEST_ASSERT_NULL(mh_link_due(&link, 101 + MH_RETRY_PATIENCE)); /* after a wait */
    mh_tick again;
    TEST_ASSERT_TRUE(mh_link_alarm(&link, &again));
    pump(again);
    TEST_ASSERT_EQUAL(3, saw.sent);
    TEST_ASSERT_EQUAL_INT16(1, saw.sequence);
    TEST_ASSERT_EQUAL(MH_LINK_TAKEN, mh_link_sent(&link, again, MH_SENT_OK));
}

/* The outcomes come in the order of sending, those of broadcasts among them. */
static void outcomes_of_broadcasts_are_told_apart(void)
{
    broadcast();
    broadcast();
    take(1);
    pump(0);
    broadcast();
    TEST_ASSERT_EQUAL(MH_LINK_OTHER, mh_link_sent(&link, 0, MH_SENT_BUSY));
    TEST_ASSERT_EQUAL(MH_LINK_OTHER, mh_link_sent(&link, 0, MH_SENT_OK));
    TEST_ASSERT_EQUAL(MH_LINK_TAKEN, mh_link_sent(&link, 0, MH_SENT_OK));
    take(2);
    pump(0);
    TEST_ASSERT_EQUAL(MH_LINK_OTHER, mh_link_sent(&link, 0, MH_SENT_OK));
    TEST_ASSERT_EQUAL(MH_LINK_LOST, mh_link_sent(&link, 0, MH_SENT_NO_ACK));
    TEST_ASSERT_EQUAL(MH_LINK_OTHER, mh_link_sent(&link, 0, MH_SENT_OK)); /* more outcomes than frames */
    TEST_ASSERT_EQUAL(1, link.retries);
}

static void waits_double_and_attempts_end(void)
{
    mh_tick now = 1000, last_wait = 0;
    take(1);
    take(2);
    for (uint8_t attempt = 1; attempt <= config.attempts; attempt++) {
        pump(now);
        TEST_ASSERT_EQUAL(attempt, saw.sent);
        TEST_ASSERT_EQUAL(1, saw.sequence);
        const enum mh_sent outcome = attempt % 2 ? MH_SENT_NO_ACK : MH_SENT_BUSY;
        TEST_ASSERT_EQUAL(attempt % 2 ? MH_LINK_LOST : MH_LINK_BUSY, mh_link_sent(&link, now, outcome));
        mh_tick due;
        if (attempt < config.attempts) {
            const mh_tick longest = config.backoff << (attempt < 7 ? attempt - 1 : 6);
            TEST_ASSERT_TRUE(mh_link_alarm(&link, &due));
            const mh_tick wait = due - now;
            TEST_ASSERT_TRUE(wait >= (longest + 1) / 2 && wait <= longest);
            TEST_ASSERT_NULL(mh_link_due(&link, due - 1));
            TEST_ASSERT_TRUE(attempt == 1 || wait + 1 >= last_wait / 2);
            last_wait = wait;
            now = due;
        } else {
            TEST_ASSERT_FALSE(mh_link_alarm(&link, &due));
        }
    }
    TEST_ASSERT_EQUAL(1, link.lost[MH_LOSS_NOT_ACKNOWLEDGED]);
    TEST_ASSERT_EQUAL(config.attempts - 1, link.retries);
    pump(now);
    TEST_ASSERT_EQUAL(2, saw.sequence); /* the next one begins afresh */
    TEST_ASSERT_EQUAL(MH_LINK_TAKEN, mh_link_sent(&link, now, MH_SENT_OK));
}

static void an_overflow_is_counted_and_may_come_again(void)
{
    for (int16_t i = 0; i < MH_LINK_QUEUE_MAX; i++) {
        TEST_ASSERT_EQUAL(MH_OK, take(i));
    }
    TEST_ASSERT_EQUAL(MH_ERR_CAPACITY, take(MH_LINK_QUEUE_MAX));
    TEST_ASSERT_EQUAL(1, link.lost[MH_LOSS_QUEUE_FULL]);
    pump(0);
    mh_link_sent(&link, 0, MH_SENT_OK);
    TEST_ASSERT_EQUAL(MH_OK, take(MH_LINK_QUEUE_MAX)); /* it was not taken for a duplicate */
    for (int16_t i = 1; i <= MH_LINK_QUEUE_MAX; i++) {
        pump(0);
        TEST_ASSERT_EQUAL(i, saw.sequence); /* also where the ring closes */
        mh_link_sent(&link, 0, MH_SENT_OK);
    }
    TEST_ASSERT_EQUAL(0, link.count);
}

/* A neighbour that missed our acknowledgement sends again, perhaps by another way. */
static void what_was_taken_is_not_taken_again(void)
{
    struct mh_message message = numbered(5);
    TEST_ASSERT_EQUAL(MH_OK, mh_link_take(&link, &message));
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, mh_link_take(&link, &message));
    message.header.route.hops = 3;
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, mh_link_take(&link, &message));
    message.envelope = MH_ENVELOPE_FACE; /* a walk may come by again */
    TEST_ASSERT_EQUAL(MH_OK, mh_link_take(&link, &message));
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, mh_link_take(&link, &message));
    message.header.route.origin++;
    TEST_ASSERT_EQUAL(MH_OK, mh_link_take(&link, &message));
    TEST_ASSERT_EQUAL(3, link.lost[MH_LOSS_DUPLICATE]);
    TEST_ASSERT_EQUAL(3, link.count);
}

/* Once more by the same edge of the same walk: a circle. By another edge, or in another walk, it is on its way. */
static void a_walk_in_a_circle_is_given_up(void)
{
    struct mh_message message = numbered(5);
    message.envelope = MH_ENVELOPE_FACE;
    message.header.route.sender = 8;
    message.header.entry = 9;
    TEST_ASSERT_EQUAL(MH_OK, mh_link_take(&link, &message));
    message.header.route.hops = 4;
    TEST_ASSERT_EQUAL(MH_ERR_NO_ROUTE, mh_link_take(&link, &message));
    TEST_ASSERT_EQUAL(1, link.lost[MH_LOSS_LOOP]);
    message.header.entry = 7;
    TEST_ASSERT_EQUAL(MH_OK, mh_link_take(&link, &message));
    message.header.entry = 9;
    message.header.route.sender = 6;
    message.header.route.hops = 5;
    TEST_ASSERT_EQUAL(MH_OK, mh_link_take(&link, &message));
}

static void at_its_end_a_message_is_taken_once_by_whatever_way_it_comes(void)
{
    struct mh_message message = numbered(5);
    TEST_ASSERT_EQUAL(MH_OK, mh_link_arrive(&link, &message));
    message.header.route.hops = 9;
    message.envelope = MH_ENVELOPE_FACE;
    TEST_ASSERT_EQUAL(MH_ERR_REPEATED, mh_link_arrive(&link, &message));
    for (int16_t i = 6; i < 6 + MH_LINK_SEEN_MAX; i++) {
        message = numbered(i);
        TEST_ASSERT_EQUAL(MH_OK, mh_link_arrive(&link, &message));
    }
    message = numbered(5);
    TEST_ASSERT_EQUAL(MH_OK, mh_link_arrive(&link, &message)); /* too long ago */
    TEST_ASSERT_EQUAL(0, link.count);
}

static void what_is_dropped_is_counted_by_reason(void)
{
    take(1);
    take(2);
    TEST_ASSERT_NOT_NULL(mh_link_due(&link, 0));
    mh_link_drop(&link, MH_LOSS_LOOP);
    TEST_ASSERT_EQUAL(2, mh_link_due(&link, 0)->header.route.sequence);
    mh_link_finish(&link);
    TEST_ASSERT_NULL(mh_link_due(&link, 0));
    TEST_ASSERT_EQUAL(1, link.lost[MH_LOSS_LOOP]);
    TEST_ASSERT_EQUAL(0, saw.sent);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bad_configurations_are_refused);
    RUN_TEST(one_message_is_in_the_air_at_a_time_in_the_order_taken);
    RUN_TEST(a_fate_that_is_never_told_does_not_block);
    RUN_TEST(outcomes_of_broadcasts_are_told_apart);
    RUN_TEST(waits_double_and_attempts_end);
    RUN_TEST(an_overflow_is_counted_and_may_come_again);
    RUN_TEST(what_was_taken_is_not_taken_again);
    RUN_TEST(a_walk_in_a_circle_is_given_up);
    RUN_TEST(at_its_end_a_message_is_taken_once_by_whatever_way_it_comes);
    RUN_TEST(what_is_dropped_is_counted_by_reason);
    port_exit(UNITY_END() > 0);
    return 0;
}
