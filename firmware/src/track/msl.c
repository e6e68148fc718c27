#include "motehound/msl.h"

#include "motehound/bytes.h"

#define SPEED_SIGMAS 3.0f
#define TRIES 20      /* a particle wanted */
#define BOX_TRIES 200 /* in the bounding box */
#define HEAD_BYTES 12
#define PARTICLE_BYTES 4
#define SAVED_MAX ((MH_TRACK_BYTES_MAX - HEAD_BYTES) / PARTICLE_BYTES)

void mh_msl_config_default(struct mh_msl_config *config)
{
    const struct mh_msl_config nominal = {
        .speed_mps = 4.4704f, .speed_sd_mps = 0.89408f, .sensing_range_m = 50.0f, .particles = 50, .seed = 1};
    *config = nominal;
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_msl *msl = state;
    const struct mh_msl_config *given = config;
    if (msl == NULL || given == NULL || interval < 1 || interval > 3600000u ||
        !mh_within(given->speed_mps, 1e-3f, 1e3f) || !mh_within(given->speed_sd_mps, 0.0f, 1e3f) ||
        !mh_within(given->sensing_range_m, 1e-2f, 1e4f) || given->particles < 1 ||
        given->particles > MH_PARTICLES_MAX) {
        return MH_ERR_ARGUMENT;
    }
    memset(msl, 0, sizeof *msl);
    msl->config = *given;
    msl->reach_m =
        (given->speed_mps + SPEED_SIGMAS * given->speed_sd_mps) * (mh_real)interval * (1.0f / (mh_real)MH_TICKS_PER_S);
    mh_random_init(&msl->random, given->seed);
    return MH_OK;
}

/* True if every node that measures can sense a target at (x, y). */
static bool sensed_by_all(const struct mh_msl *msl, mh_real x, mh_real y, const struct mh_measurement *measurements,
                          size_t count)
{
    const mh_real square = mh_squared(msl->config.sensing_range_m);
    for (size_t j = 0; j < count; j++) {
        const struct mh_vec2 node = mh_place_relative(&measurements[j].place, &msl->origin);
        if (!(mh_squared(x - node.x) + mh_squared(y - node.y) <= square)) {
            return false;
        }
    }
    return true;
}

/* The box that holds the intersection of the discs: -> centre and half its sides, which are negative if it is empty. */
static void box_of(const struct mh_msl *msl, const struct mh_measurement *measurements, size_t count,
                   struct mh_vec2 *centre, struct mh_vec2 *half)
{
    struct mh_vec2 least = mh_place_relative(&measurements[0].place, &msl->origin), largest = least;
    for (size_t j = 1; j < count; j++) {
        const struct mh_vec2 node = mh_place_relative(&measurements[j].place, &msl->origin);
        least.x = mh_min(least.x, node.x);
        least.y = mh_min(least.y, node.y);
        largest.x = mh_max(largest.x, node.x);
        largest.y = mh_max(largest.y, node.y);
    }
    centre->x = 0.5f * (least.x + largest.x);
    centre->y = 0.5f * (least.y + largest.y);
    half->x = msl->config.sensing_range_m - 0.5f * (largest.x - least.x);
    half->y = msl->config.sensing_range_m - 0.5f * (largest.y - least.y);
}

/* Draw into `next` until it has N particles that count or `tries` have been drawn: about random old ones, or in a box if one is given. */
static void draw(struct mh_msl *msl, const struct mh_measurement *measurements, size_t count,
                 const struct mh_vec2 *centre, const struct mh_vec2 *half, uint32_t tries)
{
    struct mh_particles *next = &msl->next;
    for (; tries > 0 && next->count < msl->config.particles; tries--) {
        const mh_real u = mh_random_unit(&msl->random), w = mh_random_unit(&msl->random);
        mh_real x, y;
        if (centre != NULL) {
            x = centre->x + (2.0f * u - 1.0f) * half->x;
            y = centre->y + (2.0f * w - 1.0f) * half->y;
        } else {
            const uint16_t old = mh_random_below(&msl->random, msl->count);
            const mh_real radius = msl->reach_m * mh_sqrt(u);
            const struct mh_vec2 direction = mh_direction(MH_PI * (2.0f * w - 1.0f));
            x = msl->x[old] + radius * direction.x;
            y = msl->y[old] + radius * direction.y;
        }
        msl->draws++;
        if (sensed_by_all(msl, x, y, measurements, count)) {
            next->x[next->count] = x;
            next->y[next->count] = y;
            next->count++;
        }
    }
}

/* The new particles, N of them, each of weight 1; `anew`: not from the old ones, but from measurements, of which there are some. */
static void renew(struct mh_msl *msl, bool anew, const struct mh_measurement *measurements, size_t count)
{
    struct mh_particles *next = &msl->next;
    const uint16_t wanted = msl->config.particles;
    next->count = 0;
    if (!anew) {
        draw(msl, measurements, count, NULL, NULL, (uint32_t)TRIES * wanted);
    }
    if (next->count == 0) {
        struct mh_vec2 centre, half;
        box_of(msl, measurements, count, &centre, &half);
        if (half.x >= 0.0f && half.y >= 0.0f) {
            draw(msl, measurements, count, &centre, &half, (uint32_t)BOX_TRIES * wanted);
        }
    }
    if (next->count == 0) {
        const struct mh_vec2 centroid = mh_centroid(measurements, count, &msl->origin);
        next->x[0] = centroid.x;
        next->y[0] = centroid.y;
        next->count = 1;
    }
    for (uint16_t i = next->count; i < wanted; i++) {
        const uint16_t from = mh_random_below(&msl->random, next->count);
        next->x[i] = next->x[from];
        next->y[i] = next->y[from];
    }
    next->count = wanted;
    for (uint16_t i = 0; i < wanted; i++) {
        next->weight[i] = 1.0f;
    }
}

static struct mh_estimate answer_at(const struct mh_msl *msl, mh_tick time)
{
    const struct mh_estimate answer = {.origin = msl->origin,
                                       .time = time,
                                       .position = msl->position,
                                       .raw = msl->position,
                                       .stored = msl->position,
                                       .flags = MH_ESTIMATE_COASTED};
    return answer;
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_msl *msl = state;
    if (msl == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (msl->stepped && !mh_tick_before(msl->time, time)) {
        return MH_ERR_TIME;
    }
    msl->stepped = true;
    msl->time = time;
    const bool begins = msl->count == 0;
    if (count == 0 && begins) {
        return MH_NONE;
    }
    if (begins) {
        msl->origin = measurements[0].place;
        msl->origin.z_mm = 0;
    }
    renew(msl, begins || (msl->restarted && count > 0), measurements, count);
    struct mh_vec2 mean;
    struct mh_sym2 covariance;
    /* a particle stands for its share of the disc it was drawn from */
    const mh_real resolution = mh_squared(msl->reach_m) / (2.0f * (mh_real)msl->next.count);
    const enum mh_status status = mh_particles_mean(&msl->next, resolution, &mean, &covariance);
    if (status != MH_OK) {
        return status;
    }
    msl->restarted = msl->restarted && count == 0;
    msl->count = msl->next.count;
    memcpy(msl->x, msl->next.x, sizeof msl->x);
    memcpy(msl->y, msl->next.y, sizeof msl->y);
    msl->position = mean;
    *estimate = answer_at(msl, time);
    estimate->covariance = covariance;
    estimate->states = 2;
    estimate->measurements = (uint16_t)(count < UINT16_MAX ? count : UINT16_MAX);
    estimate->flags =
        (uint8_t)(MH_ESTIMATE_REFRESHED | (begins ? MH_ESTIMATE_STARTED : 0) | (count == 0 ? MH_ESTIMATE_COASTED : 0));
    return MH_OK;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_msl *msl = state;
    if (msl == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (msl->count == 0) {
        return MH_NONE;
    }
    if (mh_tick_before(time, msl->time)) {
        return MH_ERR_TIME;
    }
    *estimate = answer_at(msl, time);
    return MH_OK;
}

/* a - b in cm, as far as 16 bits reach */
static uint16_t offset_cm(mh_real a, mh_real b)
{
    const mh_real cm = mh_clamp((a - b) * 100.0f, -32767.0f, 32767.0f);
    return (uint16_t)(int16_t)(cm < 0 ? cm - 0.5f : cm + 0.5f);
}

static enum mh_status save(const void *state, uint8_t *bytes, size_t *length)
{
    const struct mh_msl *msl = state;
    if (msl == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (msl->count == 0) {
        return MH_NONE;
    }
    const struct mh_place place = mh_place_from_offset(&msl->origin, msl->position);
    uint8_t *at = bytes;
    mh_put_u32(&at, msl->time);
    mh_put_u32(&at, (uint32_t)place.x_mm);
    mh_put_u32(&at, (uint32_t)place.y_mm);
    const uint16_t saved = msl->count < SAVED_MAX ? msl->count : SAVED_MAX;
    for (uint16_t i = 0; i < saved; i++) {
        const uint16_t from = (uint16_t)((uint32_t)i * msl->count / saved);
        mh_put_u16(&at, offset_cm(msl->x[from], msl->position.x));
        mh_put_u16(&at, offset_cm(msl->y[from], msl->position.y));
    }
    *length = (size_t)(at - bytes);
    return MH_OK;
}

static enum mh_status load(void *state, const uint8_t *bytes, size_t length)
{
    struct mh_msl *msl = state;
    if (msl == NULL || bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (length < HEAD_BYTES + PARTICLE_BYTES || length > MH_TRACK_BYTES_MAX ||
        (length - HEAD_BYTES) % PARTICLE_BYTES != 0) {
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
    const uint16_t saved = (uint16_t)((length - HEAD_BYTES) / PARTICLE_BYTES);
    msl->count = saved < MH_PARTICLES_MAX ? saved : MH_PARTICLES_MAX;
    for (uint16_t i = 0; i < msl->count; i++) {
        msl->x[i] = (mh_real)mh_get_i16(&at) * 0.01f;
        msl->y[i] = (mh_real)mh_get_i16(&at) * 0.01f;
    }
    msl->origin = place;
    msl->position.x = msl->position.y = 0.0f;
    msl->time = time;
    msl->stepped = true;
    msl->restarted = false;
    mh_random_init(&msl->random, msl->config.seed ^ time); /* no two heads draw the same */
    return MH_OK;
}

static void restart(void *state)
{
    struct mh_msl *msl = state;
    msl->restarted = true;
}

const struct mh_tracker mh_tracker_msl = {
    .name = "msl",
    .state_size = sizeof(struct mh_msl),
    .config_size = sizeof(struct mh_msl_config),
    .init = init,
    .step = step,
    .predict = predict,
    .save = save,
    .load = load,
    .restart = restart,
};
