#include "motehound/joint_sources.h"

#include "motehound/matrix.h"

#define LEAST_ENERGY 0.25f
#define SETTLED_M 0.01f

/* What Gauss-Newton damps the diagonal with */
#define DAMPING 0.001f
#define DAMPING_LEAST 1e-4f

#define UNKNOWNS_MAX (2 * MH_SOURCES_MAX)

struct normal {
    mh_real matrix[MH_PACKED_SIZE(UNKNOWNS_MAX)];
    mh_real right[UNKNOWNS_MAX];
};

static bool is_finite(struct mh_vec2 v) { return mh_finite(v.x) && mh_finite(v.y); }

static enum mh_status invert(const struct mh_sym2 *a, struct mh_sym2 *inverse)
{
    const mh_real determinant = a->xx * a->yy - a->xy * a->xy;
    if (!(a->xx > 0) || !(a->yy > 0) || !(determinant > 1e-6f * a->xx * a->yy) || !mh_finite(determinant)) {
        return MH_ERR_SINGULAR;
    }
    const mh_real scale = 1.0f / determinant;
    const struct mh_sym2 result = {a->yy * scale, -a->xy * scale, a->xx * scale};
    if (!(result.xx > 0) || !(result.yy > 0) || !mh_finite(result.xx) || !mh_finite(result.yy)) {
        return MH_ERR_SINGULAR;
    }
    *inverse = result;
    return MH_OK;
}

static struct mh_vec2 times(const struct mh_sym2 *a, struct mh_vec2 v)
{
    const struct mh_vec2 product = {a->xx * v.x + a->xy * v.y, a->xy * v.x + a->yy * v.y};
    return product;
}

/* One node's equation: r = sum of gradient . step */
static void add(const struct mh_sound *sound, const struct mh_heard *heard, const struct mh_source *sources,
                const struct mh_source_fix *at, size_t count, struct normal *normal)
{
    mh_real gradient[UNKNOWNS_MAX];
    mh_real e = 0;
    for (size_t k = 0; k < count; k++) {
        const struct mh_vec2 away = {at[k].position.x - heard->place.x, at[k].position.y - heard->place.y};
        const mh_real square = mh_max(mh_squared(away.x) + mh_squared(away.y), MH_SOUND_NEAR_M * MH_SOUND_NEAR_M);
        const mh_real inverse = 1.0f / square;
        const mh_real part = (mh_real)(1 + sources[k].besides) * sound->loudness_m2 * inverse;
        gradient[2 * k] = part * inverse * away.x;
        gradient[2 * k + 1] = part * inverse * away.y;
        e += part;
    }
    const mh_real scale = -2.0f / e;
    const mh_real weight = 1.0f / mh_sound_log_variance(sound, e);
    const mh_real weighted = weight * mh_log(mh_max(heard->energy, LEAST_ENERGY) / e);
    mh_real *element = normal->matrix;
    for (size_t i = 0; i < 2 * count; i++) {
        gradient[i] *= scale;
        normal->right[i] += weighted * gradient[i];
        const mh_real row = weight * gradient[i];
        for (size_t j = 0; j <= i; j++) {
            *element++ += row * gradient[j];
        }
    }
}

/* The share of the prior, whose information the fixes hold. */
static void add_prior(const struct mh_source *source, const struct mh_source_fix *at, size_t k, struct normal *normal)
{
    const struct mh_sym2 *information = &at->information;
    const struct mh_vec2 off = {at->position.x - source->position.x, at->position.y - source->position.y};
    const struct mh_vec2 back = times(information, off);
    const int x = (int)(2 * k), y = x + 1;
    normal->matrix[MH_PACKED(x, x)] += information->xx;
    normal->matrix[MH_PACKED(x, y)] += information->xy;
    normal->matrix[MH_PACKED(y, y)] += information->yy;
    normal->right[x] -= back.x;
    normal->right[y] -= back.y;
}

/* A step of all sources from where they are -> the longest; normal->matrix becomes the factor of the damped matrix. */
static enum mh_status iterate(const struct mh_sound *sound, const struct mh_heard *heard, size_t heard_count,
                              const struct mh_source *sources, size_t count, struct mh_source_fix *fixes,
                              struct normal *normal, mh_real *longest)
{
    const int unknowns = (int)(2 * count);
    for (int i = 0; i < MH_PACKED_SIZE(unknowns); i++) {
        normal->matrix[i] = 0;
    }
    for (int i = 0; i < unknowns; i++) {
        normal->right[i] = 0;
    }
    for (size_t i = 0; i < heard_count; i++) {
        add(sound, &heard[i], sources, fixes, count, normal);
    }
    for (size_t k = 0; k < count; k++) {
        add_prior(&sources[k], &fixes[k], k, normal);
    }
    for (int i = 0; i < unknowns; i++) {
        mh_real *diagonal = &normal->matrix[MH_PACKED(i, i)];
        *diagonal += DAMPING * *diagonal + DAMPING_LEAST;
    }
    const enum mh_status status = mh_cholesky_factor(unknowns, normal->matrix);
    if (status != MH_OK) {
        return status;
    }
    mh_cholesky_solve(unknowns, normal->matrix, normal->right);
    *longest = 0;
    for (size_t k = 0; k < count; k++) {
        struct mh_vec2 step = {normal->right[2 * k], normal->right[2 * k + 1]};
        const mh_real length = mh_sqrt(mh_squared(step.x) + mh_squared(step.y));
        if (!mh_finite(length)) {
            return MH_ERR_NOT_FINITE;
        }
        const mh_real shorter = length > MH_JOINT_STEP_M ? MH_JOINT_STEP_M / length : 1.0f;
        fixes[k].position.x += shorter * step.x;
        fixes[k].position.y += shorter * step.y;
        *longest = mh_max(*longest, length);
    }
    return MH_OK;
}

/* Covariance and what the measurements alone say of a source: the inverse of its part of the inverse, which is with the other sources eliminated, less the prior's
 * information. */
static enum mh_status conclude(size_t k, const mh_real *inverse, struct mh_source_fix *fix)
{
    const int x = (int)(2 * k), y = x + 1;
    const struct mh_sym2 prior = fix->information;
    const struct mh_sym2 covariance = {inverse[MH_PACKED(x, x)], inverse[MH_PACKED(x, y)], inverse[MH_PACKED(y, y)]};
    struct mh_sym2 both;
    const enum mh_status status = invert(&covariance, &both);
    if (status != MH_OK) {
        return status;
    }
    fix->covariance = covariance;
    fix->information.xx = mh_max(both.xx - prior.xx, 0);
    fix->information.yy = mh_max(both.yy - prior.yy, 0);
    const mh_real most = mh_sqrt(fix->information.xx * fix->information.yy);
    fix->information.xy = mh_clamp(both.xy - prior.xy, -most, most);
    return MH_OK;
}

enum mh_status mh_joint_sources(const struct mh_sound *sound, const struct mh_heard *heard, size_t heard_count,
                                const struct mh_source *sources, const struct mh_vec2 *starts, size_t count,
                                struct mh_source_fix *fixes)
{
    if (count < 1 || count > MH_SOURCES_MAX || !mh_sound_valid(sound) ||
        !(sound->source_sd > 0 || sound->background_sd > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (heard_count < 1) {
        return MH_ERR_TOO_FEW;
    }
    for (size_t i = 0; i < heard_count; i++) {
        if (!is_finite(heard[i].place) || !mh_finite(heard[i].energy)) {
            return MH_ERR_NOT_FINITE;
        }
    }
    struct mh_source_fix found[MH_SOURCES_MAX];
    for (size_t k = 0; k < count; k++) {
        found[k].position = starts ? starts[k] : sources[k].position;
        if (!is_finite(sources[k].position) || !is_finite(found[k].position)) {
            return MH_ERR_NOT_FINITE;
        }
        const enum mh_status status = invert(&sources[k].covariance, &found[k].information);
        if (status != MH_OK) {
            return status;
        }
    }
    struct normal normal;
    mh_real longest = SETTLED_M;
    for (uint8_t i = 0; i < MH_JOINT_ITERATIONS && longest >= SETTLED_M; i++) {
        const enum mh_status status = iterate(sound, heard, heard_count, sources, count, found, &normal, &longest);
        if (status != MH_OK) {
            return status;
        }
    }
    mh_cholesky_invert((int)(2 * count), normal.matrix);
    for (size_t k = 0; k < count; k++) {
        const enum mh_status status = conclude(k, normal.matrix, &found[k]);
        if (status != MH_OK) {
            return status;
        }
    }
    for (size_t k = 0; k < count; k++) {
        fixes[k] = found[k];
    }
    return MH_OK;
}
