#include "motehound/real.h"

#if MH_REAL_FIXED

/* Products of numbers with 30 fractional bits. */
static int32_t mul30(int32_t a, int32_t b) { return (int32_t)(((int64_t)a * b + (1l << 29)) >> 30); }

#define Q30(constant) ((int32_t)((constant)*1073741824.0f))

mh_real mh_mul(mh_real a, mh_real b) { return mh_real_saturate(((int64_t)a * b + MH_REAL_ONE / 2) >> MH_REAL_BITS); }

mh_real mh_div(mh_real a, mh_real b)
{
    const bool negative = (a < 0) != (b < 0);
    const uint32_t over = (uint32_t)mh_abs(a), under = (uint32_t)mh_abs(b);
    if (under == 0) {
        return negative ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    const uint64_t quotient = (((uint64_t)over << MH_REAL_BITS) + under / 2) / under;
    const mh_real saturated = quotient > MH_REAL_MAX ? MH_REAL_INFINITE : (mh_real)quotient;
    return negative ? -saturated : saturated;
}

/* The fractional bits of a quotient are those of a less those of b. */
mh_real mh_wide_div(mh_wide a, mh_real b)
{
    if (b == 0) {
        return a < 0 ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    const bool negative = (a < 0) != (b < 0);
    const uint64_t over = a < 0 ? 0 - (uint64_t)a : (uint64_t)a, under = (uint32_t)mh_abs(b);
    const uint64_t quotient = (over + under / 2) / under;
    const mh_real saturated = quotient > MH_REAL_MAX ? MH_REAL_INFINITE : (mh_real)quotient;
    return negative ? -saturated : saturated;
}

/* Both are shortened until the divisor has 31 bits; a dividend that then has no room for the fraction is too large anyway. */
mh_real mh_wide_ratio(mh_wide a, mh_wide b)
{
    const bool negative = (a < 0) != (b < 0);
    uint64_t over = a < 0 ? 0 - (uint64_t)a : (uint64_t)a, under = b < 0 ? 0 - (uint64_t)b : (uint64_t)b;
    for (; under >> 31 != 0; under >>= 1) {
        over >>= 1;
    }
    if (under == 0 || over >> 47 != 0) {
        return negative ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    const uint64_t quotient = ((over << MH_REAL_BITS) + under / 2) / under;
    const mh_real saturated = quotient > MH_REAL_MAX ? MH_REAL_INFINITE : (mh_real)quotient;
    return negative ? -saturated : saturated;
}

mh_real mh_sqrt(mh_real a) { return mh_wide_sqrt((mh_wide)a * MH_REAL_ONE); }

mh_real mh_wide_sqrt(mh_wide a)
{
    if (a < 0) {
        return -MH_REAL_INFINITE;
    }
    uint64_t rest = (uint64_t)a, root = 0, bit = (uint64_t)1 << 62;
    while (bit > rest) {
        bit >>= 2;
    }
    for (; bit > 0; bit >>= 2) {
        if (rest >= root + bit) {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    return mh_real_saturate((int64_t)(rest > root ? root + 1 : root)); /* to nearest */
}

/* 2^(whole + part) with part within +-1/2, by the series of e^x. */
mh_real mh_exp(mh_real a)
{
    if (a > MH_REAL(10.3972f)) {
        return MH_REAL_INFINITE;
    }
    if (a < MH_REAL(-12.0f)) {
        return 0;
    }
    const int64_t binary = (int64_t)a * 1549082005; /* log2(e) with 30 fractional bits more */
    const int32_t whole = (int32_t)((binary + ((int64_t)1 << 45)) >> 46);
    const int32_t x = mul30((int32_t)((binary - (int64_t)whole * ((int64_t)1 << 46)) >> 16), Q30(0.693147181f));
    int32_t sum = Q30(1.0f / 5040);
    static const int32_t coefficients[] = {Q30(1.0f / 720), Q30(1.0f / 120), Q30(1.0f / 24),
                                           Q30(1.0f / 6),   Q30(0.5f),       Q30(1.0f)};
    for (uint8_t i = 0; i < sizeof coefficients / sizeof coefficients[0]; i++) {
        sum = coefficients[i] + mul30(x, sum);
    }
    const int64_t power = (int64_t)Q30(1.0f) + mul30(x, sum);
    const int32_t shift = 30 - MH_REAL_BITS - whole;
    return shift <= 0 ? mh_real_saturate(power << -shift)
                      : mh_real_saturate((power + ((int64_t)1 << (shift - 1))) >> shift);
}

/* The number as m 2^k with m within a factor of the root of 2 of 1; ln m = 2 artanh((m - 1) / (m + 1)). */
mh_real mh_log(mh_real a)
{
    if (a <= 0) {
        return -MH_REAL_INFINITE;
    }
    int8_t exponent = 14;
    int32_t m = a; /* 30 fractional bits in the end */
    for (; m < Q30(1.0f); exponent--) {
        m *= 2;
    }
    if (m > Q30(1.41421356f)) {
        m /= 2;
        exponent++;
    }
    const int32_t t = (int32_t)((int64_t)(m - Q30(1.0f)) * Q30(1.0f) / ((int64_t)m + Q30(1.0f))), square = mul30(t, t);
    const int32_t series =
        Q30(1.0f) + mul30(square, Q30(1.0f / 3) + mul30(square, Q30(1.0f / 5) + mul30(square, Q30(1.0f / 7))));
    const int64_t sum = 2 * (int64_t)mul30(t, series) + (int64_t)exponent * Q30(0.693147181f);
    return (mh_real)((sum + (1l << 13)) >> 14);
}

/* By a polynomial of the smaller over the larger coordinate (Hastings). */
mh_real mh_atan2(mh_real y, mh_real x)
{
    const int64_t large = mh_abs(x) > mh_abs(y) ? mh_abs(x) : mh_abs(y),
                  small = mh_abs(x) > mh_abs(y) ? mh_abs(y) : mh_abs(x);
    if (large == 0) {
        return 0;
    }
    const int32_t z = (int32_t)(small * Q30(1.0f) / large), square = mul30(z, z);
    int32_t sum = Q30(-0.01172120f);
    static const int32_t coefficients[] = {Q30(0.05265332f), Q30(-0.11643287f), Q30(0.19354346f), Q30(-0.33262347f),
                                           Q30(0.99997726f)};
    for (uint8_t i = 0; i < sizeof coefficients / sizeof coefficients[0]; i++) {
        sum = coefficients[i] + mul30(square, sum);
    }
    int32_t angle = mul30(z, sum) >> 14;
    angle = mh_abs(y) > mh_abs(x) ? MH_REAL(1.57079633f) - angle : angle;
    angle = x < 0 ? MH_REAL(3.14159265f) - angle : angle;
    return y < 0 ? -angle : angle;
}

mh_real mh_real_from_int(int32_t a) { return mh_real_saturate((int64_t)a * MH_REAL_ONE); }

mh_real mh_real_from_ratio(int32_t a, int32_t b)
{
    const int64_t wide = (int64_t)a * MH_REAL_ONE;
    return mh_real_saturate((wide + (wide < 0 ? -b / 2 : b / 2)) / b);
}

int32_t mh_real_times(mh_real a, int32_t b)
{
    const int64_t product = (int64_t)a * b / MH_REAL_ONE;
    return product > INT32_MAX ? INT32_MAX : product < INT32_MIN ? INT32_MIN : (int32_t)product;
}

uint32_t mh_real_to_ieee(mh_real a)
{
    const uint32_t sign = a < 0 ? 0x80000000u : 0;
    if (!mh_finite(a)) {
        return sign | 0x7F800000u;
    }
    uint64_t mantissa = (uint64_t)(uint32_t)mh_abs(a) << 24;
    if (mantissa == 0) {
        return 0;
    }
    uint32_t exponent = 127 + 31 - MH_REAL_BITS;
    for (; mantissa < (uint64_t)1 << 55; exponent--) {
        mantissa <<= 1;
    }
    /* the leading one, at bit 23 after rounding, adds to the exponent, as a carry does */
    return sign | (((exponent - 1) << 23) + (uint32_t)((mantissa + ((uint64_t)1 << 31)) >> 32));
}

mh_real mh_real_from_ieee(uint32_t bits)
{
    const int16_t exponent = (int16_t)((bits >> 23 & 0xFF) - 127);
    const int64_t mantissa = (int64_t)(bits & 0x7FFFFF) | 0x800000;
    if (exponent < -MH_REAL_BITS - 1) {
        return 0;
    }
    const int8_t shift = (int8_t)(23 - MH_REAL_BITS - (exponent > 20 ? 20 : exponent));
    const mh_real size = mh_real_saturate(shift <= 0 ? mantissa * ((int64_t)1 << -shift)
                                                     : (mantissa + ((int64_t)1 << (shift - 1))) >> shift);
    return bits >> 31 ? -size : size;
}

#else
typedef int mh_real_is_float; /* C99 wants a declaration */
#endif
