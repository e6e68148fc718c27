#include "world/mobility.h"

#include <math.h>

static const double pi = 3.141592653589793;
static const double mph_mps = 0.44704;

struct mobility mobility_of(const struct scenario *scenario)
{
    const struct scenario_field field = scenario_field(scenario);
    const double speed_mps = scenario->target.speed_mph * mph_mps;
    return (struct mobility){.width_m = field.width_m,
                             .height_m = field.height_m,
                             .margin_m = scenario->sensor.range_m,
                             .interval_s = scenario->sensor.interval_s,
                             .speed_mps = speed_mps,
                             .speed_sd_mps = scenario->target.speed_sd * speed_mps,
                             .heading_sd_rad = scenario->target.heading_sd_rad,
                             .memory = scenario->target.memory};
}

/* One coordinate off the wall that it has passed, if any. */
static bool reflect(double *coordinate, double margin, double side)
{
    if (*coordinate < margin) {
        *coordinate = 2 * margin - *coordinate;
        return true;
    }
    if (*coordinate > side - margin) {
        *coordinate = 2 * (side - margin) - *coordinate;
        return true;
    }
    return false;
}

void mobility_positions(const struct mobility *m, uint64_t seed, size_t steps, struct point *positions)
{
    const double blur = sqrt(1 - m->memory * m->memory);
    double mean_heading = 2 * pi * recipe_uniform(seed, RECIPE_START, 2);
    double speed = m->speed_mps, heading = mean_heading;
    struct point at = {m->margin_m + (m->width_m - 2 * m->margin_m) * recipe_uniform(seed, RECIPE_START, 0),
                       m->margin_m + (m->height_m - 2 * m->margin_m) * recipe_uniform(seed, RECIPE_START, 1)};
    positions[0] = at;
    for (size_t n = 1; n <= steps; n++) {
        at.x_m += m->interval_s * speed * cos(heading);
        at.y_m += m->interval_s * speed * sin(heading);
        if (reflect(&at.x_m, m->margin_m, m->width_m)) {
            heading = pi - heading;
            mean_heading = pi - mean_heading;
        }
        if (reflect(&at.y_m, m->margin_m, m->height_m)) {
            heading = -heading;
            mean_heading = -mean_heading;
        }
        speed = m->memory * speed + (1 - m->memory) * m->speed_mps +
                blur * m->speed_sd_mps * recipe_normal(seed, RECIPE_SPEED, n);
        speed = fmin(fmax(speed, MOBILITY_SLOWEST * m->speed_mps), MOBILITY_FASTEST * m->speed_mps);
        heading = m->memory * heading + (1 - m->memory) * mean_heading +
                  blur * m->heading_sd_rad * recipe_normal(seed, RECIPE_HEADING, n);
        positions[n] = at;
    }
}
