#include "motehound/gaussian.h"

#include <string.h>

/* A determinant of correlations from which on rounding, of some 1e-6, does no harm. */
#define WELL_CONDITIONED (1.0f / 16384.0f)

static bool all_finite(const mh_real *a, uint_fast8_t count)
{
    bool finite = true;
    for (uint_fast8_t i = 0; i < count; i++) {
        finite = finite && mh_finite(a[i]);
    }
    return finite;
}

/* P has no factor: a number that is not finite leaves no pivot behind it that is. */
static enum mh_status why_not(const struct mh_gaussian *gaussian)
{
    return all_finite(gaussian->P, mh_packed_size(gaussian->n)) ? MH_ERR_SINGULAR : MH_ERR_NOT_FINITE;
}

/* L with P = L L' */
static enum mh_status factor(const struct mh_gaussian *gaussian, mh_real *L)
{
    const uint8_t n = gaussian->n;
    if (n < 1 || n > MH_STATES_MAX) {
        return MH_ERR_ARGUMENT;
    }
    if (!all_finite(gaussian->x, n)) {
        return MH_ERR_NOT_FINITE;
    }
    memcpy(L, gaussian->P, mh_packed_size(n) * sizeof L[0]);
    return mh_cholesky_factor(n, L) == MH_OK ? MH_OK : why_not(gaussian);
}

enum mh_status mh_gaussian_factor(struct mh_gaussian_root *root, const struct mh_gaussian *gaussian)
{
    const enum mh_status status = factor(gaussian, root->L);
    if (status == MH_OK) {
        root->n = gaussian->n;
        memcpy(root->x, gaussian->x, gaussian->n * sizeof root->x[0]);
    }
    return status;
}

enum mh_status mh_gaussian_check(const struct mh_gaussian *gaussian)
{
    mh_real L[MH_PACKED_SIZE(MH_STATES_MAX)];
    return factor(gaussian, L);
}

enum mh_status mh_gaussian_settle(struct mh_gaussian *gaussian)
{
    const uint8_t n = gaussian->n;
    mh_real L[MH_PACKED_SIZE(MH_STATES_MAX)];
    bool raised;
    if (!all_finite(gaussian->x, n)) {
        return MH_ERR_NOT_FINITE;
    }
    memcpy(L, gaussian->P, mh_packed_size(n) * sizeof L[0]);
    if (mh_cholesky_factor_raised(n, L, &raised) != MH_OK) {
        return why_not(gaussian);
    }
    if (raised) {
        mh_cholesky_multiply(n, L);
        memcpy(gaussian->P, L, mh_packed_size(n) * sizeof L[0]);
    }
    return MH_OK;
}

enum mh_status mh_gaussian_predict(struct mh_gaussian *gaussian, const mh_real *F, const mh_real *Q)
{
    struct mh_gaussian next = *gaussian;     /* its P is L until all of W is there */
    mh_real W[MH_STATES_MAX][MH_STATES_MAX]; /* F L */
    enum mh_status status = factor(gaussian, next.P);
    if (status != MH_OK) {
        return status;
    }
    const uint8_t n = next.n;
    for (uint_fast8_t i = 0; i < n; i++) {
        const mh_real *row = next.P;
        next.x[i] = 0;
        for (uint_fast8_t k = 0; k < n; k++) {
            W[i][k] = 0;
            const mh_real f = F[k];
            if (f != 0) {
                next.x[i] += f * gaussian->x[k];
                for (uint_fast8_t j = 0; j <= k; j++) {
                    W[i][j] += f * row[j];
                }
            }
            row += k + 1;
        }
        F += n;
    }
    mh_real *p = next.P;
    for (uint_fast8_t i = 0; i < n; i++) {
        for (uint_fast8_t j = 0; j <= i; j++) {
            mh_real sum = *Q++;
            for (uint_fast8_t k = 0; k < n; k++) {
                sum += W[i][k] * W[j][k];
            }
            *p++ = sum;
        }
    }
    status = mh_gaussian_settle(&next);
    if (status == MH_OK) {
        *gaussian = next;
    }
    return status;
}

void mh_covariance_predict(uint8_t n, mh_real *P, const mh_real *F, const mh_real *Q)
{
    mh_real before[MH_PACKED_SIZE(MH_STATES_MAX)];
    memcpy(before, P, mh_packed_size(n) * sizeof before[0]);
    for (int j = 0; j < n; j++) {
        mh_real moved[MH_STATES_MAX]; /* P times row j of F */
        for (int k = 0; k < n; k++) {
            moved[k] = 0;
            for (int m = 0; m < n; m++) {
                moved[k] += before[mh_packed_index(k, m)] * F[j * n + m];
            }
        }
        for (int i = 0; i <= j; i++) {
            mh_real sum = Q ? *Q++ : 0;
            for (int k = 0; k < n; k++) {
                sum += F[i * n + k] * moved[k];
            }
            *P++ = sum;
        }
    }
}

enum mh_status mh_gaussian_reduction(const struct mh_gaussian *before, const struct mh_gaussian *after, mh_real *A)
{
    struct mh_gaussian_root root;
    const uint8_t n = before->n;
    if (after->n != n) {
        return MH_ERR_ARGUMENT;
    }
    const enum mh_status status = mh_gaussian_factor(&root, before);
    if (status != MH_OK) {
        return status;
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            A[j] = after->P[mh_packed_index(i, j)];
        }
        mh_cholesky_solve(n, root.L, A);
        A += n;
    }
    return MH_OK;
}

void mh_gaussian_root_gradient(const struct mh_gaussian_root *root, const mh_real *h, mh_real *c)
{
    const uint8_t n = root->n;
    for (uint_fast8_t j = 0; j < n; j++) {
        const mh_real *element = root->L + MH_PACKED(j, j);
        mh_real sum = 0;
        for (uint_fast8_t i = j; i < n; i++) {
            sum += *element * h[i];
            element += i + 1;
        }
        c[j] = sum;
    }
}

void mh_root_turn_begin(struct mh_root_turn *turn, uint8_t n, const mh_real *c, mh_real innovation, mh_real variance)
{
    mh_real rest = variance; /* and the squares of c from j + 1 on */
    turn->c = c;
    for (uint_fast8_t j = n; j-- > 0;) {
        const mh_real sum = rest + c[j] * c[j];
        const mh_real inverse = 1.0f / sum;
        const mh_real scale = mh_sqrt(rest * inverse);
        turn->scale[j] = scale;
        turn->share[j] = c[j] != 0 ? c[j] * inverse / scale : 0;
        rest = sum;
    }
    turn->step = innovation / rest;
}

mh_real mh_root_turn_row(const struct mh_root_turn *turn, mh_real *row, uint8_t length)
{
    mh_real sum = 0; /* of row and c, from j + 1 on: the row's covariance with what was measured, in the end */
    for (uint_fast8_t j = length; j-- > 0;) {
        const mh_real old = row[j];
        row[j] = turn->scale[j] * old - turn->share[j] * sum;
        sum += turn->c[j] * old;
    }
    return sum * turn->step;
}

void mh_gaussian_root_apply(struct mh_gaussian_root *root, const struct mh_root_turn *turn)
{
    mh_real *row = root->L;
    for (uint8_t i = 0; i < root->n; i++) {
        root->x[i] += mh_root_turn_row(turn, row, (uint8_t)(i + 1));
        row += i + 1;
    }
}

void mh_gaussian_root_take(struct mh_gaussian_root *root, const mh_real *c, mh_real innovation, mh_real variance)
{
    struct mh_root_turn turn;
    mh_root_turn_begin(&turn, root->n, c, innovation, variance);
    mh_gaussian_root_apply(root, &turn);
}

enum mh_status mh_gaussian_compose(struct mh_gaussian *gaussian, const struct mh_gaussian_root *root)
{
    const uint8_t n = root->n;
    mh_real P[MH_PACKED_SIZE(MH_STATES_MAX)], shares = 1; /* of the pivots in their variances, multiplied */
    if (!all_finite(root->x, n)) {
        return MH_ERR_NOT_FINITE;
    }
    memcpy(P, root->L, mh_packed_size(n) * sizeof P[0]);
    mh_cholesky_multiply(n, P);
    for (uint_fast8_t i = 0; i < n; i++) {
        const mh_real variance = P[MH_PACKED(i, i)];
        if (!mh_finite(variance)) {
            return MH_ERR_NOT_FINITE;
        }
        if (variance < MH_REAL_MIN) {
            return MH_ERR_SINGULAR;
        }
        shares *= mh_squared(root->L[MH_PACKED(i, i)]) / variance;
    }
    /* Of the correlations, the product is the determinant, and the least eigenvalue no less than that over e. */
    if (!(shares >= WELL_CONDITIONED)) {
        for (uint_fast8_t i = 0; i < n; i++) {
            P[MH_PACKED(i, i)] *= 1.0f + MH_PIVOT_FLOOR;
        }
    }
    gaussian->n = n;
    memcpy(gaussian->x, root->x, n * sizeof P[0]);
    memcpy(gaussian->P, P, mh_packed_size(n) * sizeof P[0]);
    return MH_OK;
}
