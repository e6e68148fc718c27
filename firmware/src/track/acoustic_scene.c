#include "acoustic_parts.h"
#include "motehound/decomposition.h"

/* Gaps between tracks, centroids less extents, in sensing ranges: who is NEAR is told apart; from SPARSE on they are followed as several, until there are SINGLE
 * between them. Half way between two that are NEAR apart hardly any node reports. */
#define NEAR MH_REAL(3.5f)
#define SPARSE MH_REAL(2.5f)
#define SINGLE MH_REAL(3.0f)

#define LEAST_ENERGY MH_REAL(1.0f) /* what a node reports */
#define LEAST_SHARE MH_REAL(0.6f)  /* of a target's sound at a node, units of energy */
#define TRIGGER_M                                                                                                      \
    MH_REAL(10.0f) /* a share counts at nodes that expect the target within sensing range, give or take so much */
#define UNEXPLAINED MH_REAL(1.5f) /* so much more than the others' sound is that of a new target */

/* Of a target that is not where it is expected: how far off its loudest node can be; and how far from the target that is, so that all others that hear it are
 * within reach_m of there, sensing ranges. */
#define ASTRAY_SDS MH_REAL(3.0f)
#define LOUDEST_RANGES MH_REAL(0.5f)

static mh_real distance(struct mh_vec2 a, struct mh_vec2 b) { return mh_vec2_length(mh_vec2_between(b, a)); }

static bool is_within(struct mh_vec2 a, struct mh_vec2 b, mh_real range)
{
    return mh_vec2_square(mh_vec2_between(a, b)) <= mh_wide_mul(range, range);
}

static mh_real gap(const struct mh_group *a, struct mh_vec2 at_a, const struct mh_group *b, struct mh_vec2 at_b)
{
    return distance(at_a, at_b) - mh_group_extent(a) - mh_group_extent(b);
}

static bool have_a_target_in_common(const struct mh_group *a, const struct mh_group *b)
{
    for (uint8_t i = 0; i < a->count; i++) {
        for (uint8_t j = 0; j < b->count; j++) {
            if (a->targets[i].target == b->targets[j].target) {
                return true;
            }
        }
    }
    return false;
}

/* False if it is none to reckon with: from after the instant, or of a target of the own group, which was joined or parted meanwhile. */
static bool look_at(const struct mh_acoustic *acoustic, mh_tick time, const struct mh_saved_track *saved,
                    const struct mh_acoustic_track *own, struct mh_acoustic_other *other)
{
    struct mh_acoustic_track track;
    if (mh_acoustic_read(&track, saved->target, saved->bytes, saved->length) != MH_OK ||
        have_a_target_in_common(&track.group, &own->group) ||
        mh_acoustic_advance(&track, acoustic->config.acceleration_psd, time) != MH_OK) {
        return false;
    }
    const struct mh_vec2 from = mh_place_relative(&track.origin, &own->origin), on = mh_acoustic_position(&track);
    other->target = saved->target;
    other->position.x = mh_add(from.x, on.x);
    other->position.y = mh_add(from.y, on.y);
    other->velocity = mh_acoustic_velocity(&track);
    other->covariance = mh_acoustic_covariance(&track);
    other->group = track.group;
    other->near = false;
    return true;
}

/* Near to the own track, or to one that is. */
static void mark_near(struct mh_acoustic_scene *scene, mh_real near_m)
{
    const struct mh_vec2 own = mh_acoustic_position(&scene->own);
    for (uint8_t pass = 0; pass < scene->others_count; pass++) {
        for (uint8_t i = 0; i < scene->others_count; i++) {
            struct mh_acoustic_other *other = &scene->others[i];
            other->near = other->near || gap(&scene->own.group, own, &other->group, other->position) < near_m;
            for (uint8_t j = 0; j < scene->others_count && !other->near; j++) {
                const struct mh_acoustic_other *link = &scene->others[j];
                other->near = link->near && gap(&link->group, link->position, &other->group, other->position) < near_m;
            }
        }
    }
}

void mh_acoustic_look_around(const struct mh_acoustic *acoustic, mh_tick time, struct mh_acoustic_scene *scene)
{
    const mh_real range = acoustic->config.sensing_range_m;
    mh_real least = MH_REAL_MAX;
    scene->others_count = 0;
    for (uint8_t i = 0; i < acoustic->others_count; i++) {
        struct mh_acoustic_other *other = &scene->others[scene->others_count];
        if (look_at(acoustic, time, &acoustic->others[i], &scene->own, other)) {
            least = mh_min(least,
                           gap(&scene->own.group, mh_acoustic_position(&scene->own), &other->group, other->position));
            scene->others_count++;
        }
    }
    mark_near(scene, mh_mul(NEAR, range));
    scene->alone = true;
    for (uint8_t i = 0; i < scene->others_count; i++) {
        scene->alone = scene->alone && !scene->others[i].near;
    }
    if (scene->own.group.count > 1) {
        scene->own.mode = MH_TARGET_GROUP;
    } else if (least < mh_mul(SPARSE, range)) {
        scene->own.mode = MH_TARGET_SPARSE;
    } else if (least > mh_mul(SINGLE, range) || scene->own.mode == MH_TARGET_GROUP) {
        scene->own.mode = MH_TARGET_SINGLE;
    }
}

/* Among a group's members the distance to the nearest one. */
static mh_real distance_to(const struct mh_group *group, struct mh_vec2 centroid, struct mh_vec2 place)
{
    mh_real least = MH_REAL_MAX;
    for (uint8_t i = 0; i < group->count; i++) {
        least = mh_min(least, distance(mh_group_place(group, centroid, i), place));
    }
    return least;
}

/* The own target's share of what is heard, one of the others'; those that are no groups of many are single sources. */
static mh_real own_share(const struct mh_acoustic *acoustic, const struct mh_acoustic_scene *scene,
                         struct mh_vec2 place)
{
    struct mh_vec2 sources[MH_TARGETS_MAX + 1];
    size_t count = 1;
    sources[0] = mh_acoustic_position(&scene->own);
    for (uint8_t i = 0; i < scene->others_count; i++) {
        if (scene->others[i].near) {
            sources[count++] = scene->others[i].position;
        }
    }
    return mh_sound_share(sources, count, 0, place, acoustic->config.share_range_m);
}

/* What is left of the energy when the others' sound is taken off; 0 if nothing of note is. */
static mh_real unexplained(const struct mh_acoustic *acoustic, const struct mh_acoustic_scene *scene,
                           const struct mh_heard *heard)
{
    mh_real explained = 0;
    for (uint8_t i = 0; i < scene->others_count; i++) {
        const struct mh_acoustic_other *other = &scene->others[i];
        for (uint8_t j = 0; j < other->group.count; j++) {
            const mh_real away = distance(mh_group_place(&other->group, other->position, j), heard->place);
            explained = mh_add(explained, mh_sound_energy(&acoustic->config.sound, mh_squared(away)));
        }
    }
    return heard->energy > mh_mul(UNEXPLAINED, explained) ? heard->energy - explained : 0;
}

/* What a measurement says of the own target; an energy of 0 if nothing. */
static struct mh_heard heard_of(const struct mh_acoustic *acoustic, const struct mh_acoustic_scene *scene,
                                const struct mh_measurement *measurement)
{
    struct mh_heard heard = {mh_place_relative(&measurement->place, &scene->own.origin),
                             mh_q20_to_real(measurement->value)};
    if (heard.energy < LEAST_ENERGY) {
        heard.energy = 0;
    } else if (!acoustic->tracking && acoustic->config.separation != MH_SEPARATION_NONE) {
        heard.energy = unexplained(acoustic, scene, &heard);
        heard.energy = heard.energy < LEAST_ENERGY ? 0 : heard.energy;
    }
    return heard;
}

/* True if another track is expected nearer to it than `off`. */
static bool is_nearer_to_others(const struct mh_acoustic_scene *scene, mh_real off, struct mh_vec2 place)
{
    for (uint8_t j = 0; j < scene->others_count; j++) {
        if (distance_to(&scene->others[j].group, scene->others[j].position, place) < off) {
            return true;
        }
    }
    return false;
}

/* The same than `own` is. */
static bool is_others(const struct mh_acoustic_scene *scene, struct mh_vec2 own, struct mh_vec2 place)
{
    return scene->others_count > 0 && is_nearer_to_others(scene, distance(own, place), place);
}

/* Nobody else is near: what is heard about the loudest node, for the target need not be where it is expected. That node is looked for where it can be, and if there is none, anywhere. */
static void listen_alone(const struct mh_acoustic *acoustic, const struct mh_measurement *measurements, size_t count,
                         struct mh_acoustic_scene *scene)
{
    const struct mh_acoustic_config *config = &acoustic->config;
    mh_real astray = MH_REAL_MAX;
    if (acoustic->tracking) {
        astray =
            mh_add(config->reach_m, mh_mul(ASTRAY_SDS, mh_sqrt(mh_max(scene->covariance.xx, scene->covariance.yy))));
    }
    struct mh_heard loudest = {.energy = 0};
    bool expected = false;
    for (size_t i = 0; i < count; i++) {
        const struct mh_heard heard = heard_of(acoustic, scene, &measurements[i]);
        const struct mh_vec2 own = mh_acoustic_position(&scene->own);
        const bool within = is_within(own, heard.place, astray);
        if ((within > expected || (within == expected && heard.energy > loudest.energy)) && heard.energy > 0 &&
            !(acoustic->tracking && is_others(scene, own, heard.place))) {
            loudest = heard;
            expected = within;
        }
    }
    const mh_real about = mh_add(config->reach_m, mh_mul(LOUDEST_RANGES, config->sensing_range_m));
    for (size_t i = 0; i < count && loudest.energy > 0; i++) {
        const struct mh_heard heard = heard_of(acoustic, scene, &measurements[i]);
        if (heard.energy > 0 && is_within(loudest.place, heard.place, about) &&
            !is_others(scene, loudest.place, heard.place)) {
            mh_heard_insert(scene->heard, &scene->heard_count, MH_ACOUSTIC_HEARD_MAX, &heard);
        }
    }
    scene->own_count = scene->heard_count;
}

static void listen_among(const struct mh_acoustic *acoustic, bool jointly, const struct mh_measurement *measurements,
                         size_t count, struct mh_acoustic_scene *scene)
{
    const struct mh_acoustic_config *config = &acoustic->config;
    const bool in_shares = !jointly && config->separation == MH_SEPARATION_DECOMPOSITION;
    const mh_real reach = in_shares ? mh_min(config->reach_m, config->sensing_range_m + TRIGGER_M) : config->reach_m;
    /* n targets are heard farther away */
    const mh_real group_reach = mh_mul(reach, mh_sqrt(mh_real_from_int(scene->own.group.count)));
    for (size_t i = 0; i < count; i++) {
        struct mh_heard heard = heard_of(acoustic, scene, &measurements[i]);
        const mh_real off = distance_to(&scene->own.group, mh_acoustic_position(&scene->own), heard.place);
        const bool own = off <= reach || (off <= group_reach && !is_nearer_to_others(scene, off, heard.place));
        bool near = own;
        for (uint8_t j = 0; j < scene->others_count && jointly && !near; j++) {
            const struct mh_acoustic_other *other = &scene->others[j];
            near = other->near && distance_to(&other->group, other->position, heard.place) <= reach;
        }
        if (near && in_shares) {
            heard.energy = mh_mul(heard.energy, own_share(acoustic, scene, heard.place));
            near = heard.energy >= LEAST_SHARE;
        }
        if (near && heard.energy > 0) {
            mh_heard_insert(scene->heard, &scene->heard_count, MH_ACOUSTIC_HEARD_MAX, &heard);
            scene->own_count += own ? 1 : 0;
        }
    }
}

void mh_acoustic_listen(const struct mh_acoustic *acoustic, bool jointly, const struct mh_measurement *measurements,
                        size_t count, struct mh_acoustic_scene *scene)
{
    scene->heard_count = scene->own_count = 0;
    if (jointly || (acoustic->tracking && !scene->alone)) {
        listen_among(acoustic, jointly, measurements, count, scene);
    } else {
        listen_alone(acoustic, measurements, count, scene);
    }
}

uint16_t mh_acoustic_exchanged(const struct mh_acoustic_scene *scene, mh_real seconds, mh_real sds)
{
    uint16_t exchanged = 0;
    if (scene->others_count == 0) {
        return 0;
    }
    const struct mh_vec2 position = mh_acoustic_position(&scene->own), velocity = mh_acoustic_velocity(&scene->own);
    const struct mh_sym2 covariance = mh_acoustic_covariance(&scene->own);
    for (uint8_t i = 0; i < scene->others_count; i++) {
        const struct mh_acoustic_other *other = &scene->others[i];
        const struct mh_vec2 away = mh_vec2_between(position, other->position);
        const struct mh_vec2 speed = mh_vec2_between(velocity, other->velocity);
        const mh_wide square = mh_vec2_square(speed);
        /* since the last fix they were nearest to each other so long ago */
        const mh_real ago = square > 0 ? mh_clamp(mh_wide_ratio(mh_vec2_dot(away, speed), square), 0, seconds) : 0;
        const mh_real apart = mh_vec2_length(mh_vec2_along(away, -ago, speed)) - mh_group_extent(&scene->own.group) -
                              mh_group_extent(&other->group);
        const mh_real variance = mh_add(mh_add(mh_add(covariance.xx / 2, covariance.yy / 2), other->covariance.xx / 2),
                                        other->covariance.yy / 2);
        if (apart < mh_max(MH_ACOUSTIC_DISTINCT_M, mh_mul(sds, mh_sqrt(variance)))) {
            exchanged = (uint16_t)(exchanged | 1u << i);
        }
    }
    return exchanged;
}
