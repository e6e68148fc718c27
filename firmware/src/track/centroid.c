#include "motehound/centroid.h"

#include "motehound/bytes.h"

#define BYTES 12

void mh_centroid_config_default(struct mh_centroid_config *config)
{
    config->sensing_range_m = MH_REAL(50.0f);
    config->strongest = 0;
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_centroid_state *centroid = state;
    const struct mh_centroid_config *given = config;
    if (centroid == NULL || given == NULL || interval < 1 || interval > 3600000u ||
        !mh_within(given->sensing_range_m, MH_REAL(1e-2f), MH_CENTROID_RANGE_MAX) ||
        given->strongest > MH_CENTROID_STRONGEST_MAX) {
        return MH_ERR_ARGUMENT;
    }
    const struct mh_centroid_state begun = {.config = *given};
    *centroid = begun;
    return MH_OK;
}

static struct mh_estimate answer_at(const struct mh_centroid_state *centroid, mh_tick time)
{
    const struct mh_estimate answer = {.origin = centroid->origin,
                                       .time = time,
                                       .position = centroid->position,
                                       .raw = centroid->position,
                                       .stored = centroid->position,
                                       .flags = MH_ESTIMATE_COASTED};
    return answer;
}

/* The mean place of the `most` measurements of the largest values, the first of equals first; count > most. */
static struct mh_vec2 centroid_of_strongest(const struct mh_measurement *measurements, size_t count, uint8_t most,
                                            const struct mh_place *origin)
{
    size_t kept[MH_CENTROID_STRONGEST_MAX]; /* strongest first */
    uint8_t kept_count = 0;
    for (size_t i = 0; i < count; i++) {
        uint8_t place = kept_count;
        while (place > 0 && measurements[kept[place - 1]].value < measurements[i].value) {
            place--;
        }
        if (place == most) {
            continue;
        }
        kept_count = (uint8_t)(kept_count < most ? kept_count + 1 : most);
        for (uint8_t k = (uint8_t)(kept_count - 1); k > place; k--) {
            kept[k] = kept[k - 1];
        }
        kept[place] = i;
    }
    struct mh_place_sum sum = {0, 0};
    for (uint8_t k = 0; k < kept_count; k++) {
        mh_place_sum_add(&sum, &measurements[kept[k]].place, origin);
    }
    return mh_place_sum_mean(&sum, kept_count);
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_centroid_state *centroid = state;
    if (centroid == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (centroid->stepped && !mh_tick_before(centroid->time, time)) {
        return MH_ERR_TIME;
    }
    const bool begins = !centroid->tracking;
    if (count == 0) {
        centroid->stepped = true;
        centroid->time = time;
        if (begins) {
            return MH_NONE;
        }
        *estimate = answer_at(centroid, time);
    } else {
        struct mh_place origin = centroid->origin;
        if (begins) {
            origin = measurements[0].place;
            origin.z_mm = 0;
        }
        const uint8_t most = centroid->config.strongest;
        const bool all = most == 0 || count <= most;
        const size_t used = all ? count : most;
        const struct mh_vec2 position =
            all ? mh_centroid(measurements, count, &origin) : centroid_of_strongest(measurements, count, most, &origin);
        if (!mh_vec2_finite(position)) {
            return MH_ERR_NOT_FINITE;
        }
        centroid->origin = origin;
        centroid->position = position;
        centroid->tracking = centroid->stepped = true;
        centroid->time = time;
        *estimate = answer_at(centroid, time);
        estimate->measurements = (uint16_t)(used < UINT16_MAX ? used : UINT16_MAX);
        const mh_real radius = centroid->config.sensing_range_m;
        estimate->covariance.xx = estimate->covariance.yy =
            mh_wide_div(mh_wide_mul(radius, radius), 4 * mh_real_from_int((int32_t)used));
        estimate->states = 2;
        estimate->flags = begins ? MH_ESTIMATE_STARTED : 0;
    }
    estimate->flags |= MH_ESTIMATE_REFRESHED;
    return MH_OK;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_centroid_state *centroid = state;
    if (centroid == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!centroid->tracking) {
        return MH_NONE;
    }
    if (mh_tick_before(time, centroid->time)) {
        return MH_ERR_TIME;
    }
    *estimate = answer_at(centroid, time);
    return MH_OK;
}

static enum mh_status save(const void *state, uint8_t *bytes, size_t *length)
{
    const struct mh_centroid_state *centroid = state;
    if (centroid == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!centroid->tracking) {
        return MH_NONE;
    }
    const struct mh_place place = mh_place_from_offset(&centroid->origin, centroid->position);
    uint8_t *at = bytes;
    mh_put_u32(&at, centroid->time);
    mh_put_u32(&at, (uint32_t)place.x_mm);
    mh_put_u32(&at, (uint32_t)place.y_mm);
    *length = BYTES;
    return MH_OK;
}

static enum mh_status load(void *state, const uint8_t *bytes, size_t length)
{
    struct mh_centroid_state *centroid = state;
    if (centroid == NULL || bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (length != BYTES) {
        return MH_ERR_CORRUPT;
    }
    const uint8_t *at = bytes;
    const mh_tick time = mh_get_u32(&at);
    struct mh_place place = {.z_mm = 0};
    place.x_mm = mh_get_i32(&at);
    place.y_mm = mh_get_i32(&at);
    if (!mh_coordinate_valid(place.x_mm) || !mh_coordinate_valid(place.y_mm)) {
        return MH_ERR_CORRUPT;
    }
    const struct mh_centroid_state loaded = {
        .config = centroid->config, .origin = place, .time = time, .stepped = true, .tracking = true};
    *centroid = loaded;
    return MH_OK;
}

static void restart(void *state) { (void)state; }

const struct mh_tracker mh_tracker_centroid = {
    .name = "centroid",
    .state_size = sizeof(struct mh_centroid_state),
    .config_size = sizeof(struct mh_centroid_config),
    .init = init,
    .step = step,
    .predict = predict,
    .save = save,
    .load = load,
    .restart = restart,
};
