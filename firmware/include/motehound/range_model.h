/* What a ranging sensor reads: the slant distance between an anchor and the target. */
#ifndef MOTEHOUND_RANGE_MODEL_H
#define MOTEHOUND_RANGE_MODEL_H

#if MH_REAL_FIXED
#error "motehound/range_model.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/geometry.h"
#include "motehound/status.h"

/* Distance from `anchor` to a target `rise` above it (or below, if negative), and its gradient with respect to the target's place in
 * the plane: the horizontal part of the unit vector from the anchor to the target. All lengths in one unit, finite, within +- 1e9.
 * Cost: one square root, one division.
 * Errors: MH_ERR_NOT_FINITE, MH_ERR_SINGULAR (the two places coincide: no gradient). */
enum mh_status mh_range_model(struct mh_vec2 target, struct mh_vec2 anchor, mh_real rise, mh_real *distance,
                              struct mh_vec2 *gradient);

#endif
