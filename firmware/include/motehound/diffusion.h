/* The tracker `diffusion`: a sliding window of the source's path, fitted to the increments with the exact line-source model.
 *
 * Luo's increments, Eq. (8), hold the newest release and the spreading of all the older. Taking them for the newest alone (Luo, Theorem 3) puts the
 * answer metres behind the source. Here the last few positions are estimated together with the release rate, while the path before stays as a
 * trail whose share of every increment is known: trail_fit.h says how. Around the fit: which measurements to use, where to begin, when to
 * doubt the track and begin again, how far to go on without measurements.
 *
 * It wants increments from every node near the source, silent ones too: their silence says where the source is not. interest() names them;
 * its radius follows the density of the answers so that about 1.25 MH_DIFFUSION_NEAR answer.
 *
 * Instants without measurements near the source, and instants that the caller left out, are real time alike: the answer is dead reckoning from the
 * last fit, its covariance grows by an independent turn an interval. When measurements come back the gap becomes one straight segment of the path, and
 * the fit goes on. The track ends after MH_DIFFUSION_COAST intervals without measurements or without a significant increment near it, and after
 * MH_DIFFUSION_SILENCE instants in succession without a significant increment anywhere; the next detection starts a new one. It begins again
 * (MH_ESTIMATE_STARTED) where the increments crowd, when the fit has failed to explain them for three instants, when they have crowded elsewhere four times
 * in succession, or when none near the track has been significant for MH_DIFFUSION_SILENCE instants.
 *
 * The release rate may change along the path, as fast as it has been seen to change lately.
 *
 * The covariance is that of the fit times the mean square of its own residuals: the noise assumed below is generous, which the fit needs, and the
 * covariance would be too large by that. Residuals beyond that noise come from failing sensors or a wrong model and do not average out: they count
 * fourfold, and the covariance then also spans the way to where the increments crowd. From the second instant in succession without a significant increment
 * near the source on, it also grows as if the source had left. A fit that fails, which needs numbers near the ends of float, ends the track. */
#ifndef MOTEHOUND_DIFFUSION_H
#define MOTEHOUND_DIFFUSION_H

#if MH_REAL_FIXED
#error "motehound/diffusion.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/tracker.h"
#include "motehound/trail_fit.h"

/* All finite and in the range given, or init() fails. */
struct mh_diffusion_config {
    mh_real diffusion_m2ps;  /* D, 1e-4 to 1e3; nominal 1 */
    mh_real chi;             /* significant concentration, g/m2, 1e-3 to 1e3; nominal 0.2 */
    mh_real release_gps;     /* expected release rate, 1e-3 to 1e5, right to a factor of 20; nominal 100 */
    mh_real release_drift;   /* sd of its relative change in an interval at least, 1e-3 to 1; nominal 0.05 */
    mh_real additive_sd;     /* of a reading, g/m2, 1e-3 to 1e3; nominal 0.05, deliberately generous */
    mh_real relative_sd;     /* of a reading, as a share of it, 0 to 1; nominal 0.05, deliberately generous */
    mh_real turn_mps2;       /* sd of the acceleration, 1e-3 to 1e2; nominal 0.35. Sharper turns count as outliers */
    mh_real speed_mps;       /* sd of the velocity at the start, 1e-2 to 1e3; nominal 3 */
    mh_real reach_m;         /* how far off an increment tells of the newest release, 0.1 to 1e3; nominal 8 */
    struct mh_region region; /* the source stays within; nominal: unbounded (+- 1e9 mm) */
};

struct mh_diffusion {
    struct mh_diffusion_config config;
    struct mh_trail_fit fit;
    struct mh_place origin;   /* of all metres */
    mh_tick time;             /* of the last step */
    bool stepped;             /* time is valid */
    bool tracking;            /* fit holds a solution */
    int since;                /* instants since the (re)start or the last gap */
    int silent;               /* instants in succession without a significant increment */
    int unanswered;           /* instants in succession without one near the source */
    int doubtful;             /* instants in succession with a bad fit */
    int astray;               /* instants in succession with the cluster of increments elsewhere */
    struct mh_vec2 cluster;   /* where the significant increments crowded last */
    struct mh_sym2 ambiguity; /* covariance of the doubt between the fit and the cluster, m2 */
    mh_real rate_change2;     /* mean square of the change of ln(rate) in an interval lately */
    mh_real usual_misfit;     /* slow mean of the cost per row */
    mh_real level;            /* mean square of the standardised residuals lately */
    mh_real density;          /* of nodes that answer, 1/m2; 0: not known */
    struct mh_vec2 asked;     /* centre of the interest */
    mh_real asked_radius;
    uint16_t used; /* measurements of the last instant that the fit uses */
};

/* state_size is sizeof(struct mh_diffusion). step() costs at most 4 solutions of trail_fit.h, typically one of 4 evaluations. */
extern const struct mh_tracker mh_tracker_diffusion;

void mh_diffusion_config_default(struct mh_diffusion_config *config);

#endif
