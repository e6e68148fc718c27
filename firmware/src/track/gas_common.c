#include "gas_common.h"

#define GRAINS 16.0f /* of information */
#define RATE 2       /* the state q, or ln q */

/* Beyond these an estimate has gone astray: products of them stay within float */
#define RATE_MAX 1e13f
#define LOG_RATE_MAX 30.0f
#define VARIANCE_MAX 1e13f /* of places, m2 */
#define LOG_VARIANCE_MAX 100.0f

void mh_gas_config_default(struct mh_gas_config *config)
{
    const struct mh_gas_config nominal = {
        .plume = {.diffusion_m2ps = 30.0f, .wind_mps = 1.0f, .downwind = {1.0f, 0.0f}},
        .noise = 0.003f,
        .unit = 0.001f,
        .area = {.x_min_mm = 0, .x_max_mm = 500000, .y_min_mm = 0, .y_max_mm = 400000},
        .prior = {.x_mm = 250000, .y_mm = 200000},
        .prior_sd_m = {150.0f, 120.0f},
        .prior_rate = 50.0f,
        .prior_rate_sd = 30.0f,
        .calm_step_m = 5.0f,
        .calm_sd_m = 10.0f,
        .ukf = {.alpha = 1.0f, .beta = 0.0f, .kappa = 0.0f},
    };
    *config = nominal;
}

static bool region_valid(const struct mh_region *region)
{
    return mh_coordinate_valid(region->x_min_mm) && mh_coordinate_valid(region->x_max_mm) &&
           mh_coordinate_valid(region->y_min_mm) && mh_coordinate_valid(region->y_max_mm) &&
           region->x_min_mm < region->x_max_mm && region->y_min_mm < region->y_max_mm;
}

enum mh_status mh_gas_valid(const struct mh_gas_config *config, mh_tick interval)
{
    const struct mh_plume *plume = &config->plume;
    const bool air = mh_within(plume->diffusion_m2ps, 1e-6f, 1e6f) && mh_within(plume->wind_mps, 0, 1e3f) &&
                     mh_within(mh_squared(plume->downwind.x) + mh_squared(plume->downwind.y), 0.998f, 1.002f);
    const bool sensors = mh_within(config->noise, 1e-9f, 1e9f) && mh_within(config->unit, 1e-12f, 1e12f);
    const bool prior = mh_coordinate_valid(config->prior.x_mm) && mh_coordinate_valid(config->prior.y_mm) &&
                       mh_within(config->prior_sd_m.x, 0.1f, 1e5f) && mh_within(config->prior_sd_m.y, 0.1f, 1e5f) &&
                       mh_within(config->prior_rate, 1e-9f, 1e9f) &&
                       mh_within(config->prior_rate_sd / config->prior_rate, 1e-4f, 1e4f);
    const bool calm = mh_within(config->calm_step_m, 1e-3f, 1e5f) && mh_within(config->calm_sd_m, 1e-3f, 1e5f);
    return interval >= 1 && interval <= 3600000u && air && sensors && prior && calm && region_valid(&config->area)
               ? MH_OK
               : MH_ERR_ARGUMENT;
}

bool mh_gas_is_sample(const struct mh_measurement *measurement) { return measurement->target < MH_TARGET_WIND_X; }

mh_real mh_gas_scale(const struct mh_gas_config *config) { return 1.0f / config->unit / config->noise; }

enum mh_status mh_gas_sample_of_rate(const void *samples, uint16_t k, const mh_real *x, mh_real *z, mh_real *gradient)
{
    const struct mh_gas_samples *taken = samples;
    const struct mh_vec2 source = {x[0], x[1]};
    mh_real c;
    struct mh_vec2 slope;
    const enum mh_status status = mh_plume_model(&taken->config->plume, taken->places[k], source, 0, &c, &slope);
    if (status != MH_OK) {
        return status;
    }
    const mh_real scale = mh_gas_scale(taken->config);
    const mh_real rate = x[RATE] * scale;
    *z = rate * c;
    if (gradient != NULL) {
        gradient[0] = rate * slope.x;
        gradient[1] = rate * slope.y;
        gradient[RATE] = scale * c;
    }
    return MH_OK;
}

enum mh_status mh_gas_sample_of_log_rate(const void *samples, uint16_t k, const mh_real *x, mh_real *z,
                                         mh_real *gradient)
{
    const mh_real rated[MH_GAS_STATES] = {x[0], x[1], mh_exp(x[RATE])};
    const enum mh_status status = mh_gas_sample_of_rate(samples, k, rated, z, gradient);
    if (status == MH_OK && gradient != NULL) {
        gradient[RATE] = *z;
    }
    return status;
}

static void prior_of(const struct mh_gas_config *config, mh_real mean, mh_real variance, struct mh_gaussian *prior)
{
    const struct mh_gaussian p = {
        .n = MH_GAS_STATES,
        .x = {0, 0, mean},
        .P = {mh_squared(config->prior_sd_m.x), 0, mh_squared(config->prior_sd_m.y), 0, 0, variance}};
    *prior = p;
}

void mh_gas_prior(const struct mh_gas_config *config, struct mh_gaussian *prior)
{
    prior_of(config, config->prior_rate, mh_squared(config->prior_rate_sd), prior);
}

void mh_gas_prior_of_log(const struct mh_gas_config *config, struct mh_gaussian *prior)
{
    const mh_real share = mh_squared(config->prior_rate_sd / config->prior_rate);
    const mh_real variance = share < 1e-3f ? share : mh_log(1.0f + share);
    prior_of(config, mh_log(config->prior_rate) - 0.5f * variance, variance, prior);
}

bool mh_gas_sane(const struct mh_gaussian *estimate, bool log)
{
    const mh_real *P = estimate->P;
    const mh_real rate = log ? LOG_RATE_MAX : RATE_MAX;
    return mh_within(estimate->x[0], -MH_GAS_FARTHEST_M, MH_GAS_FARTHEST_M) &&
           mh_within(estimate->x[1], -MH_GAS_FARTHEST_M, MH_GAS_FARTHEST_M) &&
           mh_within(estimate->x[RATE], -rate, rate) && P[MH_PACKED(0, 0)] <= VARIANCE_MAX &&
           P[MH_PACKED(1, 1)] <= VARIANCE_MAX &&
           P[MH_PACKED(RATE, RATE)] <= (log ? LOG_VARIANCE_MAX : RATE_MAX * RATE_MAX);
}

struct mh_estimate mh_gas_answer(const struct mh_gas_config *config, const struct mh_gaussian *estimate, bool log,
                                 bool stated, mh_tick time)
{
    const mh_real *P = estimate->P;
    const mh_real rate = log ? mh_exp(estimate->x[RATE]) : estimate->x[RATE];
    const mh_real unit = log ? rate : 1.0f; /* dq / d(state) */
    struct mh_estimate answer = {.origin = config->prior, .time = time, .rate = rate};
    answer.position.x = estimate->x[0];
    answer.position.y = estimate->x[1];
    answer.raw = answer.stored = answer.position;
    if (stated) {
        const struct mh_sym2 covariance = {P[MH_PACKED(0, 0)], P[MH_PACKED(0, 1)], P[MH_PACKED(1, 1)]};
        answer.covariance = covariance;
        answer.covariance_more[0] = unit * P[MH_PACKED(0, RATE)];
        answer.covariance_more[1] = unit * P[MH_PACKED(1, RATE)];
        answer.covariance_more[2] = unit * unit * P[MH_PACKED(RATE, RATE)];
        answer.states = MH_GAS_STATES;
    }
    return answer;
}

void mh_gas_flag(const struct mh_gas_config *config, struct mh_vec2 before, uint16_t taken, bool known, bool sure,
                 struct mh_estimate *estimate)
{
    const mh_real moved_sq = mh_squared(estimate->position.x - before.x) + mh_squared(estimate->position.y - before.y);
    const mh_real variance = estimate->covariance.xx + estimate->covariance.yy;
    const bool calm = moved_sq < mh_squared(config->calm_step_m) && (!sure || variance < mh_squared(config->calm_sd_m));
    const int flags = (known ? 0 : MH_ESTIMATE_STARTED) | (taken > 0 ? MH_ESTIMATE_REFRESHED : MH_ESTIMATE_COASTED) |
                      (taken > 0 && calm ? MH_ESTIMATE_CALM : 0);
    estimate->flags = (uint8_t)flags;
    estimate->measurements = taken;
}

/* det(P^-1 + sum h h') det(P) is the product of 1 + h' P h, with P updated by each h in turn. */
mh_real mh_gas_information(const struct mh_gas_config *config, const struct mh_gaussian *estimate,
                           const struct mh_place *places, size_t count)
{
    struct mh_gaussian_root root;
    if (mh_gaussian_factor(&root, estimate) != MH_OK) {
        return 0;
    }
    const struct mh_vec2 source = {estimate->x[0], estimate->x[1]};
    const mh_real spread = estimate->P[MH_PACKED(0, 0)] + estimate->P[MH_PACKED(1, 1)];
    const mh_real rate = mh_exp(estimate->x[RATE]) * mh_gas_scale(config);
    mh_real information = 0;
    for (size_t i = 0; i < count; i++) {
        mh_real c;
        struct mh_vec2 slope;
        if (mh_plume_model(&config->plume, mh_place_relative(&places[i], &config->prior), source, spread, &c, &slope) !=
            MH_OK) {
            continue;
        }
        const mh_real h[MH_GAS_STATES] = {rate * slope.x, rate * slope.y, rate * c};
        mh_real along[MH_GAS_STATES];
        mh_gaussian_root_gradient(&root, h, along);
        const mh_real gain = 1.0f + mh_squared(along[0]) + mh_squared(along[1]) + mh_squared(along[2]);
        if (mh_finite(gain)) {
            information += mh_log(gain);
            mh_gaussian_root_take(&root, along, 0, 1.0f);
        }
    }
    return (mh_real)(int32_t)(information * GRAINS + 0.5f) / GRAINS;
}
