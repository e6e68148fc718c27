#include "motehound/pftl.h"

#include "motehound/bytes.h"

#define LEVELS 5 /* of widening; the last is the disc about the nodes */
#define HALF_ANGLE (MH_PI / 3.0f)
#define SPEED_SIGMAS 3.0f
#define GATE_SIGMAS 6.0f
#define BYTES_AT_REST 12
#define BYTES_MOVING 20

void mh_pftl_config_default(struct mh_pftl_config *config)
{
    const struct mh_pftl_config nominal = {.speed_mps = 4.4704f,
                                           .speed_sd_mps = 0.89408f,
                                           .sensing_range_m = 50.0f,
                                           .range_sd_m = 5.0f,
                                           .tolerance_m = 5.0f,
                                           .particles = 50,
                                           .seed = 1};
    *config = nominal;
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_pftl *pftl = state;
    const struct mh_pftl_config *given = config;
    if (pftl == NULL || given == NULL || interval < 1 || interval > 3600000u ||
        !mh_within(given->speed_mps, 1e-3f, 1e3f) || !mh_within(given->speed_sd_mps, 0.0f, 1e3f) ||
        !mh_within(given->sensing_range_m, 1e-2f, 1e4f) || !mh_within(given->range_sd_m, 1e-3f, 1e3f) ||
        !mh_within(given->tolerance_m, 0.0f, 1e4f) || given->particles < 1 || given->particles > MH_PARTICLES_MAX) {
        return MH_ERR_ARGUMENT;
    }
    memset(pftl, 0, sizeof *pftl);
    pftl->config = *given;
    pftl->interval_s = (mh_real)interval * (1.0f / (mh_real)MH_TICKS_PER_S);
    pftl->particles.count = given->particles;
    mh_random_init(&pftl->random, given->seed);
    return MH_OK;
}

static mh_real largest_speed(const struct mh_pftl *pftl)
{
    return pftl->config.speed_mps + SPEED_SIGMAS * pftl->config.speed_sd_mps;
}

/* The ranges of one instant, and where in the plane they are looked for. */
struct search {
    struct mh_pftl *pftl;
    const struct mh_measurement *measurements;
    size_t count;
    struct mh_sector region;
    mh_real least; /* sum of squared residuals */
};

static bool usable(const struct mh_pftl *pftl, const struct mh_measurement *m)
{
    const mh_real slack = GATE_SIGMAS * pftl->config.range_sd_m;
    return mh_within(mh_q20_to_real(m->value), -slack, pftl->config.sensing_range_m + slack);
}

/* The mean place of the n >= 1 nodes whose ranges are usable. */
static struct mh_vec2 centre_of(const struct search *search, uint16_t n)
{
    struct mh_vec2 centre = {0, 0};
    for (size_t j = 0; j < search->count; j++) {
        if (usable(search->pftl, &search->measurements[j])) {
            const struct mh_vec2 at = mh_place_relative(&search->measurements[j].place, &search->pftl->origin);
            centre.x += at.x / (mh_real)n;
            centre.y += at.y / (mh_real)n;
        }
    }
    return centre;
}

/* Draw particles from, .. in the region and sum their squared residuals. */
static void draw(struct search *search, uint16_t from)
{
    struct mh_pftl *pftl = search->pftl;
    struct mh_particles *particles = &pftl->particles;
    mh_particles_draw(particles, from, &search->region, &pftl->random);
    for (size_t j = 0; j < search->count; j++) {
        const struct mh_measurement *m = &search->measurements[j];
        if (usable(pftl, m)) {
            mh_particles_add_range(particles, from, mh_place_relative(&m->place, &pftl->origin),
                                   mh_q20_to_real(m->value));
        }
    }
    pftl->draws += (uint32_t)(particles->count - from);
}

static void redraw(void *context, struct mh_particles *particles, uint16_t from)
{
    struct search *search = context;
    draw(search, from);
    mh_particles_weigh(particles, from, search->least, search->pftl->config.range_sd_m);
}

/* Where the target can be, from the place expected now: the region of level 0, and by how much a level widens it. */
static void expect(const struct mh_pftl *pftl, struct mh_vec2 expected, uint16_t n, struct mh_sector *region,
                   mh_real *widening)
{
    const struct mh_vec2 v = pftl->buffer.velocity;
    const mh_real speed = mh_sqrt(v.x * v.x + v.y * v.y), interval = pftl->interval_s;
    const mh_real reach = largest_speed(pftl) * interval;
    const mh_real slowest = pftl->config.speed_mps - SPEED_SIGMAS * pftl->config.speed_sd_mps;
    region->apex = expected;
    region->axis.x = speed > 0.0f ? v.x / speed : 1.0f;
    region->axis.y = speed > 0.0f ? v.y / speed : 0.0f;
    if (pftl->moving) {
        region->apex.x -= v.x * interval;
        region->apex.y -= v.y * interval;
        region->inner = mh_max(0.0f, slowest * interval);
        region->outer = reach;
        region->half_angle = HALF_ANGLE;
        *widening = mh_max(pftl->config.tolerance_m, 0.5f * reach);
    } else {
        region->inner = 0.0f;
        region->outer = reach + 0.5f * pftl->config.sensing_range_m;
        region->half_angle = MH_PI;
        *widening = reach;
    }
    const mh_real margin = pftl->config.range_sd_m * mh_sqrt(2.0f / (mh_real)n);
    region->half_angle = mh_min(MH_PI, region->half_angle + mh_atan2(margin, 0.5f * (region->inner + region->outer)));
    region->inner = mh_max(0.0f, region->inner - margin);
    region->outer += margin;
}

/* A particle fits the n ranges: residuals as their noise makes them, and as much again as the distance to the nearest of N particles does. */
static bool fits(const struct search *search, uint16_t n)
{
    const struct mh_pftl_config *config = &search->pftl->config;
    const mh_real ranges = (mh_real)n;
    const mh_real noise = config->range_sd_m * config->range_sd_m * (ranges + mh_sqrt(2.0f * ranges));
    const mh_real spacing =
        3.0f * ranges * mh_sector_area(&search->region) / (2.0f * MH_PI * (mh_real)config->particles);
    return search->least <= noise + spacing;
}

/* Position from n >= 1 usable ranges, about the place expected now. */
static enum mh_status localise(struct search *search, struct mh_vec2 expected, uint16_t n, struct mh_estimate *estimate)
{
    struct mh_pftl *pftl = search->pftl;
    struct mh_particles *particles = &pftl->particles;
    const mh_real enough = 0.5f * (mh_real)particles->count;
    struct mh_sector level_0;
    mh_real widening;
    expect(pftl, expected, n, &level_0, &widening);
    mh_real effective = 0.0f;
    bool accepted = false;
    for (uint8_t level = pftl->restarted ? LEVELS : 0; !accepted; level++) {
        struct mh_sector *region = &search->region;
        *region = level_0;
        if (level < LEVELS) {
            region->inner = mh_max(0.0f, level_0.inner - (mh_real)level * widening);
            region->outer += (mh_real)level * widening;
            region->half_angle = mh_min(MH_PI, (mh_real)(1 + level) * level_0.half_angle);
        } else {
            region->apex = centre_of(search, n);
            region->inner = 0.0f;
            region->outer = pftl->config.sensing_range_m;
            region->half_angle = MH_PI;
        }
        draw(search, 0);
        search->least = mh_particles_least(particles);
        const bool last = level == LEVELS;
        if (!last && !pftl->config.literal && !fits(search, n)) {
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
    const mh_real resolution = mh_sector_area(&search->region) / (2.0f * MH_PI * (mh_real)particles->count);
    if (status == MH_OK) {
        status = mh_particles_mean(particles, resolution, &estimate->position, &estimate->covariance);
    }
    return status;
}

static void store(struct mh_pftl *pftl, mh_tick time, struct mh_vec2 position)
{
    struct mh_vec2 v = {0, 0};
    pftl->moving = pftl->buffer.known && !pftl->restarted;
    if (pftl->moving) {
        const mh_real seconds = mh_seconds_between(pftl->buffer.time, time);
        v.x = (position.x - pftl->buffer.position.x) / seconds;
        v.y = (position.y - pftl->buffer.position.y) / seconds;
        const mh_real excess = mh_sqrt(v.x * v.x + v.y * v.y) / largest_speed(pftl);
        if (excess > 1.0f) {
            v.x /= excess;
            v.y /= excess;
        }
    }
    const struct mh_followed buffer = {.time = time, .position = position, .velocity = v, .known = true};
    pftl->buffer = buffer;
    pftl->restarted = false;
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
    pftl->stepped = true;
    pftl->time = time;
    uint16_t n = 0;
    for (size_t j = 0; j < count && n < UINT16_MAX; j++) {
        n = (uint16_t)(n + (usable(pftl, &measurements[j]) ? 1 : 0));
    }
    struct mh_estimate answer = {.time = time, .measurements = n};
    struct search search = {.pftl = pftl, .measurements = measurements, .count = count};
    struct mh_vec2 expected = {0, 0};
    const bool begins = !pftl->buffer.known;
    bool refreshed = false;
    if (begins) {
        if (n == 0) {
            return MH_NONE;
        }
        pftl->origin = measurements[0].place;
        pftl->origin.z_mm = 0;
        answer.position = centre_of(&search, n);
        const mh_real radius = pftl->config.sensing_range_m;
        answer.covariance.xx = answer.covariance.yy = radius * radius / (4.0f * (mh_real)n);
        answer.flags = MH_ESTIMATE_STARTED;
        refreshed = true;
    } else {
        if (mh_followed_predict(&pftl->buffer, time, &expected) != MH_OK) {
            return MH_NONE;
        }
        if (n == 0 || localise(&search, expected, n, &answer) != MH_OK) {
            answer.position = expected;
            answer.flags = MH_ESTIMATE_COASTED;
        } else {
            refreshed = !pftl->moving || pftl->restarted ||
                        mh_followed_differs(&pftl->buffer, time, answer.position, pftl->config.tolerance_m);
        }
    }
    if (refreshed) {
        store(pftl, time, answer.position);
        answer.flags |= MH_ESTIMATE_REFRESHED;
    }
    answer.origin = pftl->origin;
    answer.raw = answer.position;
    answer.states = answer.covariance.xx > 0 ? 2 : 0;
    answer.stored = refreshed ? answer.position : expected;
    answer.velocity = answer.stored_velocity = pftl->buffer.velocity;
    *estimate = answer;
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
        !(mh_sqrt(v.x * v.x + v.y * v.y) <= 1.001f * largest_speed(pftl))) {
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
