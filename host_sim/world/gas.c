#include "world/gas.h"

#include "world/recipe.h"

#include <math.h>

static const double pi = 3.141592653589793;
static const double near_m = 1; /* of the source, where the model has its singularity */

struct gas gas_of(const struct scenario *scenario, uint64_t seed)
{
    return (struct gas){.rate_mlps = scenario->source.rate_mlps,
                        .mixing_m2ps = scenario->source.mixing_m2ps,
                        .wind_mps = scenario->wind.speed_mps,
                        .downwind_x = cos(scenario->wind.direction_rad),
                        .downwind_y = sin(scenario->wind.direction_rad),
                        .fluctuation = scenario->source.fluctuation,
                        .noise_ppm = scenario->sensor.noise_ppm,
                        .unit_ppm = scenario->sensor.unit_ppm,
                        .seed = seed};
}

/* Of a release of 1. */
static double share_of(const struct gas *gas, double x, double y, double distance_m)
{
    const double along_m = x * gas->downwind_x + y * gas->downwind_y;
    return exp(-gas->wind_mps / (2 * gas->mixing_m2ps) * (distance_m - along_m)) /
           (2 * pi * gas->mixing_m2ps * distance_m);
}

double gas_mean_ppm(const struct gas *gas, struct point source, struct point place)
{
    const double x = place.x_m - source.x_m, y = place.y_m - source.y_m;
    return gas->rate_mlps * share_of(gas, x, y, fmax(hypot(x, y), near_m));
}

void gas_gradient(const struct gas *gas, struct point source, struct point place, double gradient[3])
{
    const double x = place.x_m - source.x_m, y = place.y_m - source.y_m;
    const double distance_m = hypot(x, y), d = fmax(distance_m, near_m);
    const double share = share_of(gas, x, y, d), ppm = gas->rate_mlps * share;
    const double decay = gas->wind_mps / (2 * gas->mixing_m2ps);
    const bool near = distance_m < near_m;
    const double nx = near ? 0 : x / d, ny = near ? 0 : y / d, fall = near ? 0 : 1 / d;
    gradient[0] = ppm * (nx * fall + decay * (nx - gas->downwind_x));
    gradient[1] = ppm * (ny * fall + decay * (ny - gas->downwind_y));
    gradient[2] = share;
}

double gas_reading(const struct gas *gas, struct point source, double time_s, uint32_t node, struct point place)
{
    const uint64_t moment = ((uint64_t)llround(time_s * 1e3) << 20) + node;
    const double variance = log1p(gas->fluctuation * gas->fluctuation);
    const double fluctuation = sqrt(variance) * recipe_normal(gas->seed, RECIPE_GAS_FLUCTUATION, moment) - variance / 2;
    const double noise_ppm = gas->noise_ppm * recipe_normal(gas->seed, RECIPE_GAS_NOISE, moment);
    return (gas_mean_ppm(gas, source, place) * exp(fluctuation) + noise_ppm) / gas->unit_ppm;
}
