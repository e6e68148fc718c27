/* The puff behind a set of concentrations of one instant (Luo, Chai and Yang): position, age and mass from at least four of them.
 *
 * Two ways. The linear fit, Eq. (10), takes logarithms and the difference of every equation with a reference node's, which leaves a
 * linear least-squares problem for position and age under 0 <= age <= age_max; it is solved exactly. The nonlinear fit,
 * Eq. (9), least squares of the concentrations themselves under the same bound, is iterated from a start such as the linear answer.
 * Neither keeps the concentrations: they are fed one by one, for the nonlinear fit once a pass, so memory does not grow with them.
 *
 *     struct mh_puff_linear linear;
 *     mh_puff_linear_begin(&linear, diffusion, &samples[largest]);
 *     for (k = 0; k < count; k++) mh_puff_linear_add(&linear, &samples[k]);
 *     mh_puff_linear_solve(&linear, age_max, &answer);
 *
 *     struct mh_puff_nonlinear nonlinear;
 *     mh_puff_nonlinear_begin(&nonlinear, diffusion, &samples[largest], answer.puff.position, answer.puff.age, age_max);
 *     do {
 *         for (k = 0; k < count; k++) mh_puff_nonlinear_add(&nonlinear, &samples[k]);
 *     } while (mh_puff_nonlinear_advance(&nonlinear, &answer) == MH_NONE);
 *
 * Positions are in metres relative to an origin within 2e6 m. Errors leave the fit as it was.
 *
 * Scaling and overflow, in fixed point. There is the linear fit only: slopes of concentrations and the sums of their squares span more than the format. Its
 * equations are halved, so that their right side, half of a squared distance, reaches as far as 256 m from the reference node; a node
 * farther off is refused as MH_ERR_RANGE. Concentrations come as the 20 fractional bits of the sensor (mh_concentration), whose logarithms
 * are within 1.5e-5 of each other's difference; those of 0.01 g/m2 and less are coarser than that themselves. D is 0.01 to 500 m2/s, the mass at most 32,767 g and else infinite. */
#ifndef MOTEHOUND_PUFF_FIT_H
#define MOTEHOUND_PUFF_FIT_H

#include "motehound/least_squares.h"
#include "motehound/puff.h"

/* Fewest concentrations that determine a puff's position, age and mass. */
#define MH_PUFF_SAMPLES_MIN 4

/* A concentration with all digits that a sensor node sends; mh_concentration_of makes one of its Q11.20. */
#if MH_REAL_FIXED
typedef mh_q20 mh_concentration;
static inline mh_concentration mh_concentration_of(mh_q20 sample) { return sample; }
#else
typedef mh_real mh_concentration;
static inline mh_concentration mh_concentration_of(mh_q20 sample) { return mh_q20_to_real(sample); }
#endif

struct mh_puff_sample {
    struct mh_vec2 position;        /* of the node */
    mh_concentration concentration; /* g/m2, > 0 */
};

struct mh_puff_answer {
    struct mh_puff puff;
    enum mh_bound bound; /* of the age: low (0), high (age_max) or none active */
};

/* Eq. (10). */
struct mh_puff_linear {
    mh_real diffusion;
    struct mh_puff_sample reference;
#if MH_REAL_FIXED
    mh_real logarithm; /* of the reference's concentration as it comes, 20 fractional bits taken for 16 */
#endif
    struct mh_least_squares equations; /* unknowns: position relative to the reference, age */
};

/* Begin. `diffusion` in m2/s, > 0. `reference`: one of the samples, best the one with the largest concentration, whose
 * logarithm has the smallest relative error. Errors: MH_ERR_NOT_FINITE (fixed point: a saturated number), MH_ERR_RANGE (diffusion or
 * concentration not positive; fixed point: diffusion outside 0.01 to 500). */
enum mh_status mh_puff_linear_begin(struct mh_puff_linear *fit, mh_real diffusion,
                                    const struct mh_puff_sample *reference);

/* Take one sample, in any order; the reference is among them (its equation is 0 = 0, but it counts).
 * Errors: MH_ERR_NOT_FINITE, MH_ERR_RANGE (concentration not positive; fixed point: more than 256 m from the reference). */
enum mh_status mh_puff_linear_add(struct mh_puff_linear *fit, const struct mh_puff_sample *sample);

/* The exact minimiser. The mass is the one that gives the reference its concentration (e^20 times its share at most, in fixed point e^10, where the
 * position is far off for the age), 0 where the age is 0. Where the samples determine the position for a given age but not the
 * age, the age is age_max. Errors: MH_ERR_ARGUMENT (age_max < 0 or NaN),
 * MH_ERR_TOO_FEW (fewer than MH_PUFF_SAMPLES_MIN, the reference included), MH_ERR_SINGULAR (nodes on one line),
 * MH_ERR_RANGE (a position too large for mh_real). */
enum mh_status mh_puff_linear_solve(const struct mh_puff_linear *fit, mh_real age_max, struct mh_puff_answer *answer);

#if !MH_REAL_FIXED

/* Least age of the nonlinear fit, as a share of age_max: at age 0 Eq. (4) has no value. */
#define MH_PUFF_AGE_SHARE_MIN 1e-3f

/* Eq. (9), by Levenberg-Marquardt in position, logarithm of the mass and age. A step moves at most the width of the puff
 * sqrt(4 D age), changes the mass by a factor of at most e and the age by at most a factor of 2, and never leaves the bounds. */
struct mh_puff_nonlinear {
    mh_real diffusion, age_min, age_max;
    struct mh_puff trial, best;
    struct mh_least_squares trial_equations, best_equations; /* linearised there */
    mh_real trial_residual;
    mh_real cost; /* of best: sum of the squared residuals, (g/m2)^2 */
    mh_real damping;
    uint8_t passes; /* over the samples so far */
};

/* Begin at `position` and `age` (put within the bounds), with the mass that explains `reference`, the sample with the largest
 * concentration. Errors: MH_ERR_NOT_FINITE, MH_ERR_RANGE (diffusion, age_max or the concentration not positive). */
enum mh_status mh_puff_nonlinear_begin(struct mh_puff_nonlinear *fit, mh_real diffusion,
                                       const struct mh_puff_sample *reference, struct mh_vec2 position, mh_real age,
                                       mh_real age_max);

/* Take one sample of a pass, in any order. Cost: one exponential, four square roots. Errors: as mh_puff_linear_add. */
enum mh_status mh_puff_nonlinear_add(struct mh_puff_nonlinear *fit, const struct mh_puff_sample *sample);

/* A pass is complete. MH_NONE: another one is wanted, with the same samples; at most 24 in all. MH_OK: `answer` and
 * fit->cost hold the best puff found; its bound is low at MH_PUFF_AGE_SHARE_MIN age_max. Errors: MH_ERR_TOO_FEW (fewer than
 * MH_PUFF_SAMPLES_MIN), MH_ERR_SINGULAR (at the start the samples do not determine the puff). */
enum mh_status mh_puff_nonlinear_advance(struct mh_puff_nonlinear *fit, struct mh_puff_answer *answer);

#endif

#endif
