#include "motehound/sound.h"

bool mh_sound_valid(const struct mh_sound *sound)
{
    return mh_within(sound->loudness_m2, MH_REAL(1.0f), MH_REAL_UPTO(1e8f)) &&
           mh_within(sound->source_sd, 0, MH_REAL(1000.0f)) && mh_within(sound->background_sd, 0, MH_REAL(1000.0f)) &&
           mh_max(sound->source_sd, sound->background_sd) >= MH_REAL(0.001f);
}

mh_real mh_sound_detected(const struct mh_sound_detection *detection, mh_real distance_m)
{
    const mh_real beyond = distance_m - (detection->range_m - detection->margin_m);
    if (beyond <= 0) {
        return MH_REAL(1.0f);
    }
    if (distance_m > detection->range_m + detection->margin_m) {
        return 0;
    }
    return mh_exp(mh_mul(-detection->lambda, mh_exp(mh_mul(detection->beta, mh_log(beyond)))));
}
