/* What a gas sensor reads downwind of a leak: the time-averaged plume of a point source on the ground in uniform wind and homogeneous turbulence
 * (Ishida, Nakamoto and Moriizumi, 1998; Zhang, Eqs. (1)-(3)),
 *
 *     c(r) = q / (2 pi K d) exp(-u / (2 K) (d - D)),   d = |r - s|,   D = (r - s) . w
 *
 * the exact steady solution of u . grad c = K lap c + q delta above a reflecting ground. Nearer than MH_PLUME_NEAR_M the distance is taken for that, where
 * the model has its singularity.
 *
 * Units: with q in mL/s and K in m2/s, c is in mL/m3 = ppm. Only u / (2 K) and q / K matter, so any others do that keep them. */
#ifndef MOTEHOUND_PLUME_H
#define MOTEHOUND_PLUME_H

#if MH_REAL_FIXED
#error "motehound/plume.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/geometry.h"
#include "motehound/status.h"

#define MH_PLUME_NEAR_M 1.0f

struct mh_plume {
    mh_real diffusion_m2ps;  /* K, > 0 */
    mh_real wind_mps;        /* u, >= 0 */
    struct mh_vec2 downwind; /* w, of length 1 */
};

/* Concentration at `sensor` for a release of 1 at `source` -> *concentration, and its gradient with respect to the source's place, by the Jacobian
 * below, unless `gradient` is NULL:
 *
 *     dc/ds = c (n / d + u / (2 K) (n - w)),  n = (r - s) / d;  nearer than MH_PLUME_NEAR_M  dc/ds = -c u / (2 K) w
 *
 * `spread_m2` >= 0 is the variance of the distance where the source is uncertain: 1 / d becomes 1 / sqrt(d^2 + spread), so that a sensor that happens to
 * be near to the estimate is not thought to be next to the source; the exponential stays. All metres, finite. Cost: one root, one exponential, one
 * division; with a spread one root more, and one division if there is a gradient. Errors: MH_ERR_NOT_FINITE. */
enum mh_status mh_plume_model(const struct mh_plume *plume, struct mh_vec2 sensor, struct mh_vec2 source,
                              mh_real spread_m2, mh_real *concentration, struct mh_vec2 *gradient);

#endif
