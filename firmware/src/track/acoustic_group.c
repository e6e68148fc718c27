#include "acoustic_parts.h"
#include "motehound/joint_sources.h"
#include "motehound/source_count.h"

/* One source leaves residuals of this mean square, in their variances, once in 250 times; several equal ones always. */
#define MISFIT_OF_ONE 3.0f
#define MISFIT_OF_SEVERAL 2.0f /* as many as there are seldom leave more */

/* The centroid by weights (Han's group of many): of the energy, up to a limit, this power */
#define WEIGHT_MOST 16.0f
#define WEIGHT_POWER 0.75f

/* Two sources are looked for at least so far apart, m. */
#define APART_M 20.0f

/* Mean square of ln(y / e) over its variance. */
static mh_real misfit(const struct mh_sound *sound, const struct mh_heard *heard, size_t heard_count,
                      const struct mh_source *sources, const struct mh_vec2 *places, size_t count)
{
    mh_real sum = 0;
    for (size_t i = 0; i < heard_count; i++) {
        mh_real e = 0;
        for (size_t k = 0; k < count; k++) {
            const mh_real square =
                mh_squared(places[k].x - heard[i].place.x) + mh_squared(places[k].y - heard[i].place.y);
            e += (mh_real)(1 + sources[k].besides) * mh_sound_energy(sound, square);
        }
        sum += mh_squared(mh_log(mh_max(heard[i].energy, 0.25f) / e)) / mh_sound_log_variance(sound, e);
    }
    return sum / (mh_real)heard_count;
}

static struct mh_sym2 around(mh_real sd_m)
{
    const struct mh_sym2 covariance = {mh_squared(sd_m), 0, mh_squared(sd_m)};
    return covariance;
}

/* ---- a new group ---- */

/* So many sources, at most `count`, where they fit best -> places, *misfit_of. Returns how many they are; 0: none can be found. */
static uint8_t place_sources(const struct mh_acoustic_config *config, const struct mh_acoustic_scene *scene,
                             uint8_t count, struct mh_vec2 *places, mh_real *misfit_of)
{
    struct mh_source sources[MH_SOURCES_MAX];
    struct mh_source_fix fixes[MH_SOURCES_MAX];
    uint8_t found;
    if (mh_source_count(&config->sound, scene->heard, scene->heard_count, count, places, &found) != MH_OK) {
        return 0;
    }
    for (uint8_t k = 0; k < found; k++) {
        const struct mh_source source = {places[k], around(config->group.member_sd_m), 0};
        sources[k] = source;
    }
    if (mh_joint_sources(&config->sound, scene->heard, scene->heard_count, sources, NULL, found, fixes) == MH_OK) {
        for (uint8_t k = 0; k < found; k++) {
            places[k] = fixes[k].position;
        }
    }
    *misfit_of = misfit(&config->sound, scene->heard, scene->heard_count, sources, places, found);
    return found;
}

void mh_acoustic_find_group(const struct mh_acoustic_config *config, struct mh_acoustic_scene *scene,
                            struct mh_acoustic_fix *fix)
{
    const struct mh_source one = {fix->position, fix->covariance, 0};
    struct mh_vec2 places[MH_SOURCES_MAX];
    mh_real off = misfit(&config->sound, scene->heard, scene->heard_count, &one, &fix->position, 1);
    uint8_t count = 1;
    if (off <= MISFIT_OF_ONE) {
        return;
    }
    /* as few as explain what is heard, and no more than there seem to be */
    for (uint8_t most = 2; most <= MH_GROUP_MAX && off > MISFIT_OF_SEVERAL; most++) {
        count = place_sources(config, scene, most, places, &off);
        if (count < most) {
            break;
        }
    }
    if (count > 1 &&
        mh_group_found(&scene->own.group, scene->own.group.targets[0].target, places, count, &fix->position) == MH_OK) {
        fix->covariance = around(config->group.fix_sd_m);
        scene->own.mode = MH_TARGET_GROUP;
    }
}

/* ---- a group by weights ---- */

/* Nearer to the own centroid than to another's. */
static bool is_own(const struct mh_acoustic_scene *scene, struct mh_vec2 place)
{
    const struct mh_vec2 own = mh_acoustic_position(&scene->own);
    const mh_real square = mh_squared(place.x - own.x) + mh_squared(place.y - own.y);
    for (uint8_t j = 0; j < scene->others_count; j++) {
        const struct mh_vec2 other = scene->others[j].position;
        if (mh_squared(place.x - other.x) + mh_squared(place.y - other.y) < square) {
            return false;
        }
    }
    return true;
}

/* Of what is the own group's -> centroid. Returns false if nothing is. */
static bool weigh(const struct mh_acoustic_scene *scene, struct mh_vec2 *centroid)
{
    struct mh_vec2 sum = {0, 0};
    mh_real weights = 0;
    for (size_t i = 0; i < scene->heard_count; i++) {
        const struct mh_heard *heard = &scene->heard[i];
        if (is_own(scene, heard->place)) {
            const mh_real weight = mh_exp(WEIGHT_POWER * mh_log(mh_clamp(heard->energy, 1.0f, WEIGHT_MOST)));
            sum.x += weight * heard->place.x;
            sum.y += weight * heard->place.y;
            weights += weight;
        }
    }
    if (!(weights > 0)) {
        return false;
    }
    centroid->x = sum.x / weights;
    centroid->y = sum.y / weights;
    return true;
}

struct mh_vec2 mh_acoustic_expected_centroid(const struct mh_acoustic_config *config,
                                             const struct mh_acoustic_scene *scene)
{
    struct mh_vec2 centroid = mh_acoustic_position(&scene->own);
    if (0.5f * (scene->covariance.xx + scene->covariance.yy) > mh_squared(config->group.member_sd_m)) {
        (void)weigh(scene, &centroid);
    }
    return centroid;
}

static void leave_others(struct mh_acoustic_scene *scene)
{
    size_t count = 0;
    for (size_t i = 0; i < scene->heard_count; i++) {
        if (is_own(scene, scene->heard[i].place)) {
            scene->heard[count++] = scene->heard[i];
        }
    }
    scene->heard_count = count;
}

/* Where two sources are looked for: at the members farthest apart, or, where these are together, on the line on which the nodes lie. */
static void begin_two(const struct mh_group *group, struct mh_vec2 centroid, const struct mh_heard *heard, size_t count,
                      struct mh_vec2 *two)
{
    mh_real most = mh_squared(APART_M);
    bool apart = false;
    for (uint8_t i = 0; i < group->count; i++) {
        for (uint8_t j = (uint8_t)(i + 1); j < group->count; j++) {
            const struct mh_vec2 a = mh_group_place(group, centroid, i), b = mh_group_place(group, centroid, j);
            const mh_real square = mh_squared(a.x - b.x) + mh_squared(a.y - b.y);
            if (square >= most) {
                most = square;
                two[0] = a;
                two[1] = b;
                apart = true;
            }
        }
    }
    if (apart) {
        return;
    }
    mh_real xx = 0, xy = 0, yy = 0;
    for (size_t i = 0; i < count; i++) {
        const struct mh_vec2 off = {heard[i].place.x - centroid.x, heard[i].place.y - centroid.y};
        xx += off.x * off.x;
        xy += off.x * off.y;
        yy += off.y * off.y;
    }
    const struct mh_vec2 along = mh_direction(0.5f * mh_atan2(2.0f * xy, xx - yy));
    for (int side = 0; side < 2; side++) {
        const mh_real way = side == 0 ? 0.5f * APART_M : -0.5f * APART_M;
        two[side].x = centroid.x + way * along.x;
        two[side].y = centroid.y + way * along.y;
    }
}

enum mh_status mh_acoustic_weigh(const struct mh_acoustic_config *config, struct mh_acoustic_scene *scene,
                                 mh_real seconds, struct mh_acoustic_fix *fix)
{
    struct mh_group *group = &scene->own.group;
    struct mh_vec2 centroid;
    if (!weigh(scene, &centroid)) {
        return MH_NONE;
    }
    const struct mh_vec2 expected = mh_acoustic_expected_centroid(config, scene);
    leave_others(scene);
    const struct mh_heard *heard = scene->heard;
    const size_t count = scene->heard_count;

    /* Two sources of n targets together, however those are divided: the best fit. */
    struct mh_vec2 start[2], best[2];
    mh_real least = INFINITY;
    uint8_t at_first = 0;
    begin_two(group, expected, heard, count, start);
    best[0] = best[1] = centroid;
    for (uint8_t first = 1; first < group->count; first++) {
        const struct mh_source sources[2] = {
            {start[0], around(config->group.member_sd_m), (uint8_t)(first - 1)},
            {start[1], around(config->group.member_sd_m), (uint8_t)(group->count - first - 1)}};
        struct mh_source_fix fixes[2];
        if (mh_joint_sources(&config->sound, heard, count, sources, NULL, 2, fixes) != MH_OK) {
            continue;
        }
        const struct mh_vec2 places[2] = {fixes[0].position, fixes[1].position};
        const mh_real off = misfit(&config->sound, heard, count, sources, places, 2);
        if (off < least) {
            least = off;
            at_first = first;
            best[0] = places[0];
            best[1] = places[1];
        }
    }
    struct mh_vec2 members[MH_GROUP_MAX], middle;
    bool split;
    for (uint8_t i = 0; i < group->count; i++) {
        members[i] = best[i >= at_first];
    }
    const enum mh_status status = mh_group_take(group, &config->group, seconds, members, &middle, &split);
    if (status == MH_OK) {
        fix->position = centroid;
        fix->covariance = around(config->group.fix_sd_m);
        fix->flags = (uint16_t)(fix->flags | (split ? MH_ESTIMATE_SPLIT : 0));
    }
    return status;
}
