/* What an acoustic sensor reads: the energy of the sound of a target, which falls with the square of the distance (Han, Eq. (2-1)),
 *
 *     y = e exp(tau g1) + eta g2,   e = C / d^2
 *
 * with g1, g2 standard normal: tau is the noise of a source that is itself noise, averaged over a sample, eta that of the background, whose known mean has been
 * subtracted, so that y may be negative.
 *
 * Unit of energy: the least that a sensor reports. A target of loudness C is so loud at the range sqrt(C). Nearer than MH_SOUND_NEAR_M the distance is
 * taken for that. The energies of several sources add up.
 *
 * Scaling and overflow (fixed point): 16 fractional bits; C at most 32,767, the square of a range of 181 m. An energy is right to 8e-6: at four times the range to 1e-4 of it. Variances
 * saturate. */
#ifndef MOTEHOUND_SOUND_H
#define MOTEHOUND_SOUND_H

#include "motehound/geometry.h"

#define MH_SOUND_NEAR_M MH_REAL(1.0f)

struct mh_sound {
    mh_real loudness_m2;   /* C, 1 to 1e8: the square of the sensing range */
    mh_real source_sd;     /* tau, 0 to 1000: a share of the energy */
    mh_real background_sd; /* eta, 0 to 1000: units of energy; one of the two at least 0.001 */
};

/* True if the values are in their ranges. */
bool mh_sound_valid(const struct mh_sound *sound);

/* e at the square of a distance, m2. One division. */
static inline mh_real mh_sound_energy(const struct mh_sound *sound, mh_real square_m2)
{
    return mh_div(sound->loudness_m2, mh_max(square_m2, mh_squared(MH_SOUND_NEAR_M)));
}

/* Variance of y where the energy is e > 0. */
static inline mh_real mh_sound_variance(const struct mh_sound *sound, mh_real energy)
{
    return mh_add(mh_squared(mh_mul(sound->source_sd, energy)), mh_squared(sound->background_sd));
}

/* Variance of ln y there, to first order. One division. */
static inline mh_real mh_sound_log_variance(const struct mh_sound *sound, mh_real energy)
{
    return mh_add(mh_squared(sound->source_sd), mh_squared(mh_div(sound->background_sd, energy)));
}

/* The probability that a sensor detects the target (Han, Eq. (2-12)): 1 up to R - r, 0 beyond R + r, in between
 *
 *     exp(-lambda (d - (R - r))^beta) */
struct mh_sound_detection {
    mh_real range_m;  /* R */
    mh_real margin_m; /* r, 0 to R. 8 for R = 40 */
    mh_real lambda;   /* > 0. 0.0061 */
    mh_real beta;     /* > 0. 2.28 */
};

/* At distance_m >= 0. At most one logarithm and two exponentials. */
mh_real mh_sound_detected(const struct mh_sound_detection *detection, mh_real distance_m);

#endif
