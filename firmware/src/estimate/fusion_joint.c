/* Rules that are simple in the basis in which both covariances are diagonal: Pa = T T', Pb = T diag(d) T'. */
#include "motehound/fusion.h"

#include "information.h"

enum { SWEEPS = 20 };

struct joint {
    uint8_t n;
    mh_real d[MH_STATES_MAX];                /* b's variance where a's is 1 */
    mh_real T[MH_STATES_MAX][MH_STATES_MAX]; /* [k]: basis vector k, ... */
    mh_real length[MH_STATES_MAX];           /* ... the square of its length */
    mh_real y[MH_STATES_MAX];                /* b's mean less a's in this basis */
};

static mh_real dot(uint8_t n, const mh_real *a, const mh_real *b)
{
    mh_real sum = 0;
    for (uint_fast8_t i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* Turn a and b in their plane until they are orthogonal. Returns the cosine between them before. */
static mh_real turn(uint8_t n, mh_real *a, mh_real *b)
{
    const mh_real aa = dot(n, a, a), bb = dot(n, b, b), ab = dot(n, a, b);
    const mh_real cosine = mh_abs(ab) / (mh_sqrt(aa) * mh_sqrt(bb));
    if (ab == 0) {
        return 0;
    }
    const mh_real zeta = (bb - aa) / (2 * ab);
    const mh_real tangent = (zeta < 0 ? -1 : 1) / (mh_abs(zeta) + mh_sqrt(1 + zeta * zeta));
    const mh_real c = 1 / mh_sqrt(1 + tangent * tangent), s = c * tangent;
    for (uint_fast8_t i = 0; i < n; i++) {
        const mh_real old = a[i];
        a[i] = c * old - s * b[i];
        b[i] = s * old + c * b[i];
    }
    return cosine;
}

/* One-sided Jacobi (Hestenes) on La^-1 Lb: it finds small d as exactly as large ones, and none below 0. Once all columns are within 1e-3 of orthogonal another sweep
 * leaves them so to rounding, as it converges quadratically. */
static enum mh_status find_joint(const struct mh_gaussian *a, const struct mh_gaussian *b, struct joint *joint)
{
    struct mh_gaussian_root of_a, of_b;
    if (a->n != b->n) {
        return MH_ERR_ARGUMENT;
    }
    enum mh_status status = mh_gaussian_factor(&of_a, a);
    if (status == MH_OK) {
        status = mh_gaussian_factor(&of_b, b);
    }
    if (status != MH_OK) {
        return status;
    }
    const uint8_t n = joint->n = a->n;
    mh_real(*column)[MH_STATES_MAX] = joint->T;
    mh_real offset[MH_STATES_MAX];
    for (uint_fast8_t k = 0; k < n; k++) {
        for (uint_fast8_t i = 0; i < n; i++) {
            column[k][i] = i < k ? 0 : of_b.L[MH_PACKED(k, i)];
        }
        mh_lower_solve(n, of_a.L, column[k]);
        offset[k] = b->x[k] - a->x[k];
    }
    mh_lower_solve(n, of_a.L, offset);
    mh_real largest = 1;
    for (int sweep = 0; sweep < SWEEPS && largest > 1e-3f; sweep++) {
        largest = 0;
        for (uint_fast8_t i = 1; i < n; i++) {
            for (uint_fast8_t k = 0; k < i; k++) {
                largest = mh_max(largest, turn(n, column[k], column[i]));
            }
        }
    }
    for (uint_fast8_t k = 0; k < n; k++) {
        const mh_real d = dot(n, column[k], column[k]);
        const mh_real scale = 1 / mh_sqrt(d);
        if (!mh_finite(d) || !mh_finite(scale)) {
            return MH_ERR_NOT_FINITE;
        }
        for (uint_fast8_t i = 0; i < n; i++) {
            column[k][i] *= scale;
        }
        joint->d[k] = d;
        joint->y[k] = dot(n, column[k], offset);
        mh_lower_multiply(n, of_a.L, column[k]);
        joint->length[k] = dot(n, column[k], column[k]);
    }
    return MH_OK;
}

/* Variance p and b's share of the mean, direction by direction -> *fused. */
static enum mh_status compose(const struct joint *joint, const struct mh_gaussian *a, const mh_real *p,
                              const mh_real *share, struct mh_gaussian *fused)
{
    struct mh_gaussian result;
    const uint8_t n = result.n = joint->n;
    memcpy(result.x, a->x, sizeof result.x);
    memset(result.P, 0, sizeof result.P);
    for (uint_fast8_t k = 0; k < n; k++) {
        const mh_real *t = joint->T[k];
        mh_real *P = result.P;
        for (uint_fast8_t j = 0; j < n; j++) {
            const mh_real scaled = p[k] * t[j];
            result.x[j] += share[k] * joint->y[k] * t[j];
            for (uint_fast8_t i = 0; i <= j; i++) {
                *P++ += t[i] * scaled;
            }
        }
    }
    return mh_information_give(&result, fused);
}

/* 1 / p = 1 + 1 / d - 1 / (w + (1 - w) d), without the difference */
static mh_real inverse_variance(mh_real d, mh_real w) { return d * (w + (1 - w) * d) / (w + (1 - w) * d * d); }

static mh_real inverse_trace(const void *context, mh_real w)
{
    const struct joint *joint = context;
    mh_real trace = 0;
    for (uint_fast8_t k = 0; k < joint->n; k++) {
        trace += inverse_variance(joint->d[k], w) * joint->length[k];
    }
    return trace;
}

enum mh_status mh_fusion_inverse(const struct mh_gaussian *a, const struct mh_gaussian *b, struct mh_gaussian *fused)
{
    struct joint joint;
    mh_real p[MH_STATES_MAX], share[MH_STATES_MAX];
    const enum mh_status status = find_joint(a, b, &joint);
    if (status != MH_OK) {
        return status;
    }
    const mh_real w = mh_smallest_cost(inverse_trace, &joint);
    for (uint_fast8_t k = 0; k < joint.n; k++) {
        const mh_real d = joint.d[k];
        p[k] = inverse_variance(d, w);
        share[k] = w / (w + (1 - w) * d * d);
    }
    return compose(&joint, a, p, share, fused);
}

enum mh_status mh_fusion_ellipsoidal(const struct mh_gaussian *a, const struct mh_gaussian *b,
                                     struct mh_gaussian *fused)
{
    const mh_real eta = 1e-4f; /* what differs less in quality is as good */
    struct joint joint;
    mh_real p[MH_STATES_MAX], share[MH_STATES_MAX];
    const enum mh_status status = find_joint(a, b, &joint);
    if (status != MH_OK) {
        return status;
    }
    for (uint_fast8_t k = 0; k < joint.n; k++) {
        const mh_real d = joint.d[k];
        const mh_real worse = mh_min(d, 1 / d); /* the share of the worse of both, but for eta */
        const mh_real of_worse = worse * eta / (1 - worse + 2 * eta);
        p[k] = mh_min(d, 1);
        share[k] = d < 1 ? 1 - of_worse : of_worse;
    }
    return compose(&joint, a, p, share, fused);
}
