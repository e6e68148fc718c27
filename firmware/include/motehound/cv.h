/* The trackers `cv_ukf` and `cv_ekf`: one target at nearly constant velocity in the plane, measured by ranges that come at different rates, late, or out of
 * order; for the heads of clusters whose tracks a fusion centre joins (centre.h), or for one head that hears all.
 *
 * - State (x, vx, y, vy), relative to config.origin. At config.start it is config.mean with config.covariance; heads and centre all know that.
 * - Motion: white_acceleration.h, from one instant with samples to the next.
 * - All samples of one instant go into one update, MH_STACKED_MAX at most at once, at the state predicted to when they were taken: `cv_ukf` with sigma points drawn
 *   anew (Xu, Eqs. (17)-(28)), `cv_ekf` with all gradients at the predicted state.
 * - Reordering: a sample may come up to config.lag after the last step. Those not older than that are kept (MH_CV_SAMPLES_MAX), and the state before them; if one comes
 *   late, what is kept is filtered anew, in the order of time, node and target: the same operations as if it had come in time, so the same result to the last bit.
 *   Where there is no room for more the oldest instant is settled early, and counted. Refused and counted are: samples at or before what is settled; a second one of its
 *   node, target and time; those from after the step; all of an instant whose update fails, which leaves the state as predicted.
 *
 * There is a track from the first step on (STARTED), and it does not end: without samples it is predicted. predict() and summarise() answer for any time at or after the last
 * step. An estimate states the covariance of all four states; `raw` and `stored` equal position; `measurements` is how many of the step's samples were
 * taken, late ones included; COASTED if none. interest(), restart() and score() do not exist.
 *
 * save() keeps the track, not the samples to be reordered: MH_CV_SAVED bytes. After load() nothing from before is taken any more; it all counts as shared (SPLIT), and as known to the
 * centre (INCREMENT).
 *
 * Summaries (summary.h), by config.summary:
 * - PLAIN: the track predicted to the time.
 * - SPLIT: P = Pd + Pi. Pd, what comes from the prior and the process noise, which other heads share, begins as the start covariance and follows
 *   Pd <- A (F Pd F' + Q) A', A = I - K H, of the UKF with H = Pxz' P^-1; Pi = P - Pd comes from the noise of the own samples.
 * - INCREMENT: what the track knows more than its reference, predicted to the same time. The reference is at first the start, and then the track as it was told in the last
 *   summary of which summary_taken() says that the centre has it. A head that begins after config.start says so by `since`.
 *
 * correct() takes a PLAIN or FUSED summary of `time`, which replaces the state then; samples from after `time` are filtered anew on it. If the last summary, of that time, is not
 * known to be taken, what it told is added first. MH_ERR_TIME: a sample from after `time` is settled already (config.lag must be longer than the feedback takes), or the
 * centre is said not to have the last summary and that was of another time.
 *
 * Cost of a step: a prediction and an update for each instant that is new; for all kept ones if a sample came late (docs/costs.md). */
#ifndef MOTEHOUND_CV_H
#define MOTEHOUND_CV_H

#if MH_REAL_FIXED
#error "motehound/cv.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/gaussian.h"
#include "motehound/summary.h"
#include "motehound/tracker.h"
#include "motehound/white_acceleration.h"

#define MH_CV_STATES MH_SUMMARY_STATES
#define MH_CV_SAVED 60 /* bytes of a saved track: time, mean, covariance */

/* Samples that are kept to be reordered, 32 bytes each. */
#ifndef MH_CV_SAMPLES_MAX
#ifdef __AVR__
#define MH_CV_SAMPLES_MAX 8
#else
#define MH_CV_SAMPLES_MAX 64
#endif
#endif
#if MH_CV_SAMPLES_MAX < 4 || MH_CV_SAMPLES_MAX > 4096
#error "MH_CV_SAMPLES_MAX must be 4 to 4096: a position takes a few ranges, and the table is searched linearly"
#endif

/* Summaries, with INCREMENT, of which it is not known whether the centre has them: the track of each is kept, 64 bytes and more with MH_STATES_MAX above 4. Where the centre
 * is said to have one that is not kept any more, the newest stands for it: what these have told is left out, rather than counted twice. */
#ifndef MH_CV_TOLD_MAX
#ifdef __AVR__
#define MH_CV_TOLD_MAX 2
#else
#define MH_CV_TOLD_MAX 4
#endif
#endif
#if MH_CV_TOLD_MAX < 1 || MH_CV_TOLD_MAX > 100
#error "MH_CV_TOLD_MAX must be 1 to 100"
#endif

/* A node whose ranges are not as noisy as the others'. */
struct mh_cv_noise {
    mh_node_id node;
    mh_real variance; /* m2, >= 1e-8 */
};

struct mh_cv_config {
    struct mh_place origin;                           /* of all states; its z is the target's height */
    mh_tick start;                                    /* the time of ... */
    mh_real mean[MH_CV_STATES];                       /* ... the first state: m, m/s ... */
    mh_real covariance[MH_PACKED_SIZE(MH_CV_STATES)]; /* ... packed, positive definite */
    struct mh_white_acceleration motion;              /* tick 1 to 3,600,000. Nominal 500, (5e-5, 1e-4) */
    mh_real variance;                                 /* of a range, m2, >= 1e-8. Nominal 0.02 */
    const struct mh_cv_noise *noise;                  /* of nodes with another; outlives the state */
    uint16_t noise_count;                             /* 0 without */
    mh_tick lag;                                      /* 0 to 3,600,000. Nominal 2,000 */
    mh_real alpha, beta, kappa;                       /* of cv_ukf (ukf.h), alpha >= 0.1. Nominal 1, 2, 0 */
    enum mh_summary_kind summary;                     /* PLAIN, SPLIT or INCREMENT. Nominal PLAIN */
};

/* Of samples, but for the last three. */
struct mh_cv_counters {
    uint32_t taken;
    uint32_t reordered; /* of these: later ones, or others of their instant, had been filtered before */
    uint32_t late;      /* refused: at or before what is settled */
    uint32_t early;     /* refused: from after the step */
    uint32_t repeated;  /* refused */
    uint32_t failed;    /* their update was not possible */
    uint32_t hurried;   /* settled early for want of room */
    uint32_t corrected; /* times that the track was corrected ... */
    uint32_t refused;   /* ... or should have been, and was not */
    uint32_t left_out;  /* times that what a summary had told was left out of all increments: see MH_CV_TOLD_MAX */
};

/* A track at a time. */
struct mh_cv_track {
    mh_tick time;
    struct mh_gaussian state;
    mh_real shared[MH_PACKED_SIZE(MH_CV_STATES)]; /* Pd, with SPLIT */
};

struct mh_cv_sample {
    mh_node_id node;
    mh_tick time;
    struct mh_vec2 at; /* of the node, relative to the origin */
    mh_real rise;      /* of the target above it, m */
    mh_real range;     /* m */
    mh_real variance;  /* m2 */
    uint8_t target;
};

/* The state, in the header so that it can be allocated statically; its members are the tracker's own. */
struct mh_cv {
    struct mh_cv_config config;
    mh_tick interval;
    mh_tick time;                                   /* of the last step */
    bool stepped;                                   /* `time` is set */
    mh_tick horizon;                                /* samples at or before it are too late */
    struct mh_cv_track settled;                     /* before all kept samples */
    struct mh_cv_track latest;                      /* after the first `filtered` of the kept samples */
    struct mh_cv_sample samples[MH_CV_SAMPLES_MAX]; /* by time, node and target */
    uint16_t count, filtered;
    /* with INCREMENT: the reference, as it was at a time, and the name under which the centre knows it; the track as it was told in the last summaries, oldest first,
     * of which it is not known whether the centre has them */
    struct mh_gaussian reference;
    mh_tick reference_time, since;
    struct mh_cv_told {
        mh_tick time;
        struct mh_gaussian state;
    } told[MH_CV_TOLD_MAX];
    uint8_t told_count;
    struct mh_cv_counters counters;
};

extern const struct mh_tracker mh_tracker_cv_ukf, mh_tracker_cv_ekf;

/* Xu's target and first cluster: from (10, 0.8, 20, 0.6) with variances (1, 0.04, 1, 0.04) at time 0, origin (0, 0, 0), and the nominal values above. */
void mh_cv_config_default(struct mh_cv_config *config);

#endif
