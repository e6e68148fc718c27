#include "engine/arena.h"

#include <stdlib.h>

enum { FIRST_BLOCK = 256 };

/* Aligned for any scalar. */
union unit {
    long long integer;
    double real;
    void *pointer;
};

struct arena_block {
    struct arena_block *next;
    size_t count, used; /* units */
    union unit units[];
};

static struct arena_block *grow(struct arena *arena, size_t units)
{
    size_t count = arena->blocks ? 2 * arena->blocks->count : FIRST_BLOCK;
    while (count < units) {
        count *= 2;
    }
    struct arena_block *block = malloc(sizeof *block + count * sizeof block->units[0]);
    if (block) {
        block->next = arena->blocks;
        block->count = count;
        block->used = 0;
        arena->blocks = block;
    }
    return block;
}

void *arena_take(struct arena *arena, size_t size)
{
    const size_t units = (size + sizeof(union unit) - 1) / sizeof(union unit);
    struct arena_block *block = arena->blocks;
    if (!block || block->count - block->used < units) {
        block = grow(arena, units);
        if (!block) {
            return NULL;
        }
    }
    union unit *piece = &block->units[block->used];
    block->used += units;
    return piece;
}

static void free_from(struct arena_block *block)
{
    while (block) {
        struct arena_block *next = block->next;
        free(block);
        block = next;
    }
}

void arena_reset(struct arena *arena)
{
    if (arena->blocks) {
        free_from(arena->blocks->next);
        arena->blocks->next = NULL;
        arena->blocks->used = 0;
    }
}

void arena_free(struct arena *arena)
{
    free_from(arena->blocks);
    *arena = (struct arena){0};
}
