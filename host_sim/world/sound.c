#include "world/sound.h"

#include "world/recipe.h"

#include <math.h>

static const double near_sq_m2 = 1;

struct sound sound_of(const struct scenario *scenario, uint64_t seed)
{
    return (struct sound){.range_m = scenario->sensor.range_m,
                          .source_noise = scenario->sensor.source_noise,
                          .background_noise = scenario->sensor.background_noise,
                          .seed = seed};
}

double sound_energy(const struct sound *sound, const struct targets *targets, double time_s, struct point place)
{
    double energy = 0;
    for (size_t i = 0; i < targets->count; i++) {
        const struct target_state state = targets_at(targets, i, time_s);
        const double x = place.x_m - state.at.x_m, y = place.y_m - state.at.y_m;
        if (state.present) {
            energy += targets->list[i].loudness * sound->range_m * sound->range_m / fmax(x * x + y * y, near_sq_m2);
        }
    }
    return energy;
}

double sound_reading(const struct sound *sound, const struct targets *targets, double time_s, uint32_t node,
                     struct point place)
{
    const uint64_t moment = ((uint64_t)llround(time_s * 1e3) << 20) + node;
    const double source = sound->source_noise * recipe_normal(sound->seed, RECIPE_SOUND_SOURCE, moment);
    const double background = sound->background_noise * recipe_normal(sound->seed, RECIPE_SOUND_BACKGROUND, moment);
    return sound_energy(sound, targets, time_s, place) * exp(source) + background;
}
