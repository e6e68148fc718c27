/* The scalar of the cluster head, and its few mathematical functions.
 *
 * mh_real is float, or with MH_REAL_FIXED a 32-bit fixed-point number (real_float.h, real_fixed.h: range, resolution and rounding). What is
 * written in the words below works with both: +, - and comparisons are the language's own, a real times or divided by an integer too, but
 *
 *     MH_REAL(0.5f)    a constant, folded by the compiler (MH_REAL_UPTO: or the largest real, if that is less)
 *     mh_mul, mh_div   product and quotient of two reals
 *     mh_add           a sum, where it may be too large (fixed point saturates, + does not)
 *     mh_wide          a product of two reals, or the sum of two of these, where it may be too large for a real: a squared length. To be compared, or made
 *                      a real again: mh_wide_mul, mh_wide_div (by a real), mh_wide_ratio (by another), mh_wide_sqrt, mh_wide_to_real
 *
 * No double stands behind either on any target. Quantities keep their digits because positions are relative to an origin near the work (see
 * geometry.h). */
#ifndef MOTEHOUND_REAL_H
#define MOTEHOUND_REAL_H

#include <stdbool.h>
#include <stdint.h>

#ifndef MH_REAL_FIXED
#define MH_REAL_FIXED 0
#endif

#if MH_REAL_FIXED
#include "motehound/real_fixed.h"
#else
#include "motehound/real_float.h"
#endif

#define MH_PI MH_REAL(3.14159265f)

static inline mh_real mh_min(mh_real a, mh_real b) { return a < b ? a : b; }
static inline mh_real mh_max(mh_real a, mh_real b) { return a > b ? a : b; }
static inline mh_real mh_clamp(mh_real a, mh_real low, mh_real high) { return mh_min(mh_max(a, low), high); }

static inline mh_real mh_squared(mh_real a) { return mh_mul(a, a); }

/* True if low <= a <= high; false for NaN. */
static inline bool mh_within(mh_real a, mh_real low, mh_real high) { return a >= low && a <= high; }

/* The integer quantity of a sensor node: signed, 20 fractional bits (Q11.20), in the unit of the sensor. Range
 * -2048 to 2047.999999, resolution 9.5e-7. Exact in a float mh_real up to 24 significant bits. */
typedef int32_t mh_q20;

#define MH_Q20_ONE ((mh_q20)1 << 20)
#define MH_Q20(constant) ((mh_q20)((constant)*1048576.0f)) /* for literals: folded by the compiler */

#endif
