#include "motehound/plume.h"

#include <stddef.h>

enum mh_status mh_plume_model(const struct mh_plume *plume, struct mh_vec2 sensor, struct mh_vec2 source,
                              mh_real spread_m2, mh_real *concentration, struct mh_vec2 *gradient)
{
    const struct mh_vec2 w = plume->downwind;
    const struct mh_vec2 r = {sensor.x - source.x, sensor.y - source.y};
    const mh_real distance = mh_sqrt(r.x * r.x + r.y * r.y);
    if (!mh_finite(distance) || !mh_finite(spread_m2)) {
        return MH_ERR_NOT_FINITE;
    }
    const mh_real d = mh_max(distance, MH_PLUME_NEAR_M);
    const mh_real blurred = spread_m2 > 0 ? mh_sqrt(d * d + spread_m2) : d;
    const mh_real share = 1.0f / (2.0f * MH_PI * plume->diffusion_m2ps * blurred);
    const mh_real beta = MH_PI * blurred * share * plume->wind_mps; /* u / (2 K) */
    const mh_real c = share * mh_exp(-beta * (d - (r.x * w.x + r.y * w.y)));
    *concentration = c;
    if (gradient != NULL) {
        const mh_real inverse = 2.0f * MH_PI * plume->diffusion_m2ps * share; /* 1 / blurred */
        const mh_real decay = spread_m2 > 0 ? beta * (blurred / d) : beta;
        const mh_real radial = distance < MH_PLUME_NEAR_M ? 0 : c * inverse * (inverse + decay);
        gradient->x = radial * r.x - c * beta * w.x;
        gradient->y = radial * r.y - c * beta * w.y;
    }
    return MH_OK;
}
