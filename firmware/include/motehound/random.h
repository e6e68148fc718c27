/* Random numbers for a mote, with the state in their owner: the same seed gives the same numbers on every machine.
 *
 * sfc32 (Doty-Humphrey, PractRand 0.94): three words that chaotically mix and a counter, so that no seed has a period below 2^32; additions and
 * shifts only, about 15 instructions of 32 bits a number. Not for secrets. */
#ifndef MOTEHOUND_RANDOM_H
#define MOTEHOUND_RANDOM_H

#include "motehound/real.h"

#include <stdint.h>

struct mh_random {
    uint32_t a, b, c, counter;
};

/* A uniform word. */
static inline uint32_t mh_random_word(struct mh_random *random)
{
    const uint32_t word = random->a + random->b + random->counter++;
#ifdef __AVR__ /* the same, of halves: it shifts 32 bits bit by bit */
    const uint16_t b = (uint16_t)random->b, b_high = (uint16_t)(random->b >> 16);
    const uint16_t c = (uint16_t)random->c, c_high = (uint16_t)(random->c >> 16);
    const uint32_t shifted = (uint32_t)(b_high >> 9) << 16 | (uint16_t)(b_high << 7 | b >> 9);
    const uint32_t turned = (uint32_t)(uint16_t)(c << 5 | c_high >> 11) << 16 | (uint16_t)(c_high << 5 | c >> 11);
    random->a = random->b ^ shifted;
    random->b = random->c * 9;
    random->c = turned + word;
#else
    random->a = random->b ^ (random->b >> 9);
    random->b = random->c + (random->c << 3);
    random->c = (random->c << 21 | random->c >> 11) + word;
#endif
    return word;
}

/* Begin; any seed will do. */
static inline void mh_random_init(struct mh_random *random, uint32_t seed)
{
    const struct mh_random begun = {0, seed, 0, 1};
    *random = begun;
    for (uint8_t i = 0; i < 12; i++) {
        (void)mh_random_word(random);
    }
}

/* Uniform in [0, 1), a multiple of 2^-24 (fixed point: of 2^-16). */
static inline mh_real mh_random_unit(struct mh_random *random)
{
#if MH_REAL_FIXED
    return mh_real_from_bits((int32_t)(mh_random_word(random) >> (32 - MH_REAL_BITS)));
#else
    return (mh_real)(int32_t)(mh_random_word(random) >> 8) * (1.0f / 16777216.0f);
#endif
}

/* Uniform in 0 .. count - 1; count 1 to 65,535, and no number more probable than another by more than count / 2^32. */
static inline uint16_t mh_random_below(struct mh_random *random, uint16_t count)
{
    const uint32_t word = mh_random_word(random);
    return (uint16_t)(((word >> 16) * count + ((word & 0xFFFFu) * count >> 16)) >> 16);
}

#endif
