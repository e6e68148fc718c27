#include "motehound/plume.h"

#include <stddef.h>

enum mh_status mh_plume_model(const struct mh_plume *plume, struct mh_vec2 sensor, struct mh_vec2 source,
                              mh_real spread_m2, mh_real *concentration, struct mh_vec2 *gradient)
{
    const struct mh_vec2 w = plume->downwind;
    const struct mh_vec2 r = {sensor.x - source.x, sensor.y - source.y};
    const mh_real distance = mh_sqrt(r.x * r.x + r.y * r.y + spread_m2);
    if (!mh_finite(distance)) {
        return MH_ERR_NOT_FINITE;
    }
    const mh_real d = mh_max(distance, MH_PLUME_NEAR_M);
    const mh_real share = 1.0f / (2.0f * MH_PI * plume->diffusion_m2ps * d);
    const mh_real beta = MH_PI * d * share * plume->wind_mps; /* u / (2 K) */
    const mh_real c = share * mh_exp(-beta * (d - (r.x * w.x + r.y * w.y)));
    *concentration = c;
    if (gradient != NULL) {
        const bool near = distance < MH_PLUME_NEAR_M;
        const mh_real along = near ? 0 : 2.0f * MH_PI * plume->diffusion_m2ps * share; /* 1 / d */
        const mh_real radial = c * along * (along + (near ? 0 : beta));
        gradient->x = radial * r.x - c * beta * w.x;
        gradient->y = radial * r.y - c * beta * w.y;
    }
    return MH_OK;
}
