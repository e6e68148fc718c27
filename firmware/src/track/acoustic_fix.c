#include "acoustic_parts.h"

/* Of a fix, added to what Fisher's information leaves in each axis: the model is not the world, m2 */
#define MODEL_VARIANCE 0.25f

/* What is known of a member of the joint fit is never taken for surer than this, m2 */
#define PRIOR_VARIANCE 2.25f

#define MIRROR_M 25.0f
#define MIRROR_GAIN 0.5f
#define MIRROR_SLACK 0.25f
#define MIRROR_SLACK_M 3.0f

#define DM_STRONGEST 3
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

static size_t strongest(const struct mh_acoustic_config *config, size_t count, size_t nominal)
{
    const size_t most = config->strongest > 0 ? config->strongest : nominal;
    return count < most ? count : most;
}

/* ---- alone ---- */

static enum mh_status locate_gn(const struct mh_acoustic_config *config, const struct mh_heard *heard, size_t count,
                                struct mh_acoustic_fix *fix)
{
    struct mh_sym2 information;
    const enum mh_status status =
        mh_sound_fix(&config->sound, heard, strongest(config, count, count), NULL, &fix->position, &information);
    if (status == MH_OK) {
        fix->covariance = covariance_of(&information, least_information(config));
    }
    return status;
}

static void state_nominal(const struct mh_acoustic_config *config, struct mh_acoustic_fix *fix)
{
    const mh_real variance = mh_squared(config->fix_sd_m);
    const struct mh_sym2 covariance = {variance, 0, variance};
    fix->covariance = covariance;
}

static enum mh_status locate_dm(const struct mh_acoustic_config *config, const struct mh_heard *heard, size_t count,
                                struct mh_acoustic_fix *fix)
{
    const struct mh_distance_table table = {config->sensing_range_m, config->intervals, (uint8_t)config->distances};
    const size_t used = strongest(config, count, DM_STRONGEST);
    state_nominal(config, fix);
    return used <= DM_STRONGEST ? mh_distance_fix(heard, used, &table, config->variant, &fix->position)
                                : mh_median_fix(heard, used, &table, &fix->position);
}

static enum mh_status locate_ml(const struct mh_acoustic_config *config, const struct mh_heard *heard, size_t count,
                                struct mh_acoustic_fix *fix)
{
    state_nominal(config, fix);
    return mh_likeliest(&config->sound, heard, strongest(config, count, count), MH_LIKELIHOOD_CONSTANT, &fix->position);
}

mh_real mh_acoustic_surprise(const struct mh_acoustic_track *track, const struct mh_acoustic_fix *fix)
{
    const struct mh_sym2 P = mh_acoustic_covariance(track), *R = &fix->covariance;
    const mh_real xx = P.xx + R->xx, xy = P.xy + R->xy, yy = P.yy + R->yy;
    const mh_real x = fix->position.x - track->filter.x[0], y = fix->position.y - track->filter.x[1];
    return (yy * x * x - 2.0f * xy * x * y + xx * y * y) / (xx * yy - xy * xy);
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
    const size_t count = strongest(config, scene->heard_count, scene->heard_count);
    struct mh_acoustic_fix other = {.position = mh_acoustic_position(&scene->own),
                                    .flags = (uint16_t)(fix->flags | MH_ESTIMATE_MIRRORED)};
    struct mh_sym2 information;
    if (mh_sound_refine(&config->sound, scene->heard, count, NULL, ITERATIONS, &other.position, &information) !=
        MH_OK) {
        return;
    }
    other.covariance = covariance_of(&information, least_information(config));
    if (mh_acoustic_surprise(&scene->own, &other) + misfit(&config->sound, scene->heard, count, other.position) <
        mh_acoustic_surprise(&scene->own, fix) + misfit(&config->sound, scene->heard, count, fix->position)) {
        *fix = other;
    }
}

static bool meets_all(const struct mh_acoustic_config *config, const struct mh_heard *heard, size_t count,
                      struct mh_vec2 point)
{
    const struct mh_distance_table exact = {config->sensing_range_m, 0, MH_DISTANCE_MIDDLE};
    for (size_t i = 0; i < count; i++) {
        const mh_real radius = mh_distance(&exact, heard[i].energy);
        const mh_real away = mh_sqrt(mh_squared(point.x - heard[i].place.x) + mh_squared(point.y - heard[i].place.y));
        if (mh_abs(away - radius) > MIRROR_SLACK * radius + MIRROR_SLACK_M) {
            return false;
        }
    }
    return true;
}

void mh_acoustic_check_mirror(const struct mh_acoustic_config *config, const struct mh_acoustic_scene *scene,
                              struct mh_acoustic_fix *fix)
{
    const struct mh_distance_table exact = {config->sensing_range_m, 0, MH_DISTANCE_MIDDLE};
    const struct mh_vec2 expected = mh_acoustic_position(&scene->own);
    const size_t count = scene->heard_count < 3 ? scene->heard_count : 3;
    const mh_real off = mh_sqrt(mh_squared(fix->position.x - expected.x) + mh_squared(fix->position.y - expected.y));
    mh_real least = MIRROR_GAIN * off;
    if (!(off > MIRROR_M)) {
        return;
    }
    struct mh_circle circles[3];
    for (size_t i = 0; i < count; i++) {
        circles[i].centre = scene->heard[i].place;
        circles[i].radius = mh_distance(&exact, scene->heard[i].energy);
    }
    for (size_t i = 0; i < count; i++) {
        for (size_t j = i + 1; j < count; j++) {
            struct mh_vec2 crossings[2];
            const int crossing_count = mh_crossings(&circles[i], &circles[j], crossings) ? 2 : 0;
            for (int k = 0; k < crossing_count; k++) {
                const mh_real away =
                    mh_sqrt(mh_squared(crossings[k].x - expected.x) + mh_squared(crossings[k].y - expected.y));
                if (away <= least && meets_all(config, scene->heard, count, crossings[k])) {
                    least = away;
                    fix->position = crossings[k];
                    fix->flags |= MH_ESTIMATE_MIRRORED;
                }
            }
        }
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
    const struct mh_sym2 covariance = mh_acoustic_covariance(&scene->own);
    const struct mh_vec2 expected =
        group->count > 1 ? mh_acoustic_expected_centroid(config, scene) : mh_acoustic_position(&scene->own);
    size_t count = sources_of(config, group, expected, &covariance, sources);
    for (uint8_t i = nearest(scene, first); i < scene->others_count; i = nearest(scene, first)) {
        const struct mh_acoustic_other *other = &scene->others[i];
        if (count + other->group.count > MH_SOURCES_MAX) {
            break;
        }
        first[i] = (uint8_t)count;
        count += sources_of(config, &other->group, other->position, &other->covariance, &sources[count]);
    }
    const size_t used = strongest(config, scene->heard_count, scene->heard_count);
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

/* what a build of these capacities never calls is not linked */
#define TOGETHER (MH_TARGETS_MAX > 1 || MH_GROUP_MAX > 1)
#define GROUPS (MH_GROUP_MAX > 1)
const struct mh_acoustic_kind mh_acoustic_kind_gn = {locate_gn,
                                                     reconsider_gn,
                                                     TOGETHER ? locate_jointly : NULL,
                                                     GROUPS ? mh_acoustic_weigh : NULL,
                                                     GROUPS ? mh_acoustic_find_group : NULL,
                                                     GROUPS ? approach : NULL};
const struct mh_acoustic_kind mh_acoustic_kind_dm = {.locate = locate_dm};
const struct mh_acoustic_kind mh_acoustic_kind_ml = {.locate = locate_ml};
