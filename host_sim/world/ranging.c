#include "world/ranging.h"

#include "world/recipe.h"

#include <math.h>

struct ranging ranging_of(const struct scenario *scenario, const struct clusters *clusters, uint64_t seed)
{
    return (struct ranging){.range_m = scenario->sensor.range_m,
                            .noise_m = scenario->sensor.range_noise_m,
                            .clusters = clusters != NULL && clusters->count > 0 ? clusters : NULL,
                            .correlation = scenario->sensor.noise_correlation,
                            .noisy = scenario->sensor.noisy_detection,
                            .seed = seed};
}

/* The noise of a node's range, m. */
static double noise(const struct ranging *ranging, uint64_t sample, uint32_t node)
{
    const uint64_t everybody = UINT32_MAX; /* no node has this number */
    const uint64_t purpose = RECIPE_RANGE_NOISE + sample;
    const double sd_m =
        ranging->clusters != NULL ? sqrt(ranging->clusters->nodes[node].range_variance_m2) : ranging->noise_m;
    const double own = recipe_normal(ranging->seed, purpose, node);
    if (ranging->correlation <= 0) {
        return sd_m * own;
    }
    const double common = recipe_normal(ranging->seed, purpose, everybody);
    return sd_m * (sqrt(1 - ranging->correlation) * own + sqrt(ranging->correlation) * common);
}

bool ranging_detects(const struct ranging *ranging, uint64_t sample, uint32_t node, double distance_m, double *range_m)
{
    const double farthest_noise = 9; /* |g| <= sqrt(-2 ln 2^-54) = 8.7 */
    if (distance_m > ranging->range_m + (ranging->noisy ? farthest_noise * ranging->noise_m : 0)) {
        return false;
    }
    const double measured = distance_m + noise(ranging, sample, node);
    if (ranging->noisy && measured > ranging->range_m) {
        return false;
    }
    *range_m = measured;
    return true;
}
