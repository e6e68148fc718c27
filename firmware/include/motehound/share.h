/* A share: a real within -1 and 1 that keeps its digits however small it is. In fixed point it has 30 fractional bits (Q1.30) beside the 16 of mh_real, so a
 * weight of 0.002 or a gain of 0.01 is not rounded before it meets what it weighs, and a product with one is rounded once, to nearest. No result is larger than its
 * operands, so nothing saturates. */
#ifndef MOTEHOUND_SHARE_H
#define MOTEHOUND_SHARE_H

#include "motehound/real.h"

#if MH_REAL_FIXED

typedef int32_t mh_share;

#define MH_SHARE_BITS 30
#define MH_SHARE(constant) ((mh_share)((constant)*1073741824.0f))

static inline mh_real mh_share_round(int64_t product)
{
    return (mh_real)((product + ((int64_t)1 << (MH_SHARE_BITS - 1))) >> MH_SHARE_BITS);
}

/* share whole */
static inline mh_real mh_part(mh_share share, mh_real whole) { return mh_share_round((int64_t)share * whole); }

/* c a + s b, for c^2 + s^2 <= 1 and |a|, |b| below 2^30 */
static inline mh_real mh_turned(mh_share c, mh_real a, mh_share s, mh_real b)
{
    return mh_share_round((int64_t)c * a + (int64_t)s * b);
}

/* (1 - share) before + share now, for 0 <= share <= 1 */
static inline mh_real mh_blend(mh_share share, mh_real before, mh_real now)
{
    return (mh_real)(before + mh_share_round((int64_t)share * ((int64_t)now - before)));
}

/* part / whole, for 0 <= part <= whole and whole > 0 */
static inline mh_share mh_share_of(mh_real part, mh_real whole)
{
    return (mh_share)(((uint64_t)(uint32_t)part << MH_SHARE_BITS) / (uint32_t)whole);
}

#else

typedef mh_real mh_share;

#define MH_SHARE(constant) (constant)

static inline mh_real mh_part(mh_share share, mh_real whole) { return share * whole; }
static inline mh_real mh_turned(mh_share c, mh_real a, mh_share s, mh_real b) { return c * a + s * b; }
static inline mh_real mh_blend(mh_share share, mh_real before, mh_real now)
{
    return (1 - share) * before + share * now;
}
static inline mh_share mh_share_of(mh_real part, mh_real whole) { return part / whole; }

#endif
#endif
