#include "ideal/token.h"

#include "ideal/vicinity.h"
#include "reals.h"
#include "roster.h"
#include "world/campaign.h"
#include "world/gas.h"
#include "world/trajectory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct run {
    const struct scenario *scenario;
    const struct observer *observer;
    struct deployment deployment;
    struct vicinity vicinity;
    struct trajectory path;
    struct gas gas;
    struct tracker_choice tracker;
    mh_tick interval;
    void *state;                  /* of the tracker at the head */
    struct mh_measurement *heard; /* room for every node; so below */
    size_t count;
    mh_node_id *members;
    struct mh_place *places;

    uint32_t head;
    struct truth truth;
    uint64_t heads, calm; /* so far, and of these in succession */
    uint32_t samples;
};

static void take_sample(struct run *run, uint32_t node)
{
    const struct recorded_node *place = &run->deployment.nodes[node];
    const struct point source = {run->truth.x_m, run->truth.y_m};
    const double value =
        gas_reading(&run->gas, source, run->truth.time_s, node, (struct point){place->x_m, place->y_m});
    run->heard[run->count++] = (struct mh_measurement){.node = run->vicinity.id[node],
                                                       .place = run->vicinity.place[node],
                                                       .time = (mh_tick)(run->heads * run->interval),
                                                       .value = q20_of(value)};
}

static int by_node(const void *a, const void *b)
{
    const mh_node_id left = ((const struct mh_measurement *)a)->node, right = ((const struct mh_measurement *)b)->node;
    return (left > right) - (left < right);
}

/* The head, then its neighbours by identifier. */
static void hear(struct run *run)
{
    run->count = 0;
    take_sample(run, run->head);
    for (size_t k = run->vicinity.first[run->head]; k < run->vicinity.first[run->head + 1]; k++) {
        if (run->vicinity.neighbours[k] < run->deployment.count) {
            take_sample(run, run->vicinity.neighbours[k]);
        }
    }
    qsort(run->heard + 1, run->count - 1, sizeof *run->heard, by_node);
    run->samples += (uint32_t)run->count;
    for (size_t i = 1; i < run->count; i++) {
        run->members[i - 1] = run->heard[i].node;
    }
    if (run->observer->cluster) {
        run->observer->cluster(run->observer->context, run->truth.time_s, 0, run->heard[0].node, run->members,
                               run->count - 1, run->heads > 0);
    }
}

static mh_real score(struct run *run, uint32_t candidate)
{
    size_t count = 0;
    run->places[count++] = run->vicinity.place[candidate];
    for (size_t k = run->vicinity.first[candidate]; k < run->vicinity.first[candidate + 1]; k++) {
        if (run->vicinity.neighbours[k] < run->deployment.count) {
            run->places[count++] = run->vicinity.place[run->vicinity.neighbours[k]];
        }
    }
    mh_real value = 0;
    (void)run->tracker.tracker->score(run->state, run->vicinity.id[candidate], run->places, count, &value);
    return value;
}

/* The head itself where it has no neighbours. */
static uint32_t next_head(struct run *run)
{
    uint32_t best = run->head;
    mh_real highest = 0;
    for (size_t k = run->vicinity.first[run->head]; k < run->vicinity.first[run->head + 1]; k++) {
        const uint32_t candidate = run->vicinity.neighbours[k];
        if (candidate >= run->deployment.count) {
            continue;
        }
        const mh_real value = score(run, candidate);
        const bool even = value >= highest && value <= highest;
        if (best == run->head || value > highest || (even && candidate < best)) {
            best = candidate;
            highest = value;
        }
    }
    return best;
}

/* What the tracker saves comes to a tracker that knows nothing. */
static enum mh_status hand_over(struct run *run)
{
    const struct mh_tracker *tracker = run->tracker.tracker;
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length;
    enum mh_status status = tracker->save(run->state, bytes, &length);
    if (status == MH_OK) {
        status = tracker->init(run->state, &run->tracker.config, run->interval);
    }
    return status == MH_OK ? tracker->load(run->state, bytes, length) : status;
}

static void tell_truth(struct run *run)
{
    const double time_s = (double)run->heads * run->scenario->sensor.interval_s;
    const struct point p = trajectory_position(&run->path, time_s);
    run->truth =
        (struct truth){.time_s = time_s, .x_m = p.x_m, .y_m = p.y_m, .present = true, .rate = run->gas.rate_mlps};
    if (run->observer->truth) {
        run->observer->truth(run->observer->context, &run->truth);
    }
}

/* Returns false when the search is over. */
static bool lead(struct run *run)
{
    struct mh_estimate estimate;
    tell_truth(run);
    hear(run);
    const mh_tick now = (mh_tick)(run->heads * run->interval);
    run->heads++;
    if (run->tracker.tracker->step(run->state, now, run->heard, run->count, &estimate) != MH_OK) {
        return false;
    }
    if (run->observer->estimate) {
        run->observer->estimate(run->observer->context, run->truth.time_s, run->vicinity.id[run->head], &estimate,
                                &run->truth, &run->truth);
    }
    run->calm = estimate.flags & MH_ESTIMATE_CALM ? run->calm + 1 : 0;
    if (run->calm >= (uint64_t)run->scenario->protocol.calm) {
        return false;
    }
    run->head = next_head(run);
    return hand_over(run) == MH_OK;
}

static int make_world(struct run *run, uint64_t seed, char *error, size_t error_size)
{
    const struct scenario *scenario = run->scenario;
    const struct scenario_field field = scenario_field(scenario);
    const struct mh_place corner = place_from_metres(field.width_m, field.height_m, 0);
    const struct mh_region region = {0, corner.x_mm, 0, corner.y_mm};
    run->gas = gas_of(scenario, seed);
    run->interval = (mh_tick)llround(scenario->sensor.interval_s * MH_TICKS_PER_S);
    if (deployment_make(&run->deployment, scenario, seed, error, error_size) ||
        trajectory_make(&run->path, scenario, seed, error, error_size) ||
        tracker_choose(scenario, &region, &run->tracker, error, error_size)) {
        return -1;
    }
    const struct mh_tracker *tracker = run->tracker.tracker;
    if (run->tracker.measures != QUANTITY_GAS || !tracker->score) {
        snprintf(error, error_size, "tracker.name: `%s`, expected gas, gas_small, gas_ekf or gas_ukf for a token",
                 tracker->name);
        return -1;
    }
    snprintf(error, error_size, "out of memory");
    const size_t nodes = run->deployment.count;
    run->state = malloc(tracker->state_size);
    run->heard = calloc(nodes, sizeof *run->heard);
    run->members = calloc(nodes, sizeof *run->members);
    run->places = calloc(nodes, sizeof *run->places);
    if (!run->state || !run->heard || !run->members || !run->places ||
        vicinity_of(&run->vicinity, scenario, &run->deployment, scenario->radio.range_m) ||
        campaign_start(scenario, seed, &run->deployment, &run->head, error, error_size)) {
        return -1;
    }
    if (tracker->init(run->state, &run->tracker.config, run->interval) != MH_OK) {
        snprintf(error, error_size, "tracker %s: a setting is outside its range", tracker->name);
        return -1;
    }
    return 0;
}

static void free_world(struct run *run)
{
    free(run->state);
    free(run->heard);
    free(run->members);
    free(run->places);
    vicinity_free(&run->vicinity);
    trajectory_free(&run->path);
    deployment_free(&run->deployment);
}

static int search(struct run *run, const volatile sig_atomic_t *stop, char *error, size_t error_size)
{
    for (uint32_t i = 0; run->observer->node && i < run->vicinity.count; i++) {
        run->observer->node(run->observer->context, run->vicinity.id[i], &run->vicinity.place[i]);
    }
    bool goes_on = true;
    while (goes_on && run->heads < (uint64_t)run->scenario->protocol.heads_max) {
        if (stop && *stop) {
            snprintf(error, error_size, "stopped");
            return -1;
        }
        goes_on = lead(run);
    }
    return 0;
}

int ideal_token_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                    const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                    size_t error_size)
{
    struct run run = {.scenario = scenario, .observer = observer};
    int result = make_world(&run, seed, error, error_size);
    if (result == 0) {
        result = search(&run, stop, error, error_size);
    }
    if (result == 0) {
        const double none = (double)NAN;
        *counters = (struct simulation_counters){.samples = run.heads,
                                                 .head.measurements = run.samples,
                                                 .energy = energy_total_unknown(),
                                                 .clock_error_median_ms = none,
                                                 .clock_error_p99_ms = none,
                                                 .clock_known_share = none};
    }
    free_world(&run);
    return result;
}
