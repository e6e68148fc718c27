/* Memory for arrays with an element for each mote. */
#ifndef MOTEHOUND_SIM_MEMORY_H
#define MOTEHOUND_SIM_MEMORY_H

#include <stddef.h>

enum { CACHE_LINE = 64 };

/* `count` elements of `size` bytes, zeroed, from the beginning of a cache line; a large array lies in large pages where the system
 * has them, since a network touches its motes in no order. To be released with free(). NULL if there is no memory. */
void *memory_array(size_t count, size_t size);

#endif
