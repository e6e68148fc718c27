#include "motehound/scaled_fixed.h"

#if MH_REAL_FIXED

uint8_t mh_digits(uint32_t a)
{
    uint8_t count = 0;
    if (a >> 16) {
        a >>= 16;
        count = 16;
    }
    if (a >> 8) {
        a >>= 8;
        count = (uint8_t)(count + 8);
    }
    if (a >> 4) {
        a >>= 4;
        count = (uint8_t)(count + 4);
    }
    static const uint8_t of_four[] = {0, 1, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4};
    return (uint8_t)(count + of_four[a]);
}

/* a / 2^15, rounded down: an AVR shifts bytes at once, bits in a loop. */
#ifdef __AVR__
static inline int32_t without_15_bits(int32_t a) { return (a >> 16) * 2 + ((uint16_t)a >> 15); }
#else
static inline int32_t without_15_bits(int32_t a) { return a >> 15; }
#endif

/* A straight line, two steps of Newton in 16 bits, and one in 32, in which all but the last 32 bits of 2^45 - a x are known to be 0. */
struct mh_reciprocal mh_reciprocal(int32_t a)
{
    const uint8_t exponent = (uint8_t)(mh_digits((uint32_t)a) - 1);
    const uint32_t normal = (uint32_t)a << (30 - exponent);
    const int32_t short_of = without_15_bits((int32_t)normal); /* 1 to 2, with 15 fractional bits, like x */
    int32_t x = 46261 - without_15_bits(15420 * short_of);
    for (uint8_t step = 0; step < 2; step++) {
        const int32_t error = 32768 - without_15_bits(short_of * x + 16384);
        x += without_15_bits(x * error + 16384);
    }
    const int32_t rest = (int32_t)(0 - normal * (uint32_t)x);
    return (struct mh_reciprocal){x * 32768 + without_15_bits(x * without_15_bits(rest)), exponent};
}

int32_t mh_scaled(int32_t a, int8_t shift)
{
    if (shift < -31 || a == 0) {
        return 0;
    }
    if (shift < 0) {
        const int32_t half = a >> (-shift - 1);
        return (half >> 1) + (half & 1);
    }
    if (shift > 30 || mh_abs(a) > MH_REAL_MAX >> shift) {
        return a < 0 ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    return (int32_t)((uint32_t)a << shift);
}

int32_t mh_product(int32_t a, int32_t b, int8_t shift)
{
    return shift >= 0 ? shift > 62 ? 0 : mh_mul_shift(a, b, (uint8_t)shift)
                      : mh_scaled(mh_mul_shift(a, b, 0), (int8_t)-shift);
}

/* What U loses in rounding is given back to the elements before it: P_ik = u_i D u_k + u_i r_k + r_i u_k. */
enum mh_status mh_ud_factor(uint8_t n, mh_real *P, bool raise)
{
    mh_real floor[MH_SCALED_STATES_MAX];
    const mh_real *variance = P;
    for (uint_fast8_t j = 0; j < n; j++) {
        floor[j] = mh_max(*variance >> 21, MH_SCALED_LEAST);
        variance += j + 2;
    }
    mh_real *column = P + MH_PACKED_SIZE(n);
    for (uint_fast8_t j = n; j-- > 0;) {
        mh_real u[MH_SCALED_STATES_MAX];
        column -= j + 1;
        if (column[j] < floor[j]) {
            if (!raise) {
                return MH_ERR_SINGULAR;
            }
            column[j] = floor[j];
        }
        if (j == 0) {
            break;
        }
        const struct mh_reciprocal inverse = mh_reciprocal(column[j]);
        mh_real *other = P;
        for (uint_fast8_t k = 0; k < j; k++) {
            u[k] = 0;
            if (column[k] == 0) {
                other += k + 1;
                continue;
            }
            u[k] = mh_mul_shift(column[k], inverse.mantissa, (uint8_t)(inverse.exponent + 30 - MH_REAL_BITS));
            if (!mh_finite(u[k])) {
                return MH_ERR_RANGE;
            }
            const mh_real rest = column[k] - mh_mul(u[k], column[j]);
            for (uint_fast8_t i = 0; i <= k; i++) {
                if (u[i] != 0) {
                    *other = mh_add(*other, -mh_add(mh_mul(u[k], column[i]), mh_mul(rest, u[i])));
                    if (!mh_finite(*other)) {
                        return MH_ERR_SINGULAR;
                    }
                }
                other++;
            }
        }
        for (uint_fast8_t k = 0; k < j; k++) {
            column[k] = u[k];
        }
    }
    return MH_OK;
}

#else
typedef int mh_scaled_is_float; /* C99 wants a declaration */
#endif
