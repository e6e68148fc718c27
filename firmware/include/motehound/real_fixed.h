/* mh_real as a fixed-point number: signed, 16 fractional bits (Q15.16). Included by real.h.
 *
 * Range +-32767.99998, resolution 1.5e-5. Every function rounds to nearest and saturates to +-MH_REAL_INFINITE, which mh_finite tells from a
 * number: so an overflow is seen where a float's infinity would be. + and - are the language's own and do not saturate: whoever adds keeps the operands
 * small enough, or uses mh_add. There is no NaN; 0 / 0, the root and the logarithm of a negative number are infinite. All results are the same on
 * every machine, bit by bit.
 *
 * Largest error besides rounding (half of 1.5e-5): mh_exp 1e-8 of the result, mh_log 1e-7, mh_atan2 2e-5. */
#ifndef MOTEHOUND_REAL_FIXED_H
#define MOTEHOUND_REAL_FIXED_H

#include <stdbool.h>
#include <stdint.h>

typedef int32_t mh_real;

#define MH_REAL_BITS 16
#define MH_REAL_ONE ((mh_real)1 << MH_REAL_BITS)
#define MH_REAL(constant) ((mh_real)((constant)*65536.0f + ((constant) < 0 ? -0.5f : 0.5f)))
#define MH_REAL_UPTO(constant) MH_REAL((constant) < 32767.0f ? (constant) : 32767.0f)
#define MH_REAL_MIN ((mh_real)1)
#define MH_REAL_INFINITE ((mh_real)INT32_MAX)
#define MH_REAL_MAX (MH_REAL_INFINITE - 1)

static inline mh_real mh_abs(mh_real a) { return a < 0 ? -a : a; }

/* True unless a is what an overflow leaves. */
static inline bool mh_finite(mh_real a) { return a <= MH_REAL_MAX && a >= -MH_REAL_MAX; }

/* A wide number, saturated. */
static inline mh_real mh_real_saturate(int64_t a)
{
    return a > MH_REAL_MAX ? MH_REAL_INFINITE : a < -MH_REAL_MAX ? -MH_REAL_INFINITE : (mh_real)a;
}

/* a + b, saturated; an infinite one stays infinite. */
static inline mh_real mh_add(mh_real a, mh_real b)
{
    if (!mh_finite(a) || !mh_finite(b)) {
        return mh_finite(a) ? b : a;
    }
    const bool over = b > 0 && a > MH_REAL_INFINITE - b, under = b < 0 && a < -MH_REAL_INFINITE - b;
    return over ? MH_REAL_INFINITE : under ? -MH_REAL_INFINITE : a + b;
}

/* Whether the machine multiplies to 64 bits in a few instructions. Without, halves of 16 bits are quicker. */
#if defined __ARM_ARCH_6M__ || defined __ARM_ARCH_8M_BASE__ || defined __AVR__ || defined __MSP430__
#define MH_REAL_WIDE 0
mh_real mh_mul(mh_real a, mh_real b);
#else
#define MH_REAL_WIDE 1
static inline mh_real mh_mul(mh_real a, mh_real b)
{
    return mh_real_saturate(((int64_t)a * b + MH_REAL_ONE / 2) >> MH_REAL_BITS);
}
#endif
mh_real mh_div(mh_real a, mh_real b);

/* a b / 2^shift, rounded and saturated, for shift <= 62: a product of numbers in other formats. */
int32_t mh_mul_shift(int32_t a, int32_t b, uint8_t shift);

/* A product of two reals, exact, with 32 fractional bits; two of them may be added. */
typedef int64_t mh_wide;
static inline mh_wide mh_wide_mul(mh_real a, mh_real b) { return (int64_t)a * b; }
mh_real mh_wide_div(mh_wide a, mh_real b);
mh_real mh_wide_ratio(mh_wide a, mh_wide b);
mh_real mh_wide_sqrt(mh_wide a);
static inline mh_real mh_wide_to_real(mh_wide a) { return mh_real_saturate((a + MH_REAL_ONE / 2) >> MH_REAL_BITS); }

mh_real mh_sqrt(mh_real a);
mh_real mh_exp(mh_real a);
mh_real mh_log(mh_real a);
mh_real mh_atan2(mh_real y, mh_real x);

/* The real of these bits, bits / 65536. */
static inline mh_real mh_real_from_bits(int32_t bits) { return bits; }
static inline int32_t mh_real_to_bits(mh_real a) { return a; }

/* Integers as reals: a, and a / b for b > 0. */
mh_real mh_real_from_int(int32_t a);
mh_real mh_real_from_ratio(int32_t a, int32_t b);

/* a / b for a real and an integer b > 0. */
static inline mh_real mh_real_over(mh_real a, int16_t b) { return (a + (a < 0 ? -b / 2 : b / 2)) / b; }

/* The integer a b, its fraction cut off, for a real and an integer b > 0; saturated. */
int32_t mh_real_times(mh_real a, int32_t b);

/* The integer nearest to a. */
static inline int32_t mh_real_round(mh_real a)
{
    return (a < -INT32_MAX + 32768  ? -INT32_MAX
            : a < 0                 ? a - 32768
            : a > INT32_MAX - 32768 ? INT32_MAX
                                    : a + 32768) /
           65536;
}

/* As the bits of an IEEE 754 binary32 (rounded to 24 significant bits; infinite as infinity), and back (saturated; NaN as infinite), in integers. */
uint32_t mh_real_to_ieee(mh_real a);
mh_real mh_real_from_ieee(uint32_t bits);

static inline mh_real mh_real_from_float(float a)
{
    const float scaled = a * 65536.0f;
    return scaled >= 2147483520.0f    ? MH_REAL_INFINITE
           : scaled <= -2147483520.0f ? -MH_REAL_INFINITE
           : scaled == scaled         ? (mh_real)(scaled < 0 ? scaled - 0.5f : scaled + 0.5f)
                                      : MH_REAL_INFINITE;
}

static inline float mh_real_to_float(mh_real a) { return (float)a * (1.0f / 65536.0f); }

/* From and to Q11.20. To: saturated. */
static inline mh_real mh_q20_to_real(int32_t a) { return (a >> 4) + (a >> 3 & 1); }

static inline int32_t mh_q20_from_real(mh_real a)
{
    return a > INT32_MAX / 16 ? INT32_MAX : a < INT32_MIN / 16 ? INT32_MIN : a * 16;
}

#endif
