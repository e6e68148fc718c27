#include "motehound/gaussian.h"

#if MH_REAL_FIXED

#include "motehound/scaled_fixed.h"

enum mh_status mh_gaussian_check(const struct mh_gaussian *gaussian)
{
    const uint8_t n = gaussian->n;
    if (n < 1 || n > MH_STATES_MAX) {
        return MH_ERR_ARGUMENT;
    }
    mh_real P[MH_PACKED_SIZE(MH_STATES_MAX)], largest = 0, across = 0;
    const mh_real *element = gaussian->P;
    for (uint_fast8_t j = 0; j < n; j++) {
        for (uint_fast8_t i = 0; i <= j; i++) {
            if (!mh_finite(*element) || !mh_finite(gaussian->x[j])) {
                return MH_ERR_NOT_FINITE;
            }
            across = mh_max(across, mh_abs(*element++));
        }
        const mh_real variance = gaussian->P[MH_PACKED(j, j)];
        if (variance <= 0) {
            return MH_ERR_SINGULAR;
        }
        largest = mh_max(largest, variance);
    }
    if (across > largest) {
        return MH_ERR_SINGULAR;
    }
    const int8_t up = (int8_t)(MH_SCALED_TOP - mh_digits((uint32_t)largest));
    for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
        P[i] = mh_scaled(gaussian->P[i], up);
    }
    for (uint_fast8_t j = 0; j < n; j++) {
        if (P[MH_PACKED(j, j)] < MH_SCALED_LEAST) {
            return MH_ERR_RANGE;
        }
    }
    return mh_ud_factor(n, P, false);
}

#else
typedef int mh_gaussian_is_float; /* C99 wants a declaration */
#endif
