#include "motehound/ukf.h"

#include <string.h>

#define SMALLEST 1.2e-38f /* of the normal floats */

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

/* What the transition makes of the sigma points on both sides of column i, as differences c_i and d_i / (2 gamma). `point` is the middle, before
 * and after. */
static enum mh_status move_pair(const struct mh_gaussian_root *root, const struct spread *spread,
                                const struct mh_transition *transition, const mh_real *middle, uint_fast8_t i,
                                mh_real *point, mh_real *c, mh_real *d)
{
    const uint8_t n = root->n;
    mh_real plus[MH_STATES_MAX], minus[MH_STATES_MAX];
    for (uint_fast8_t j = i; j < n; j++) {
        point[j] = root->x[j] + spread->gamma * root->L[MH_PACKED(i, j)];
    }
    enum mh_status status = transition->move(transition->context, point, plus, NULL);
    if (status != MH_OK) {
        return status;
    }
    for (uint_fast8_t j = i; j < n; j++) {
        point[j] = root->x[j] - spread->gamma * root->L[MH_PACKED(i, j)];
    }
    status = transition->move(transition->context, point, minus, NULL);
    for (uint_fast8_t j = 0; j < n; j++) {
        point[j] = root->x[j];
        c[j] = (plus[j] - minus[j]) * spread->first;
        d[j] = ((plus[j] - middle[j]) + (minus[j] - middle[j])) * spread->first;
    }
    return status;
}

enum mh_status mh_ukf_predict(struct mh_gaussian *gaussian, const struct mh_ukf_weights *weights,
                              const struct mh_transition *transition, const mh_real *Q)
{
    struct mh_gaussian_root root;
    struct mh_gaussian next = *gaussian;
    struct spread spread;
    mh_real point[MH_STATES_MAX], middle[MH_STATES_MAX], c[MH_STATES_MAX], d[MH_STATES_MAX];
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
    memcpy(point, root.x, n * sizeof point[0]);
    for (uint_fast8_t i = 0; i < n; i++) {
        status = move_pair(&root, &spread, transition, middle, i, point, c, d);
        if (status != MH_OK) {
            return status;
        }
        /* the sum of (d - mean) (d - mean)' grows by i / (i + 1) times that with the mean before (Welford) */
        const mh_real share = 1.0f / (mh_real)(i + 1);
        mh_real *p = next.P;
        for (uint_fast8_t j = 0; j < n; j++) {
            d[j] -= mean[j];
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

static enum mh_status look(struct sight *sight, const struct mh_gaussian_root *root, const struct spread *spread,
                           const struct mh_observations *observations, uint16_t k)
{
    const uint8_t n = root->n;
    mh_real point[MH_STATES_MAX], middle, sum = 0;
    enum mh_status status = observations->predict(observations->context, k, root->x, &middle, NULL);
    if (status != MH_OK) {
        return status;
    }
    if (!(observations->variance[k] >= SMALLEST)) {
        return MH_ERR_ARGUMENT;
    }
    memcpy(point, root->x, n * sizeof point[0]);
    for (uint_fast8_t i = 0; i < n; i++) {
        mh_real plus, minus;
        const mh_real *element = root->L + MH_PACKED(i, i);
        for (uint_fast8_t j = i; j < n; j++) {
            point[j] = root->x[j] + spread->gamma * *element;
            element += j + 1;
        }
        status = off_middle(observations, k, point, middle, &plus);
        if (status != MH_OK) {
            return status;
        }
        for (uint_fast8_t j = i; j < n; j++) {
            point[j] = root->x[j] + (root->x[j] - point[j]);
        }
        status = off_middle(observations, k, point, middle, &minus);
        if (status != MH_OK) {
            return status;
        }
        memcpy(point + i, root->x + i, (size_t)(n - i) * sizeof point[0]);
        sight->c[i] = (plus - minus) * spread->first;
        sight->d[i] = (plus + minus) * spread->first;
        sum += plus + minus;
    }
    const mh_real D = sum * spread->half, mean = sum * spread->first / (mh_real)n;
    for (uint_fast8_t i = 0; i < n; i++) {
        sight->d[i] -= mean;
    }
    sight->D = spread->bend * D;
    sight->innovation = observations->z[k] - middle - D;
    if (observations->wrap) {
        sight->innovation = observations->wrap(observations->context, k, sight->innovation);
    }
    return mh_finite(sight->innovation) ? MH_OK : MH_ERR_NOT_FINITE;
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
        status = look(&sight, &root, &spread, observations, k);
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

/* y = L^-1 (x - root.x) is of mean 0 and covariance I; what the sights, linear in it, make of that -> part. */
static void take_all(struct mh_gaussian_root *part, const struct sight *sights, uint16_t count, uint8_t n)
{
    memset(part, 0, sizeof *part);
    part->n = n;
    for (uint_fast8_t i = 0; i < n; i++) {
        part->L[MH_PACKED(i, i)] = 1;
    }
    for (uint16_t k = 0; k < count; k++) {
        mh_real c[MH_STATES_MAX], innovation = sights[k].innovation;
        for (uint_fast8_t i = 0; i < n; i++) {
            innovation -= sights[k].c[i] * part->x[i];
        }
        mh_gaussian_root_gradient(part, sights[k].c, c);
        mh_gaussian_root_take(part, c, innovation, 1);
    }
}

/* x += L y, L = L times the root of y. */
static void move_by(struct mh_gaussian_root *root, const struct mh_gaussian_root *part)
{
    mh_real *row = root->L;
    for (uint_fast8_t i = 0; i < root->n; i++) {
        for (uint_fast8_t j = 0; j <= i; j++) {
            mh_real sum = 0;
            root->x[i] += row[j] * part->x[j];
            for (uint_fast8_t k = j; k <= i; k++) {
                sum += row[k] * part->L[MH_PACKED(j, k)];
            }
            row[j] = sum;
        }
        row += i + 1;
    }
}

enum mh_status mh_ukf_update_stacked(struct mh_gaussian *gaussian, const struct mh_ukf_weights *weights,
                                     const struct mh_observations *observations)
{
    struct mh_gaussian_root root, part;
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
    mh_real *element = noise;
    for (uint16_t k = 0; k < count && status == MH_OK; k++) {
        status = look(&sights[k], &root, &spread, observations, k);
        for (uint16_t m = 0; m <= k && status == MH_OK; m++) {
            *element++ = curvature(&sights[k], &sights[m], root.n) + (m == k ? observations->variance[k] : 0);
        }
    }
    if (status == MH_OK) {
        status = mh_cholesky_factor_raised((int)count, noise, &raised);
    }
    if (status != MH_OK) {
        return status;
    }
    decorrelate(sights, count, noise, root.n);
    take_all(&part, sights, count, root.n);
    move_by(&root, &part);
    return mh_gaussian_compose(gaussian, &root);
}
