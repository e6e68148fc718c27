/* A fuzzer: LLVMFuzzerTestOneInput of one fuzz_NAME.c, called by libFuzzer, or by replay.c for a folder of inputs. */
#ifndef FUZZ_H
#define FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A property that holds for every input, whatever the build. */
static inline void require(int holds)
{
    if (!holds) {
        abort();
    }
}

#endif
