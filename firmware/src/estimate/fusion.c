#include "motehound/fusion.h"

#include "information.h"

enum { STEPS = 200 };

static enum mh_status check_numbers(const struct mh_gaussian *estimates, uint8_t count)
{
    if (count < 1 || count > MH_FUSED_MAX || estimates[0].n < 1 || estimates[0].n > MH_STATES_MAX) {
        return MH_ERR_ARGUMENT;
    }
    for (uint_fast8_t i = 1; i < count; i++) {
        if (estimates[i].n != estimates[0].n) {
            return MH_ERR_ARGUMENT;
        }
    }
    return MH_OK;
}

static enum mh_status check_weights(uint8_t count, const mh_real *w)
{
    mh_real sum = 0;
    bool negative = false;
    for (uint_fast8_t i = 0; i < count; i++) {
        negative = negative || !(w[i] >= 0);
        sum += w[i];
    }
    return negative || !mh_within(sum, 1 - 1e-4f, 1 + 1e-4f) ? MH_ERR_ARGUMENT : MH_OK;
}

/* w NULL: 1 each */
static enum mh_status join(const struct mh_gaussian *estimates, uint8_t count, const mh_real *w,
                           struct mh_gaussian *fused)
{
    struct mh_information_sum sum;
    mh_information_begin(&sum, estimates);
    for (uint_fast8_t i = 0; i < count; i++) {
        const enum mh_status status = mh_information_add_estimate(&sum, w ? w[i] : 1, &estimates[i]);
        if (status != MH_OK) {
            return status;
        }
    }
    return mh_information_finish(&sum, fused);
}

enum mh_status mh_fusion_intersect(const struct mh_gaussian *estimates, uint8_t count, const mh_real *w,
                                   struct mh_gaussian *fused)
{
    if (check_numbers(estimates, count) != MH_OK || check_weights(count, w) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    return join(estimates, count, w, fused);
}

enum mh_status mh_fusion_naive(const struct mh_gaussian *estimates, uint8_t count, struct mh_gaussian *fused)
{
    if (check_numbers(estimates, count) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    return join(estimates, count, NULL, fused);
}

static void normalise(uint8_t count, mh_real *w)
{
    mh_real sum = 0;
    for (uint_fast8_t i = 0; i < count; i++) {
        sum += w[i];
    }
    const mh_real scale = 1 / sum;
    for (uint_fast8_t i = 0; i < count; i++) {
        w[i] *= scale;
    }
}

enum mh_status mh_fusion_weights(const struct mh_gaussian *estimates, uint8_t count, mh_real *w)
{
    mh_real share[MH_FUSED_MAX];
    if (check_numbers(estimates, count) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    mh_real smallest = 0;
    for (uint_fast8_t i = 0; i < count; i++) {
        mh_real trace = 0;
        for (uint_fast8_t k = 0; k < estimates[i].n; k++) {
            const mh_real variance = estimates[i].P[MH_PACKED(k, k)];
            if (!mh_finite(variance)) {
                return MH_ERR_NOT_FINITE;
            }
            if (!(variance > 0)) {
                return MH_ERR_SINGULAR;
            }
            trace += variance;
        }
        if (!mh_finite(trace)) {
            return MH_ERR_NOT_FINITE;
        }
        share[i] = trace;
        smallest = i == 0 ? trace : mh_min(smallest, trace);
    }
    for (uint_fast8_t i = 0; i < count; i++) {
        share[i] = smallest / share[i];
    }
    normalise(count, share);
    memcpy(w, share, count * sizeof w[0]);
    return MH_OK;
}

/* tr(A B) of symmetric packed matrices */
static mh_real trace_of_product(uint8_t n, const mh_real *A, const mh_real *B)
{
    mh_real diagonal = 0, above = 0;
    for (uint_fast8_t j = 0; j < n; j++) {
        for (uint_fast8_t i = 0; i < j; i++) {
            above += *A++ * *B++;
        }
        diagonal += *A++ * *B++;
    }
    return diagonal + 2 * above;
}

/* B = A A, symmetric and packed */
static void square_of(uint8_t n, const mh_real *A, mh_real *B)
{
    for (int j = 0; j < n; j++) {
        for (int i = 0; i <= j; i++) {
            mh_real sum = 0;
            for (int k = 0; k < n; k++) {
                sum += A[mh_packed_index(i, k)] * A[mh_packed_index(k, j)];
            }
            *B++ = sum;
        }
    }
}

enum optimum { TRACE, DETERMINANT };

/* One step of the fixed point: weights of the estimates with this information -> better ones. */
static enum mh_status improve(uint8_t n, uint8_t count, mh_real I[][MH_PACKED_SIZE(MH_STATES_MAX)],
                              enum optimum optimum, mh_real *share, mh_real *moved)
{
    mh_real P[MH_PACKED_SIZE(MH_STATES_MAX)] = {0}, PP[MH_PACKED_SIZE(MH_STATES_MAX)];
    for (uint_fast8_t i = 0; i < count; i++) {
        for (uint_fast8_t k = 0; k < mh_packed_size(n); k++) {
            P[k] += share[i] * I[i][k];
        }
    }
    const enum mh_status status = mh_cholesky_factor(n, P);
    if (status != MH_OK) {
        return status;
    }
    mh_cholesky_invert(n, P);
    if (optimum == TRACE) {
        square_of(n, P, PP);
    }
    mh_real next[MH_FUSED_MAX], sum = 0;
    for (uint_fast8_t i = 0; i < count; i++) {
        next[i] = share[i] * (optimum == TRACE ? mh_sqrt(trace_of_product(n, PP, I[i])) : trace_of_product(n, P, I[i]));
        sum += next[i];
    }
    if (!mh_finite(sum) || !(sum > 0)) {
        return MH_ERR_NOT_FINITE;
    }
    normalise(count, next);
    *moved = 0;
    for (uint_fast8_t i = 0; i < count; i++) {
        *moved = mh_max(*moved, mh_abs(next[i] - share[i]));
        share[i] = next[i];
    }
    return MH_OK;
}

static enum mh_status optimise(const struct mh_gaussian *estimates, uint8_t count, enum optimum optimum, mh_real *w)
{
    if (check_numbers(estimates, count) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    mh_real I[MH_FUSED_MAX][MH_PACKED_SIZE(MH_STATES_MAX)];
    mh_real share[MH_FUSED_MAX];
    for (uint_fast8_t i = 0; i < count; i++) {
        const enum mh_status status = mh_information_of(&estimates[i], I[i]);
        if (status != MH_OK) {
            return status;
        }
        share[i] = 1 / (mh_real)count;
    }
    mh_real moved = 1;
    for (int step = 0; step < STEPS && moved > 1e-6f; step++) {
        const enum mh_status status = improve(estimates[0].n, count, I, optimum, share, &moved);
        if (status != MH_OK) {
            return status;
        }
    }
    memcpy(w, share, count * sizeof w[0]);
    return MH_OK;
}

enum mh_status mh_fusion_weights_trace(const struct mh_gaussian *estimates, uint8_t count, mh_real *w)
{
    return optimise(estimates, count, TRACE, w);
}

enum mh_status mh_fusion_weights_determinant(const struct mh_gaussian *estimates, uint8_t count, mh_real *w)
{
    return optimise(estimates, count, DETERMINANT, w);
}
