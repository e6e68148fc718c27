#include "engine/event_queue.h"
#include "engine/random.h"
#include "port.h"
#include "unity.h"

#include <stdlib.h>

void setUp(void) {}
void tearDown(void) {}

static struct event_queue queue;

struct expected {
    sim_time time;
    uint32_t content; /* counts the pushes: the age */
};

static int by_time_then_age(const void *a, const void *b)
{
    const struct expected *left = a, *right = b;
    if (left->time != right->time) {
        return left->time < right->time ? -1 : 1;
    }
    return (left->content > right->content) - (left->content < right->content);
}

static void comes_out_by_time_and_then_in_the_order_of_arrival(void)
{
    enum { EVENTS = 20000 };
    static struct expected expected[EVENTS];
    const struct random_stream stream = random_stream(7, RANDOM_DEPLOYMENT);
    for (uint32_t i = 0; i < EVENTS; i++) {
        expected[i] = (struct expected){random_bits(stream, i) % 500, i}; /* about forty of each time */
        TEST_ASSERT_EQUAL_INT(0, event_queue_push(&queue, expected[i].time, i));
    }
    qsort(expected, EVENTS, sizeof expected[0], by_time_then_age);
    struct event event;
    for (uint32_t i = 0; i < EVENTS; i++) {
        TEST_ASSERT_TRUE(event_queue_next(&queue) == expected[i].time);
        TEST_ASSERT_TRUE(event_queue_pop(&queue, &event));
        TEST_ASSERT_TRUE(event.time == expected[i].time);
        TEST_ASSERT_EQUAL_UINT32(expected[i].content, event.content);
    }
    TEST_ASSERT_TRUE(event_queue_next(&queue) == SIM_TIME_NEVER);
    TEST_ASSERT_FALSE(event_queue_pop(&queue, &event));
    event_queue_free(&queue);
}

/* The queue beside a plain array that is searched from end to end. Time of the next push, given random bits and the time
 * of the last event taken: */
typedef sim_time (*time_rule)(uint64_t bits, sim_time now);

static sim_time soon(uint64_t bits, sim_time now) { return now + bits % 3; }
static sim_time anywhere(uint64_t bits, sim_time now) { return (void)now, bits & 4095; }
static sim_time in_bursts(uint64_t bits, sim_time now) { return (now / 1000 + bits % 4) * 1000; }

/* Each number of digits ahead is as likely as any other, as far as the last instant. */
static sim_time at_any_distance(uint64_t bits, sim_time now)
{
    const sim_time ahead = (bits >> 1) >> bits % 63;
    return ahead < UINT64_MAX - now ? now + ahead : UINT64_MAX;
}

static void agrees_with_an_array(time_rule rule, unsigned pushes_in_eight)
{
    enum { STEPS = 6000 };
    static struct expected kept[STEPS];
    size_t count = 0;
    sim_time now = 0;
    const struct random_stream stream = random_stream(11, RANDOM_DEPLOYMENT);
    for (uint32_t i = 0; i < 2 * STEPS && (i < STEPS || count > 0); i++) {
        const uint64_t bits = random_bits(stream, i);
        if (i < STEPS && (count == 0 || bits >> 61 < pushes_in_eight)) {
            kept[count] = (struct expected){rule(bits, now), i};
            TEST_ASSERT_EQUAL_INT(0, event_queue_push(&queue, kept[count++].time, i));
            continue;
        }
        size_t least = 0;
        for (size_t k = 1; k < count; k++) {
            if (by_time_then_age(&kept[k], &kept[least]) < 0) {
                least = k;
            }
        }
        struct event event;
        TEST_ASSERT_TRUE(event_queue_next(&queue) == kept[least].time);
        TEST_ASSERT_TRUE(event_queue_pop(&queue, &event));
        TEST_ASSERT_TRUE(event.time == kept[least].time);
        TEST_ASSERT_EQUAL_UINT32(kept[least].content, event.content);
        now = event.time;
        kept[least] = kept[--count];
    }
    TEST_ASSERT_EQUAL_UINT(0, queue.count);
    event_queue_free(&queue);
}

static void pushes_and_pops_may_alternate(void)
{
    static const time_rule rules[] = {soon, anywhere, in_bursts, at_any_distance};
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++) {
        agrees_with_an_array(rules[i], 4); /* mostly nearly empty */
        agrees_with_an_array(rules[i], 6);
    }
}

/* Whatever has been in and out, the memory is that of the most that were pending. */
static void memory_does_not_grow_with_time(void)
{
    enum { PENDING = 100000 };
    const struct random_stream stream = random_stream(13, RANDOM_DEPLOYMENT);
    struct event event;
    for (uint32_t i = 0; i < PENDING; i++) {
        TEST_ASSERT_EQUAL_INT(0, event_queue_push(&queue, random_bits(stream, i) % 1000000, i));
    }
    const uint32_t blocks = queue.block_count;
    for (uint32_t i = 0; i < 20 * PENDING; i++) {
        TEST_ASSERT_TRUE(event_queue_pop(&queue, &event));
        const sim_time ahead = random_bits(stream, PENDING + i) % (i % 7 ? 3000 : 10000000);
        TEST_ASSERT_EQUAL_INT(0, event_queue_push(&queue, event.time + ahead, i));
    }
    TEST_ASSERT_EQUAL_UINT32(blocks, queue.block_count);
    TEST_ASSERT_EQUAL_UINT(PENDING, queue.count);
    event_queue_free(&queue);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(comes_out_by_time_and_then_in_the_order_of_arrival);
    RUN_TEST(pushes_and_pops_may_alternate);
    RUN_TEST(memory_does_not_grow_with_time);
    port_exit(UNITY_END() > 0);
    return 0;
}
