/* Random numbers in sequence: SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014), by which the experiments with sound are drawn. Its
 * state begins at seed G + stream 0xD1B54A32D192ED03, G = 0x9E3779B97F4A7C15, modulo 2^64; each step adds G. So the numbers of seed s + 1 are those of seed s but for the first. */
#ifndef MOTEHOUND_SIM_SPLITMIX_H
#define MOTEHOUND_SIM_SPLITMIX_H

#include <stdint.h>

/* What a stream is for. */
enum splitmix_stream { SPLITMIX_DEPLOYMENT, SPLITMIX_SENSING, SPLITMIX_TARGETS, SPLITMIX_RADIO, SPLITMIX_OTHER };

struct splitmix {
    uint64_t state;
};

struct splitmix splitmix_begin(uint64_t seed, enum splitmix_stream stream);

uint64_t splitmix_next(struct splitmix *stream);

/* In [0, 1), 53 bits. */
double splitmix_uniform(struct splitmix *stream);

/* Standard normal, sqrt(-2 ln(1 - u1)) cos(2 pi u2): two numbers each. */
double splitmix_normal(struct splitmix *stream);

#endif
