#include "heard.h"

#if MH_REAL_FIXED
#define ENERGY_MAX MH_REAL_MAX
#define PLACE_MAX MH_REAL(1e4f) /* m */
#else
#define ENERGY_MAX 1e9f
#define PLACE_MAX 1e6f /* m */
#endif

enum mh_status mh_heard_check(const struct mh_heard *heard, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct mh_vec2 at = heard[i].place;
        const mh_real energy = heard[i].energy;
        if (!(mh_abs(at.x) <= PLACE_MAX && mh_abs(at.y) <= PLACE_MAX && mh_abs(energy) <= ENERGY_MAX)) {
            return mh_finite(at.x) && mh_finite(at.y) && mh_finite(energy) ? MH_ERR_RANGE : MH_ERR_NOT_FINITE;
        }
    }
    return MH_OK;
}

void mh_heard_insert(struct mh_heard *heard, size_t *count, size_t capacity, const struct mh_heard *one)
{
    size_t at = *count;
    for (; at > 0 && one->energy > heard[at - 1].energy; at--) {
        if (at < capacity) {
            heard[at] = heard[at - 1];
        }
    }
    if (at < capacity) {
        heard[at] = *one;
        *count += *count < capacity;
    }
}

size_t mh_strongest(const struct mh_measurement *measurements, size_t count, const struct mh_place *origin,
                    struct mh_heard *heard, size_t capacity)
{
    size_t taken = 0;
    for (size_t i = 0; i < count; i++) {
        const struct mh_heard one = {mh_place_relative(&measurements[i].place, origin),
                                     mh_q20_to_real(measurements[i].value)};
        mh_heard_insert(heard, &taken, capacity, &one);
    }
    return taken;
}

enum mh_status mh_heard_centroid(const struct mh_heard *heard, size_t count, struct mh_vec2 *position)
{
    if (count == 0) {
        return MH_ERR_TOO_FEW;
    }
    const enum mh_status status = mh_heard_check(heard, count);
    if (status != MH_OK) {
        return status;
    }
#if MH_REAL_FIXED
    struct mh_vec2 mean = {0, 0};
    for (size_t i = 0; i < count; i++) { /* a sum would be too large */
        mean.x += mh_div(heard[i].place.x, mh_real_from_int((int32_t)count));
        mean.y += mh_div(heard[i].place.y, mh_real_from_int((int32_t)count));
    }
    *position = mean;
#else
    struct mh_vec2 sum = {0, 0};
    for (size_t i = 0; i < count; i++) {
        sum.x += heard[i].place.x;
        sum.y += heard[i].place.y;
    }
    const mh_real share = 1.0f / (mh_real)count;
    position->x = share * sum.x;
    position->y = share * sum.y;
#endif
    return MH_OK;
}

/* The circles of the first nodes, at most `capacity`. */
static enum mh_status circles_of(const struct mh_heard *heard, size_t count, const struct mh_distance_table *table,
                                 uint8_t capacity, struct mh_circle *circles, uint8_t *taken)
{
    const uint8_t n = (uint8_t)(count < capacity ? count : capacity);
    if (n == 0) {
        return MH_ERR_TOO_FEW;
    }
    if (!mh_within(table->range_m, MH_SOUND_NEAR_M, MH_DISTANCE_FIX_RANGE_MAX)) {
        return MH_ERR_ARGUMENT;
    }
    const enum mh_status status = mh_heard_check(heard, n);
    if (status != MH_OK) {
        return status;
    }
    for (uint8_t i = 0; i < n; i++) {
        circles[i].centre = heard[i].place;
        circles[i].radius = mh_distance(table, heard[i].energy);
    }
    *taken = n;
    return MH_OK;
}

static struct mh_vec2 one_or_two_circles(const struct mh_circle *circles, uint8_t count)
{
    return count == 1 ? circles[0].centre : mh_two_circles(&circles[0], &circles[1]);
}

enum mh_status mh_distance_fix(const struct mh_heard *heard, size_t count, const struct mh_distance_table *table,
                               enum mh_circles_variant variant, struct mh_vec2 *position)
{
    struct mh_circle circles[3];
    uint8_t taken;
    const enum mh_status status = circles_of(heard, count, table, 3, circles, &taken);
    if (status == MH_OK) {
        *position = taken < 3 ? one_or_two_circles(circles, taken) : mh_three_circles(circles, variant);
    }
    return status;
}

enum mh_status mh_median_fix(const struct mh_heard *heard, size_t count, const struct mh_distance_table *table,
                             struct mh_vec2 *position)
{
    struct mh_circle circles[MH_CIRCLES_MEDIAN_MAX];
    uint8_t taken;
    const enum mh_status status = circles_of(heard, count, table, MH_CIRCLES_MEDIAN_MAX, circles, &taken);
    if (status == MH_OK) {
        *position = taken < 3 ? one_or_two_circles(circles, taken) : mh_median_of_triples(circles, taken);
    }
    return status;
}
