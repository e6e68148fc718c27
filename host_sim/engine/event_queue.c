#include "engine/event_queue.h"

#include <stdlib.h>

enum { ARITY = 4 };

static inline bool before(const struct event *a, const struct event *b)
{
    return a->time != b->time ? a->time < b->time : (int32_t)(a->order - b->order) < 0;
}

static int grow(struct event_queue *queue)
{
    const size_t capacity = queue->capacity ? 2 * queue->capacity : 1024;
    struct event *heap = realloc(queue->heap, capacity * sizeof *heap);
    if (!heap) {
        return -1;
    }
    queue->heap = heap;
    queue->capacity = capacity;
    return 0;
}

int event_queue_push(struct event_queue *queue, sim_time time, uint32_t content)
{
    if (queue->count == queue->capacity && grow(queue)) {
        return -1;
    }
    const struct event event = {time, queue->order++, content};
    size_t hole = queue->count++;
    while (hole > 0) {
        const size_t parent = (hole - 1) / ARITY;
        if (!before(&event, &queue->heap[parent])) {
            break;
        }
        queue->heap[hole] = queue->heap[parent];
        hole = parent;
    }
    queue->heap[hole] = event;
    return 0;
}

bool event_queue_pop(struct event_queue *queue, struct event *event)
{
    if (queue->count == 0) {
        return false;
    }
    struct event *heap = queue->heap;
    *event = heap[0];
    const struct event last = heap[--queue->count];
    const size_t count = queue->count;
    size_t hole = 0;
    for (;;) {
        const size_t first = ARITY * hole + 1;
        if (first >= count) {
            break;
        }
        const size_t end = first + ARITY < count ? first + ARITY : count;
        size_t least = first;
        for (size_t child = first + 1; child < end; child++) {
            if (before(&heap[child], &heap[least])) {
                least = child;
            }
        }
        if (!before(&heap[least], &last)) {
            break;
        }
        heap[hole] = heap[least];
        hole = least;
    }
    heap[hole] = last;
    return true;
}

void event_queue_free(struct event_queue *queue)
{
    free(queue->heap);
    *queue = (struct event_queue){0};
}
