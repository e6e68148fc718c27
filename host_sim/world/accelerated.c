#include "world/accelerated.h"

#include "engine/random.h"

struct accelerated accelerated_of(const struct scenario *scenario)
{
    return (struct accelerated){
        .interval_s = scenario->sensor.interval_s,
        .mean = {scenario->target.x_m, scenario->target.y_m},
        .mean_velocity = {scenario->target.vx_mps, scenario->target.vy_mps},
        .position_sd_m = scenario->target.position_sd_m,
        .velocity_sd_mps = scenario->target.velocity_sd_mps,
        .acceleration_sd = {scenario->target.acceleration_x_mps2, scenario->target.acceleration_y_mps2}};
}

void accelerated_states(const struct accelerated *target, uint64_t seed, size_t steps, struct accelerated_state *states)
{
    const struct random_stream stream = random_stream(seed, RANDOM_TARGET);
    const double T = target->interval_s;
    double g[4];
    random_normals(stream, 0, 4, g);
    states[0] = (struct accelerated_state){
        .at = {target->mean.x_m + target->position_sd_m * g[0], target->mean.y_m + target->position_sd_m * g[1]},
        .velocity = {target->mean_velocity.x_m + target->velocity_sd_mps * g[2],
                     target->mean_velocity.y_m + target->velocity_sd_mps * g[3]}};
    for (size_t k = 0; k < steps; k++) {
        struct accelerated_state *now = &states[k];
        random_normals(stream, 4 + 2 * k, 2, g);
        now->acceleration = (struct point){target->acceleration_sd.x_m * g[0], target->acceleration_sd.y_m * g[1]};
        states[k + 1] = (struct accelerated_state){
            .at = {now->at.x_m + T * (now->velocity.x_m + T / 2 * now->acceleration.x_m),
                   now->at.y_m + T * (now->velocity.y_m + T / 2 * now->acceleration.y_m)},
            .velocity = {now->velocity.x_m + T * now->acceleration.x_m, now->velocity.y_m + T * now->acceleration.y_m}};
    }
}
