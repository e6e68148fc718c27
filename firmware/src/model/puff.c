#include "motehound/puff.h"

#include <stddef.h>

mh_real mh_puff_concentration(const struct mh_puff *puff, mh_real diffusion_m2ps, struct mh_vec2 point,
                              struct mh_puff_slope *slope)
{
    const mh_real spread = 4.0f * diffusion_m2ps * puff->age; /* squared length over which the puff has spread */
    const struct mh_puff_slope none = {0, 0, 0, 0};
    if (slope != NULL) {
        *slope = none;
    }
    if (!(spread > 0)) {
        return 0;
    }
    const mh_real dx = point.x - puff->position.x;
    const mh_real dy = point.y - puff->position.y;
    const mh_real exponent = (dx * dx + dy * dy) / spread;
    const mh_real c = puff->mass / (MH_PI * spread) * mh_exp(-exponent);
    if (slope != NULL && c != 0) {
        slope->x = 2.0f * c * dx / spread;
        slope->y = 2.0f * c * dy / spread;
        slope->log_mass = c;
        slope->age = c * (exponent - 1.0f) / puff->age;
    }
    return c;
}
