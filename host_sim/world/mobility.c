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

struct mobility_state mobility_start(const struct mobility *m, uint64_t seed)
{
    const double room_x_m = m->width_m - 2 * m->margin_m, room_y_m = m->height_m - 2 * m->margin_m;
    const double heading_rad = 2 * pi * recipe_uniform(seed, RECIPE_START, 2);
    return (struct mobility_state){.at = {m->margin_m + room_x_m * recipe_uniform(seed, RECIPE_START, 0),
                                          m->margin_m + room_y_m * recipe_uniform(seed, RECIPE_START, 1)},
                                   .speed_mps = m->speed_mps,
                                   .heading_rad = heading_rad,
                                   .mean_heading_rad = heading_rad};
}

void mobility_step(const struct mobility *m, double speed_disturbance, double heading_disturbance,
                   struct mobility_state *state)
{
    const double blur = sqrt(1 - m->memory * m->memory);
    double heading = state->heading_rad, mean_heading = state->mean_heading_rad;
    struct point at = {state->at.x_m + m->interval_s * state->speed_mps * cos(heading),
                       state->at.y_m + m->interval_s * state->speed_mps * sin(heading)};
    const bool reflected_x = reflect(&at.x_m, m->margin_m, m->width_m);
    const bool reflected_y = reflect(&at.y_m, m->margin_m, m->height_m);
    if (reflected_x) {
        heading = pi - heading;
        mean_heading = pi - mean_heading;
    }
    if (reflected_y) {
        heading = -heading;
        mean_heading = -mean_heading;
    }
    const double speed =
        m->memory * state->speed_mps + (1 - m->memory) * m->speed_mps + blur * m->speed_sd_mps * speed_disturbance;
    *state = (struct mobility_state){
        .at = at,
        .speed_mps = fmin(fmax(speed, MOBILITY_SLOWEST * m->speed_mps), MOBILITY_FASTEST * m->speed_mps),
        .heading_rad =
            m->memory * heading + (1 - m->memory) * mean_heading + blur * m->heading_sd_rad * heading_disturbance,
        .mean_heading_rad = mean_heading,
        .reflected_x = reflected_x,
        .reflected_y = reflected_y};
}

void mobility_next(const struct mobility *m, uint64_t seed, size_t n, struct mobility_state *state)
{
    mobility_step(m, recipe_normal(seed, RECIPE_SPEED, n), recipe_normal(seed, RECIPE_HEADING, n), state);
}

void mobility_positions(const struct mobility *m, uint64_t seed, size_t steps, struct point *positions)
{
    struct mobility_state state = mobility_start(m, seed);
    positions[0] = state.at;
    for (size_t n = 1; n <= steps; n++) {
        mobility_next(m, seed, n, &state);
        positions[n] = state.at;
    }
}
