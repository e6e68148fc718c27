#include "motehound/fusion.h"

#include "information.h"

/* An increment may take this share of what was known before: the rounding of a difference. */
#define ROUNDING 1e-3f

enum mh_status mh_fusion_increment(const struct mh_gaussian *posterior, const struct mh_gaussian *reference,
                                   struct mh_information *increment)
{
    struct mh_information difference;
    mh_real after[MH_PACKED_SIZE(MH_STATES_MAX)], moved[MH_STATES_MAX], told[MH_STATES_MAX];
    const uint8_t n = difference.n = posterior->n;
    if (reference->n != n) {
        return MH_ERR_ARGUMENT;
    }
    enum mh_status status = mh_information_of(posterior, after);
    if (status == MH_OK) {
        status = mh_information_of(reference, difference.matrix);
    }
    if (status != MH_OK) {
        return status;
    }
    mh_real sum = 0; /* finite only if all are */
    for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
        difference.matrix[i] = after[i] - difference.matrix[i];
        sum += mh_abs(difference.matrix[i]);
    }
    for (uint_fast8_t i = 0; i < n; i++) {
        moved[i] = posterior->x[i] - reference->x[i];
    }
    /* dI x_ref + I_post (x_post - x_ref) is the difference of P^-1 x without subtracting two large numbers */
    mh_symmetric_times(n, difference.matrix, reference->x, difference.vector);
    mh_symmetric_times(n, after, moved, told);
    for (uint_fast8_t i = 0; i < n; i++) {
        difference.vector[i] += told[i];
        sum += mh_abs(difference.vector[i]);
    }
    if (!mh_finite(sum)) {
        return MH_ERR_NOT_FINITE;
    }
    *increment = difference;
    return MH_OK;
}

/* Errors: MH_ERR_ARGUMENT, MH_ERR_NOT_FINITE, MH_ERR_SINGULAR (takes more than rounding away of I). */
static enum mh_status check(const struct mh_information *increment, uint8_t n, const mh_real *I)
{
    mh_real sum = 0, kept[MH_PACKED_SIZE(MH_STATES_MAX)];
    if (increment->n != n) {
        return MH_ERR_ARGUMENT;
    }
    for (uint_fast8_t i = 0; i < n; i++) {
        sum += mh_abs(increment->vector[i]);
    }
    for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
        sum += mh_abs(increment->matrix[i]);
        kept[i] = increment->matrix[i] + ROUNDING * I[i];
    }
    return mh_finite(sum) ? mh_cholesky_factor(n, kept) : MH_ERR_NOT_FINITE;
}

enum mh_status mh_fusion_add(const struct mh_gaussian *prior, const struct mh_information *increments, uint8_t count,
                             struct mh_gaussian *fused)
{
    struct mh_information_sum sum;
    mh_real I[MH_PACKED_SIZE(MH_STATES_MAX)];
    if (count > MH_FUSED_MAX) {
        return MH_ERR_ARGUMENT;
    }
    enum mh_status status = mh_information_of(prior, I);
    if (status != MH_OK) {
        return status;
    }
    const uint8_t n = prior->n;
    mh_information_begin(&sum, prior);
    mh_information_add(&sum, 1, I, prior->x);
    for (uint_fast8_t k = 0; k < count; k++) {
        const struct mh_information *increment = &increments[k];
        mh_real known[MH_STATES_MAX];
        status = check(increment, n, I);
        if (status != MH_OK) {
            return status;
        }
        mh_symmetric_times(n, increment->matrix, prior->x, known);
        for (uint_fast8_t i = 0; i < n; i++) {
            sum.vector[i] += increment->vector[i] - known[i];
        }
        for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
            sum.matrix[i] += increment->matrix[i];
        }
    }
    return mh_information_finish(&sum, fused);
}
