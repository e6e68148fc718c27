/* Estimates as sums of information. */
#ifndef INFORMATION_H
#define INFORMATION_H

#include "motehound/gaussian.h"

#include <string.h>

/* Of estimates as offsets from a first one's mean, so that a large mean costs no digits. */
struct mh_information_sum {
    uint8_t n;
    mh_real about[MH_STATES_MAX];
    mh_real vector[MH_STATES_MAX];
    mh_real matrix[MH_PACKED_SIZE(MH_STATES_MAX)];
};

/* I = P^-1. Errors: as mh_gaussian_check. */
enum mh_status mh_information_of(const struct mh_gaussian *gaussian, mh_real *I);

/* b = A a, A symmetric and packed. */
void mh_symmetric_times(uint8_t n, const mh_real *A, const mh_real *a, mh_real *b);

void mh_information_begin(struct mh_information_sum *sum, const struct mh_gaussian *first);

/* Add weight times the information I about an estimate with this mean. */
void mh_information_add(struct mh_information_sum *sum, mh_real weight, const mh_real *I, const mh_real *mean);

/* Add weight times an estimate's information. Errors: as mh_gaussian_check; the sum is as it was. */
enum mh_status mh_information_add_estimate(struct mh_information_sum *sum, mh_real weight,
                                           const struct mh_gaussian *estimate);

/* The estimate of all that was added -> *fused. Errors: MH_ERR_NOT_FINITE, MH_ERR_SINGULAR. */
enum mh_status mh_information_finish(const struct mh_information_sum *sum, struct mh_gaussian *fused);

/* *fused = the estimate, with pivots that rounding has swallowed raised (mh_gaussian_settle). */
static inline enum mh_status mh_information_give(struct mh_gaussian *estimate, struct mh_gaussian *fused)
{
    const enum mh_status status = mh_gaussian_settle(estimate);
    if (status == MH_OK) {
        *fused = *estimate;
    }
    return status;
}

/* The w in 0 to 1 at which a convex `cost` > 0 is smallest, by golden section: to 2e-5, or until the cost does not tell any more. INFINITY is larger than any. */
mh_real mh_smallest_cost(mh_real (*cost)(const void *context, mh_real w), const void *context);

#endif
