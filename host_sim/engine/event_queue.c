#include "engine/event_queue.h"

#include <stdlib.h>
#include <string.h>

/* The children of entry i are 4 (i - 2) ... 4 (i - 2) + 3: with the root at 3, four siblings share a cache line. */
enum { ARITY = 4, ROOT = 3, CACHE_LINE = 64 };

static inline size_t first_child(size_t i) { return ARITY * (i - 2); }
static inline size_t parent_of(size_t i) { return i / ARITY + 2; }

static inline bool before(const struct event *a, const struct event *b)
{
    return a->time != b->time ? a->time < b->time : (int32_t)(a->order - b->order) < 0;
}

static int grow(struct event_queue *queue)
{
    const size_t capacity = queue->capacity ? 2 * queue->capacity : 1024;
    void *block;
    if (posix_memalign(&block, CACHE_LINE, (capacity + ROOT) * sizeof *queue->heap)) {
        return -1;
    }
    if (queue->heap) {
        memcpy(block, queue->heap, (queue->count + ROOT) * sizeof *queue->heap);
    }
    free(queue->heap);
    queue->heap = block;
    queue->capacity = capacity;
    return 0;
}

int event_queue_push(struct event_queue *queue, sim_time time, uint32_t content)
{
    if (queue->count == queue->capacity && grow(queue)) {
        return -1;
    }
    const struct event event = {time, queue->order++, content};
    size_t hole = ROOT + queue->count++;
    while (hole > ROOT) {
        const size_t parent = parent_of(hole);
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
    *event = heap[ROOT];
    const size_t last = ROOT + --queue->count; /* to fill the hole */
    size_t hole = ROOT;
    for (size_t first; (first = first_child(hole)) < last;) {
        const size_t end = first + ARITY < last ? first + ARITY : last;
        const size_t grandchild = first_child(first);
        for (size_t i = 0; i < ARITY && grandchild + i * ARITY < last; i++) {
            __builtin_prefetch(&heap[grandchild + i * ARITY]); /* a line for each child, while these are compared */
        }
        size_t least = first;
        for (size_t child = first + 1; child < end; child++) {
            if (before(&heap[child], &heap[least])) {
                least = child;
            }
        }
        if (!before(&heap[least], &heap[last])) {
            break;
        }
        heap[hole] = heap[least];
        hole = least;
    }
    heap[hole] = heap[last];
    return true;
}

void event_queue_free(struct event_queue *queue)
{
    free(queue->heap);
    *queue = (struct event_queue){0};
}
