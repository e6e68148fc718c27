#include "motehound/fusion.h"

#include "kalman_parts.h"
#include "motehound/scaled_fixed.h"

#include <string.h>

#if MH_REAL_FIXED

/* P^-1 = sum w_i P_i^-1 without an inverse: one estimate is the prior, with P_i / w_i, and every other is a measurement of all states with its P_i / w_i.
 * With P_i = U D U' these are the scalars U^-1 x_i of independent noises D / w_i, which the Kalman filter takes one by one. */

static const mh_real least_weight = MH_REAL_ONE >> 14;

static enum mh_status check_numbers(const struct mh_gaussian *estimates, uint8_t count)
{
    if (count < 1 || count > MH_FUSED_MAX || estimates[0].n < 1 || estimates[0].n > MH_KALMAN_MOVING_MAX) {
        return MH_ERR_ARGUMENT;
    }
    for (uint_fast8_t i = 1; i < count; i++) {
        if (estimates[i].n != estimates[0].n) {
            return MH_ERR_ARGUMENT;
        }
    }
    return MH_OK;
}

/* The estimate's say: each row of U^-1 a measurement. `factors`: of the estimate. */
static enum mh_status tell(struct mh_kalman *filter, const struct mh_kalman *factors, mh_real ratio)
{
    const uint8_t n = filter->n, down = mh_digits((uint32_t)ratio);
    const int8_t up = (int8_t)(down - MH_REAL_BITS - factors->exponent);
    for (uint_fast8_t k = 0; k < n; k++) {
        mh_real h[MH_KALMAN_STATES_MAX] = {0}, innovation = 0;
        h[k] = MH_REAL_ONE;
        for (uint_fast8_t j = k; j < n; j++) {
            const mh_real *column = factors->ud + MH_PACKED(0, j);
            for (uint_fast8_t m = k; m < j; m++) {
                if (h[m] != 0 && column[m] != 0) {
                    h[j] = mh_add(h[j], -mh_mul(h[m], column[m]));
                }
            }
            innovation = mh_add(innovation, mh_mul(h[j], mh_add(factors->x[j], -filter->x[j])));
        }
        const int32_t variance = mh_product(factors->ud[MH_PACKED(k, k)], ratio, (int8_t)down);
        const enum mh_status status = mh_kalman_update_scaled(filter, h, innovation, variance, up);
        if (status != MH_OK) {
            return status;
        }
    }
    return MH_OK;
}

/* w NULL: 1 each */
static enum mh_status join(const struct mh_gaussian *estimates, uint8_t count, const mh_real *w,
                           struct mh_gaussian *fused)
{
    const uint8_t n = estimates[0].n;
    uint_fast8_t first = 0;
    for (uint_fast8_t i = 1; i < count; i++) {
        first = w && w[i] > w[first] ? i : first;
    }
    struct mh_kalman filter, factors;
    enum mh_status status = mh_kalman_init(&filter, n, estimates[first].x, estimates[first].P);
    if (status != MH_OK) {
        return status;
    }
    if (w) {
        const mh_real ratio = mh_div(MH_REAL_ONE, w[first]);
        const uint8_t down = mh_digits((uint32_t)ratio);
        for (uint_fast8_t j = 0; j < n; j++) {
            filter.ud[MH_PACKED(j, j)] = mh_product(filter.ud[MH_PACKED(j, j)], ratio, (int8_t)down);
        }
        filter.exponent = (int8_t)(filter.exponent + MH_REAL_BITS - down);
    }
    for (uint_fast8_t i = 0; i < count; i++) {
        if (i == first) {
            continue;
        }
        status = mh_kalman_init(&factors, n, estimates[i].x, estimates[i].P);
        if (status == MH_OK && (!w || w[i] >= least_weight)) {
            status = tell(&filter, &factors, w ? mh_div(MH_REAL_ONE, w[i]) : MH_REAL_ONE);
        }
        if (status != MH_OK) {
            return status;
        }
    }
    struct mh_gaussian result;
    result.n = n;
    memcpy(result.x, filter.x, n * sizeof result.x[0]);
    mh_kalman_covariance(&filter, result.P);
    /* What the rounding of U, of 1 part in 3,000 at worst, and of these elements may take from a direction is given back: the result is not bolder than
     * what it comes from. */
    for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
        result.P[i] = mh_add(result.P[i], result.P[i] / 1024);
    }
    for (uint_fast8_t j = 0; j < n; j++) {
        result.P[MH_PACKED(j, j)] = mh_add(result.P[MH_PACKED(j, j)], n);
    }
    status = mh_gaussian_check(&result);
    if (status == MH_OK) {
        *fused = result;
    }
    return status;
}

enum mh_status mh_fusion_intersect(const struct mh_gaussian *estimates, uint8_t count, const mh_real *w,
                                   struct mh_gaussian *fused)
{
    mh_real sum = 0;
    if (check_numbers(estimates, count) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    for (uint_fast8_t i = 0; i < count; i++) {
        if (!mh_within(w[i], 0, 2 * MH_REAL_ONE)) {
            return MH_ERR_ARGUMENT;
        }
        sum += w[i];
    }
    if (!mh_within(sum, MH_REAL(0.9999f), MH_REAL(1.0001f))) {
        return MH_ERR_ARGUMENT;
    }
    return join(estimates, count, w, fused);
}

enum mh_status mh_fusion_naive(const struct mh_gaussian *estimates, uint8_t count, struct mh_gaussian *fused)
{
    return check_numbers(estimates, count) == MH_OK ? join(estimates, count, NULL, fused) : MH_ERR_ARGUMENT;
}

enum mh_status mh_fusion_weights(const struct mh_gaussian *estimates, uint8_t count, mh_real *w)
{
    mh_real share[MH_FUSED_MAX], smallest = MH_REAL_INFINITE, sum = 0;
    uint_fast8_t surest = 0;
    if (check_numbers(estimates, count) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    for (uint_fast8_t i = 0; i < count; i++) {
        share[i] = 0;
        for (uint_fast8_t k = 0; k < estimates[i].n; k++) {
            const mh_real variance = estimates[i].P[MH_PACKED(k, k)];
            if (mh_finite(variance) && variance <= 0) {
                return MH_ERR_SINGULAR;
            }
            share[i] = mh_add(share[i], variance);
        }
        if (!mh_finite(share[i])) {
            return MH_ERR_NOT_FINITE;
        }
        surest = share[i] < smallest ? i : surest;
        smallest = mh_min(smallest, share[i]);
    }
    for (uint_fast8_t i = 0; i < count; i++) {
        share[i] = mh_div(smallest, share[i]);
        sum += share[i];
    }
    mh_real rest = MH_REAL_ONE;
    for (uint_fast8_t i = 0; i < count; i++) {
        w[i] = mh_div(share[i], sum);
        rest -= w[i];
    }
    w[surest] += rest;
    return MH_OK;
}

/* What needs more than 31 bits for its matrices. */

enum mh_status mh_fusion_weights_trace(const struct mh_gaussian *estimates, uint8_t count, mh_real *w)
{
    (void)estimates, (void)count, (void)w;
    return MH_ERR_ARGUMENT;
}

enum mh_status mh_fusion_weights_determinant(const struct mh_gaussian *estimates, uint8_t count, mh_real *w)
{
    (void)estimates, (void)count, (void)w;
    return MH_ERR_ARGUMENT;
}

enum mh_status mh_split_check(const struct mh_split_gaussian *estimate)
{
    (void)estimate;
    return MH_ERR_ARGUMENT;
}

enum mh_status mh_fusion_split(const struct mh_split_gaussian *a, const struct mh_split_gaussian *b,
                               struct mh_split_gaussian *fused)
{
    (void)a, (void)b, (void)fused;
    return MH_ERR_ARGUMENT;
}

enum mh_status mh_fusion_inverse(const struct mh_gaussian *a, const struct mh_gaussian *b, struct mh_gaussian *fused)
{
    (void)a, (void)b, (void)fused;
    return MH_ERR_ARGUMENT;
}

enum mh_status mh_fusion_ellipsoidal(const struct mh_gaussian *a, const struct mh_gaussian *b,
                                     struct mh_gaussian *fused)
{
    (void)a, (void)b, (void)fused;
    return MH_ERR_ARGUMENT;
}

enum mh_status mh_fusion_increment(const struct mh_gaussian *posterior, const struct mh_gaussian *reference,
                                   struct mh_information *increment)
{
    (void)posterior, (void)reference, (void)increment;
    return MH_ERR_ARGUMENT;
}

enum mh_status mh_fusion_add(const struct mh_gaussian *prior, const struct mh_information *increments, uint8_t count,
                             struct mh_gaussian *fused)
{
    (void)prior, (void)increments, (void)count, (void)fused;
    return MH_ERR_ARGUMENT;
}

#else
typedef int mh_fusion_is_float; /* C99 wants a declaration */
#endif
