#include "motehound/geometry.h"

static int32_t millimetres(int32_t origin_mm, mh_real offset_m)
{
    const mh_real mm = mh_clamp(offset_m * 1000.0f, -2.0f * MH_COORDINATE_MAX_MM, 2.0f * MH_COORDINATE_MAX_MM);
    const int64_t sum = (int64_t)origin_mm + (int32_t)(mm < 0 ? mm - 0.5f : mm + 0.5f);
    return (int32_t)(sum > MH_COORDINATE_MAX_MM    ? MH_COORDINATE_MAX_MM
                     : sum < -MH_COORDINATE_MAX_MM ? -MH_COORDINATE_MAX_MM
                                                   : sum);
}

struct mh_place mh_place_from_offset(const struct mh_place *origin, struct mh_vec2 offset)
{
    struct mh_place place = {millimetres(origin->x_mm, offset.x), millimetres(origin->y_mm, offset.y), origin->z_mm};
    return place;
}
