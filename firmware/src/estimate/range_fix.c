#include "motehound/range_fix.h"

#include "motehound/range_model.h"

#define SINGULAR 0.3f
#define STRAIGHT 0.05f /* of a standard deviation: the error of taking a circle for its tangent */

struct problem {
    const struct mh_measurement *ranges;
    size_t count;
    const struct mh_place *origin;
    mh_real height_m, sd_m;
};

/* At most `passes` steps of Gauss and Newton from fix->position, `damping` on the diagonal. Gives the sum of squared residuals at the end of
 * the last step, to first order. */
static mh_real descend(const struct problem *problem, int passes, mh_real damping, struct mh_range_fix *fix)
{
    mh_real squares = 0;
    for (int pass = 0; pass < passes; pass++) {
        struct mh_sym2 normal = {0, 0, 0};
        struct mh_vec2 right = {0, 0}; /* sum of u r */
        mh_real distances = 0;
        squares = 0;
        for (size_t i = 0; i < problem->count; i++) {
            const struct mh_measurement *m = &problem->ranges[i];
            mh_real range;
            struct mh_vec2 u;
            if (mh_range_model(fix->position, mh_place_relative(&m->place, problem->origin),
                               problem->height_m - (mh_real)m->place.z_mm * 0.001f, &range, &u) != MH_OK) {
                continue;
            }
            const mh_real r = mh_q20_to_real(m->value) - range;
            normal.xx += u.x * u.x;
            normal.xy += u.x * u.y;
            normal.yy += u.y * u.y;
            right.x += u.x * r;
            right.y += u.y * r;
            squares += r * r;
            distances += range;
        }
        fix->normal = normal;
        const mh_real xx = normal.xx + damping;
        const mh_real yy = normal.yy + damping;
        const mh_real inverse = 1.0f / (xx * yy - normal.xy * normal.xy);
        const struct mh_vec2 step = {(yy * right.x - normal.xy * right.y) * inverse,
                                     (xx * right.y - normal.xy * right.x) * inverse};
        fix->position.x += step.x;
        fix->position.y += step.y;
        squares -= step.x * right.x + step.y * right.y;
        /* a circle of radius d leaves its tangent by step^2 / (2 d) */
        const mh_real square = step.x * step.x + step.y * step.y;
        if (square * (mh_real)problem->count <= 2 * STRAIGHT * problem->sd_m * distances) {
            break;
        }
    }
    return squares;
}

struct mh_vec2 mh_range_centre(const struct mh_measurement *ranges, size_t count, const struct mh_place *origin)
{
    struct mh_vec2 centre = {0, 0};
    for (size_t i = 0; i < count; i++) {
        const struct mh_vec2 anchor = mh_place_relative(&ranges[i].place, origin);
        centre.x += anchor.x;
        centre.y += anchor.y;
    }
    const mh_real share = 1.0f / (mh_real)count;
    centre.x *= share;
    centre.y *= share;
    return centre;
}

enum mh_status mh_range_fix(const struct mh_measurement *ranges, size_t count, const struct mh_place *origin,
                            mh_real height_m, mh_real sd_m, struct mh_vec2 near, struct mh_range_fix *fix)
{
    if (count < 3) {
        return MH_ERR_TOO_FEW;
    }
    const struct problem problem = {ranges, count, origin, height_m, sd_m};
    const mh_real n = (mh_real)count;
    const mh_real limit = sd_m * sd_m * (n + 4.0f * mh_sqrt(2.0f * n));
    struct mh_range_fix best = {.position = near};
    mh_real squares = descend(&problem, 5, 0.05f, &best);
    if (!(squares <= limit)) {
        struct mh_range_fix second = {.position = mh_range_centre(ranges, count, origin)};
        const mh_real others = descend(&problem, 10, 0.3f, &second);
        if (!(squares <= others)) {
            best = second;
            squares = others;
        }
    }
    if (!(squares <= 2.0f * limit) || !mh_finite(best.position.x) || !mh_finite(best.position.y)) {
        return MH_NONE;
    }
    if (!(best.normal.xx * best.normal.yy - best.normal.xy * best.normal.xy >= SINGULAR)) {
        return MH_ERR_SINGULAR;
    }
    *fix = best;
    return MH_OK;
}
