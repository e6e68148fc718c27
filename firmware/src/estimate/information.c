#include "information.h"

enum mh_status mh_information_of(const struct mh_gaussian *gaussian, mh_real *I)
{
    struct mh_gaussian_root root;
    const enum mh_status status = mh_gaussian_factor(&root, gaussian);
    if (status != MH_OK) {
        return status;
    }
    mh_cholesky_invert(root.n, root.L);
    memcpy(I, root.L, mh_packed_size(root.n) * sizeof I[0]);
    return MH_OK;
}

void mh_symmetric_times(uint8_t n, const mh_real *A, const mh_real *a, mh_real *b)
{
    for (uint_fast8_t j = 0; j < n; j++) {
        b[j] = 0;
        for (uint_fast8_t i = 0; i < j; i++) {
            b[i] += *A * a[j];
            b[j] += *A++ * a[i];
        }
        b[j] += *A++ * a[j];
    }
}

void mh_information_begin(struct mh_information_sum *sum, const struct mh_gaussian *first)
{
    memset(sum, 0, sizeof *sum);
    sum->n = first->n;
    memcpy(sum->about, first->x, first->n * sizeof first->x[0]);
}

void mh_information_add(struct mh_information_sum *sum, mh_real weight, const mh_real *I, const mh_real *mean)
{
    const uint8_t n = sum->n;
    mh_real offset[MH_STATES_MAX] = {0}, told[MH_STATES_MAX];
    for (uint_fast8_t i = 0; i < n; i++) {
        offset[i] = weight * (mean[i] - sum->about[i]);
    }
    mh_symmetric_times(n, I, offset, told);
    for (uint_fast8_t i = 0; i < n; i++) {
        sum->vector[i] += told[i];
    }
    for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
        sum->matrix[i] += weight * I[i];
    }
}

enum mh_status mh_information_add_estimate(struct mh_information_sum *sum, mh_real weight,
                                           const struct mh_gaussian *estimate)
{
    struct mh_gaussian_root root;
    const enum mh_status status = mh_gaussian_factor(&root, estimate);
    if (status != MH_OK) {
        return status;
    }
    const uint8_t n = root.n;
    const mh_real *row = root.L; /* of M = L^-1; P^-1 = M' M */
    mh_cholesky_invert_factor(n, root.L);
    for (uint_fast8_t i = 0; i < n; i++) {
        root.x[i] -= sum->about[i];
    }
    for (uint_fast8_t k = 0; k < n; k++) {
        mh_real *matrix = sum->matrix;
        mh_real told = 0;
        for (uint_fast8_t j = 0; j <= k; j++) {
            const mh_real scaled = weight * row[j];
            told += scaled * root.x[j];
            for (uint_fast8_t i = 0; i <= j; i++) {
                *matrix++ += row[i] * scaled;
            }
        }
        for (uint_fast8_t j = 0; j <= k; j++) {
            sum->vector[j] += row[j] * told;
        }
        row += k + 1;
    }
    return MH_OK;
}

enum mh_status mh_information_finish(const struct mh_information_sum *sum, struct mh_gaussian *fused)
{
    struct mh_gaussian result;
    const uint8_t n = result.n = sum->n;
    memcpy(result.P, sum->matrix, sizeof result.P);
    const enum mh_status status = mh_cholesky_factor(n, result.P);
    if (status != MH_OK) {
        return status;
    }
    mh_cholesky_invert(n, result.P);
    mh_symmetric_times(n, result.P, sum->vector, result.x);
    for (uint_fast8_t i = 0; i < n; i++) {
        result.x[i] += sum->about[i];
    }
    return mh_information_give(&result, fused);
}

mh_real mh_smallest_cost(mh_real (*cost)(const void *context, mh_real w), const void *context)
{
    enum { STEPS = 22 }; /* 0.618^22 = 2.5e-5 */
    const mh_real golden = 0.618033989f;
    mh_real low = 0, high = 1, left = 1 - golden, right = golden;
    mh_real at_left = cost(context, left), at_right = cost(context, right);
    for (int step = 0; step < STEPS; step++) {
        if (mh_abs(at_left - at_right) <=
            1e-6f * at_left) { /* to rounding the same: the middle is as good a guess as any */
            break;
        }
        if (at_left < at_right) {
            high = right;
            right = left;
            at_right = at_left;
            left = high - golden * (high - low);
            at_left = cost(context, left);
        } else {
            low = left;
            left = right;
            at_left = at_right;
            right = low + golden * (high - low);
            at_right = cost(context, right);
        }
    }
    return 0.5f * (low + high);
}
