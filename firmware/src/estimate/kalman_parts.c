#include "kalman_parts.h"

enum mh_status mh_kalman_append(struct mh_kalman *filter, mh_real mean, mh_real variance)
{
    const uint8_t n = filter->n;
    if (n >= MH_KALMAN_STATES_MAX) {
        return MH_ERR_CAPACITY;
    }
    if (!mh_finite(mean) || !mh_finite(variance)) {
        return MH_ERR_NOT_FINITE;
    }
    if (variance < MH_REAL_MIN) {
        return MH_ERR_SINGULAR;
    }
    mh_real *column = filter->ud + MH_PACKED(0, n);
    for (uint_fast8_t i = 0; i < n; i++) {
        column[i] = 0;
    }
    column[n] = mh_kalman_variance_for(filter, variance);
    filter->x[n] = mean;
    filter->n++;
    return MH_OK;
}

enum mh_status mh_kalman_move_ties(struct mh_kalman *next, const struct mh_kalman *filter, const mh_real *F)
{
    const uint8_t n = filter->moving;
    for (uint_fast8_t j = 0; j < n; j++) {
        for (uint_fast8_t k = n; k < filter->n; k++) {
            const mh_real *column = filter->ud + MH_PACKED(0, k);
            mh_real sum = 0;
            for (uint_fast8_t m = 0; m < n; m++) {
                sum = mh_add(sum, mh_mul(F[m], column[m]));
            }
            if (!mh_finite(sum)) {
                return MH_ERR_NOT_FINITE;
            }
            next->ud[MH_PACKED(j, k)] = sum;
        }
        F += n;
    }
    return MH_OK;
}

void mh_kalman_covariance_of(const struct mh_kalman *filter, uint8_t count, mh_real *P)
{
    for (uint_fast8_t j = 0; j < count; j++) {
        for (uint_fast8_t i = 0; i <= j; i++) {
            *P++ = mh_kalman_element(filter, i, j);
        }
    }
}

mh_real mh_kalman_variance(const struct mh_kalman *filter, uint8_t i) { return mh_kalman_element(filter, i, i); }
