/* The trackers of a gas leak at rest in the wind: `gas`, `gas_small`, `gas_ekf` and `gas_ukf`. They find its place and its rate of release from the
 * concentrations of sensors that are heard one head after the other (protocol token.h), or all at one head.
 *
 * - `gas_ekf`, `gas_ukf`: state (x, y, q), one sample after the other (Zhang, Eqs. (8)-(12) and (13)-(20)). A saved track takes 36 bytes.
 * - `gas_small`: state (x, y, ln q), Levenberg-Marquardt over all samples of a head from the token's Gaussian. 36 bytes.
 * - `gas`, the default: the track is the data, the mean of each sensor's samples; every head solves the whole problem again, from a grid of places on which the
 *   rate is eliminated. MH_GAS_RECORD_BYTES for each sensor.
 *
 * `interest` does not exist. `score`: gas_ekf and gas_ukf want the head nearest to the estimate, the others the one whose neighbourhood tells most. */
#ifndef MOTEHOUND_GAS_H
#define MOTEHOUND_GAS_H

#include "motehound/gaussian.h"
#include "motehound/plume.h"
#include "motehound/tracker.h"

struct mh_gas_config {
    struct mh_plume plume; /* the air as the tracker knows it, where no wind is measured */
    mh_real noise;         /* standard deviation of one sample, in the unit of the sensors, > 0 */
    mh_real unit;          /* concentration (plume.h) that is 1 in the unit of the sensors, > 0. Nominal 1 */
    struct mh_region area; /* where the source can be: the grid's */
    struct mh_place prior; /* where it is expected, ... */
    struct mh_vec2 prior_sd_m;
    mh_real prior_rate, prior_rate_sd; /* ... and how much it releases */
    mh_real calm_step_m;               /* MH_ESTIMATE_CALM: the estimate moved less than this, nominal 5, ... */
    mh_real calm_sd_m;                 /* ... and for `gas` and `gas_small` sqrt(Pxx + Pyy) is below this, nominal 10 */
};

extern const struct mh_tracker mh_tracker_gas, mh_tracker_gas_small, mh_tracker_gas_ekf, mh_tracker_gas_ukf;

/* Zhang's field: 500 m x 400 m, K = 30, u = 1 along +x, prior (250, 200) +- (150, 120) m and 50 +- 30, noise 3e-6. */
void mh_gas_config_default(struct mh_gas_config *config);

#endif
