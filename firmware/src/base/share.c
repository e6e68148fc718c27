#include "motehound/share.h"

#if MH_REAL_FIXED

mh_share mh_share_of(mh_real part, mh_real whole)
{
    return (mh_share)(((uint64_t)(uint32_t)part << MH_SHARE_BITS) / (uint32_t)whole);
}

/* by repeated squares */
mh_share mh_share_power(mh_share a, uint32_t n)
{
    mh_share power = MH_SHARE(1.0f);
    for (; n > 0 && power > 0; n >>= 1) {
        power = (n & 1) != 0 ? mh_share_mul(power, a) : power;
        a = mh_share_mul(a, a);
    }
    return power;
}

/* The inverse root, with 30 fractional bits, of x, 1/2 to 2 with 29. In 16 bits, which an AVR multiplies in 30 cycles: within 9 % and by Newton's method
 * twice, to 3e-4. Then the series of 1 / sqrt(1 - e) = 1 + (e + 3/4 e^2) / 2 with what is still missing, e = 1 - x root^2. Shifts by bytes: an AVR shifts bits in
 * a loop. */
static int32_t inverse_root(int32_t x)
{
    const uint16_t x15 = (uint16_t)((uint32_t)x * 4 >> 16);
    uint16_t root = (uint16_t)(49418 - ((uint32_t)x15 * 28238 >> 16)); /* 15 fractional bits */
    for (uint8_t i = 0; i < 2; i++) {
        const uint16_t square = (uint16_t)((uint32_t)root * root >> 16);
        const uint16_t product = (uint16_t)((uint32_t)x15 * square * 2 >> 16);
        root = (uint16_t)((uint32_t)root * (uint16_t)(49152u - product) * 2 >> 16);
    }
    const int32_t e = ((int32_t)1 << 28) - mh_part(x, (int32_t)((uint32_t)root * root >> 1));
    const int16_t e20 = (int16_t)(e >> 8);
    const int32_t found = (int32_t)((uint32_t)root << 16 >> 1);
    return found + 2 * mh_part(found, e + ((int32_t)e20 * (12 * e20) >> 16));
}

/* Halves by shifts: an AVR divides, even by 2, in 600 cycles. */
bool mh_turn(mh_real a, mh_real b, mh_share *c, mh_share *s)
{
    int32_t over_a = mh_abs(a), over_b = mh_abs(b);
    if ((over_a | over_b) == 0) {
        return false;
    }
    if ((over_a | over_b) >= (int32_t)1 << 30) {
        over_a >>= 1;
        over_b >>= 1;
    }
    while ((over_a | over_b) < (int32_t)1 << 29) { /* until the larger is 1/2 to 1, in 30 fractional bits */
        over_a += over_a;
        over_b += over_b;
    }
    const int32_t square = mh_turned(over_a, over_a, over_b, over_b);
    const bool small = square < (int32_t)1 << 29;
    const int32_t root = inverse_root(small ? square + square : square >> 1); /* the sum of squares, or four of it */
    over_a = mh_part(over_a, root);
    over_b = mh_part(over_b, root);
    if (small) {
        over_a += over_a;
        over_b += over_b;
    }
    *c = a < 0 ? -over_a : over_a;
    *s = b < 0 ? -over_b : over_b;
    return true;
}

mh_real mh_hypot(mh_real a, mh_real b)
{
    mh_share c, s;
    return mh_turn(a, b, &c, &s) ? mh_turned(c, a, s, b) : 0;
}

#else
typedef int mh_share_is_float; /* C99 wants a declaration */
#endif
