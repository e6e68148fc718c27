#include "bounds/pcrb_fixed.h"

#include "bounds/pcrb.h"
#include "world/accelerated.h"

#include <math.h>
#include <stdlib.h>

enum { X, Y, VX, VY, STATES };

enum { PATHS = 100 };

/* What is measured at each step along the path of `seed` is added to informations[0 .. steps]. */
static int add_path(const struct scenario *scenario, const struct clusters *clusters, int cluster, uint64_t seed,
                    struct information *informations)
{
    const struct accelerated target = accelerated_of(scenario);
    const size_t steps = scenario_steps(scenario);
    struct accelerated_state *states = malloc((steps + 1) * sizeof *states);
    if (!states) {
        return -1;
    }
    accelerated_states(&target, seed, steps, states);
    for (size_t i = 0; i < clusters->node_count; i++) {
        const struct clustered_node *what = &clusters->nodes[i];
        const bool heard = cluster == PCRB_ALL_CLUSTERS || clusters_hear(clusters, (size_t)cluster, i);
        for (size_t k = what->period; heard && k <= steps; k += what->period) {
            information_add_range(&informations[k], &states[k].at, &what->place, sqrt(what->range_variance_m2));
        }
    }
    free(states);
    return 0;
}

static void begin(const struct scenario *scenario, struct pcrb *pcrb)
{
    const double position = scenario->target.position_sd_m, velocity = scenario->target.velocity_sd_mps;
    *pcrb = (struct pcrb){{{0}}};
    pcrb->covariance[X][X] = pcrb->covariance[Y][Y] = position * position;
    pcrb->covariance[VX][VX] = pcrb->covariance[VY][VY] = velocity * velocity;
}

/* P <- F P F' + Q over an interval. */
static void step(const struct scenario *scenario, struct pcrb *pcrb)
{
    const double T = scenario->sensor.interval_s;
    const double sd[2] = {scenario->target.acceleration_x_mps2, scenario->target.acceleration_y_mps2};
    double(*p)[STATES] = pcrb->covariance;
    for (int i = 0; i < STATES; i++) { /* rows, then columns */
        p[X][i] += T * p[VX][i];
        p[Y][i] += T * p[VY][i];
    }
    for (int i = 0; i < STATES; i++) {
        p[i][X] += T * p[i][VX];
        p[i][Y] += T * p[i][VY];
    }
    for (int axis = 0; axis < 2; axis++) {
        const double variance = sd[axis] * sd[axis], gain = T * T / 2;
        p[axis][axis] += gain * gain * variance;
        p[axis][axis + VX] += gain * T * variance;
        p[axis + VX][axis] += gain * T * variance;
        p[axis + VX][axis + VX] += T * T * variance;
    }
}

static int bounds_of_paths(const struct scenario *scenario, const struct clusters *clusters, int cluster,
                           uint64_t first, size_t paths, double *bounds)
{
    const size_t steps = scenario_steps(scenario);
    struct information *informations = calloc(steps + 1, sizeof *informations);
    int status = informations ? 0 : -1;
    for (size_t i = 0; i < paths && status == 0; i++) {
        status = add_path(scenario, clusters, cluster, first + i, informations);
    }
    struct pcrb pcrb;
    begin(scenario, &pcrb);
    for (size_t k = 0; k <= steps && status == 0; k++) {
        const double share = 1 / (double)paths;
        const struct information mean = {informations[k].xx * share, informations[k].xy * share,
                                         informations[k].yy * share};
        if (k > 0) {
            step(scenario, &pcrb);
        }
        pcrb_measure(&pcrb, &mean);
        bounds[k] = pcrb_bound(&pcrb);
    }
    free(informations);
    return status;
}

int pcrb_fixed_posterior(const struct scenario *scenario, const struct clusters *clusters, int cluster, double *bounds)
{
    return bounds_of_paths(scenario, clusters, cluster, 0, PATHS, bounds);
}

int pcrb_fixed_conditional(const struct scenario *scenario, const struct clusters *clusters, int cluster, uint64_t seed,
                           double *bounds)
{
    return bounds_of_paths(scenario, clusters, cluster, seed, 1, bounds);
}

double pcrb_fixed_rms_m(const struct scenario *scenario, const double *bounds)
{
    const size_t every = (size_t)llround(scenario->fusion.report_s / scenario->sensor.interval_s);
    const size_t skipped = (size_t)scenario->metrics.skip_first;
    double sum = 0;
    size_t count = 0;
    for (size_t k = (skipped + 1) * every; k <= scenario_steps(scenario); k += every) {
        sum += bounds[k];
        count++;
    }
    return count > 0 ? sqrt(sum / (double)count) : (double)NAN;
}
