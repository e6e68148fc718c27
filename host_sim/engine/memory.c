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

void *memory_reserve(size_t size)
{
    void *memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        return NULL;
    }
#ifdef MADV_NOHUGEPAGE
    (void)madvise(memory, size, MADV_NOHUGEPAGE); /* a wish */
#endif
    return memory;
}

void memory_release(void *memory, size_t size)
{
    if (memory) {
        (void)munmap(memory, size);
    }
}
