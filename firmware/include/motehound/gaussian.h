/* A state estimate: mean and covariance of up to MH_STATES_MAX states. What the filters (ekf.h, ukf.h, iterated_ekf.h) update, what fusion
 * (fusion.h) joins, and what travels between motes.
 *
 * The covariance is packed as matrix.h says, so it is symmetric by construction; that it is positive definite is checked whenever it comes
 * from outside, and again by every function that changes it.
 *
 * Scaling and overflow. In fixed point (MH_REAL=fixed) there are mh_gaussian_check, mh_gaussian_write and mh_gaussian_read; what changes an estimate is in kalman.h and fusion.h. The
 * covariance is Q15.16, so a variance is at most 32767 and is right to 7.6e-6; the check scales the largest to 28 bits and finds a P whose variances are further
 * apart than 2^22 out of its range (MH_ERR_RANGE). In messages the numbers are IEEE binary32, of 24 significant bits, as a float's. */
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

/* x = F x, P = F P F' + Q: F n x n, row by row; Q packed, positive semidefinite. P is made as the product of F L with its transpose, P = L L', and
 * what rounding would take from a pivot it gets back (MH_PIVOT_FLOOR). Zeros of F cost nothing: at most 4 n^3 / 3 + n^2 multiplications, 2 n roots.
 * Stack, N = MH_STATES_MAX: 10 N^2 + 14 N bytes and registers.
 * Errors: MH_ERR_ARGUMENT (n), MH_ERR_NOT_FINITE (an input, or the result overflows), MH_ERR_SINGULAR (P before, or F P F' + Q, is not positive definite). */
enum mh_status mh_gaussian_predict(struct mh_gaussian *gaussian, const mh_real *F, const mh_real *Q);

/* P = F P F' + Q for a part of a covariance, which may be only positive semidefinite (nothing is checked): packed, n <= MH_STATES_MAX; Q NULL for none. */
void mh_covariance_predict(uint8_t n, mh_real *P, const mh_real *F, const mh_real *Q);

/* After an update: A = I - K H of it, n x n, row by row, from the Gaussians before and after, as P_after P_before^-1. With it follow the parts that a
 * covariance is split into (fusion.h), P_part = A P_part A' + K R K': mh_covariance_predict(n, P_part, A, ...). Errors: as of mh_gaussian_check, of
 * `before`; MH_ERR_ARGUMENT too if their numbers of states differ. */
enum mh_status mh_gaussian_reduction(const struct mh_gaussian *before, const struct mh_gaussian *after, mh_real *A);

/* A Gaussian while it is worked upon, with its covariance as P = L L', L lower triangular with a positive diagonal and packed. So P cannot lose its
 * positive definiteness, whatever is done to L. For those who write filters; their users need it not. */
struct mh_gaussian_root {
    uint8_t n;
    mh_real x[MH_STATES_MAX];
    mh_real L[MH_PACKED_SIZE(MH_STATES_MAX)];
};

/* L from P. n^3 / 6 multiplications, n roots. Errors: as of mh_gaussian_check, which is this. */
enum mh_status mh_gaussian_factor(struct mh_gaussian_root *root, const struct mh_gaussian *gaussian);

/* c = L' h: the gradient h of a scalar with respect to the state -> with respect to L^-1 x, which has the covariance I. */
void mh_gaussian_root_gradient(const struct mh_gaussian_root *root, const mh_real *h, mh_real *c);

/* One scalar measured: c = L' h for its gradient h, its innovation, its noise variance. P becomes P - P h h' P / (h' P h + variance), as
 * L becomes L T with T T' = I - c c' / (c' c + variance) and T lower triangular (Carlson, AIAA Journal 11, 1973, pp. 1259-1265, there with upper triangles):
 * nothing is subtracted from a variance. 3 n^2 / 2 + 7 n multiplications, n roots, 2 n divisions. What is not finite shows in mh_gaussian_compose. */
void mh_gaussian_root_take(struct mh_gaussian_root *root, const mh_real *c, mh_real innovation, mh_real variance);

/* The same in its parts, for quantities besides the states: one that is linear in them with gradient h has the row L' h, which is to be turned too,
 * and its mean moves by what mh_root_turn_row returns. `c` must last as long as the turn. */
struct mh_root_turn {
    const mh_real *c;
    mh_real scale[MH_STATES_MAX], share[MH_STATES_MAX]; /* T: its diagonal, and what times -c is below it */
    mh_real step;                                       /* innovation over its variance */
};
void mh_root_turn_begin(struct mh_root_turn *turn, uint8_t n, const mh_real *c, mh_real innovation, mh_real variance);
mh_real mh_root_turn_row(const struct mh_root_turn *turn, mh_real *row, uint8_t length);
void mh_gaussian_root_apply(struct mh_gaussian_root *root, const struct mh_root_turn *turn);

/* P = L L'. Where its correlations are so near to singular that rounding could take a pivot, here or on the machine that P is sent to, every variance is
 * raised by MH_PIVOT_FLOOR of it, so that P can be factored again. `gaussian` is untouched after an error: MH_ERR_NOT_FINITE (a state or a variance),
 * MH_ERR_SINGULAR (a variance too small for mh_real). */
enum mh_status mh_gaussian_compose(struct mh_gaussian *gaussian, const struct mh_gaussian_root *root);

/* The same for x and P as they came out of a sum of products: `gaussian` itself is checked, and its pivots raised where rounding has swallowed them. Its
 * contents are not to be used after an error, MH_ERR_NOT_FINITE or MH_ERR_SINGULAR. */
enum mh_status mh_gaussian_settle(struct mh_gaussian *gaussian);

#endif
