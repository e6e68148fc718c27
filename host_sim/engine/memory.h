/* Memory for what each mote has. */
#ifndef MOTEHOUND_SIM_MEMORY_H
#define MOTEHOUND_SIM_MEMORY_H

#include <stddef.h>

enum { CACHE_LINE = 64 };

/* `count` elements of `size` bytes, zeroed, from the beginning of a cache line; a large array lies in large pages where the system
 * has them, since a network touches its motes in no order. To be released with free(). NULL if there is no memory. */
void *memory_array(size_t count, size_t size);

/* `size` bytes, zeroed, from the beginning of a page. The system backs a page when it is touched: large memory of which little is used costs little.
 * To be released with memory_release(). NULL if there is no memory. */
void *memory_reserve(size_t size);

void memory_release(void *memory, size_t size);

#endif
