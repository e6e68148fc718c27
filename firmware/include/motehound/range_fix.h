/* One position in the plane from the ranges of one instant, near a place where it is known to be: maximum likelihood by Gauss-Newton.
 *
 * The ranges' errors are normal and independent with one standard deviation. About two passes over the ranges are enough from a filter's
 * prediction: each ends the search as soon as the circles that the ranges draw are straight over its step, to a tenth of that deviation.
 * Where nothing is known multilateration.h searches everywhere and suffers outliers. */
#ifndef MOTEHOUND_RANGE_FIX_H
#define MOTEHOUND_RANGE_FIX_H

#if MH_REAL_FIXED
#error "motehound/range_fix.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/measurement.h"
#include "motehound/status.h"

#include <stddef.h>

struct mh_range_fix {
    struct mh_vec2 position; /* relative to the origin */
    /* Sum of u u' over the ranges, u the horizontal part of the unit vector from the anchor: sd_m^2 times its inverse is the covariance. */
    struct mh_sym2 normal;
};

/* `ranges`: values in m, of either sign as noise makes them; places with z. `height_m`: z of the target, `sd_m`: of one range, > 0; `near`:
 * where the search begins, relative to the origin. If the sum of squared residuals there exceeds sd_m^2 (n + 4 sqrt(2 n)), four of its
 * standard deviations more than n ranges have, it begins again from the anchors' centre and the better end is taken.
 * Cost: at most 15 passes over the ranges, of one root, one division and about 25 additions and multiplications each.
 * Errors: MH_ERR_TOO_FEW (fewer than three ranges), MH_NONE (the residuals are more than twice as large: the ranges do not agree),
 * MH_ERR_SINGULAR (det of `normal` below 0.3: the anchors stand in one line with the place). */
enum mh_status mh_range_fix(const struct mh_measurement *ranges, size_t count, const struct mh_place *origin,
                            mh_real height_m, mh_real sd_m, struct mh_vec2 near, struct mh_range_fix *fix);

#endif
