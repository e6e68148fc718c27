#include "motehound/geometry.h"

#include "motehound/share.h"

static int32_t millimetres(int32_t origin_mm, mh_real offset_m)
{
#if MH_REAL_FIXED
    const int64_t wide = (int64_t)offset_m * 1000;
    const int32_t offset_mm = (int32_t)((wide < 0 ? wide - MH_REAL_ONE / 2 : wide + MH_REAL_ONE / 2) / MH_REAL_ONE);
#else
    const mh_real mm = mh_clamp(offset_m * 1000.0f, -2.0f * MH_COORDINATE_MAX_MM, 2.0f * MH_COORDINATE_MAX_MM);
    const int32_t offset_mm = mh_real_round(mm);
#endif
    const int64_t sum = (int64_t)origin_mm + offset_mm;
    return (int32_t)(sum > MH_COORDINATE_MAX_MM    ? MH_COORDINATE_MAX_MM
                     : sum < -MH_COORDINATE_MAX_MM ? -MH_COORDINATE_MAX_MM
                                                   : sum);
}

struct mh_place mh_place_from_offset(const struct mh_place *origin, struct mh_vec2 offset)
{
    struct mh_place place = {millimetres(origin->x_mm, offset.x), millimetres(origin->y_mm, offset.y), origin->z_mm};
    return place;
}

#if MH_REAL_FIXED
/* mm * 8192 / 125, rounded, by a product in place of the division: `whole` may be one off, and the rest makes up for it */
mh_real mh_metres(int32_t mm)
{
    if (mm > 32767999 || mm < -32767999) {
        return mm < 0 ? -MH_REAL_INFINITE : MH_REAL_INFINITE;
    }
    const int32_t whole = mh_real_to_bits(mh_part(8589935, mh_real_from_bits(mm))), rest = mm - 125 * whole;
    return mh_real_from_bits((int32_t)((uint32_t)whole * 8192 + (uint32_t)((rest * 4294967 + 32768) >> 16)));
}
#endif

/* digit by digit in base 4 */
uint32_t mh_square_root(uint64_t square)
{
    uint64_t result = 0;
    uint64_t bit = (uint64_t)1 << 62;
    while (bit > square) {
        bit >>= 2;
    }
    for (; bit != 0; bit >>= 2) {
        const uint64_t trial = result + bit;
        result >>= 1;
        if (square >= trial) {
            square -= trial;
            result += bit;
        }
    }
    return (uint32_t)result;
}

uint32_t mh_place_distance_mm(const struct mh_place *a, const struct mh_place *b)
{
    const int64_t dx = (int64_t)a->x_mm - b->x_mm;
    const int64_t dy = (int64_t)a->y_mm - b->y_mm;
    return mh_square_root((uint64_t)(dx * dx + dy * dy));
}
