/* The published paths and the published field of a ranged target, as the scenarios of these tests. */
#ifndef SCENARIOS_H
#define SCENARIOS_H

#include "scenario/scenario.h"

static struct waypoint e1_points[] = {{0, 0, 0}, {38, 78, 1}};
static struct waypoint e2_points[] = {{1, 1, 0},     {20, 12, 1.0}, {45, 18, 2.0},  {52, 42, 0.8},
                                      {28, 46, 1.6}, {20, 64, 0.6}, {14.5, 80, 1.5}};

static inline struct scenario e1(void)
{
    static char luo[] = "luo", collection[] = "collection", mica2[] = "mica2";
    return (struct scenario){
        .field = {80, 80},
        .energy = {.profile = mica2, .sink_mains = true},
        .source = {.path = PATH_ARCS,
                   .points = e1_points,
                   .points_count = 2,
                   .speed_mps = 1,
                   .release_gps = 100,
                   .release_period_s = 30,
                   .diffusion_m2ps = 1},
        .network = {.nodes = 1280, .layout = LAYOUT_UNIFORM, .sink_x_m = 40, .sink_y_m = 40, .protocol = collection},
        .sensor = {.interval_s = 1, .full_scale = 64},
        .radio = {.range_m = 15, .delay_s = 0.002, .bitrate_bps = 250000, .profile = "ideal", .queue = 8},
        .tracker = {.name = luo,
                    .diffusion_m2ps = 1,
                    .chi = 0.2,
                    .release_gps = 100,
                    .additive_sd = 0.05,
                    .relative_sd = 0.05,
                    .forgetting = 0.97,
                    .range_sd_m = 0.1,
                    .acceleration_sd_mps2 = 1},
    };
}

static inline struct scenario e2(void)
{
    struct scenario scenario = e1();
    scenario.source.path = PATH_WAYPOINTS;
    scenario.source.points = e2_points;
    scenario.source.points_count = 7;
    return scenario;
}

/* Of a scenario that scenario_init has filled: a ranged target walks for two hours among 1,000 nodes. */
static inline void walk_among_nodes(struct scenario *scenario)
{
    scenario->source.path = PATH_GAUSS_MARKOV;
    scenario->source.duration_s = 7200;
    scenario->sensor.interval_s = 2;
    scenario->sensor.quantity = QUANTITY_RANGE;
    scenario->network.nodes = 1000;
    scenario->network.layout = LAYOUT_HASHED;
    scenario->network.density = 12;
}

#endif
