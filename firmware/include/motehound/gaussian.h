/* A state estimate: mean and covariance of up to MH_STATES_MAX states. What the filters (ekf.h, ukf.h, iterated_ekf.h) update, what fusion
 * (fusion.h) joins, and what travels between motes.
 *
 * The covariance is packed as matrix.h says, so it is symmetric by construction; that it is positive definite is checked whenever it comes
 * from outside, and again by every function that changes it. */
#ifndef MOTEHOUND_GAUSSIAN_H
#define MOTEHOUND_GAUSSIAN_H

#include "motehound/config.h"
#include "motehound/matrix.h"
#include "motehound/real.h"
#include "motehound/status.h"

#include <stddef.h>

struct mh_gaussian {
    uint8_t n;                                /* states, 1 to MH_STATES_MAX */
    mh_real x[MH_STATES_MAX];                 /* mean */
    mh_real P[MH_PACKED_SIZE(MH_STATES_MAX)]; /* covariance, packed */
};

/* Bytes that n states take in a message. */
#define MH_GAUSSIAN_BYTES(n) (4 * ((n) + MH_PACKED_SIZE(n)))

/* Errors: MH_ERR_ARGUMENT (n), MH_ERR_NOT_FINITE, MH_ERR_SINGULAR (P is not positive definite to the precision of mh_real). */
enum mh_status mh_gaussian_check(const struct mh_gaussian *gaussian);

/* Mean, then covariance -> bytes, each number as bytes.h puts it. Returns MH_GAUSSIAN_BYTES(n). */
size_t mh_gaussian_write(const struct mh_gaussian *gaussian, uint8_t *bytes);

/* And back, of n states; `gaussian` is untouched after an error. Errors: MH_ERR_CORRUPT (whatever mh_gaussian_check finds). */
enum mh_status mh_gaussian_read(struct mh_gaussian *gaussian, uint8_t n, const uint8_t *bytes);

/* x = F x, P = F P F' + Q: F n x n, row by row; Q packed. Errors: MH_ERR_NOT_FINITE, MH_ERR_SINGULAR. */
enum mh_status mh_gaussian_predict(struct mh_gaussian *gaussian, const mh_real *F, const mh_real *Q);

#endif
