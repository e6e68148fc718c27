#include "motehound/plume_regression.h"

#include <stddef.h>

/* A place that explains all but this share of the readings cannot do better in single precision. */
#define LEAST_RESIDUAL 1e-5f

void mh_plume_regression_init(struct mh_plume_regression *regression)
{
    const struct mh_plume_regression empty = {.count = 0};
    *regression = empty;
}

void mh_plume_regression_forget(struct mh_plume_regression *regression, mh_real keep)
{
    for (uint16_t i = 0; i < MH_LEAK_PLACES_MAX; i++) {
        regression->places[i].gg *= keep;
        regression->places[i].gz *= keep;
    }
    regression->zz *= keep;
    regression->count *= keep;
}

static enum mh_status mixture(const struct mh_plume_share *plumes, uint8_t plume_count, struct mh_vec2 sensor,
                              struct mh_vec2 place, mh_real *g)
{
    mh_real sum = 0;
    for (uint8_t i = 0; i < plume_count; i++) {
        mh_real concentration;
        const enum mh_status status = mh_plume_model(&plumes[i].plume, sensor, place, 0, &concentration, NULL);
        if (status != MH_OK) {
            return status;
        }
        sum += plumes[i].share * concentration;
    }
    *g = sum;
    return MH_OK;
}

enum mh_status mh_plume_regression_take(struct mh_plume_regression *regression, const struct mh_vec2 *places,
                                        uint16_t count, const struct mh_plume_share *plumes, uint8_t plume_count,
                                        struct mh_vec2 sensor, mh_real z)
{
    if (count < 1 || count > MH_LEAK_PLACES_MAX) {
        return MH_ERR_ARGUMENT;
    }
    mh_real g[MH_LEAK_PLACES_MAX];
    for (uint16_t i = 0; i < count; i++) {
        const enum mh_status status = mixture(plumes, plume_count, sensor, places[i], &g[i]);
        if (status != MH_OK) {
            return status;
        }
        if (!mh_finite(regression->places[i].gg + g[i] * g[i]) || !mh_finite(regression->places[i].gz + g[i] * z)) {
            return MH_ERR_NOT_FINITE;
        }
    }
    if (!mh_finite(regression->zz + z * z)) {
        return MH_ERR_NOT_FINITE;
    }
    for (uint16_t i = 0; i < count; i++) {
        regression->places[i].gg += g[i] * g[i];
        regression->places[i].gz += g[i] * z;
    }
    regression->zz += z * z;
    regression->count += 1.0f;
    return MH_OK;
}

/* What place i leaves of the readings' squares, as a share; 1 where it explains nothing. */
static mh_real residual(const struct mh_plume_regression *regression, uint16_t i)
{
    const mh_real gg = regression->places[i].gg, gz = regression->places[i].gz;
    if (!(gz > 0 && gg > 0)) {
        return 1.0f;
    }
    return mh_clamp(1.0f - gz / gg * (gz / regression->zz), LEAST_RESIDUAL, 1.0f);
}

enum mh_status mh_plume_regression_solve(const struct mh_plume_regression *regression, const struct mh_vec2 *places,
                                         uint16_t count, mh_real correlation, struct mh_plume_fit *fit)
{
    if (count < 1 || count > MH_LEAK_PLACES_MAX || !(correlation >= 1.0f && mh_finite(correlation))) {
        return MH_ERR_ARGUMENT;
    }
    if (!(regression->zz > 0)) {
        return MH_NONE;
    }
    uint16_t best = 0;
    mh_real least = 1.0f;
    for (uint16_t i = 0; i < count; i++) {
        const mh_real left = residual(regression, i);
        if (left < least) {
            least = left;
            best = i;
        }
    }
    if (!(least < 1.0f)) {
        return MH_NONE;
    }
    const mh_real half_n = 0.5f * regression->count / correlation;
    mh_real sum = 0;
    struct mh_sym2 spread = {0, 0, 0};
    for (uint16_t i = 0; i < count; i++) {
        const mh_real likelihood = mh_exp(-half_n * mh_log(residual(regression, i) / least));
        const mh_real x = places[i].x - places[best].x, y = places[i].y - places[best].y;
        sum += likelihood;
        spread.xx += likelihood * x * x;
        spread.xy += likelihood * x * y;
        spread.yy += likelihood * y * y;
    }
    fit->place = best;
    fit->rate = regression->places[best].gz / regression->places[best].gg;
    fit->likelihood = 1.0f / sum;
    fit->spread.xx = spread.xx / sum;
    fit->spread.xy = spread.xy / sum;
    fit->spread.yy = spread.yy / sum;
    return MH_OK;
}
