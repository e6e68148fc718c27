/* How self-tests compare. */
#ifndef SELF_TEST_PARTS_H
#define SELF_TEST_PARTS_H

#include "self_test.h"

/* Answers stay in flash: FLASH int answers[] = {...}; then flash_read(&copy, answers, sizeof copy). */
#ifdef __AVR__
#include <avr/pgmspace.h>
#define FLASH static const PROGMEM
#define flash_read memcpy_P
#else
#include <string.h>
#define FLASH static const
#define flash_read memcpy
#endif

/* Within 1e-4 of the answer and of 1, in fixed point 1e-3. */
static inline bool near(mh_real value, mh_real answer)
{
    const mh_real share = MH_REAL_FIXED ? MH_REAL(1e-3f) : MH_REAL(1e-4f);
    return mh_abs(value - answer) <= share + mh_mul(mh_abs(answer), share);
}

#endif
