/* The trackers of targets that are heard: `acoustic`, `dm` and `ml`. One instance follows one target, or one group of targets (group.h); several side by side follow
 * several, each told of the others (among()).
 *
 * - `acoustic`, the default: the median of triples of the strongest nodes, refined by Gauss-Newton on all that are near (mh_sound_fix); with others near, the joint
 *   solution for all of them (joint_sources.h).
 * - `dm`: distance measurement with the three strongest, from a table of a few intervals (Han 2.1).
 * - `ml`: maximum likelihood on a grid, all energies equally certain (Han, Eqs. (2-3), (2-4)). A baseline.
 *
 * Measurements are energies in units of the detection threshold (sound.h); those below 1 are left out, and when there is a track those of nodes farther than
 * reach_m from where it is expected, and from where the others are that it is fitted with. The strongest MH_ACOUSTIC_HEARD_MAX have room.
 *
 * A step: (1) with others within 120 m (`mode` SPARSE: from a gap of 100 m on until one of 120 m, distances of centroids less extents), their energies are told apart as
 * `separation` says; (2) a fix, from at least two nodes; (3) farther than 25 m from the prediction it may be a mirror image: the crossings of the circle pairs of the three strongest are
 * tried, and the one nearest to the prediction is taken (MH_ESTIMATE_MIRRORED) if it halves the distance and meets each circle within a quarter of the distance and 3 m
 * (not `acoustic` fitted jointly); (4) the filter takes it: a Kalman filter of constant velocity (q = acceleration_psd), or where `filtered` is false the fix itself
 * with the velocity between the last two. A fix outside the chi-square gate of 25 begins the track again there if nobody is near, with the velocity from the last fix; else
 * it is left out, GATE_PATIENCE times.
 *
 * What an estimate holds: `covariance` of position (4 states); `raw` the fix; velocity at most 30 m/s, zero where it is unknown: at the first fix, and below 1 m/s; `measurements` those used; `flags` STARTED, COASTED,
 * REFRESHED with every fix, MIRRORED, of groups MERGE (with `near`) and SPLIT, and
 * UNRESOLVED once two targets have been so near to each other that they may have exchanged their identifiers: from then on, for sound has no memory of who is who. `target`, `members`, `of`,
 * `extent` and `mode` as estimate.h says. A track without a fix for coast_s ends: step() gives MH_NONE, and the next one begins anew.
 *
 * Groups (config.group; group.h), `acoustic` only: a track that begins, with nobody near, where one source explains the energies badly begins as a group of as many as source_count.h finds, up to
 * MH_GROUP_MAX, with the identifiers target, target + 1, ...: whoever gives identifiers leaves these free. Two tracks that are to merge are not UNRESOLVED for it: what velocities say when they
 * part decides.
 *
 * A saved track (numbers as bytes.h puts them): kind and mode (1), the time (4), place in mm (4 + 4), velocity (2 + 2, in 1/256 m/s), the covariance's factors (10 x 2), the last three speeds (3), then the
 * group (group.h): 42 bytes for a single target, MH_ACOUSTIC_SAVED_MAX at most. The filter works with what was saved: a step of the instance that saved and of one that loaded are the same.
 *
 * Cost: docs/costs.md. */
#ifndef MOTEHOUND_ACOUSTIC_H
#define MOTEHOUND_ACOUSTIC_H

#include "motehound/circles.h"
#include "motehound/group.h"
#include "motehound/kalman.h"
#include "motehound/sound.h"
#include "motehound/tracker.h"

/* Measurements that a step works with: 12 bytes of stack each. */
#ifndef MH_ACOUSTIC_HEARD_MAX
#ifdef __AVR__
#define MH_ACOUSTIC_HEARD_MAX 12
#else
#define MH_ACOUSTIC_HEARD_MAX 48
#endif
#endif
#if MH_ACOUSTIC_HEARD_MAX < 3 || MH_ACOUSTIC_HEARD_MAX > 1000
#error "MH_ACOUSTIC_HEARD_MAX must be 3 to 1000: a place takes three, and the strongest are found by insertion"
#endif

/* Of a speed in a saved track, m/s. */
#define MH_ACOUSTIC_SPEED_UNIT 0.25f

/* Bytes of a saved track. */
#define MH_ACOUSTIC_HEADER_BYTES 40
#define MH_ACOUSTIC_SAVED_MAX (MH_ACOUSTIC_HEADER_BYTES + MH_GROUP_BYTES(MH_GROUP_MAX))

/* How the energy of several targets is told apart. */
enum mh_separation {
    MH_SEPARATION_NONE,          /* not at all */
    MH_SEPARATION_DECOMPOSITION, /* each node's energy times the target's share in it (decomposition.h) */
    MH_SEPARATION_JOINT          /* one fit for all (joint_sources.h); `acoustic` only */
};

/* All finite and in the range given, or init() fails. */
struct mh_acoustic_config {
    struct mh_sound sound;
    mh_real sensing_range_m;         /* R, 1 to 1e4, nominal 40 */
    mh_real reach_m;                 /* from how far a measurement is used, 1 to 1e5, nominal R + 15 */
    enum mh_circles_variant variant; /* of `dm`, nominal UNIFORM */
    uint8_t intervals;               /* of the table of `dm`, 0: undivided; nominal 8 */
    uint8_t strongest;               /* nodes that a fix is made from, the strongest: 2 to 255, nominal 255: all */
    enum mh_separation separation;   /* nominal JOINT; of `dm` and `ml` it must be another */
    mh_real share_range_m;           /* DECOMPOSITION: of mh_sound_share, 1 to 1e5, nominal 3 R; as published R */
    bool filtered;                   /* nominal true */
    bool mirror_check;               /* nominal true */
    mh_real acceleration_psd;        /* q, (m/s2)^2 s, 1e-6 to 1e6, nominal 0.5 */
    mh_real
        speed_mps; /* what a target's velocity may be in each axis when nothing is known of it, 0.1 to 1e3, nominal 10 */
    mh_real
        fix_sd_m; /* of a fix in each axis, where no Fisher information says it (`dm`, `ml`): 0.1 to 1e3, nominal 3 */
    mh_real coast_s;              /* 0.1 to 3600, nominal 10 */
    struct mh_group_config group; /* nominal NONE */
};

/* What is known of a target, or of a group's centroid: all that a saved track holds. */
struct mh_acoustic_track {
    struct mh_kalman filter; /* x, y, vx, vy, relative to the origin, at ... */
    struct mh_place origin;
    mh_tick updated;       /* ... the time of the last fix */
    struct mh_group group; /* which targets, at least one */
    uint8_t speeds[3];     /* between the last fixes, quarters of m/s, the newest first */
    uint8_t mode;          /* enum mh_target_mode */
    uint8_t refused;       /* fixes in a row outside the gate */
    bool moving;           /* there have been two fixes: the velocity means something */
};

struct mh_acoustic_kind;

/* The state, in the header so that it can be allocated statically; its members are the tracker's own. */
struct mh_acoustic {
    const struct mh_acoustic_kind *kind; /* which of the trackers */
    struct mh_acoustic_config config;
    struct mh_acoustic_track track;
    mh_tick time;           /* of the last step */
    bool stepped, tracking; /* `time` is set; there is a track */
    uint8_t others_count;
    struct mh_saved_track others[MH_TARGETS_MAX]; /* reckoned with in the next step */
};

extern const struct mh_tracker mh_tracker_acoustic, mh_tracker_dm, mh_tracker_ml;

/* The nominal values above, for a sensing range in m, tau 0.19 and eta 0.05. For `dm` and `ml` choose another separation. */
void mh_acoustic_config_default(struct mh_acoustic_config *config, mh_real sensing_range_m);

/* After init: go on with a track of `target` that was at `place` at `time`, with this velocity; standard deviations per axis of both, m and m/s. For a target whose
 * appearance is known, or announced. Errors: MH_ERR_ARGUMENT (a standard deviation not above 0, a place out of range), MH_ERR_NOT_FINITE. */
enum mh_status mh_acoustic_begin(struct mh_acoustic *acoustic, uint32_t target, mh_tick time,
                                 const struct mh_place *place, struct mh_vec2 velocity, mh_real position_sd_m,
                                 mh_real velocity_sd_mps);

/* The same of `count` targets, 2 to MH_GROUP_MAX, identified as target, target + 1, ..., at places[0 .. count): a group. Errors: and MH_ERR_CAPACITY. */
enum mh_status mh_acoustic_begin_group(struct mh_acoustic *acoustic, uint32_t target, mh_tick time,
                                       const struct mh_place *places, uint8_t count, struct mh_vec2 velocity,
                                       mh_real position_sd_m, mh_real velocity_sd_mps);

/* The largest speed between the last fixes, of at most three pairs, m/s; 0 where there is none. */
mh_real mh_acoustic_largest_speed(const struct mh_acoustic *acoustic);

/* What a saved track says, without an instance: where it is expected at `time`, at or after it. */
struct mh_acoustic_summary {
    struct mh_place place;
    struct mh_vec2 velocity; /* m/s, zero where unknown */
    mh_tick fixed;           /* the time of its last fix */
    mh_real largest_speed;   /* mh_acoustic_largest_speed */
    mh_real extent;          /* of a group */
    uint8_t members;
};
/* Errors: MH_ERR_CORRUPT. */
enum mh_status mh_acoustic_look(uint32_t target, const uint8_t *bytes, size_t length, mh_tick time,
                                struct mh_acoustic_summary *summary);

#endif
