#include "motehound/range.h"

#include "motehound/bytes.h"
#include "motehound/multilateration.h"
#include "motehound/range_fix.h"
#include "motehound/range_model.h"

#include <string.h>

#define LOST_TICKS (10 * (int32_t)MH_TICKS_PER_S)
#define LOST_INTERVALS 5
#define GATE_SIGMAS 3.0f
#define GATE_PATIENCE 10      /* ranges */
#define SURPRISE_MEMORY 20.0f /* ranges */
#define SURPRISE_CAP 25.0f
#define SURPRISE_LOST 8.0f
#define GATE_OF_FIX 12.0f /* chi-square with two degrees of freedom: 0.25 % */
#define AT_ONCE 0.1f      /* of a standard deviation, which the target moves meanwhile */

/* Variances of velocity, in squares of the usual speed: of a target that has just been found, and of one that manoeuvres */
#define UNKNOWN 0.6f
#define MANOEUVRE 2.0f

enum { MOTION = 4 }; /* states x, y, vx, vy */

void mh_range_config_default(struct mh_range_config *config)
{
    const struct mh_range_config nominal = {
        .range_sd_m = 0.3f, .acceleration_sd_mps2 = 1.0f, .speed_mps = 1.5f, .height_m = 1.0f};
    *config = nominal;
}

static bool valid(const struct mh_range_config *config)
{
    return mh_within(config->range_sd_m, 1e-3f, 100.0f) && mh_within(config->bias_sd_m, 0, 100.0f) &&
           mh_within(config->scale_sd, 0, MH_RANGE_BIASES_MAX > 0 ? 0.5f : 0) &&
           mh_within(config->sensing_range_m, 0, 1e5f) && mh_within(config->acceleration_sd_mps2, 1e-3f, 1e3f) &&
           mh_within(config->speed_mps, 1e-3f, 1e4f) && mh_within(config->height_m, -1e5f, 1e5f) &&
           mh_within(config->tolerance_m, 0, 1e5f);
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_range *range = state;
    const struct mh_range_config *given = config;
    if (range == NULL || given == NULL || interval < 1 || interval > 3600000u || !valid(given)) {
        return MH_ERR_ARGUMENT;
    }
    memset(range, 0, sizeof *range); /* no copy on the stack */
    range->config = *given;
    range->gate.sigmas = GATE_SIGMAS;
    range->gate.patience = GATE_PATIENCE;
    range->interval = interval;
    return MH_OK;
}

/* Move `filter` on in time by `ticks`. */
static enum mh_status advance(const struct mh_range *range, struct mh_kalman *filter, int32_t ticks)
{
    mh_real F[MOTION * MOTION];
    mh_real Q[MH_PACKED_SIZE(MOTION)];
    mh_kalman_constant_velocity(mh_seconds_between(0, (mh_tick)ticks), mh_squared(range->config.acceleration_sd_mps2),
                                F, Q);
    return mh_kalman_predict(filter, F, Q);
}

/* The velocity, before the filter was moved on by `ticks`, has changed by nobody knows what. */
static enum mh_status manoeuvre(const struct mh_range *range, struct mh_kalman *filter, int32_t ticks)
{
    static const mh_real F[MOTION * MOTION] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const mh_real seconds = mh_seconds_between(0, (mh_tick)ticks);
    const mh_real velocity = MANOEUVRE * mh_squared(range->config.speed_mps);
    const mh_real cross = velocity * seconds;
    const mh_real position = cross * seconds;
    const mh_real Q[MH_PACKED_SIZE(MOTION)] = {position, 0, position, cross, 0, velocity, 0, cross, 0, velocity};
    return mh_kalman_predict(filter, F, Q);
}

/* of the target above the anchor */
static mh_real rise(const struct mh_range *range, const struct mh_measurement *m)
{
    return range->config.height_m - (mh_real)m->place.z_mm * 0.001f;
}

/* Which of the first `states` states are what is known of the errors of an anchor's ranges, (1 + scale) distance + bias; 0: none is. */
struct errors {
    uint8_t scale, bias;
};

static struct errors errors_of(const struct mh_range *range, uint8_t states, mh_node_id node)
{
    struct errors errors = {0, 0};
    uint8_t i = MOTION;
    if (range->config.scale_sd > 0 && i < states) {
        errors.scale = i++;
    }
    for (; i < states; i++) {
        if (range->anchors[i - MOTION] == node) {
            errors.bias = i;
        }
    }
    return errors;
}

/* Begin at `place`, at rest. What the first `states` states of the track before have learned of the ranges' errors stays. */
static bool begin(struct mh_range *range, uint8_t states, const struct mh_place *origin, const struct mh_fix *place,
                  mh_tick time)
{
    const struct mh_sym2 *covariance = &place->covariance;
    const mh_real velocity = UNKNOWN * mh_squared(range->config.speed_mps);
    const mh_real x[MOTION] = {place->position.x, place->position.y, 0, 0};
    const mh_real P[MH_PACKED_SIZE(MOTION)] = {covariance->xx, covariance->xy, covariance->yy, 0, 0, velocity, 0, 0, 0,
                                               velocity};
    struct mh_kalman filter;
    enum mh_status status = mh_kalman_init(&filter, MOTION, x, P);
    if (states <= MOTION && range->config.scale_sd > 0 && status == MH_OK) {
        status = mh_kalman_append(&filter, 0, mh_squared(range->config.scale_sd));
    }
    for (uint8_t i = MOTION; i < states && i < MH_KALMAN_STATES_MAX && status == MH_OK; i++) {
        status = mh_kalman_append(&filter, range->filter.x[i], mh_kalman_variance(&range->filter, i));
    }
    if (status != MH_OK) {
        return false;
    }
    range->filter = filter;
    range->origin = *origin;
    range->origin.z_mm = (int32_t)(range->config.height_m * 1000.0f);
    range->updated = time;
    range->gate.refused = 0;
    range->surprise = 1;
    range->followed.known = false;
    range->tracking = true;
    return true;
}

/* Where the sensors that hear the target stand close to it: about their centre. */
static bool start_among(struct mh_range *range, uint8_t states, const struct mh_measurement *m, size_t count)
{
    const struct mh_range_config *config = &range->config;
    const struct mh_place origin = m[0].place;
    const mh_real spread = mh_squared(config->sensing_range_m) * 0.25f; /* of a disc, in each axis */
    struct mh_fix place = {.position = mh_centroid(m, count, &origin), .covariance = {spread, 0, spread}};
    struct mh_range_fix fix;
    const mh_real variance = mh_squared(config->range_sd_m) + mh_squared(config->bias_sd_m);
    if (mh_range_fix(m, count, &origin, config->height_m, mh_sqrt(variance), place.position, &fix) == MH_OK) {
        const mh_real unit = variance / (fix.normal.xx * fix.normal.yy - mh_squared(fix.normal.xy));
        place.position = fix.position;
        place.covariance.xx = unit * fix.normal.yy;
        place.covariance.xy = -unit * fix.normal.xy;
        place.covariance.yy = unit * fix.normal.xx;
    }
    return begin(range, states, &origin, &place, m[count - 1].time);
}

/* Keep the last range of each anchor, of as many as there is room for, the newest last. */
static void hear(struct mh_range *range, const struct mh_measurement *m)
{
    uint8_t at = 0;
    while (at < range->heard_count && range->heard[at].node != m->node) {
        at++;
    }
    if (at == MH_RANGE_HEARD_MAX) {
        at = 0;
    }
    if (at == range->heard_count) {
        range->heard_count++;
    }
    for (; at + 1 < range->heard_count; at++) {
        range->heard[at] = range->heard[at + 1];
    }
    range->heard[at] = *m;
}

/* Drop the ranges that are too old to start from, before the ticks wrap and they seem new. */
static void forget(struct mh_range *range, mh_tick time)
{
    uint8_t kept = 0;
    for (uint8_t i = 0; i < range->heard_count; i++) {
        if (mh_ticks_between(range->heard[i].time, time) <= LOST_TICKS + (int32_t)range->interval) {
            range->heard[kept++] = range->heard[i];
        }
    }
    range->heard_count = kept;
}

/* The range less what is known of its errors; *variance: of what is not. */
static mh_q20 corrected(const struct mh_range *range, uint8_t states, const struct mh_measurement *m, mh_real *variance)
{
    const struct mh_kalman *filter = &range->filter;
    const struct errors errors = errors_of(range, states, m->node);
    mh_real value = mh_q20_to_real(m->value);
    mh_real bias = mh_squared(range->config.bias_sd_m);
    mh_real scale = mh_squared(range->config.scale_sd);
    if (errors.bias > 0) {
        value -= filter->x[errors.bias];
        bias = mh_kalman_variance(filter, errors.bias);
    }
    if (errors.scale > 0) {
        value /= 1.0f + filter->x[errors.scale];
        scale = mh_kalman_variance(filter, errors.scale);
    }
    *variance = bias + scale * value * value;
    return mh_q20_from_real(value);
}

/* Where the last ranges of the anchors agree on a place. */
static bool start_anywhere(struct mh_range *range, uint8_t states)
{
    const struct mh_range_config *config = &range->config;
    const mh_tick time = range->heard[range->heard_count - 1].time;
    struct mh_measurement m[MH_RANGE_HEARD_MAX];
    size_t count = 0;
    mh_real largest = 0;
    for (uint8_t i = 0; i < range->heard_count; i++) {
        if (mh_ticks_between(range->heard[i].time, time) <= LOST_TICKS) {
            mh_real variance;
            m[count] = range->heard[i];
            m[count].value = corrected(range, states, &m[count], &variance);
            largest = mh_max(largest, variance);
            count++;
        }
    }
    if (count < 3) {
        return false;
    }
    const mh_real moved = config->speed_mps * mh_seconds_between(m[0].time, time);
    const mh_real sd = mh_sqrt(mh_squared(config->range_sd_m) + mh_squared(moved) + largest);
    const struct mh_place origin = m[0].place;
    struct mh_fix place;
    return mh_multilaterate(m, count, &origin, config->height_m, sd, &place) == MH_OK &&
           begin(range, states, &origin, &place, time);
}

/* The gradient of the anchor's range where the filter has the target, and what it predicts; a bias that is new gets its state. */
static mh_real with_errors(struct mh_range *range, struct mh_kalman *filter, mh_node_id node, mh_real distance,
                           mh_real *h, mh_real *variance)
{
    const mh_real bias = mh_squared(range->config.bias_sd_m);
    struct errors errors = errors_of(range, filter->n, node);
    if (errors.bias == 0 && bias > 0) {
        if (mh_kalman_append(filter, 0, bias) == MH_OK) {
            errors.bias = (uint8_t)(filter->n - 1);
            range->anchors[errors.bias - MOTION] = node;
        } else {
            *variance += bias;
        }
    }
    mh_real predicted = distance;
    if (errors.scale > 0) {
        const mh_real scale = filter->x[errors.scale];
        predicted += scale * distance;
        h[0] += scale * h[0];
        h[1] += scale * h[1];
        h[errors.scale] = distance;
    }
    if (errors.bias > 0) {
        predicted += filter->x[errors.bias];
        h[errors.bias] = 1;
    }
    return predicted;
}

/* Take one range of the filter's time, `ticks` after the last that were taken, by itself. True if it was taken. */
static bool take_one(struct mh_range *range, struct mh_kalman *filter, int32_t ticks, const struct mh_measurement *m)
{
    const struct mh_range_config *config = &range->config;
    const struct mh_vec2 position = {filter->x[0], filter->x[1]};
    mh_real distance;
    struct mh_vec2 u;
    if (mh_range_model(position, mh_place_relative(&m->place, &range->origin), rise(range, m), &distance, &u) !=
        MH_OK) {
        return false;
    }
    mh_real P[MH_PACKED_SIZE(2)];
    mh_kalman_covariance_of(filter, 2, P);
    const mh_real along = P[0] * u.x * u.x + 2.0f * P[1] * u.x * u.y + P[2] * u.y * u.y;
    mh_real bend = (P[0] + P[2] - along) / (2.0f * distance);
    if (bend < config->range_sd_m) {
        bend = 0;
    }
    mh_real h[MH_KALMAN_STATES_MAX] = {u.x, u.y};
    mh_real variance = mh_squared(config->range_sd_m) + 2.0f * bend * bend;
    const mh_real predicted = with_errors(range, filter, m->node, distance, h, &variance);
    const mh_real innovation = mh_q20_to_real(m->value) - predicted - bend;
    enum mh_status status = mh_kalman_update(filter, h, innovation, variance, &range->gate);
    if (status == MH_NONE) {
        /* what the gate refuses and a manoeuvre would explain is one */
        const mh_real moved = config->speed_mps * mh_seconds_between(0, (mh_tick)ticks);
        const mh_real explained = along + variance + MANOEUVRE * moved * moved;
        if (innovation * innovation <= GATE_SIGMAS * GATE_SIGMAS * explained &&
            manoeuvre(range, filter, ticks) == MH_OK) {
            return mh_kalman_update(filter, h, innovation, variance, NULL) == MH_OK;
        }
    }
    range->surprise += (mh_min(range->gate.surprise, SURPRISE_CAP) - range->surprise) * (1.0f / SURPRISE_MEMORY);
    return status == MH_OK;
}

/* Take the position on which ranges of the filter's time agree, `ticks` after the last that were taken. */
static enum mh_status take_fix(const struct mh_range *range, struct mh_kalman *filter, int32_t ticks,
                               const struct mh_measurement *m, size_t count)
{
    const mh_real sd = range->config.range_sd_m;
    const mh_real variance = sd * sd;
    const struct mh_vec2 predicted = {filter->x[0], filter->x[1]};
    struct mh_range_fix fix;
    enum mh_status status = mh_range_fix(m, count, &range->origin, range->config.height_m, sd, predicted, &fix);
    if (status != MH_OK) {
        return status;
    }
    const struct mh_sym2 *N = &fix.normal;
    const mh_real unit = variance / (N->xx * N->yy - N->xy * N->xy);
    const mh_real x = fix.position.x - predicted.x;
    const mh_real y = fix.position.y - predicted.y;
    mh_real P[MH_PACKED_SIZE(2)];
    mh_kalman_covariance_of(filter, 2, P);
    const mh_real xx = P[0] + unit * N->yy;
    const mh_real xy = P[1] - unit * N->xy;
    const mh_real yy = P[2] + unit * N->xx;
    if (yy * x * x - 2.0f * xy * x * y + xx * y * y > GATE_OF_FIX * (xx * yy - xy * xy) &&
        manoeuvre(range, filter, ticks) != MH_OK) {
        return MH_NONE;
    }
    /* normal = L D L': two scalars, x + l y and y, whose errors are independent */
    const mh_real l = N->xy / N->xx;
    mh_real h[MH_KALMAN_STATES_MAX] = {1, l};
    status = mh_kalman_update(filter, h, x + l * y, variance / N->xx, NULL);
    if (status == MH_OK) {
        h[0] = 0;
        h[1] = 1;
        status = mh_kalman_update(filter, h, fix.position.y - filter->x[1], variance / (N->yy - l * N->xy), NULL);
    }
    return status;
}

/* Take ranges of one instant. Returns how many were taken. */
static uint16_t take(struct mh_range *range, const struct mh_measurement *m, size_t count)
{
    const mh_tick time = m[count - 1].time;
    const int32_t ticks = mh_ticks_between(range->updated, time);
    if (ticks < 0) {
        return 0;
    }
    struct mh_kalman next = range->filter;
    if (ticks > 0 && advance(range, &next, ticks) != MH_OK) {
        return 0;
    }
    uint16_t taken = 0;
    if (count >= 3 && range->config.bias_sd_m <= 0 && range->config.scale_sd <= 0) {
        struct mh_kalman fixed = next;
        if (take_fix(range, &fixed, ticks, m, count) == MH_OK) {
            next = fixed;
            taken = (uint16_t)count;
        }
    }
    if (taken == 0) {
        for (size_t i = 0; i < count; i++) {
            taken = (uint16_t)(taken + (take_one(range, &next, ticks, &m[i]) ? 1 : 0));
        }
    }
    if (taken > 0) {
        range->filter = next;
        range->updated = time;
    }
    return taken;
}

/* Take all ranges, sorted by time, those of one instant together. Returns how many were taken. */
static uint16_t take_all(struct mh_range *range, const struct mh_measurement *m, size_t count)
{
    const mh_real apart_s = AT_ONCE * range->config.range_sd_m / range->config.speed_mps;
    const int32_t apart = (int32_t)mh_min(apart_s * (mh_real)MH_TICKS_PER_S, (mh_real)range->interval * 0.5f);
    uint16_t taken = 0;
    size_t end;
    for (size_t i = 0; i < count; i = end) {
        for (end = i + 1; end < count && mh_ticks_between(m[i].time, m[end].time) <= apart; end++) {}
        taken = (uint16_t)(taken + take(range, &m[i], end - i));
    }
    return taken;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_range *range = state;
    if (range == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!range->tracking) {
        return MH_NONE;
    }
    if (mh_tick_before(time, range->time)) {
        return MH_ERR_TIME;
    }
    struct mh_kalman filter = range->filter;
    const int32_t ticks = mh_ticks_between(range->updated, time);
    if (ticks > 0 && advance(range, &filter, ticks) != MH_OK) {
        return MH_NONE;
    }
    mh_real P[MH_PACKED_SIZE(2)];
    mh_kalman_covariance_of(&filter, 2, P);
    const struct mh_vec2 position = {filter.x[0], filter.x[1]};
    struct mh_estimate answer = {
        .origin = range->origin,
        .time = time,
        .position = position,
        .velocity = {filter.x[2], filter.x[3]},
        .covariance = {P[0], P[1], P[2]},
        .raw = position,
        .stored = position,
        .stored_velocity = range->followed.velocity,
        .states = 2,
        .flags = MH_ESTIMATE_COASTED,
    };
    (void)mh_followed_predict(&range->followed, time, &answer.stored);
    *estimate = answer;
    return MH_OK;
}

/* Store the estimate, if what is stored is too far from it, or nothing is. */
static void store(struct mh_range *range, struct mh_estimate *estimate)
{
    if (mh_followed_differs(&range->followed, estimate->time, estimate->position, range->config.tolerance_m) &&
        mh_followed_report(&range->followed, estimate->time, estimate->position, estimate->velocity) == MH_OK) {
        estimate->stored = estimate->position;
        estimate->stored_velocity = estimate->velocity;
        estimate->flags |= MH_ESTIMATE_REFRESHED;
    }
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_range *range = state;
    if (range == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (range->stepped && !mh_tick_before(range->time, time)) {
        return MH_ERR_TIME;
    }
    range->stepped = true;
    range->time = time;
    while (count > 0 && mh_tick_before(time, measurements[count - 1].time)) {
        count--;
    }
    const int32_t idle = mh_ticks_between(range->updated, time);
    if (range->tracking && idle > LOST_TICKS && (mh_tick)idle > LOST_INTERVALS * range->interval) {
        range->tracking = false;
    }
    const bool among = range->config.sensing_range_m > 0;
    forget(range, time);
    for (size_t i = 0; i < count && !among; i++) {
        hear(range, &measurements[i]);
    }
    uint16_t taken = range->tracking ? take_all(range, measurements, count) : 0;
    bool started = false;
    const bool lost = range->surprise > SURPRISE_LOST;
    if (count > 0 && (!range->tracking || lost)) {
        const uint8_t states = lost ? 0 : range->filter.n; /* what a track that went astray has learned is wrong */
        started = among ? start_among(range, states, measurements, count) : start_anywhere(range, states);
        taken = started ? (uint16_t)count : taken;
    }
    const enum mh_status status = predict(range, time, estimate);
    if (status == MH_OK) {
        estimate->measurements = taken;
        estimate->flags = (uint8_t)((started ? MH_ESTIMATE_STARTED : 0) | (taken == 0 ? MH_ESTIMATE_COASTED : 0));
        if (taken > 0) {
            store(range, estimate);
        }
    }
    return status;
}

static void restart(void *state)
{
    struct mh_range *range = state;
    range->tracking = false;
}

/* The upper half of the number, rounded: 8 significant bits */
static uint16_t half(mh_real value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (uint16_t)((bits + 0x8000u) >> 16);
}

static mh_real whole(uint16_t half)
{
    const uint32_t bits = (uint32_t)half << 16;
    mh_real value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void put_place(uint8_t **at, const struct mh_place *place)
{
    mh_put_u32(at, (uint32_t)place->x_mm);
    mh_put_u32(at, (uint32_t)place->y_mm);
}

static struct mh_place get_place(const uint8_t **at)
{
    struct mh_place place = {0, 0, 0};
    place.x_mm = mh_get_i32(at);
    place.y_mm = mh_get_i32(at);
    return place;
}

static void put_velocity(uint8_t **at, struct mh_vec2 velocity)
{
    mh_put_real(at, velocity.x);
    mh_put_real(at, velocity.y);
}

static struct mh_vec2 get_velocity(const uint8_t **at)
{
    struct mh_vec2 velocity;
    velocity.x = mh_get_real(at);
    velocity.y = mh_get_real(at);
    return velocity;
}

/* Places in the field's frame, in mm; the covariance as its factors U and D to 8 bits, which are one whatever they are rounded to. */
static enum mh_status save(const void *state, uint8_t *bytes, size_t *length)
{
    const struct mh_range *range = state;
    if (range == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!range->tracking || !range->followed.known) {
        return MH_NONE;
    }
    const struct mh_kalman *filter = &range->filter;
    const struct mh_vec2 position = {filter->x[0], filter->x[1]};
    const struct mh_vec2 velocity = {filter->x[2], filter->x[3]};
    const struct mh_place place = mh_place_from_offset(&range->origin, position);
    const struct mh_place stored = mh_place_from_offset(&range->origin, range->followed.position);
    uint8_t *at = bytes;
    mh_put_u32(&at, range->updated);
    put_place(&at, &place);
    put_velocity(&at, velocity);
    for (int i = 0; i < MH_PACKED_SIZE(MOTION); i++) {
        mh_put_u16(&at, half(filter->ud[i]));
    }
    mh_put_u32(&at, range->followed.time);
    put_place(&at, &stored);
    put_velocity(&at, range->followed.velocity);
    *length = MH_RANGE_SAVED;
    return MH_OK;
}

static bool place_valid(const struct mh_place *place)
{
    return mh_coordinate_valid(place->x_mm) && mh_coordinate_valid(place->y_mm);
}

static enum mh_status load(void *state, const uint8_t *bytes, size_t length)
{
    struct mh_range *range = state;
    if (range == NULL || bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (length != MH_RANGE_SAVED) {
        return MH_ERR_CORRUPT;
    }
    const uint8_t *at = bytes;
    const mh_tick updated = mh_get_u32(&at);
    struct mh_place place = get_place(&at);
    const struct mh_vec2 velocity = get_velocity(&at);
    struct mh_kalman filter = {.n = MOTION, .moving = MOTION, .x = {0, 0, velocity.x, velocity.y}};
    bool good = place_valid(&place) && mh_finite(velocity.x) && mh_finite(velocity.y);
    for (int i = 0; i < MH_PACKED_SIZE(MOTION); i++) {
        filter.ud[i] = whole(mh_get_u16(&at));
        good = good && mh_finite(filter.ud[i]);
    }
    for (int i = 0; i < MOTION; i++) {
        good = good && filter.ud[MH_PACKED(i, i)] >= 1e-30f;
    }
    const mh_tick reported = mh_get_u32(&at);
    const struct mh_place stored = get_place(&at);
    const struct mh_vec2 stored_velocity = get_velocity(&at);
    struct mh_followed followed = {.known = false};
    /* bytes that are no covariance to the precision of mh_real show when it is factored anew */
    if (!good || !place_valid(&stored) || advance(range, &filter, 0) != MH_OK ||
        mh_followed_report(&followed, reported, mh_place_relative(&stored, &place), stored_velocity) != MH_OK) {
        return MH_ERR_CORRUPT;
    }
    if (range->config.scale_sd > 0 && mh_kalman_append(&filter, 0, mh_squared(range->config.scale_sd)) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    place.z_mm = (int32_t)(range->config.height_m * 1000.0f);
    range->origin = place;
    range->filter = filter;
    range->surprise = 1;
    range->followed = followed;
    range->time = range->updated = updated;
    range->stepped = range->tracking = true;
    return MH_OK;
}

const struct mh_tracker mh_tracker_range = {
    .name = "range",
    .state_size = sizeof(struct mh_range),
    .config_size = sizeof(struct mh_range_config),
    .init = init,
    .step = step,
    .predict = predict,
    .save = save,
    .load = load,
    .restart = restart,
};
