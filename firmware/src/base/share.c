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
    const int32_t x = small ? square + square : square >> 1; /* the sum of squares, or four of it: 1/2 to 2, in 29 */
    /* its inverse root within 9 %, and Newton's method */
    int32_t root = 1619307820 - mh_part(x, 925318756);
    for (uint8_t i = 0; i < 3; i++) {
        root = 2 * mh_part(root, ((int32_t)3 << 28) - mh_part(x, mh_part(root, root >> 1)));
    }
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
