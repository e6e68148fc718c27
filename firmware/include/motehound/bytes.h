/* Numbers as bytes that are the same on every machine: the most significant first, as in the frames. */
#ifndef MOTEHOUND_BYTES_H
#define MOTEHOUND_BYTES_H

#include "motehound/real.h"

#include <stdint.h>

/* Each writes or reads at *at and moves it on. Signed numbers are in two's complement. */
static inline void mh_put_u16(uint8_t **at, uint16_t value)
{
    *(*at)++ = (uint8_t)(value >> 8);
    *(*at)++ = (uint8_t)value;
}

static inline void mh_put_u32(uint8_t **at, uint32_t value)
{
    mh_put_u16(at, (uint16_t)(value >> 16));
    mh_put_u16(at, (uint16_t)value);
}

static inline uint16_t mh_get_u16(const uint8_t **at)
{
    const uint16_t high = *(*at)++;
    return (uint16_t)((uint16_t)(high << 8) | *(*at)++);
}

static inline uint32_t mh_get_u32(const uint8_t **at)
{
    const uint32_t high = mh_get_u16(at);
    return high << 16 | mh_get_u16(at);
}

static inline int16_t mh_get_i16(const uint8_t **at)
{
    const uint16_t bits = mh_get_u16(at);
    return bits > INT16_MAX ? (int16_t)((int32_t)bits - 65536) : (int16_t)bits;
}

static inline int32_t mh_get_i32(const uint8_t **at)
{
    const uint32_t bits = mh_get_u32(at);
    return bits > INT32_MAX ? -(int32_t)(UINT32_MAX - bits) - 1 : (int32_t)bits;
}

/* mh_real as IEEE 754 binary32, whatever it is on this machine */
static inline void mh_put_real(uint8_t **at, mh_real value) { mh_put_u32(at, mh_real_to_ieee(value)); }
static inline mh_real mh_get_real(const uint8_t **at) { return mh_real_from_ieee(mh_get_u32(at)); }

#endif
