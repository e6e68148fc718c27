/* The tracker `pftl`: the particle filter of Zhou et al., "Moving target localization and tracking algorithms: a particle filter based method",
 * Journal of Software 24(9), 2013.
 *
 * Measurements are ranges in m, horizontal distances with Gaussian noise; they may be negative near a node. Nothing of an instant's particles is
 * kept: what is stored of the track is the last reported position and the velocity from the report before (the paper's buffer of two fixes),
 * which whoever follows the track knows too (followed.h). With T the interval, v and P the stored velocity and the position expected now:
 *
 * Region. The target's class gives its least and largest speed, mean -+ three standard deviations. Particles are uniform in the sector of a ring
 * about P - v T, from the one to the other speed times T, within 60 degrees of v: Eq. (13). It is wider by one standard deviation of the stored
 * position, sd sqrt(2 / n) for n ranges. After a first report it is a disc about P.
 * Widening. If no particle fits the ranges (sum of squared residuals above sd^2 (n + sqrt(2 n)), and what the density of the particles makes of
 * it), the region is drawn anew, wider by max(tolerance, half the largest speed x T) in both radii and by the first angle, up to four times; at
 * last it is the disc of the sensing range about the centroid of the nodes, which holds the target for sure.
 * Weights. Likelihood of the ranges. At an effective number of at most N / 2, partial rejection control with the region as
 * proposal, or systematic resampling. The position is the weighted mean.
 * Storing. If the position is farther than the tolerance from P, or P has no velocity yet, it is reported and stored, the velocity is that from the
 * report before, at most the largest speed; otherwise P is stored.
 *
 * The first step with a measurement takes the centroid of the nodes. Without a measurement the track coasts along P, as long as it is stepped.
 * restart(): the next step with a measurement uses the last region at once and begins the buffer anew.
 * Ranges that nothing within the sensing range can give (6 standard deviations beyond it, or below 0) are left out.
 *
 * What an estimate holds: `position` as localised; `velocity` and `stored_velocity` the stored one, after this step; `stored` what those who follow have at
 * `time`; `covariance` that of the particles, of the first position that of a centroid, all zero when coasting; `raw` equals
 * position; `age` 0; `measurements` the ranges used; `flags` STARTED, COASTED, REFRESHED. `origin` is the first node's place, its z 0; mh_real
 * resolves 1 mm 10 km from it. step() gives MH_NONE until the first measurement. interest() does not exist. save() writes 20 bytes, 12 after a first report.
 *
 * The covariance knows nothing of how wrong the region may be: the squared error over it averages 0.2 (sharp ranges) to 4.5 (slow targets) where 2 is
 * right.
 *
 * Cost: on average some four draws a particle, each of n roots and 7 n operations; at most MH_PFTL_DRAWS_MAX. 12 bytes a particle, in fixed point 8. See docs/costs.md.
 *
 * Scaling and overflow (fixed point). Particles are held as particles.h says, in units of which `extent`, the farthest that a widened region reaches from its apex and a node
 * from there, is at most 2^14: by the nominal values 202 m, 1/64 m. init() gives MH_ERR_ARGUMENT for a range_sd_m below 4 of these units (nominal: 0.063), for an extent above
 * 16 km and for a sensing_range_m above 300, whose covariance would be no number. Positions and velocities have 16 fractional bits; a step whose expected position or mean is
 * more than 32.7 km from the origin in x or y gives MH_ERR_NOT_FINITE, the track and the estimate as they were. Sums of squared residuals saturate, so that a particle that is very wrong
 * is very wrong still. So does a velocity, component by component, before it is limited to the largest speed: if the target seems to have gone faster than 32.7 km/s, as it can only within a fraction
 * of a second, the direction is that of the saturated components, up to 45 degrees off, and the speed up to 1.41 times the largest. The arithmetic's errors, a unit in a distance and 1.5e-3 in a weight, are below a hundredth of what the noise of the ranges and the density of the particles
 * do (docs/fixed_point.md). */
#ifndef MOTEHOUND_PFTL_H
#define MOTEHOUND_PFTL_H

#include "motehound/followed.h"
#include "motehound/particles.h"
#include "motehound/tracker.h"

#if MH_REAL_FIXED
#define MH_PFTL_RANGE_MAX MH_REAL(300.0f)
#define MH_PFTL_SD_MAX MH_REAL(181.0f) /* whose square is a number */
#else
#define MH_PFTL_RANGE_MAX 1e4f
#define MH_PFTL_SD_MAX 1e3f
#endif

struct mh_pftl_config {
    mh_real speed_mps;       /* mean speed of the target's class, 1e-3 to 1e3; nominal 4.4704 (10 mph) */
    mh_real speed_sd_mps;    /* its standard deviation, 0 to 1e3; nominal a fifth of that */
    mh_real sensing_range_m; /* how far a node measures, 1e-2 to MH_PFTL_RANGE_MAX; nominal 50 */
    mh_real range_sd_m;      /* standard deviation of a range, 1e-3 to MH_PFTL_SD_MAX; nominal 5 */
    mh_real tolerance_m;     /* 0 (every position is reported) to 1e4; nominal 5 */
    uint16_t particles;      /* N, 1 to MH_PARTICLES_MAX; nominal 50 */
    uint32_t seed;           /* of the random numbers; nominal 1 */

    /* Widen as the paper says: until the effective number exceeds N / 2, whether or not a particle fits. Nominal false: the sharp
     * likelihood of exact ranges never gives that, and a region that misses the target does. */
    bool literal;
    bool systematic; /* resample instead of rejection control; nominal false */
};

/* The state, in the header so that it can be allocated statically; its members are the tracker's own, but `draws` may be read. */
struct mh_pftl {
    struct mh_pftl_config config;
    mh_real interval_s;
    struct mh_random random;
    uint32_t draws; /* particles drawn since init: what the work goes with */
    mh_tick time;   /* of the last step */
    bool stepped;   /* `time` is set */
    bool restarted; /* the next position begins the buffer anew */
    bool moving;    /* the buffer has two fixes: the stored velocity is one */
    struct mh_place origin;
    struct mh_followed buffer;
    struct mh_particles particles;
};

/* A step draws at most so many times N particles: six regions, and the redraws of rejection control in the last. */
#define MH_PFTL_DRAWS_MAX (6 + MH_PARTICLES_REDRAWS)

extern const struct mh_tracker mh_tracker_pftl;

void mh_pftl_config_default(struct mh_pftl_config *config);

#endif
