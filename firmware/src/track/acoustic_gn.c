#include "acoustic_parts.h"
#include "motehound/joint_sources.h"

/* Of a fix, added to what Fisher's information leaves in each axis: the model is not the world, m2 */
#define MODEL_VARIANCE 0.25f

/* What is known of a member of the joint fit is never taken for surer than this, m2 */
#define PRIOR_VARIANCE 2.25f

#define ITERATIONS 5

/* (information + floor)^-1 + MODEL_VARIANCE */
static struct mh_sym2 covariance_of(const struct mh_sym2 *information, mh_real floor)
{
    const mh_real xx = information->xx + floor, yy = information->yy + floor, xy = information->xy;
    const mh_real scale = 1.0f / mh_max(xx * yy - xy * xy, floor * floor);
    const struct mh_sym2 covariance = {yy * scale + MODEL_VARIANCE, -xy * scale, xx * scale + MODEL_VARIANCE};
    return covariance;
}

/* Whatever is heard, it is within the range. */
static mh_real least_information(const struct mh_acoustic_config *config)
{
    return 1.0f / mh_squared(config->sensing_range_m);
}

/* ---- alone ---- */

static enum mh_status locate_gn(const struct mh_acoustic_config *config, const struct mh_heard *heard, size_t count,
                                struct mh_acoustic_fix *fix)
{
    struct mh_sym2 information;
    const enum mh_status status = mh_sound_fix(&config->sound, heard, mh_acoustic_strongest(config, count, count), NULL,
                                               &fix->position, &information);
    if (status == MH_OK) {
        fix->covariance = covariance_of(&information, least_information(config));
    }
    return status;
}

/* Sum of the squares of what is unexplained of the energies, in their variances. */
static mh_real misfit(const struct mh_sound *sound, const struct mh_heard *heard, size_t count, struct mh_vec2 at)
{
    mh_real sum = 0;
    for (size_t i = 0; i < count; i++) {
        const mh_real energy =
            mh_sound_energy(sound, mh_squared(at.x - heard[i].place.x) + mh_squared(at.y - heard[i].place.y));
        sum += mh_squared(mh_log(heard[i].energy / energy)) / mh_sound_log_variance(sound, energy);
    }
    return sum;
}

/* From few nodes, or such as stand nearly on a line, the median of triples can end at the mirror image, or between both; from the prediction it ends elsewhere. */
static void reconsider_gn(const struct mh_acoustic_config *config, const struct mh_acoustic_scene *scene,
                          struct mh_acoustic_fix *fix)
{
    const size_t count = mh_acoustic_strongest(config, scene->heard_count, scene->heard_count);
    struct mh_acoustic_fix other = {.position = mh_acoustic_position(&scene->own),
                                    .flags = (uint16_t)(fix->flags | MH_ESTIMATE_MIRRORED)};
    struct mh_sym2 information;
    if (mh_sound_refine(&config->sound, scene->heard, count, NULL, ITERATIONS, &other.position, &information) !=
        MH_OK) {
        return;
    }
    other.covariance = covariance_of(&information, least_information(config));
    if (mh_acoustic_surprise(scene, &other) + misfit(&config->sound, scene->heard, count, other.position) <
        mh_acoustic_surprise(scene, fix) + misfit(&config->sound, scene->heard, count, fix->position)) {
        *fix = other;
    }
}

/* ---- together ---- */

/* The sources of a track -> sources; how many. */
static size_t sources_of(const struct mh_acoustic_config *config, const struct mh_group *group, struct mh_vec2 centroid,
                         const struct mh_sym2 *covariance, struct mh_source *sources)
{
    if (group->count < 2) {
        sources[0].position = centroid;
        sources[0].covariance = *covariance;
        sources[0].covariance.xx = mh_max(covariance->xx, PRIOR_VARIANCE);
        sources[0].covariance.yy = mh_max(covariance->yy, PRIOR_VARIANCE);
        sources[0].besides = 0;
        return 1;
    }
    const mh_real variance = mh_squared(config->group.member_sd_m);
    for (uint8_t i = 0; i < group->count; i++) {
        sources[i].position = mh_group_place(group, centroid, i);
        sources[i].covariance.xx = sources[i].covariance.yy = variance;
        sources[i].covariance.xy = 0;
        sources[i].besides = 0;
    }
    return group->count;
}

/* The nearest of those that are near and not yet in the fit; others_count if there is none. */
static uint8_t nearest(const struct mh_acoustic_scene *scene, const uint8_t *first)
{
    const struct mh_vec2 own = mh_acoustic_position(&scene->own);
    uint8_t best = scene->others_count;
    mh_real least = INFINITY;
    for (uint8_t i = 0; i < scene->others_count; i++) {
        const struct mh_acoustic_other *other = &scene->others[i];
        const mh_real square = mh_squared(other->position.x - own.x) + mh_squared(other->position.y - own.y);
        if (other->near && first[i] == 0 && square < least) {
            best = i;
            least = square;
        }
    }
    return best;
}

/* What the fit has found of another track, to judge by how near it is. */
static void put_back(const struct mh_source_fix *fixes, struct mh_acoustic_other *other)
{
    struct mh_vec2 sum = {0, 0};
    for (uint8_t i = 0; i < other->group.count; i++) {
        sum.x += fixes[i].position.x;
        sum.y += fixes[i].position.y;
    }
    other->position.x = sum.x / (mh_real)other->group.count;
    other->position.y = sum.y / (mh_real)other->group.count;
    if (other->group.count < 2) {
        other->covariance = fixes[0].covariance;
    }
}

static enum mh_status locate_jointly(const struct mh_acoustic_config *config, struct mh_acoustic_scene *scene,
                                     mh_real seconds, struct mh_acoustic_fix *fix)
{
    struct mh_source sources[MH_SOURCES_MAX];
    struct mh_source_fix fixes[MH_SOURCES_MAX];
    uint8_t first[MH_TARGETS_MAX] = {0}; /* source of each; 0, an own one: it is not in the fit */
    struct mh_group *group = &scene->own.group;
    const struct mh_vec2 expected =
        group->count > 1 ? mh_acoustic_expected_centroid(config, scene) : mh_acoustic_position(&scene->own);
    size_t count = sources_of(config, group, expected, &scene->covariance, sources);
    for (uint8_t i = nearest(scene, first); i < scene->others_count; i = nearest(scene, first)) {
        const struct mh_acoustic_other *other = &scene->others[i];
        if (count + other->group.count > MH_SOURCES_MAX) {
            break;
        }
        first[i] = (uint8_t)count;
        count += sources_of(config, &other->group, other->position, &other->covariance, &sources[count]);
    }
    const size_t used = mh_acoustic_strongest(config, scene->heard_count, scene->heard_count);
    const enum mh_status status = mh_joint_sources(&config->sound, scene->heard, used, sources, NULL, count, fixes);
    if (status != MH_OK) {
        return status;
    }
    for (uint8_t i = 0; i < scene->others_count; i++) {
        if (first[i] > 0) {
            put_back(&fixes[first[i]], &scene->others[i]);
        }
    }
    if (group->count < 2) {
        fix->position = fixes[0].position;
        fix->covariance = covariance_of(&fixes[0].information, least_information(config));
        return MH_OK;
    }
    struct mh_vec2 places[MH_GROUP_MAX];
    bool split;
    for (uint8_t i = 0; i < group->count; i++) {
        places[i] = fixes[i].position;
    }
    const mh_real variance = mh_squared(config->group.fix_sd_m);
    fix->covariance.xx = fix->covariance.yy = variance;
    fix->covariance.xy = 0;
    const enum mh_status grouped = mh_group_take(group, &config->group, seconds, places, &fix->position, &split);
    if (grouped == MH_OK && split) {
        fix->flags |= MH_ESTIMATE_SPLIT;
    }
    return grouped;
}

static bool approach(const struct mh_acoustic_config *config, struct mh_acoustic_scene *scene)
{
    struct mh_group_neighbour neighbours[MH_TARGETS_MAX];
    const struct mh_vec2 own = mh_acoustic_position(&scene->own);
    for (uint8_t i = 0; i < scene->others_count; i++) {
        const struct mh_acoustic_other *other = &scene->others[i];
        const struct mh_group_neighbour neighbour = {
            .target = other->target,
            .count = other->group.count,
            .gap = mh_group_gap(&scene->own.group, own, &other->group, other->position),
        };
        neighbours[i] = neighbour;
    }
    return mh_group_approach(&scene->own.group, &config->group, neighbours, scene->others_count);
}

/* ---- groups that begin, merge and part ---- */

enum mh_status mh_acoustic_begin_group(struct mh_acoustic *acoustic, uint32_t target, mh_tick time,
                                       const struct mh_place *places, uint8_t count, struct mh_vec2 velocity,
                                       mh_real position_sd_m, mh_real velocity_sd_mps)
{
    struct mh_vec2 members[MH_GROUP_MAX], centroid;
    struct mh_group group;
    if (acoustic == NULL || places == NULL || count < 2 || !mh_acoustic_follows_groups(acoustic)) {
        return MH_ERR_ARGUMENT;
    }
    if (count > MH_GROUP_MAX) {
        return MH_ERR_CAPACITY;
    }
    for (uint8_t i = 0; i < count; i++) {
        members[i] = mh_place_relative(&places[i], &places[0]);
    }
    enum mh_status status = mh_group_found(&group, target, members, count, &centroid);
    if (status == MH_OK) {
        const struct mh_place place = mh_place_from_offset(&places[0], centroid);
        status = mh_acoustic_begin(acoustic, target, time, &place, velocity, position_sd_m, velocity_sd_mps);
    }
    if (status == MH_OK) {
        acoustic->track.group = group;
        acoustic->track.mode = MH_TARGET_GROUP;
    }
    return status;
}

static enum mh_status join(void *state, const struct mh_saved_track *other)
{
    struct mh_acoustic *acoustic = state;
    struct mh_acoustic_track second;
    if (acoustic == NULL || other == NULL || other->bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!acoustic->tracking) {
        return MH_NONE;
    }
    if (mh_acoustic_read(&second, other->target, other->bytes, other->length) != MH_OK) {
        return MH_ERR_CORRUPT;
    }
    struct mh_acoustic_track joined = acoustic->track;
    if (mh_tick_before(second.updated, joined.updated) &&
        mh_acoustic_advance(&second, acoustic->config.acceleration_psd, joined.updated) != MH_OK) {
        return MH_ERR_CORRUPT;
    }
    const struct mh_vec2 from = mh_place_relative(&second.origin, &joined.origin), on = mh_acoustic_position(&second);
    const struct mh_vec2 position = {from.x + on.x, from.y + on.y};
    struct mh_vec2 centroid = mh_acoustic_position(&joined), velocity = {joined.filter.x[2], joined.filter.x[3]};
    const struct mh_vec2 second_velocity = {second.filter.x[2], second.filter.x[3]};
    const enum mh_status status =
        mh_group_join(&joined.group, &centroid, &velocity, &second.group, position, second_velocity);
    if (status != MH_OK) {
        return status == MH_ERR_CAPACITY ? status : MH_ERR_CORRUPT;
    }
    joined.filter.x[0] = centroid.x;
    joined.filter.x[1] = centroid.y;
    joined.filter.x[2] = velocity.x;
    joined.filter.x[3] = velocity.y;
    joined.mode = MH_TARGET_GROUP;
    acoustic->track = joined;
    return MH_OK;
}

static enum mh_status part(const void *state, uint8_t number, uint32_t *target, uint8_t *bytes, size_t *length)
{
    const struct mh_acoustic *acoustic = state;
    if (acoustic == NULL || target == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!acoustic->tracking) {
        return MH_NONE;
    }
    const struct mh_vec2 velocity = {acoustic->track.filter.x[2], acoustic->track.filter.x[3]};
    struct mh_acoustic_track own = acoustic->track;
    struct mh_vec2 position, moving;
    mh_real moving_sd;
    const enum mh_status status =
        mh_group_part(&acoustic->track.group, &acoustic->config.group, mh_acoustic_position(&acoustic->track), velocity,
                      number, &own.group, &position, &moving, &moving_sd);
    const mh_real position_variance = mh_squared(acoustic->config.group.fix_sd_m), variance = mh_squared(moving_sd);
    const struct mh_sym2 positions = {position_variance, 0, position_variance}, velocities = {variance, 0, variance};
    if (status != MH_OK || mh_acoustic_set(&own, position, &positions, moving, &velocities, 0) != MH_OK) {
        return MH_NONE;
    }
    own.mode = own.group.count > 1 ? MH_TARGET_GROUP : MH_TARGET_SPARSE;
    *target = own.group.targets[0].target;
    *length = mh_acoustic_write(&own, bytes);
    return MH_OK;
}

/* what a build of these capacities never calls is not linked */
#define TOGETHER (MH_TARGETS_MAX > 1 || MH_GROUP_MAX > 1)
#define GROUPS (MH_GROUP_MAX > 1)
static const struct mh_acoustic_kind kind = {locate_gn,
                                             reconsider_gn,
                                             TOGETHER ? locate_jointly : NULL,
                                             GROUPS ? mh_acoustic_weigh : NULL,
                                             GROUPS ? mh_acoustic_find_group : NULL,
                                             GROUPS ? approach : NULL};

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    return mh_acoustic_init(state, &kind, config, interval);
}

const struct mh_tracker mh_tracker_acoustic = {
    .name = "acoustic", .init = init, MH_ACOUSTIC_TRACKER, .join = join, .part = part};
