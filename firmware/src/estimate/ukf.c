#include "motehound/ukf.h"

#include <string.h>

/* What the weights come to for n states. */
struct spread {
    mh_real gamma; /* of the sigma points, in standard deviations */
    mh_real half;  /* 1 / (2 gamma^2) */
    mh_real first; /* 1 / (2 gamma) */
    mh_real bend;  /* root of beta + alpha^2 kappa / n */
};

static enum mh_status spread_of(struct spread *spread, const struct mh_ukf_weights *weights, uint8_t n)
{
    const mh_real alpha = weights->alpha, kappa = weights->kappa;
    const mh_real bend = weights->beta + alpha * alpha * kappa / (mh_real)n;
    if (!mh_within(alpha, 0.1f, 1.0f) || !mh_finite(bend) || !(bend >= 0) || !((mh_real)n + kappa >= 0.5f)) {
        return MH_ERR_ARGUMENT;
    }
    spread->gamma = alpha * mh_sqrt((mh_real)n + kappa);
    spread->first = 0.5f / spread->gamma;
    spread->half = 2.0f * mh_squared(spread->first);
    spread->bend = mh_sqrt(bend);
    return MH_OK;
}

/* The sigma points on both sides along column i: what they were along the column before is put back, rows above it are those of x. */
static void put_pair(const struct mh_gaussian_root *root, mh_real gamma, uint_fast8_t i, mh_real *plus, mh_real *minus)
{
    const mh_real *element = root->L + MH_PACKED(i, i);
    if (i > 0) {
        plus[i - 1] = minus[i - 1] = root->x[i - 1];
    }
    for (uint_fast8_t j = i; j < root->n; j++) {
        const mh_real x = root->x[j], step = gamma * *element;
        plus[j] = x + step;
        minus[j] = x - step;
        element += j + 1;
    }
}

enum mh_status mh_ukf_predict(struct mh_gaussian *gaussian, const struct mh_ukf_weights *weights,
                              const struct mh_transition *transition, const mh_real *Q)
{
    struct mh_gaussian_root root;
    struct mh_gaussian next = *gaussian;
    struct spread spread;
    mh_real plus[MH_STATES_MAX], minus[MH_STATES_MAX], middle[MH_STATES_MAX], c[MH_STATES_MAX], d[MH_STATES_MAX];
    mh_real mean[MH_STATES_MAX] = {0}; /* of the d so far */
    enum mh_status status = mh_gaussian_factor(&root, gaussian);
    if (status == MH_OK) {
        status = spread_of(&spread, weights, root.n);
    }
    if (status == MH_OK) {
        status = transition->move(transition->context, root.x, middle, NULL);
    }
    if (status != MH_OK) {
        return status;
    }
    const uint8_t n = root.n;
    memcpy(next.P, Q, (size_t)MH_PACKED_SIZE(n) * sizeof next.P[0]);
    for (uint_fast8_t i = 0; i < n; i++) {
        put_pair(&root, spread.gamma, i, plus, minus);
        status = transition->move(transition->context, plus, c, NULL);
        if (status == MH_OK) {
            status = transition->move(transition->context, minus, d, NULL);
        }
        if (status != MH_OK) {
            return status;
        }
        /* the sum of (d - mean) (d - mean)' grows by i / (i + 1) times that with the mean before (Welford) */
        const mh_real share = 1.0f / (mh_real)(i + 1);
        mh_real *p = next.P;
        for (uint_fast8_t j = 0; j < n; j++) {
            const mh_real above = c[j] - middle[j], below = d[j] - middle[j];
            c[j] = (above - below) * spread.first;
            d[j] = (above + below) * spread.first - mean[j];
            const mh_real weighted = (1.0f - share) * d[j];
            for (uint_fast8_t k = 0; k <= j; k++) {
                *p++ += c[j] * c[k] + weighted * d[k];
            }
        }
        for (uint_fast8_t j = 0; j < n; j++) {
            mean[j] += share * d[j];
        }
    }
    const mh_real to_sum = (mh_real)n * 2.0f * spread.first; /* D = n mean / gamma */
    mh_real *p = next.P;
    for (uint_fast8_t j = 0; j < n; j++) {
        const mh_real D = mean[j] * to_sum;
        next.x[j] = middle[j] + D;
        mean[j] = spread.bend * D;
        for (uint_fast8_t k = 0; k <= j; k++) {
            *p++ += mean[j] * mean[k];
        }
    }
    status = mh_gaussian_settle(&next);
    if (status == MH_OK) {
        *gaussian = next;
    }
    return status;
}

/* One element as the sigma points see it. */
struct sight {
    mh_real middle;
    mh_real c[MH_STATES_MAX]; /* first differences: the gradient with respect to L^-1 x */
    mh_real d[MH_STATES_MAX]; /* second differences less their mean, over 2 gamma */
    mh_real D;                /* its mean less its value in the middle, times the root of beta + alpha^2 kappa / n */
    mh_real innovation;
};

/* What element k is at `point`, less what it is in the middle. */
static enum mh_status off_middle(const struct mh_observations *observations, uint16_t k, const mh_real *point,
                                 mh_real middle, mh_real *difference)
{
    mh_real z;
    const enum mh_status status = observations->predict(observations->context, k, point, &z, NULL);
    *difference = z - middle;
    if (status == MH_OK && observations->wrap) {
        *difference = observations->wrap(observations->context, k, *difference);
    }
    return status;
}

/* The sum of the second differences is in sight->D. */
static enum mh_status conclude(struct sight *sight, const struct spread *spread,
                               const struct mh_observations *observations, uint16_t k, uint8_t n)
{
    const mh_real D = sight->D * spread->half, mean = sight->D * spread->first / (mh_real)n;
    for (uint_fast8_t i = 0; i < n; i++) {
        sight->d[i] -= mean;
    }
    sight->D = spread->bend * D;
    sight->innovation = observations->z[k] - sight->middle - D;
    if (observations->wrap) {
        sight->innovation = observations->wrap(observations->context, k, sight->innovation);
    }
    return mh_finite(sight->innovation) ? MH_OK : MH_ERR_NOT_FINITE;
}

/* `count` elements from number `first` on, all with the same sigma points. */
static enum mh_status look(struct sight *sights, uint16_t count, const struct mh_gaussian_root *root,
                           const struct spread *spread, const struct mh_observations *observations, uint16_t first)
{
    const uint8_t n = root->n;
    mh_real plus[MH_STATES_MAX], minus[MH_STATES_MAX];
    enum mh_status status = MH_OK;
    for (uint16_t k = 0; k < count && status == MH_OK; k++) {
        const uint16_t number = (uint16_t)(first + k);
        sights[k].D = 0;
        status = observations->predict(observations->context, number, root->x, &sights[k].middle, NULL);
        if (!(observations->variance[number] >= MH_REAL_MIN)) {
            return MH_ERR_ARGUMENT;
        }
    }
    for (uint_fast8_t i = 0; i < n; i++) {
        put_pair(root, spread->gamma, i, plus, minus);
        for (uint16_t k = 0; k < count && status == MH_OK; k++) {
            struct sight *sight = &sights[k];
            mh_real above, below;
            status = off_middle(observations, (uint16_t)(first + k), plus, sight->middle, &above);
            if (status == MH_OK) {
                status = off_middle(observations, (uint16_t)(first + k), minus, sight->middle, &below);
            }
            if (status == MH_OK) {
                sight->c[i] = (above - below) * spread->first;
                sight->d[i] = (above + below) * spread->first;
                sight->D += above + below;
            }
        }
    }
    for (uint16_t k = 0; k < count && status == MH_OK; k++) {
        status = conclude(&sights[k], spread, observations, (uint16_t)(first + k), n);
    }
    return status;
}

/* Covariance of two elements beyond what their gradients make it, their noise not counted. */
static mh_real curvature(const struct sight *a, const struct sight *b, uint8_t n)
{
    mh_real sum = a->D * b->D;
    for (uint_fast8_t i = 0; i < n; i++) {
        sum += a->d[i] * b->d[i];
    }
    return sum;
}

enum mh_status mh_ukf_update(struct mh_gaussian *gaussian, const struct mh_ukf_weights *weights,
                             const struct mh_observations *observations)
{
    struct mh_gaussian_root root;
    struct spread spread;
    enum mh_status status = mh_gaussian_factor(&root, gaussian);
    if (status == MH_OK) {
        status = spread_of(&spread, weights, root.n);
    }
    for (uint16_t k = 0; k < observations->count && status == MH_OK; k++) {
        struct sight sight;
        status = look(&sight, 1, &root, &spread, observations, k);
        if (status == MH_OK) {
            mh_gaussian_root_take(&root, sight.c, sight.innovation,
                                  observations->variance[k] + curvature(&sight, &sight, root.n));
        }
    }
    return status == MH_OK ? mh_gaussian_compose(gaussian, &root) : status;
}

/* Sights with correlated noise, covariance G G' -> with independent noise of variance 1: each less its share of those before it. */
static void decorrelate(struct sight *sights, uint16_t count, const mh_real *G, uint8_t n)
{
    for (uint16_t k = 0; k < count; k++) {
        struct sight *sight = &sights[k];
        for (uint16_t m = 0; m < k; m++) {
            const mh_real share = *G++;
            for (uint_fast8_t i = 0; i < n; i++) {
                sight->c[i] -= share * sights[m].c[i];
            }
            sight->innovation -= share * sights[m].innovation;
        }
        const mh_real scale = 1.0f / *G++;
        for (uint_fast8_t i = 0; i < n; i++) {
            sight->c[i] *= scale;
        }
        sight->innovation *= scale;
    }
}

enum mh_status mh_ukf_update_stacked(struct mh_gaussian *gaussian, const struct mh_ukf_weights *weights,
                                     const struct mh_observations *observations)
{
    struct mh_gaussian_root root;
    struct spread spread;
    struct sight sights[MH_STACKED_MAX];
    mh_real noise[MH_PACKED_SIZE(MH_STACKED_MAX)];
    bool raised;
    const uint16_t count = observations->count;
    enum mh_status status = mh_gaussian_factor(&root, gaussian);
    if (status == MH_OK) {
        status = spread_of(&spread, weights, root.n);
    }
    if (status == MH_OK && count > MH_STACKED_MAX) {
        status = MH_ERR_CAPACITY;
    }
    if (status == MH_OK) {
        status = look(sights, count, &root, &spread, observations, 0);
    }
    if (status != MH_OK) {
        return status;
    }
    mh_real *element = noise;
    for (uint16_t k = 0; k < count; k++) {
        for (uint16_t m = 0; m < k; m++) {
            *element++ = curvature(&sights[k], &sights[m], root.n);
        }
        *element++ = curvature(&sights[k], &sights[k], root.n) + observations->variance[k];
    }
    status = mh_cholesky_factor_raised((int)count, noise, &raised);
    if (status != MH_OK) {
        return status;
    }
    decorrelate(sights, count, noise, root.n);
    for (uint16_t k = 0; k < count; k++) {
        struct mh_root_turn turn;
        mh_root_turn_begin(&turn, root.n, sights[k].c, sights[k].innovation, 1);
        mh_gaussian_root_apply(&root, &turn);
        for (uint16_t m = (uint16_t)(k + 1); m < count; m++) {
            sights[m].innovation -= mh_root_turn_row(&turn, sights[m].c, root.n);
        }
    }
    return mh_gaussian_compose(gaussian, &root);
}
