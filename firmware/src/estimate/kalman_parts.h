/* What the Kalman filter is made of, each part in one file: kalman.c and kalman_fixed.c know what a variance in D is worth, kalman_parts.c does not need to. */
#ifndef KALMAN_PARTS_H
#define KALMAN_PARTS_H

#include "motehound/kalman.h"

/* `variance` as an element of D, for which it makes room. */
mh_real mh_kalman_variance_for(struct mh_kalman *filter, mh_real variance);

/* Element (i, j) of P, i <= j. */
mh_real mh_kalman_element(const struct mh_kalman *filter, uint_fast8_t i, uint_fast8_t j);

/* The rows of U that tie the states that do not move to the others: F times themselves. */
enum mh_status mh_kalman_move_ties(struct mh_kalman *next, const struct mh_kalman *filter, const mh_real *F);

#if MH_REAL_FIXED
/* mh_kalman_update without a gate, of a noise variance `variance` 2^up, as Q15.16, variance > 0. */
enum mh_status mh_kalman_update_scaled(struct mh_kalman *filter, const mh_real *h, mh_real innovation, int32_t variance,
                                       int8_t up);
#endif

#endif
