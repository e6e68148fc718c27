/* For tests in both arithmetics: numbers are written as for float, tolerances for each. */
#ifndef REALS_H
#define REALS_H

#include "motehound/real.h"
#include "unity.h"

#if MH_REAL_FIXED
#define FLOAT_FIXED(in_float, in_fixed) (in_fixed)
#define NOT_A_NUMBER MH_REAL_INFINITE
#define ENDLESS MH_REAL_INFINITE
#else
#define FLOAT_FIXED(in_float, in_fixed) (in_float)
#define NOT_A_NUMBER NAN
#define ENDLESS INFINITY
#endif

#define EXPECT_REAL(in_float, in_fixed, expected, actual)                                                              \
    TEST_ASSERT_FLOAT_WITHIN(FLOAT_FIXED(in_float, in_fixed), expected, mh_real_to_float(actual))

#endif
