/* Extended Kalman filter on a struct mh_gaussian, with the models as functions (transition.h, observations.h).
 *
 * The covariance is updated as its root, P = L L', one scalar at a time (mh_gaussian_root_take), which equals Joseph's form
 * in exact arithmetic and cannot lose positive definiteness in any other. No function keeps anything between calls: any number of filters run
 * side by side.
 *
 * Of all functions: the gaussian is untouched after an error. Errors of all: MH_ERR_ARGUMENT (number of states; noise variance below 1.2e-38 or NaN),
 * MH_ERR_NOT_FINITE (an input, what a model says, or the result), MH_ERR_SINGULAR (P is not positive definite), and whatever the model returns.
 *
 * Stack, with N = MH_STATES_MAX, besides the model's own: 4 N^2 + 24 N bytes and registers in an update, 16 N^2 + 24 N in a prediction. */
#ifndef MOTEHOUND_EKF_H
#define MOTEHOUND_EKF_H

#if MH_REAL_FIXED
#error "motehound/ekf.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/gaussian.h"
#include "motehound/observations.h"
#include "motehound/transition.h"

/* x = f(x), P = F P F' + Q with F the Jacobian of f at x before. Q packed, positive semidefinite. */
enum mh_status mh_ekf_predict(struct mh_gaussian *gaussian, const struct mh_transition *transition, const mh_real *Q);

/* The elements one after the other, each with its model evaluated where those before it have moved the estimate (Zhang, Eqs. (10), (11)): better than
 * all at once where they are accurate and the model is curved. Their order matters a little. `count` may be 0 to 65535.
 * 2 n^2 + 8 n multiplications, n roots and 2 n
 * divisions an element, n^3 / 3 multiplications and n roots once. */
enum mh_status mh_ekf_update(struct mh_gaussian *gaussian, const struct mh_observations *observations);

/* The elements all at once: every model evaluated at the estimate before the update. Their order does not matter; the cost is the same. */
enum mh_status mh_ekf_update_stacked(struct mh_gaussian *gaussian, const struct mh_observations *observations);

#endif
