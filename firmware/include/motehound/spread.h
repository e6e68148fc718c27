/* Pseudo-random waits that differ between neighbours and from one time to the next, and are the same on every machine. */
#ifndef MOTEHOUND_SPREAD_H
#define MOTEHOUND_SPREAD_H

#include <stdint.h>

/* A number below `limit`, spread evenly over pairs of `node` and `count`: both are mixed by a multiplicative hash (the finaliser of
 * MurmurHash3). */
static inline uint32_t mh_spread(uint32_t node, uint32_t count, uint32_t limit)
{
    uint32_t hash = node ^ count * 0x9E3779B1u;
    hash = (hash ^ hash >> 16) * 0x85EBCA6Bu;
    hash = (hash ^ hash >> 13) * 0xC2B2AE35u;
    hash ^= hash >> 16;
    return (uint32_t)((uint64_t)hash * limit >> 32);
}

#endif
