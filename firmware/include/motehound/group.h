/* Targets so close together that sound hardly tells them apart, followed as one: a group. What a track knows of it, and the decisions to merge and to
 * split; the centroid's filter is the track's own (acoustic.h).
 *
 * A group is n identified targets and n members, places about the centroid. Which target is which member is not known: sound does not say, and the members
 * change places as the fit likes it. A single target is a group of one.
 *
 * - Merge: the nearest members of two tracks are less than merge_m apart in merge_epochs instants in a row. The one with more members, at equal
 *   numbers the one with the lower identifier, says so (MH_ESTIMATE_MERGE) and takes the other in. Each target's velocity when it was last alone is kept.
 * - Split: linking all members that are less than split_m apart leaves more than one part, of the same sizes in split_epochs instants in a row
 *   (MH_ESTIMATE_SPLIT). The parts get their targets by least squares between the velocity of the parts over those instants and the velocities kept. Where another
 *   allotment would be nearly as good, for the targets may have turned meanwhile, the parts that it differs in are marked: MH_ESTIMATE_UNRESOLVED. Targets that were found in the group have
 *   never been anybody in particular: which of them gets which part does not matter.
 * merge_m < split_m and the counts are the hysteresis.
 *
 * All is kept as coarsely as it is known and exactly as it is saved (offsets in half metres within +- 63.5, velocities in quarters of m/s within +- 31.75,
 * both limited to that; times in sixteenths of seconds), so that a hand-over changes nothing. About 13 bytes a target.
 *
 * In fixed point (MH_REAL=fixed) there are what a group is, mh_group_single(), and its bytes, exact in either arithmetic: to reckon with another head's group. Groups that are found,
 * merge or part need float, as the tracker that follows them does. */
#ifndef MOTEHOUND_GROUP_H
#define MOTEHOUND_GROUP_H

#include "motehound/config.h"
#include "motehound/geometry.h"
#include "motehound/real.h"
#include "motehound/status.h"

#include <stddef.h>

enum mh_group_mode {
    MH_GROUP_NONE,    /* no groups: targets are followed one by one however near they are */
    MH_GROUP_MEMBERS, /* every member is a source of its own in one joint fit */
    MH_GROUP_WEIGHTS /* the centroid is the mean of the nodes, weighted by energy; members by a fit of two sources of n targets together */
};

/* How groups are followed. All finite and in the range given. */
struct mh_group_config {
    enum mh_group_mode mode;
    mh_real merge_m,
        split_m; /* 1 to 60, merge_m <= split_m; nominal 20 and 30, by weights 50 and 75 with split_m up to 120 */
    uint8_t merge_epochs; /* 1 to 15, nominal 2 */
    uint8_t split_epochs; /* 1 to 15, nominal 3; 1 leaves the parts without velocities of their own */
    mh_real
        member_sd_m;  /* how far a member may be from where it was, relative to the centroid: 0.1 to 100, nominal 12 */
    mh_real fix_sd_m; /* of a centroid found, 0.1 to 100, nominal 2.5 */
    mh_real extent_memory; /* share of the extent that stays at an instant, 0 to 0.99, nominal 0.6 */
    mh_real
        turn_sd_mps; /* a target's velocity changes by this much in 1 s, and with the square root of time, as the parts are told apart: 0.01 to 100, nominal 4: it may turn back within ten seconds */
    mh_real
        odds; /* UNRESOLVED where the second best allotment is not this many times less likely, 1 to 1e6, nominal 20 */
};

/* A target of a group: who it is, and its velocity when it was last alone; vx -128: it never was. */
struct mh_group_target {
    uint32_t target;
    int8_t vx, vy;  /* quarters of m/s */
    uint16_t alone; /* sixteenths of seconds since then, at most 65535 */
};

/* A member: where it is from the centroid, and where it was when the parts that are counted were first seen. Half metres. */
struct mh_group_member {
    int8_t x, y;
    int8_t first_x, first_y;
};

struct mh_group {
    struct mh_group_target targets[MH_GROUP_MAX]; /* ascending */
    struct mh_group_member members[MH_GROUP_MAX];
    uint32_t near;       /* merges > 0: whom it is near to */
    uint16_t extent;     /* root mean square distance of the members, smoothed, cm */
    uint16_t split_time; /* splits > 0: since the first of them, sixteenths of seconds */
    uint8_t count;       /* targets, and members: 1 to MH_GROUP_MAX */
    uint8_t merges;      /* instants in a row that it was near to `near` */
    uint8_t splits;      /* instants in a row that it fell into parts of the sizes `parts` */
    uint8_t
        parts; /* bit i: a part ends with member i, when the members are sorted by parts, and the parts by size; the last end is not marked */
    bool unresolved; /* its targets were parted from others without knowing which is which */
};

#define MH_GROUP_EPOCHS_MAX 15 /* of what is counted in four bits */

/* Bytes of a saved group of n, at most. */
#define MH_GROUP_BYTES(n) ((n) < 2 ? 6 : 3 + 12 * (n))

/* The values above, of `mode`. */
void mh_group_config_default(struct mh_group_config *config, enum mh_group_mode mode);

/* MH_ERR_ARGUMENT if a value is out of range. */
enum mh_status mh_group_config_check(const struct mh_group_config *config);

/* One target alone. */
void mh_group_single(struct mh_group *group, uint32_t target);

/* A group found as such: `count` targets, 1 to MH_GROUP_MAX, identified as target, target + 1, ..., at places[0 .. count) -> their centroid. Their velocities when
 * alone are unknown. Errors: MH_ERR_ARGUMENT (count), MH_ERR_NOT_FINITE. */
enum mh_status mh_group_found(struct mh_group *group, uint32_t target, const struct mh_vec2 *places, uint8_t count,
                              struct mh_vec2 *centroid);

static inline mh_real mh_group_extent(const struct mh_group *group) { return mh_real_from_ratio(group->extent, 100); }

/* Of a member from the centroid, m. */
static inline struct mh_vec2 mh_group_offset(const struct mh_group_member *member)
{
    return (struct mh_vec2){mh_real_from_ratio(member->x, 2), mh_real_from_ratio(member->y, 2)};
}

/* Where member i is, the centroid being at `centroid`. */
struct mh_vec2 mh_group_place(const struct mh_group *group, struct mh_vec2 centroid, uint8_t i);

/* Least distance of a member of one from a member of the other. */
mh_real mh_group_gap(const struct mh_group *a, struct mh_vec2 centroid_a, const struct mh_group *b,
                     struct mh_vec2 centroid_b);

/* `seconds` after the last call the members were found at places[0 .. count) -> the centroid found. Offsets, extent and the count of instants in parts are
 * set. `*split`: it is to be split (mh_group_part). Errors: MH_ERR_ARGUMENT (seconds not 0 to 4000), MH_ERR_NOT_FINITE (or a place farther than 1e6 from 0). */
enum mh_status mh_group_take(struct mh_group *group, const struct mh_group_config *config, mh_real seconds,
                             const struct mh_vec2 *places, struct mh_vec2 *centroid, bool *split);

/* Another track: who it is, how many targets it is, and how far off (mh_group_gap). */
struct mh_group_neighbour {
    uint32_t target;
    uint8_t count;
    mh_real gap;
};

/* After that, or after a single target's step, with all tracks around: -> whether this one is to take in `group->near` (MH_ESTIMATE_MERGE). Whom it has come near
 * to it goes on with while that is near, else with the nearest. A group that counts towards a split counts no merges, and none that is too large for a group. */
bool mh_group_approach(struct mh_group *group, const struct mh_group_config *config,
                       const struct mh_group_neighbour *neighbours, size_t count);

/* `group` and `other` become one -> `group`, its centroid and mean velocity, both weighted with the members. Errors, with nothing changed: MH_ERR_CAPACITY,
 * MH_ERR_ARGUMENT (they have a target in common), MH_ERR_NOT_FINITE. */
enum mh_status mh_group_join(struct mh_group *group, struct mh_vec2 *centroid, struct mh_vec2 *velocity,
                             const struct mh_group *other, struct mh_vec2 other_centroid,
                             struct mh_vec2 other_velocity);

/* Part `part`, from 0, of a group that is to be split, whose centroid and velocity are given -> it, its centroid, its velocity and the standard deviation of that in each axis. All permutations of up to
 * MH_GROUP_MAX targets are compared, each a few multiplications a target. Errors: MH_NONE (it has no such part). */
enum mh_status mh_group_part(const struct mh_group *group, const struct mh_group_config *config,
                             struct mh_vec2 centroid, struct mh_vec2 velocity, uint8_t part, struct mh_group *to,
                             struct mh_vec2 *to_centroid, struct mh_vec2 *to_velocity, mh_real *velocity_sd);

/* The group of `target`, its lowest identifier, which is not written -> bytes. Returns how many, at most MH_GROUP_BYTES(count):
 * count and `unresolved` (bit 7) (1); splits (high) and merges (low 4 bits) (1); with merges `near` (4); for groups of two and more extent (2); for each target vx, vy (1 + 1),
 * alone (2), but the first its identifier (4), and x, y of the member (1 + 1); with splits `parts` (1), split_time (2) and for each member first_x, first_y (1 + 1). */
size_t mh_group_write(const struct mh_group *group, uint8_t *bytes);

/* And back; at most `length` bytes are read -> how many they were. Errors: MH_ERR_CORRUPT (not what is written; nothing is changed). */
enum mh_status mh_group_read(struct mh_group *group, uint32_t target, const uint8_t *bytes, size_t length,
                             size_t *taken);

#endif
