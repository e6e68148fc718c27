/* A bounded set of particles: places in the plane, each with a weight.
 *
 * A set drawn afresh is judged in two steps. First weight[i] holds particle i's sum of squared residuals (draw, then add_range for each range);
 * weigh() then makes weights of the sums: the likelihood of Gaussian errors, relative to a sum that the caller names, so that the best of a set
 * has weight 1 however bad it is. Weights need not sum to 1. Functions with `from` work on particles from, from + 1, .. and leave those before
 * alone, so that a part of a set can be drawn anew.
 *
 * One array for each coordinate, so that compilers vectorise what is done to all. Nothing is allocated. Coordinates are in metres relative to an
 * origin that the owner keeps. Liu, "Monte Carlo Strategies in Scientific Computing", 2001. */
#ifndef MOTEHOUND_PARTICLES_H
#define MOTEHOUND_PARTICLES_H

#include "motehound/config.h"
#include "motehound/geometry.h"
#include "motehound/random.h"
#include "motehound/status.h"

struct mh_particles {
    uint16_t count; /* 1 to MH_PARTICLES_MAX, set by the owner */
    mh_real x[MH_PARTICLES_MAX], y[MH_PARTICLES_MAX];
    mh_real weight[MH_PARTICLES_MAX]; /* >= 0; before weigh(): the sum of squared residuals, m2 */
};

/* The part of a ring about `apex` that lies within half_angle of `axis`; with half_angle = pi a ring, with inner = 0 too a disc. */
struct mh_sector {
    struct mh_vec2 apex;
    struct mh_vec2 axis;  /* unit vector */
    mh_real half_angle;   /* 0 to pi */
    mh_real inner, outer; /* m, 0 <= inner <= outer <= 1e6 */
};

/* m2 */
static inline mh_real mh_sector_area(const struct mh_sector *sector)
{
    return sector->half_angle * (sector->outer - sector->inner) * (sector->outer + sector->inner);
}

/* Places uniform in the area of `sector`, sums of squared residuals 0. 40 operations and a root each. */
void mh_particles_draw(struct mh_particles *particles, uint16_t from, const struct mh_sector *sector,
                       struct mh_random *random);

/* A range was measured at `station`: add (range - distance)^2 to each sum. The range may be negative, as noise makes it near a station.
 * 7 operations and a root each. */
void mh_particles_add_range(struct mh_particles *particles, uint16_t from, struct mh_vec2 station, mh_real range);

/* The least sum; infinite if none is finite. */
mh_real mh_particles_least(const struct mh_particles *particles);

/* Sums -> weights exp(-(sum - least) / (2 sd^2)), at most exp(40), 0 below exp(-80) and for a sum that is not finite. sd > 0: of a range. */
void mh_particles_weigh(struct mh_particles *particles, uint16_t from, mh_real least, mh_real sd);

/* (sum w)^2 / sum w^2: how many equal weights say as much; 0 where all weights are 0. */
mh_real mh_particles_effective(const struct mh_particles *particles);

/* Weighted mean, and covariance about it with `resolution` >= 0 (m2) added to both variances, so that it is positive definite for a
 * resolution > 0: what a set of this density cannot tell. Errors: MH_ERR_SINGULAR (the weights sum to less than 1.2e-38), MH_ERR_NOT_FINITE. */
enum mh_status mh_particles_mean(const struct mh_particles *particles, mh_real resolution, struct mh_vec2 *mean,
                                 struct mh_sym2 *covariance);

/* Systematic resampling (Kitagawa, J. Comput. Graph. Stat. 5, 1996, "deterministic"): particle i goes on floor or ceiling of N w_i / sum w
 * times, N w_i / sum w times on average; all weights become 1. In place. Errors, the set untouched: MH_ERR_SINGULAR (the weights sum to less than 1.2e-38),
 * MH_ERR_NOT_FINITE. */
enum mh_status mh_particles_resample(struct mh_particles *particles, struct mh_random *random);

/* Partial rejection control (Liu, Chen and Logvinenko 2001, in "Sequential Monte Carlo Methods in Practice"): with c the mean weight, a
 * particle stays with probability min(1, w / c) and then weighs max(w, c); otherwise it is drawn anew. After MH_PARTICLES_REDRAWS redraws it
 * stays as it is, with its own weight.
 *
 * redraw(context, particles, from) draws and weighs particles from, .. anew, relative to the same `least`. Particles are reordered.
 * Errors, the set untouched: MH_ERR_SINGULAR (the weights sum to less than 1.2e-38), MH_ERR_NOT_FINITE. */
#define MH_PARTICLES_REDRAWS 10
typedef void mh_particles_redraw(void *context, struct mh_particles *particles, uint16_t from);
enum mh_status mh_particles_reject(struct mh_particles *particles, struct mh_random *random,
                                   mh_particles_redraw *redraw, void *context);

#endif
