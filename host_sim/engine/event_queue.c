#include "engine/event_queue.h"

#include <stdlib.h>

enum { BLOCK_EVENTS = 31 };

/* Block 0 is none. */
struct event_block {
    struct event events[BLOCK_EVENTS];
    uint32_t next; /* of the bucket, or of the free blocks */
};

static int lowest_bit(uint64_t bits) { return __builtin_ctzll(bits); }

/* The highest digit in which two times differ; 0 if none. */
static int digit_of_difference(sim_time a, sim_time b)
{
    return (63 - __builtin_clzll((a ^ b) | 1)) / EVENT_DIGIT_BITS;
}

/* Each bucket may end in a block that is hardly used, those of the lowest digit may begin with one, too, and one more is
 * being emptied while its bucket is moved: with that many to spare, no event ever lacks a block. */
static int grow(struct event_queue *queue)
{
    enum { SPARE = (EVENT_DIGITS + 1) * EVENT_RADIX + 1 };
    const uint32_t block_count = queue->block_count ? 2 * queue->block_count : 2 * SPARE;
    struct event_block *blocks = realloc(queue->blocks, block_count * sizeof *blocks);
    if (!blocks) {
        return -1;
    }
    queue->blocks = blocks;
    queue->block_count = block_count;
    queue->used_blocks = queue->used_blocks ? queue->used_blocks : 1;
    queue->room = (size_t)(block_count - 1 - SPARE) * BLOCK_EVENTS;
    return 0;
}

static uint32_t take_block(struct event_queue *queue)
{
    const uint32_t block = queue->free_block;
    if (block == 0) {
        return queue->used_blocks++;
    }
    queue->free_block = queue->blocks[block].next;
    return block;
}

static void give_block(struct event_queue *queue, uint32_t block)
{
    queue->blocks[block].next = queue->free_block;
    queue->free_block = block;
}

static void set_empty(struct event_queue *queue, int digit, int value)
{
    queue->values[digit] &= ~(UINT64_C(1) << value);
    if (queue->values[digit] == 0) {
        queue->digits &= ~(1u << digit);
    }
}

/* Into the bucket where it belongs now. */
static void place(struct event_queue *queue, const struct event *event)
{
    const int digit = digit_of_difference(event->time, queue->now);
    const int value = (int)(event->time >> digit * EVENT_DIGIT_BITS & (EVENT_RADIX - 1));
    struct event_bucket *bucket = &queue->buckets[digit][value];
    if ((queue->values[digit] >> value & 1) == 0) {
        queue->values[digit] |= UINT64_C(1) << value;
        queue->digits |= 1u << digit;
        const uint32_t block = take_block(queue);
        *bucket = (struct event_bucket){.earliest = event->time, .first = block, .last = block};
    } else if (bucket->end == BLOCK_EVENTS) {
        const uint32_t block = take_block(queue);
        queue->blocks[bucket->last].next = block;
        bucket->last = block;
        bucket->end = 0;
    }
    if (event->time < bucket->earliest) {
        bucket->earliest = event->time;
    }
    queue->blocks[bucket->last].events[bucket->end++] = *event;
}

/* Place all events of a bucket anew, as queue->now has changed. */
static void move(struct event_queue *queue, int digit, int value)
{
    const struct event_bucket bucket = queue->buckets[digit][value];
    set_empty(queue, digit, value);
    uint32_t begin = bucket.begin;
    for (uint32_t block = bucket.first;; begin = 0) {
        const bool is_last = block == bucket.last;
        const uint32_t end = is_last ? bucket.end : BLOCK_EVENTS, next = queue->blocks[block].next;
        for (uint32_t i = begin; i < end; i++) {
            place(queue, &queue->blocks[block].events[i]);
        }
        give_block(queue, block);
        if (is_last) {
            return;
        }
        block = next;
    }
}

/* Time goes back to `time`: what was sorted by the digits below the one that changes no longer is. */
static void go_back(struct event_queue *queue, sim_time time)
{
    const int changed = digit_of_difference(time, queue->now);
    queue->now = time;
    for (int digit = 0; digit < changed; digit++) {
        while (queue->values[digit]) {
            move(queue, digit, lowest_bit(queue->values[digit]));
        }
    }
}

int event_queue_push(struct event_queue *queue, sim_time time, uint32_t content)
{
    if (queue->count == queue->room && grow(queue)) {
        return -1;
    }
    if (time < queue->now) {
        go_back(queue, time);
    }
    const struct event event = {time, content};
    place(queue, &event);
    queue->count++;
    return 0;
}

sim_time event_queue_next(const struct event_queue *queue)
{
    if (queue->count == 0) {
        return SIM_TIME_NEVER;
    }
    const int digit = lowest_bit(queue->digits);
    return queue->buckets[digit][lowest_bit(queue->values[digit])].earliest;
}

bool event_queue_pop(struct event_queue *queue, struct event *event)
{
    if (queue->count == 0) {
        return false;
    }
    const int digit = lowest_bit(queue->digits);
    queue->now = event_queue_next(queue);
    if (digit > 0) {
        move(queue, digit, lowest_bit(queue->values[digit]));
    }
    const int value = (int)(queue->now & (EVENT_RADIX - 1));
    struct event_bucket *bucket = &queue->buckets[0][value];
    const uint32_t block = bucket->first;
    *event = queue->blocks[block].events[bucket->begin++];
    queue->count--;
    const bool was_last = block == bucket->last && bucket->begin == bucket->end;
    if (was_last || bucket->begin == BLOCK_EVENTS) {
        bucket->first = queue->blocks[block].next;
        bucket->begin = 0;
        give_block(queue, block);
    }
    if (was_last) {
        set_empty(queue, 0, value);
    }
    return true;
}

void event_queue_free(struct event_queue *queue)
{
    free(queue->blocks);
    *queue = (struct event_queue){0};
}
