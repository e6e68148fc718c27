/* A fuzzer: LLVMFuzzerTestOneInput of one fuzz_NAME.c, called by libFuzzer, or by replay.c for a folder of inputs. */
#ifndef FUZZ_H
#define FUZZ_H

#include "motehound/real.h"
#include <stddef.h>
#include <stdint.h>

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A property that holds for every input, whatever the build. */
static inline void require(int holds)
{
    if (!holds) {
        abort();
    }
}

/* What there is in float alone: in fixed point the inputs that choose it are passed over. */
#if MH_REAL_FIXED
#define FLOAT_ONLY(thing) NULL
#else
#define FLOAT_ONLY(thing) (thing)
#endif

/* What is left of an input that is read from its beginning. */
struct input {
    const uint8_t *data;
    size_t left;
};

/* The next byte; 0 behind the end. */
static inline uint8_t byte(struct input *input)
{
    if (input->left == 0) {
        return 0;
    }
    input->left--;
    return *input->data++;
}

/* The next bytes, at most `most` -> to. Returns how many there were. */
static inline size_t bytes(struct input *input, uint8_t *to, size_t most)
{
    const size_t count = most < input->left ? most : input->left;
    memcpy(to, input->data, count);
    input->data += count;
    input->left -= count;
    return count;
}

#endif
