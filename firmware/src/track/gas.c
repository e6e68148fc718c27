#include "gas_common.h"
#include "motehound/bytes.h"
#include "motehound/iterated_ekf.h"
#include "motehound/plume_search.h"

#include <string.h>

#define ITERATIONS 30
#define PLACE_MAX_MM 8388607 /* 24 bits with a sign */
#define MEAN_MAX 2048.0f     /* of what a sensor can read, Q11.20 */
#define OFTEN UINT8_MAX

static enum mh_status init(void *state, const void *given, mh_tick interval)
{
    struct mh_gas *gas = state;
    const struct mh_gas_config *config = given;
    if (gas == NULL || config == NULL || mh_gas_valid(config, interval) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    memset(gas, 0, sizeof *gas);
    gas->config = *config;
    mh_gas_prior_of_log(config, &gas->estimate);
    return MH_OK;
}

static struct mh_vec2 place_of(const struct mh_gas_sensor *sensor)
{
    const struct mh_vec2 place = {(mh_real)sensor->x_mm * 0.001f, (mh_real)sensor->y_mm * 0.001f};
    return place;
}

/* How much the mean of a sensor adds to what is known, h' P h / R at the estimate; whose share is least can go. */
static mh_real share_of(const struct mh_gas *gas, const struct mh_gas_sensor *sensor)
{
    const struct mh_vec2 place = place_of(sensor);
    const struct mh_gas_samples context = {&gas->config, &place};
    const mh_real *P = gas->estimate.P;
    mh_real z;
    mh_real h[MH_GAS_STATES];
    if (mh_gas_sample_of_log_rate(&context, 0, gas->estimate.x, &z, h) != MH_OK) {
        return 0;
    }
    const mh_real squares =
        P[MH_PACKED(0, 0)] * h[0] * h[0] + P[MH_PACKED(1, 1)] * h[1] * h[1] + P[MH_PACKED(2, 2)] * h[2] * h[2];
    const mh_real products =
        P[MH_PACKED(0, 1)] * h[0] * h[1] + P[MH_PACKED(0, 2)] * h[0] * h[2] + P[MH_PACKED(1, 2)] * h[1] * h[2];
    return (mh_real)sensor->samples * (squares + 2.0f * products);
}

/* The record of the measuring node, a new one if need be in place of the one that tells least. NULL: it is too far away. */
static struct mh_gas_sensor *record_of(struct mh_gas *gas, const struct mh_measurement *m)
{
    const struct mh_place *prior = &gas->config.prior;
    const int64_t x = (int64_t)m->place.x_mm - prior->x_mm;
    const int64_t y = (int64_t)m->place.y_mm - prior->y_mm;
    if (x < -PLACE_MAX_MM || x > PLACE_MAX_MM || y < -PLACE_MAX_MM || y > PLACE_MAX_MM) {
        return NULL;
    }
    const struct mh_gas_sensor fresh = {.node = m->node, .x_mm = (int32_t)x, .y_mm = (int32_t)y};
    for (uint16_t i = 0; i < gas->count; i++) {
        struct mh_gas_sensor *sensor = &gas->sensors[i];
        if (sensor->node == m->node) {
            if (sensor->x_mm != fresh.x_mm || sensor->y_mm != fresh.y_mm) {
                *sensor = fresh; /* it has been put elsewhere */
            }
            return sensor;
        }
    }
    if (gas->count < MH_GAS_SENSORS_MAX) {
        gas->sensors[gas->count] = fresh;
        return &gas->sensors[gas->count++];
    }
    uint16_t least = 0;
    mh_real share = share_of(gas, &gas->sensors[0]);
    for (uint16_t i = 1; i < gas->count; i++) {
        const mh_real other = share_of(gas, &gas->sensors[i]);
        if (other < share) {
            least = i;
            share = other;
        }
    }
    gas->sensors[least] = fresh;
    return &gas->sensors[least];
}

static void count_once(uint8_t *count) { *count = (uint8_t)(*count + (*count < OFTEN ? 1 : 0)); }

/* Merge the samples into the means. Returns how many were taken. */
static uint16_t take(struct mh_gas *gas, const struct mh_measurement *measurements, size_t count)
{
    uint16_t taken = 0;
    for (size_t i = 0; i < count && taken < UINT16_MAX; i++) {
        struct mh_gas_sensor *sensor = mh_gas_is_sample(&measurements[i]) ? record_of(gas, &measurements[i]) : NULL;
        if (sensor == NULL) {
            continue;
        }
        if (i == 0) {
            count_once(&sensor->heads);
        }
        count_once(&sensor->samples);
        sensor->mean += (mh_q20_to_real(measurements[i].value) - sensor->mean) / (mh_real)sensor->samples;
        taken++;
    }
    return taken;
}

static struct mh_vec2 corner(const struct mh_gas_config *config, int32_t x_mm, int32_t y_mm)
{
    const struct mh_vec2 place = {((mh_real)x_mm - (mh_real)config->prior.x_mm) * 0.001f,
                                  ((mh_real)y_mm - (mh_real)config->prior.y_mm) * 0.001f};
    return place;
}

/* Where the grid finds places likely that the Gaussian at the most probable one does not reach, its moments about that one are what is known. */
static void widen(const struct mh_gas_config *config, const struct mh_plume_search *search,
                  struct mh_gaussian *estimate)
{
    const mh_real *P = estimate->P;
    const mh_real spread = search->variance[0] + search->variance[1];
    if (!(spread > mh_max(mh_squared(config->calm_sd_m), P[MH_PACKED(0, 0)] + P[MH_PACKED(1, 1)]))) {
        return;
    }
    mh_real wide[MH_PACKED_SIZE(MH_GAS_STATES)] = {0};
    for (int i = 0; i < MH_GAS_STATES; i++) {
        const int diagonal = MH_PACKED(i, i);
        wide[diagonal] = mh_max(search->variance[i] + mh_squared(search->mean[i] - estimate->x[i]), P[diagonal]);
    }
    memcpy(estimate->P, wide, sizeof wide);
}

/* The most probable place and rate, from the prior and all that is known of the sensors. */
static enum mh_status solve(const struct mh_gas *gas, struct mh_gaussian *estimate)
{
    static const struct mh_iterated_ekf_config method = {.iterations = ITERATIONS, .damping = 0.01f, .settled = 1e-6f};
    const struct mh_gas_config *config = &gas->config;
    struct mh_vec2 places[MH_GAS_SENSORS_MAX];
    mh_real z[MH_GAS_SENSORS_MAX], weight[MH_GAS_SENSORS_MAX], variance[MH_GAS_SENSORS_MAX];
    for (uint16_t i = 0; i < gas->count; i++) {
        places[i] = place_of(&gas->sensors[i]);
        z[i] = gas->sensors[i].mean / config->noise;
        weight[i] = (mh_real)gas->sensors[i].samples;
    }
    struct mh_gaussian prior;
    mh_gas_prior_of_log(config, &prior);
    const struct mh_plume_problem problem = {
        .plume = &config->plume,
        .low = corner(config, config->area.x_min_mm, config->area.y_min_mm),
        .high = corner(config, config->area.x_max_mm, config->area.y_max_mm),
        .prior = {prior.x[0], prior.x[1], prior.x[2]},
        .variance = {prior.P[MH_PACKED(0, 0)], prior.P[MH_PACKED(1, 1)], prior.P[MH_PACKED(2, 2)]},
        .count = gas->count,
        .places = places,
        .z = z,
        .weight = weight,
        .scale = mh_gas_scale(config),
    };
    struct mh_plume_search search;
    enum mh_status status = mh_plume_search(&problem, variance, &search);
    if (status != MH_OK) {
        return status;
    }
    for (uint16_t i = 0; i < gas->count; i++) {
        variance[i] = 1.0f / weight[i];
    }
    const struct mh_gas_samples context = {config, places};
    const struct mh_observations samples = {
        .count = gas->count, .z = z, .variance = variance, .context = &context, .predict = mh_gas_sample_of_log_rate};
    mh_real least = 0;
    status = MH_ERR_NOT_FINITE;
    for (int i = -1; i < (int)search.starts; i++) {
        struct mh_gaussian found = prior;
        mh_real cost;
        if (mh_iterated_ekf_update(&found, &method, i < 0 ? gas->estimate.x : search.start[i], &samples, &cost) ==
                MH_OK &&
            mh_gas_sane(&found, true) && (status != MH_OK || cost < least)) {
            *estimate = found;
            least = cost;
            status = MH_OK;
        }
    }
    if (status == MH_OK) {
        widen(config, &search, estimate);
        status = mh_gas_sane(estimate, true) ? MH_OK : MH_ERR_NOT_FINITE;
    }
    return status;
}

static void restart(void *state)
{
    struct mh_gas *gas = state;
    mh_gas_prior_of_log(&gas->config, &gas->estimate);
    gas->count = 0;
    gas->known = gas->stated = false;
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_gas *gas = state;
    if (gas == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (gas->stepped && !mh_tick_before(gas->time, time)) {
        return MH_ERR_TIME;
    }
    gas->stepped = true;
    gas->time = time;
    const struct mh_vec2 before = {gas->estimate.x[0], gas->estimate.x[1]};
    const uint16_t taken = take(gas, measurements, count);
    if (taken == 0 && !gas->known) {
        return MH_NONE;
    }
    if (taken > 0) {
        struct mh_gaussian found;
        if (solve(gas, &found) != MH_OK) {
            restart(gas);
            return MH_NONE;
        }
        gas->estimate = found;
        gas->stated = true;
    }
    *estimate = mh_gas_answer(&gas->config, &gas->estimate, true, gas->stated, time);
    mh_gas_flag(&gas->config, before, taken, gas->known, true, estimate);
    gas->known = true;
    return MH_OK;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_gas *gas = state;
    if (gas == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!gas->known) {
        return MH_NONE;
    }
    if (gas->stepped && mh_tick_before(time, gas->time)) {
        return MH_ERR_TIME;
    }
    *estimate = mh_gas_answer(&gas->config, &gas->estimate, true, gas->stated, time);
    estimate->flags = MH_ESTIMATE_COASTED;
    return MH_OK;
}

static void put_place(uint8_t **at, int32_t mm)
{
    const uint32_t bits = (uint32_t)mm;
    *(*at)++ = (uint8_t)(bits >> 16);
    mh_put_u16(at, (uint16_t)(bits & 0xffffu));
}

static int32_t get_place(const uint8_t **at)
{
    const uint32_t high = *(*at)++;
    const int32_t bits = (int32_t)(high << 16 | mh_get_u16(at));
    return bits > PLACE_MAX_MM ? bits - 2 * (PLACE_MAX_MM + 1) : bits;
}

static void put_sensor(uint8_t **at, const struct mh_gas_sensor *sensor)
{
    mh_put_u32(at, sensor->node);
    put_place(at, sensor->x_mm);
    put_place(at, sensor->y_mm);
    *(*at)++ = sensor->heads;
    *(*at)++ = sensor->samples;
    mh_put_real(at, sensor->mean);
}

static struct mh_gas_sensor get_sensor(const uint8_t **at)
{
    struct mh_gas_sensor sensor;
    sensor.node = mh_get_u32(at);
    sensor.x_mm = get_place(at);
    sensor.y_mm = get_place(at);
    sensor.heads = *(*at)++;
    sensor.samples = *(*at)++;
    sensor.mean = mh_get_real(at);
    return sensor;
}

static enum mh_status save(const void *state, uint8_t *bytes, size_t *length)
{
    enum { ROOM = (MH_TRACK_BYTES_MAX - MH_GAS_HEADER_BYTES) / MH_GAS_RECORD_BYTES };
    const struct mh_gas *gas = state;
    if (gas == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!gas->known) {
        return MH_NONE;
    }
    uint8_t *at = bytes;
    for (int i = 0; i < MH_GAS_STATES; i++) {
        mh_put_real(&at, gas->estimate.x[i]);
    }
    mh_real share[MH_GAS_SENSORS_MAX];
    for (uint16_t i = 0; i < gas->count; i++) {
        share[i] = gas->count > ROOM ? share_of(gas, &gas->sensors[i]) : 0;
    }
    for (uint16_t i = 0; i < gas->count; i++) {
        uint16_t ahead = 0;
        for (uint16_t j = 0; j < gas->count; j++) {
            ahead = (uint16_t)(ahead + (share[j] > share[i] || (share[j] == share[i] && j < i) ? 1 : 0));
        }
        if (ahead < ROOM) {
            put_sensor(&at, &gas->sensors[i]);
        }
    }
    *length = (size_t)(at - bytes);
    return MH_OK;
}

/* All that save can write, and nothing else. */
static bool sensor_valid(const struct mh_gas_sensor *sensors, uint16_t i)
{
    for (uint16_t j = 0; j < i; j++) {
        if (sensors[j].node == sensors[i].node) {
            return false;
        }
    }
    return sensors[i].samples > 0 && mh_within(sensors[i].mean, -MEAN_MAX, MEAN_MAX);
}

static enum mh_status load(void *state, const uint8_t *bytes, size_t length)
{
    struct mh_gas *gas = state;
    if (gas == NULL || bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    const size_t count = length < MH_GAS_HEADER_BYTES ? 0 : (length - MH_GAS_HEADER_BYTES) / MH_GAS_RECORD_BYTES;
    if (count < 1 || count > MH_GAS_SENSORS_MAX || length != MH_GAS_HEADER_BYTES + count * MH_GAS_RECORD_BYTES) {
        return MH_ERR_CORRUPT;
    }
    const uint8_t *at = bytes;
    struct mh_gaussian estimate = gas->estimate;
    for (int i = 0; i < MH_GAS_STATES; i++) {
        estimate.x[i] = mh_get_real(&at);
    }
    bool valid = mh_gas_sane(&estimate, true);
    for (uint16_t i = 0; i < (uint16_t)count && valid; i++) {
        gas->sensors[i] = get_sensor(&at);
        valid = sensor_valid(gas->sensors, i);
    }
    if (!valid) {
        restart(gas);
        return MH_ERR_CORRUPT;
    }
    gas->estimate = estimate;
    gas->count = (uint16_t)count;
    gas->known = true;
    gas->stated = gas->stepped = false;
    return MH_OK;
}

static enum mh_status score(const void *state, mh_node_id candidate, const struct mh_place *places, size_t count,
                            mh_real *score)
{
    const struct mh_gas *gas = state;
    if (gas == NULL || places == NULL || count < 1 || score == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!gas->stated) {
        return MH_NONE;
    }
    uint8_t heads = 0;
    for (uint16_t i = 0; i < gas->count; i++) {
        if (gas->sensors[i].node == candidate) {
            heads = gas->sensors[i].heads;
        }
    }
    *score = mh_gas_information(&gas->config, &gas->estimate, places, count) - MH_GAS_REVISIT * (mh_real)heads;
    return MH_OK;
}

const struct mh_tracker mh_tracker_gas = {
    .name = "gas",
    .state_size = sizeof(struct mh_gas),
    .config_size = sizeof(struct mh_gas_config),
    .init = init,
    .step = step,
    .predict = predict,
    .save = save,
    .load = load,
    .restart = restart,
    .score = score,
};
