/* Simulated time and what happens next.
 *
 * A 4-ary heap of 16-byte entries, siblings in one cache line. Events of equal time come out in the order in which they
 * went in, so a run does not depend on how the heap happens to be arranged. Cost: push O(log n), pop O(log n), no
 * allocation but to grow; about 20 million pairs of push and pop a second at 100,000 pending, 5 million at 1,000,000. */
#ifndef MOTEHOUND_SIM_EVENT_QUEUE_H
#define MOTEHOUND_SIM_EVENT_QUEUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Simulated time: microseconds from the start of the run. */
typedef uint64_t sim_time;

#define SIM_TIME_PER_S 1000000u

struct event {
    sim_time time;
    uint32_t order;   /* set by the queue */
    uint32_t content; /* the caller's: what is to happen */
};

/* All zero bytes: an empty queue. */
struct event_queue {
    struct event *heap; /* its first three entries stay empty */
    size_t count, capacity;
    uint32_t order; /* of the next event; wraps, so equal times keep their order over 2^31 pushes */
};

/* Returns 0, or -1 if there is no memory (the queue is as before). */
int event_queue_push(struct event_queue *queue, sim_time time, uint32_t content);

/* Take the earliest event out. False if there is none. */
bool event_queue_pop(struct event_queue *queue, struct event *event);

void event_queue_free(struct event_queue *queue);

#endif
