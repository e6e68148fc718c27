#include "engine/event_queue.h"
#include "engine/random.h"
#include "port.h"
#include "unity.h"

#include <stdlib.h>

void setUp(void) {}
void tearDown(void) {}

struct expected {
    sim_time time;
    uint32_t content;
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
    struct event_queue queue = {0};
    for (uint32_t i = 0; i < EVENTS; i++) {
        expected[i] = (struct expected){random_bits(stream, i) % 500, i}; /* about forty of each time */
        TEST_ASSERT_EQUAL_INT(0, event_queue_push(&queue, expected[i].time, i));
    }
    qsort(expected, EVENTS, sizeof expected[0], by_time_then_age);
    struct event event;
    for (uint32_t i = 0; i < EVENTS; i++) {
        TEST_ASSERT_TRUE(event_queue_pop(&queue, &event));
        TEST_ASSERT_TRUE(event.time == expected[i].time);
        TEST_ASSERT_EQUAL_UINT32(expected[i].content, event.content);
    }
    TEST_ASSERT_FALSE(event_queue_pop(&queue, &event));
    event_queue_free(&queue);
}

/* Against a plain array searched from end to end. */
static void pushes_and_pops_may_alternate(void)
{
    enum { STEPS = 5000 };
    static struct expected kept[STEPS];
    size_t count = 0;
    const struct random_stream stream = random_stream(11, RANDOM_DEPLOYMENT);
    struct event_queue queue = {.order = UINT32_MAX - STEPS / 4}; /* the order wraps on the way */
    for (uint32_t i = 0; i < STEPS; i++) {
        const uint64_t bits = random_bits(stream, i);
        if (bits % 5 < 3 || count == 0) {
            kept[count++] = (struct expected){bits >> 32 & 63, i};
            TEST_ASSERT_EQUAL_INT(0, event_queue_push(&queue, bits >> 32 & 63, i));
            continue;
        }
        size_t least = 0;
        for (size_t k = 1; k < count; k++) {
            if (by_time_then_age(&kept[k], &kept[least]) < 0) {
                least = k;
            }
        }
        struct event event;
        TEST_ASSERT_TRUE(event_queue_pop(&queue, &event));
        TEST_ASSERT_EQUAL_UINT32(kept[least].content, event.content);
        kept[least] = kept[--count];
    }
    event_queue_free(&queue);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(comes_out_by_time_and_then_in_the_order_of_arrival);
    RUN_TEST(pushes_and_pops_may_alternate);
    port_exit(UNITY_END() > 0);
    return 0;
}
