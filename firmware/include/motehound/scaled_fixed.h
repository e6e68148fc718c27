/* Integers with an exponent of their own, for what mh_real has too few digits or too small a range: variances and their divisors. Only in fixed point. */
#ifndef SCALED_FIXED_H
#define SCALED_FIXED_H

#include "motehound/config.h"
#include "motehound/matrix.h"
#include "motehound/real.h"
#include "motehound/status.h"

#if MH_REAL_FIXED

enum {
    MH_SCALED_TOP =
        28, /* the largest variance is below 2^28, and if it can be at least 2^27: what is over of 31 bits is for sums */
    MH_SCALED_LEAST = 64, /* 2^-22 of the largest: what is smaller counts as that */
    MH_SCALED_STATES_MAX = MH_STATES_MAX > MH_KALMAN_MOVING_MAX ? MH_STATES_MAX : MH_KALMAN_MOVING_MAX
};

/* Binary digits of a: 0 for 0. */
uint8_t mh_digits(uint32_t a);

/* a 2^shift, rounded, saturated. */
int32_t mh_scaled(int32_t a, int8_t shift);

/* a b / 2^shift, where it is known to fit. */
int32_t mh_product(int32_t a, int32_t b, int8_t shift);

/* 1 / a = mantissa / 2^(30 + exponent), a >= 1, with a relative error of 2^-27. */
struct mh_reciprocal {
    int32_t mantissa; /* 2^29 to 2^30 */
    uint8_t exponent; /* 2^exponent <= a */
};
struct mh_reciprocal mh_reciprocal(int32_t a);

/* P := U D U' (U unit upper triangular, Q15.16; D in P's unit), packed, last column first. Elements of P at most 2^30. A pivot below 2^-21 of its variance or
 * MH_SCALED_LEAST is an error, or with `raise` it is raised to that. Errors: MH_ERR_SINGULAR (such a pivot), MH_ERR_RANGE (U overflows); P is then half overwritten. */
enum mh_status mh_ud_factor(uint8_t n, mh_real *P, bool raise);

#endif
#endif
