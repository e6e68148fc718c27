/* Simulated time and what happens next.
 *
 * A radix heap (Ahuja, Mehlhorn, Orlin and Tarjan, "Faster algorithms for the shortest path problem", Journal of the ACM 37, 1990) with
 * digits of six bits: an event lies in the bucket of the highest digit in which its time differs from the time of the last
 * event taken, and moves to a lower one, with all of its bucket, when the lower ones are empty. Buckets keep the order of arrival, so
 * events of equal time come out in the order in which they went in. They are chains of small blocks, so that moving them
 * reads and writes memory in a row.
 *
 * Cost: push O(1), pop O(digits in which pending times differ: four for delays of seconds), amortised; no allocation but
 * to grow. The figures are in docs/scale.md. */
#ifndef MOTEHOUND_SIM_EVENT_QUEUE_H
#define MOTEHOUND_SIM_EVENT_QUEUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Simulated time: microseconds from the start of the run. */
typedef uint64_t sim_time;

#define SIM_TIME_PER_S 1000000u
#define SIM_TIME_NEVER UINT64_MAX

enum { EVENT_DIGIT_BITS = 6, EVENT_DIGITS = 11, EVENT_RADIX = 64 };

struct event {
    sim_time time;
    uint32_t content; /* the caller's: what is to happen */
};

struct event_bucket {
    sim_time earliest;
    uint32_t first, last; /* blocks */
    uint32_t begin, end;  /* events begin ... of the first block to ... end - 1 of the last */
};

/* All zero bytes: an empty queue. */
struct event_queue {
    sim_time now; /* of the last event taken */
    size_t count; /* of pending events ... */
    size_t room;  /* ... and how many there may be before there must be more blocks */
    struct event_block *blocks;
    uint32_t block_count, used_blocks, free_block;
    uint32_t digits;               /* one bit for each row of buckets that is not empty ... */
    uint64_t values[EVENT_DIGITS]; /* ... and for each bucket of it that is not */
    struct event_bucket buckets[EVENT_DIGITS][EVENT_RADIX];
};

/* A time before that of the last event taken is in order but costs time in the pending events. Returns 0, or -1 if there is no
 * memory (the queue is as before). */
int event_queue_push(struct event_queue *queue, sim_time time, uint32_t content);

/* When the earliest event is due; SIM_TIME_NEVER if there is none. */
sim_time event_queue_next(const struct event_queue *queue);

/* Take the earliest event out. False if there is none. */
bool event_queue_pop(struct event_queue *queue, struct event *event);

void event_queue_free(struct event_queue *queue);

#endif
