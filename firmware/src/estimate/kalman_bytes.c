#include "motehound/bytes.h"
#include "motehound/kalman.h"

#if MH_REAL_FIXED
#include "motehound/scaled_fixed.h"
#endif

/* Bits of an IEEE 754 binary32 that is positive are in order as it is. */
#define LEAST_PIVOT 0x179abe15u /* 1e-24 */
#define MOST_PIVOT 0x5368d4a5u  /* 1e12 */

#if MH_REAL_FIXED

#define LEAST_VARIANCE 0
#define MOST_VARIANCE MH_REAL_MAX

enum {
    MANTISSA_BITS = 23,
    TOP = 138,            /* IEEE exponent of the largest pivot as an integer of 2^27 to 2^28, taken for a real */
    LARGEST_EXPONENT = 32 /* of a filter */
};

/* A pivot is d 2^-exponent, where d is a real. */
static uint32_t scaled(uint32_t ieee, int8_t exponent) { return ieee + ((uint32_t)exponent << MANTISSA_BITS); }

static uint32_t pivot_to_ieee(const struct mh_kalman *filter, mh_real pivot)
{
    return scaled(mh_real_to_ieee(pivot), (int8_t)-filter->exponent);
}

static mh_real pivot_from_ieee(const struct mh_kalman *filter, uint32_t ieee)
{
    return mh_max(mh_real_from_ieee(scaled(ieee, filter->exponent)), mh_real_from_bits(MH_SCALED_LEAST));
}

static void choose_exponent(struct mh_kalman *filter, uint32_t largest_pivot)
{
    const int16_t exponent = (int16_t)(TOP - (int16_t)(largest_pivot >> MANTISSA_BITS));
    filter->exponent = (int8_t)(exponent < LARGEST_EXPONENT ? exponent : LARGEST_EXPONENT);
}

#else

#define LEAST_VARIANCE 1e-12f
#define MOST_VARIANCE 1e12f

static uint32_t pivot_to_ieee(const struct mh_kalman *filter, mh_real pivot)
{
    (void)filter;
    return mh_real_to_ieee(pivot);
}

static mh_real pivot_from_ieee(const struct mh_kalman *filter, uint32_t ieee)
{
    (void)filter;
    return mh_real_from_ieee(ieee);
}

static void choose_exponent(struct mh_kalman *filter, uint32_t largest_pivot)
{
    (void)filter;
    (void)largest_pivot;
}

#endif

void mh_kalman_write_factors(const struct mh_kalman *filter, uint8_t **at)
{
    const mh_real *element = filter->ud;
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        for (uint_fast8_t i = 0; i <= j; i++, element++) {
            const uint32_t ieee = i == j ? pivot_to_ieee(filter, *element) : mh_real_to_ieee(*element);
            mh_put_u16(at, (uint16_t)((ieee + 0x8000u) >> 16));
        }
    }
}

enum mh_status mh_kalman_read_factors(struct mh_kalman *filter, const uint8_t **at)
{
    uint32_t largest = 0;
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        const uint8_t *pivot = *at + 2 * MH_PACKED(j, j);
        const uint32_t ieee = (uint32_t)mh_get_u16(&pivot) << 16;
        if (ieee < LEAST_PIVOT || ieee > MOST_PIVOT) {
            return MH_ERR_CORRUPT;
        }
        largest = ieee > largest ? ieee : largest;
    }
    choose_exponent(filter, largest);
    mh_real *element = filter->ud;
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        for (uint_fast8_t i = 0; i <= j; i++, element++) {
            const uint32_t ieee = (uint32_t)mh_get_u16(at) << 16;
            *element = i == j ? pivot_from_ieee(filter, ieee) : mh_real_from_ieee(ieee);
            if (!mh_finite(*element)) {
                return MH_ERR_CORRUPT;
            }
        }
    }
    for (uint8_t i = 0; i < filter->n; i++) {
        if (!mh_within(mh_kalman_variance(filter, i), LEAST_VARIANCE, MOST_VARIANCE)) {
            return MH_ERR_CORRUPT;
        }
    }
    return MH_OK;
}
