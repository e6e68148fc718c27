/* Random numbers as a function of (seed, purpose, counter): SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom
 * number generators", 2014), whose n-th output needs no state but n. So what a node draws does not depend on the order in which
 * events happen, and one purpose never shifts another. */
#ifndef MOTEHOUND_SIM_RANDOM_H
#define MOTEHOUND_SIM_RANDOM_H

#include <stddef.h>
#include <stdint.h>

/* What a stream is for. The state of a stream begins at seed + 1,000,000 x purpose. */
enum random_purpose {
    RANDOM_DEPLOYMENT,
    RANDOM_RELATIVE_NOISE,
    RANDOM_ADDITIVE_NOISE,
    RANDOM_READING_LOSS,
    RANDOM_RADIO_LOSS,
    RANDOM_CLOCK,
    RANDOM_TRAFFIC,
    RANDOM_FAULTS, /* whom they hit */
    RANDOM_SPIKES,
    RANDOM_RADIO_BACKOFF,
    RANDOM_RADIO_SHADOWING,
    RANDOM_RADIO_BURST,
    RANDOM_TARGET,   /* where it starts and how it accelerates */
    RANDOM_SUMMARIES /* which of them an ideal network loses */
};

struct random_stream {
    uint64_t start;
};

static inline struct random_stream random_stream(uint64_t seed, enum random_purpose purpose)
{
    return (struct random_stream){seed + UINT64_C(1000000) * (uint64_t)purpose};
}

/* Output number `counter` (from 0) of SplitMix64 started at the stream's state. */
static inline uint64_t random_bits(struct random_stream stream, uint64_t counter)
{
    uint64_t z = stream.start + (counter + 1) * UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

/* Uniform in [0, 1), 53 bits. */
static inline double random_uniform(struct random_stream stream, uint64_t counter)
{
    return (double)(random_bits(stream, counter) >> 11) * 0x1p-53;
}

/* Standard normal numbers first ... first + count - 1 of the stream. Box-Muller: numbers 2i and 2i + 1 are r cos a and r sin a with
 * r = sqrt(-2 ln(1 - u_2i)), a = 2 pi u_2i+1. */
void random_normals(struct random_stream stream, uint64_t first, size_t count, double *normals);

#endif
