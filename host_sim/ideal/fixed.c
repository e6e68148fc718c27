#include "ideal/fixed.h"

#include "engine/random.h"
#include "reals.h"
#include "roster.h"
#include "world/ranging.h"
#include "world/trajectory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct run {
    const struct scenario *scenario;
    const struct observer *observer;
    struct deployment deployment;
    struct clusters clusters;
    struct trajectory path;
    struct ranging ranging;
    struct tracker_choice tracker;
    struct centre_choice centre;
    struct random_stream losses;
    size_t heads;                       /* one for each cluster; one in all where there is no centre */
    void *tracks[SCENARIO_NUMBERS_MAX]; /* of each */
    void *centre_state;
    struct mh_measurement *sampled, *heard; /* at this instant: by all nodes, and by a head's */
    size_t sampled_count;
    uint64_t sample, report_every; /* sampling instants */
    struct truth truth;
    uint64_t measurements;
    struct mh_fixed_counters counters;
};

static mh_tick now(const struct run *run) { return (mh_tick)llround(run->truth.time_s * MH_TICKS_PER_S); }

static mh_node_id sink_of(const struct run *run) { return run->deployment.nodes[run->deployment.count - 1].id + 1; }

static void take_samples(struct run *run)
{
    run->sampled_count = 0;
    for (uint32_t i = 0; i < run->deployment.count; i++) {
        const struct recorded_node *node = &run->deployment.nodes[i];
        const double distance_m = hypot(node->x_m - run->truth.x_m, node->y_m - run->truth.y_m);
        double range_m;
        if (run->sample % run->clusters.nodes[i].period == 0 &&
            ranging_detects(&run->ranging, run->sample, i, distance_m, &range_m)) {
            run->sampled[run->sampled_count++] =
                (struct mh_measurement){.node = node->id,
                                        .place = place_from_metres(node->x_m, node->y_m, node->z_m),
                                        .time = now(run),
                                        .value = q20_of(range_m)};
        }
    }
}

static enum mh_status step(struct run *run, size_t head, struct mh_estimate *estimate)
{
    size_t count = 0;
    for (size_t i = 0; i < run->sampled_count; i++) {
        if (run->centre.centre == NULL ||
            clusters_hear(&run->clusters, head, deployment_find(&run->deployment, run->sampled[i].node))) {
            run->heard[count++] = run->sampled[i];
        }
    }
    run->measurements += count;
    return run->tracker.tracker->step(run->tracks[head], now(run), run->heard, count, estimate);
}

static void tell(const struct run *run, const struct mh_estimate *estimate)
{
    const struct observer *observer = run->observer;
    if (observer->estimate) {
        observer->estimate(observer->context, run->truth.time_s, sink_of(run), estimate, &run->truth, &run->truth);
    }
}

static void tell_local(const struct run *run, size_t head, const struct mh_estimate *estimate)
{
    const struct observer *observer = run->observer;
    if (observer->local) {
        const mh_node_id node = run->deployment.nodes[clusters_first(&run->clusters, head)].id;
        observer->local(observer->context, run->truth.time_s, (uint8_t)head, node, estimate, &run->truth);
    }
}

/* What the cluster has goes to the centre, unless it is lost. */
static void report(struct run *run, size_t head)
{
    const struct mh_tracker *tracker = run->tracker.tracker;
    uint8_t bytes[MH_SUMMARY_BYTES_MAX];
    size_t length;
    if (tracker->summarise(run->tracks[head], now(run), bytes, &length) != MH_OK) {
        return;
    }
    run->counters.summaries++;
    if (random_uniform(run->losses, run->sample * run->heads + head) < run->scenario->fusion.report_loss) {
        return;
    }
    const enum mh_status status = run->centre.centre->take(run->centre_state, (uint8_t)head, now(run), bytes, length);
    if (status == MH_OK || status == MH_ERR_REPEATED) {
        tracker->summary_taken(run->tracks[head], now(run));
        run->counters.taken++;
    }
}

static void feed_back(struct run *run)
{
    uint8_t bytes[MH_SUMMARY_BYTES_MAX];
    size_t length;
    if (run->centre.centre->feedback(run->centre_state, bytes, &length) == MH_OK) {
        for (size_t head = 0; head < run->heads; head++) {
            const bool corrected = run->tracker.tracker->correct(run->tracks[head], now(run), bytes, length) == MH_OK;
            run->counters.corrected += corrected;
            run->counters.uncorrected += !corrected;
        }
    }
}

static void sample(struct run *run)
{
    const double time_s = (double)run->sample * run->scenario->sensor.interval_s;
    const struct point p = trajectory_position(&run->path, time_s), v = trajectory_velocity(&run->path, time_s);
    const bool reports = run->sample % run->report_every == 0;
    run->truth =
        (struct truth){.time_s = time_s, .x_m = p.x_m, .y_m = p.y_m, .present = true, .vx_mps = v.x_m, .vy_mps = v.y_m};
    if (run->observer->truth) {
        run->observer->truth(run->observer->context, &run->truth);
    }
    if (run->sample == 0) {
        return; /* all that is known then is the start */
    }
    take_samples(run);
    for (size_t head = 0; head < run->heads; head++) {
        struct mh_estimate estimate;
        const bool known = step(run, head, &estimate) == MH_OK && reports;
        if (known && run->centre.centre != NULL) {
            tell_local(run, head, &estimate);
            report(run, head);
        } else if (known) {
            tell(run, &estimate);
        }
    }
    struct mh_estimate fused;
    if (reports && run->centre.centre != NULL &&
        run->centre.centre->fuse(run->centre_state, now(run), &fused) == MH_OK) {
        run->counters.fused++;
        tell(run, &fused);
        feed_back(run);
    }
}

static int begin(struct run *run, char *error, size_t error_size)
{
    const struct mh_tracker *tracker = run->tracker.tracker;
    const mh_tick interval = (mh_tick)lround(run->scenario->sensor.interval_s * MH_TICKS_PER_S);
    if (tracker->summarise == NULL) {
        snprintf(error, error_size, "tracker.name: `%s`, expected cv_ukf or cv_ekf for network.protocol fixed",
                 tracker->name);
        return -1;
    }
    snprintf(error, error_size, "out of memory");
    run->sampled = calloc(2 * run->deployment.count, sizeof *run->sampled);
    if (!run->sampled) {
        return -1;
    }
    run->heard = run->sampled + run->deployment.count;
    for (size_t head = 0; head < run->heads; head++) {
        run->tracks[head] = malloc(tracker->state_size);
        if (!run->tracks[head]) {
            return -1;
        }
        if (tracker->init(run->tracks[head], &run->tracker.config, interval) != MH_OK) {
            snprintf(error, error_size, "tracker %s: a setting is outside its range", tracker->name);
            return -1;
        }
    }
    if (run->centre.centre != NULL) {
        run->centre_state = malloc(run->centre.centre->state_size);
        if (!run->centre_state) {
            return -1;
        }
        if (run->centre.centre->init(run->centre_state, &run->centre.config) != MH_OK) {
            snprintf(error, error_size, "fusion: a setting is outside its range");
            return -1;
        }
    }
    return 0;
}

static int make(struct run *run, uint64_t seed, char *error, size_t error_size)
{
    const struct scenario *scenario = run->scenario;
    const struct scenario_field field = scenario_field(scenario);
    const struct mh_place corner = place_from_metres(field.width_m, field.height_m, 0);
    const struct mh_region region = {0, corner.x_mm, 0, corner.y_mm};
    if (clusters_make(&run->clusters, scenario, error, error_size) ||
        deployment_make(&run->deployment, scenario, seed, error, error_size) ||
        trajectory_make(&run->path, scenario, seed, error, error_size) ||
        tracker_choose(scenario, &region, &run->tracker, error, error_size)) {
        return -1;
    }
    tracker_tell_clusters(&run->tracker, &run->clusters);
    centre_choose(scenario, run->clusters.count, &run->centre);
    run->ranging = ranging_of(scenario, &run->clusters, seed);
    run->losses = random_stream(seed, RANDOM_SUMMARIES);
    run->report_every = (uint64_t)llround(scenario->fusion.report_s / scenario->sensor.interval_s);
    run->heads = run->centre.centre != NULL ? run->clusters.count : 1;
    return begin(run, error, error_size);
}

static void tear_down(struct run *run)
{
    for (size_t head = 0; head < run->heads; head++) {
        free(run->tracks[head]);
    }
    free(run->centre_state);
    free(run->sampled);
    trajectory_free(&run->path);
    deployment_free(&run->deployment);
}

static void tell_nodes(const struct run *run)
{
    const struct observer *observer = run->observer;
    const struct scenario_field field = scenario_field(run->scenario);
    for (size_t i = 0; observer->node && i < run->deployment.count; i++) {
        const struct recorded_node *node = &run->deployment.nodes[i];
        const struct mh_place place = place_from_metres(node->x_m, node->y_m, node->z_m);
        observer->node(observer->context, node->id, &place);
    }
    if (observer->node) {
        const struct mh_place place = place_from_metres(field.sink_x_m, field.sink_y_m, 0);
        observer->node(observer->context, sink_of(run), &place);
    }
}

int ideal_fixed_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                    const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                    size_t error_size)
{
    struct run run = {.scenario = scenario, .observer = observer};
    int result = make(&run, seed, error, error_size);
    if (result == 0) {
        tell_nodes(&run);
    }
    const uint64_t samples = scenario_steps(scenario) + 1;
    while (result == 0 && run.sample < samples) {
        if (stop && *stop) {
            snprintf(error, error_size, "stopped");
            result = -1;
        } else {
            sample(&run);
            run.sample++;
        }
    }
    if (result == 0) {
        const double none = (double)NAN;
        *counters = (struct simulation_counters){.samples = run.sample,
                                                 .head.measurements = (uint32_t)run.measurements,
                                                 .protocol.fixed = run.counters,
                                                 .energy = energy_total_unknown(),
                                                 .clock_error_median_ms = none,
                                                 .clock_error_p99_ms = none,
                                                 .clock_known_share = none};
    }
    tear_down(&run);
    return result;
}
