#include "motehound/geometry.h"

static int32_t millimetres(int32_t origin_mm, mh_real offset_m)
{
    mh_real mm = offset_m * 1000.0f;
    return origin_mm + (int32_t)(mm < 0 ? mm - 0.5f : mm + 0.5f);
}

struct mh_place mh_place_from_offset(const struct mh_place *origin, struct mh_vec2 offset)
{
    struct mh_place place = {millimetres(origin->x_mm, offset.x), millimetres(origin->y_mm, offset.y), origin->z_mm};
    return place;
}
