/* What the tests of the filters observe: ranges and bearings in the plane, gas in the wind, and linear forms. */
#ifndef FILTER_MODELS_H
#define FILTER_MODELS_H

#include "motehound/gaussian.h"
#include "motehound/observations.h"
#include "motehound/plume.h"
#include "unity.h"

#include <math.h>

static uint32_t seed;

/* uniform in -1 to 1 */
static inline mh_real draw(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (mh_real)(int32_t)(seed >> 8) * (2.0f / 16777216.0f) - 1.0f;
}

/* where there is no sinf, sin is of float (AVR) */
static inline mh_real sine(mh_real angle) { return (mh_real)sinf(angle); }
static inline mh_real cosine(mh_real angle) { return (mh_real)cosf(angle); }

/* x at random, P = B B' + I / 10 */
static inline void draw_gaussian(struct mh_gaussian *g, uint8_t n)
{
    mh_real B[4][4];
    g->n = n;
    for (int i = 0; i < n; i++) {
        g->x[i] = 10 * draw();
        for (int j = 0; j < n; j++) {
            B[i][j] = draw();
        }
        for (int j = 0; j <= i; j++) {
            mh_real sum = i == j ? 0.1f : 0;
            for (int k = 0; k < n; k++) {
                sum += B[i][k] * B[j][k];
            }
            g->P[mh_packed_index(i, j)] = sum;
        }
    }
}

/* Places of sensors; the state is (x, vx, y, vy). */
struct places {
    const struct mh_vec2 *at;
};

static inline enum mh_status predict_range(const void *context, uint16_t k, const mh_real *x, mh_real *z,
                                           mh_real *gradient)
{
    const struct places *places = context;
    const mh_real dx = x[0] - places->at[k].x, dy = x[2] - places->at[k].y;
    *z = mh_sqrt(dx * dx + dy * dy);
    if (gradient) {
        gradient[0] = dx / *z;
        gradient[2] = dy / *z;
        gradient[1] = gradient[3] = 0;
    }
    return MH_OK;
}

static inline enum mh_status predict_bearing(const void *context, uint16_t k, const mh_real *x, mh_real *z,
                                             mh_real *gradient)
{
    const struct places *places = context;
    const mh_real dx = x[0] - places->at[k].x, dy = x[2] - places->at[k].y;
    *z = mh_atan2(dy, dx);
    if (gradient) {
        gradient[0] = -dy / (dx * dx + dy * dy);
        gradient[2] = dx / (dx * dx + dy * dy);
        gradient[1] = gradient[3] = 0;
    }
    return MH_OK;
}

static inline mh_real wrap_angle(const void *context, uint16_t k, mh_real difference)
{
    (void)context;
    (void)k;
    return difference > MH_PI ? difference - 2 * MH_PI : difference < -MH_PI ? difference + 2 * MH_PI : difference;
}

/* Rows of four coefficients, and the curvature that is added: z_k = h_k . x + curve x_0^2 */
struct forms {
    const mh_real (*h)[4];
    uint8_t n;
    mh_real curve;
};

static inline enum mh_status predict_form(const void *context, uint16_t k, const mh_real *x, mh_real *z,
                                          mh_real *gradient)
{
    const struct forms *forms = context;
    *z = forms->curve * x[0] * x[0];
    for (int i = 0; i < forms->n; i++) {
        *z += forms->h[k][i] * x[i];
        if (gradient) {
            gradient[i] = forms->h[k][i] + (i == 0 ? 2 * forms->curve * x[0] : 0);
        }
    }
    return MH_OK;
}

/* The published update (Zhang): six sensors in the plume of a source at (50, 0) that releases 30; the state is (xs, ys, q) or (xs, ys, ln q). */
enum { GAS_SENSORS = 6 };

struct gas {
    bool logarithmic;
    mh_real z[GAS_SENSORS], variance[GAS_SENSORS];
};

static inline enum mh_status predict_gas(const void *context, uint16_t k, const mh_real *x, mh_real *z,
                                         mh_real *gradient)
{
    const struct gas *gas = context;
    const struct mh_plume plume = {30.0f, 1.0f, {1, 0}};
    const struct mh_vec2 sensor = {430.0f + 12.0f * (mh_real)k, 30.0f * cosine(1.3f * (mh_real)k)},
                         source = {x[0], x[1]};
    const mh_real rate = gas->logarithmic ? mh_exp(x[2]) : x[2];
    struct mh_vec2 by_source;
    mh_real unit;
    const enum mh_status status = mh_plume_model(&plume, sensor, source, 0, &unit, gradient ? &by_source : NULL);
    *z = rate * unit;
    if (status == MH_OK && gradient) {
        gradient[0] = rate * by_source.x;
        gradient[1] = rate * by_source.y;
        gradient[2] = gas->logarithmic ? *z : unit;
    }
    return status;
}

/* The prior and what was measured; `gas` is the observations' memory. */
static inline struct mh_observations gas_begin(struct gas *gas, struct mh_gaussian *prior, bool logarithmic)
{
    const mh_real truth[3] = {50, 0, logarithmic ? mh_log(30) : 30};
    const mh_real s2 = mh_log(1 + 0.36f); /* of ln q, by moments: mean 50, standard deviation 30 */
    const struct mh_observations observations = {GAS_SENSORS, gas->z, gas->variance, gas, predict_gas, NULL};
    const struct mh_gaussian nominal = {
        3, {250, 0, logarithmic ? mh_log(50) - s2 / 2 : 50}, {22500, 0, 14400, 0, 0, logarithmic ? s2 : 900}};
    *prior = nominal;
    gas->logarithmic = logarithmic;
    for (uint16_t k = 0; k < GAS_SENSORS; k++) {
        predict_gas(gas, k, truth, &gas->z[k], NULL);
        gas->z[k] += 1e-4f * sine(2.0f * (mh_real)k + 1.0f);
        gas->variance[k] = 1e-8f;
    }
    return observations;
}

/* answer: x, y, q, then the variances of those, then their covariances xy, xq, yq; each within `share` of it, or of the largest it could be. */
static inline void assert_gas(const mh_real answer[9], const struct mh_gaussian *g, mh_real share)
{
    static const uint8_t of_packed[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_FLOAT_WITHIN(share * mh_max(mh_abs(answer[i]), mh_sqrt(answer[3 + i])), answer[i], g->x[i]);
    }
    for (int i = 0; i < 6; i++) {
        const uint8_t a = of_packed[i][0], b = of_packed[i][1];
        TEST_ASSERT_FLOAT_WITHIN(share * mh_sqrt(answer[3 + a] * answer[3 + b]), answer[3 + i], g->P[MH_PACKED(a, b)]);
    }
}

/* The published update (Xu): clusters of three and six sensors measure the range of a target that has moved for a second. */
struct cluster {
    uint16_t count;
    struct mh_vec2 at[6];
    mh_real variance;
    mh_real answer[14]; /* x, then P row by row from the diagonal on */
};

static inline struct mh_observations cluster_begin(const struct cluster *cluster, struct places *places, mh_real *z,
                                                   mh_real *variance, struct mh_gaussian *g)
{
    const mh_real truth[4] = {10.9f, 0.82f, 20.5f, 0.58f};
    const struct mh_observations observations = {cluster->count, z, variance, places, predict_range, NULL};
    const struct mh_gaussian start = {4, {10, 0.8f, 20, 0.6f}, {1, 0, 0.04f, 0, 0, 1, 0, 0, 0, 0.04f}};
    const mh_real F[16] = {1, 0.5f, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.5f, 0, 0, 0, 1};
    const mh_real Q[10] = {7.8125e-7f, 3.125e-6f, 1.25e-5f, 0, 0, 1.5625e-6f, 0, 0, 6.25e-6f, 2.5e-5f};
    *g = start;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_predict(g, F, Q));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_predict(g, F, Q));
    places->at = cluster->at;
    for (uint16_t k = 0; k < cluster->count; k++) {
        predict_range(places, k, truth, &z[k], NULL);
        z[k] += 0.1f * sine(1.0f + 2.0f * (mh_real)k);
        variance[k] = cluster->variance;
    }
    return observations;
}

static inline void assert_cluster(const struct cluster *cluster, const struct mh_gaussian *g, mh_real tolerance)
{
    const mh_real *answer = cluster->answer;
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_FLOAT_WITHIN(tolerance, *answer++, g->x[i]);
    }
    for (int i = 0; i < 4; i++) {
        for (int j = i; j < 4; j++) {
            TEST_ASSERT_FLOAT_WITHIN(tolerance, *answer++, g->P[MH_PACKED(i, j)]);
        }
    }
}

#endif
