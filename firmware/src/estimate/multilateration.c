#include "motehound/multilateration.h"

#include "motehound/range_model.h"

enum { STARTS = 8, STAGES = 5, ITERATIONS = 16 };

#define CAUCHY 2.385f /* scale in standard deviations */
#define COARSER 4.0f  /* from one stage's scale to that of the stage before */
#define AGREES 3.0f   /* standard deviations */

/* The normal equations of one linearisation, and what the residuals say. */
struct pass {
    struct mh_sym2 normal; /* J' W J */
    struct mh_vec2 right;  /* J' W r */
    mh_real cost;
    mh_real squares; /* of the residuals that agree */
    uint16_t agreeing;
};

struct problem {
    const struct mh_measurement *ranges;
    size_t count;
    const struct mh_place *origin;
    mh_real height_m, sd_m;
    mh_real scale; /* c of Cauchy's loss */
};

static struct pass linearise(const struct problem *problem, struct mh_vec2 position)
{
    struct pass pass = {.cost = 0};
    for (size_t i = 0; i < problem->count; i++) {
        const struct mh_measurement *m = &problem->ranges[i];
        const struct mh_vec2 anchor = mh_place_relative(&m->place, problem->origin);
        mh_real predicted;
        struct mh_vec2 g;
        if (m->value <= 0 || mh_range_model(position, anchor, problem->height_m - (mh_real)m->place.z_mm * 0.001f,
                                            &predicted, &g) != MH_OK) {
            continue;
        }
        const mh_real r = mh_q20_to_real(m->value) - predicted;
        const mh_real ratio = r / problem->scale;
        const mh_real weight = 1.0f / (1.0f + ratio * ratio);
        pass.cost -= mh_log(weight);
        pass.normal.xx += weight * g.x * g.x;
        pass.normal.xy += weight * g.x * g.y;
        pass.normal.yy += weight * g.y * g.y;
        pass.right.x += weight * g.x * r;
        pass.right.y += weight * g.y * r;
        if (mh_abs(r) <= AGREES * problem->sd_m) {
            pass.squares += r * r;
            pass.agreeing++;
        }
    }
    return pass;
}

/* Levenberg-Marquardt from `position`: damping rises where a step would not lower the cost, falls where it does. */
static struct pass descend(const struct problem *problem, struct mh_vec2 *position)
{
    struct pass best = linearise(problem, *position);
    mh_real damping = 1e-3f;
    for (int i = 1; i < ITERATIONS; i++) {
        const mh_real ridge = damping * (best.normal.xx + best.normal.yy);
        const mh_real xx = best.normal.xx + ridge;
        const mh_real yy = best.normal.yy + ridge;
        const mh_real determinant = xx * yy - best.normal.xy * best.normal.xy;
        if (!(determinant > 0)) {
            break;
        }
        const struct mh_vec2 step = {(yy * best.right.x - best.normal.xy * best.right.y) / determinant,
                                     (xx * best.right.y - best.normal.xy * best.right.x) / determinant};
        const struct mh_vec2 next = {position->x + step.x, position->y + step.y};
        const struct pass tried = linearise(problem, next);
        if (tried.cost < best.cost) {
            best = tried;
            *position = next;
            damping *= 0.1f;
        } else if (mh_abs(step.x) + mh_abs(step.y) < 1e-4f) {
            break;
        } else {
            damping *= 10.0f;
        }
    }
    return best;
}

enum mh_status mh_multilaterate(const struct mh_measurement *ranges, size_t count, const struct mh_place *origin,
                                mh_real height_m, mh_real sd_m, struct mh_fix *fix)
{
    if (!mh_finite(height_m) || !mh_finite(sd_m) || sd_m <= 0) {
        return MH_ERR_ARGUMENT;
    }
    struct mh_vec2 centre = {0, 0};
    mh_real mean = 0;
    mh_real used = 0;
    for (size_t i = 0; i < count; i++) {
        if (ranges[i].value > 0) {
            const struct mh_vec2 anchor = mh_place_relative(&ranges[i].place, origin);
            centre.x += anchor.x;
            centre.y += anchor.y;
            mean += mh_q20_to_real(ranges[i].value);
            used += 1.0f;
        }
    }
    if (used < 3.0f) {
        return MH_ERR_TOO_FEW;
    }
    centre.x /= used;
    centre.y /= used;
    mean /= used;
    static const struct mh_vec2 directions[STARTS] = {{1, 0},  {0.7071f, 0.7071f},   {0, 1},  {-0.7071f, 0.7071f},
                                                      {-1, 0}, {-0.7071f, -0.7071f}, {0, -1}, {0.7071f, -0.7071f}};
    const mh_real scale = CAUCHY * sd_m;
    struct problem problem = {ranges, count, origin, height_m, sd_m, scale};
    struct pass best = {.cost = 0};
    struct mh_vec2 position = centre;
    for (int i = 0; i < STARTS; i++) {
        struct mh_vec2 candidate = {centre.x + mean * directions[i].x, centre.y + mean * directions[i].y};
        struct pass pass = best;
        problem.scale = scale * (COARSER * COARSER * COARSER * COARSER);
        for (int stage = 0; stage < STAGES; stage++) {
            pass = descend(&problem, &candidate);
            problem.scale *= 1.0f / COARSER;
        }
        if (i == 0 || pass.cost < best.cost) {
            best = pass;
            position = candidate;
        }
    }
    if (best.agreeing < 3) {
        return MH_NONE;
    }
    /* eigenvalues of J' W J: the smaller one is the variance of the worse direction, inverted */
    const struct mh_sym2 *a = &best.normal;
    const mh_real half = 0.5f * (a->xx - a->yy);
    const mh_real larger = 0.5f * (a->xx + a->yy) + mh_sqrt(half * half + a->xy * a->xy);
    const mh_real determinant = a->xx * a->yy - a->xy * a->xy;
    const mh_real variance = sd_m * sd_m;
    if (!(variance * larger <= 0.25f * mean * mean * determinant)) {
        return MH_ERR_SINGULAR;
    }
    const mh_real unit = variance / determinant;
    const struct mh_fix answer = {
        .position = position,
        .covariance = {unit * a->yy, -unit * a->xy, unit * a->xx},
        .rms_m = mh_sqrt(best.squares / (mh_real)best.agreeing),
        .agreeing = best.agreeing,
    };
    *fix = answer;
    return MH_OK;
}
