#include "world/ranging.h"

#include "world/recipe.h"

#include <math.h>

struct ranging ranging_of(const struct scenario *scenario, uint64_t seed)
{
    return (struct ranging){.range_m = scenario->sensor.range_m,
                            .noise_m = scenario->sensor.range_noise_m,
                            .noisy = scenario->sensor.noisy_detection,
                            .seed = seed};
}

bool ranging_detects(const struct ranging *ranging, uint64_t sample, uint32_t node, double distance_m, double *range_m)
{
    const double farthest_noise = 9; /* |g| <= sqrt(-2 ln 2^-54) = 8.7 */
    if (distance_m > ranging->range_m + (ranging->noisy ? farthest_noise * ranging->noise_m : 0)) {
        return false;
    }
    const double measured =
        distance_m + ranging->noise_m * recipe_normal(ranging->seed, RECIPE_RANGE_NOISE + sample, node);
    if (ranging->noisy && measured > ranging->range_m) {
        return false;
    }
    *range_m = measured;
    return true;
}
