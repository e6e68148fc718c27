/* Where a target is, by the energies of its sound at one instant.
 *
 * The default localiser: the median of triples of the five strongest nodes, whose tables may be as coarse as they like, and two iterations of weighted
 * Gauss-Newton on all of them; within 3 % of the Cramer-Rao bound. Beside it the simpler ones to compare with. All of them take one target, alone; for several see
 * joint_sources.h.
 *
 * All places are relative to an origin near the work, m. After an error the outputs are untouched: MH_ERR_NOT_FINITE, MH_ERR_RANGE (a place beyond 1e6 m, an energy
 * beyond 1e9), MH_ERR_TOO_FEW (as each says), MH_ERR_ARGUMENT (sound: see sound.h; range 1 to 1e4 m; no iteration; prior). Energies of 0 and below are in order: such
 * a node is at the end of its range, or in a likelihood at what the model says.
 *
 * Scaling and overflow (fixed point). There are mh_heard_insert(), mh_strongest(), mh_heard_centroid(), mh_distance_fix() and mh_median_fix(); what weighs by the model's variances needs
 * float. Numbers have 16 fractional bits; places are within 10 km of the origin (else MH_ERR_RANGE), distances at most MH_DISTANCE_FIX_RANGE_MAX, so that the
 * square of the sum of two has room (else MH_ERR_ARGUMENT); see circles.h. An energy comes in 20 fractional bits and is rounded to 16; at the border of an interval that may take it for the
 * next one. */
#ifndef MOTEHOUND_SOUND_FIX_H
#define MOTEHOUND_SOUND_FIX_H

#include "motehound/circles.h"
#include "motehound/distance_table.h"
#include "motehound/measurement.h"
#include "motehound/sound.h"
#include "motehound/status.h"

#include <stddef.h>

#if MH_REAL_FIXED
#define MH_DISTANCE_FIX_RANGE_MAX MH_REAL(90.0f) /* m */
#else
#define MH_DISTANCE_FIX_RANGE_MAX 1e4f
#endif

/* What one node heard. */
struct mh_heard {
    struct mh_vec2 place;
    mh_real energy;
};

/* `one` into a list of the strongest so far, strongest first, of equals the first come first; it drops out if `capacity` have as much energy. `*count` is kept up to
 * date. One comparison a place at most. */
void mh_heard_insert(struct mh_heard *heard, size_t *count, size_t capacity, const struct mh_heard *one);

/* The `capacity` strongest of `measurements` (value: energy), as above -> how many. */
size_t mh_strongest(const struct mh_measurement *measurements, size_t count, const struct mh_place *origin,
                    struct mh_heard *heard, size_t capacity);

/* Binary centroid: the mean place of the nodes. Too few: none. */
enum mh_status mh_heard_centroid(const struct mh_heard *heard, size_t count, struct mh_vec2 *position);

/* Distance measurement (Han 2.1) with the first three, which should be the strongest; of two nodes the point of two circles, of one its place. Too few: none. */
enum mh_status mh_distance_fix(const struct mh_heard *heard, size_t count, const struct mh_distance_table *table,
                               enum mh_circles_variant variant, struct mh_vec2 *position);

/* Median of triples of the first five, which should be the strongest; of three nodes and fewer mh_distance_fix() with variant uniform. Too few: none. */
enum mh_status mh_median_fix(const struct mh_heard *heard, size_t count, const struct mh_distance_table *table,
                             struct mh_vec2 *position);

/* What is known of the position besides: independent of what is heard, the same in all directions. */
struct mh_position_prior {
    struct mh_vec2 mean;
    mh_real sd_m; /* 0.001 to 1e6 */
};

/* Gauss-Newton from *position with all that was heard, weighted by the model's variances:
 *
 *     r_i = sqrt(C / max(y_i, 1/4)) - d_i,   var r_i = d_i^2 (tau^2 + (eta / e_i)^2) / 4
 *
 * each step of at most 15 m, until one is below 1 cm. `prior` may be NULL. `information`, unless NULL: sum of u u' / var r at the last point linearised about,
 * the prior's share included; Fisher's information where that is the truth. Cost: iterations (1 to 255) times one root and two divisions a node. Two iterations are
 * enough. Too few: none and no prior. */
enum mh_status mh_sound_refine(const struct mh_sound *sound, const struct mh_heard *heard, size_t count,
                               const struct mh_position_prior *prior, uint8_t iterations, struct mh_vec2 *position,
                               struct mh_sym2 *information);

/* The default localiser: mh_median_fix() with 40 intervals, then mh_sound_refine() twice. Too few: none. */
enum mh_status mh_sound_fix(const struct mh_sound *sound, const struct mh_heard *heard, size_t count,
                            const struct mh_position_prior *prior, struct mh_vec2 *position,
                            struct mh_sym2 *information);

/* Maximum likelihood by a grid of 1 m over the places within the sensing range of all nodes, and 10 m around: a baseline, a hundred times as dear. A node whose range shares
 * no place with those before it does not bound the grid, so the strongest should be first. */
enum mh_likelihood {
    MH_LIKELIHOOD_CONSTANT, /* sum (y - e)^2, as if all energies were equally certain (Han, Eqs. (2-3), (2-4)) */
    MH_LIKELIHOOD_FULL /* that of ln max(y, 1/4) with the model's variance; then on a grid of 0.1 m about the best */
};
/* At most 121 x 121 points, farther apart where that is too few; each takes a division a node, in full three and two logarithms. Too few: none. */
enum mh_status mh_likeliest(const struct mh_sound *sound, const struct mh_heard *heard, size_t count,
                            enum mh_likelihood likelihood, struct mh_vec2 *position);

#endif
