/* Numbers of the world, and of the library. The same world in both arithmetics: what a sensor converts does not depend on mh_real. */
#ifndef MOTEHOUND_SIM_REALS_H
#define MOTEHOUND_SIM_REALS_H

#include "motehound/real.h"

#include <math.h>
#include <stdbool.h>

static inline const char *arithmetic_name(bool fixed) { return fixed ? "fixed point" : "floating point"; }

/* The nearest real; saturated. */
static inline mh_real real_of(double a)
{
#if MH_REAL_FIXED
    const double scaled = a * MH_REAL_ONE;
    return isnan(scaled) || scaled >= INT32_MAX ? MH_REAL_INFINITE
           : scaled <= -INT32_MAX               ? -MH_REAL_INFINITE
                                                : mh_real_from_bits((int32_t)lround(scaled));
#else
    return (mh_real)a;
#endif
}

static inline double number_of(mh_real a)
{
#if MH_REAL_FIXED
    return mh_finite(a) ? (double)mh_real_to_bits(a) / MH_REAL_ONE : a > 0 ? (double)INFINITY : -(double)INFINITY;
#else
    return (double)a;
#endif
}

/* To Q11.20, rounded to nearest from the float next to it, and saturated; NaN gives 0. */
static inline mh_q20 q20_of(double a)
{
    const float scaled = (float)a * 1048576.0f;
    return isnan(scaled)              ? 0
           : scaled >= 2147483520.0f  ? INT32_MAX
           : scaled <= -2147483648.0f ? INT32_MIN
                                      : (mh_q20)(scaled < 0 ? scaled - 0.5f : scaled + 0.5f);
}

static inline double number_of_q20(mh_q20 a) { return (double)((float)a * (1.0f / 1048576.0f)); }

#endif
