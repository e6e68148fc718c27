/* Memory that is handed out piece by piece and taken back all at once: what has to last for one window of simulated time. */
#ifndef MOTEHOUND_SIM_ARENA_H
#define MOTEHOUND_SIM_ARENA_H

#include <stddef.h>

struct arena_block;

/* All zero bytes: an empty arena. */
struct arena {
    struct arena_block *blocks; /* the one in use first */
};

/* `size` bytes, aligned for any scalar, that stay where they are until arena_reset. NULL if there is no memory. */
void *arena_take(struct arena *arena, size_t size);

/* All that was handed out is free again. The largest block is kept, so that an arena that has grown allocates no more. */
void arena_reset(struct arena *arena);

void arena_free(struct arena *arena);

#endif
