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
 * Instants without measurements, and instants that the caller left out, are real time alike: the fit goes on by dead reckoning with a covariance
 * that grows. After MH_DIFFUSION_SILENCE instants without a significant increment the track ends; the next detection starts a new one.
 *
 * The covariance is that of the fit times the level of its own residuals, averaged over some ten instants: the noise assumed below is
 * generous, which the fit needs, and the covariance would be too large by that. */
#ifndef MOTEHOUND_DIFFUSION_H
#define MOTEHOUND_DIFFUSION_H

#include "motehound/tracker.h"
#include "motehound/trail_fit.h"

struct mh_diffusion_config {
    mh_real diffusion_m2ps; /* D, 1e-4 to 1e3; nominal 1 */
    mh_real chi;            /* significant concentration, g/m2, 1e-3 to 1e3; nominal 0.2 */
    mh_real
        release_gps; /* expected release rate, 1e-3 to 1e5; nominal 100 (known to within a factor of about e, bounded to a factor of 20) */
    mh_real additive_sd; /* of a reading, g/m2, 1e-3 to 1e3; nominal 0.05, deliberately generous */
    mh_real relative_sd; /* of a reading, as a share of it, 0 to 1; nominal 0.05, deliberately generous */
    mh_real
        turn_mps2; /* sd of the source's acceleration, 1e-3 to 1e2; nominal 0.35. Sharper turns are taken as outliers */
    mh_real speed_mps;       /* sd of its velocity at the start, 1e-2 to 1e3; nominal 3 */
    mh_real reach_m;         /* how far from the source an increment still tells something, 0.1 to 1e3; nominal 8 */
    struct mh_region region; /* the source stays within; nominal: unbounded (+- 1e9 mm) */
};

struct mh_diffusion {
    struct mh_diffusion_config config;
    struct mh_trail_fit fit;
    struct mh_place origin; /* of all metres */
    mh_tick time;           /* of the last step */
    bool stepped;           /* time is valid */
    bool tracking;          /* fit holds a solution */
    int since;              /* instants since the (re)start */
    int silent;             /* instants in succession without a significant increment */
    int doubtful, astray;   /* instants in succession with a bad fit; with the cluster of increments elsewhere */
    mh_real level;          /* mean square of the standardised residuals */
    mh_real density;        /* of nodes that answer, 1/m2; 0: not known */
    struct mh_vec2 asked;   /* centre and radius of the interest */
    mh_real asked_radius;
    uint16_t used; /* measurements of the last instant that the fit uses */
};

/* state_size is sizeof(struct mh_diffusion). step() costs at most 3 solutions of trail_fit.h, typically one of 4 evaluations. */
extern const struct mh_tracker mh_tracker_diffusion;

void mh_diffusion_config_default(struct mh_diffusion_config *config);

#endif
