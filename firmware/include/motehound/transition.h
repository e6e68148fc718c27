/* How a state moves from one instant to the next: the one way in which ekf.h and ukf.h are told a motion that is not linear. A linear one is a matrix,
 * and mh_gaussian_predict (gaussian.h) is exact for it and takes a third of the time. */
#ifndef MOTEHOUND_TRANSITION_H
#define MOTEHOUND_TRANSITION_H

#if MH_REAL_FIXED
#error "motehound/transition.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/real.h"
#include "motehound/status.h"

struct mh_transition {
    const void *context; /* of the function */
    /* Where state x is after the step, without noise -> next (x and next are not the same), and the Jacobian d next_i / d x_j -> F[i n + j], unless
     * that is NULL, as it always is for a UKF. Any error but MH_OK ends the prediction, the estimate as it was. */
    enum mh_status (*move)(const void *context, const mh_real *x, mh_real *next, mh_real *F);
};

#endif
