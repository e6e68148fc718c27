/* One mote's clock, fed by hand with what its neighbours would send. */
#include "motehound/clock.h"
#include "port.h"
#include "unity.h"

#include <string.h>

#define ME 7u
#define ROOT 1u
#define PERIOD ((mh_tick)15000)
#define WAIT ((mh_tick)1500)

static struct mh_clock_config config;
static struct mh_clock clock;

/* A neighbour that knows the network's time exactly: network = local x (1 + skew) + offset, skew in 2^-20 (0.95 ppm). */
static struct {
    mh_node_id id;
    mh_tick offset;
    int32_t skew_q20;
    uint8_t number;
    uint16_t round;
    uint8_t hops;
    mh_tick last;
} neighbour;

void setUp(void)
{
    const struct mh_clock_config plain = {.period = PERIOD, .wait = WAIT, .sent_q8 = 128};
    config = plain;
    memset(&neighbour, 0, sizeof neighbour);
    neighbour.id = 2;
    TEST_ASSERT_EQUAL(MH_OK, mh_clock_init(&clock, &config, ME, 5));
}

void tearDown(void) {}

/* 1/256 ticks that the network's time is ahead of `local` + offset. */
static int32_t gain_q8(mh_tick local) { return (int32_t)((int64_t)neighbour.skew_q20 * local / 4096); }

static mh_sync_t message_at(mh_tick now)
{
    mh_sync_t message;
    memset(&message, 0, sizeof message);
    message.sender = (int32_t)neighbour.id;
    message.root = (int32_t)ROOT;
    message.round = (int16_t)neighbour.round;
    message.hops = neighbour.hops;
    message.number = ++neighbour.number;
    if (message.number > 1) {
        const int32_t more = gain_q8(neighbour.last) + 128;
        message.time_ms = (int32_t)(neighbour.last + neighbour.offset + (mh_tick)(more / 256));
        message.fraction = (uint8_t)(more % 256);
        message.stamped = 1;
    }
    neighbour.last = now;
    return message;
}

static bool hear(mh_tick now)
{
    neighbour.round++;
    const mh_sync_t message = message_at(now);
    return mh_clock_message(&clock, now, &message);
}

/* Rounds from `begin` on; returns when the last one was heard. */
static mh_tick hear_rounds(mh_tick begin, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        hear(begin + i * PERIOD);
    }
    return begin + (count - 1) * PERIOD;
}

static void test_before_the_first_pair(void)
{
    mh_tick due;
    TEST_ASSERT_FALSE(mh_clock_synchronised(&clock));
    TEST_ASSERT_FALSE(mh_clock_due(&clock, &due));
    TEST_ASSERT_EQUAL_UINT32(123456, mh_clock_network(&clock, 123456, NULL));
    TEST_ASSERT_EQUAL_UINT32(123456, mh_clock_local(&clock, 123456));
    /* one message is a moment without a time */
    TEST_ASSERT_FALSE(hear(1000));
    TEST_ASSERT_FALSE(mh_clock_synchronised(&clock));
    TEST_ASSERT_TRUE(mh_clock_due(&clock, &due)); /* but the round is passed on */
}

static void test_the_first_pair_gives_the_offset(void)
{
    uint8_t fraction;
    neighbour.offset = 0xFFFFF000u;
    hear(1000);
    TEST_ASSERT_TRUE(hear(1000 + PERIOD));
    TEST_ASSERT_TRUE(mh_clock_synchronised(&clock));
    TEST_ASSERT_EQUAL_UINT32(0xFFFFF000u + 20000u, mh_clock_network(&clock, 20000, &fraction));
    TEST_ASSERT_EQUAL_UINT8(128, fraction);
    TEST_ASSERT_EQUAL_UINT16(1, clock.counters.jumps);
}

/* Pairs on a line give the line: 40 ppm of a quarter of an hour are 36 ticks. */
static void test_the_skew_is_found(void)
{
    uint8_t fraction;
    neighbour.offset = 77;
    neighbour.skew_q20 = 42; /* 40.05 ppm */
    const mh_tick now = hear_rounds(1000, 2 * MH_CLOCK_PAIRS), later = now + 900000;
    const mh_tick network = mh_clock_network(&clock, later, &fraction);
    const int32_t error_q8 =
        (mh_ticks_between(later + neighbour.offset, network) * 256 + fraction - 128) - gain_q8(later);
    TEST_ASSERT_INT32_WITHIN(110, 0, error_q8); /* the prior for the slope takes 0.7 % (24 pairs), 1.6 % (16) */
    TEST_ASSERT_EQUAL_UINT16(1, clock.counters.jumps);
    TEST_ASSERT_EQUAL_UINT16(0, clock.counters.rejected);
}

static void test_time_never_runs_backwards_and_inverts_exactly(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        neighbour.offset = 0xFFFF0000u; /* the network's ticks wrap at local 65536 */
        neighbour.skew_q20 = sign * 300;
        neighbour.last = 0;
        for (unsigned i = 0; i < 6; i++) { /* the stamps of a negative skew: added to the offset, to stay positive */
            neighbour.round++;
            mh_sync_t message = message_at(200 + i * PERIOD);
            if (i > 0) {
                const int32_t more = gain_q8(200 + (i - 1) * PERIOD) + 128 + 256 * 100;
                message.time_ms = (int32_t)(200 + (i - 1) * PERIOD + neighbour.offset + (mh_tick)(more / 256) - 100);
                message.fraction = (uint8_t)(more % 256);
            }
            mh_clock_message(&clock, 200 + i * PERIOD, &message);
        }
        mh_tick before = mh_clock_network(&clock, 64000, NULL);
        for (mh_tick local = 64001; local < 67500; local++) {
            const mh_tick network = mh_clock_network(&clock, local, NULL);
            TEST_ASSERT_TRUE((uint32_t)(network - before) <= 2);
            if (network != before) {
                TEST_ASSERT_EQUAL_UINT32(local, mh_clock_local(&clock, network));
                TEST_ASSERT_EQUAL_UINT32(local, mh_clock_local(&clock, before + 1));
            }
            before = network;
        }
    }
}

static void test_wild_stamps_are_rejected(void)
{
    const mh_tick now = hear_rounds(1000, 10);
    const mh_tick expected = mh_clock_network(&clock, now + 5000, NULL);
    for (int wild = 0; wild < 3 * MH_CLOCK_REJECTS; wild++) {
        neighbour.round++;
        mh_sync_t message = message_at(now + 20u * (mh_tick)wild);
        if (wild % MH_CLOCK_REJECTS != 0) { /* always a good one in time */
            message.time_ms += wild % 2 ? 100 : -100000000;
        }
        TEST_ASSERT_FALSE(mh_clock_message(&clock, now + 20u * (mh_tick)wild, &message));
    }
    TEST_ASSERT_EQUAL_UINT16(3 * (MH_CLOCK_REJECTS - 1), clock.counters.rejected);
    TEST_ASSERT_EQUAL_UINT32(expected, mh_clock_network(&clock, now + 5000, NULL));
}

static void test_a_root_that_jumps_is_believed_in_the_end(void)
{
    mh_tick now = hear_rounds(1000, 10);
    neighbour.offset += 3600000;
    unsigned rounds = 0;
    while (rounds < 20 && !hear(now += PERIOD)) {
        rounds++;
    }
    TEST_ASSERT_EQUAL_UINT(MH_CLOCK_REJECTS - 1, rounds);
    TEST_ASSERT_EQUAL_UINT32(now + 3600000, mh_clock_network(&clock, now, NULL));
    TEST_ASSERT_EQUAL_UINT16(2, clock.counters.jumps);
}

/* Its numbers begin anew: no stamp may be matched with a moment from before. */
static void test_a_restarted_neighbour_does_no_harm(void)
{
    mh_tick now = hear_rounds(1000, 10);
    const uint16_t pairs = clock.counters.pairs;
    neighbour.number = 0;
    hear(now += PERIOD);
    TEST_ASSERT_EQUAL_UINT16(pairs, clock.counters.pairs);
    hear(now += PERIOD);
    TEST_ASSERT_EQUAL_UINT16(pairs + 1, clock.counters.pairs);
    TEST_ASSERT_EQUAL_UINT16(0, clock.counters.rejected);
    /* a lost message: the next one's stamp belongs to a moment that was not heard */
    neighbour.number++;
    hear(now += PERIOD);
    TEST_ASSERT_EQUAL_UINT16(pairs + 1, clock.counters.pairs);
}

static mh_sync_t send_now(mh_tick *now)
{
    struct mh_message message;
    mh_tick due;
    TEST_ASSERT_TRUE(mh_clock_due(&clock, &due));
    TEST_ASSERT_FALSE(mh_clock_timer(&clock, due - 1, &message));
    TEST_ASSERT_TRUE(mh_clock_timer(&clock, due, &message));
    TEST_ASSERT_EQUAL(MH_MESSAGE_SYNC, message.kind);
    TEST_ASSERT_TRUE(mh_clock_sent(&clock, due + 3, MH_SENT_OK));
    *now = due + 3;
    return message.as.sync;
}

/* Each round twice, the second time with the stamp of the first; then again without a new round after the period. */
static void test_rounds_are_relayed(void)
{
    mh_tick first, second, third;
    neighbour.offset = 1000000;
    neighbour.hops = 3;
    mh_tick now = hear_rounds(1000, 12);
    for (int i = 0; i < 30; i++) { /* until messages have slowed down to the period */
        (void)send_now(&first);
    }
    now = first;
    hear(now += PERIOD / 2);
    mh_sync_t message = send_now(&first);
    TEST_ASSERT_TRUE(first - now <= WAIT + 4);
    TEST_ASSERT_EQUAL_INT16(13, message.round);
    TEST_ASSERT_EQUAL_UINT8(4, message.hops);
    const uint8_t number = message.number;
    message = send_now(&second);
    TEST_ASSERT_TRUE(second - first <= WAIT + 4);
    TEST_ASSERT_EQUAL_UINT8(number + 1, message.number);
    TEST_ASSERT_EQUAL_UINT8(1, message.stamped);
    TEST_ASSERT_EQUAL_INT32(first + 1000000, message.time_ms);
    TEST_ASSERT_INT_WITHIN(2, 128, message.fraction);
    message = send_now(&third);
    TEST_ASSERT_EQUAL_INT16(13, message.round);
    TEST_ASSERT_TRUE(third - first >= PERIOD && third - first <= PERIOD + WAIT + 4);
}

/* Of two frames handed to the radio the fate of the older is told first. */
static void test_fates_of_other_frames(void)
{
    struct mh_message message;
    mh_tick due;
    hear_rounds(1000, 2);
    mh_clock_other_frame(&clock);
    TEST_ASSERT_TRUE(mh_clock_due(&clock, &due) && mh_clock_timer(&clock, due, &message));
    mh_clock_other_frame(&clock);
    TEST_ASSERT_FALSE(mh_clock_sent(&clock, due + 10, MH_SENT_OK));
    TEST_ASSERT_FALSE(clock.sent);
    TEST_ASSERT_TRUE(mh_clock_sent(&clock, due + 20, MH_SENT_OK));
    TEST_ASSERT_TRUE(clock.sent && clock.sent_time == due + 20);
    TEST_ASSERT_FALSE(mh_clock_sent(&clock, due + 30, MH_SENT_OK));
    TEST_ASSERT_TRUE(clock.sent_time == due + 20);
    /* one that never went out has no time */
    TEST_ASSERT_TRUE(mh_clock_due(&clock, &due) && mh_clock_timer(&clock, due, &message));
    TEST_ASSERT_TRUE(mh_clock_sent(&clock, due + 30, MH_SENT_BUSY));
    TEST_ASSERT_TRUE(mh_clock_due(&clock, &due) && mh_clock_timer(&clock, due, &message));
    TEST_ASSERT_EQUAL_UINT8(0, message.as.sync.stamped);
}

/* A radio that was reset tells nothing any more: after a period the clock goes on. */
static void test_a_fate_that_is_never_told(void)
{
    struct mh_message message;
    mh_tick due;
    hear_rounds(1000, 2);
    mh_clock_other_frame(&clock);
    TEST_ASSERT_TRUE(mh_clock_due(&clock, &due) && mh_clock_timer(&clock, due, &message));
    const mh_tick begin = due;
    while (mh_clock_due(&clock, &due) && due - begin < 2 * PERIOD && !mh_clock_timer(&clock, due, &message)) {}
    TEST_ASSERT_TRUE(due - begin >= PERIOD && due - begin < PERIOD + 2 * WAIT);
    TEST_ASSERT_EQUAL_UINT8(0, message.as.sync.stamped);
    TEST_ASSERT_TRUE(mh_clock_sent(&clock, due + 10, MH_SENT_OK));
}

/* What comes from farther away and has been derived from this mote's own time teaches it nothing. */
static void test_errors_do_not_run_in_circles(void)
{
    mh_tick now = hear_rounds(1000, 3), sent;
    (void)send_now(&sent);
    const uint16_t pairs = clock.counters.pairs;
    neighbour.id = 3;
    neighbour.hops = 2;
    for (unsigned i = 0; i < 3; i++) {
        const mh_sync_t message = message_at(sent + 100 * i);
        TEST_ASSERT_FALSE(mh_clock_message(&clock, sent + 100 * i, &message));
    }
    TEST_ASSERT_EQUAL_UINT16(pairs, clock.counters.pairs);
    (void)now;
}

static void test_another_root_after_silence(void)
{
    const mh_tick now = hear_rounds(1000, 5);
    mh_sync_t message = message_at(now + 1000);
    message.root = 99;
    message.round = -5;
    mh_clock_message(&clock, now + 1000, &message);
    TEST_ASSERT_EQUAL_UINT32(ROOT, clock.root);
    mh_clock_message(&clock, now + MH_CLOCK_SILENCE * PERIOD + 1, &message);
    TEST_ASSERT_EQUAL_UINT32(99, clock.root);
}

static void test_the_root(void)
{
    mh_tick now, earlier = 0;
    config.root = true;
    TEST_ASSERT_EQUAL(MH_OK, mh_clock_init(&clock, &config, ROOT, 5));
    TEST_ASSERT_TRUE(mh_clock_synchronised(&clock));
    mh_sync_t message = send_now(&now);
    TEST_ASSERT_EQUAL_UINT8(0, message.stamped);
    for (int i = 0; i < 40; i++) {
        earlier = now;
        const uint8_t number = message.number;
        message = send_now(&now);
        TEST_ASSERT_EQUAL_UINT8(number + 1, message.number);
        TEST_ASSERT_EQUAL_INT32(earlier, message.time_ms);
        TEST_ASSERT_EQUAL_UINT8(128, message.fraction);
    }
    /* its field remembers more rounds than it does */
    message.round = 5000;
    message.sender = 3;
    TEST_ASSERT_FALSE(mh_clock_message(&clock, now, &message));
    (void)send_now(&now);
    message = send_now(&now);
    TEST_ASSERT_EQUAL_INT16(5001, message.round);
    TEST_ASSERT_EQUAL_UINT32(now, mh_clock_network(&clock, now, NULL));
}

static void test_bad_arguments(void)
{
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_clock_init(NULL, &config, ME, 0));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_clock_init(&clock, NULL, ME, 0));
    config.period = 1999;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_clock_init(&clock, &config, ME, 0));
    config.period = 3600001;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_clock_init(&clock, &config, ME, 0));
    config.period = 2000;
    config.wait = 1001;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_clock_init(&clock, &config, ME, 0));
    config.wait = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_clock_init(&clock, &config, ME, 0));
}

/* Years alone: the line keeps its digits, and afterwards the root is believed again. */
static void test_a_long_silence(void)
{
    struct mh_message message;
    mh_tick due, now = hear_rounds(1000, 10);
    for (int i = 0; i < 20; i++) { /* 20 times 4.6 days without an event in between: the alarm comes late */
        now += 400000000u;
        TEST_ASSERT_TRUE(mh_clock_due(&clock, &due));
        if (mh_clock_timer(&clock, now, &message)) {
            mh_clock_sent(&clock, now, MH_SENT_OK);
        }
    }
    TEST_ASSERT_INT32_WITHIN(10, 0, mh_ticks_between(now, mh_clock_network(&clock, now, NULL)));
    hear(now += PERIOD);
    hear(now += PERIOD);
    TEST_ASSERT_EQUAL_UINT32(now, mh_clock_network(&clock, now, NULL));
    TEST_ASSERT_EQUAL_UINT16(1, clock.counters.jumps);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_before_the_first_pair);
    RUN_TEST(test_the_first_pair_gives_the_offset);
    RUN_TEST(test_the_skew_is_found);
    RUN_TEST(test_time_never_runs_backwards_and_inverts_exactly);
    RUN_TEST(test_wild_stamps_are_rejected);
    RUN_TEST(test_a_root_that_jumps_is_believed_in_the_end);
    RUN_TEST(test_a_restarted_neighbour_does_no_harm);
    RUN_TEST(test_rounds_are_relayed);
    RUN_TEST(test_fates_of_other_frames);
    RUN_TEST(test_a_fate_that_is_never_told);
    RUN_TEST(test_errors_do_not_run_in_circles);
    RUN_TEST(test_another_root_after_silence);
    RUN_TEST(test_the_root);
    RUN_TEST(test_a_long_silence);
    RUN_TEST(test_bad_arguments);
    port_exit(UNITY_END() > 0);
}
