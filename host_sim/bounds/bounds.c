#include "bounds/bounds.h"

#include "bounds/hindsight.h"
#include "bounds/pcrb.h"
#include "bounds/pcrb_fixed.h"

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

int bounds_of(const struct scenario *scenario, uint64_t seed, struct bounds *bounds, char *error, size_t error_size)
{
    const bool fixed = strcmp(scenario->network.protocol, "fixed") == 0;
    const double none = (double)NAN;
    *bounds =
        (struct bounds){.apply = scenario->sensor.quantity == QUANTITY_RANGE && scenario->source.path != PATH_NONE,
                        .follow = !fixed,
                        .ccrb_m = none,
                        .local_ccrb_m = {none, none, none, none}};
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
