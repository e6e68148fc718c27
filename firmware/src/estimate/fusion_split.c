#include "motehound/fusion.h"

#include "information.h"

/* The weight stays this far from 0 and 1, where a covariance without a bound would be needed. */
#define MARGIN 1e-4f
/* What a semidefinite covariance may lack to rounding, as a share of the whole one. */
#define ROUNDING 1e-5f

/* sum = a + weight * b, packed */
static void add_scaled(uint8_t n, const mh_real *a, mh_real weight, const mh_real *b, mh_real *sum)
{
    for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
        sum[i] = a[i] + weight * b[i];
    }
}

static enum mh_status check_semidefinite(uint8_t n, const mh_real *part, const mh_real *whole)
{
    mh_real raised[MH_PACKED_SIZE(MH_STATES_MAX)];
    add_scaled(n, part, ROUNDING, whole, raised);
    return mh_cholesky_factor(n, raised);
}

enum mh_status mh_split_check(const struct mh_split_gaussian *estimate)
{
    struct mh_gaussian whole = estimate->dependent;
    if (whole.n < 1 || whole.n > MH_STATES_MAX) {
        return MH_ERR_ARGUMENT;
    }
    add_scaled(whole.n, estimate->dependent.P, 1, estimate->independent, whole.P);
    enum mh_status status = mh_gaussian_check(&whole);
    if (status == MH_OK) {
        status = check_semidefinite(whole.n, estimate->dependent.P, whole.P);
    }
    if (status == MH_OK) {
        status = check_semidefinite(whole.n, estimate->independent, whole.P);
    }
    return status;
}

/* I = (Pd / w + Pi)^-1 = w (Pd + w Pi)^-1 */
static enum mh_status split_information(const struct mh_split_gaussian *estimate, mh_real w, mh_real *I)
{
    const uint8_t n = estimate->dependent.n;
    add_scaled(n, estimate->dependent.P, w, estimate->independent, I);
    const enum mh_status status = mh_cholesky_factor(n, I);
    if (status == MH_OK) {
        mh_cholesky_invert(n, I);
        for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
            I[i] *= w;
        }
    }
    return status;
}

struct pair {
    const struct mh_split_gaussian *a, *b;
};

static mh_real weight_of(mh_real w) { return MARGIN + (1 - 2 * MARGIN) * w; }

static mh_real split_trace(const void *context, mh_real w)
{
    const struct pair *pair = context;
    const uint8_t n = pair->a->dependent.n;
    mh_real of_a[MH_PACKED_SIZE(MH_STATES_MAX)], P[MH_PACKED_SIZE(MH_STATES_MAX)];
    mh_real trace = 0;
    if (split_information(pair->a, weight_of(w), of_a) != MH_OK ||
        split_information(pair->b, weight_of(1 - w), P) != MH_OK) {
        return INFINITY;
    }
    add_scaled(n, of_a, 1, P, P);
    if (mh_cholesky_factor(n, P) != MH_OK) {
        return INFINITY;
    }
    mh_cholesky_invert(n, P);
    for (uint_fast8_t i = 0; i < n; i++) {
        trace += P[MH_PACKED(i, i)];
    }
    return trace;
}

/* Pi += K Pai K', K = P I: what comes of an independent part. */
static void add_part(uint8_t n, const mh_real *P, const mh_real *I, mh_real weight, const mh_real *part, mh_real *sum)
{
    mh_real K[MH_STATES_MAX][MH_STATES_MAX], moved[MH_STATES_MAX];
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            K[j][i] = 0;
            for (int k = 0; k < n; k++) {
                K[j][i] += P[mh_packed_index(j, k)] * I[mh_packed_index(k, i)];
            }
        }
        mh_symmetric_times(n, part, K[j], moved);
        for (int i = 0; i <= j; i++) {
            for (int k = 0; k < n; k++) {
                *sum += weight * K[i][k] * moved[k];
            }
            sum++;
        }
    }
}

static enum mh_status add_up(const struct pair *pair, const mh_real *of_a, const mh_real *of_b,
                             struct mh_gaussian *whole)
{
    struct mh_information_sum sum;
    mh_information_begin(&sum, &pair->a->dependent);
    mh_information_add(&sum, 1, of_a, pair->a->dependent.x);
    mh_information_add(&sum, 1, of_b, pair->b->dependent.x);
    return mh_information_finish(&sum, whole);
}

/* Both parts as sums of products: Pd = P - Pi, as P = P (Pa^-1 + Pb^-1) P. */
static enum mh_status part(const struct pair *pair, mh_real w, const mh_real *of_a, const mh_real *of_b,
                           const struct mh_gaussian *whole, struct mh_split_gaussian *fused)
{
    const struct mh_split_gaussian *a = pair->a, *b = pair->b;
    const uint8_t n = whole->n;
    struct mh_split_gaussian result;
    memset(&result, 0, sizeof result);
    result.dependent.n = n;
    memcpy(result.dependent.x, whole->x, sizeof whole->x);
    add_part(n, whole->P, of_a, 1, a->independent, result.independent);
    add_part(n, whole->P, of_b, 1, b->independent, result.independent);
    add_part(n, whole->P, of_a, 1 / weight_of(w), a->dependent.P, result.dependent.P);
    add_part(n, whole->P, of_b, 1 / weight_of(1 - w), b->dependent.P, result.dependent.P);
    const enum mh_status status = mh_split_check(&result);
    if (status == MH_OK) {
        *fused = result;
    }
    return status;
}

static enum mh_status join_at(const struct pair *pair, mh_real w, struct mh_split_gaussian *fused)
{
    mh_real of_a[MH_PACKED_SIZE(MH_STATES_MAX)], of_b[MH_PACKED_SIZE(MH_STATES_MAX)];
    if (split_information(pair->a, weight_of(w), of_a) != MH_OK ||
        split_information(pair->b, weight_of(1 - w), of_b) != MH_OK) {
        return MH_ERR_SINGULAR;
    }
    struct mh_gaussian whole;
    const enum mh_status status = add_up(pair, of_a, of_b, &whole);
    return status == MH_OK ? part(pair, w, of_a, of_b, &whole, fused) : status;
}

enum mh_status mh_fusion_split(const struct mh_split_gaussian *a, const struct mh_split_gaussian *b,
                               struct mh_split_gaussian *fused)
{
    const struct pair pair = {a, b};
    if (b->dependent.n != a->dependent.n) {
        return MH_ERR_ARGUMENT;
    }
    enum mh_status status = mh_split_check(a);
    if (status == MH_OK) {
        status = mh_split_check(b);
    }
    return status == MH_OK ? join_at(&pair, mh_smallest_cost(split_trace, &pair), fused) : status;
}
