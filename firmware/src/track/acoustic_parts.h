/* The parts of the acoustic trackers. */
#ifndef MOTEHOUND_ACOUSTIC_PARTS_H
#define MOTEHOUND_ACOUSTIC_PARTS_H

#include "motehound/acoustic.h"
#include "motehound/sound_fix.h"

/* ---- acoustic.c: what all of them do, as struct mh_tracker says ---- */

struct mh_acoustic_kind;

enum mh_status mh_acoustic_init(void *state, const struct mh_acoustic_kind *kind, const void *given, mh_tick interval);
enum mh_status mh_acoustic_step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                                struct mh_estimate *estimate);
enum mh_status mh_acoustic_predict(const void *state, mh_tick time, struct mh_estimate *estimate);
enum mh_status mh_acoustic_save(const void *state, uint8_t *bytes, size_t *length);
enum mh_status mh_acoustic_load(void *state, const uint8_t *bytes, size_t length);
void mh_acoustic_restart(void *state);
enum mh_status mh_acoustic_among(void *state, uint32_t target, const struct mh_saved_track *others, size_t count);

/* Of a struct mh_tracker all but its name, init, join and part. */
#define MH_ACOUSTIC_TRACKER                                                                                            \
    .state_size = sizeof(struct mh_acoustic), .config_size = sizeof(struct mh_acoustic_config),                        \
    .step = mh_acoustic_step, .predict = mh_acoustic_predict, .save = mh_acoustic_save, .load = mh_acoustic_load,      \
    .restart = mh_acoustic_restart, .among = mh_acoustic_among

/* Position and velocity of a track with their covariances: of each, and of both, which is so many times that of the position. As mh_kalman_init. */
enum mh_status mh_acoustic_set(struct mh_acoustic_track *track, struct mh_vec2 position,
                               const struct mh_sym2 *covariance, struct mh_vec2 velocity,
                               const struct mh_sym2 *velocities, mh_real both);

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
#define MH_ACOUSTIC_FASTEST_MPS MH_REAL(30.0f)
#define MH_ACOUSTIC_SLOWEST_MPS MH_REAL(1.0f)
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
    struct mh_sym2 covariance;    /* of its position, as predicted */
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
#define MH_ACOUSTIC_DISTINCT_M MH_REAL(14.0f)
uint16_t mh_acoustic_exchanged(const struct mh_acoustic_scene *scene, mh_real seconds, mh_real sds);

/* ---- a kind: where a target is at one instant. acoustic_gn.c, acoustic_dm.c, acoustic_ml.c ---- */

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

/* A group takes a fit of several sources. */
static inline bool mh_acoustic_follows_groups(const struct mh_acoustic *acoustic)
{
    return acoustic->kind->locate_jointly != NULL;
}

/* ---- acoustic_fix.c: what they have in common ---- */

/* How many of `count` nodes make a fix: config.strongest, or if that is 0 `nominal`. */
size_t mh_acoustic_strongest(const struct mh_acoustic_config *config, size_t count, size_t nominal);

/* The fix has config.fix_sd_m in each axis. */
void mh_acoustic_state_nominal(const struct mh_acoustic_config *config, struct mh_acoustic_fix *fix);

/* The mirror image that the prediction is nearer to, if `fix` is one. */
void mh_acoustic_check_mirror(const struct mh_acoustic_config *config, const struct mh_acoustic_scene *scene,
                              struct mh_acoustic_fix *fix);

/* The fix's distance from where the own track is expected, chi-square. Before the fix goes into it. */
mh_real mh_acoustic_surprise(const struct mh_acoustic_scene *scene, const struct mh_acoustic_fix *fix);
#define MH_ACOUSTIC_GATE MH_REAL(25.0f)

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

#endif
