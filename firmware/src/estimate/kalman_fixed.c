#include "kalman_parts.h"

#include "motehound/scaled_fixed.h"

#if MH_REAL_FIXED

/* The algorithm of kalman.c, its numbers scaled. States, F, U, h and U' h are mh_real. Variances (D, P, Q, R, D U' h, h' P h) are integers in a unit of
 * their own, 2^-(16 + filter->exponent), such that the largest element of D lies in 2^27 to 2^28; what they leave of 31 bits is for sums and for U.
 * Divisors become reciprocals of 30 bits with an exponent. */
enum {
    LARGEST_EXPONENT = 32,   /* a filter whose variances are smaller than that has them with fewer bits */
    SMALLEST_EXPONENT = -16, /* a variance of 2^28 */
    COUNT_BITS = MH_KALMAN_STATES_MAX <= 4   ? 2
                 : MH_KALMAN_STATES_MAX <= 8 ? 3
                                             : 4,
};

static mh_real *variance_of(struct mh_kalman *filter, uint_fast8_t i) { return &filter->ud[MH_PACKED(i, i)]; }

/* All of D times 2^shift, but the exponent is as it was. */
static void scale_variances(struct mh_kalman *filter, int8_t shift)
{
    mh_real *variance = filter->ud;
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        *variance = mh_max(mh_scaled(*variance, shift), MH_SCALED_LEAST);
        variance += j + 2;
    }
}

/* The largest of D into its place. Errors: MH_ERR_NOT_FINITE (there is no exponent for it). */
static enum mh_status normalise(struct mh_kalman *filter)
{
    uint32_t all = 0;
    const mh_real *variance = filter->ud;
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        all |= (uint32_t)*variance;
        variance += j + 2;
    }
    int8_t shift = (int8_t)(MH_SCALED_TOP - mh_digits(all));
    if (filter->exponent + shift < SMALLEST_EXPONENT) {
        return MH_ERR_NOT_FINITE;
    }
    if (filter->exponent + shift > LARGEST_EXPONENT) {
        shift = (int8_t)(LARGEST_EXPONENT - filter->exponent);
    }
    scale_variances(filter, shift);
    filter->exponent = (int8_t)(filter->exponent + shift);
    return MH_OK;
}

enum mh_status mh_kalman_init(struct mh_kalman *filter, uint8_t n, const mh_real *x, const mh_real *P)
{
    if (n < 1 || n > MH_KALMAN_MOVING_MAX) {
        return MH_ERR_ARGUMENT;
    }
    struct mh_kalman started;
    started.n = started.moving = n;
    mh_real largest = 0, smallest = MH_REAL_INFINITE, across = 0;
    for (uint_fast8_t j = 0; j < n; j++) {
        started.x[j] = x[j];
        for (uint_fast8_t i = 0; i <= j; i++) {
            const mh_real element = P[MH_PACKED(i, j)];
            if (!mh_finite(x[j]) || !mh_finite(element)) {
                return MH_ERR_NOT_FINITE;
            }
            across = mh_max(across, mh_abs(element));
        }
        largest = mh_max(largest, P[MH_PACKED(j, j)]);
        smallest = mh_min(smallest, P[MH_PACKED(j, j)]);
    }
    if (smallest <= 0 || across > largest) {
        return MH_ERR_SINGULAR;
    }
    started.exponent = (int8_t)(MH_SCALED_TOP - mh_digits((uint32_t)largest));
    if (mh_scaled(smallest, started.exponent) < MH_SCALED_LEAST) {
        return MH_ERR_RANGE;
    }
    for (uint_fast8_t i = 0; i < mh_packed_size(n); i++) {
        started.ud[i] = mh_scaled(P[i], started.exponent);
    }
    enum mh_status status = mh_ud_factor(n, started.ud, false);
    if (status == MH_OK) {
        status = normalise(&started);
    }
    if (status == MH_OK) {
        *filter = started;
    }
    return status;
}

mh_real mh_kalman_variance_for(struct mh_kalman *filter, mh_real variance)
{
    const int8_t over = (int8_t)(mh_digits((uint32_t)variance) + filter->exponent - MH_SCALED_TOP);
    if (over > 0) {
        scale_variances(filter, (int8_t)-over);
        filter->exponent = (int8_t)(filter->exponent - over);
    }
    return mh_max(mh_scaled(variance, filter->exponent), MH_SCALED_LEAST);
}

enum mh_status mh_kalman_predict(struct mh_kalman *filter, const mh_real *F, const mh_real *Q)
{
    const mh_real limit = (mh_real)1 << 30; /* of the variances of F P F' + Q */
    const uint8_t n = filter->moving;
    struct mh_kalman next = *filter;
    mh_real W[MH_KALMAN_MOVING_MAX][MH_KALMAN_MOVING_MAX]; /* F U */
    uint8_t first[MH_KALMAN_MOVING_MAX];                   /* F is zero before it in this row, and so is F U */
    uint32_t noise = 0;
    if (filter->n > n && mh_kalman_move_ties(&next, filter, F) != MH_OK) {
        return MH_ERR_NOT_FINITE;
    }
    for (uint_fast8_t j = 0; j < n; j++) {
        const mh_real *column = filter->ud;
        mh_real x = 0;
        uint8_t k = 0;
        while (k < n && F[k] == 0) {
            k++;
            column += k;
        }
        first[j] = k;
        for (; k < n; k++) {
            mh_real sum = F[k];
            if (sum != 0) {
                x = mh_add(x, mh_mul(sum, filter->x[k]));
            }
            for (uint_fast8_t m = first[j]; m < k; m++) {
                if (F[m] != 0 && column[m] != 0) {
                    sum = mh_add(sum, mh_mul(F[m], column[m]));
                }
            }
            if (!mh_finite(sum)) {
                return MH_ERR_NOT_FINITE;
            }
            W[j][k] = sum;
            column += k + 1;
        }
        if (!mh_finite(x)) {
            return MH_ERR_NOT_FINITE;
        }
        next.x[j] = x;
        F += n;
        for (uint_fast8_t i = 0; i <= j; i++) {
            const mh_real element = Q[MH_PACKED(i, j)];
            if (!mh_finite(element)) {
                return MH_ERR_NOT_FINITE;
            }
            noise |= (uint32_t)mh_abs(element);
        }
    }
    /* Where the sum would be too large, all is scaled down. Beside the diagonal nothing is larger than on it. */
    const int8_t room = (int8_t)(28 - mh_digits(noise) - filter->exponent);
    int8_t down = room < 0 ? (int8_t)-room : 0;
    mh_real scaled_W[MH_KALMAN_MOVING_MAX][MH_KALMAN_MOVING_MAX]; /* F U D */
    mh_real largest;
    for (;;) {
        largest = 0;
        next.exponent = (int8_t)(filter->exponent - down);
        if (next.exponent < SMALLEST_EXPONENT - 4) {
            return MH_ERR_NOT_FINITE;
        }
        for (uint_fast8_t j = 0; j < n; j++) {
            uint_fast8_t diagonal = (uint_fast8_t)MH_PACKED(first[j], first[j]);
            mh_real sum = mh_scaled(Q[MH_PACKED(j, j)], next.exponent);
            for (uint_fast8_t k = first[j]; k < n; k++) {
                scaled_W[j][k] = W[j][k] == 0 ? 0 : mh_mul(W[j][k], mh_scaled(filter->ud[diagonal], (int8_t)-down));
                if (W[j][k] != 0) {
                    sum = mh_add(sum, mh_mul(W[j][k], scaled_W[j][k]));
                }
                diagonal = (uint_fast8_t)(diagonal + k + 2);
            }
            next.ud[MH_PACKED(j, j)] = sum;
            largest = mh_max(largest, sum);
        }
        if (largest <= limit) {
            break;
        }
        down = (int8_t)(down + 2);
    }
    for (uint_fast8_t j = 1; j < n; j++) {
        for (uint_fast8_t i = 0; i < j; i++) {
            mh_real sum = mh_scaled(Q[MH_PACKED(i, j)], next.exponent);
            for (uint_fast8_t k = first[i] > first[j] ? first[i] : first[j]; k < n; k++) {
                if (W[i][k] != 0 && scaled_W[j][k] != 0) {
                    sum += mh_mul(W[i][k], scaled_W[j][k]);
                }
            }
            next.ud[MH_PACKED(i, j)] = sum;
        }
    }
    if (filter->n > n) {
        for (uint_fast8_t k = n; k < filter->n; k++) {
            *variance_of(&next, k) = mh_max(mh_scaled(*variance_of(&next, k), (int8_t)-down), MH_SCALED_LEAST);
        }
    }
    enum mh_status status = mh_ud_factor(n, next.ud, true);
    if (status == MH_OK) {
        status = normalise(&next);
    }
    if (status == MH_OK) {
        *filter = next;
    }
    return status;
}

/* A scalar measurement, its unit such that f = U' h is at most 1: f, innovation and the root of the noise's variance are 2^f_down times these. */
struct scalar {
    mh_real f[MH_KALMAN_STATES_MAX];
    int8_t f_down;
    mh_real innovation; /* as it was */
    mh_real noise;      /* its variance times 2^-noise_up, as it was */
    int8_t noise_up;
};

/* How much the numbers that are added up may have, so that there can be as many of them as states. */
enum { ADDED = 30 - COUNT_BITS };

static enum mh_status project(struct scalar *scalar, const struct mh_kalman *filter, const mh_real *h)
{
    mh_real largest = 0;
    const mh_real *u = filter->ud;
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        mh_real sum = h[j];
        for (uint_fast8_t i = 0; i < j; i++) {
            if (h[i] != 0) {
                sum = mh_add(sum, mh_mul(*u, h[i]));
            }
            u++;
        }
        u++;
        if (!mh_finite(sum)) {
            return MH_ERR_NOT_FINITE;
        }
        scalar->f[j] = sum;
        largest = mh_max(largest, mh_abs(sum));
    }
    scalar->f_down = 0;
    if (largest > MH_REAL_ONE || (largest < MH_REAL_ONE / 16 && largest > 0)) {
        scalar->f_down = (int8_t)(mh_digits((uint32_t)largest) - MH_REAL_BITS);
        for (uint_fast8_t j = 0; j < filter->n; j++) {
            scalar->f[j] = mh_scaled(scalar->f[j], (int8_t)-scalar->f_down);
        }
    }
    return MH_OK;
}

/* What the gate compares: variances 2^down of the filter's. */
struct expected {
    mh_real predicted, noise; /* h' P h, R */
    int8_t down;
};

static void expect(struct expected *expected, const struct mh_kalman *filter, const struct scalar *scalar)
{
    const int8_t up = (int8_t)(filter->exponent - 2 * scalar->f_down + scalar->noise_up);
    int8_t size = (int8_t)(mh_digits((uint32_t)scalar->noise) + up);
    const mh_real *d = filter->ud;
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        const int8_t this =
            (int8_t)(mh_digits((uint32_t)*d) + 2 * (mh_digits((uint32_t)mh_abs(scalar->f[j])) - MH_REAL_BITS));
        size = scalar->f[j] != 0 && this > size ? this : size;
        d += j + 2;
    }
    expected->down = (int8_t)(size - ADDED);
    expected->noise = mh_scaled(scalar->noise, (int8_t)(up - expected->down));
    expected->predicted = 0;
    d = filter->ud;
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        const mh_real square = mh_mul_shift(scalar->f[j], scalar->f[j], 2);
        expected->predicted += mh_product(*d, square, (int8_t)(30 + expected->down));
        d += j + 2;
    }
}

/* D times what makes h' P h + R = `ratio` times what it is, ratio > 1; false if that is too large. */
static bool widen(struct mh_kalman *filter, const struct expected *expected, mh_real ratio)
{
    if (!mh_finite(ratio) || expected->predicted < 1) {
        return false;
    }
    const int8_t up = (int8_t)(mh_digits((uint32_t)ratio) - MH_REAL_BITS);
    const mh_real wanted = mh_mul(expected->predicted + expected->noise, mh_scaled(ratio, (int8_t)-up)) -
                           mh_scaled(expected->noise, (int8_t)-up);
    if (wanted < 1) {
        return false;
    }
    const struct mh_reciprocal inverse = mh_reciprocal(expected->predicted);
    const uint8_t size = mh_digits((uint32_t)wanted);
    const int32_t mantissa = mh_mul_shift(wanted, inverse.mantissa, (uint8_t)(size + 1)); /* 2^27 to 2^29 */
    const int8_t exponent = (int8_t)(filter->exponent - (up + size - inverse.exponent));
    if (exponent < SMALLEST_EXPONENT) {
        return false;
    }
    for (uint_fast8_t j = 0; j < filter->n; j++) {
        *variance_of(filter, j) = mh_max(mh_mul_shift(*variance_of(filter, j), mantissa, 29), MH_SCALED_LEAST);
    }
    filter->exponent = exponent;
    return true;
}

/* Bierman's update. Its variances are in a unit of their own, in which R has 24 bits, and which grows with alpha, from R to h' P h + R. */
static enum mh_status take(struct mh_kalman *filter, const struct scalar *scalar)
{
    const uint8_t n = filter->n, noise_digits = mh_digits((uint32_t)scalar->noise);
    int8_t down = (int8_t)(noise_digits + scalar->noise_up + filter->exponent - 2 * scalar->f_down - 24);
    mh_real g[MH_KALMAN_STATES_MAX] = {0}; /* D f, which becomes P h column by column */
    mh_real alpha = mh_scaled(scalar->noise, (int8_t)(24 - noise_digits));
    struct mh_reciprocal inverse = mh_reciprocal(alpha);
    mh_real *column = filter->ud;
    for (uint_fast8_t j = 0; j < n; j++) {
        const mh_real f = scalar->f[j];
        if (f != 0) {
            uint32_t all = MH_REAL_ONE / 2;
            for (uint_fast8_t i = 0; i < j; i++) {
                all |= (uint32_t)mh_abs(column[i]);
            }
            const int8_t f_digits = (int8_t)(mh_digits((uint32_t)mh_abs(f)) - MH_REAL_BITS);
            const int8_t u_digits = (int8_t)(mh_digits(all) - MH_REAL_BITS);
            const int8_t over = (int8_t)(mh_digits((uint32_t)column[j]) + f_digits +
                                         (f_digits > u_digits ? f_digits : u_digits) - down - ADDED);
            const int8_t grown = over > 0 ? over : 0;
            down = (int8_t)(down + grown);
            const mh_real gain = mh_product(column[j], f, (int8_t)(MH_REAL_BITS + down)), before = alpha;
            const mh_real lambda = mh_mul(f, inverse.mantissa); /* 2^-shift of it is f / alpha */
            const uint8_t shift = (uint8_t)(inverse.exponent + 30 - MH_REAL_BITS);
            alpha = mh_scaled(alpha, (int8_t)-grown) + mh_mul(f, gain);
            if (alpha < 1024) { /* less than ten bits are left of it */
                return MH_ERR_RANGE;
            }
            inverse = mh_reciprocal(alpha);
            const mh_real ratio = mh_product(before, inverse.mantissa, (int8_t)(inverse.exponent + grown));
            column[j] = mh_max(mh_mul_shift(column[j], ratio, 30), MH_SCALED_LEAST);
            for (uint_fast8_t i = 0; i < j; i++) {
                const mh_real old = column[i];
                if (g[i] != 0) {
                    column[i] = mh_add(old, -mh_mul_shift(g[i], lambda, shift));
                    if (!mh_finite(column[i])) {
                        return MH_ERR_RANGE;
                    }
                    g[i] = mh_scaled(g[i], (int8_t)-grown);
                }
                if (old != 0) {
                    g[i] += mh_mul(gain, old);
                }
            }
            g[j] = gain;
        }
        column += j + 1;
    }
    const mh_real scale = mh_mul_shift(scalar->innovation, inverse.mantissa, 30);
    for (uint_fast8_t j = 0; j < n; j++) {
        if (g[j] != 0) {
            filter->x[j] = mh_add(filter->x[j], mh_product(g[j], scale, (int8_t)(inverse.exponent + scalar->f_down)));
            if (!mh_finite(filter->x[j])) {
                return MH_ERR_NOT_FINITE;
            }
        }
    }
    return normalise(filter);
}

/* The innovation squared over its variance. */
static mh_real surprise_of(const struct mh_kalman *filter, const struct expected *expected, const struct scalar *scalar)
{
    const struct mh_reciprocal inverse = mh_reciprocal(expected->predicted + expected->noise);
    const mh_real scale = mh_mul_shift(scalar->innovation, inverse.mantissa, 30);
    return mh_product(scalar->innovation, scale,
                      (int8_t)(inverse.exponent + 2 * scalar->f_down + expected->down - filter->exponent));
}

enum mh_status mh_kalman_update(struct mh_kalman *filter, const mh_real *h, mh_real innovation, mh_real variance,
                                struct mh_gate *gate)
{
    struct scalar scalar = {.innovation = innovation, .noise = variance};
    if (variance < MH_REAL_MIN) {
        return MH_ERR_ARGUMENT;
    }
    if (!mh_finite(variance) || !mh_finite(innovation) || project(&scalar, filter, h) != MH_OK) {
        return MH_ERR_NOT_FINITE;
    }
    struct mh_kalman next = *filter;
    if (gate) {
        struct expected expected;
        const mh_real limit = mh_mul(gate->sigmas, gate->sigmas);
        expect(&expected, filter, &scalar);
        gate->surprise = surprise_of(filter, &expected, &scalar);
        if (gate->surprise > limit) {
            if (gate->refused < gate->patience) {
                gate->refused++;
                return MH_NONE;
            }
            if (!widen(&next, &expected, mh_div(gate->surprise, limit))) {
                return MH_NONE;
            }
        }
    }
    const enum mh_status status = take(&next, &scalar);
    if (status != MH_OK) {
        return status;
    }
    *filter = next;
    if (gate) {
        gate->refused = 0;
    }
    return MH_OK;
}

enum mh_status mh_kalman_update_scaled(struct mh_kalman *filter, const mh_real *h, mh_real innovation, int32_t variance,
                                       int8_t up)
{
    struct scalar scalar = {.innovation = innovation, .noise = variance, .noise_up = up};
    if (!mh_finite(innovation) || project(&scalar, filter, h) != MH_OK) {
        return MH_ERR_NOT_FINITE;
    }
    struct mh_kalman next = *filter;
    const enum mh_status status = take(&next, &scalar);
    if (status == MH_OK) {
        *filter = next;
    }
    return status;
}

/* Element (i, j) of P, i <= j, times 2^guard. */
static mh_real element_with(const struct mh_kalman *filter, uint_fast8_t i, uint_fast8_t j, uint8_t guard)
{
    const int8_t down = (int8_t)(MH_REAL_BITS + filter->exponent - guard);
    const mh_real *column = filter->ud + MH_PACKED(0, j);
    mh_real sum = mh_product(column[j], i == j ? MH_REAL_ONE : column[i], down); /* U_jj = 1 */
    for (uint_fast8_t k = (uint_fast8_t)(j + 1); k < filter->n; k++) {
        column += k;
        const mh_real left = column[i], right = column[j];
        if (left != 0 && right != 0) {
            const int8_t all = (int8_t)(mh_digits((uint32_t)mh_abs(left)) + mh_digits((uint32_t)mh_abs(right)));
            const int8_t over = all > 30 ? (int8_t)(all - 30) : 0;
            sum =
                mh_add(sum, mh_product(column[k], mh_product(left, right, over), (int8_t)(MH_REAL_BITS - over + down)));
        }
    }
    return sum;
}

mh_real mh_kalman_element(const struct mh_kalman *filter, uint_fast8_t i, uint_fast8_t j)
{
    enum { GUARD = 8 };
    const mh_real fine = element_with(filter, i, j, GUARD);
    return mh_finite(fine) ? mh_scaled(fine, -GUARD) : element_with(filter, i, j, 0);
}

#else
typedef int mh_kalman_is_float; /* C99 wants a declaration */
#endif
