#include "motehound/sage_husa.h"

#if MH_REAL_FIXED
#define VALUE_MAX MH_REAL(8000.0f)
#define VARIANCE_MIN MH_REAL(2.44e-4f)
#define VARIANCE_MAX MH_REAL(8000.0f)
#else
#define VALUE_MAX 1e9f
#define VARIANCE_MIN 1e-12f
#define VARIANCE_MAX 1e9f
#endif

void mh_sage_husa_config_default(struct mh_sage_husa_config *config)
{
    const struct mh_sage_husa_config nominal = {MH_REAL(1.0f), MH_REAL(10.0f), MH_REAL(10.0f), MH_REAL(1e-3f),
                                                MH_REAL(0.1f)};
    *config = nominal;
}

static bool is_variance(mh_real a) { return mh_within(a, VARIANCE_MIN, VARIANCE_MAX); }

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

mh_share mh_sage_husa_weight(mh_real forgetting, uint32_t l)
{
    const mh_share one = MH_SHARE(1.0f), b = mh_share_from_real(forgetting);
    return mh_share_mul(one - b, one - mh_share_power(b, l - 1));
}

/* False if `a` would leave the room that the sums count on (sage_husa.h); a float has room for all. */
static bool has_room(mh_real a, mh_real largest)
{
#if MH_REAL_FIXED
    return mh_within(a, -largest, largest);
#else
    (void)a, (void)largest;
    return true;
#endif
}

enum mh_status mh_sage_husa_step(struct mh_sage_husa *filter, const struct mh_sage_husa_config *config,
                                 mh_real measurement, mh_real input, mh_share weight)
{
    if (!mh_finite(measurement) || !mh_finite(input) || !mh_share_finite(weight)) {
        return MH_ERR_NOT_FINITE;
    }
    const struct mh_sage_husa old = *filter;
    if (mh_abs(measurement) > VALUE_MAX || mh_abs(input) > VALUE_MAX || !has_room(old.estimate, VALUE_MAX) ||
        weight < 0 || weight > MH_SHARE(1.0f)) {
        return MH_ERR_RANGE;
    }
    const mh_real variance = old.estimate_variance + old.process_variance;
    const mh_real predicted = old.estimate + old.process_mean + input;
    if (mh_abs(measurement - predicted) > VALUE_MAX) {
        return MH_ERR_RANGE;
    }
    struct mh_sage_husa next;
    next.measurement_mean = mh_blend(weight, old.measurement_mean, measurement - predicted);
    const mh_real innovation = measurement - next.measurement_mean - predicted;
    const mh_real surprise =
        mh_wide_to_real(mh_wide_mul(innovation, innovation) - mh_wide_mul(variance, MH_REAL(1.0f)));
    next.measurement_variance = mh_max(mh_blend(weight, old.measurement_variance, surprise), config->measurement_floor);
    if (!mh_finite(surprise) || !has_room(next.measurement_variance, VARIANCE_MAX)) {
        return MH_ERR_RANGE;
    }
    const mh_share gain = mh_share_of(variance, variance + next.measurement_variance);
    const mh_real correction = mh_part(gain, innovation);
    /* (1 - K) Ph, written so that it stays positive when K rounds to 1 */
    next.estimate_variance = mh_part(gain, next.measurement_variance);
    next.estimate = predicted + correction;
    if (!has_room(next.estimate, VALUE_MAX)) {
        return MH_ERR_RANGE;
    }
    next.process_mean = mh_blend(weight, old.process_mean, next.estimate - old.estimate - input);
    const mh_real growth =
        mh_wide_to_real(mh_wide_mul(correction, correction) + mh_wide_mul(next.estimate_variance, MH_REAL(1.0f)) -
                        mh_wide_mul(old.estimate_variance, MH_REAL(1.0f)));
    next.process_variance = mh_max(mh_blend(weight, old.process_variance, growth), config->process_floor);
    if (!has_room(next.process_mean, VALUE_MAX) || !mh_finite(growth) ||
        !has_room(next.process_variance, VARIANCE_MAX)) {
        return MH_ERR_RANGE;
    }
    *filter = next;
    return MH_OK;
}
