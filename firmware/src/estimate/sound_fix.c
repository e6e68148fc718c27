#include "heard.h"

#define ENERGY_MIN 0.25f /* what is less is taken for this: nothing is farther than twice the sensing range */
#define STEP_MAX 15.0f   /* m */
#define SETTLED 0.01f    /* m */

enum { FINEST = 40, REFINEMENTS = 2 };

#define GRID 1.0f    /* m */
#define FINE 0.1f    /* m */
#define MARGIN 10.0f /* m */
enum { GRID_MAX = 120 };

enum mh_status mh_sound_refine(const struct mh_sound *sound, const struct mh_heard *heard, size_t count,
                               const struct mh_position_prior *prior, uint8_t iterations, struct mh_vec2 *position,
                               struct mh_sym2 *information)
{
    if (!mh_sound_valid(sound) || iterations == 0) {
        return MH_ERR_ARGUMENT;
    }
    if (count == 0 && prior == NULL) {
        return MH_ERR_TOO_FEW;
    }
    struct mh_sym2 known = {0, 0, 0};
    if (prior != NULL) {
        const struct mh_heard expected = {prior->mean, 0};
        const enum mh_status status = mh_heard_check(&expected, 1);
        if (status != MH_OK) {
            return status;
        }
        if (!mh_within(prior->sd_m, 1e-3f, 1e6f)) {
            return MH_ERR_ARGUMENT;
        }
        known.xx = known.yy = 1.0f / (prior->sd_m * prior->sd_m);
    }
    const struct mh_heard start = {*position, 0};
    enum mh_status status = mh_heard_check(&start, 1);
    if (status == MH_OK) {
        status = mh_heard_check(heard, count);
    }
    if (status != MH_OK) {
        return status;
    }
    struct mh_vec2 p = *position;
    struct mh_sym2 normal = known;
    const mh_real source = 0.25f * sound->source_sd * sound->source_sd;
    const mh_real background = 0.25f * mh_squared(sound->background_sd / sound->loudness_m2);
    for (uint8_t iteration = 0; iteration < iterations; iteration++) {
        struct mh_vec2 right = {0, 0};
        normal = known;
        if (prior != NULL) {
            right.x = known.xx * (prior->mean.x - p.x);
            right.y = known.yy * (prior->mean.y - p.y);
        }
        for (size_t i = 0; i < count; i++) {
            const struct mh_vec2 away = {p.x - heard[i].place.x, p.y - heard[i].place.y};
            const mh_real square = mh_max(away.x * away.x + away.y * away.y, MH_SOUND_NEAR_M * MH_SOUND_NEAR_M);
            const mh_real distance = mh_sqrt(square);
            /* weight / d^2: that of u u' is 1 / (d^2 (tau^2 + (eta / e)^2) / 4) */
            const mh_real weight = 1.0f / (square * square * (source + background * square * square));
            const mh_real heard_from = mh_sqrt(sound->loudness_m2 / mh_max(heard[i].energy, ENERGY_MIN));
            const mh_real pull = weight * distance * (heard_from - distance);
            const mh_real wx = weight * away.x;
            normal.xx += wx * away.x;
            normal.xy += wx * away.y;
            normal.yy += weight * away.y * away.y;
            right.x += pull * away.x;
            right.y += pull * away.y;
        }
        const mh_real damping = 1e-3f * (normal.xx + normal.yy) + 1e-12f;
        const mh_real xx = normal.xx + damping;
        const mh_real yy = normal.yy + damping;
        const mh_real inverse = 1.0f / (xx * yy - normal.xy * normal.xy);
        const struct mh_vec2 step = {(yy * right.x - normal.xy * right.y) * inverse,
                                     (xx * right.y - normal.xy * right.x) * inverse};
        const mh_real length = mh_sqrt(step.x * step.x + step.y * step.y);
        const mh_real share = length > STEP_MAX ? STEP_MAX / length : 1.0f;
        p.x += share * step.x;
        p.y += share * step.y;
        if (length < SETTLED) {
            break;
        }
    }
    *position = p;
    if (information != NULL) {
        *information = normal;
    }
    return MH_OK;
}

enum mh_status mh_sound_fix(const struct mh_sound *sound, const struct mh_heard *heard, size_t count,
                            const struct mh_position_prior *prior, struct mh_vec2 *position,
                            struct mh_sym2 *information)
{
    if (!mh_sound_valid(sound)) {
        return MH_ERR_ARGUMENT;
    }
    const struct mh_distance_table table = {mh_sqrt(sound->loudness_m2), FINEST, MH_DISTANCE_MIDDLE};
    struct mh_vec2 p;
    enum mh_status status = mh_median_fix(heard, count, &table, &p);
    if (status == MH_OK) {
        status = mh_sound_refine(sound, heard, count, prior, REFINEMENTS, &p, information);
    }
    if (status == MH_OK) {
        *position = p;
    }
    return status;
}

static mh_real cost_at(const struct mh_sound *sound, const struct mh_heard *heard, size_t count,
                       enum mh_likelihood likelihood, struct mh_vec2 at)
{
    mh_real cost = 0;
    for (size_t i = 0; i < count; i++) {
        const mh_real energy =
            mh_sound_energy(sound, mh_squared(at.x - heard[i].place.x) + mh_squared(at.y - heard[i].place.y));
        if (likelihood == MH_LIKELIHOOD_CONSTANT) {
            cost += mh_squared(heard[i].energy - energy);
        } else {
            const mh_real variance = mh_sound_log_variance(sound, energy);
            const mh_real residual = mh_log(mh_max(heard[i].energy, ENERGY_MIN) / energy);
            cost += residual * residual / variance + mh_log(variance);
        }
    }
    return cost;
}

/* The best of a grid of at most GRID_MAX intervals a side. */
static struct mh_vec2 best_of_grid(const struct mh_sound *sound, const struct mh_heard *heard, size_t count,
                                   enum mh_likelihood likelihood, struct mh_vec2 low, struct mh_vec2 high, mh_real step)
{
    const mh_real coarse = mh_max(step, mh_max(high.x - low.x, high.y - low.y) * (1.0f / GRID_MAX));
    const int columns = (int)((high.x - low.x) / coarse + 0.5f);
    const int rows = (int)((high.y - low.y) / coarse + 0.5f);
    struct mh_vec2 best = low;
    mh_real least = cost_at(sound, heard, count, likelihood, low);
    for (int row = 0; row <= rows; row++) {
        for (int column = 0; column <= columns; column++) {
            const struct mh_vec2 at = {low.x + (mh_real)column * coarse, low.y + (mh_real)row * coarse};
            const mh_real cost = cost_at(sound, heard, count, likelihood, at);
            if (cost < least) {
                least = cost;
                best = at;
            }
        }
    }
    return best;
}

enum mh_status mh_likeliest(const struct mh_sound *sound, const struct mh_heard *heard, size_t count,
                            enum mh_likelihood likelihood, struct mh_vec2 *position)
{
    if (!mh_sound_valid(sound)) {
        return MH_ERR_ARGUMENT;
    }
    if (count == 0) {
        return MH_ERR_TOO_FEW;
    }
    const enum mh_status status = mh_heard_check(heard, count);
    if (status != MH_OK) {
        return status;
    }
    const mh_real reach = mh_sqrt(sound->loudness_m2) + MARGIN;
    struct mh_vec2 low = {heard[0].place.x - reach, heard[0].place.y - reach};
    struct mh_vec2 high = {heard[0].place.x + reach, heard[0].place.y + reach};
    for (size_t i = 1; i < count; i++) {
        const struct mh_vec2 at = heard[i].place;
        const struct mh_vec2 l = {mh_max(low.x, at.x - reach), mh_max(low.y, at.y - reach)};
        const struct mh_vec2 h = {mh_min(high.x, at.x + reach), mh_min(high.y, at.y + reach)};
        if (l.x <= h.x - 2 * MARGIN && l.y <= h.y - 2 * MARGIN) {
            low = l;
            high = h;
        }
    }
    struct mh_vec2 best = best_of_grid(sound, heard, count, likelihood, low, high, GRID);
    if (likelihood == MH_LIKELIHOOD_FULL) {
        const struct mh_vec2 l = {best.x - GRID, best.y - GRID};
        const struct mh_vec2 h = {best.x + GRID, best.y + GRID};
        best = best_of_grid(sound, heard, count, likelihood, l, h, FINE);
    }
    *position = best;
    return MH_OK;
}
