#include "kalman_parts.h"

#include <string.h>

/* A pivot below this share of its variance is rounding: 8 units in the last place of a float. */
#define PIVOT_FLOOR (1.0f / 2097152.0f)

/* P = U D U', packed, in place, last column first. A pivot that rounding has swallowed is an error, or with `raise` it is
 * put back to its floor. */
static enum mh_status factor(uint8_t n, mh_real *P, bool raise)
{
    mh_real floor[MH_KALMAN_MOVING_MAX];
    const mh_real *variance = P;
    for (uint_fast8_t j = 0; j < n; j++) {
        floor[j] = PIVOT_FLOOR * *variance;
        variance += j + 2;
    }
    mh_real *column = P + MH_PACKED_SIZE(n);
    for (uint_fast8_t j = n; j-- > 0;) {
        column -= j + 1;
        if (!mh_finite(column[j])) {
            return MH_ERR_NOT_FINITE;
        }
        if (column[j] < floor[j] && raise) {
            column[j] = floor[j];
        }
        if (!(column[j] >= floor[j]) || column[j] <= 0) {
            return MH_ERR_SINGULAR;
        }
        const mh_real inverse = 1.0f / column[j];
        mh_real *other = P;
        for (uint_fast8_t k = 0; k < j; k++) {
            const mh_real u = column[k] * inverse;
            for (uint_fast8_t i = 0; i <= k; i++) {
                *other++ -= u * column[i];
            }
        }
        for (uint_fast8_t k = 0; k < j; k++) {
            column[k] *= inverse;
        }
    }
    return MH_OK;
}

enum mh_status mh_kalman_init(struct mh_kalman *filter, uint8_t n, const mh_real *x, const mh_real *P)
{
    if (n < 1 || n > MH_KALMAN_MOVING_MAX) {
        return MH_ERR_ARGUMENT;
    }
    struct mh_kalman started;
    started.n = started.moving = n;
    for (uint_fast8_t i = 0; i < n; i++) {
        if (!mh_finite(x[i])) {
            return MH_ERR_NOT_FINITE;
        }
        started.x[i] = x[i];
    }
    for (uint_fast8_t i = 0; i < (uint_fast8_t)MH_PACKED_SIZE(n); i++) {
        started.ud[i] = P[i];
    }
    enum mh_status status = factor(n, started.ud, false);
    if (status == MH_OK) {
        *filter = started;
    }
    return status;
}

mh_real mh_kalman_variance_for(struct mh_kalman *filter, mh_real variance)
{
    (void)filter;
    return variance;
}

/* Copy what is in use. */
static void copy(struct mh_kalman *to, const struct mh_kalman *filter)
{
    if (MH_KALMAN_STATES_MAX <= MH_KALMAN_MOVING_MAX) {
        *to = *filter;
        return;
    }
    to->n = filter->n;
    to->moving = filter->moving;
    memcpy(to->x, filter->x, filter->n * sizeof to->x[0]);
    memcpy(to->ud, filter->ud, (size_t)MH_PACKED_SIZE(filter->n) * sizeof to->ud[0]);
}

enum mh_status mh_kalman_predict(struct mh_kalman *filter, const mh_real *F, const mh_real *Q)
{
    const uint8_t n = filter->moving;
    struct mh_kalman next;
    mh_real W[MH_KALMAN_MOVING_MAX][MH_KALMAN_MOVING_MAX]; /* F U */
    mh_real *p = next.ud;
    next.n = filter->n;
    next.moving = n;
    if (filter->n > n) {
        copy(&next, filter);
        if (mh_kalman_move_ties(&next, filter, F) != MH_OK) {
            return MH_ERR_NOT_FINITE;
        }
    }
    for (uint_fast8_t j = 0; j < n; j++) {
        mh_real scaled[MH_KALMAN_MOVING_MAX]; /* row j of F U D */
        uint_fast8_t first = 0;               /* F is zero before it in this row, and so is F U */
        const mh_real *column = filter->ud;
        mh_real x = 0;
        while (first < n && F[first] == 0) {
            W[j][first++] = 0;
            column += first;
        }
        for (uint_fast8_t k = first; k < n; k++) {
            mh_real sum = F[k];
            x += sum * filter->x[k];
            for (uint_fast8_t m = first; m < k; m++) {
                sum += F[m] * column[m];
            }
            W[j][k] = sum;
            scaled[k] = sum * column[k];
            column += k + 1;
        }
        if (!mh_finite(x)) {
            return MH_ERR_NOT_FINITE;
        }
        next.x[j] = x;
        for (uint_fast8_t i = 0; i <= j; i++) {
            mh_real sum = *Q++;
            for (uint_fast8_t k = first; k < n; k++) {
                sum += W[i][k] * scaled[k];
            }
            *p++ = sum;
        }
        F += n;
    }
    enum mh_status status = factor(n, next.ud, true);
    if (status == MH_OK) {
        copy(filter, &next);
    }
    return status;
}

/* True if the measurement may be used; it may widen P (by a common factor on D, and so on g = D f) to make it so. */
static bool gate_passes(struct mh_gate *gate, struct mh_kalman *filter, mh_real *g, mh_real *predicted,
                        mh_real innovation, mh_real variance)
{
    const mh_real square = innovation * innovation;
    const mh_real limit = gate->sigmas * gate->sigmas;
    gate->surprise = square / (*predicted + variance);
    if (gate->surprise <= limit) {
        return true;
    }
    const mh_real factor = (square / limit - variance) / *predicted;
    mh_real largest = 0;
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        largest = mh_max(largest, filter->ud[MH_PACKED(j, j)]);
    }
    if (gate->refused < gate->patience || !mh_finite(factor * largest)) {
        gate->refused = (uint8_t)(gate->refused < gate->patience ? gate->refused + 1 : gate->refused);
        return false;
    }
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        filter->ud[MH_PACKED(j, j)] *= factor;
        g[j] *= factor;
    }
    *predicted *= factor;
    return true;
}

enum mh_status mh_kalman_update(struct mh_kalman *filter, const mh_real *h, mh_real innovation, mh_real variance,
                                struct mh_gate *gate)
{
    const uint8_t n = filter->n;
    struct mh_kalman before;
    copy(&before, filter);
    mh_real f[MH_KALMAN_STATES_MAX]; /* U' h */
    mh_real g[MH_KALMAN_STATES_MAX]; /* D f, which becomes P h column by column */
    mh_real predicted = 0;           /* h' P h */
    const mh_real *u = filter->ud;
    for (uint_fast8_t j = 0; j < n; j++) {
        mh_real sum = h[j];
        for (uint_fast8_t i = 0; i < j; i++) {
            sum += *u++ * h[i];
        }
        f[j] = sum;
        g[j] = *u++ * sum;
        predicted += sum * g[j];
    }
    if (!(variance >= MH_REAL_MIN)) {
        return MH_ERR_ARGUMENT;
    }
    if (!mh_finite(predicted + variance) || !mh_finite(innovation)) {
        return MH_ERR_NOT_FINITE;
    }
    if (gate && !gate_passes(gate, filter, g, &predicted, innovation, variance)) {
        return MH_NONE;
    }
    mh_real alpha = variance;
    mh_real inverse = 1.0f / variance;
    /* P does not grow, so U stays below sqrt(P / D): it cannot overflow while every pivot is a normal number */
    bool fits = true;
    mh_real *column = filter->ud;
    for (uint_fast8_t j = 0; j < n; j++) {
        if (f[j] != 0) {
            const mh_real lambda = -f[j] * inverse;
            const mh_real gain = g[j];
            const mh_real ratio = alpha;
            alpha += f[j] * gain;
            inverse = 1.0f / alpha;
            column[j] *= ratio * inverse;
            fits = fits && column[j] >= MH_REAL_MIN;
            for (uint_fast8_t i = 0; i < j; i++) {
                const mh_real old = column[i];
                column[i] = old + g[i] * lambda;
                g[i] += gain * old;
            }
        }
        column += j + 1;
    }
    const mh_real scale = innovation * inverse;
    mh_real sum = 0; /* finite only if every state is */
    for (uint_fast8_t j = 0; j < n; j++) {
        filter->x[j] += g[j] * scale;
        sum += filter->x[j];
    }
    if (!fits || !mh_finite(sum)) {
        copy(filter, &before);
        return MH_ERR_NOT_FINITE;
    }
    if (gate) {
        gate->refused = 0;
    }
    return MH_OK;
}

mh_real mh_kalman_element(const struct mh_kalman *filter, uint_fast8_t i, uint_fast8_t j)
{
    mh_real sum = 0;
    for (uint_fast8_t k = j; k < filter->n; k++) {
        const mh_real *column = filter->ud + MH_PACKED(0, k);
        const mh_real left = i == k ? 1.0f : column[i];
        const mh_real right = j == k ? 1.0f : column[j];
        sum += left * column[k] * right; /* in this order finite if P is: U may be as large as sqrt(P / D) */
    }
    return sum;
}
