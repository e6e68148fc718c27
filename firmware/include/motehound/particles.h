/* A bounded set of particles: places in the plane, each with a weight.
 *
 * A set drawn afresh is judged in two steps. First weight[i] holds particle i's sum of squared residuals (draw, then add_range for each range);
 * weigh() then makes weights of the sums: the likelihood of Gaussian errors, relative to a sum that the caller names, so that the best of a set
 * has weight 1 however bad it is. Weights need not sum to 1. Functions with `from` work on particles from, from + 1, .. and leave those before
 * alone, so that a part of a set can be drawn anew.
 *
 * One array for each coordinate, so that compilers vectorise what is done to all. Nothing is allocated. Places go in and out in metres relative to an
 * origin that the owner keeps. Liu, "Monte Carlo Strategies in Scientific Computing", 2001.
 *
 * Scaling and overflow (fixed point). A coordinate is 16 bits relative to a centre, the apex of the last sector of which all were drawn, in units of 2^-bits m:
 * the finest of 4 mm to 1 m in which `extent` is at most 2^14. So a difference fits in 16 bits, a squared distance in 32. A distance is rounded to a unit (relative error of the root besides:
 * 1.5e-5 of it). Sums of squared residuals are 32 bits in units squared, and saturate there. Weights have 16 fractional bits; their largest error is 1.5e-3 of them, and 1.5e-5.
 * A station farther than 2^14 units from the centre in either coordinate is taken to be that far: its residuals are then large, but smaller than they should be. Sums of weights, means
 * and covariances are made in 64 bits and rounded once. 8 bytes a particle. */
#ifndef MOTEHOUND_PARTICLES_H
#define MOTEHOUND_PARTICLES_H

#include "motehound/config.h"
#include "motehound/geometry.h"
#include "motehound/random.h"
#include "motehound/status.h"

#if MH_REAL_FIXED
typedef int16_t mh_particle_coordinate;
typedef uint32_t mh_particle_weight;
#define MH_PARTICLE_WEIGHT_ONE ((mh_particle_weight)65536)
#define MH_PARTICLE_SUM_MAX UINT32_MAX /* what is not finite */
#else
typedef mh_real mh_particle_coordinate;
typedef mh_real mh_particle_weight;
#define MH_PARTICLE_WEIGHT_ONE 1.0f
#define MH_PARTICLE_SUM_MAX ((mh_particle_weight)INFINITY)
#endif

struct mh_particles {
    uint16_t count; /* 1 to MH_PARTICLES_MAX */
#if MH_REAL_FIXED
    uint8_t bits;          /* of a metre: 0 to 8 */
    struct mh_vec2 centre; /* of what the coordinates are relative to */
#endif
    mh_particle_coordinate x[MH_PARTICLES_MAX], y[MH_PARTICLES_MAX];
    mh_particle_weight weight[MH_PARTICLES_MAX]; /* >= 0; before weigh(): the sum of squared residuals */
};

/* Begin with `count` particles, none of which, and no station whose range is told, is farther than `extent` (m) from the apex of the sector that it was
 * drawn of; nor is a range longer. `sd`: the least standard deviation of a range. Errors (fixed point): MH_ERR_ARGUMENT (`extent` above 16,384 m, or `sd` below 4 of the units in
 * which that is held, so that these would be felt: 1/4,096 of the extent). */
enum mh_status mh_particles_init(struct mh_particles *particles, uint16_t count, mh_real extent, mh_real sd);

/* Where particle i is. */
static inline struct mh_vec2 mh_particles_place(const struct mh_particles *particles, uint16_t i)
{
#if MH_REAL_FIXED
    const int32_t unit = (int32_t)1 << (MH_REAL_BITS - particles->bits);
    const struct mh_vec2 place = {mh_add(particles->centre.x, mh_real_from_bits(particles->x[i] * unit)),
                                  mh_add(particles->centre.y, mh_real_from_bits(particles->y[i] * unit))};
#else
    const struct mh_vec2 place = {particles->x[i], particles->y[i]};
#endif
    return place;
}

/* A sum of squared residuals of `square` >= 0 (m2). */
static inline mh_particle_weight mh_particles_sum(const struct mh_particles *particles, mh_wide square)
{
#if MH_REAL_FIXED
    const int64_t sum = square >> (2 * (MH_REAL_BITS - particles->bits));
    return sum < MH_PARTICLE_SUM_MAX ? (mh_particle_weight)sum : MH_PARTICLE_SUM_MAX;
#else
    (void)particles;
    return square;
#endif
}

/* The part of a ring about `apex` that lies within half_angle of `axis`; with half_angle = pi a ring, with inner = 0 too a disc. */
struct mh_sector {
    struct mh_vec2 apex;
    struct mh_vec2 axis;  /* unit vector */
    mh_real half_angle;   /* 0 to pi */
    mh_real inner, outer; /* m, 0 <= inner <= outer <= 1e6 */
};

/* Its area in m2 times factor / (2 pi count): with a factor of 1 the variance of a place in a disc of a count'th of the area. */
static inline mh_wide mh_sector_share(const struct mh_sector *sector, mh_real factor, uint16_t count)
{
#if MH_REAL_FIXED /* in an order in which no product is large */
    const mh_real width = mh_mul(mh_div(sector->half_angle, 2 * MH_PI), sector->outer - sector->inner);
    return mh_wide_mul(mh_mul(width / count, sector->outer + sector->inner), factor);
#else
    const mh_real area = sector->half_angle * (sector->outer - sector->inner) * (sector->outer + sector->inner);
    return factor * area / (2.0f * MH_PI * (mh_real)count);
#endif
}

/* Places uniform in the area of `sector`, sums of squared residuals 0. 40 operations and a root each. */
void mh_particles_draw(struct mh_particles *particles, uint16_t from, const struct mh_sector *sector,
                       struct mh_random *random);

/* A range was measured at `station`: add (range - distance)^2 to each sum, but those that are above `beyond` already may be left as they are. The range may be negative, as noise makes it
 * near a station. 7 operations and a root each. */
void mh_particles_add_range(struct mh_particles *particles, uint16_t from, struct mh_vec2 station, mh_real range,
                            mh_particle_weight beyond);

/* A sum so large that weigh() gives it no weight. */
mh_particle_weight mh_particles_worthless(const struct mh_particles *particles, mh_particle_weight least, mh_real sd);

/* The least sum; MH_PARTICLE_SUM_MAX if none is finite. */
mh_particle_weight mh_particles_least(const struct mh_particles *particles);

/* Sums -> weights exp(-(sum - least) / (2 sd^2)), at most exp(40), 0 below exp(-80) (fixed point: 2^15 and 2^-16) and for a sum that is not
 * finite. sd > 0: of a range. */
void mh_particles_weigh(struct mh_particles *particles, uint16_t from, mh_particle_weight least, mh_real sd);

/* (sum w)^2 / sum w^2: how many equal weights say as much; 0 where all weights are 0. */
mh_real mh_particles_effective(const struct mh_particles *particles);

/* Weighted mean, and covariance about it with `resolution` >= 0 (m2) added to both variances, so that it is positive definite for a
 * resolution > 0: what a set of this density cannot tell. Errors: MH_ERR_SINGULAR (the weights sum to less than 1.2e-38, in fixed point to 0),
 * MH_ERR_NOT_FINITE. */
enum mh_status mh_particles_mean(const struct mh_particles *particles, mh_real resolution, struct mh_vec2 *mean,
                                 struct mh_sym2 *covariance);

/* Systematic resampling (Kitagawa, J. Comput. Graph. Stat. 5, 1996, "deterministic"): particle i goes on floor or ceiling of N w_i / sum w
 * times, N w_i / sum w times on average; all weights become 1. In place. Errors, the set untouched: those of mh_particles_mean. */
enum mh_status mh_particles_resample(struct mh_particles *particles, struct mh_random *random);

/* Partial rejection control (Liu, Chen and Logvinenko 2001, in "Sequential Monte Carlo Methods in Practice"): with c the mean weight, a
 * particle stays with probability min(1, w / c) and then weighs max(w, c); otherwise it is drawn anew. After MH_PARTICLES_REDRAWS redraws it
 * stays as it is, with its own weight.
 *
 * redraw(context, particles, from) draws and weighs particles from, .. anew, relative to the same `least`. Particles are reordered.
 * Errors, the set untouched: those of mh_particles_mean. */
#define MH_PARTICLES_REDRAWS 10
typedef void mh_particles_redraw(void *context, struct mh_particles *particles, uint16_t from);
enum mh_status mh_particles_reject(struct mh_particles *particles, struct mh_random *random,
                                   mh_particles_redraw *redraw, void *context);

#endif
