#include "motehound/group.h"

#include <string.h>

#define OFFSET 0.5f         /* m of a unit in a member's offset */
#define VELOCITY 0.25f      /* m/s in a target's velocity */
#define TIME (1.0f / 16.0f) /* s in a time */
#define TIME_MAX UINT16_MAX
#define NEVER_ALONE INT8_MIN /* vx of a target that was found in a group */

static int8_t coarse(mh_real value, mh_real unit)
{
    const mh_real units = mh_clamp(value / unit, -127.0f, 127.0f);
    return (int8_t)(units < 0 ? units - 0.5f : units + 0.5f);
}

static uint16_t later(uint16_t time, mh_real seconds)
{
    const mh_real units = (mh_real)time + seconds / TIME + 0.5f;
    return units < (mh_real)TIME_MAX ? (uint16_t)units : TIME_MAX;
}

static bool place_valid(struct mh_vec2 place) { return mh_abs(place.x) <= 1e6f && mh_abs(place.y) <= 1e6f; }

static mh_real distance(struct mh_vec2 a, struct mh_vec2 b)
{
    return mh_sqrt(mh_squared(a.x - b.x) + mh_squared(a.y - b.y));
}

/* Mean of the places, and the members' offsets from it; root mean square of them. */
static struct mh_vec2 place_members(struct mh_group *group, const struct mh_vec2 *places, mh_real *extent)
{
    struct mh_vec2 mean = {0, 0};
    for (uint8_t i = 0; i < group->count; i++) {
        mean.x += places[i].x;
        mean.y += places[i].y;
    }
    mean.x /= (mh_real)group->count;
    mean.y /= (mh_real)group->count;
    mh_real square = 0;
    for (uint8_t i = 0; i < group->count; i++) {
        square += mh_squared(places[i].x - mean.x) + mh_squared(places[i].y - mean.y);
        group->members[i].x = coarse(places[i].x - mean.x, OFFSET);
        group->members[i].y = coarse(places[i].y - mean.y, OFFSET);
    }
    *extent = mh_sqrt(square / (mh_real)group->count);
    return mean;
}

static void set_extent(struct mh_group *group, mh_real extent)
{
    group->extent = (uint16_t)(mh_min(extent, 600.0f) * 100.0f + 0.5f);
}

enum mh_status mh_group_found(struct mh_group *group, uint32_t target, const struct mh_vec2 *places, uint8_t count,
                              struct mh_vec2 *centroid)
{
    if (count < 1 || count > MH_GROUP_MAX) {
        return MH_ERR_ARGUMENT;
    }
    for (uint8_t i = 0; i < count; i++) {
        if (!place_valid(places[i])) {
            return MH_ERR_NOT_FINITE;
        }
    }
    *group = (struct mh_group){.count = count};
    for (uint8_t i = 0; i < count; i++) {
        group->targets[i] = (struct mh_group_target){.target = target + i, .vx = NEVER_ALONE, .alone = TIME_MAX};
    }
    mh_real extent;
    *centroid = place_members(group, places, &extent);
    set_extent(group, extent);
    return MH_OK;
}

mh_real mh_group_gap(const struct mh_group *a, struct mh_vec2 centroid_a, const struct mh_group *b,
                     struct mh_vec2 centroid_b)
{
    mh_real least = INFINITY;
    for (uint8_t i = 0; i < a->count; i++) {
        for (uint8_t j = 0; j < b->count; j++) {
            least = mh_min(least, distance(mh_group_place(a, centroid_a, i), mh_group_place(b, centroid_b, j)));
        }
    }
    return least;
}

/* The members in parts, by single linkage: member i belongs to part part_of[i], and part k has sizes[k] members; the largest part is number 0, among equals the one
 * of the first member. Returns how many parts there are. */
static uint8_t link_members(const struct mh_group *group, mh_real within, uint8_t *part_of, uint8_t *sizes)
{
    const uint8_t n = group->count;
    uint8_t link[MH_GROUP_MAX] = {0}, size[MH_GROUP_MAX] = {0}; /* both by the first member of the part */
    for (uint8_t i = 0; i < n; i++) {
        link[i] = i;
    }
    /* A link reaches at least one member farther each time. */
    for (uint8_t pass = 1; pass < n; pass++) {
        for (uint8_t i = 0; i < n; i++) {
            for (uint8_t j = 0; j < n; j++) {
                if (link[j] < link[i] &&
                    distance(mh_group_offset(&group->members[i]), mh_group_offset(&group->members[j])) < within) {
                    link[i] = link[j];
                }
            }
        }
    }
    for (uint8_t i = 0; i < n; i++) {
        size[link[i]]++;
    }
    uint8_t parts = 0;
    for (uint8_t of_size = n; of_size > 0; of_size--) {
        for (uint8_t first = 0; first < n; first++) {
            if (size[first] != of_size) {
                continue;
            }
            for (uint8_t i = first; i < n; i++) {
                if (link[i] == first) {
                    part_of[i] = parts;
                }
            }
            sizes[parts++] = of_size;
        }
    }
    return parts;
}

enum mh_status mh_group_take(struct mh_group *group, const struct mh_group_config *config, mh_real seconds,
                             const struct mh_vec2 *places, struct mh_vec2 *centroid, bool *split)
{
    if (!mh_within(seconds, 0.0f, 4000.0f)) {
        return MH_ERR_ARGUMENT;
    }
    for (uint8_t i = 0; i < group->count; i++) {
        if (!place_valid(places[i])) {
            return MH_ERR_NOT_FINITE;
        }
    }
    mh_real extent;
    *centroid = place_members(group, places, &extent);
    set_extent(group, config->extent_memory * mh_group_extent(group) + (1.0f - config->extent_memory) * extent);

    uint8_t part_of[MH_GROUP_MAX], sizes[MH_GROUP_MAX];
    const uint8_t parts = link_members(group, config->split_m, part_of, sizes);
    uint8_t ends = 0, end = 0;
    for (uint8_t k = 0; k + 1 < parts; k++) {
        end = (uint8_t)(end + sizes[k]);
        ends = (uint8_t)(ends | 1u << (end - 1));
    }
    if (parts > 1 && group->splits > 0 && ends == group->parts) {
        group->splits = (uint8_t)(group->splits < MH_GROUP_EPOCHS_MAX ? group->splits + 1 : MH_GROUP_EPOCHS_MAX);
        group->split_time = later(group->split_time, seconds);
    } else {
        group->splits = parts > 1;
        group->split_time = 0;
        group->parts = ends;
        for (uint8_t i = 0; i < group->count; i++) {
            group->members[i].first_x = parts > 1 ? group->members[i].x : 0;
            group->members[i].first_y = parts > 1 ? group->members[i].y : 0;
        }
    }
    for (uint8_t i = 0; i < group->count; i++) {
        group->targets[i].alone = later(group->targets[i].alone, group->count > 1 ? seconds : 0.0f);
    }
    *split = group->splits >= config->split_epochs;
    return MH_OK;
}

bool mh_group_approach(struct mh_group *group, const struct mh_group_config *config,
                       const struct mh_group_neighbour *neighbours, size_t count)
{
    const struct mh_group_neighbour *near = NULL;
    for (size_t i = 0; i < count && group->splits == 0; i++) {
        const struct mh_group_neighbour *other = &neighbours[i];
        if (!(other->gap < config->merge_m) || group->count + other->count > MH_GROUP_MAX) {
            continue;
        }
        const bool known = group->merges > 0 && other->target == group->near;
        if (known || near == NULL || other->gap < near->gap) {
            near = other;
        }
        if (known) {
            break;
        }
    }
    if (near == NULL) {
        group->merges = 0;
        group->near = 0;
        return false;
    }
    const bool again = group->merges > 0 && near->target == group->near;
    group->merges = (uint8_t)(again ? group->merges + (group->merges < MH_GROUP_EPOCHS_MAX) : 1);
    group->near = near->target;
    return group->merges >= config->merge_epochs &&
           (group->count > near->count || (group->count == near->count && group->targets[0].target < near->target));
}

enum mh_status mh_group_join(struct mh_group *group, struct mh_vec2 *centroid, struct mh_vec2 *velocity,
                             const struct mh_group *other, struct mh_vec2 other_centroid, struct mh_vec2 other_velocity)
{
    const struct mh_group *sides[2] = {group, other};
    const struct mh_vec2 centroids[2] = {*centroid, other_centroid}, velocities[2] = {*velocity, other_velocity};
    if (group->count + other->count > MH_GROUP_MAX) {
        return MH_ERR_CAPACITY;
    }
    for (uint8_t side = 0; side < 2; side++) {
        if (!place_valid(centroids[side]) || !place_valid(velocities[side])) {
            return MH_ERR_NOT_FINITE;
        }
    }
    struct mh_group all = {.count = (uint8_t)(group->count + other->count),
                           .unresolved = group->unresolved || other->unresolved};
    struct mh_vec2 places[MH_GROUP_MAX], sum = {0, 0};
    uint8_t taken[2] = {0, 0};
    for (uint8_t i = 0; i < all.count; i++) {
        /* The lower of the next of both sides. */
        const uint8_t side =
            taken[0] == group->count ||
            (taken[1] < other->count && other->targets[taken[1]].target < group->targets[taken[0]].target);
        const uint8_t k = taken[side]++;
        all.targets[i] = sides[side]->targets[k];
        if (i > 0 && all.targets[i].target == all.targets[i - 1].target) {
            return MH_ERR_ARGUMENT;
        }
        if (sides[side]->count == 1) {
            all.targets[i].vx = coarse(velocities[side].x, VELOCITY);
            all.targets[i].vy = coarse(velocities[side].y, VELOCITY);
            all.targets[i].alone = 0;
        }
        places[i] = mh_group_place(sides[side], centroids[side], k);
        sum.x += velocities[side].x;
        sum.y += velocities[side].y;
    }
    mh_real extent;
    *centroid = place_members(&all, places, &extent);
    *velocity = (struct mh_vec2){sum.x / (mh_real)all.count, sum.y / (mh_real)all.count};
    set_extent(&all, extent);
    *group = all;
    return MH_OK;
}

/* A group in parts, and how well an allotment of its targets to them explains their velocities. */
struct parting {
    const struct mh_group *group;
    struct mh_vec2 velocities[MH_GROUP_MAX]; /* of the parts */
    mh_real variance;                        /* of each of their components */
    mh_real turn;                            /* and how much it grows in a second */
};

/* Twice the negative logarithm of the likelihood that target i is in part allotment[i], but for a constant. */
static mh_real unlikelihood(const struct parting *parting, const uint8_t *allotment)
{
    mh_real sum = 0;
    for (uint8_t i = 0; i < parting->group->count; i++) {
        const struct mh_group_target *target = &parting->group->targets[i];
        if (target->vx == NEVER_ALONE) {
            continue;
        }
        const struct mh_vec2 kept = {(mh_real)target->vx * VELOCITY, (mh_real)target->vy * VELOCITY};
        const struct mh_vec2 now = parting->velocities[allotment[i]];
        sum += (mh_squared(now.x - kept.x) + mh_squared(now.y - kept.y)) /
               (parting->variance + parting->turn * (mh_real)target->alone * TIME);
    }
    return sum;
}

/* The next permutation in lexicographic order, of elements that may be equal; false after the last (Knuth, The Art of Computer Programming 4A, 7.2.1.2, algorithm L). */
static bool next_permutation(uint8_t *a, uint8_t n)
{
    uint8_t j = (uint8_t)(n - 1), l = (uint8_t)(n - 1);
    while (j > 0 && a[j - 1] >= a[j]) {
        j--;
    }
    if (j == 0) {
        return false;
    }
    while (a[j - 1] >= a[l]) {
        l--;
    }
    const uint8_t pivot = a[j - 1];
    a[j - 1] = a[l];
    a[l] = pivot;
    for (uint8_t i = j, k = (uint8_t)(n - 1); i < k; i++, k--) {
        const uint8_t swapped = a[i];
        a[i] = a[k];
        a[k] = swapped;
    }
    return true;
}

/* The first permutation: the parts in order, each as often as it has members. */
static void first_allotment(const uint8_t *sizes, uint8_t parts, uint8_t *allotment)
{
    for (uint8_t k = 0, i = 0; k < parts; k++) {
        for (uint8_t left = sizes[k]; left > 0; left--) {
            allotment[i++] = k;
        }
    }
}

enum mh_status mh_group_part(const struct mh_group *group, const struct mh_group_config *config,
                             struct mh_vec2 centroid, struct mh_vec2 velocity, uint8_t part, struct mh_group *to,
                             struct mh_vec2 *to_centroid, struct mh_vec2 *to_velocity, mh_real *velocity_sd)
{
    const uint8_t n = group->count;
    uint8_t part_of[MH_GROUP_MAX], sizes[MH_GROUP_MAX];
    const uint8_t parts = link_members(group, config->split_m, part_of, sizes);
    if (parts < 2 || part >= parts || group->splits < config->split_epochs) {
        return MH_NONE;
    }

    /* The velocities of the parts, relative to the centroid over the instants counted. */
    const mh_real per_second = 1.0f / mh_max((mh_real)group->split_time * TIME, 1.0f);
    struct parting parting = {.group = group,
                              .variance = 2.0f * mh_squared(config->fix_sd_m * per_second) + mh_squared(VELOCITY),
                              .turn = mh_squared(config->turn_sd_mps)};
    for (uint8_t k = 0; k < parts; k++) {
        parting.velocities[k] = velocity;
    }
    for (uint8_t i = 0; i < n; i++) {
        const struct mh_group_member *member = &group->members[i];
        const uint8_t k = part_of[i];
        const mh_real weight = OFFSET * per_second / (mh_real)sizes[k];
        parting.velocities[k].x += (mh_real)(member->x - member->first_x) * weight;
        parting.velocities[k].y += (mh_real)(member->y - member->first_y) * weight;
    }

    /* The best allotment, then whether one that is nearly as good gives this part other targets. */
    uint8_t allotment[MH_GROUP_MAX] = {0}, best[MH_GROUP_MAX] = {0};
    mh_real least = INFINITY;
    first_allotment(sizes, parts, allotment);
    do {
        const mh_real cost = unlikelihood(&parting, allotment);
        if (cost < least) {
            least = cost;
            memcpy(best, allotment, n);
        }
    } while (next_permutation(allotment, n));
    bool unresolved = group->unresolved;
    const mh_real doubtful = least + 2.0f * mh_log(config->odds);
    first_allotment(sizes, parts, allotment);
    do {
        bool same = true;
        for (uint8_t i = 0; i < n; i++) {
            same = same && (group->targets[i].vx == NEVER_ALONE || (allotment[i] == part) == (best[i] == part));
        }
        unresolved = unresolved || (!same && unlikelihood(&parting, allotment) < doubtful);
    } while (next_permutation(allotment, n));

    struct mh_vec2 places[MH_GROUP_MAX];
    struct mh_group found = {.count = 0, .unresolved = unresolved};
    for (uint8_t i = 0; i < n; i++) {
        if (part_of[i] == part) {
            places[found.count++] = mh_group_place(group, centroid, i);
        }
    }
    for (uint8_t i = 0, k = 0; i < n; i++) {
        if (best[i] == part) {
            found.targets[k++] = group->targets[i];
        }
    }
    mh_real extent;
    *to_centroid = place_members(&found, places, &extent);
    set_extent(&found, extent);
    if (found.count == 1) {
        mh_group_single(&found, found.targets[0].target);
        found.unresolved = unresolved;
    }
    *to_velocity = parting.velocities[part];
    *velocity_sd = mh_sqrt(parting.variance);
    *to = found;
    return MH_OK;
}
