#include "acoustic_parts.h"

#define MIRROR_M MH_REAL(25.0f)
#define MIRROR_GAIN MH_REAL(0.5f)
#define MIRROR_SLACK MH_REAL(0.25f)
#define MIRROR_SLACK_M MH_REAL(3.0f)

size_t mh_acoustic_strongest(const struct mh_acoustic_config *config, size_t count, size_t nominal)
{
    const size_t most = config->strongest > 0 ? config->strongest : nominal;
    return count < most ? count : most;
}

void mh_acoustic_state_nominal(const struct mh_acoustic_config *config, struct mh_acoustic_fix *fix)
{
    const mh_real variance = mh_squared(config->fix_sd_m);
    const struct mh_sym2 covariance = {variance, 0, variance};
    fix->covariance = covariance;
}

mh_real mh_acoustic_surprise(const struct mh_acoustic_scene *scene, const struct mh_acoustic_fix *fix)
{
    const struct mh_sym2 *P = &scene->covariance, *R = &fix->covariance;
    const mh_real xx = mh_add(P->xx, R->xx), xy = mh_add(P->xy, R->xy), yy = mh_add(P->yy, R->yy);
    const struct mh_vec2 off = mh_vec2_between(mh_acoustic_position(&scene->own), fix->position);
#if MH_REAL_FIXED
    /* products of three have no room: that of y, and of what y does not say of x */
    const mh_real across = mh_add(off.x, -mh_mul(mh_div(xy, yy), off.y));
    const mh_real variance = mh_wide_div(mh_wide_mul(xx, yy) - mh_wide_mul(xy, xy), yy);
    return mh_add(mh_wide_div(mh_wide_mul(off.y, off.y), yy), mh_wide_div(mh_wide_mul(across, across), variance));
#else
    return (yy * off.x * off.x - 2.0f * xy * off.x * off.y + xx * off.y * off.y) / (xx * yy - xy * xy);
#endif
}

static bool meets_all(const struct mh_acoustic_config *config, const struct mh_heard *heard, size_t count,
                      struct mh_vec2 point)
{
    const struct mh_distance_table exact = {config->sensing_range_m, 0, MH_DISTANCE_MIDDLE};
    for (size_t i = 0; i < count; i++) {
        const mh_real radius = mh_distance(&exact, heard[i].energy);
        const mh_real away = mh_vec2_length(mh_vec2_between(heard[i].place, point));
        if (mh_abs(away - radius) > mh_mul(MIRROR_SLACK, radius) + MIRROR_SLACK_M) {
            return false;
        }
    }
    return true;
}

void mh_acoustic_check_mirror(const struct mh_acoustic_config *config, const struct mh_acoustic_scene *scene,
                              struct mh_acoustic_fix *fix)
{
    const struct mh_distance_table exact = {config->sensing_range_m, 0, MH_DISTANCE_MIDDLE};
    const struct mh_vec2 expected = mh_acoustic_position(&scene->own);
    const size_t count = scene->heard_count < 3 ? scene->heard_count : 3;
    const struct mh_vec2 off = mh_vec2_between(expected, fix->position);
    if (!(mh_vec2_square(off) > mh_wide_mul(MIRROR_M, MIRROR_M))) {
        return;
    }
    mh_real least = mh_mul(MIRROR_GAIN, mh_vec2_length(off));
    struct mh_circle circles[3];
    for (size_t i = 0; i < count; i++) {
        circles[i].centre = scene->heard[i].place;
        circles[i].radius = mh_distance(&exact, scene->heard[i].energy);
    }
    for (size_t i = 0; i < count; i++) {
        for (size_t j = i + 1; j < count; j++) {
            struct mh_vec2 crossings[2];
            const int crossing_count = mh_crossings(&circles[i], &circles[j], crossings) ? 2 : 0;
            for (int k = 0; k < crossing_count; k++) {
                const mh_real away = mh_vec2_length(mh_vec2_between(expected, crossings[k]));
                if (away <= least && meets_all(config, scene->heard, count, crossings[k])) {
                    least = away;
                    fix->position = crossings[k];
                    fix->flags |= MH_ESTIMATE_MIRRORED;
                }
            }
        }
    }
}
