/* The trackers of a gas leak at rest in the wind: `gas`, `gas_small`, `gas_ekf` and `gas_ukf`. They find its place and its rate of release from the
 * concentrations of sensors that are heard one head after the other (protocol token.h), or all at one head.
 *
 * - `gas_ekf`, `gas_ukf`: state (x, y, q), one sample after the other in the order given (Zhang, Eqs. (8)-(12) and (13)-(20)).
 * - `gas_small`: state (x, y, ln q), Levenberg-Marquardt over all samples of a head from the Gaussian of the head before.
 * - `gas`, the default: the track is the data, the mean of each sensor's samples; every head solves the whole problem again, from a grid of places on
 *   which the rate is eliminated (plume_search.h). Where the grid finds more than one place likely, its covariance is the one stated.
 *
 * The first measurement of a step is the head's own. Samples may be negative, as noise makes them. Measured winds (MH_TARGET_WIND_X and _Y) are left out: the
 * wind is the configuration's. The leak does not move: step() without samples gives the same place again, or MH_NONE if there have been none yet.
 *
 * What an estimate holds: `origin` is the place of the prior; `states` 3, (x, y, q), after a step and 0 where `gas` was loaded and has not been stepped; `raw`
 * and `stored` equal position; `rate` in the unit of the prior's. `flags`: STARTED at the first step from the prior, COASTED without samples, REFRESHED with some,
 * CALM where the estimate has moved by less than calm_step_m since the step, or the head, before, and for `gas` and `gas_small` also
 * sqrt(Pxx + Pyy) < calm_sd_m. A track that has gone astray, more than 100 km from the prior or of an absurd rate, is dropped: MH_NONE, and the next step begins from the prior.
 *
 * `score`: gas_ekf and gas_ukf want the head nearest to the estimate. The others want the one whose neighbourhood, itself included, tells most,
 * ln det(P^-1 + sum h h' / sigma^2), with h where the estimate is but no nearer than it is sure of, to a sixteenth, so that rounding decides nothing;
 * `gas` takes off MH_GAS_REVISIT each time that the
 * candidate was head before.
 *
 * A saved track, all of it relative to the place of the prior, which all heads know alike (numbers as bytes.h puts them):
 * - of the Gaussian trackers MH_GAS_SAVED bytes: the mean, (x, y, q) or (x, y, ln q), and the packed covariance;
 * - of `gas` MH_GAS_HEADER_BYTES: x, y and ln q of the last estimate; then MH_GAS_RECORD_BYTES for each sensor: its id (4), its place in mm (3 + 3, within +- 8.3 km,
 *   sensors farther off are not taken), how often it was head (1) and sampled (1), both saturating, and the mean of its samples in the sensors' unit (4).
 *   Where there are more sensors than MH_TRACK_BYTES_MAX has room for, those whose samples tell least at the estimate stay behind.
 * load() accepts nothing that is not finite, not positive definite or out of range. */
#ifndef MOTEHOUND_GAS_H
#define MOTEHOUND_GAS_H

#if MH_REAL_FIXED
#error "motehound/gas.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/gaussian.h"
#include "motehound/plume.h"
#include "motehound/tracker.h"
#include "motehound/ukf.h"

#define MH_GAS_STATES 3
#define MH_GAS_SAVED MH_GAUSSIAN_BYTES(MH_GAS_STATES)
#define MH_GAS_HEADER_BYTES 12
#define MH_GAS_RECORD_BYTES 16
#define MH_GAS_REVISIT 0.5f

/* All finite and in the range given, or init() fails. */
struct mh_gas_config {
    struct mh_plume
        plume;     /* the air as the tracker knows it: K 1e-6 to 1e6, u 0 to 1e3, w of length 1 to a thousandth */
    mh_real noise; /* standard deviation of one sample, in the unit of the sensors, 1e-9 to 1e9 */
    mh_real unit;  /* concentration (plume.h) that is 1 in the unit of the sensors, 1e-12 to 1e12 */
    struct mh_region
        area; /* where the source can be: the grid's; not empty. Places within 1000 km of the field's origin */
    struct mh_place prior;             /* where it is expected, ... */
    struct mh_vec2 prior_sd_m;         /* 0.1 to 1e5 */
    mh_real prior_rate, prior_rate_sd; /* ... and how much it releases, 1e-9 to 1e9 and 1e-4 to 1e4 times that */
    mh_real calm_step_m; /* MH_ESTIMATE_CALM: the estimate moved less than this, 1e-3 to 1e5, nominal 5, ... */
    mh_real calm_sd_m;   /* ... and is as sure as this, the same range, nominal 10 */
    struct mh_ukf_weights
        ukf; /* of gas_ukf, as ukf.h has them: nominal {1, 0, 0}, as published; {0.5, 2, 0} is better */
};

/* State of `gas_ekf`, `gas_ukf` and `gas_small`. */
struct mh_gas_gaussian {
    const struct mh_gas_kind *kind; /* which of them */
    struct mh_gas_config config;
    struct mh_gaussian estimate;
    mh_tick time; /* of the last step */
    bool stepped; /* time is valid */
    bool known;   /* samples have gone into the estimate */
};

/* What `gas` keeps of a sensor. */
struct mh_gas_sensor {
    mh_node_id node;
    int32_t x_mm, y_mm; /* from the place of the prior */
    mh_real mean;       /* of its samples, in the sensors' unit */
    uint8_t samples, heads;
};

/* State of `gas`. */
struct mh_gas {
    struct mh_gas_config config;
    struct mh_gas_sensor sensors[MH_GAS_SENSORS_MAX];
    uint16_t count;
    struct mh_gaussian estimate; /* of (x, y, ln q) */
    mh_tick time;                /* of the last step */
    bool stepped;                /* time is valid */
    bool known;                  /* samples have gone into the estimate */
    bool stated;                 /* the estimate has a covariance */
};

extern const struct mh_tracker mh_tracker_gas, mh_tracker_gas_small, mh_tracker_gas_ekf, mh_tracker_gas_ukf;

/* Zhang's field with sensors that read ppb: 500 m x 400 m, K = 30, u = 1 along +x, prior (250, 200) +- (150, 120) m and 50 +- 30 mL/s, noise 0.003 ppb. */
void mh_gas_config_default(struct mh_gas_config *config);

#endif
