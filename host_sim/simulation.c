#include "simulation.h"

#include "network.h"
#include "world/field.h"
#include "world/sensor.h"

#include <stdio.h>
#include <stdlib.h>

struct run {
    const struct observer *observer;
    struct deployment deployment;
    struct field field;
    struct sensors sensors;
    double *concentrations;
    int32_t *counts;
    struct network network;
    sim_time interval;
    uint64_t instants, next; /* in all, and the one to come */
};

static struct truth truth_at(const struct run *run, double time_s)
{
    struct truth truth = {.time_s = time_s, .present = time_s >= 0 && time_s <= run->field.trajectory.duration_s};
    if (truth.present) {
        const struct point p = trajectory_position(&run->field.trajectory, time_s);
        truth.x_m = p.x_m;
        truth.y_m = p.y_m;
    }
    return truth;
}

static void report(void *context, double now_s, double time_s, const struct mh_estimate *estimate)
{
    const struct run *run = context;
    if (run->observer->estimate) {
        const struct truth at_time = truth_at(run, time_s), at_arrival = truth_at(run, time_s - (double)estimate->age);
        run->observer->estimate(run->observer->context, now_s, estimate, &at_time, &at_arrival);
    }
}

static int sample(void *context)
{
    struct run *run = context;
    const uint64_t instant = run->next++;
    const double time_s = network_time_s(&run->network);
    if (run->observer->truth) {
        const struct truth truth = truth_at(run, time_s);
        run->observer->truth(run->observer->context, &truth);
    }
    if (field_prepare(&run->field, time_s)) {
        return -1;
    }
    for (size_t i = 0; i < run->deployment.count; i++) {
        const struct recorded_node *node = &run->deployment.nodes[i];
        run->concentrations[i] = field_concentration(&run->field, node->x_m, node->y_m);
    }
    sensors_read(&run->sensors, instant, run->concentrations, run->counts);
    for (size_t i = 0; i < run->deployment.count; i++) {
        if (!sensors_lost(&run->sensors, instant, time_s, i)) {
            network_reading(&run->network, (uint32_t)i, run->counts[i], 0);
        }
    }
    return run->next < run->instants ? network_schedule(&run->network, run->next * run->interval) : 0;
}

static int bring_up(struct run *run, const struct scenario *scenario, uint64_t seed, char *error, size_t error_size)
{
    const struct mh_place far_corner = place_from_metres(scenario->field.width_m, scenario->field.height_m, 0);
    const struct mh_region region = {0, far_corner.x_mm, 0, far_corner.y_mm};
    struct network_config config = {.scenario = scenario,
                                    .deployment = &run->deployment,
                                    .sensor = sensor_config(scenario),
                                    .range_m = scenario->radio.range_m,
                                    .seed = seed,
                                    .observer = run->observer,
                                    .context = run,
                                    .instant = sample,
                                    .report = report};
    if (deployment_make(&run->deployment, scenario, seed, error, error_size) ||
        field_make(&run->field, scenario, error, error_size) ||
        tracker_choose(scenario, &region, &config.tracker, error, error_size) ||
        protocol_choose(scenario->network.protocol, scenario, &config.protocol, error, error_size)) {
        return -1;
    }
    if (config.tracker.measures != QUANTITY_CONCENTRATION) {
        snprintf(error, error_size, "tracker.name: `%s` works on ranges, a diffusing source gives concentrations",
                 scenario->tracker.name);
        return -1;
    }
    if (config.sensor.interval < 1) {
        snprintf(error, error_size, "sensor.interval_s: %g, expected at least 0.001", scenario->sensor.interval_s);
        return -1;
    }
    run->interval = (sim_time)config.sensor.interval * (SIM_TIME_PER_S / MH_TICKS_PER_S);
    run->instants = (sim_time)(run->field.trajectory.duration_s * SIM_TIME_PER_S + 1e-3) / run->interval + 1;
    run->concentrations = malloc(run->deployment.count * sizeof *run->concentrations);
    run->counts = malloc(run->deployment.count * sizeof *run->counts);
    if (!run->concentrations || !run->counts || sensors_make(&run->sensors, scenario, seed, run->deployment.count)) {
        snprintf(error, error_size, "out of memory for %zu nodes", run->deployment.count);
        return -1;
    }
    if (network_make(&run->network, &config, error, error_size)) {
        return -1;
    }
    if (network_schedule(&run->network, 0)) {
        snprintf(error, error_size, "out of memory");
        return -1;
    }
    return 0;
}

static void tear_down(struct run *run)
{
    network_free(&run->network);
    sensors_free(&run->sensors);
    free(run->counts);
    free(run->concentrations);
    field_free(&run->field);
    deployment_free(&run->deployment);
}

int simulation_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                   const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                   size_t error_size)
{
    struct run run = {.observer = observer};
    int result = bring_up(&run, scenario, seed, error, error_size);
    if (result == 0) {
        /* The head waits for the last instant's measurements less than one interval. */
        result = network_run(&run.network, run.instants * run.interval, stop, error, error_size);
        *counters = (struct simulation_counters){.samples = run.next};
        network_count(&run.network, counters);
    }
    tear_down(&run);
    return result;
}
