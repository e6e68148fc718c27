#include "motehound/luo.h"

#include "motehound/puff_fit.h"

#if MH_REAL_FIXED
#define DIFFUSION_MIN MH_REAL(0.01f)
#define DIFFUSION_MAX MH_REAL(500.0f)
#define FARTHEST MH_REAL(8000.0f)   /* from the origin: as far as mh_sage_husa_step goes */
#define INSIDE_MAX_MM 16000000      /* more, and a saturated border would move into reach */
#define LONGEST_S MH_REAL(16383.0f) /* two of them have a sum */
#else
#define DIFFUSION_MIN 1e-6f
#define DIFFUSION_MAX 1e3f
#define FARTHEST MH_REAL_MAX
#define INSIDE_MAX_MM MH_COORDINATE_MAX_MM
#define LONGEST_S MH_REAL_MAX
#endif

void mh_luo_config_default(struct mh_luo_config *config)
{
    const struct mh_luo_config nominal = {
        .diffusion_m2ps = MH_REAL(1.0f),
        .chi = MH_REAL(0.2f),
        .forgetting = MH_REAL(0.97f),
        .region = {0, 80000, 0, 80000},
        .inside_mm = 5000,
    };
    *config = nominal;
    mh_sage_husa_config_default(&config->filter);
}

/* (a + b) ticks in seconds */
static mh_real seconds(uint32_t a, uint32_t b)
{
#if MH_REAL_FIXED
    const uint32_t longest = 16383u * MH_TICKS_PER_S;
    return mh_real_from_ratio((int32_t)(a >= longest || b >= longest - a ? longest : a + b), (int32_t)MH_TICKS_PER_S);
#else
    return ((mh_real)a + (mh_real)b) / (mh_real)MH_TICKS_PER_S;
#endif
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_luo *luo = state;
    const struct mh_luo_config *c = config;
    if (luo == NULL || c == NULL || interval < 1 || interval > 3600000u) {
        return MH_ERR_ARGUMENT;
    }
    /* written so that NaN fails */
    if (!mh_within(c->diffusion_m2ps, DIFFUSION_MIN, DIFFUSION_MAX) || !mh_within(c->chi, 0, MH_REAL(2000.0f)) ||
        !(c->forgetting > 0 && c->forgetting < MH_REAL(1.0f)) || c->inside_mm < 0 || c->inside_mm > INSIDE_MAX_MM ||
        (MH_REAL_FIXED && c->nonlinear)) {
        return MH_ERR_ARGUMENT;
    }
    if (!mh_coordinate_valid(c->region.x_min_mm) || !mh_coordinate_valid(c->region.x_max_mm) ||
        !mh_coordinate_valid(c->region.y_min_mm) || !mh_coordinate_valid(c->region.y_max_mm)) {
        return MH_ERR_ARGUMENT;
    }
    struct mh_sage_husa x;
    const enum mh_status status = mh_sage_husa_init(&x, &c->filter, 0);
    if (status != MH_OK) {
        return status;
    }
    const struct mh_luo fresh = {
        .config = *c,
        .interval_s = seconds(interval, 0),
        .threshold = mh_q20_from_real(c->chi),
        .x = x,
        .y = x,
    };
    *luo = fresh;
    return MH_OK;
}

/* Steps 2 and 3: the concentration with which a measurement takes part, 0 if it does not. */
static mh_q20 selected(const struct mh_luo *luo, const struct mh_measurement *measurement)
{
    if (luo->count == 0) {
        return measurement->value > luo->threshold ? measurement->value : 0;
    }
    const bool known = (measurement->flags & MH_MEASUREMENT_HAS_INCREMENT) != 0;
    return known && measurement->increment > 0 && measurement->increment >= luo->threshold ? measurement->increment : 0;
}

/* The measurements of one sampling instant. */
struct instant {
    const struct mh_luo *luo;
    const struct mh_measurement *measurements;
    size_t count;
    /* largest concentration, of equals the lowest node; NULL if none takes part */
    const struct mh_measurement *reference;
};

static struct instant gather(const struct mh_luo *luo, const struct mh_measurement *measurements, size_t count)
{
    struct instant instant = {luo, measurements, count, NULL};
    mh_q20 largest = 0;
    for (size_t i = 0; i < count; i++) {
        const mh_q20 c = selected(luo, &measurements[i]);
        if (c > largest || (c > 0 && c == largest && measurements[i].node < instant.reference->node)) {
            instant.reference = &measurements[i];
            largest = c;
        }
    }
    return instant;
}

/* Relative to the reference node, so that the fit has all its digits however far the source has gone. */
static struct mh_puff_sample sample_of(const struct instant *instant, const struct mh_measurement *measurement)
{
    const struct mh_puff_sample sample = {mh_place_relative(&measurement->place, &instant->reference->place),
                                          mh_concentration_of(selected(instant->luo, measurement))};
    return sample;
}

/* Eq. (10). Errors: those of the fit. `used` is the number of measurements that took part. */
static enum mh_status fit_linear(const struct instant *instant, mh_real age_max, struct mh_puff_answer *answer,
                                 uint16_t *used)
{
    struct mh_puff_linear fit;
    const struct mh_puff_sample reference = sample_of(instant, instant->reference);
    enum mh_status status = mh_puff_linear_begin(&fit, instant->luo->config.diffusion_m2ps, &reference);
    for (size_t i = 0; i < instant->count && status == MH_OK; i++) {
        const struct mh_puff_sample sample = sample_of(instant, &instant->measurements[i]);
        if (sample.concentration > 0) {
            status = mh_puff_linear_add(&fit, &sample);
        }
    }
    *used = fit.equations.rows;
    return status == MH_OK ? mh_puff_linear_solve(&fit, age_max, answer) : status;
}

#if !MH_REAL_FIXED
/* Eq. (9) from one start. Leaves `answer` and `cost` alone unless it finds a puff of less cost. */
static void fit_nonlinear(const struct instant *instant, struct mh_vec2 position, mh_real age, mh_real age_max,
                          struct mh_puff_answer *answer, mh_real *cost)
{
    struct mh_puff_nonlinear fit;
    struct mh_puff_answer found;
    const struct mh_puff_sample reference = sample_of(instant, instant->reference);
    enum mh_status status =
        mh_puff_nonlinear_begin(&fit, instant->luo->config.diffusion_m2ps, &reference, position, age, age_max);
    if (status != MH_OK) {
        return;
    }
    do {
        for (size_t i = 0; i < instant->count; i++) {
            const struct mh_puff_sample sample = sample_of(instant, &instant->measurements[i]);
            if (sample.concentration > 0 && mh_puff_nonlinear_add(&fit, &sample) != MH_OK) {
                return;
            }
        }
        status = mh_puff_nonlinear_advance(&fit, &found);
    } while (status == MH_NONE);
    if (status == MH_OK && fit.cost < *cost) {
        *answer = found;
        *cost = fit.cost;
    }
}

#endif

/* Step 4: the pre-estimate, relative to the reference node. */
static enum mh_status locate(const struct instant *instant, mh_real age_max, struct mh_puff_answer *answer,
                             uint16_t *used)
{
    const enum mh_status status = fit_linear(instant, age_max, answer, used);
#if !MH_REAL_FIXED
    if (status == MH_OK && instant->luo->config.nonlinear) {
        const struct mh_puff linear = answer->puff;
        const struct mh_vec2 peak = {0, 0};
        mh_real cost = 3e38f;
        fit_nonlinear(instant, linear.position, linear.age, age_max, answer, &cost);
        fit_nonlinear(instant, peak, 0.5f * instant->luo->interval_s, age_max, answer, &cost);
    }
#endif
    return status;
}

static bool same(struct mh_vec2 a, struct mh_vec2 b) { return a.x == b.x && a.y == b.y; }

/* Step 6: true if the track ends here. A source may enter the field at its border, so the rule waits until the track was inside. */
static bool leaves(struct mh_luo *luo, struct mh_vec2 position)
{
    if (!luo->config.stop_outside) {
        return false;
    }
    const struct mh_region *region = &luo->config.region;
    const struct mh_place lowest = {region->x_min_mm, region->y_min_mm, 0};
    const struct mh_place highest = {region->x_max_mm, region->y_max_mm, 0};
    const struct mh_vec2 low = mh_place_relative(&lowest, &luo->origin);
    const struct mh_vec2 high = mh_place_relative(&highest, &luo->origin);
    const mh_real margin = luo->armed ? 0 : mh_real_from_ratio(luo->config.inside_mm, 1000);
    const bool inside = mh_within(position.x, mh_add(low.x, margin), mh_add(high.x, -margin)) &&
                        mh_within(position.y, mh_add(low.y, margin), mh_add(high.y, -margin));
    const bool end = luo->armed && !inside;
    luo->armed = luo->armed || inside;
    return end;
}

/* Step 5 and the velocity: position number luo->count + 1 has been pre-estimated, `elapsed` seconds of tau after the one before.
 * `filtered` says whether it was filtered. A step that the filter refuses, because the velocity is absurd after a wild pre-estimate, is left out like
 * any other: the next two positions then give a velocity again. Errors: MH_ERR_RANGE (a velocity too large for mh_real). */
static enum mh_status take(struct mh_luo *luo, struct mh_vec2 raw, mh_real elapsed, bool *filtered)
{
    const uint32_t n = luo->count < UINT32_MAX ? luo->count + 1 : luo->count;
    struct mh_sage_husa x = luo->x;
    struct mh_sage_husa y = luo->y;
    *filtered = n > 2 && !same(raw, luo->raw[0]) && !same(raw, luo->raw[1]);
    if (*filtered) {
        const mh_share weight = mh_sage_husa_weight(luo->config.forgetting, n);
        const struct mh_sage_husa_config *noise = &luo->config.filter;
        *filtered = mh_sage_husa_step(&x, noise, raw.x, mh_mul(elapsed, luo->velocity.x), weight) == MH_OK &&
                    mh_sage_husa_step(&y, noise, raw.y, mh_mul(elapsed, luo->velocity.y), weight) == MH_OK;
    }
    if (!*filtered) {
        x = luo->x;
        y = luo->y;
        x.estimate = raw.x;
        y.estimate = raw.y;
    }
    struct mh_vec2 velocity = luo->velocity;
    /* the velocity is 0/0 where two positions share one arrival time, as they do whenever the bound tau >= tau before is active */
    if (n > 1 && elapsed >= luo->interval_s / 2) {
        velocity.x = mh_div(x.estimate - luo->x.estimate, elapsed);
        velocity.y = mh_div(y.estimate - luo->y.estimate, elapsed);
    }
    if (!mh_finite(velocity.x) || !mh_finite(velocity.y)) {
        return MH_ERR_RANGE;
    }
    luo->velocity = velocity;
    luo->x = x;
    luo->y = y;
    luo->raw[1] = luo->raw[0];
    luo->raw[0] = raw;
    luo->count = n;
    return MH_OK;
}

/* What one instant has given. */
struct found {
    struct mh_place origin;
    struct mh_vec2 raw;
    struct mh_puff_answer answer;
    uint16_t used;
    bool filtered;
};

/* Steps 4 and 5. Errors: those of the fit; MH_ERR_RANGE and MH_ERR_NOT_FINITE leave the state as it was. */
static enum mh_status find(struct mh_luo *luo, const struct instant *instant, mh_real age_max, struct found *found)
{
    const enum mh_status status = locate(instant, age_max, &found->answer, &found->used);
    if (status != MH_OK) {
        return status;
    }
    found->origin = luo->count == 0 ? instant->reference->place : luo->origin;
    const struct mh_vec2 reference = mh_place_relative(&instant->reference->place, &found->origin);
    found->raw.x = mh_add(reference.x, found->answer.puff.position.x);
    found->raw.y = mh_add(reference.y, found->answer.puff.position.y);
    return mh_within(found->raw.x, -FARTHEST, FARTHEST) && mh_within(found->raw.y, -FARTHEST, FARTHEST)
               ? take(luo, found->raw, age_max - found->answer.puff.age, &found->filtered)
               : MH_ERR_RANGE;
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_luo *luo = state;
    if (luo == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    uint32_t since = luo->since;
    if (luo->stepped) {
        if (!mh_tick_before(luo->time, time)) {
            return MH_ERR_TIME;
        }
        const uint32_t passed = time - luo->time;
        since = passed > UINT32_MAX - since ? UINT32_MAX : since + passed;
    }
    const struct instant instant = gather(luo, measurements, count);
    struct found found;
    const enum mh_status status = luo->ended || instant.reference == NULL
                                      ? MH_NONE
                                      : find(luo, &instant, mh_min(luo->age + seconds(since, 0), LONGEST_S), &found);
    if (status == MH_ERR_RANGE || status == MH_ERR_NOT_FINITE) {
        return status;
    }
    luo->stepped = true;
    luo->time = time;
    luo->since = since;
    if (status != MH_OK) {
        return MH_NONE;
    }
    luo->origin = found.origin;
    luo->age = found.answer.puff.age;
    luo->since = 0;
    const struct mh_vec2 position = {luo->x.estimate, luo->y.estimate};
    luo->ended = leaves(luo, position);
    if (luo->ended) {
        return MH_NONE;
    }
    const enum mh_bound bound = found.answer.bound;
    const struct mh_estimate result = {
        .origin = found.origin,
        .time = time,
        .position = position,
        .velocity = luo->velocity,
        .raw = found.raw,
        .age = luo->age,
        .measurements = found.used,
        .flags = (uint8_t)((luo->count == 1 ? MH_ESTIMATE_STARTED : 0) | (found.filtered ? MH_ESTIMATE_FILTERED : 0) |
                           (bound == MH_BOUND_LOW ? MH_ESTIMATE_AGE_LOW : 0) |
                           (bound == MH_BOUND_HIGH ? MH_ESTIMATE_AGE_HIGH : 0)),
    };
    *estimate = result;
    return MH_OK;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_luo *luo = state;
    if (luo == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (luo->count == 0 || luo->ended) {
        return MH_NONE;
    }
    if (mh_tick_before(time, luo->time)) {
        return MH_ERR_TIME;
    }
    /* Eq. (11) from the arrival time tau */
    const mh_real ahead = luo->age + seconds(luo->since, time - luo->time);
    const struct mh_vec2 last = {luo->x.estimate, luo->y.estimate};
    const struct mh_vec2 position = mh_vec2_along(last, ahead, luo->velocity);
    if (!mh_finite(position.x) || !mh_finite(position.y)) {
        return MH_ERR_RANGE;
    }
    const struct mh_estimate result = {
        .origin = luo->origin,
        .time = time,
        .position = position,
        .velocity = luo->velocity,
        .raw = position,
        .flags = MH_ESTIMATE_COASTED,
    };
    *estimate = result;
    return MH_OK;
}

const struct mh_tracker mh_tracker_luo = {
    .name = "luo",
    .state_size = sizeof(struct mh_luo),
    .config_size = sizeof(struct mh_luo_config),
    .init = init,
    .step = step,
    .predict = predict,
};
