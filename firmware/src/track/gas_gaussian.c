#include "gas_common.h"
#include "motehound/ekf.h"
#include "motehound/iterated_ekf.h"
#include "motehound/ukf.h"

#include <string.h>

#define AT_ONCE 16 /* samples of one iterated update */
#define ITERATIONS 20

struct mh_gas_kind {
    bool log; /* the third state is ln q, and to be calm takes to be sure */
    void (*prior)(const struct mh_gas_config *config, struct mh_gaussian *prior);
    /* Take the samples into the estimate. Returns how many were taken. */
    uint16_t (*take)(struct mh_gaussian *estimate, const struct mh_observations *samples);
};

static enum mh_status init(const struct mh_gas_kind *kind, void *state, const void *given, mh_tick interval)
{
    struct mh_gas_gaussian *gas = state;
    const struct mh_gas_config *config = given;
    if (gas == NULL || config == NULL || mh_gas_valid(config, interval) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    memset(gas, 0, sizeof *gas);
    gas->kind = kind;
    gas->config = *config;
    kind->prior(config, &gas->estimate);
    return MH_OK;
}

/* Take the samples among the measurements, as many at a time as there is room for. */
static uint16_t take(struct mh_gas_gaussian *gas, const struct mh_measurement *measurements, size_t count)
{
    struct mh_vec2 places[AT_ONCE];
    mh_real z[AT_ONCE], variance[AT_ONCE];
    const struct mh_gas_samples context = {&gas->config, places};
    struct mh_observations samples = {.z = z,
                                      .variance = variance,
                                      .context = &context,
                                      .predict = gas->kind->log ? mh_gas_sample_of_log_rate : mh_gas_sample_of_rate};
    uint16_t taken = 0;
    for (size_t i = 0; i < count; i++) {
        if (mh_gas_is_sample(&measurements[i])) {
            places[samples.count] = mh_place_relative(&measurements[i].place, &gas->config.prior);
            z[samples.count] = mh_q20_to_real(measurements[i].value) / gas->config.noise;
            variance[samples.count] = 1;
            samples.count++;
        }
        if (samples.count == AT_ONCE || (i + 1 == count && samples.count > 0)) {
            taken = (uint16_t)(taken + gas->kind->take(&gas->estimate, &samples));
            samples.count = 0;
        }
    }
    return taken;
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_gas_gaussian *gas = state;
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
    if (!mh_gas_sane(&gas->estimate, gas->kind->log)) {
        gas->kind->prior(&gas->config, &gas->estimate);
        gas->known = false;
        return MH_NONE;
    }
    if (taken == 0 && !gas->known) {
        return MH_NONE;
    }
    *estimate = mh_gas_answer(&gas->config, &gas->estimate, gas->kind->log, true, time);
    mh_gas_flag(&gas->config, before, taken, gas->known, gas->kind->log, estimate);
    gas->known = true;
    return MH_OK;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_gas_gaussian *gas = state;
    if (gas == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!gas->known) {
        return MH_NONE;
    }
    if (gas->stepped && mh_tick_before(time, gas->time)) {
        return MH_ERR_TIME;
    }
    *estimate = mh_gas_answer(&gas->config, &gas->estimate, gas->kind->log, true, time);
    estimate->flags = MH_ESTIMATE_COASTED;
    return MH_OK;
}

static enum mh_status save(const void *state, uint8_t *bytes, size_t *length)
{
    const struct mh_gas_gaussian *gas = state;
    if (gas == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!gas->known) {
        return MH_NONE;
    }
    *length = mh_gaussian_write(&gas->estimate, bytes);
    return MH_OK;
}

static enum mh_status load(void *state, const uint8_t *bytes, size_t length)
{
    struct mh_gas_gaussian *gas = state;
    if (gas == NULL || bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    struct mh_gaussian estimate;
    if (length != MH_GAS_SAVED || mh_gaussian_read(&estimate, MH_GAS_STATES, bytes) != MH_OK ||
        !mh_gas_sane(&estimate, gas->kind->log)) {
        return MH_ERR_CORRUPT;
    }
    gas->estimate = estimate;
    gas->known = true;
    gas->stepped = false;
    return MH_OK;
}

static void restart(void *state)
{
    struct mh_gas_gaussian *gas = state;
    gas->kind->prior(&gas->config, &gas->estimate);
    gas->known = false;
}

/* The head nearest to the estimate. */
static enum mh_status score_by_distance(const void *state, mh_node_id candidate, const struct mh_place *places,
                                        size_t count, mh_real *score)
{
    (void)candidate;
    const struct mh_gas_gaussian *gas = state;
    if (gas == NULL || places == NULL || count < 1 || score == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!gas->known) {
        return MH_NONE;
    }
    const struct mh_vec2 at = mh_place_relative(&places[0], &gas->config.prior);
    *score = -mh_sqrt(mh_squared(at.x - gas->estimate.x[0]) + mh_squared(at.y - gas->estimate.x[1]));
    return MH_OK;
}

static enum mh_status score_by_information(const void *state, mh_node_id candidate, const struct mh_place *places,
                                           size_t count, mh_real *score)
{
    (void)candidate;
    const struct mh_gas_gaussian *gas = state;
    if (gas == NULL || places == NULL || count < 1 || score == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!gas->known) {
        return MH_NONE;
    }
    *score = mh_gas_information(&gas->config, &gas->estimate, places, count);
    return MH_OK;
}

/* One sample after the other. One that the filter cannot take, for the covariance would not stay positive definite, is left out. */
typedef enum mh_status take_one(struct mh_gaussian *estimate, const struct mh_observations *sample);

static uint16_t one_by_one(struct mh_gaussian *estimate, const struct mh_observations *samples, take_one *take_sample)
{
    uint16_t taken = 0;
    for (uint16_t k = 0; k < samples->count; k++) {
        struct mh_gas_samples context = *(const struct mh_gas_samples *)samples->context;
        context.places += k;
        const struct mh_observations sample = {.count = 1,
                                               .z = &samples->z[k],
                                               .variance = &samples->variance[k],
                                               .context = &context,
                                               .predict = samples->predict};
        taken = (uint16_t)(taken + (take_sample(estimate, &sample) == MH_OK ? 1 : 0));
    }
    return taken;
}

static enum mh_status take_by_ekf(struct mh_gaussian *estimate, const struct mh_observations *sample)
{
    return mh_ekf_update(estimate, sample);
}

static enum mh_status take_by_ukf(struct mh_gaussian *estimate, const struct mh_observations *sample)
{
    const struct mh_gas_samples *context = sample->context;
    return mh_ukf_update(estimate, &context->config->ukf, sample);
}

static uint16_t take_ekf(struct mh_gaussian *estimate, const struct mh_observations *samples)
{
    return one_by_one(estimate, samples, take_by_ekf);
}

static uint16_t take_ukf(struct mh_gaussian *estimate, const struct mh_observations *samples)
{
    return one_by_one(estimate, samples, take_by_ukf);
}

static uint16_t take_small(struct mh_gaussian *estimate, const struct mh_observations *samples)
{
    static const struct mh_iterated_ekf_config config = {.iterations = ITERATIONS, .damping = 0.01f, .settled = 1e-6f};
    return mh_iterated_ekf_update(estimate, &config, NULL, samples, NULL) == MH_OK ? samples->count : 0;
}

static enum mh_status init_ekf(void *state, const void *config, mh_tick interval)
{
    static const struct mh_gas_kind kind = {.log = false, .prior = mh_gas_prior, .take = take_ekf};
    return init(&kind, state, config, interval);
}

static enum mh_status init_ukf(void *state, const void *config, mh_tick interval)
{
    static const struct mh_gas_kind kind = {.log = false, .prior = mh_gas_prior, .take = take_ukf};
    static const struct mh_observations none = {.count = 0};
    const struct mh_gas_config *given = config;
    struct mh_gaussian prior;
    if (given == NULL) {
        return MH_ERR_ARGUMENT;
    }
    mh_gas_prior(given, &prior);
    if (mh_ukf_update(&prior, &given->ukf, &none) != MH_OK) {
        return MH_ERR_ARGUMENT; /* the weights */
    }
    return init(&kind, state, config, interval);
}

static enum mh_status init_small(void *state, const void *config, mh_tick interval)
{
    static const struct mh_gas_kind kind = {.log = true, .prior = mh_gas_prior_of_log, .take = take_small};
    return init(&kind, state, config, interval);
}

const struct mh_tracker mh_tracker_gas_ekf = {
    .name = "gas_ekf",
    .state_size = sizeof(struct mh_gas_gaussian),
    .config_size = sizeof(struct mh_gas_config),
    .init = init_ekf,
    .step = step,
    .predict = predict,
    .save = save,
    .load = load,
    .restart = restart,
    .score = score_by_distance,
};

const struct mh_tracker mh_tracker_gas_ukf = {
    .name = "gas_ukf",
    .state_size = sizeof(struct mh_gas_gaussian),
    .config_size = sizeof(struct mh_gas_config),
    .init = init_ukf,
    .step = step,
    .predict = predict,
    .save = save,
    .load = load,
    .restart = restart,
    .score = score_by_distance,
};

const struct mh_tracker mh_tracker_gas_small = {
    .name = "gas_small",
    .state_size = sizeof(struct mh_gas_gaussian),
    .config_size = sizeof(struct mh_gas_config),
    .init = init_small,
    .step = step,
    .predict = predict,
    .save = save,
    .load = load,
    .restart = restart,
    .score = score_by_information,
};
