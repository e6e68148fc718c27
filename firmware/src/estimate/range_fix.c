#include "motehound/range_fix.h"

#include "motehound/range_model.h"

#define SINGULAR 0.3f
#define STRAIGHT 0.1f /* of a standard deviation: the error of taking a circle for its tangent */

#define MM_OF_Q20 (1000.0f / 1048576.0f)

/* Lengths are in mm here, as places are. */
struct problem {
    const struct mh_measurement *ranges;
    size_t count;
    struct mh_place origin; /* z: the target's */
    mh_real sd;
};

static struct mh_vec2 offset(const struct problem *problem, const struct mh_place *place)
{
    const struct mh_vec2 v = {(mh_real)(place->x_mm - problem->origin.x_mm),
                              (mh_real)(place->y_mm - problem->origin.y_mm)};
    return v;
}

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
            if (mh_range_model(fix->position, offset(problem, &m->place),
                               (mh_real)(problem->origin.z_mm - m->place.z_mm), &range, &u) != MH_OK) {
                continue;
            }
            const mh_real r = (mh_real)m->value * MM_OF_Q20 - range;
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
        if (square * (mh_real)problem->count <= 2 * STRAIGHT * problem->sd * distances) {
            break;
        }
    }
    return squares;
}

enum mh_status mh_range_fix(const struct mh_measurement *ranges, size_t count, const struct mh_place *origin,
                            mh_real height_m, mh_real sd_m, struct mh_vec2 near, struct mh_range_fix *fix)
{
    if (count < 3) {
        return MH_ERR_TOO_FEW;
    }
    const struct mh_place target = {origin->x_mm, origin->y_mm, (int32_t)(height_m * 1000.0f)};
    const struct problem problem = {ranges, count, target, sd_m * 1000.0f};
    const mh_real n = (mh_real)count;
    const mh_real limit = problem.sd * problem.sd * (n + 4.0f * mh_sqrt(2.0f * n));
    struct mh_range_fix best = {.position = {near.x * 1000.0f, near.y * 1000.0f}};
    mh_real squares = descend(&problem, 5, 0.05f, &best);
    if (!(squares <= limit)) {
        const struct mh_vec2 centre = mh_centroid(ranges, count, origin);
        struct mh_range_fix second = {.position = {centre.x * 1000.0f, centre.y * 1000.0f}};
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
    best.position.x *= 0.001f;
    best.position.y *= 0.001f;
    *fix = best;
    return MH_OK;
}
