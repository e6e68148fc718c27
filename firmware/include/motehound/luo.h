/* The tracker `luo`: Algorithm 1 of Luo, Chai and Yang, "Mobile diffusion source tracking in wireless sensor networks".
 *
 * One pre-estimate of position and arrival time a sampling instant by bound-constrained least squares, Eq. (10), or optionally by
 * the nonlinear problem (9), then a Sage-Husa filter on the sequence of positions (Appendix 2).
 *
 * Measurements are concentrations. Until the first position every node with a value above chi takes part, afterwards every node with
 * an increment, Eq. (13), of at least chi; a measurement without MH_MEASUREMENT_HAS_INCREMENT then has no part. step() gives
 * MH_NONE where fewer than MH_PUFF_SAMPLES_MIN take part, where their nodes lie on one line, and after the end.
 *
 * What an estimate holds: `raw` the pre-estimate, `age` the time from the arrival at the position (tau) to `time`, `position` the
 * filtered position, `velocity` the last one known, `flags` STARTED, FILTERED, AGE_LOW and AGE_HIGH. `covariance` is all zero: the
 * filter's variance holds neither the error of the velocity nor the lag of the method, which is most of the error. `origin` is the
 * node with the largest concentration at the first position, for the whole track; mh_real resolves 1 mm 10 km from it.
 * predict() moves the position on with the velocity, from tau, Eq. (11). interest() does not exist: the method never asks.
 *
 * Scaling and overflow. A step whose numbers have no room gives MH_ERR_RANGE or MH_ERR_NOT_FINITE and leaves the state as it was, its time included. In
 * float that takes a velocity beyond 3e38 m/s. In fixed point the room is: nodes at most 256 m from the one with the largest concentration (puff_fit.h),
 * positions at most 8,000 m from `origin`, velocities below 32,767 m/s, sensor readings that are not saturated; a step of the filter
 * that sage_husa.h refuses, such as a jump of more than 181 m, is left out as after any wild pre-estimate. Times since the last position count as 16,383 s at most.
 * All numbers are mh_real (Q15.16: 0.015 mm, 0.015 ms) but weights, gains, the factor of the least squares and
 * concentrations, which keep more. predict() gives MH_ERR_RANGE where the position has no room. `nonlinear` needs float. */
#ifndef MOTEHOUND_LUO_H
#define MOTEHOUND_LUO_H

#include "motehound/sage_husa.h"
#include "motehound/tracker.h"

struct mh_luo_config {
    mh_real diffusion_m2ps;            /* D, 1e-6 to 1e3 (fixed point: 0.01 to 500); nominal 1 */
    mh_real chi;                       /* selection threshold on concentration, g/m2, 0 to 2000; nominal 0.2 */
    mh_real forgetting;                /* b of the Sage-Husa weight, 0 < b < 1; nominal 0.97 */
    struct mh_sage_husa_config filter; /* start values and floors, m2; nominal: mh_sage_husa_config_default */

    /* Solve Eq. (9), once from the answer of (10) and once from the reference node, and take the better one. Nominal false; fixed point: always. */
    bool nonlinear;

    /* End for good once the track has left `region` after having been inside it by at least `inside_mm`, 0 to 1e9 (fixed point: 1.6e7), from every
     * border. Nominal false; region 0 to 80 m (each coordinate within +- 1e9 mm), inside_mm 5000. */
    bool stop_outside;
    struct mh_region region;
    int32_t inside_mm;
};

/* The state, in the header so that it can be allocated statically; its members are the tracker's own. */
struct mh_luo {
    struct mh_luo_config config;
    mh_real interval_s;
    mh_q20 threshold; /* chi */
    uint32_t count;   /* n: positions so far, saturating */
    mh_tick time;     /* of the last step */
    uint32_t since;   /* ticks from the last position (before the first: from the first step) to `time`, saturating */
    bool stepped;     /* `time` is set */
    bool armed;       /* has been well inside the region */
    bool ended;       /* has left it */
    struct mh_place origin;
    struct mh_sage_husa x, y; /* their estimates: the filtered position */
    mh_real age;              /* of the last pre-estimate at its sampling instant */
    struct mh_vec2 raw[2];    /* the last pre-estimate and the one before */
    struct mh_vec2 velocity;
};

extern const struct mh_tracker mh_tracker_luo;

void mh_luo_config_default(struct mh_luo_config *config);

#endif
