/* Gauss-Markov mobility in a rectangle (Camp, Boleng and Davies, "A survey of mobility models for ad hoc network research", 2002, Eq. (1)
 * and (2)): at each step speed and heading are drawn back to their means and disturbed,
 *
 *   s <- alpha s + (1 - alpha) mean + sqrt(1 - alpha^2) sd g        and d likewise,
 *
 * so that their deviations stay as wide as sd whatever alpha. The target is reflected at a margin inside the border, its mean heading
 * too; its speed is kept within the bounds below; the heading is never wrapped. */
#ifndef MOTEHOUND_SIM_MOBILITY_H
#define MOTEHOUND_SIM_MOBILITY_H

#include "world/recipe.h"
#include "world/trajectory.h"

#include <stdbool.h>
#include <stddef.h>

#define MOBILITY_SLOWEST 0.1 /* of the mean speed */
#define MOBILITY_FASTEST 1.9

struct mobility {
    double width_m, height_m, margin_m;
    double interval_s; /* of a step */
    double speed_mps, speed_sd_mps;
    double heading_sd_rad;
    double memory; /* alpha, 0 to 1 */
};

/* That of scenario->target: a step each sensor.interval_s, the margin sensor.range_m so that nodes lie all around it. */
struct mobility mobility_of(const struct scenario *scenario);

/* Where it is and how it moves there. */
struct mobility_state {
    struct point at;
    double speed_mps;
    double heading_rad, mean_heading_rad;
    bool reflected_x, reflected_y; /* by the step that led here */
};

/* At step 0: place and mean heading are the recipe's for `seed`, speed and heading their means. */
struct mobility_state mobility_start(const struct mobility *mobility, uint64_t seed);

/* One step on, disturbed by the standard normal numbers given. A step is shorter than the way between the margins. */
void mobility_step(const struct mobility *mobility, double speed_disturbance, double heading_disturbance,
                   struct mobility_state *state);

/* Step `n`, from 1, with the recipe's disturbances for `seed`. */
void mobility_next(const struct mobility *mobility, uint64_t seed, size_t n, struct mobility_state *state);

/* Its place at steps 0 ... steps, so positions holds steps + 1 of them. */
void mobility_positions(const struct mobility *mobility, uint64_t seed, size_t steps, struct point *positions);

#endif
