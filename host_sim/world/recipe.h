/* Random numbers as a function of (seed, a, b): where the nodes stand, how the target moves and how noisy each range is, the same whoever
 * asks and in whatever order. With the SplitMix64 finaliser mix() and G = 0x9E3779B97F4A7C15, all modulo 2^64:
 *
 *   h(seed, a, b) = mix(mix(mix(seed + G) + G (a + 1)) + G (b + 1))
 *   U(seed, a, b) = ((h >> 11) + 1/2) 2^-53                                      in (0, 1)
 *   g(seed, a, b) = sqrt(-2 ln U(seed, a, 2b)) cos(2 pi U(seed, a, 2b + 1))      standard normal
 */
#ifndef MOTEHOUND_SIM_RECIPE_H
#define MOTEHOUND_SIM_RECIPE_H

#include <stdint.h>

/* What a number `a` is for. The noise of sample t has a = RECIPE_RANGE_NOISE + t, and b is the node. */
enum recipe_purpose {
    RECIPE_NODE_X = 1, /* b: the node */
    RECIPE_NODE_Y = 2,
    RECIPE_START = 3, /* b: 0 for x, 1 for y, 2 for the mean heading */
    RECIPE_SPEED = 4, /* b: the step */
    RECIPE_HEADING = 5,
    RECIPE_GAS_NOISE = 16, /* b: the millisecond and the node */
    RECIPE_GAS_FLUCTUATION = 17,
    RECIPE_FIRST_HEAD = 18,   /* b: which of a deployment's searches */
    RECIPE_SOUND_SOURCE = 19, /* b: the millisecond and the node */
    RECIPE_SOUND_BACKGROUND = 20,
    RECIPE_RANGE_NOISE = 1000
};

uint64_t recipe_hash(uint64_t seed, uint64_t a, uint64_t b);

double recipe_uniform(uint64_t seed, uint64_t a, uint64_t b);

double recipe_normal(uint64_t seed, uint64_t a, uint64_t b);

#endif
