#include "acoustic_parts.h"

#include <string.h>

#define GATE_PATIENCE 2

/* Tracks that were found nearer to each other than so many standard deviations of their distance may have been exchanged. */
#define DISTINCT_SDS MH_REAL(2.5f)

enum { MOTION = 4 }; /* states x, y, vx, vy */

void mh_acoustic_config_default(struct mh_acoustic_config *config, mh_real sensing_range_m)
{
    const struct mh_acoustic_config nominal = {
        .sound = {.loudness_m2 = mh_squared(sensing_range_m),
                  .source_sd = MH_REAL(0.19f),
                  .background_sd = MH_REAL(0.05f)},
        .sensing_range_m = sensing_range_m,
        .reach_m = sensing_range_m + MH_REAL(15.0f),
        .variant = MH_CIRCLES_UNIFORM,
        .intervals = 8,
        .distances = MH_DISTANCE_MIDDLE,
        .separation = MH_SEPARATION_JOINT,
        .share_range_m = 3 * sensing_range_m,
        .filtered = true,
        .mirror_check = true,
        .acceleration_psd = MH_REAL(0.5f),
        .speed_mps = MH_REAL(10.0f),
        .fix_sd_m = MH_REAL(3.0f),
        .coast_s = MH_REAL(10.0f),
    };
    *config = nominal;
    mh_group_config_default(&config->group, MH_GROUP_NONE);
}

static bool valid(const struct mh_acoustic_config *config)
{
    return mh_sound_valid(&config->sound) && (config->sound.source_sd > 0 || config->sound.background_sd > 0) &&
           mh_within(config->sensing_range_m, MH_REAL(1.0f), MH_DISTANCE_FIX_RANGE_MAX) &&
           mh_within(config->reach_m, MH_REAL(1.0f), MH_REAL_UPTO(1e5f)) && config->variant <= MH_CIRCLES_JOINT &&
           config->distances <= MH_DISTANCE_LINEAR && config->strongest != 1 &&
           config->separation <= MH_SEPARATION_JOINT &&
           mh_within(config->share_range_m, MH_REAL(1.0f), MH_REAL_UPTO(1e5f)) &&
           mh_within(config->acceleration_psd, mh_max(MH_REAL(1e-6f), MH_REAL_MIN), MH_REAL_UPTO(1e6f)) &&
           mh_within(config->speed_mps, MH_REAL(0.1f), MH_ACOUSTIC_SD_MAX) &&
           mh_within(config->fix_sd_m, MH_REAL(0.1f), MH_ACOUSTIC_SD_MAX) &&
           mh_within(config->coast_s, MH_REAL(0.1f), MH_REAL(3600.0f)) &&
           mh_group_config_check(&config->group) == MH_OK;
}

enum mh_status mh_acoustic_init(void *state, const struct mh_acoustic_kind *kind, const void *given, mh_tick interval)
{
    struct mh_acoustic *acoustic = state;
    const struct mh_acoustic_config *config = given;
    if (acoustic == NULL || config == NULL || interval < 1 || interval > 3600000u || !valid(config)) {
        return MH_ERR_ARGUMENT;
    }
    if ((kind->locate_jointly == NULL && config->separation == MH_SEPARATION_JOINT) ||
        (kind->approach == NULL && config->group.mode != MH_GROUP_NONE)) {
        return MH_ERR_ARGUMENT;
    }
    memset(acoustic, 0, sizeof *acoustic);
    acoustic->kind = kind;
    acoustic->config = *config;
    mh_group_single(&acoustic->track.group, 0);
    return MH_OK;
}

/* ---- the filter ---- */

/* Position and velocity with their covariances: of each, and of both. */
enum mh_status mh_acoustic_set(struct mh_acoustic_track *track, struct mh_vec2 position,
                               const struct mh_sym2 *covariance, struct mh_vec2 velocity,
                               const struct mh_sym2 *velocities, mh_real both)
{
    const struct mh_sym2 *C = covariance, *V = velocities;
    const mh_real x[MOTION] = {position.x, position.y, velocity.x, velocity.y};
    const mh_real cross_xx = mh_mul(both, C->xx), cross_xy = mh_mul(both, C->xy), cross_yy = mh_mul(both, C->yy);
    const mh_real P[MH_PACKED_SIZE(MOTION)] = {C->xx, C->xy,    C->yy,    cross_xx, cross_xy,
                                               V->xx, cross_xy, cross_yy, V->xy,    V->yy};
    return mh_kalman_init(&track->filter, MOTION, x, P);
}

/* A first fix: its velocity is anything. */
static enum mh_status set_first(const struct mh_acoustic_config *config, const struct mh_acoustic_fix *fix,
                                struct mh_acoustic_track *track)
{
    const mh_real variance = mh_squared(config->speed_mps);
    const struct mh_sym2 velocities = {variance, 0, variance};
    const struct mh_vec2 rest = {0, 0};
    track->moving = false;
    track->refused = 0;
    memset(track->speeds, 0, sizeof track->speeds);
    return mh_acoustic_set(track, fix->position, &fix->covariance, rest, &velocities, 0);
}

/* The velocity between the fix and the one before: the filter forgets what it had. */
static enum mh_status set_chord(const struct mh_acoustic_fix *fix, struct mh_vec2 before, mh_real seconds,
                                struct mh_acoustic_track *track)
{
    const mh_real rate = mh_div(MH_REAL(1.0f), seconds);
    const struct mh_vec2 way = mh_vec2_between(before, fix->position);
    const struct mh_vec2 chord = {mh_mul(way.x, rate), mh_mul(way.y, rate)};
    const mh_real speed = mh_vec2_length(chord);
    const mh_real scale = speed > MH_ACOUSTIC_FASTEST_MPS ? mh_div(MH_ACOUSTIC_FASTEST_MPS, speed) : MH_REAL(1.0f);
    const struct mh_vec2 velocity = {mh_mul(chord.x, scale), mh_mul(chord.y, scale)};
    const mh_real twice = mh_mul(2 * rate, rate);
    const struct mh_sym2 *C = &fix->covariance;
    const struct mh_sym2 velocities = {mh_mul(twice, C->xx), mh_mul(twice, C->xy), mh_mul(twice, C->yy)};
    return mh_acoustic_set(track, fix->position, C, velocity, &velocities, rate);
}

/* As two scalars with independent errors: y, and x less what y says of it. */
static enum mh_status update(struct mh_acoustic_track *track, const struct mh_acoustic_fix *fix)
{
    const struct mh_sym2 *R = &fix->covariance;
    const mh_real l = mh_div(R->xy, R->yy);
    const mh_real along_y[MOTION] = {0, MH_REAL(1.0f)}, across[MOTION] = {MH_REAL(1.0f), -l};
    enum mh_status status =
        mh_kalman_update(&track->filter, along_y, fix->position.y - track->filter.x[1], R->yy, NULL);
    if (status == MH_OK) {
        const mh_real expected = track->filter.x[0] - mh_mul(l, track->filter.x[1]);
        status = mh_kalman_update(&track->filter, across, fix->position.x - mh_mul(l, fix->position.y) - expected,
                                  R->xx - mh_mul(l, R->xy), NULL);
    }
    return status;
}

static void note_speed(struct mh_acoustic_track *track, struct mh_vec2 before, mh_real seconds)
{
    const struct mh_vec2 way = mh_vec2_between(before, mh_acoustic_position(track));
    const mh_real speed = mh_div(mh_vec2_length(way), seconds);
    track->speeds[2] = track->speeds[1];
    track->speeds[1] = track->speeds[0];
    track->speeds[0] = (uint8_t)mh_real_round(MH_ACOUSTIC_SPEEDS_A_MPS * mh_min(speed, MH_ACOUSTIC_FASTEST_MPS));
}

/* The fix, `seconds` after the last one at `before`, goes into the predicted track. MH_NONE: it is left out. */
static enum mh_status take_fix(const struct mh_acoustic_config *config, const struct mh_acoustic_scene *scene,
                               struct mh_vec2 before, mh_real seconds, const struct mh_acoustic_fix *fix,
                               struct mh_acoustic_track *track)
{
    enum mh_status status;
    const bool outside = mh_acoustic_surprise(scene, fix) > MH_ACOUSTIC_GATE;
    if (config->filtered && outside && !scene->alone && track->refused < GATE_PATIENCE) {
        return MH_NONE;
    }
    if (!config->filtered || outside) {
        status = set_chord(fix, before, seconds, track);
    } else {
        status = update(track, fix);
    }
    if (status == MH_OK) {
        note_speed(track, before, seconds);
        track->moving = true;
        track->refused = 0;
    }
    return status;
}

/* ---- a step ---- */

static void state_identity(const struct mh_acoustic_track *track, struct mh_estimate *estimate)
{
    const struct mh_group *group = &track->group;
    estimate->target = group->targets[0].target;
    estimate->members = group->count;
    estimate->extent = mh_group_extent(group);
    estimate->mode = track->mode;
    for (uint8_t i = 0; i < group->count && group->count > 1; i++) {
        estimate->of[i] = group->targets[i].target;
    }
    if (group->unresolved) {
        estimate->flags |= MH_ESTIMATE_UNRESOLVED;
    }
}

/* The track, predicted to `time`. */
static void answer(const struct mh_acoustic_track *track, mh_tick time, struct mh_estimate *estimate)
{
    mh_real P[MH_PACKED_SIZE(MOTION)];
    mh_kalman_covariance(&track->filter, P);
    struct mh_estimate stated = {
        .origin = track->origin,
        .time = time,
        .position = mh_acoustic_position(track),
        .velocity = mh_acoustic_velocity(track),
        .covariance = {P[0], P[1], P[2]},
        .states = MOTION,
    };
    memcpy(stated.covariance_more, P + MH_PACKED_SIZE(2), sizeof stated.covariance_more);
    stated.raw = stated.stored = stated.position;
    stated.stored_velocity = stated.velocity;
    state_identity(track, &stated);
    *estimate = stated;
}

/* A fix for the scene -> fix. */
static enum mh_status locate(const struct mh_acoustic *acoustic, struct mh_acoustic_scene *scene, bool jointly,
                             mh_real seconds, struct mh_acoustic_fix *fix)
{
    const struct mh_acoustic_config *config = &acoustic->config;
    if (jointly && scene->own_count == 0) {
        return MH_NONE;
    }
    if (jointly) {
        return scene->own.group.count > 1 && config->group.mode == MH_GROUP_WEIGHTS
                   ? acoustic->kind->weigh(config, scene, seconds, fix)
                   : acoustic->kind->locate_jointly(config, scene, seconds, fix);
    }
    if (scene->heard_count < 2) {
        return MH_NONE;
    }
    const enum mh_status status = acoustic->kind->locate(config, scene->heard, scene->heard_count, fix);
    if (status == MH_OK && acoustic->tracking && config->mirror_check) {
        mh_acoustic_check_mirror(config, scene, fix);
        if (acoustic->kind->reconsider && mh_acoustic_surprise(scene, fix) > MH_ACOUSTIC_GATE) {
            acoustic->kind->reconsider(config, scene, fix);
        }
    }
    if (status == MH_OK && !acoustic->tracking && config->group.mode != MH_GROUP_NONE && scene->alone) {
        acoustic->kind->find_group(config, scene, fix);
    }
    return status;
}

/* The fix into the track -> scene->own, as it is then. MH_NONE: it is left out, and counted. */
static enum mh_status follow(struct mh_acoustic *acoustic, mh_tick time, const struct mh_acoustic_fix *fix,
                             struct mh_acoustic_scene *scene)
{
    struct mh_acoustic_track *last = &acoustic->track;
    if (!acoustic->tracking) {
        scene->own.updated = time;
        return set_first(&acoustic->config, fix, &scene->own);
    }
    const struct mh_acoustic_track expected = scene->own;
    const mh_real seconds = mh_seconds_between(last->updated, time);
    const enum mh_status status =
        take_fix(&acoustic->config, scene, mh_acoustic_position(last), seconds, fix, &scene->own);
    if (status != MH_OK) {
        scene->own = expected;
        last->refused = (uint8_t)(last->refused + (last->refused < GATE_PATIENCE));
    }
    return status;
}

/* The one of the others, as a bit, with which it is about to become a group, where velocities before and after tell them apart. */
static unsigned merging(const struct mh_acoustic_scene *scene)
{
    const struct mh_group *group = &scene->own.group;
    for (uint8_t i = 0; i < scene->others_count && group->merges > 0; i++) {
        if (scene->others[i].target == group->near) {
            return 1u << i;
        }
    }
    return 0;
}

enum mh_status mh_acoustic_step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                                struct mh_estimate *estimate)
{
    struct mh_acoustic *acoustic = state;
    if (acoustic == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (acoustic->stepped && !mh_tick_before(acoustic->time, time)) {
        acoustic->others_count = 0;
        return MH_ERR_TIME;
    }
    struct mh_acoustic_scene scene;
    struct mh_acoustic_track *track = &acoustic->track;
    acoustic->time = time;
    acoustic->stepped = true;
    scene.own = *track;
    acoustic->tracking = acoustic->tracking && mh_seconds_between(track->updated, time) <= acoustic->config.coast_s &&
                         mh_acoustic_advance(&scene.own, acoustic->config.acceleration_psd, time) == MH_OK;
    const bool tracking = acoustic->tracking;
    if (!tracking && count > 0) {
        scene.own.origin = measurements[0].place;
        scene.own.filter.x[0] = scene.own.filter.x[1] = 0;
        mh_group_single(&scene.own.group, track->group.targets[0].target);
    }
    if (tracking) {
        scene.covariance = mh_acoustic_covariance(&scene.own);
    }
    mh_acoustic_look_around(acoustic, time, &scene);
    const bool jointly =
        tracking && (scene.own.group.count > 1 || (!scene.alone && acoustic->config.separation == MH_SEPARATION_JOINT));
    const mh_real seconds = tracking ? mh_seconds_between(track->updated, time) : 0;
    const unsigned expected = tracking ? mh_acoustic_exchanged(&scene, seconds, 0) : 0u;
    mh_acoustic_listen(acoustic, jointly, measurements, count, &scene);
    acoustic->others_count = 0;

    struct mh_acoustic_fix fix = {.flags = 0};
    enum mh_status status = locate(acoustic, &scene, jointly, seconds, &fix);
    if (status == MH_OK) {
        status = follow(acoustic, time, &fix, &scene);
    }
    if (status != MH_OK) {
        if (!tracking) {
            return MH_NONE;
        }
        track->mode = scene.own.mode;
        track->group.unresolved = track->group.unresolved || (expected & ~merging(&scene)) != 0;
        answer(&scene.own, time, estimate); /* what is kept of the track is as it was after its last fix */
        estimate->flags |= MH_ESTIMATE_COASTED;
        return MH_OK;
    }
    const bool merge = acoustic->kind->approach && acoustic->config.group.mode != MH_GROUP_NONE &&
                       acoustic->kind->approach(&acoustic->config, &scene);
    const unsigned exchanged = (expected | mh_acoustic_exchanged(&scene, seconds, DISTINCT_SDS)) & ~merging(&scene);
    scene.own.group.unresolved = scene.own.group.unresolved || exchanged != 0;
    *track = scene.own;
    acoustic->tracking = true;
    answer(track, time, estimate);
    estimate->raw = fix.position;
    estimate->measurements = (uint16_t)scene.heard_count;
    estimate->flags = (uint16_t)(estimate->flags | fix.flags | MH_ESTIMATE_REFRESHED |
                                 (tracking ? 0 : MH_ESTIMATE_STARTED) | (merge ? MH_ESTIMATE_MERGE : 0));
    estimate->near = merge ? track->group.near : 0;
    return MH_OK;
}

enum mh_status mh_acoustic_predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_acoustic *acoustic = state;
    if (acoustic == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!acoustic->tracking) {
        return MH_NONE;
    }
    struct mh_acoustic_track track = acoustic->track;
    const enum mh_status status = mh_acoustic_advance(&track, acoustic->config.acceleration_psd, time);
    if (status != MH_OK) {
        return status == MH_ERR_TIME ? status : MH_NONE;
    }
    answer(&track, time, estimate);
    estimate->flags |= MH_ESTIMATE_COASTED;
    return MH_OK;
}

/* ---- from head to head, and beside others ---- */

enum mh_status mh_acoustic_save(const void *state, uint8_t *bytes, size_t *length)
{
    const struct mh_acoustic *acoustic = state;
    if (acoustic == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!acoustic->tracking) {
        return MH_NONE;
    }
    *length = mh_acoustic_write(&acoustic->track, bytes);
    return MH_OK;
}

static void go_on(struct mh_acoustic *acoustic, const struct mh_acoustic_track *track)
{
    acoustic->track = *track;
    acoustic->time = track->updated;
    acoustic->stepped = acoustic->tracking = true;
}

enum mh_status mh_acoustic_load(void *state, const uint8_t *bytes, size_t length)
{
    struct mh_acoustic *acoustic = state;
    struct mh_acoustic_track track;
    if (acoustic == NULL || bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (mh_acoustic_read(&track, acoustic->track.group.targets[0].target, bytes, length) != MH_OK ||
        (track.group.count > 1 && !mh_acoustic_follows_groups(acoustic))) {
        return MH_ERR_CORRUPT;
    }
    go_on(acoustic, &track);
    return MH_OK;
}

void mh_acoustic_restart(void *state)
{
    struct mh_acoustic *acoustic = state;
    acoustic->tracking = false;
}

enum mh_status mh_acoustic_among(void *state, uint32_t target, const struct mh_saved_track *others, size_t count)
{
    struct mh_acoustic *acoustic = state;
    struct mh_acoustic_track track;
    if (acoustic == NULL || (others == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    acoustic->others_count = 0;
    if (acoustic->tracking && acoustic->track.group.count > 1 && target != acoustic->track.group.targets[0].target) {
        return MH_ERR_ARGUMENT; /* a group has its lowest identifier */
    }
    acoustic->track.group.targets[0].target = target;
    for (size_t i = 0; i < count; i++) {
        if (mh_acoustic_read(&track, others[i].target, others[i].bytes, others[i].length) != MH_OK) {
            return MH_ERR_CORRUPT;
        }
    }
    for (size_t i = 0; i < count && acoustic->others_count < MH_TARGETS_MAX; i++) {
        acoustic->others[acoustic->others_count++] = others[i];
    }
    return MH_OK;
}

enum mh_status mh_acoustic_begin(struct mh_acoustic *acoustic, uint32_t target, mh_tick time,
                                 const struct mh_place *place, struct mh_vec2 velocity, mh_real position_sd_m,
                                 mh_real velocity_sd_mps)
{
    if (acoustic == NULL || place == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!mh_finite(velocity.x) || !mh_finite(velocity.y)) {
        return MH_ERR_NOT_FINITE;
    }
    if (!mh_within(position_sd_m, MH_REAL(1e-3f), MH_REAL_UPTO(1e5f)) ||
        !mh_within(velocity_sd_mps, MH_REAL(1e-3f), MH_REAL_UPTO(1e5f)) || !mh_coordinate_valid(place->x_mm) ||
        !mh_coordinate_valid(place->y_mm)) {
        return MH_ERR_ARGUMENT;
    }
    const struct mh_sym2 positions = {mh_squared(position_sd_m), 0, mh_squared(position_sd_m)};
    const struct mh_sym2 velocities = {mh_squared(velocity_sd_mps), 0, mh_squared(velocity_sd_mps)};
    const struct mh_vec2 here = {0, 0};
    struct mh_acoustic_track track = {.origin = *place, .updated = time, .moving = true};
    const enum mh_status status = mh_acoustic_set(&track, here, &positions, velocity, &velocities, 0);
    if (status == MH_OK) {
        mh_group_single(&track.group, target);
        go_on(acoustic, &track);
    }
    return status;
}
