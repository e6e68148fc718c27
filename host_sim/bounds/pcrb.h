/* The posterior Cramer-Rao bound of a target that walks as mobility.h says and is ranged by the nodes near it: how well any estimator could
 * know its position from all ranges up to now (Tichavsky, Muravchik and Nehorai, "Posterior Cramer-Rao bounds for discrete-time nonlinear
 * filtering", 1998).
 *
 * The process noise is singular, it enters speed and heading only, so the recursion is that of the covariance, not of the information:
 * the state [x, y, speed, heading] is propagated with the Jacobian along the true path and corrected with the Fisher matrix of the
 * ranges there. The start but for the place, the mean heading, the reflections and which nodes detect the target are taken as known,
 * the limits of the speed and what the silence of the other nodes tells are not used. Linearised, the bound is a fair one,
 * not a strict one: the exact posterior's error has been within 4 % of it. */
#ifndef MOTEHOUND_SIM_PCRB_H
#define MOTEHOUND_SIM_PCRB_H

#include "world/deployment.h"
#include "world/mobility.h"

/* Fisher matrix of a position, 1/m2. Adds up over independent ranges. */
struct information {
    double xx, xy, yy;
};

/* Add that of one range of standard deviation sd_m, measured from `node`: u u' / sd^2 with the direction u from there to the target.
 * At the target itself the direction is undefined, and nothing is added. */
void information_add_range(struct information *information, const struct point *target, const struct point *node,
                           double sd_m);

/* The bound of the mean square error of a position that is known from this alone, the trace of the inverse, m2. Infinite where the
 * information is singular: fewer than two nodes, or all in one line with the target. */
double information_bound(const struct information *information);

struct pcrb {
    double covariance[4][4]; /* of [x, y, speed, heading], SI units */
};

/* At step 0, before any range: the place is anywhere between the margins, speed and heading are their known means. */
void pcrb_begin(struct pcrb *pcrb, const struct mobility *mobility);

/* One step on, from the true state `before` to the true state `after`. */
void pcrb_step(struct pcrb *pcrb, const struct mobility *mobility, const struct mobility_state *before,
               const struct mobility_state *after);

/* What has been measured at this step. */
void pcrb_measure(struct pcrb *pcrb, const struct information *information);

/* The bound of the position's mean square error, m2. */
double pcrb_bound(const struct pcrb *pcrb);

/* Both bounds of a whole walk, as root mean squares over its steps, m. */
struct pcrb_of_walk {
    double pcrb_m;     /* from all ranges up to each step */
    double snapshot_m; /* from those of each step alone, where at least three nodes detect the target */
};

/* The walk of `steps` steps that mobility.h makes of `seed`, over steps `skip` ... steps; detected by the nodes within range_m, whose ranges have
 * standard deviation sd_m > 0. NaN where there is no such step. Cost: nodes x steps. */
struct pcrb_of_walk pcrb_of_walk(const struct mobility *mobility, uint64_t seed, size_t steps, size_t skip,
                                 const struct deployment *deployment, double range_m, double sd_m);

#endif
