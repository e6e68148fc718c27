/* The parts of the acoustic trackers. */
#ifndef MOTEHOUND_ACOUSTIC_PARTS_H
#define MOTEHOUND_ACOUSTIC_PARTS_H

#include "motehound/acoustic.h"
#include "motehound/joint_sources.h"

/* ---- acoustic_saved.c: a track and its bytes ---- */

/* Returns the length, at most MH_ACOUSTIC_SAVED_MAX. */
size_t mh_acoustic_write(const struct mh_acoustic_track *track, uint8_t *bytes);
/* Errors: MH_ERR_CORRUPT (not what is written; nothing is changed). */
enum mh_status mh_acoustic_read(struct mh_acoustic_track *track, uint32_t target, const uint8_t *bytes, size_t length);

/* Move its filter on to `time`. Errors: MH_ERR_TIME (before its last fix), MH_ERR_NOT_FINITE. */
enum mh_status mh_acoustic_advance(struct mh_acoustic_track *track, mh_real acceleration_psd, mh_tick time);

static inline struct mh_vec2 mh_acoustic_position(const struct mh_acoustic_track *track)
{
    const struct mh_vec2 position = {track->filter.x[0], track->filter.x[1]};
    return position;
}

/* At most MH_ACOUSTIC_FASTEST_MPS; zero where it is unknown: before the second fix, and below MH_ACOUSTIC_SLOWEST_MPS. */
#define MH_ACOUSTIC_FASTEST_MPS 30.0f
#define MH_ACOUSTIC_SLOWEST_MPS 1.0f
struct mh_vec2 mh_acoustic_velocity(const struct mh_acoustic_track *track);

struct mh_sym2 mh_acoustic_covariance(const struct mh_acoustic_track *track);

/* ---- acoustic_scene.c: one instant, and who is near ---- */

/* Another track, predicted to the instant; or where the joint fit has found it. Relative to the own track's origin. */
struct mh_acoustic_other {
    uint32_t target;
    struct mh_vec2 position, velocity;
    struct mh_sym2 covariance;
    struct mh_group group;
    bool near; /* its sound is to be told apart from the own */
};

struct mh_acoustic_scene {
    struct mh_acoustic_track own; /* predicted to the instant */
    struct mh_acoustic_other others[MH_TARGETS_MAX];
    uint8_t others_count;
    bool alone;                                   /* none of them is near */
    struct mh_heard heard[MH_ACOUSTIC_HEARD_MAX]; /* strongest first */
    size_t heard_count;
    size_t own_count; /* of these within reach of the own track */
};

/* The others -> scene, near or not; the mode of the own track. Needs `own`. */
void mh_acoustic_look_around(const struct mh_acoustic *acoustic, mh_tick time, struct mh_acoustic_scene *scene);

/* What was heard that is of use -> scene. With a track and `jointly`: about all that are near; else about the own track, less the others' shares as the configuration says. */
void mh_acoustic_listen(const struct mh_acoustic *acoustic, bool jointly, const struct mh_measurement *measurements,
                        size_t count, struct mh_acoustic_scene *scene);

/* With which of the others the own track, at an instant `seconds` after the last fix, may have exchanged its identity, for they were nearer to each
 * other than MH_ACOUSTIC_DISTINCT_M, or than `sds` standard deviations of their distance: bit i for others[i]. */
#define MH_ACOUSTIC_DISTINCT_M 14.0f
uint16_t mh_acoustic_exchanged(const struct mh_acoustic_scene *scene, mh_real seconds, mh_real sds);

/* ---- acoustic_fix.c: where it is at one instant ---- */

struct mh_acoustic_fix {
    struct mh_vec2 position;
    struct mh_sym2 covariance;
    uint16_t flags; /* MH_ESTIMATE_MIRRORED, MH_ESTIMATE_SPLIT */
};

struct mh_acoustic_kind {
    /* By scene->heard, of which there are at least two, all the own target's. */
    enum mh_status (*locate)(const struct mh_acoustic_config *config, const struct mh_heard *heard, size_t count,
                             struct mh_acoustic_fix *fix);
    /* A fix that the prediction makes unlikely: the one that is nearer to it, if both together are likelier. NULL: it stays. */
    void (*reconsider)(const struct mh_acoustic_config *config, const struct mh_acoustic_scene *scene,
                       struct mh_acoustic_fix *fix);
    /* Together with all that are near, `seconds` after the last fix; a group's members. NULL: it cannot. */
    enum mh_status (*locate_jointly)(const struct mh_acoustic_config *config, struct mh_acoustic_scene *scene,
                                     mh_real seconds, struct mh_acoustic_fix *fix);
    /* The same of a group by weights (mh_acoustic_weigh). With approach. */
    enum mh_status (*weigh)(const struct mh_acoustic_config *config, struct mh_acoustic_scene *scene, mh_real seconds,
                            struct mh_acoustic_fix *fix);
    /* mh_acoustic_find_group. With approach. */
    void (*find_group)(const struct mh_acoustic_config *config, struct mh_acoustic_scene *scene,
                       struct mh_acoustic_fix *fix);
    /* Whether it is to take in the neighbour own.group.near. NULL: it follows no groups. */
    bool (*approach)(const struct mh_acoustic_config *config, struct mh_acoustic_scene *scene);
};

/* The fix's distance from where the own track is expected, chi-square. */
mh_real mh_acoustic_surprise(const struct mh_acoustic_track *track, const struct mh_acoustic_fix *fix);
#define MH_ACOUSTIC_GATE 25.0f

/* ---- acoustic_group.c: groups ---- */

/* What has been heard of a track that begins with `fix` may be several targets: then own.group, and the fix of its centroid. */
void mh_acoustic_find_group(const struct mh_acoustic_config *config, struct mh_acoustic_scene *scene,
                            struct mh_acoustic_fix *fix);

/* Where the own group's centroid is expected: as predicted, or where that is less certain than its members' offsets, by the weights of the nodes. */
struct mh_vec2 mh_acoustic_expected_centroid(const struct mh_acoustic_config *config,
                                             const struct mh_acoustic_scene *scene);

/* The centroid of a group by the weights of the nodes, and its members as two sources of all its targets. As locate_jointly. */
enum mh_status mh_acoustic_weigh(const struct mh_acoustic_config *config, struct mh_acoustic_scene *scene,
                                 mh_real seconds, struct mh_acoustic_fix *fix);

extern const struct mh_acoustic_kind mh_acoustic_kind_gn, mh_acoustic_kind_dm, mh_acoustic_kind_ml;

/* The mirror image that the prediction is nearer to, if `fix` is one. */
void mh_acoustic_check_mirror(const struct mh_acoustic_config *config, const struct mh_acoustic_scene *scene,
                              struct mh_acoustic_fix *fix);

#endif
