#include "motehound/gas_wind.h"

#define DIRECTIONS 3
#define HERMITE_NODE                                                                                                   \
    1.7320508f /* of three points, in standard deviations; the middle one has the weight 2/3, the others 1/6 */

void mh_gas_wind_config_default(struct mh_gas_wind_config *config)
{
    const struct mh_gas_wind_config nominal = {.place_sd_m = 3.0f,
                                               .mixing_m = 0.3f,
                                               .direction_sd_rad = 0.2f,
                                               .unit = 1.0f,
                                               .correlation = 10.0f,
                                               .background = {.quantile = 0.2f, .step = 0.03f},
                                               .learn = 3600000u,
                                               .memory = 14400000u};
    *config = nominal;
}

static bool valid(const struct mh_gas_wind_config *config)
{
    bool places = config->place_count >= 1 && config->place_count <= MH_LEAK_PLACES_MAX;
    for (uint16_t i = 0; places && i < config->place_count; i++) {
        places = mh_coordinate_valid(config->places[i].x_mm) && mh_coordinate_valid(config->places[i].y_mm);
    }
    return places && mh_within(config->place_sd_m, 0.01f, 1e3f) && mh_within(config->mixing_m, 1e-3f, 1e3f) &&
           mh_within(config->direction_sd_rad, 0, 1.0f) && mh_within(config->unit, 1e-9f, 1e9f) &&
           mh_within(config->correlation, 1.0f, 1e4f) && mh_within(config->background.quantile, 0.01f, 0.5f) &&
           mh_within(config->background.step, 1e-9f, 1e4f) && config->learn <= 2073600000u &&
           config->memory <= 2073600000u;
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_gas_wind *gas = state;
    const struct mh_gas_wind_config *given = config;
    if (gas == NULL || given == NULL || interval < 1 || interval > 3600000u || !valid(given)) {
        return MH_ERR_ARGUMENT;
    }
    gas->config = *given;
    for (uint16_t i = 0; i < given->place_count; i++) {
        gas->places[i] = mh_place_relative(&given->places[i], &given->places[0]);
    }
    mh_plume_regression_init(&gas->regression);
    gas->keep = given->memory > 0 ? mh_exp(-(mh_real)interval / (mh_real)given->memory) : 1.0f;
    gas->interval = interval;
    gas->sensor_count = 0;
    gas->blows[0] = gas->blows[1] = false;
    gas->stepped = gas->learned = gas->tracking = false;
    gas->begin = gas->time = 0;
    gas->crowded = 0;
    return MH_OK;
}

/* The y that belongs to the x at `at`, or NULL. */
static const struct mh_measurement *partner(const struct mh_measurement *measurements, size_t count, size_t at)
{
    for (size_t i = 0; i < count; i++) {
        const struct mh_measurement *m = &measurements[i];
        if (m->target == MH_TARGET_WIND_Y && m->node == measurements[at].node && m->time == measurements[at].time) {
            return m;
        }
    }
    return NULL;
}

/* Mean wind of all anemometers -> *wind. Returns false if there is none. */
static bool wind_of(const struct mh_measurement *measurements, size_t count, struct mh_vec2 *wind)
{
    struct mh_vec2 sum = {0, 0};
    mh_real anemometers = 0;
    for (size_t i = 0; i < count; i++) {
        const struct mh_measurement *y =
            measurements[i].target == MH_TARGET_WIND_X ? partner(measurements, count, i) : NULL;
        if (y != NULL) {
            sum.x += mh_q20_to_real(measurements[i].value);
            sum.y += mh_q20_to_real(y->value);
            anemometers += 1.0f;
        }
    }
    if (anemometers > 0) {
        wind->x = sum.x / anemometers;
        wind->y = sum.y / anemometers;
    }
    return anemometers > 0;
}

/* The plumes in the wind -> air[0 .. DIRECTIONS). */
static void blow(const struct mh_gas_wind_config *config, struct mh_vec2 wind, struct mh_plume_share *air)
{
    const mh_real speed = mh_sqrt(wind.x * wind.x + wind.y * wind.y);
    const struct mh_vec2 downwind = {speed > 0 ? wind.x / speed : 1.0f, speed > 0 ? wind.y / speed : 0};
    const mh_real felt = mh_max(speed, MH_GAS_CALM_MPS);
    for (int8_t i = 0; i < DIRECTIONS; i++) {
        const mh_real angle = (mh_real)(i - 1) * HERMITE_NODE * config->direction_sd_rad;
        const struct mh_vec2 turn = mh_direction(angle);
        air[i].plume.diffusion_m2ps = config->mixing_m * felt;
        air[i].plume.wind_mps = felt;
        air[i].plume.downwind.x = downwind.x * turn.x - downwind.y * turn.y;
        air[i].plume.downwind.y = downwind.x * turn.y + downwind.y * turn.x;
        air[i].share = i == 1 ? 2.0f / 3.0f : 1.0f / 6.0f;
    }
}

/* Time goes on to `time`, at which the wind is that of the measurements. Returns the number of plumes. */
static uint8_t breathe(struct mh_gas_wind *gas, mh_tick time, const struct mh_measurement *measurements, size_t count)
{
    gas->blows[1] = gas->blows[0] && gas->stepped && time - gas->time == gas->interval;
    for (uint8_t i = 0; i < DIRECTIONS; i++) {
        gas->air[DIRECTIONS + i] = gas->air[i];
    }
    struct mh_vec2 wind = {0, 0};
    gas->blows[0] = wind_of(measurements, count, &wind);
    if (!gas->blows[0]) {
        return 0;
    }
    blow(&gas->config, wind, gas->air);
    return gas->blows[1] ? 2 * DIRECTIONS : DIRECTIONS;
}

/* The background of a node's sensor; NULL if there is no room for it. */
static struct mh_background *background_of(struct mh_gas_wind *gas, mh_node_id node)
{
    for (uint16_t i = 0; i < gas->sensor_count; i++) {
        if (gas->sensors[i].node == node) {
            return &gas->sensors[i].background;
        }
    }
    if (gas->sensor_count == MH_LEAK_SENSORS_MAX) {
        return NULL;
    }
    gas->sensors[gas->sensor_count].node = node;
    gas->sensors[gas->sensor_count].background.known = false;
    return &gas->sensors[gas->sensor_count++].background;
}

/* Returns how many readings were used. */
static uint16_t take(struct mh_gas_wind *gas, const struct mh_measurement *measurements, size_t count, uint8_t plumes)
{
    uint16_t used = 0;
    struct mh_plume_share air[2 * DIRECTIONS];
    for (uint8_t i = 0; i < plumes; i++) {
        air[i] = gas->air[i];
        air[i].share *= 1.0f / (gas->config.unit * (plumes > DIRECTIONS ? 2.0f : 1.0f));
    }
    for (size_t i = 0; i < count; i++) {
        const struct mh_measurement *m = &measurements[i];
        struct mh_background *background = m->target == 0 ? background_of(gas, m->node) : NULL;
        mh_real excess;
        if (background == NULL) {
            gas->crowded += m->target == 0;
            continue;
        }
        const mh_real reading = mh_q20_to_real(m->value);
        const struct mh_vec2 sensor = mh_place_relative(&m->place, &gas->config.places[0]);
        if (mh_background_take(background, &gas->config.background, reading, &excess) == MH_OK && plumes > 0 &&
            mh_plume_regression_take(&gas->regression, gas->places, gas->config.place_count, air, plumes, sensor,
                                     excess) == MH_OK) {
            used++;
        }
    }
    return used;
}

static struct mh_estimate answer_at(const struct mh_gas_wind *gas, mh_tick time)
{
    const struct mh_sym2 spread = gas->fit.spread;
    const mh_real extent = mh_squared(gas->config.place_sd_m);
    const struct mh_estimate answer = {.origin = gas->config.places[gas->fit.place],
                                       .time = time,
                                       .covariance = {spread.xx + extent, spread.xy, spread.yy + extent},
                                       .states = 2,
                                       .rate = gas->fit.rate,
                                       .flags = MH_ESTIMATE_COASTED};
    return answer;
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_gas_wind *gas = state;
    if (gas == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (gas->stepped && !mh_tick_before(gas->time, time)) {
        return MH_ERR_TIME;
    }
    uint8_t plumes = breathe(gas, time, measurements, count);
    if (!gas->stepped) {
        gas->begin = time;
    }
    gas->stepped = true;
    gas->time = time;
    gas->learned = gas->learned || mh_ticks_between(gas->begin, time) >= (int32_t)gas->config.learn;
    if (!gas->learned) {
        plumes = 0;
    }
    mh_plume_regression_forget(&gas->regression, gas->keep);
    const uint16_t used = take(gas, measurements, count, plumes);
    const bool begins = !gas->tracking;
    gas->tracking = mh_plume_regression_solve(&gas->regression, gas->places, gas->config.place_count,
                                              gas->config.correlation, &gas->fit) == MH_OK;
    if (!gas->tracking) {
        return MH_NONE;
    }
    *estimate = answer_at(gas, time);
    estimate->measurements = used;
    estimate->flags = (uint8_t)((begins ? MH_ESTIMATE_STARTED : 0) | (used > 0 ? 0 : MH_ESTIMATE_COASTED));
    return MH_OK;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_gas_wind *gas = state;
    if (gas == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!gas->tracking) {
        return MH_NONE;
    }
    if (mh_tick_before(time, gas->time)) {
        return MH_ERR_TIME;
    }
    *estimate = answer_at(gas, time);
    return MH_OK;
}

const struct mh_tracker mh_tracker_gas_wind = {
    .name = "gas",
    .state_size = sizeof(struct mh_gas_wind),
    .config_size = sizeof(struct mh_gas_wind_config),
    .init = init,
    .step = step,
    .predict = predict,
};
