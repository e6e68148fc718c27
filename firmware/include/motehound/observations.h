/* What was measured of a state and what the model says of it: the one way in which ekf.h, ukf.h and iterated_ekf.h are told both.
 *
 * A user writes one function, `predict`, for each kind of sensor; the filters ask it element by element, so measurements of several kinds and
 * places go into one update. Noise is independent between elements: correlated noise is whitened first. */
#ifndef MOTEHOUND_OBSERVATIONS_H
#define MOTEHOUND_OBSERVATIONS_H

#if MH_REAL_FIXED
#error "motehound/observations.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/real.h"
#include "motehound/status.h"

struct mh_observations {
    uint16_t count;          /* of elements */
    const mh_real *z;        /* what was measured, each ... */
    const mh_real *variance; /* ... and its noise variance, > 0 */
    const void *context;     /* of the functions */
    /* What element k would be at state x, without noise -> *z, and its gradient with respect to the state -> gradient[0 .. n), unless that
     * is NULL. Any error but MH_OK ends the update, the estimate as it was. */
    enum mh_status (*predict)(const void *context, uint16_t k, const mh_real *x, mh_real *z, mh_real *gradient);
    /* `difference` of two values of element k, where it wraps as an angle does, brought to its range. NULL: no element wraps. */
    mh_real (*wrap)(const void *context, uint16_t k, mh_real difference);
};

#endif
