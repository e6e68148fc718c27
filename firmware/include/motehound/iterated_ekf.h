/* Iterated extended Kalman filter: the most probable state, and how well it is known, from a prior and any number of measurements with any model
 * (observations.h), by Levenberg and Marquardt's method. Where an EKF linearises once, at what it believed before, this goes to the minimum of
 *
 *     f(x) = (x - x0)' P0^-1 (x - x0) + sum_k (z_k - h_k(x))^2 / R_k
 *
 * and takes the covariance there, (P0^-1 + sum_k h_k h_k' / R_k)^-1 with h_k the gradients (Bell and Cathey, IEEE Trans. Automatic Control 38, 1993, with damping).
 *
 * It works in y = L^-1 (x - x0), P0 = L L', where the prior is |y|^2, on the triangular root of the information matrix, to which the measurements are
 * rotated one by one (Givens). So nothing is stored for a measurement, the condition is not squared, the information never falls below that of
 * the prior, and the result is positive definite by construction.
 *
 * Of several minima it finds the one downhill of the start; who fears others starts from several places and compares the costs.
 *
 * Each iteration evaluates every model once, with its gradient: `iterations` (at most) times `count`, n^2 / 2 for the change to y, and n roots,
 * n divisions and 2 n^2 multiplications to rotate it. Stack, N = MH_STATES_MAX: 14 N^2 + 34 N bytes and registers, besides the model's own. */
#ifndef MOTEHOUND_ITERATED_EKF_H
#define MOTEHOUND_ITERATED_EKF_H

#if MH_REAL_FIXED
#error "motehound/iterated_ekf.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/gaussian.h"
#include "motehound/observations.h"

struct mh_iterated_ekf_config {
    uint8_t iterations; /* at most, tries that do not lower f included; 1 to 255. 20 to 30 are plenty */
    mh_real
        damping; /* at first, a share of the diagonal: 0.01. Times 0.1 (to 1e-9) after a step that did not raise f, times 10 after one that would */
    mh_real settled; /* ends when a step lowers f by less than this share of 1 + f: 1e-4 is a hundredth of a standard
                      * deviation, 1e-6 about the rounding of f */
};

/* gaussian: the prior, then the posterior. From `start` (n states; NULL: from the prior's mean). `*cost` = f at the minimum, unless NULL. That it has run out of iterations is no
 * error: f is lower than at the start, and the covariance that of the place. The gaussian, and *cost, are untouched after an error: MH_ERR_ARGUMENT (number of states; config;
 * noise variance below 1.2e-38 or NaN), MH_ERR_NOT_FINITE (an input, f at the start, or the result), MH_ERR_SINGULAR (P is not positive definite), and whatever the model
 * returns at the start. Elsewhere a model that fails only ends the step. */
enum mh_status mh_iterated_ekf_update(struct mh_gaussian *gaussian, const struct mh_iterated_ekf_config *config,
                                      const mh_real *start, const struct mh_observations *observations, mh_real *cost);

#endif
