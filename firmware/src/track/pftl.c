#include "motehound/pftl.h"

#include "motehound/bytes.h"

#include <string.h>

#define LEVELS 5 /* of widening; the last is the disc about the nodes */
#define HALF_ANGLE (MH_PI / 3)
#define SPEED_SIGMAS 3
#define GATE_SIGMAS 6
#define BYTES_AT_REST 12
#define BYTES_MOVING 20

void mh_pftl_config_default(struct mh_pftl_config *config)
{
    const struct mh_pftl_config nominal = {.speed_mps = MH_REAL(4.4704f),
                                           .speed_sd_mps = MH_REAL(0.89408f),
                                           .sensing_range_m = MH_REAL(50.0f),
                                           .range_sd_m = MH_REAL(5.0f),
                                           .tolerance_m = MH_REAL(5.0f),
                                           .particles = 50,
                                           .seed = 1};
    *config = nominal;
}

static mh_real largest_speed(const struct mh_pftl_config *config)
{
    return mh_add(config->speed_mps, SPEED_SIGMAS * config->speed_sd_mps);
}

static mh_real slack(const struct mh_pftl_config *config) { return GATE_SIGMAS * config->range_sd_m; }

/* From the apex of a region, as expect() and localise() make them, to the farthest of its particles, and from there to a node that measured one. */
static mh_real extent(const struct mh_pftl_config *config, mh_real interval_s)
{
    const mh_real reach = mh_mul(largest_speed(config), interval_s), range = config->sensing_range_m;
    const mh_real levels = MH_REAL((float)(LEVELS - 1));
    const mh_real moving = mh_add(reach, mh_mul(levels, mh_max(config->tolerance_m, reach / 2)));
    const mh_real starting = mh_add(range / 2, mh_add(reach, mh_mul(levels, reach)));
    const mh_real region = mh_add(mh_max(moving, starting), mh_mul(MH_REAL(1.5f), config->range_sd_m));
    return mh_add(mh_max(region, range), mh_add(range, slack(config)));
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_pftl *pftl = state;
    const struct mh_pftl_config *given = config;
    if (pftl == NULL || given == NULL || interval < 1 || interval > 3600000u ||
        !mh_within(given->speed_mps, MH_REAL(1e-3f), MH_REAL(1e3f)) ||
        !mh_within(given->speed_sd_mps, 0, MH_REAL(1e3f)) ||
        !mh_within(given->sensing_range_m, MH_REAL(1e-2f), MH_PFTL_RANGE_MAX) ||
        !mh_within(given->range_sd_m, MH_REAL(1e-3f), MH_PFTL_SD_MAX) ||
        !mh_within(given->tolerance_m, 0, MH_REAL(1e4f)) || given->particles < 1 ||
        given->particles > MH_PARTICLES_MAX) {
        return MH_ERR_ARGUMENT;
    }
    const mh_real interval_s = mh_real_from_ratio((int32_t)interval, (int32_t)MH_TICKS_PER_S);
    if (mh_particles_init(&pftl->particles, given->particles, extent(given, interval_s), given->range_sd_m) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    const struct mh_followed nothing = {.known = false};
    pftl->config = *given;
    pftl->interval_s = interval_s;
    mh_random_init(&pftl->random, given->seed);
    pftl->draws = 0;
    pftl->stepped = pftl->restarted = pftl->moving = false;
    pftl->buffer = nothing;
    return MH_OK;
}

/* The ranges of one instant, and where in the plane they are looked for. */
struct search {
    struct mh_pftl *pftl;
    const struct mh_measurement *measurements;
    size_t count;
    struct mh_sector region;
    mh_particle_weight least; /* sum of squared residuals */
};

static bool usable(const struct mh_pftl *pftl, const struct mh_measurement *m)
{
    const mh_real beyond = slack(&pftl->config);
    return mh_within(mh_q20_to_real(m->value), -beyond, pftl->config.sensing_range_m + beyond);
}

/* The mean place of the n >= 1 nodes whose ranges are usable, relative to `origin`; infinite where that has no room. */
static struct mh_vec2 centre_of(const struct search *search, uint16_t n, const struct mh_place *origin)
{
#if MH_REAL_FIXED /* in the integers of places: far ones among them, relative to the origin, would be of no size */
    struct mh_place_sum sum = {0, 0};
    for (size_t j = 0; j < search->count; j++) {
        if (usable(search->pftl, &search->measurements[j])) {
            mh_place_sum_add(&sum, &search->measurements[j].place, origin);
        }
    }
    return mh_place_sum_mean(&sum, n);
#else
    struct mh_vec2 centre = {0, 0};
    for (size_t j = 0; j < search->count; j++) {
        if (usable(search->pftl, &search->measurements[j])) {
            const struct mh_vec2 at = mh_place_relative(&search->measurements[j].place, origin);
            centre.x += mh_div(at.x, mh_real_from_int(n));
            centre.y += mh_div(at.y, mh_real_from_int(n));
        }
    }
    return centre;
#endif
}

/* Draw particles from, .. in the region and sum their squared residuals: of sums that are to be compared with `least`; no more once all are above the bound, if
 * there is one. */
static void draw(struct search *search, uint16_t from, mh_particle_weight least, mh_particle_weight bound)
{
    struct mh_pftl *pftl = search->pftl;
    struct mh_particles *particles = &pftl->particles;
    const mh_particle_weight beyond = mh_particles_worthless(particles, least, pftl->config.range_sd_m);
    mh_particles_draw(particles, from, &search->region, &pftl->random);
    pftl->draws += (uint32_t)(particles->count - from);
    for (size_t j = 0; j < search->count; j++) {
        const struct mh_measurement *m = &search->measurements[j];
        if (!usable(pftl, m)) {
            continue;
        }
        mh_particles_add_range(particles, from, mh_place_relative(&m->place, &pftl->origin), mh_q20_to_real(m->value),
                               beyond);
        if (bound < MH_PARTICLE_SUM_MAX && mh_particles_least(particles) > bound) {
            return;
        }
    }
}

static void redraw(void *context, struct mh_particles *particles, uint16_t from)
{
    struct search *search = context;
    draw(search, from, search->least, MH_PARTICLE_SUM_MAX);
    mh_particles_weigh(particles, from, search->least, search->pftl->config.range_sd_m);
}

/* Where the target can be, from the place expected now: the region of level 0, and by how much a level widens it. */
static void expect(const struct mh_pftl *pftl, struct mh_vec2 expected, uint16_t n, struct mh_sector *region,
                   mh_real *widening)
{
    const struct mh_vec2 v = pftl->buffer.velocity;
    const mh_real speed = mh_vec2_length(v), interval = pftl->interval_s;
    const mh_real reach = mh_mul(largest_speed(&pftl->config), interval);
    const mh_real slowest = pftl->config.speed_mps - SPEED_SIGMAS * pftl->config.speed_sd_mps;
    region->apex = expected;
    region->axis.x = speed > 0 ? mh_div(v.x, speed) : MH_REAL(1.0f);
    region->axis.y = speed > 0 ? mh_div(v.y, speed) : 0;
    if (pftl->moving) {
        region->apex = mh_vec2_along(expected, -interval, v);
        region->inner = mh_max(0, mh_mul(slowest, interval));
        region->outer = reach;
        region->half_angle = HALF_ANGLE;
        *widening = mh_max(pftl->config.tolerance_m, reach / 2);
    } else {
        region->inner = 0;
        region->outer = reach + pftl->config.sensing_range_m / 2;
        region->half_angle = MH_PI;
        *widening = reach;
    }
    const mh_real margin = mh_mul(pftl->config.range_sd_m, mh_sqrt(mh_div(MH_REAL(2.0f), mh_real_from_int(n))));
    region->half_angle = mh_min(MH_PI, region->half_angle + mh_atan2(margin, (region->inner + region->outer) / 2));
    region->inner = mh_max(0, region->inner - margin);
    region->outer += margin;
}

/* The largest sum of a particle that fits the n ranges: residuals as their noise makes them, and as much again as the distance to the nearest of N particles does. */
static mh_particle_weight fit(const struct search *search, uint16_t n)
{
    const struct mh_pftl_config *config = &search->pftl->config;
    const mh_real ranges = mh_real_from_int(n);
    const mh_wide noise = mh_wide_mul(mh_squared(config->range_sd_m), ranges + mh_sqrt(2 * ranges));
    const mh_wide spacing = mh_sector_share(&search->region, 3 * ranges, config->particles);
    return mh_particles_sum(&search->pftl->particles, noise + spacing);
}

/* What an instant gives; whole estimates are large, and the search goes deep. */
struct fix {
    struct mh_vec2 position;
    struct mh_sym2 covariance;
    uint16_t flags;
};

/* Position from n >= 1 usable ranges, about the place expected now. */
static enum mh_status localise(struct search *search, struct mh_vec2 expected, uint16_t n, struct fix *fix)
{
    struct mh_pftl *pftl = search->pftl;
    struct mh_particles *particles = &pftl->particles;
    const mh_real enough = mh_real_from_int(particles->count) / 2;
    struct mh_sector level_0;
    mh_real widening;
    expect(pftl, expected, n, &level_0, &widening);
    mh_real effective = 0;
    bool accepted = false;
    for (uint8_t level = pftl->restarted ? LEVELS : 0; !accepted; level++) {
        struct mh_sector *region = &search->region;
        *region = level_0;
        if (level < LEVELS) {
            const mh_real wider = mh_mul(mh_real_from_int(level), widening);
            region->inner = mh_max(0, level_0.inner - wider);
            region->outer += wider;
            region->half_angle = mh_min(MH_PI, mh_mul(mh_real_from_int(1 + level), level_0.half_angle));
        } else {
            region->apex = centre_of(search, n, &pftl->origin);
            region->inner = 0;
            region->outer = pftl->config.sensing_range_m;
            region->half_angle = MH_PI;
        }
        if (!mh_vec2_finite(region->apex)) {
            return MH_ERR_NOT_FINITE;
        }
        const bool last = level == LEVELS;
        const mh_particle_weight bound = last || pftl->config.literal ? MH_PARTICLE_SUM_MAX : fit(search, n);
        draw(search, 0, bound, bound);
        search->least = mh_particles_least(particles);
        if (search->least > bound) {
            continue;
        }
        mh_particles_weigh(particles, 0, search->least, pftl->config.range_sd_m);
        effective = mh_particles_effective(particles);
        accepted = last || !pftl->config.literal || effective > enough;
    }
    enum mh_status status = MH_OK;
    if (effective <= enough) {
        status = pftl->config.systematic ? mh_particles_resample(particles, &pftl->random)
                                         : mh_particles_reject(particles, &pftl->random, redraw, search);
    }
    /* a particle stands for its share of the region's area */
    const mh_real resolution = mh_wide_to_real(mh_sector_share(&search->region, MH_REAL(1.0f), particles->count));
    if (status == MH_OK) {
        status = mh_particles_mean(particles, resolution, &fix->position, &fix->covariance);
    }
    return status;
}

static void store(struct mh_pftl *pftl, mh_tick time, struct mh_vec2 position)
{
    struct mh_vec2 v = {0, 0};
    pftl->moving = pftl->buffer.known && !pftl->restarted;
    if (pftl->moving) {
        const mh_real seconds = mh_seconds_between(pftl->buffer.time, time);
        v = mh_vec2_between(pftl->buffer.position, position);
        v.x = mh_div(v.x, seconds);
        v.y = mh_div(v.y, seconds);
        const mh_real excess = mh_div(mh_vec2_length(v), largest_speed(&pftl->config));
        if (excess > MH_REAL(1.0f)) {
            v.x = mh_div(v.x, excess);
            v.y = mh_div(v.y, excess);
        }
    }
    const struct mh_followed buffer = {.time = time, .position = position, .velocity = v, .known = true};
    pftl->buffer = buffer;
    pftl->restarted = false;
}

static void answer(const struct mh_pftl *pftl, const struct fix *fix, uint16_t n, struct mh_vec2 stored,
                   struct mh_estimate *estimate)
{
    memset(estimate, 0, sizeof *estimate);
    estimate->origin = pftl->origin;
    estimate->time = pftl->time;
    estimate->position = estimate->raw = fix->position;
    estimate->velocity = estimate->stored_velocity = pftl->buffer.velocity;
    estimate->covariance = fix->covariance;
    estimate->stored = stored;
    estimate->measurements = n;
    estimate->flags = fix->flags;
    estimate->states = fix->covariance.xx > 0 ? 2 : 0;
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_pftl *pftl = state;
    if (pftl == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (pftl->stepped && !mh_tick_before(pftl->time, time)) {
        return MH_ERR_TIME;
    }
    uint16_t n = 0;
    for (size_t j = 0; j < count && n < UINT16_MAX; j++) {
        n = (uint16_t)(n + (usable(pftl, &measurements[j]) ? 1 : 0));
    }
    struct fix fix = {.flags = 0};
    struct search search = {.pftl = pftl, .measurements = measurements, .count = count};
    struct mh_vec2 expected = {0, 0};
    const bool begins = !pftl->buffer.known;
    bool refreshed = false;
    if (begins) {
        if (n == 0) {
            pftl->stepped = true;
            pftl->time = time;
            return MH_NONE;
        }
        struct mh_place origin = measurements[0].place;
        origin.z_mm = 0;
        fix.position = centre_of(&search, n, &origin);
        if (!mh_vec2_finite(fix.position)) {
            return MH_ERR_NOT_FINITE;
        }
        pftl->origin = origin;
        const mh_real radius = pftl->config.sensing_range_m;
        fix.covariance.xx = fix.covariance.yy = mh_wide_div(mh_wide_mul(radius, radius), 4 * mh_real_from_int(n));
        fix.flags = MH_ESTIMATE_STARTED;
        refreshed = true;
    } else {
        enum mh_status status = mh_followed_predict(&pftl->buffer, time, &expected);
        if (status != MH_OK) {
            return status;
        }
        status = n > 0 ? localise(&search, expected, n, &fix) : MH_NONE;
        if (status == MH_ERR_NOT_FINITE) {
            return status;
        }
        if (status != MH_OK) {
            fix.position = expected;
            fix.flags = MH_ESTIMATE_COASTED;
        } else {
            refreshed = !pftl->moving || pftl->restarted ||
                        mh_followed_differs(&pftl->buffer, time, fix.position, pftl->config.tolerance_m);
        }
    }
    pftl->stepped = true;
    pftl->time = time;
    if (refreshed) {
        store(pftl, time, fix.position);
        fix.flags |= MH_ESTIMATE_REFRESHED;
    }
    answer(pftl, &fix, n, refreshed ? fix.position : expected, estimate);
    return MH_OK;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_pftl *pftl = state;
    if (pftl == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    struct mh_vec2 position;
    if (!pftl->buffer.known) {
        return MH_NONE;
    }
    if (mh_tick_before(time, pftl->time)) {
        return MH_ERR_TIME;
    }
    const enum mh_status status = mh_followed_predict(&pftl->buffer, time, &position);
    if (status != MH_OK) {
        return status;
    }
    const struct mh_estimate answer = {.origin = pftl->origin,
                                       .time = time,
                                       .position = position,
                                       .velocity = pftl->buffer.velocity,
                                       .raw = position,
                                       .stored = position,
                                       .stored_velocity = pftl->buffer.velocity,
                                       .flags = MH_ESTIMATE_COASTED};
    *estimate = answer;
    return MH_OK;
}

static enum mh_status save(const void *state, uint8_t *bytes, size_t *length)
{
    const struct mh_pftl *pftl = state;
    if (pftl == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!pftl->buffer.known) {
        return MH_NONE;
    }
    const struct mh_place place = mh_place_from_offset(&pftl->origin, pftl->buffer.position);
    uint8_t *at = bytes;
    mh_put_u32(&at, pftl->buffer.time);
    mh_put_u32(&at, (uint32_t)place.x_mm);
    mh_put_u32(&at, (uint32_t)place.y_mm);
    if (pftl->moving) {
        mh_put_real(&at, pftl->buffer.velocity.x);
        mh_put_real(&at, pftl->buffer.velocity.y);
    }
    *length = (size_t)(at - bytes);
    return MH_OK;
}

static enum mh_status load(void *state, const uint8_t *bytes, size_t length)
{
    struct mh_pftl *pftl = state;
    if (pftl == NULL || bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (length != BYTES_AT_REST && length != BYTES_MOVING) {
        return MH_ERR_CORRUPT;
    }
    const uint8_t *at = bytes;
    const mh_tick time = mh_get_u32(&at);
    struct mh_place place = {.z_mm = 0};
    place.x_mm = mh_get_i32(&at);
    place.y_mm = mh_get_i32(&at);
    struct mh_vec2 v = {0, 0};
    if (length == BYTES_MOVING) {
        v.x = mh_get_real(&at);
        v.y = mh_get_real(&at);
    }
    /* a rounding above the largest speed at most: heads of one field know the same class */
    if (!mh_coordinate_valid(place.x_mm) || !mh_coordinate_valid(place.y_mm) ||
        !(mh_vec2_length(v) <= mh_mul(MH_REAL(1.001f), largest_speed(&pftl->config)))) {
        return MH_ERR_CORRUPT;
    }
    const struct mh_followed buffer = {.time = time, .velocity = v, .known = true};
    pftl->buffer = buffer;
    pftl->origin = place;
    pftl->time = time;
    pftl->stepped = true;
    pftl->restarted = false;
    mh_random_init(&pftl->random, pftl->config.seed ^ time); /* no two heads draw the same */
    pftl->moving = length == BYTES_MOVING;
    return MH_OK;
}

static void restart(void *state)
{
    struct mh_pftl *pftl = state;
    pftl->restarted = true;
}

const struct mh_tracker mh_tracker_pftl = {
    .name = "pftl",
    .state_size = sizeof(struct mh_pftl),
    .config_size = sizeof(struct mh_pftl_config),
    .init = init,
    .step = step,
    .predict = predict,
    .save = save,
    .load = load,
    .restart = restart,
};
