/* Unscented Kalman filter on a struct mh_gaussian, with the models as functions (transition.h, observations.h). No Jacobian is needed.
 *
 * Sigma points: x and x +- gamma column_i(L), P = L L', gamma = alpha sqrt(n + kappa), with the weights of Julier and Uhlmann (Proc. IEEE 92, 2004) as scaled
 * by Wan and van der Merwe (2000). What a function f makes of them is used as symmetric and second differences,
 *
 *     c_i = (f(X+_i) - f(X-_i)) / (2 gamma),   d_i = f(X+_i) + f(X-_i) - 2 f(x),   D = sum d_i / (2 gamma^2)
 *     mean = f(x) + D,   cov(x, f) = sum column_i(L) c_i'
 *     var f = sum c_i c_i' + sum (d_i - mean d) (d_i - mean d)' / (4 gamma^2) + (beta + alpha^2 kappa / n) D D'
 *
 * which are the usual weighted sums to the letter, but without a negative or large weight, so that nothing cancels where alpha is small. And they say when
 * a UKF keeps its covariance positive definite by construction: if beta + alpha^2 kappa / n >= 0, what var f has beside sum c_i c_i' is that
 * of a further noise, for any f. An update is then that of a linear measurement with the gradient c with respect to L^-1 x and that noise
 * (mh_gaussian_root_take): P stays L L', as in a square-root UKF.
 *
 * No function keeps anything between calls: any number of filters run side by side.
 *
 * Of all functions: the gaussian is untouched after an error. Errors of all: MH_ERR_ARGUMENT (number of states; weights out of their range; noise variance below
 * 1.2e-38 or NaN), MH_ERR_NOT_FINITE (an input, what a model says at a sigma point, or the result), MH_ERR_SINGULAR (P is not positive definite), and
 * whatever the model returns.
 *
 * Stack, besides the model's own: 4 N^2 + 24 N bytes and registers in a sequential update, N = MH_STATES_MAX; 6 N^2 + 38 N in a
 * prediction; a stacked update takes 2 S^2 + 8 N S + 14 S more, S = MH_STACKED_MAX. */
#ifndef MOTEHOUND_UKF_H
#define MOTEHOUND_UKF_H

#if MH_REAL_FIXED
#error "motehound/ukf.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/gaussian.h"
#include "motehound/observations.h"
#include "motehound/transition.h"

/* {1, 0, 0}: points at sqrt(n) standard deviations, no weight on the middle one. {0.5, 2, 0}: nearer, and right to fourth order for Gaussians.
 * {1, 2, 0}: as {1, 0, 0}, with the curvature counted in full. In mh_real an alpha of 0.1 gives what it gives in double precision, one of 1e-3
 * nothing but rounding. */
struct mh_ukf_weights {
    mh_real alpha; /* 0.1 to 1: how far out the points are */
    mh_real beta;  /* what is known of the distribution's kurtosis: 2 for a Gaussian */
    mh_real kappa; /* n + kappa >= 1/2, beta + alpha^2 kappa / n >= 0 */
};

/* x = E f(x), P = cov f(x) + Q. Q packed, positive semidefinite. For a linear f exactly F x and F P F' + Q (mh_gaussian_predict does that in a third of
 * the time). 2 n + 1 evaluations of the model. */
enum mh_status mh_ukf_predict(struct mh_gaussian *gaussian, const struct mh_ukf_weights *weights,
                              const struct mh_transition *transition, const mh_real *Q);

/* The elements one after the other, with new sigma points for each (Zhang, Eqs. (13)-(20)). `count` may be 0 to 65535. 2 n + 1 evaluations of the
 * model an element, and 5 n^2 / 2 + 14 n multiplications, n roots and 2 n divisions. */
enum mh_status mh_ukf_update(struct mh_gaussian *gaussian, const struct mh_ukf_weights *weights,
                             const struct mh_observations *observations);

/* The elements all at once, with one set of sigma points (Xu, Eqs. (17)-(28)). `count` at most MH_STACKED_MAX, else MH_ERR_CAPACITY. */
enum mh_status mh_ukf_update_stacked(struct mh_gaussian *gaussian, const struct mh_ukf_weights *weights,
                                     const struct mh_observations *observations);

#endif
