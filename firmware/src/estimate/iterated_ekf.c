#include "motehound/iterated_ekf.h"

#include <string.h>

#define DAMPING_MIN 1e-9f
#define TRIES_MAX 12 /* in succession that do not lower f */

/* f around a place y: |R step - d|^2 and a constant, with R upper triangular, packed. */
struct quadratic {
    mh_real y[MH_STATES_MAX];
    mh_real R[MH_PACKED_SIZE(MH_STATES_MAX)];
    mh_real d[MH_STATES_MAX];
    mh_real cost; /* f at y */
};

/* One more equation, row . step = d, rotated into R. */
static void rotate(struct quadratic *f, uint8_t n, mh_real *row, mh_real d)
{
    for (uint_fast8_t i = 0; i < n; i++) {
        if (row[i] == 0) {
            continue;
        }
        mh_real *element = f->R + MH_PACKED(i, i);
        const mh_real inverse = 1.0f / mh_sqrt(mh_squared(*element) + mh_squared(row[i]));
        const mh_real cosine = *element * inverse, sine = row[i] * inverse;
        for (uint_fast8_t j = i; j < n; j++) {
            const mh_real kept = *element;
            *element = cosine * kept + sine * row[j];
            row[j] = cosine * row[j] - sine * kept;
            element += j + 1;
        }
        const mh_real kept = f->d[i];
        f->d[i] = cosine * kept + sine * d;
        d = cosine * d - sine * kept;
    }
}

/* x = x0 + L y */
static void state_of(const struct mh_gaussian_root *prior, const mh_real *y, mh_real *x)
{
    memcpy(x, y, prior->n * sizeof x[0]);
    mh_lower_multiply(prior->n, prior->L, x);
    for (uint_fast8_t i = 0; i < prior->n; i++) {
        x[i] += prior->x[i];
    }
}

/* y = L^-1 (x - x0) */
static void place_of(const struct mh_gaussian_root *prior, const mh_real *x, mh_real *y)
{
    for (uint_fast8_t i = 0; i < prior->n; i++) {
        y[i] = x[i] - prior->x[i];
    }
    mh_lower_solve(prior->n, prior->L, y);
}

/* f at f->y, with all models linearised there. */
static enum mh_status linearise(struct quadratic *f, const struct mh_gaussian_root *prior,
                                const struct mh_observations *observations)
{
    const uint8_t n = prior->n;
    mh_real x[MH_STATES_MAX];
    state_of(prior, f->y, x);
    memset(f->R, 0, sizeof f->R);
    f->cost = 0;
    for (uint_fast8_t i = 0; i < n; i++) {
        f->R[MH_PACKED(i, i)] = 1;
        f->d[i] = -f->y[i];
        f->cost += mh_squared(f->y[i]);
    }
    for (uint16_t k = 0; k < observations->count; k++) {
        mh_real h[MH_STATES_MAX], row[MH_STATES_MAX], z;
        const enum mh_status status = observations->predict(observations->context, k, x, &z, h);
        if (status != MH_OK) {
            return status;
        }
        if (!(observations->variance[k] >= MH_REAL_MIN)) {
            return MH_ERR_ARGUMENT;
        }
        mh_real residual = observations->z[k] - z;
        if (observations->wrap) {
            residual = observations->wrap(observations->context, k, residual);
        }
        const mh_real weight = 1.0f / mh_sqrt(observations->variance[k]);
        for (uint_fast8_t i = 0; i < n; i++) {
            h[i] *= weight;
        }
        residual *= weight;
        f->cost += mh_squared(residual);
        mh_gaussian_root_gradient(prior, h, row);
        rotate(f, n, row, residual);
    }
    return mh_finite(f->cost) ? MH_OK : MH_ERR_NOT_FINITE;
}

/* y after the step that minimises |R step - d|^2 + damping sum_i J_ii step_i^2, J = R' R */
static void damped_step(const struct quadratic *f, uint8_t n, mh_real damping, mh_real *y)
{
    struct quadratic damped = *f;
    for (uint_fast8_t j = 0; j < n; j++) {
        mh_real row[MH_STATES_MAX] = {0}, sum = 0;
        for (uint_fast8_t i = 0; i <= j; i++) {
            sum += mh_squared(f->R[MH_PACKED(i, j)]);
        }
        row[j] = mh_sqrt(damping * sum);
        rotate(&damped, n, row, 0);
    }
    for (uint_fast8_t j = n; j-- > 0;) {
        const mh_real *column = damped.R + MH_PACKED(0, j);
        const mh_real step = damped.d[j] / column[j];
        for (uint_fast8_t i = 0; i < j; i++) {
            damped.d[i] -= column[i] * step;
        }
        y[j] = f->y[j] + step;
    }
}

/* x = x0 + L y, P = V V' with V R = L */
static enum mh_status conclude(struct mh_gaussian *posterior, const struct mh_gaussian_root *prior,
                               const struct quadratic *f)
{
    const uint8_t n = prior->n;
    mh_real V[MH_STATES_MAX][MH_STATES_MAX];
    mh_real *p = posterior->P;
    const mh_real *row = prior->L;
    state_of(prior, f->y, posterior->x);
    for (uint_fast8_t i = 0; i < n; i++) {
        for (uint_fast8_t j = 0; j < n; j++) {
            mh_real sum = j <= i ? *row++ : 0;
            for (uint_fast8_t k = 0; k < j; k++) {
                sum -= V[i][k] * f->R[MH_PACKED(k, j)];
            }
            V[i][j] = sum / f->R[MH_PACKED(j, j)];
        }
        for (uint_fast8_t j = 0; j <= i; j++) {
            mh_real sum = 0;
            for (uint_fast8_t k = 0; k < n; k++) {
                sum += V[i][k] * V[j][k];
            }
            *p++ = sum;
        }
    }
    return mh_gaussian_settle(posterior);
}

enum mh_status mh_iterated_ekf_update(struct mh_gaussian *gaussian, const struct mh_iterated_ekf_config *config,
                                      const mh_real *start, const struct mh_observations *observations, mh_real *cost)
{
    struct mh_gaussian_root prior;
    struct quadratic best, trial;
    enum mh_status status = mh_gaussian_factor(&prior, gaussian);
    if (status == MH_OK && (config->iterations < 1 || !(config->damping >= 0) || !(config->settled >= 0))) {
        status = MH_ERR_ARGUMENT;
    }
    if (status == MH_OK) {
        place_of(&prior, start ? start : prior.x, best.y);
        status = linearise(&best, &prior, observations);
    }
    if (status != MH_OK) {
        return status;
    }
    mh_real damping = config->damping;
    bool moving = true;
    uint_fast8_t tries = 0;
    for (uint_fast8_t i = 0; i < config->iterations && moving; i++) {
        damped_step(&best, prior.n, damping, trial.y);
        if (linearise(&trial, &prior, observations) == MH_OK && trial.cost <= best.cost) {
            moving = best.cost - trial.cost >= config->settled * (1.0f + best.cost);
            best = trial;
            damping = mh_max(0.1f * damping, DAMPING_MIN);
            tries = 0;
        } else {
            damping = mh_max(10.0f * damping, DAMPING_MIN);
            tries++;
            moving = tries < TRIES_MAX;
        }
    }
    struct mh_gaussian posterior = *gaussian;
    status = conclude(&posterior, &prior, &best);
    if (status == MH_OK) {
        *gaussian = posterior;
        if (cost) {
            *cost = best.cost;
        }
    }
    return status;
}
