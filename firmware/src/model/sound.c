#include "motehound/sound.h"

bool mh_sound_valid(const struct mh_sound *sound)
{
    return mh_within(sound->loudness_m2, 1, 1e8f) && mh_within(sound->source_sd, 0, 1000) &&
           mh_within(sound->background_sd, 0, 1000) && mh_max(sound->source_sd, sound->background_sd) >= 0.001f;
}

mh_real mh_sound_detected(const struct mh_sound_detection *detection, mh_real distance_m)
{
    const mh_real beyond = distance_m - (detection->range_m - detection->margin_m);
    if (beyond <= 0) {
        return 1;
    }
    if (distance_m > detection->range_m + detection->margin_m) {
        return 0;
    }
    return mh_exp(-detection->lambda * mh_exp(detection->beta * mh_log(beyond)));
}
