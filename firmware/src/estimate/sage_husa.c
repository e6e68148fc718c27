#include "motehound/sage_husa.h"

#define VALUE_MAX 1e9f

void mh_sage_husa_config_default(struct mh_sage_husa_config *config)
{
    const struct mh_sage_husa_config nominal = {1.0f, 10.0f, 10.0f, 1e-3f, 0.1f};
    *config = nominal;
}

static bool is_variance(mh_real a) { return a >= 1e-12f && a <= 1e9f; }

enum mh_status mh_sage_husa_init(struct mh_sage_husa *filter, const struct mh_sage_husa_config *config,
                                 mh_real estimate)
{
    if (!is_variance(config->process_variance) || !is_variance(config->measurement_variance) ||
        !is_variance(config->estimate_variance) || !is_variance(config->process_floor) ||
        !is_variance(config->measurement_floor)) {
        return MH_ERR_ARGUMENT;
    }
    if (!mh_finite(estimate)) {
        return MH_ERR_NOT_FINITE;
    }
    const struct mh_sage_husa begin = {
        .estimate = estimate,
        .estimate_variance = config->estimate_variance,
        .process_variance = config->process_variance,
        .measurement_variance = config->measurement_variance,
    };
    *filter = begin;
    return MH_OK;
}

mh_real mh_sage_husa_weight(mh_real forgetting, uint32_t l)
{
    return (1 - forgetting) * (1 - mh_exp((mh_real)(l - 1) * mh_log(forgetting)));
}

enum mh_status mh_sage_husa_step(struct mh_sage_husa *filter, const struct mh_sage_husa_config *config,
                                 mh_real measurement, mh_real input, mh_real weight)
{
    if (!mh_finite(measurement) || !mh_finite(input) || !mh_finite(weight)) {
        return MH_ERR_NOT_FINITE;
    }
    const struct mh_sage_husa old = *filter;
    const mh_real variance = old.estimate_variance + old.process_variance;
    const mh_real predicted = old.estimate + old.process_mean + input;
    if (mh_abs(measurement) > VALUE_MAX || mh_abs(input) > VALUE_MAX || mh_abs(measurement - predicted) > VALUE_MAX ||
        weight < 0 || weight > 1) {
        return MH_ERR_RANGE;
    }
    const mh_real keep = 1 - weight;
    filter->measurement_mean = keep * old.measurement_mean + weight * (measurement - predicted);
    const mh_real innovation = measurement - filter->measurement_mean - predicted;
    filter->measurement_variance = mh_max(
        keep * old.measurement_variance + weight * (innovation * innovation - variance), config->measurement_floor);
    const mh_real gain = variance / (variance + filter->measurement_variance);
    const mh_real correction = gain * innovation;
    /* (1 - K) Ph, written so that it stays positive when K rounds to 1 */
    filter->estimate_variance = gain * filter->measurement_variance;
    filter->estimate = predicted + correction;
    filter->process_mean = keep * old.process_mean + weight * (filter->estimate - old.estimate - input);
    filter->process_variance =
        mh_max(keep * old.process_variance +
                   weight * (correction * correction + filter->estimate_variance - old.estimate_variance),
               config->process_floor);
    return MH_OK;
}
