#include "engine/memory.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define LARGE_PAGE ((size_t)2 << 20)

void *memory_array(size_t count, size_t size)
{
    if (size > 0 && count > SIZE_MAX / size) {
        return NULL;
    }
    const size_t bytes = count * size;
    const bool large = bytes >= 4 * LARGE_PAGE;
    void *array;
    if (posix_memalign(&array, large ? LARGE_PAGE : CACHE_LINE, bytes)) {
        return NULL;
    }
#ifdef MADV_HUGEPAGE
    if (large) {
        (void)madvise(array, bytes, MADV_HUGEPAGE); /* a wish */
    }
#endif
    return memset(array, 0, bytes);
}
