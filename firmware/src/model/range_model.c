#include "motehound/range_model.h"

enum mh_status mh_range_model(struct mh_vec2 target, struct mh_vec2 anchor, mh_real rise, mh_real *distance,
                              struct mh_vec2 *gradient)
{
    const mh_real dx = target.x - anchor.x;
    const mh_real dy = target.y - anchor.y;
    const mh_real range = mh_sqrt(dx * dx + dy * dy + rise * rise);
    if (!mh_finite(range)) {
        return MH_ERR_NOT_FINITE;
    }
    if (range <= 0) {
        return MH_ERR_SINGULAR;
    }
    const mh_real inverse = 1.0f / range;
    *distance = range;
    gradient->x = dx * inverse;
    gradient->y = dy * inverse;
    return MH_OK;
}
