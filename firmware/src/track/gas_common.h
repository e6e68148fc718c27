/* What the trackers of a gas leak share: the configuration, the model of a sample, the answer. Coordinates are metres from the place of the prior, samples in
 * standard deviations of the noise. */
#ifndef MOTEHOUND_GAS_COMMON_H
#define MOTEHOUND_GAS_COMMON_H

#include "motehound/gas.h"
#include "motehound/observations.h"

/* A track farther than this from the prior has gone astray. */
#define MH_GAS_FARTHEST_M 1e5f

/* Context of the models: where the samples were taken. */
struct mh_gas_samples {
    const struct mh_gas_config *config;
    const struct mh_vec2 *places;
};

enum mh_status mh_gas_valid(const struct mh_gas_config *config, mh_tick interval);

/* A sample of the gas, not of the wind. */
bool mh_gas_is_sample(const struct mh_measurement *measurement);

/* Concentration (plume.h) in standard deviations of a sample. */
mh_real mh_gas_scale(const struct mh_gas_config *config);

/* `predict` of struct mh_observations, of the states (x, y, q) and (x, y, ln q). */
enum mh_status mh_gas_sample_of_rate(const void *samples, uint16_t k, const mh_real *x, mh_real *z, mh_real *gradient);
enum mh_status mh_gas_sample_of_log_rate(const void *samples, uint16_t k, const mh_real *x, mh_real *z,
                                         mh_real *gradient);

/* The prior, of (x, y, q), and with the same mean and variance of the rate as a lognormal of (x, y, ln q). */
void mh_gas_prior(const struct mh_gas_config *config, struct mh_gaussian *prior);
void mh_gas_prior_of_log(const struct mh_gas_config *config, struct mh_gaussian *prior);

/* Finite, not astray, and not of an absurd uncertainty. */
bool mh_gas_sane(const struct mh_gaussian *estimate, bool log);

/* The estimate of (x, y, q), or of (x, y, ln q) where `log`, with its covariance if it is `stated`. */
struct mh_estimate mh_gas_answer(const struct mh_gas_config *config, const struct mh_gaussian *estimate, bool log,
                                 bool stated, mh_tick time);

/* What became of the estimate in a step that took so many samples into a track that was `known` or begins: its flags and measurements. It is calm if it moved
 * little from `before`, and where that is asked for is `sure`. */
void mh_gas_flag(const struct mh_gas_config *config, struct mh_vec2 before, uint16_t taken, bool known, bool sure,
                 struct mh_estimate *estimate);

/* How much, in logarithms of the determinant of the information, samples at all of `places` would add to the estimate of (x, y, ln q): in
 * whole steps of 1 / 16, so that the same places tell the same, in whatever order they come and whatever rounding makes of it. */
mh_real mh_gas_information(const struct mh_gas_config *config, const struct mh_gaussian *estimate,
                           const struct mh_place *places, size_t count);

#endif
