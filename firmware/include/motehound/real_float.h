/* mh_real as float: 24 significant bits. Included by real.h. */
#ifndef MOTEHOUND_REAL_FLOAT_H
#define MOTEHOUND_REAL_FLOAT_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

typedef float mh_real;

#define MH_REAL(constant) (constant)
#define MH_REAL_UPTO(constant) (constant)
#define MH_REAL_MIN 1.2e-38f /* positive numbers below are not normal: they lose digits, or are 0 */
#define MH_REAL_MAX 3.4e38f  /* what is larger is not finite */

static inline mh_real mh_mul(mh_real a, mh_real b) { return a * b; }
static inline mh_real mh_div(mh_real a, mh_real b) { return a / b; }
static inline mh_real mh_add(mh_real a, mh_real b) { return a + b; }

typedef mh_real mh_wide;
static inline mh_wide mh_wide_mul(mh_real a, mh_real b) { return a * b; }
static inline mh_real mh_wide_div(mh_wide a, mh_real b) { return a / b; }
static inline mh_real mh_wide_sqrt(mh_wide a) { return sqrtf(a); }
static inline mh_real mh_wide_ratio(mh_wide a, mh_wide b) { return a / b; }
static inline mh_real mh_wide_to_real(mh_wide a) { return a; }

static inline mh_real mh_abs(mh_real a) { return fabsf(a); }
static inline mh_real mh_sqrt(mh_real a) { return sqrtf(a); }
static inline mh_real mh_exp(mh_real a) { return expf(a); }
static inline mh_real mh_log(mh_real a) { return logf(a); }
static inline mh_real mh_atan2(mh_real y, mh_real x) { return atan2f(y, x); }

/* True unless a is NaN or infinite. */
static inline bool mh_finite(mh_real a) { return mh_abs(a) <= MH_REAL_MAX; }

/* Integers as reals: a, and a / b for a constant b > 0 (one multiplication). */
static inline mh_real mh_real_from_int(int32_t a) { return (mh_real)a; }
#define mh_real_from_ratio(a, b) ((mh_real)(int32_t)(a) * (1.0f / (mh_real)(b)))

/* a / b for a real and a constant integer b > 0 (one multiplication). */
#define mh_real_over(a, b) ((a) * (1.0f / (mh_real)(b)))

/* The integer a b, its fraction cut off, for a real and an integer b > 0; |a b| below 2e9. */
#define mh_real_times(a, b) ((int32_t)((a) * (mh_real)(b)))

/* The integer nearest to a; |a| below 2e9. */
static inline int32_t mh_real_round(mh_real a) { return (int32_t)(a < 0 ? a - 0.5f : a + 0.5f); }

static inline mh_real mh_real_from_float(float a) { return a; }
static inline float mh_real_to_float(mh_real a) { return a; }

/* As the bits of an IEEE 754 binary32, and back. */
static inline uint32_t mh_real_to_ieee(mh_real a)
{
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}

static inline mh_real mh_real_from_ieee(uint32_t bits)
{
    mh_real a;
    memcpy(&a, &bits, sizeof a);
    return a;
}

/* From and to Q11.20. To: rounded to nearest and saturated; NaN gives 0 (check mh_finite first where it can come in). */
static inline mh_real mh_q20_to_real(int32_t a) { return (mh_real)a * (1.0f / 1048576.0f); }

static inline int32_t mh_q20_from_real(mh_real a)
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
    return (int32_t)(scaled < 0 ? scaled - 0.5f : scaled + 0.5f);
}

#endif
