/* Which of several places a gas leaks from, and how much, from sensors at rest in a wind that turns: for each place the regression of the readings on
 * what a plume from there would bring, by least squares.
 *
 * With excess z above the background and the plume's concentration g for a release of 1, a release of q leaves the residual
 *
 *     sum (z - q g)^2 = sum z^2 - 2 q sum g z + q^2 sum g^2,   smallest at   q = max(sum g z / sum g^2, 0)
 *
 * (the profile over the rate, Zhang). So two sums a place keep all that readings and winds say: neither is stored, however long it lasts, and
 * one place is told from another because the wind brings the gas of each to a sensor at different times.
 *
 * Memory: 8 bytes a place. Cost of a reading: one plume model for each place and plume. */
#ifndef MOTEHOUND_PLUME_REGRESSION_H
#define MOTEHOUND_PLUME_REGRESSION_H

#if MH_REAL_FIXED
#error "motehound/plume_regression.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/config.h"
#include "motehound/plume.h"

struct mh_plume_regression {
    struct {
        mh_real gg, gz; /* sum g^2, sum g z */
    } places[MH_LEAK_PLACES_MAX];
    mh_real zz;    /* sum z^2 */
    mh_real count; /* of readings, those forgotten in part counted in part */
};

/* A plume in the air of the moment, and the share of the gas that it carries. */
struct mh_plume_share {
    struct mh_plume plume;
    mh_real share; /* >= 0 */
};

struct mh_plume_fit {
    uint16_t place;     /* the likeliest */
    mh_real rate;       /* of release there, > 0, in the unit of plume.h times that of z */
    mh_real likelihood; /* of that place among all, to 1 */
    /* Second moments of the places about the likeliest, m2: 0 where no other is likely. */
    struct mh_sym2 spread;
};

/* Nothing is known. */
void mh_plume_regression_init(struct mh_plume_regression *regression);

/* All that was taken counts `keep` times as much, 0 to 1: so that in the long run the past is forgotten. */
void mh_plume_regression_forget(struct mh_plume_regression *regression, mh_real keep);

/* A sensor reads z above its background, in air that carries the gas in the plumes[0 .. plume_count) with their shares: the average over the directions
 * and travel times of a minute. places[0 .. count), count up to MH_LEAK_PLACES_MAX, and the sensor in metres from one origin; the same
 * places at each call. Errors: MH_ERR_ARGUMENT (count), MH_ERR_NOT_FINITE. */
enum mh_status mh_plume_regression_take(struct mh_plume_regression *regression, const struct mh_vec2 *places,
                                        uint16_t count, const struct mh_plume_share *plumes, uint8_t plume_count,
                                        struct mh_vec2 sensor, mh_real z);

/* The likeliest place. The likelihood of a place whose residual is S is proportional to S^(-n/2), which is the profile over an unknown noise too, for
 * n = readings taken / correlation: `correlation` >= 1 readings tell as much as a single one would if errors came alone, as those of a plume
 * model do not. Errors: MH_ERR_ARGUMENT (count, correlation), MH_NONE (nothing was taken, or no place explains any of it). */
enum mh_status mh_plume_regression_solve(const struct mh_plume_regression *regression, const struct mh_vec2 *places,
                                         uint16_t count, mh_real correlation, struct mh_plume_fit *fit);

#endif
