/* The sound of several targets at one node, told apart by where they are expected: the share of each in the measured energy (Han, Eqs. (3-3), (3-4), (3-6)).
 *
 * Scaling and overflow (fixed point): squared distances are wide, their ratios Q15.16: a share is right to 1.5e-5 a source, and 0 where another is 181 times as near; a loudness is at most 32,767.
 *
 * The prediction need not be good: the shares of two sources 40 m apart, predicted to 3 m, are off by 0.31 in the logarithm of the energy (root mean square). What is
 * left of the energy after the others' expected sound is taken away (mh_sound_residual) is off by twice that. */
#ifndef MOTEHOUND_DECOMPOSITION_H
#define MOTEHOUND_DECOMPOSITION_H

#include "motehound/geometry.h"

#include <stddef.h>

/* The least that mh_sound_residual leaves, as a share of the energy. */
#define MH_RESIDUAL_LEAST MH_REAL(0.05f)

/* k = (1 / d_own^2) / sum_j 1 / d_j^2 over sources[own] and all others that are within `range_m` of `node`; in (0, 1]. Sources of one loudness; distances d are at
 * least 1 m. Eq. (3-6) as published has range_m = R; but what is heard of a target outside R is still 7 to 16 % of the energy: 3 R is recommended. One division a source. */
mh_real mh_sound_share(const struct mh_vec2 *sources, size_t count, size_t own, struct mh_vec2 node, mh_real range_m);

/* energy - sum_j loudness / d_j^2 over all sources but sources[own], at least MH_RESIDUAL_LEAST x energy. To compare with. */
mh_real mh_sound_residual(mh_real loudness, const struct mh_vec2 *sources, size_t count, size_t own,
                          struct mh_vec2 node, mh_real energy);

#endif
