#include "bounds/bounds.h"

#include "bounds/fix_bound.h"
#include "bounds/hindsight.h"
#include "bounds/pcrb.h"
#include "bounds/pcrb_fixed.h"
#include "world/sound.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double pcrb_m(const struct scenario *scenario, uint64_t seed, const struct deployment *deployment)
{
    const double sd_m = scenario->sensor.range_noise_m;
    if (scenario->source.path != PATH_GAUSS_MARKOV || scenario->sensor.noisy_detection || sd_m <= 0) {
        return (double)NAN;
    }
    const struct mobility mobility = mobility_of(scenario);
    const size_t steps = scenario_steps(scenario), skip = (size_t)scenario->metrics.skip_first;
    return pcrb_of_walk(&mobility, seed, steps, skip, deployment, scenario->sensor.range_m, sd_m).pcrb_m;
}

/* The path's places at the sampling instants. */
static struct point *places_of(const struct trajectory *trajectory, double interval_s, size_t *count)
{
    *count = (size_t)(trajectory->duration_s / interval_s + 1e-9) + 1;
    struct point *places = malloc(*count * sizeof *places);
    for (size_t n = 0; places != NULL && n < *count; n++) {
        places[n] = trajectory_position(trajectory, (double)n * interval_s);
    }
    return places;
}

static int in_hindsight(const struct scenario *scenario, const struct trajectory *trajectory,
                        const struct deployment *deployment, struct bounds *bounds)
{
    size_t count, hand_overs, reports;
    struct point *places = places_of(trajectory, scenario->sensor.interval_s, &count);
    const bool sound = places != NULL &&
                       hindsight_hand_overs(deployment->nodes, deployment->count, places, count,
                                            scenario->sensor.range_m, &hand_overs) == 0 &&
                       hindsight_reports(places, count, scenario->tracker.tolerance_m, &reports) == 0;
    free(places);
    if (!sound) {
        return -1;
    }
    bounds->hand_overs = hand_overs;
    bounds->reports = reports;
    return 0;
}

static int of_fixed_clusters(const struct scenario *scenario, uint64_t seed, struct bounds *bounds, char *error,
                             size_t error_size)
{
    struct clusters clusters;
    if (clusters_make(&clusters, scenario, error, error_size) != 0) {
        return -1;
    }
    double *squares = malloc((scenario_steps(scenario) + 1) * sizeof *squares);
    int status = squares != NULL ? pcrb_fixed_posterior(scenario, &clusters, PCRB_ALL_CLUSTERS, squares) : -1;
    if (status == 0) {
        bounds->pcrb_m = pcrb_fixed_rms_m(scenario, squares);
        status = pcrb_fixed_conditional(scenario, &clusters, PCRB_ALL_CLUSTERS, seed, squares);
    }
    if (status == 0) {
        bounds->ccrb_m = pcrb_fixed_rms_m(scenario, squares);
    }
    for (int c = 0; c < BOUNDS_LOCAL && (size_t)c < clusters.count && status == 0; c++) {
        status = pcrb_fixed_conditional(scenario, &clusters, c, seed, squares);
        bounds->local_ccrb_m[c] = pcrb_fixed_rms_m(scenario, squares);
    }
    free(squares);
    return status;
}

/* What all nodes that detect a target at time_s tell of those that are there. */
static struct fix_information heard_at(const struct sound *sound, const struct targets *targets,
                                       const struct deployment *deployment, double time_s)
{
    struct heard_target heard[TARGETS_MAX];
    struct fix_information information = {0};
    for (size_t k = 0; k < targets->count; k++) {
        const struct target_state state = targets_at(targets, k, time_s);
        if (state.present) {
            heard[information.targets++] =
                (struct heard_target){state.at, targets->list[k].loudness * sound->range_m * sound->range_m};
        }
    }
    for (uint32_t i = 0; i < deployment->count && information.targets > 0; i++) {
        const struct point node = {deployment->nodes[i].x_m, deployment->nodes[i].y_m};
        if (sound_reading(sound, targets, time_s, i, node) >= 1) {
            fix_information_add(&information, heard, node, sound->source_noise, sound->background_noise);
        }
    }
    return information;
}

static int of_sound(const struct scenario *scenario, uint64_t seed, struct bounds *bounds, char *error,
                    size_t error_size)
{
    struct deployment deployment = {0};
    struct targets targets = {0};
    const struct sound sound = sound_of(scenario, seed);
    double sum_m2 = 0;
    size_t count = 0;
    int status = deployment_make(&deployment, scenario, seed, error, error_size);
    if (status == 0) {
        status = targets_make(&targets, scenario, seed, error, error_size);
    }
    const double interval_s = scenario->sensor.interval_s;
    const size_t last = (size_t)(targets.duration_s / interval_s + 1e-6);
    for (size_t n = (size_t)scenario->metrics.skip_first; n <= last && status == 0; n++) {
        const struct fix_information information = heard_at(&sound, &targets, &deployment, (double)n * interval_s);
        const double variance_m2 = fix_bound_m2(&information);
        sum_m2 += isnan(variance_m2) ? 0 : variance_m2;
        count += isnan(variance_m2) ? 0 : 1;
    }
    bounds->heard = true;
    bounds->fix_crlb_m = count > 0 ? sqrt(sum_m2 / (double)count) : (double)NAN;
    targets_free(&targets);
    deployment_free(&deployment);
    return status;
}

int bounds_of(const struct scenario *scenario, uint64_t seed, struct bounds *bounds, char *error, size_t error_size)
{
    const bool fixed = strcmp(scenario->network.protocol, "fixed") == 0;
    const double none = (double)NAN;
    *bounds =
        (struct bounds){.apply = scenario->sensor.quantity == QUANTITY_RANGE && scenario->source.path != PATH_NONE,
                        .follow = !fixed,
                        .ccrb_m = none,
                        .local_ccrb_m = {none, none, none, none}};
    if (scenario->sensor.quantity == QUANTITY_SOUND) {
        return of_sound(scenario, seed, bounds, error, error_size);
    }
    if (!bounds->apply) {
        return 0;
    }
    struct deployment deployment = {0};
    struct trajectory trajectory = {0};
    snprintf(error, error_size, "out of memory");
    int status = deployment_make(&deployment, scenario, seed, error, error_size);
    if (status == 0) {
        status = trajectory_make(&trajectory, scenario, seed, error, error_size);
    }
    if (status == 0 && fixed) {
        status = of_fixed_clusters(scenario, seed, bounds, error, error_size);
    } else if (status == 0) {
        bounds->pcrb_m = pcrb_m(scenario, seed, &deployment);
        status = in_hindsight(scenario, &trajectory, &deployment, bounds);
    }
    trajectory_free(&trajectory);
    deployment_free(&deployment);
    return status;
}
