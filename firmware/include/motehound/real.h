/* The scalar of the cluster head, and its few mathematical functions.
 *
 * mh_real is float: 24 significant bits, no double behind it on any target. Quantities keep their digits because
 * positions are relative to an origin near the work (see geometry.h). */
#ifndef MOTEHOUND_REAL_H
#define MOTEHOUND_REAL_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

typedef float mh_real;

#define MH_PI 3.14159265f
#define MH_REAL_MIN 1.2e-38f /* positive numbers below are not normal: they lose digits, or are 0 */

static inline mh_real mh_abs(mh_real a) { return fabsf(a); }
static inline mh_real mh_sqrt(mh_real a) { return sqrtf(a); }
static inline mh_real mh_exp(mh_real a) { return expf(a); }
static inline mh_real mh_log(mh_real a) { return logf(a); }
static inline mh_real mh_atan2(mh_real y, mh_real x) { return atan2f(y, x); }
static inline mh_real mh_min(mh_real a, mh_real b) { return a < b ? a : b; }
static inline mh_real mh_max(mh_real a, mh_real b) { return a > b ? a : b; }
static inline mh_real mh_clamp(mh_real a, mh_real low, mh_real high) { return mh_min(mh_max(a, low), high); }

static inline mh_real mh_squared(mh_real a) { return a * a; }

/* True if low <= a <= high; false for NaN. */
static inline bool mh_within(mh_real a, mh_real low, mh_real high) { return a >= low && a <= high; }

/* True unless a is NaN or infinite. */
static inline bool mh_finite(mh_real a) { return mh_abs(a) <= 3.4e38f; }

/* The integer quantity of a sensor node: signed, 20 fractional bits (Q11.20), in the unit of the sensor. Range
 * -2048 to 2047.999999, resolution 9.5e-7. Exact in mh_real up to 24 significant bits. */
typedef int32_t mh_q20;

#define MH_Q20_ONE ((mh_q20)1 << 20)
#define MH_Q20(constant) ((mh_q20)((constant)*1048576.0f)) /* for literals: folded by the compiler */

static inline mh_real mh_q20_to_real(mh_q20 a) { return (mh_real)a * (1.0f / 1048576.0f); }

/* a as Q11.20, rounded to nearest and saturated; NaN gives 0 (check mh_finite first where it can come in). */
static inline mh_q20 mh_q20_from_real(mh_real a)
{
    mh_real scaled = a * 1048576.0f;
    if (!(scaled == scaled)) {
        return 0;
    }
    if (scaled >= 2147483520.0f) {
        return INT32_MAX;
    }
    if (scaled <= -2147483648.0f) {
        return INT32_MIN;
    }
    return (mh_q20)(scaled < 0 ? scaled - 0.5f : scaled + 0.5f);
}

#endif
