/* One position in the plane from the ranges of one instant: robust Gauss-Newton from eight starts.
 *
 * Minimises the sum of log(1 + (r / c)2) over the residuals r (Cauchy's loss, c = 2.385 standard deviations: 95 % efficient on
 * normal noise), so that one false range among four or more does not move the answer far; c comes down to that value in five
 * stages, lest a start far off settles in a dip that one range alone makes.
 *
 * Ambiguity: seen from above, anchors on one line cannot tell a place from its mirror image in that line, and three anchors
 * nearly on a line can hardly. The place with the lower cost is given; where both cost the same it is the one found first, in the
 * order of the starts: directions 0, 45, ... 315 degrees anticlockwise from +x, seen from the anchors' centre. */
#ifndef MOTEHOUND_MULTILATERATION_H
#define MOTEHOUND_MULTILATERATION_H

#if MH_REAL_FIXED
#error "motehound/multilateration.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/measurement.h"
#include "motehound/status.h"

#include <stddef.h>

struct mh_fix {
    struct mh_vec2 position;   /* relative to the origin */
    struct mh_sym2 covariance; /* m2, for independent errors of the given standard deviation */
    mh_real rms_m;             /* of the residuals of the ranges that agree */
    uint16_t agreeing;         /* ranges within three standard deviations */
};

/* `ranges`: values > 0 are ranges in m, others are left out; places with z. `height_m`: z of the target. `sd_m`: of one range, > 0.
 * Cost: at most 8 x 5 x 16 passes over the ranges. Errors: MH_ERR_ARGUMENT (sd or height), MH_ERR_TOO_FEW (fewer than three ranges),
 * MH_NONE (no place agrees with three of them), MH_ERR_SINGULAR (they leave the place open in some direction: the larger
 * standard deviation exceeds half of the mean range). */
enum mh_status mh_multilaterate(const struct mh_measurement *ranges, size_t count, const struct mh_place *origin,
                                mh_real height_m, mh_real sd_m, struct mh_fix *fix);

#endif
