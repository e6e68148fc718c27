#include "motehound/cv.h"

#include "plane_estimate.h"

#include "motehound/bytes.h"
#include "motehound/ekf.h"
#include "motehound/range_model.h"
#include "motehound/ukf.h"

#include <string.h>

#define LONGEST_TICKS 3600000u
#define LONGEST_GAP ((int32_t)1 << 30) /* ticks */
#define SMALLEST_VARIANCE 1e-8f

typedef enum mh_status (*update_function)(const struct mh_cv_config *config, struct mh_gaussian *state,
                                          const struct mh_observations *observations);

/* ---- motion ---- */

/* `track`, at or before `time`, -> *moved, at `time`. */
static enum mh_status predict_track(const struct mh_cv_config *config, const struct mh_cv_track *track, mh_tick time,
                                    struct mh_cv_track *moved)
{
    mh_real F[MH_CV_STATES * MH_CV_STATES], Q[MH_PACKED_SIZE(MH_CV_STATES)];
    struct mh_cv_track next = *track;
    if (time != track->time) {
        mh_white_acceleration(&config->motion, time - track->time, F, Q);
        const enum mh_status status = mh_gaussian_predict(&next.state, F, Q);
        if (status != MH_OK) {
            return status;
        }
        next.time = time;
        if (config->summary == MH_SUMMARY_SPLIT) {
            mh_covariance_predict(MH_CV_STATES, next.shared, F, Q);
        }
    }
    *moved = next;
    return MH_OK;
}

/* ---- samples ---- */

static enum mh_status range_of(const void *context, uint16_t k, const mh_real *x, mh_real *z, mh_real *gradient)
{
    const struct mh_cv_sample *sample = (const struct mh_cv_sample *)context + k;
    const struct mh_vec2 target = {x[0], x[2]};
    struct mh_vec2 along;
    const enum mh_status status = mh_range_model(target, sample->at, sample->rise, z, &along);
    if (gradient == NULL) {
        if (status == MH_ERR_SINGULAR) { /* just there */
            *z = 0;
        }
        return status == MH_ERR_SINGULAR ? MH_OK : status;
    }
    if (status == MH_OK) {
        gradient[0] = along.x;
        gradient[2] = along.y;
        gradient[1] = gradient[3] = 0;
    }
    return status;
}

static enum mh_status ukf_update(const struct mh_cv_config *config, struct mh_gaussian *state,
                                 const struct mh_observations *observations)
{
    const struct mh_ukf_weights weights = {config->alpha, config->beta, config->kappa};
    return mh_ukf_update_stacked(state, &weights, observations);
}

static enum mh_status ekf_update(const struct mh_cv_config *config, struct mh_gaussian *state,
                                 const struct mh_observations *observations)
{
    (void)config;
    return mh_ekf_update_stacked(state, observations);
}

/* Samples of one instant, at most MH_STACKED_MAX -> track, which comes to their time. */
static enum mh_status filter_some(const struct mh_cv_config *config, update_function update,
                                  const struct mh_cv_sample *samples, uint16_t count, struct mh_cv_track *track)
{
    mh_real z[MH_STACKED_MAX], variance[MH_STACKED_MAX], A[MH_CV_STATES * MH_CV_STATES];
    enum mh_status status = predict_track(config, track, samples[0].time, track);
    if (status != MH_OK) {
        return status;
    }
    for (uint16_t i = 0; i < count; i++) {
        z[i] = samples[i].range;
        variance[i] = samples[i].variance;
    }
    const struct mh_observations observations = {
        .count = count, .z = z, .variance = variance, .context = samples, .predict = range_of};
    struct mh_gaussian state = track->state;
    status = update(config, &state, &observations);
    if (status == MH_OK && config->summary == MH_SUMMARY_SPLIT) {
        status = mh_gaussian_reduction(&track->state, &state, A);
        if (status == MH_OK) {
            mh_covariance_predict(MH_CV_STATES, track->shared, A, NULL);
        }
    }
    if (status == MH_OK) {
        track->state = state;
    }
    return status;
}

/* The first samples of samples[0 .. count) that are of one instant, and go into one update. */
static uint16_t together(const struct mh_cv_sample *samples, uint16_t count)
{
    uint16_t some = 1;
    while (some < count && some < MH_STACKED_MAX && samples[some].time == samples[0].time) {
        some++;
    }
    return some;
}

/* samples[0 .. count) -> track. Returns how many were of no use. */
static uint16_t filter(const struct mh_cv_config *config, update_function update, const struct mh_cv_sample *samples,
                       uint16_t count, struct mh_cv_track *track)
{
    uint16_t failed = 0, some;
    for (uint16_t done = 0; done < count; done = (uint16_t)(done + some)) {
        some = together(samples + done, (uint16_t)(count - done));
        if (filter_some(config, update, samples + done, some, track) != MH_OK) {
            failed = (uint16_t)(failed + some);
        }
    }
    return failed;
}

/* ---- the kept samples ---- */

static void begin_again(struct mh_cv *cv)
{
    cv->latest = cv->settled;
    cv->filtered = 0;
}

static void catch_up(struct mh_cv *cv, update_function update)
{
    cv->counters.failed +=
        filter(&cv->config, update, cv->samples + cv->filtered, (uint16_t)(cv->count - cv->filtered), &cv->latest);
    cv->filtered = cv->count;
}

static void drop(struct mh_cv *cv, uint16_t count)
{
    cv->count = (uint16_t)(cv->count - count);
    cv->filtered = (uint16_t)(cv->filtered > count ? cv->filtered - count : 0);
    memmove(cv->samples, cv->samples + count, cv->count * sizeof cv->samples[0]);
}

static uint16_t kept_until(const struct mh_cv *cv, mh_tick time)
{
    uint16_t count = 0;
    while (count < cv->count && !mh_tick_before(time, cv->samples[count].time)) {
        count++;
    }
    return count;
}

/* What was taken until `time` can change no more. */
static void settle(struct mh_cv *cv, update_function update, mh_tick time)
{
    const uint16_t count = kept_until(cv, time);
    catch_up(cv, update);
    if (count == cv->count) {
        cv->settled = cv->latest;
    } else {
        (void)filter(&cv->config, update, cv->samples, count, &cv->settled);
    }
    drop(cv, count);
    if (mh_tick_before(cv->horizon, time)) {
        cv->horizon = time;
    }
}

static int order(const struct mh_cv_sample *kept, const struct mh_measurement *m)
{
    if (kept->time != m->time) {
        return mh_tick_before(kept->time, m->time) ? -1 : 1;
    }
    if (kept->node != m->node) {
        return kept->node < m->node ? -1 : 1;
    }
    return (kept->target > m->target) - (kept->target < m->target);
}

static mh_real variance_of(const struct mh_cv_config *config, mh_node_id node)
{
    for (uint16_t i = 0; i < config->noise_count; i++) {
        if (config->noise[i].node == node) {
            return config->noise[i].variance;
        }
    }
    return config->variance;
}

static void insert(struct mh_cv *cv, uint16_t at, const struct mh_measurement *m)
{
    const struct mh_place *origin = &cv->config.origin;
    const struct mh_cv_sample sample = {
        .node = m->node,
        .time = m->time,
        .at = mh_place_relative(&m->place, origin),
        .rise = (mh_real)(origin->z_mm - m->place.z_mm) * 0.001f,
        .range = mh_q20_to_real(m->value),
        .variance = variance_of(&cv->config, m->node),
        .target = m->target,
    };
    memmove(cv->samples + at + 1, cv->samples + at, (size_t)(cv->count - at) * sizeof cv->samples[0]);
    cv->samples[at] = sample;
    cv->count++;
}

/* One more sample, of an instant until `time`. Returns false if it is refused. */
static bool take(struct mh_cv *cv, update_function update, mh_tick time, const struct mh_measurement *m)
{
    if (mh_tick_before(time, m->time)) {
        cv->counters.early++;
        return false;
    }
    if (cv->count == MH_CV_SAMPLES_MAX && mh_tick_before(cv->samples[0].time, m->time)) {
        const mh_tick oldest = cv->samples[0].time;
        cv->counters.hurried += kept_until(cv, oldest);
        settle(cv, update, oldest);
    }
    if (!mh_tick_before(cv->horizon, m->time) || cv->count == MH_CV_SAMPLES_MAX) {
        cv->counters.late++;
        return false;
    }
    uint16_t at = cv->count;
    while (at > 0 && order(&cv->samples[at - 1], m) > 0) {
        at--;
    }
    if (at > 0 && order(&cv->samples[at - 1], m) == 0) {
        cv->counters.repeated++;
        return false;
    }
    /* what was filtered already is not what it is to be if it is later, or of the same instant */
    if (at < cv->filtered || (at > 0 && at == cv->filtered && cv->samples[at - 1].time == m->time)) {
        cv->counters.reordered++;
        begin_again(cv);
    }
    cv->counters.taken++;
    insert(cv, at, m);
    return true;
}

/* ---- the tracker ---- */

static bool motion_sound(const struct mh_white_acceleration *motion)
{
    return motion->tick >= 1 && motion->tick <= LONGEST_TICKS && mh_within(motion->variance.x, 0, 1e6f) &&
           mh_within(motion->variance.y, 0, 1e6f);
}

static bool noise_sound(const struct mh_cv_config *config)
{
    bool sound = mh_within(config->variance, SMALLEST_VARIANCE, 1e8f) && (config->noise || config->noise_count == 0);
    for (uint16_t i = 0; sound && i < config->noise_count; i++) {
        sound = mh_within(config->noise[i].variance, SMALLEST_VARIANCE, 1e8f);
    }
    return sound;
}

static void begin_with(struct mh_cv *cv, mh_tick time, const struct mh_gaussian *state)
{
    cv->settled.time = cv->reference_time = cv->since = cv->horizon = time;
    cv->settled.state = cv->reference = *state;
    memcpy(cv->settled.shared, state->P, sizeof cv->settled.shared);
    cv->latest = cv->settled;
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_cv *cv = state;
    const struct mh_cv_config *chosen = config;
    if (cv == NULL || chosen == NULL || interval < 1 || interval > LONGEST_TICKS || !motion_sound(&chosen->motion) ||
        !noise_sound(chosen) || chosen->lag > LONGEST_TICKS ||
        (chosen->summary != MH_SUMMARY_PLAIN && chosen->summary != MH_SUMMARY_SPLIT &&
         chosen->summary != MH_SUMMARY_INCREMENT) ||
        !mh_coordinate_valid(chosen->origin.x_mm) || !mh_coordinate_valid(chosen->origin.y_mm) ||
        !mh_coordinate_valid(chosen->origin.z_mm)) {
        return MH_ERR_ARGUMENT;
    }
    struct mh_gaussian start = {.n = MH_CV_STATES};
    memcpy(start.x, chosen->mean, sizeof chosen->mean);
    memcpy(start.P, chosen->covariance, sizeof chosen->covariance);
    if (mh_gaussian_check(&start) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    memset(cv, 0, sizeof *cv);
    cv->config = *chosen;
    cv->interval = interval;
    begin_with(cv, chosen->start, &start);
    cv->horizon = chosen->start - 1; /* a sample of the start itself counts */
    return MH_OK;
}

/* The weights are the filter's to judge. */
static enum mh_status init_ukf(void *state, const void *config, mh_tick interval)
{
    struct mh_gaussian any = {.n = 1, .P = {1.0f}};
    const struct mh_observations none = {.count = 0};
    const enum mh_status status = init(state, config, interval);
    return status == MH_OK ? ukf_update(config, &any, &none) : status;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_cv *cv = state;
    struct mh_cv_track track;
    if (cv == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!cv->stepped) {
        return MH_NONE;
    }
    if (mh_tick_before(time, cv->time)) {
        return MH_ERR_TIME;
    }
    const enum mh_status status = predict_track(&cv->config, &cv->latest, time, &track);
    if (status != MH_OK) {
        return MH_NONE;
    }
    mh_plane_estimate(&track.state, &cv->config.origin, time, estimate);
    estimate->flags = MH_ESTIMATE_COASTED;
    return MH_OK;
}

/* Without samples for so long that differences of times are about to lose their meaning: the track is predicted for good. */
static void keep_up(struct mh_cv *cv, mh_tick time)
{
    struct mh_cv_track reference = {.time = cv->reference_time, .state = cv->reference};
    if (mh_ticks_between(cv->latest.time, time) > LONGEST_GAP &&
        predict_track(&cv->config, &cv->latest, time, &cv->latest) == MH_OK) {
        cv->settled = cv->latest;
    }
    if (mh_ticks_between(cv->reference_time, time) > LONGEST_GAP &&
        predict_track(&cv->config, &reference, time, &reference) == MH_OK) {
        cv->reference = reference.state;
        cv->reference_time = time;
    }
}

static enum mh_status step(update_function update, struct mh_cv *cv, mh_tick time,
                           const struct mh_measurement *measurements, size_t count, struct mh_estimate *estimate)
{
    if (cv == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (cv->stepped && !mh_tick_before(cv->time, time)) {
        return MH_ERR_TIME;
    }
    const bool starts = !cv->stepped;
    if (starts && mh_tick_before(time, cv->latest.time)) {
        return MH_NONE;
    }
    if (starts && mh_tick_before(cv->since, time - cv->interval)) {
        cv->since = time - cv->interval;
    }
    uint16_t taken = 0;
    for (size_t i = 0; i < count; i++) {
        taken = (uint16_t)(taken + take(cv, update, time, &measurements[i]));
    }
    catch_up(cv, update);
    cv->stepped = true;
    cv->time = time;
    settle(cv, update, time - cv->config.lag);
    keep_up(cv, time);
    const enum mh_status status = predict(cv, time, estimate);
    if (status == MH_OK) {
        estimate->measurements = taken;
        estimate->flags = (uint8_t)((starts ? MH_ESTIMATE_STARTED : 0) | (taken == 0 ? MH_ESTIMATE_COASTED : 0));
    }
    return status;
}

static enum mh_status step_ukf(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                               struct mh_estimate *estimate)
{
    return step(ukf_update, state, time, measurements, count, estimate);
}

static enum mh_status step_ekf(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                               struct mh_estimate *estimate)
{
    return step(ekf_update, state, time, measurements, count, estimate);
}

static enum mh_status save(const void *state, uint8_t *bytes, size_t *length)
{
    const struct mh_cv *cv = state;
    uint8_t *at = bytes;
    if (cv == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!cv->stepped) {
        return MH_NONE;
    }
    mh_put_u32(&at, cv->latest.time);
    *length = sizeof(uint32_t) + mh_gaussian_write(&cv->latest.state, at);
    return MH_OK;
}

static enum mh_status load(void *state, const uint8_t *bytes, size_t length)
{
    struct mh_cv *cv = state;
    struct mh_gaussian saved;
    const uint8_t *at = bytes;
    if (cv == NULL || bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (length != MH_CV_SAVED) {
        return MH_ERR_CORRUPT;
    }
    const mh_tick time = mh_get_u32(&at);
    if (mh_tick_before(time, cv->config.start) || mh_gaussian_read(&saved, MH_CV_STATES, at) != MH_OK ||
        !mh_summary_sane(&saved)) {
        return MH_ERR_CORRUPT;
    }
    begin_with(cv, time, &saved);
    return MH_OK;
}

/* ---- summaries ---- */

/* What is not shared; a variance that rounding has left below 0 is none. */
static void own_part(const struct mh_cv_track *track, mh_real *own)
{
    for (int i = 0; i < MH_PACKED_SIZE(MH_CV_STATES); i++) {
        own[i] = track->state.P[i] - track->shared[i];
    }
    for (int i = 0; i < MH_CV_STATES; i++) {
        if (own[MH_PACKED(i, i)] <= 0) {
            for (int j = 0; j < MH_CV_STATES; j++) {
                own[mh_packed_index(i, j)] = 0;
            }
        }
    }
}

/* What the track of now, predicted to a time, knows more than the reference. */
static enum mh_status increment_of(const struct mh_cv *cv, const struct mh_gaussian *now, mh_tick time,
                                   struct mh_information *increment)
{
    struct mh_cv_track reference = {.time = cv->reference_time, .state = cv->reference};
    enum mh_status status = predict_track(&cv->config, &reference, time, &reference);
    if (status == MH_OK) {
        status = mh_fusion_increment(now, &reference.state, increment);
    }
    return status;
}

static void forget_told(struct mh_cv *cv, uint8_t count)
{
    cv->told_count = (uint8_t)(cv->told_count - count);
    memmove(cv->told, cv->told + count, cv->told_count * sizeof cv->told[0]);
}

static void note_told(struct mh_cv *cv, const struct mh_cv_track *track)
{
    if (cv->told_count > 0 && !mh_tick_before(cv->told[cv->told_count - 1].time, track->time)) {
        cv->told_count--; /* told once more */
    }
    if (cv->told_count == MH_CV_TOLD_MAX) {
        forget_told(cv, 1);
    }
    cv->told[cv->told_count].time = track->time;
    cv->told[cv->told_count++].state = track->state;
}

static enum mh_status summarise(void *state, mh_tick time, uint8_t *bytes, size_t *length)
{
    struct mh_cv *cv = state;
    struct mh_cv_track track;
    if (cv == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!cv->stepped) {
        return MH_NONE;
    }
    if (mh_tick_before(time, cv->time)) {
        return MH_ERR_TIME;
    }
    struct mh_summary summary = {.kind = cv->config.summary};
    enum mh_status status = predict_track(&cv->config, &cv->latest, time, &track);
    if (status != MH_OK) {
        return MH_NONE;
    }
    switch (summary.kind) {
    case MH_SUMMARY_INCREMENT:
        summary.since = cv->since;
        status = increment_of(cv, &track.state, time, &summary.of.increment);
        if (status == MH_OK) {
            note_told(cv, &track);
        }
        break;
    case MH_SUMMARY_SPLIT:
        summary.of.split.dependent = track.state;
        memcpy(summary.of.split.dependent.P, track.shared, sizeof track.shared);
        own_part(&track, summary.of.split.independent);
        break;
    default:
        summary.of.plain = track.state;
        break;
    }
    if (status != MH_OK) {
        return MH_NONE;
    }
    *length = mh_summary_write(&summary, bytes);
    return MH_OK;
}

/* The centre has that summary, or one before it that is forgotten. */
static void refer_to(struct mh_cv *cv, uint8_t told)
{
    cv->reference = cv->told[told].state;
    cv->reference_time = cv->since = cv->told[told].time;
    forget_told(cv, (uint8_t)(told + 1));
}

static void summary_taken(void *state, mh_tick time)
{
    struct mh_cv *cv = state;
    for (uint8_t i = 0; i < cv->told_count; i++) {
        if (cv->told[i].time == time) {
            refer_to(cv, i);
            return;
        }
    }
    if (cv->told_count > 0 && mh_tick_before(cv->since, time) && mh_tick_before(time, cv->told[0].time)) {
        cv->counters.left_out++;
        refer_to(cv, (uint8_t)(cv->told_count - 1));
    }
}

/* Put the state of `time` in place of the track, and filter what was taken after it anew. */
static void replace(struct mh_cv *cv, update_function update, mh_tick time, const struct mh_gaussian *state)
{
    drop(cv, kept_until(cv, time));
    cv->settled.time = time;
    cv->settled.state = *state;
    memcpy(cv->settled.shared, state->P, sizeof cv->settled.shared);
    if (mh_tick_before(cv->horizon, time)) {
        cv->horizon = time;
    }
    begin_again(cv);
    catch_up(cv, update);
}

static enum mh_status correct(update_function update, struct mh_cv *cv, mh_tick time, const uint8_t *bytes,
                              size_t length)
{
    struct mh_summary summary;
    struct mh_information increment;
    if (cv == NULL || bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (mh_summary_read(&summary, bytes, length) != MH_OK ||
        (summary.kind != MH_SUMMARY_FUSED && summary.kind != MH_SUMMARY_PLAIN)) {
        cv->counters.refused++;
        return MH_ERR_CORRUPT;
    }
    const struct mh_cv_told *last = cv->told_count > 0 ? &cv->told[cv->told_count - 1] : NULL;
    if (!cv->stepped || mh_tick_before(cv->time, time) || mh_tick_before(time, cv->settled.time) ||
        (last && last->time != time)) {
        cv->counters.refused++;
        return MH_ERR_TIME;
    }
    struct mh_gaussian corrected = summary.of.plain;
    if (last &&
        (increment_of(cv, &last->state, time, &increment) != MH_OK ||
         mh_fusion_add(&summary.of.plain, &increment, 1, &corrected) != MH_OK || !mh_summary_sane(&corrected))) {
        corrected = summary.of.plain; /* what was told is of no use */
    }
    cv->reference = summary.of.plain;
    cv->reference_time = cv->since = time;
    cv->told_count = 0;
    cv->counters.corrected++;
    replace(cv, update, time, &corrected);
    return MH_OK;
}

static enum mh_status correct_ukf(void *state, mh_tick time, const uint8_t *bytes, size_t length)
{
    return correct(ukf_update, state, time, bytes, length);
}

static enum mh_status correct_ekf(void *state, mh_tick time, const uint8_t *bytes, size_t length)
{
    return correct(ekf_update, state, time, bytes, length);
}

const struct mh_tracker mh_tracker_cv_ukf = {
    .name = "cv_ukf",
    .state_size = sizeof(struct mh_cv),
    .config_size = sizeof(struct mh_cv_config),
    .init = init_ukf,
    .step = step_ukf,
    .predict = predict,
    .save = save,
    .load = load,
    .summarise = summarise,
    .summary_taken = summary_taken,
    .correct = correct_ukf,
};

const struct mh_tracker mh_tracker_cv_ekf = {
    .name = "cv_ekf",
    .state_size = sizeof(struct mh_cv),
    .config_size = sizeof(struct mh_cv_config),
    .init = init,
    .step = step_ekf,
    .predict = predict,
    .save = save,
    .load = load,
    .summarise = summarise,
    .summary_taken = summary_taken,
    .correct = correct_ekf,
};

void mh_cv_config_default(struct mh_cv_config *config)
{
    const struct mh_cv_config nominal = {
        .mean = {10.0f, 0.8f, 20.0f, 0.6f},
        .covariance = {1.0f, 0, 0.04f, 0, 0, 1.0f, 0, 0, 0, 0.04f},
        .motion = {.tick = 500, .variance = {5e-5f, 1e-4f}},
        .variance = 0.02f,
        .lag = 2000,
        .alpha = 1.0f,
        .beta = 2.0f,
        .summary = MH_SUMMARY_PLAIN,
    };
    *config = nominal;
}
