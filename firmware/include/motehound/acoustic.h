/* The trackers of targets that are heard: `acoustic`, `dm` and `ml`. One instance follows one target, or one group of targets (group.h); several side by side follow
 * several, each told of the others (among()). The measurements are energies in units of the detection threshold (sound.h); those below 1 are left out.
 *
 * - `acoustic`, the default: the median of triples of the strongest nodes, refined by Gauss-Newton (mh_sound_fix).
 * - `dm`: distance measurement with the three strongest, by a table of a few intervals (Han 2.1); where more are wanted (`strongest`) the median of triples.
 * - `ml`: maximum likelihood on a grid, all energies equally certain (Han, Eqs. (2-3), (2-4)). A baseline.
 *
 * A step, for a sensing range R:
 * 1. Who is near: tracks with less than 3.5 R between them, centroids less extents, and who is near to those. `mode` is SPARSE from a gap of 2.5 R on until there are 3 R.
 * 2. What is of use. Nobody is near: what is heard within reach_m + R / 2 of the loudest node, for a target that has turned is not where it is expected; but nothing that is nearer to another
 *    track. Else what is heard within reach_m of where it is expected, or with JOINT of where one of them is; with DECOMPOSITION times the own share, where that leaves
 *    0.6. Without a track: where separation is not NONE, what the others do not explain of energies that are more than one and a half times as large as they do.
 *    The MH_ACOUSTIC_HEARD_MAX strongest have room.
 * 3. A fix. With JOINT and somebody near, or of a group, joint_sources.h with the predictions of all as priors, none taken for surer than 1.5 m; MH_SOURCES_MAX at most, the nearest.
 *    Else by the tracker's own method from at least two nodes.
 * 4. Mirror check, unless JOINT. Farther than 25 m from where it was expected: of the crossings of the circle pairs of the three strongest the one nearest to that, if
 *    it at least halves the distance and meets every circle within a quarter of its radius and 3 m. And `acoustic` outside the gate (5.): Gauss-Newton from where it was expected instead, if that
 *    explains energies and prediction better. Either is MH_ESTIMATE_MIRRORED.
 * 5. The filter: of Kalman, constant velocity with white acceleration, the fix with its Fisher information's covariance and 0.25 m2. A fix that is farther off than a chi-square of
 *    25 is a turn: the track goes on from it with the velocity between it and the last; but with somebody near the first two of them are left out. Where `filtered` is false it goes on
 *    so from every fix.
 *
 * What an estimate holds: `covariance` of position and velocity (4 states); `raw` the fix; velocity at most 30 m/s between fixes, zero where it is unknown: at the first, and below 1 m/s;
 * `measurements` those used; `flags` STARTED, COASTED, REFRESHED with every fix, MIRRORED; MERGE (with `near`) and SPLIT of groups; and UNRESOLVED
 * once the target may have exchanged its identifier with another: if they were expected to come, or found to have come, within 14 m of each other, at an instant or between two, or were found within two and a half
 * standard deviations of their distance. It stays so: two that meet and part again sound the same whether they crossed or turned back, and nothing that comes later tells. `target`, `members`, `of`, `extent` and `mode` as estimate.h
 * says. After coast_s without a fix the track ends: MH_NONE, and the next step begins anew.
 *
 * A saved track (numbers as bytes.h puts them): 5 << 5, 16 if there have been two fixes, 4 x fixes left out, mode (1); time of the last fix (4); place in mm (4 + 4); velocity in 1/256 m/s (2 + 2); the
 * covariance's factors U and D (kalman.h), the upper halves of the numbers (10 x 2); the last three speeds in 1/4 m/s (3); the group (group.h). Of a single target 42 bytes, 46 while it draws near
 * to another; MH_ACOUSTIC_SAVED_MAX at most.
 *
 * Groups (config.group; group.h), `acoustic` only: a track that begins, with nobody near, where one source explains the energies badly begins as a group of as few as explain them, no more than
 * source_count.h finds and MH_GROUP_MAX, with the identifiers target, target + 1, ...: whoever gives identifiers leaves these free. Two tracks that are to merge are not UNRESOLVED for it: what velocities say when they
 * part decides.
 *
 * Scaling and overflow (fixed point, MH_REAL=fixed: `dm` only). Positions, velocities, covariances and energies have 16 fractional bits; squares of lengths and products of variances are 64 bits wide, sums saturate;
 * the filter's formats, with 2 guard bits and more, are kalman.h's, the fix's sound_fix.h's. Good for nodes and a target within 10 km of where the track began or was handed over (beyond, a step finds nothing
 * and the track coasts until it ends), for a sensing range to MH_DISTANCE_FIX_RANGE_MAX, for variances to 32,767 (181 m): a larger one refuses the fix or ends the track. reach_m, share_range_m and
 * acceleration_psd end at 32,767; acceleration_psd is a multiple of 1.5e-5, mh_acoustic_begin() takes standard deviations from 0.004 to 181 (others: MH_ERR_SINGULAR, MH_ERR_NOT_FINITE). A track saved by a head in
 * float is taken if its variances are within that. Error analysis: docs/fixed_point.md.
 *
 * load(): MH_ERR_CORRUPT also of a group where the tracker is `dm` or `ml`. among(): others beyond MH_TARGETS_MAX are not reckoned with; so give the nearest. MH_ERR_ARGUMENT: a group is not renamed. Cost: docs/costs.md. */
#ifndef MOTEHOUND_ACOUSTIC_H
#define MOTEHOUND_ACOUSTIC_H

#include "motehound/circles.h"
#include "motehound/distance_table.h"
#include "motehound/group.h"
#include "motehound/kalman.h"
#include "motehound/sound.h"
#include "motehound/sound_fix.h"
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

/* Units of a speed in a saved track, in 1 m/s. */
#define MH_ACOUSTIC_SPEEDS_A_MPS 4

/* Bytes of a saved track. */
#define MH_ACOUSTIC_HEADER_BYTES 40
#define MH_ACOUSTIC_SAVED_MAX (MH_ACOUSTIC_HEADER_BYTES + MH_GROUP_BYTES(MH_GROUP_MAX))
#if MH_ACOUSTIC_SAVED_MAX > MH_TRACK_BYTES_MAX
#error                                                                                                                 \
    "MH_TRACK_BYTES_MAX must be 46 at least, with groups of n targets 43 + 12 n: a saved track has to have room in it"
#endif

/* How the energy of several targets is told apart. */
enum mh_separation {
    MH_SEPARATION_NONE,          /* not at all */
    MH_SEPARATION_DECOMPOSITION, /* each node's energy times the target's share in it (decomposition.h) */
    MH_SEPARATION_JOINT          /* one fit for all (joint_sources.h); `acoustic` only */
};

/* All finite and in the range given, or init() fails. */
struct mh_acoustic_config {
    struct mh_sound sound;
    mh_real sensing_range_m;         /* R, 1 to MH_DISTANCE_FIX_RANGE_MAX (1e4), nominal 40 */
    mh_real reach_m;                 /* from how far a measurement is used, 1 to 1e5, nominal R + 15 */
    enum mh_circles_variant variant; /* of `dm`, nominal UNIFORM */
    uint8_t intervals;               /* of the table of `dm`, 0: undivided; nominal 8, ... */
    enum mh_distance_mode distances; /* ... and what it says of each; nominal MIDDLE */
    uint8_t strongest; /* so many nodes make a fix, the strongest: 2 to 255; nominal 0: all, of `dm` three */
    enum mh_separation separation; /* nominal JOINT; of `dm` and `ml` it must be another */
    mh_real share_range_m;         /* DECOMPOSITION: of mh_sound_share, 1 to 1e5, nominal 3 R; as published R */
    bool filtered;                 /* nominal true */
    bool mirror_check;             /* nominal true */
    mh_real acceleration_psd;      /* q, (m/s2)^2 s, 1e-6 to 1e6, nominal 0.5 */
    mh_real
        speed_mps; /* what a target's velocity may be in each axis when nothing is known of it, 0.1 to MH_ACOUSTIC_SD_MAX, nominal 10 */
    mh_real
        fix_sd_m; /* of a fix in each axis, where no Fisher information says it (`dm`, `ml`): 0.1 to MH_ACOUSTIC_SD_MAX, nominal 3 */
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

/* The largest standard deviation of the configuration, m or m/s: its square is a variance. */
#if MH_REAL_FIXED
#define MH_ACOUSTIC_SD_MAX MH_REAL(181.0f)
#else
#define MH_ACOUSTIC_SD_MAX 1e3f
#endif

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

/* The same of `count` targets, 2 to MH_GROUP_MAX, identified as target, target + 1, ..., at places[0 .. count): a group. Errors: and MH_ERR_CAPACITY; MH_ERR_ARGUMENT also of
 * `dm` and `ml`, which follow none. */
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
