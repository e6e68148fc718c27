#include "motehound/luo.h"

#include "motehound/puff_fit.h"

void mh_luo_config_default(struct mh_luo_config *config)
{
    const struct mh_luo_config nominal = {
        .diffusion_m2ps = 1.0f,
        .chi = 0.2f,
        .forgetting = 0.97f,
        .region = {0, 80000, 0, 80000},
        .inside_mm = 5000,
    };
    *config = nominal;
    mh_sage_husa_config_default(&config->filter);
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_luo *luo = state;
    const struct mh_luo_config *c = config;
    if (luo == NULL || c == NULL || interval < 1 || interval > 3600000u) {
        return MH_ERR_ARGUMENT;
    }
    /* written so that NaN fails */
    if (!(c->diffusion_m2ps >= 1e-6f && c->diffusion_m2ps <= 1e3f) || !(c->chi >= 0 && c->chi <= 2000.0f) ||
        !(c->forgetting > 0 && c->forgetting < 1) || c->inside_mm < 0 || c->inside_mm > 1000000000) {
        return MH_ERR_ARGUMENT;
    }
    struct mh_sage_husa x;
    const enum mh_status status = mh_sage_husa_init(&x, &c->filter, 0);
    if (status != MH_OK) {
        return status;
    }
    const struct mh_luo fresh = {
        .config = *c,
        .interval_s = (mh_real)interval / (mh_real)MH_TICKS_PER_S,
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

/* The reference node: largest concentration, of equals the lowest node. NULL if no measurement takes part. */
static const struct mh_measurement *find_reference(const struct mh_luo *luo, const struct mh_measurement *measurements,
                                                   size_t count)
{
    const struct mh_measurement *best = NULL;
    mh_q20 largest = 0;
    for (size_t i = 0; i < count; i++) {
        const mh_q20 c = selected(luo, &measurements[i]);
        if (c > largest || (c > 0 && c == largest && measurements[i].node < best->node)) {
            best = &measurements[i];
            largest = c;
        }
    }
    return best;
}

static struct mh_puff_sample sample_of(const struct mh_luo *luo, const struct mh_measurement *measurement,
                                       const struct mh_place *origin)
{
    const struct mh_puff_sample sample = {mh_place_relative(&measurement->place, origin),
                                          mh_q20_to_real(selected(luo, measurement))};
    return sample;
}

/* Step 4: the pre-estimate. Errors: MH_NONE. `used` is the number of measurements that took part. */
static enum mh_status locate(const struct mh_luo *luo, const struct mh_measurement *measurements, size_t count,
                             const struct mh_measurement *reference, const struct mh_place *origin, mh_real age_max,
                             struct mh_puff_answer *answer, uint16_t *used)
{
    struct mh_puff_linear fit;
    const struct mh_puff_sample largest = sample_of(luo, reference, origin);
    if (mh_puff_linear_begin(&fit, luo->config.diffusion_m2ps, &largest) != MH_OK) {
        return MH_NONE;
    }
    for (size_t i = 0; i < count; i++) {
        const struct mh_puff_sample sample = sample_of(luo, &measurements[i], origin);
        if (sample.concentration > 0 && mh_puff_linear_add(&fit, &sample) != MH_OK) {
            return MH_NONE;
        }
    }
    *used = fit.equations.rows;
    return mh_puff_linear_solve(&fit, age_max, answer) == MH_OK ? MH_OK : MH_NONE;
}

static bool same(struct mh_vec2 a, struct mh_vec2 b)
{
    return a.x == b.x && a.y == b.y;
}

/* Step 6: true if the track ends here. A source may enter the field at its border, so the rule waits until the track was inside. */
static bool leaves(struct mh_luo *luo, struct mh_vec2 position)
{
    if (!luo->config.stop_outside) {
        return false;
    }
    const struct mh_region *region = &luo->config.region;
    const int32_t margin = luo->armed ? 0 : luo->config.inside_mm;
    const struct mh_place lowest = {region->x_min_mm + margin, region->y_min_mm + margin, 0};
    const struct mh_place highest = {region->x_max_mm - margin, region->y_max_mm - margin, 0};
    const struct mh_vec2 low = mh_place_relative(&lowest, &luo->origin);
    const struct mh_vec2 high = mh_place_relative(&highest, &luo->origin);
    const bool inside = position.x >= low.x && position.x <= high.x && position.y >= low.y && position.y <= high.y;
    const bool end = luo->armed && !inside;
    luo->armed = luo->armed || inside;
    return end;
}

/* Step 5 and the velocity: position number luo->count + 1 has been pre-estimated, `elapsed` seconds of tau after the one before. */
static enum mh_status take(struct mh_luo *luo, struct mh_vec2 raw, mh_real elapsed, bool *filtered)
{
    const uint32_t n = luo->count < UINT32_MAX ? luo->count + 1 : luo->count;
    struct mh_sage_husa x = luo->x;
    struct mh_sage_husa y = luo->y;
    *filtered = n > 2 && !same(raw, luo->raw[0]) && !same(raw, luo->raw[1]);
    if (*filtered) {
        const mh_real weight = mh_sage_husa_weight(luo->config.forgetting, n);
        const struct mh_sage_husa_config *noise = &luo->config.filter;
        if (mh_sage_husa_step(&x, noise, raw.x, elapsed * luo->velocity.x, weight) != MH_OK ||
            mh_sage_husa_step(&y, noise, raw.y, elapsed * luo->velocity.y, weight) != MH_OK) {
            return MH_NONE;
        }
    } else {
        x.estimate = raw.x;
        y.estimate = raw.y;
    }
    /* the velocity is 0/0 where two positions share one arrival time, as they do whenever the bound tau >= tau before is active */
    if (n > 1 && elapsed >= 0.5f * luo->interval_s) {
        luo->velocity.x = (x.estimate - luo->x.estimate) / elapsed;
        luo->velocity.y = (y.estimate - luo->y.estimate) / elapsed;
    }
    luo->x = x;
    luo->y = y;
    luo->raw[1] = luo->raw[0];
    luo->raw[0] = raw;
    luo->count = n;
    return MH_OK;
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_luo *luo = state;
    if (luo == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (luo->stepped) {
        if (!mh_tick_before(luo->time, time)) {
            return MH_ERR_TIME;
        }
        const uint32_t passed = time - luo->time;
        luo->since = passed > UINT32_MAX - luo->since ? UINT32_MAX : luo->since + passed;
    }
    luo->stepped = true;
    luo->time = time;
    const struct mh_measurement *reference = luo->ended ? NULL : find_reference(luo, measurements, count);
    if (reference == NULL) {
        return MH_NONE;
    }
    const struct mh_place origin = luo->count == 0 ? reference->place : luo->origin;
    const mh_real age_max = luo->age + (mh_real)luo->since / (mh_real)MH_TICKS_PER_S;
    struct mh_puff_answer answer;
    uint16_t used;
    bool filtered;
    if (locate(luo, measurements, count, reference, &origin, age_max, &answer, &used) != MH_OK ||
        take(luo, answer.puff.position, age_max - answer.puff.age, &filtered) != MH_OK) {
        return MH_NONE;
    }
    luo->origin = origin;
    luo->age = answer.puff.age;
    luo->since = 0;
    const struct mh_vec2 position = {luo->x.estimate, luo->y.estimate};
    luo->ended = leaves(luo, position);
    if (luo->ended) {
        return MH_NONE;
    }
    const struct mh_estimate result = {
        .origin = origin,
        .time = time,
        .position = position,
        .velocity = luo->velocity,
        .raw = answer.puff.position,
        .age = answer.puff.age,
        .measurements = used,
        .flags = (uint8_t)((luo->count == 1 ? MH_ESTIMATE_STARTED : 0) | (filtered ? MH_ESTIMATE_FILTERED : 0) |
                           (answer.bound == MH_BOUND_LOW ? MH_ESTIMATE_AGE_LOW : 0) |
                           (answer.bound == MH_BOUND_HIGH ? MH_ESTIMATE_AGE_HIGH : 0)),
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
    const mh_real ahead = luo->age + ((mh_real)luo->since + (mh_real)(time - luo->time)) / (mh_real)MH_TICKS_PER_S;
    const struct mh_vec2 position = {luo->x.estimate + ahead * luo->velocity.x,
                                     luo->y.estimate + ahead * luo->velocity.y};
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
