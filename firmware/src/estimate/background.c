#include "motehound/background.h"

enum mh_status mh_background_take(struct mh_background *background, const struct mh_background_config *config,
                                  mh_real reading, mh_real *excess)
{
    if (!mh_finite(reading)) {
        return MH_ERR_NOT_FINITE;
    }
    if (!background->known) {
        background->known = true;
        background->level = reading;
    }
    const mh_real level = background->level;
    if (reading > level) {
        background->level = mh_min(level + config->quantile * config->step, reading);
    } else {
        background->level = mh_max(level - (1.0f - config->quantile) * config->step, reading);
    }
    *excess = reading - level;
    return MH_OK;
}
