/* Cramer-Rao bounds of a target of white acceleration (accelerated.h) that is ranged by nodes which sample at different rates: how well any estimator could know its
 * position from all ranges up to now, if the prior of its start and the model of its motion are known.
 *
 * The posterior bound (Tichavsky, Muravchik and Nehorai, "Posterior Cramer-Rao bounds for discrete-time nonlinear filtering", 1998) is, with a linear model of motion,
 *
 *   J(k + 1) = (F J(k)^-1 F' + Q)^-1 + E[H' R^-1 H]
 *
 * with the expectation over all paths. The conditional bound is the same recursion along one path, with H there; its mean over the paths is the larger one, because a path
 * that is seen badly costs more than one that is seen well saves. */
#ifndef MOTEHOUND_SIM_PCRB_FIXED_H
#define MOTEHOUND_SIM_PCRB_FIXED_H

#include "scenario/scenario.h"
#include "world/clusters.h"

/* Nodes that are heard: all, or those of one cluster. */
enum { PCRB_ALL_CLUSTERS = -1 };

/* Of `scenario`'s target and its clusters: mean square errors of the position, m2, at steps 0 ... scenario_steps() -> bounds, so it holds one more. The posterior bound is over the paths of seeds 0 to
 * 99, so it is the same in each run; the conditional bound is along the path of `seed`. Returns 0, or -1 if there is no memory. */
int pcrb_fixed_posterior(const struct scenario *scenario, const struct clusters *clusters, int cluster, double *bounds);
int pcrb_fixed_conditional(const struct scenario *scenario, const struct clusters *clusters, int cluster, uint64_t seed,
                           double *bounds);

/* Root mean square over what is reported, every fusion.report_s but for the first metrics.skip_first times, m; NaN for nothing. */
double pcrb_fixed_rms_m(const struct scenario *scenario, const double *bounds);

#endif
