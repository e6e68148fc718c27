#include "motehound/range.h"

#include "motehound/multilateration.h"
#include "motehound/range_model.h"

#define LOST_TICKS (10 * (int32_t)MH_TICKS_PER_S)
#define SPEED_BUILD_UP_S 5.0f /* a target's speed is what its acceleration builds up in this time */
#define GATE_SIGMAS 3.0f
#define GATE_PATIENCE 10   /* ranges */
#define RESTART_PATIENCE 5 /* instants */

void mh_range_config_default(struct mh_range_config *config)
{
    const struct mh_range_config nominal = {.range_sd_m = 0.3f, .acceleration_sd_mps2 = 1.0f, .height_m = 1.0f};
    *config = nominal;
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_range *range = state;
    const struct mh_range_config *given = config;
    if (range == NULL || given == NULL || interval < 1 || interval > 3600000u ||
        !mh_within(given->range_sd_m, 1e-3f, 100.0f) || !mh_within(given->acceleration_sd_mps2, 1e-3f, 1e3f) ||
        !mh_within(given->height_m, -1e5f, 1e5f)) {
        return MH_ERR_ARGUMENT;
    }
    const struct mh_range begun = {.config = *given, .gate = {.sigmas = GATE_SIGMAS, .patience = GATE_PATIENCE}};
    *range = begun;
    return MH_OK;
}

/* Move `filter` on in time by `ticks`. */
static enum mh_status advance(const struct mh_range *range, struct mh_kalman *filter, int32_t ticks)
{
    const mh_real a = range->config.acceleration_sd_mps2;
    mh_real F[16];
    mh_real Q[10];
    mh_kalman_constant_velocity((mh_real)ticks / (mh_real)MH_TICKS_PER_S, a * a, F, Q);
    return mh_kalman_predict(filter, F, Q);
}

/* How many ranges agree on a start; 0 for none. */
static uint16_t start(struct mh_range *range, const struct mh_measurement *measurements, size_t count)
{
    if (count == 0) {
        return 0;
    }
    struct mh_place origin = measurements[0].place;
    struct mh_fix fix;
    if (mh_multilaterate(measurements, count, &origin, range->config.height_m, range->config.range_sd_m, &fix) !=
        MH_OK) {
        return 0;
    }
    const mh_real speed_sd = SPEED_BUILD_UP_S * range->config.acceleration_sd_mps2;
    const mh_real x[4] = {fix.position.x, fix.position.y, 0, 0};
    const mh_real P[10] = {fix.covariance.xx,  fix.covariance.xy, fix.covariance.yy, 0, 0, speed_sd * speed_sd, 0, 0, 0,
                           speed_sd * speed_sd};
    if (mh_kalman_init(&range->filter, 4, x, P) != MH_OK) {
        return 0;
    }
    origin.z_mm = (int32_t)(range->config.height_m * 1000.0f);
    range->origin = origin;
    range->updated = range->accepted = measurements[count - 1].time;
    range->gate.refused = 0;
    range->doubted = 0;
    return fix.agreeing;
}

/* True if the range was taken. */
static bool take(struct mh_range *range, const struct mh_measurement *m)
{
    const int32_t ticks = mh_ticks_between(range->updated, m->time);
    if (m->value <= 0 || ticks < 0) {
        return false;
    }
    struct mh_kalman next = range->filter;
    if (ticks > 0 && advance(range, &next, ticks) != MH_OK) {
        return false;
    }
    const struct mh_vec2 position = {next.x[0], next.x[1]};
    const mh_real rise = range->config.height_m - (mh_real)m->place.z_mm * 0.001f;
    mh_real predicted;
    struct mh_vec2 gradient;
    if (mh_range_model(position, mh_place_relative(&m->place, &range->origin), rise, &predicted, &gradient) != MH_OK) {
        return false;
    }
    const mh_real h[4] = {gradient.x, gradient.y, 0, 0};
    const mh_real variance = range->config.range_sd_m * range->config.range_sd_m;
    if (mh_kalman_update(&next, h, mh_q20_to_real(m->value) - predicted, variance, &range->gate) != MH_OK) {
        return false;
    }
    range->filter = next;
    range->updated = range->accepted = m->time;
    return true;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_range *range = state;
    if (range == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!range->tracking) {
        return MH_NONE;
    }
    if (mh_tick_before(time, range->time)) {
        return MH_ERR_TIME;
    }
    struct mh_kalman filter = range->filter;
    if (advance(range, &filter, mh_ticks_between(range->updated, time)) != MH_OK) {
        return MH_NONE;
    }
    mh_real P[10];
    mh_kalman_covariance(&filter, P);
    const struct mh_vec2 position = {filter.x[0], filter.x[1]};
    const struct mh_estimate answer = {
        .origin = range->origin,
        .time = time,
        .position = position,
        .velocity = {filter.x[2], filter.x[3]},
        .covariance = {P[MH_PACKED(0, 0)], P[MH_PACKED(0, 1)], P[MH_PACKED(1, 1)]},
        .raw = position,
        .flags = MH_ESTIMATE_COASTED,
    };
    *estimate = answer;
    return MH_OK;
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_range *range = state;
    if (range == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (range->stepped && !mh_tick_before(range->time, time)) {
        return MH_ERR_TIME;
    }
    range->stepped = true;
    range->time = time;
    while (count > 0 && mh_tick_before(time, measurements[count - 1].time)) {
        count--;
    }
    if (range->tracking && mh_ticks_between(range->accepted, time) > LOST_TICKS) {
        range->tracking = false;
    }
    uint16_t taken = 0;
    bool started = false;
    if (range->tracking) {
        for (size_t i = 0; i < count; i++) {
            taken = (uint16_t)(taken + (take(range, &measurements[i]) ? 1 : 0));
        }
        if (count > 0) {
            range->doubted = 2u * taken >= count ? 0 : (uint8_t)(range->doubted + (range->doubted < RESTART_PATIENCE));
        }
    }
    if (!range->tracking || range->doubted == RESTART_PATIENCE) {
        const uint16_t agreeing = start(range, measurements, count);
        if (agreeing > 0) {
            range->tracking = started = true;
            taken = agreeing;
        }
    }
    const enum mh_status status = predict(range, time, estimate);
    if (status == MH_OK) {
        estimate->measurements = taken;
        estimate->flags = (uint8_t)((started ? MH_ESTIMATE_STARTED : 0) | (taken == 0 ? MH_ESTIMATE_COASTED : 0));
    }
    return status;
}

const struct mh_tracker mh_tracker_range = {
    .name = "range",
    .state_size = sizeof(struct mh_range),
    .config_size = sizeof(struct mh_range_config),
    .init = init,
    .step = step,
    .predict = predict,
};
