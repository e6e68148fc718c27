/* A share: a real within -1 and 1 that keeps its digits however small it is. In fixed point it has 30 fractional bits (Q1.30) beside the 16 of mh_real, so that a
 * weight of 0.002 or a gain of 0.01 is not rounded before it meets what it weighs.
 *
 *     MH_SHARE(0.1f)            a constant
 *     mh_share_of(part, whole)  part / whole, for 0 <= part <= whole, whole > 0
 *     mh_share_from_real(a)     a, for -1 <= a <= 1
 *     mh_share_finite(a)        false if a is no number, or in fixed point no share
 *     mh_share_mul(a, b)        a b
 *     mh_share_power(a, n)      a^n, for a >= 0
 *     mh_part(share, a)         share a
 *     mh_blend(share, a, b)     (1 - share) a + share b, for |b - a| < 32,768
 *     mh_turn(a, b, &c, &s)     cosine and sine of the turn that brings (a, b) onto the axis of a; false if both are 0
 *     mh_turned(c, a, s, b)     c a + s b
 *     mh_hypot(a, b)            the root of a^2 + b^2
 *
 * Scaling and overflow, in fixed point. Products and sums of two products are rounded once, to nearest, and are not larger than what the comments say, so nothing
 * saturates; the operands of a turn take 2^30.3, or 18,000 as mh_real. Cosine and sine come without a division from the inverse root of the sum of
 * squares: each is rounded to 2^-29, and both may be too large or small by the same 4e-9.
 *
 * Cost, in fixed point, in products of 32 bits by 32 to 64 (one instruction from a Cortex-M3 on, else a routine): mh_part and mh_share_mul 1, mh_turned and mh_blend 2, mh_turn 6,
 * eight of 16 bits, and up to 29 doublings, mh_hypot 8, mh_share_power 2 for each binary digit of n; mh_share_of a division of 64 bits; the others none. With floats mh_turn is a root
 * and three divisions, mh_hypot a root and a division, mh_share_power a logarithm and an exponential. */
#ifndef MOTEHOUND_SHARE_H
#define MOTEHOUND_SHARE_H

#include "motehound/real.h"

#if MH_REAL_FIXED

typedef int32_t mh_share;

#define MH_SHARE_BITS 30
#define MH_SHARE(constant) ((mh_share)((constant)*1073741824.0f))

#if MH_REAL_WIDE
static inline int32_t mh_share_round(int64_t product)
{
    return (int32_t)((product + ((int64_t)1 << (MH_SHARE_BITS - 1))) >> MH_SHARE_BITS);
}

static inline mh_real mh_part(mh_share share, mh_real a) { return mh_share_round((int64_t)share * a); }

static inline mh_real mh_turned(mh_share c, mh_real a, mh_share s, mh_real b)
{
    return mh_share_round((int64_t)c * a + (int64_t)s * b);
}
#else
mh_real mh_part(mh_share share, mh_real a);
mh_real mh_turned(mh_share c, mh_real a, mh_share s, mh_real b);
#endif

mh_share mh_share_of(mh_real part, mh_real whole);
mh_share mh_share_power(mh_share a, uint32_t n);
bool mh_turn(mh_real a, mh_real b, mh_share *c, mh_share *s);
mh_real mh_hypot(mh_real a, mh_real b);

static inline mh_share mh_share_from_real(mh_real a) { return a * ((int32_t)1 << (MH_SHARE_BITS - MH_REAL_BITS)); }
static inline bool mh_share_finite(mh_share a) { return a <= MH_SHARE(1.0f) && a >= -MH_SHARE(1.0f); }
static inline mh_share mh_share_mul(mh_share a, mh_share b) { return mh_part(a, b); }
static inline mh_real mh_blend(mh_share share, mh_real a, mh_real b) { return a + mh_turned(share, b, -share, a); }

#else

typedef mh_real mh_share;

#define MH_SHARE(constant) (constant)

static inline mh_share mh_share_of(mh_real part, mh_real whole) { return part / whole; }
static inline mh_share mh_share_from_real(mh_real a) { return a; }
static inline bool mh_share_finite(mh_share a) { return mh_finite(a); }
static inline mh_share mh_share_mul(mh_share a, mh_share b) { return a * b; }
static inline mh_share mh_share_power(mh_share a, uint32_t n) { return mh_exp((mh_real)n * mh_log(a)); }
static inline mh_real mh_part(mh_share share, mh_real a) { return share * a; }
static inline mh_real mh_blend(mh_share share, mh_real a, mh_real b) { return (1 - share) * a + share * b; }
static inline mh_real mh_turned(mh_share c, mh_real a, mh_share s, mh_real b) { return c * a + s * b; }

/* without overflow or underflow of the squares */
static inline mh_real mh_hypot(mh_real a, mh_real b)
{
    const mh_real large = mh_max(mh_abs(a), mh_abs(b)), small = mh_min(mh_abs(a), mh_abs(b));
    if (large == 0) {
        return 0;
    }
    const mh_real ratio = small / large;
    return large * mh_sqrt(1 + ratio * ratio);
}

static inline bool mh_turn(mh_real a, mh_real b, mh_share *c, mh_share *s)
{
    const mh_real length = mh_hypot(a, b);
    if (length == 0) {
        return false;
    }
    *c = a / length;
    *s = b / length;
    return true;
}

#endif
#endif
