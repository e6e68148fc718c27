/* What a gas sensor reads without the leak: a low quantile of its own readings, followed as it drifts with weather, hour and sensor.
 *
 * A reading above the level lifts it by quantile * step, one below lowers it by (1 - quantile) * step, neither beyond the reading: in balance the
 * share `quantile` of the readings lies below (Robbins and Monro, 1951). Plumes pass a fixed sensor now and then, so a low quantile stays beneath them,
 * and a reading that is absurdly high counts no more than any other that is above. */
#ifndef MOTEHOUND_BACKGROUND_H
#define MOTEHOUND_BACKGROUND_H

#if MH_REAL_FIXED
#error "motehound/background.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/real.h"
#include "motehound/status.h"

struct mh_background_config {
    mh_real quantile; /* 0.01 to 0.5 */
    mh_real step;     /* how far the level may move at a reading, in the unit of the sensor, > 0 */
};

struct mh_background {
    mh_real level;
    bool known; /* begins as false */
};

/* What the reading is above the level before it -> *excess, which may be negative; the first sets the level. Cost: a few comparisons.
 * Errors: MH_ERR_NOT_FINITE. */
enum mh_status mh_background_take(struct mh_background *background, const struct mh_background_config *config,
                                  mh_real reading, mh_real *excess);

#endif
