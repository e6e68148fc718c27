/* The Kalman filter in fixed point, for those who know its units. */
#ifndef KALMAN_FIXED_H
#define KALMAN_FIXED_H

#include "motehound/kalman.h"

/* mh_kalman_update without a gate, of a noise variance `variance` 2^up, as Q15.16, variance > 0. */
enum mh_status mh_kalman_update_scaled(struct mh_kalman *filter, const mh_real *h, mh_real innovation, int32_t variance,
                                       int8_t up);

#endif
