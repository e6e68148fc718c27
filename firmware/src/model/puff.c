#include "motehound/puff.h"

#include <stddef.h>

mh_real mh_puff_concentration(const struct mh_puff *puff, mh_real diffusion_m2ps, struct mh_vec2 point,
                              struct mh_puff_slope *slope)
{
    const mh_real spread =
        mh_mul(mh_mul(MH_REAL(4.0f), diffusion_m2ps), puff->age); /* squared length over which the puff has spread */
    const struct mh_puff_slope none = {0, 0, 0, 0};
    if (slope != NULL) {
        *slope = none;
    }
    if (!(spread > 0)) {
        return 0;
    }
    const struct mh_vec2 away = mh_vec2_between(puff->position, point);
    const mh_real exponent = mh_wide_div(mh_vec2_square(away), spread);
    const mh_real central = mh_div(puff->mass, mh_mul(MH_PI, spread));
    const mh_real c = mh_finite(central) ? mh_mul(central, mh_exp(-exponent)) : central;
    if (slope != NULL && c != 0) {
        const mh_real half_x = mh_wide_div(mh_wide_mul(c, away.x), spread);
        const mh_real half_y = mh_wide_div(mh_wide_mul(c, away.y), spread);
        slope->x = mh_add(half_x, half_x);
        slope->y = mh_add(half_y, half_y);
        slope->log_mass = c;
        slope->age = mh_wide_div(mh_wide_mul(c, exponent - MH_REAL(1.0f)), puff->age);
    }
    return c;
}
