/* Kalman filter core, linear or extended, updated with one scalar measurement at a time.
 *
 * The covariance is kept as P = U D U' (U unit upper triangular, D diagonal and positive), so it is symmetric positive
 * definite by construction: Bierman's measurement update never subtracts one variance from another, and the time update
 * factors F P F' + Q anew with a floor under every element of D. A vector measurement with independent noise is its elements,
 * one update each; they need not belong to the same instant.
 *
 * Bierman, "Factorization Methods for Discrete Sequential Estimation", 1977, chapter V. Several filters may run side by
 * side: nothing is shared. Symmetric matrices are packed as matrix.h says. Stack: 4 MH_KALMAN_MOVING_MAX^2 bytes and a copy of the filter in
 * predict, 8 MH_KALMAN_STATES_MAX and a copy of it in update, and a few registers.
 *
 * States that never change but are to be learned (a sensor's bias) come after those that move: with P = U D U' the time update leaves
 * their factors alone, but for the rows of U that tie them to the moving ones, which become F times themselves.
 *
 * Scaling and overflow. In fixed point (MH_REAL=fixed) states, F, h, innovations and U are Q15.16; P, Q and R go in and P comes out as Q15.16 too. D is kept in 28 bits with one
 * exponent for all of it, so it has no smallest variance of its own and no error adds up; sums have at least 2 guard bits; divisors are reciprocals of 30
 * bits; all is rounded to nearest. Good for variances up to 32767 (a standard deviation of 181 m), for R from 1.5e-5, and for variances of
 * one filter that lie within 2^22 of each other (standard deviations of 1 to 2000), where states are within 0.5 % of their standard deviation of what
 * infinite precision gives. Further apart: mh_kalman_init refuses (MH_ERR_RANGE); later, what has become smaller than 2^-22 of the largest of D counts as that,
 * so that the filter is more cautious than it might be, never bolder. A prior of 1e6 is not a number there: MH_ERR_NOT_FINITE. An element of U above 32767, or a state,
 * is refused with the filter as it was. P, Q and R may be in any one unit, as only their ratios matter but to a gate (whose sigmas are then in the root of
 * that unit): in 1/256 m2 they have 24 fractional bits. Error analysis: docs/fixed_point.md. */
#ifndef MOTEHOUND_KALMAN_H
#define MOTEHOUND_KALMAN_H

#include "motehound/config.h"
#include "motehound/matrix.h"
#include "motehound/real.h"
#include "motehound/status.h"

struct mh_kalman {
    uint8_t n;      /* states, 1 to MH_KALMAN_STATES_MAX */
    uint8_t moving; /* the first of them, which the time update moves, at most MH_KALMAN_MOVING_MAX */
#if MH_REAL_FIXED
    int8_t exponent; /* D is in units of 2^-(16 + exponent) */
#endif
    mh_real x[MH_KALMAN_STATES_MAX];                  /* the estimate; its owner may read it, and shift it */
    mh_real ud[MH_PACKED_SIZE(MH_KALMAN_STATES_MAX)]; /* packed: D on the diagonal, U above it */
};

/* Innovation gate: refuses a measurement whose innovation exceeds `sigmas` of its own standard deviations, but at most `patience` of
 * them in a row. The next one is believed: the covariance is widened until that innovation stands just at the gate, and the
 * update is made, unless the widened covariance would overflow. So an outlier is kept out, and a filter that has lost its target is not locked out for good. */
struct mh_gate {
    mh_real sigmas;   /* > 0 */
    uint8_t patience; /* >= 0 */
    uint8_t refused;  /* so far in a row; starts at 0 */
    mh_real surprise; /* of the last measurement: its innovation squared over the innovation's variance */
};

/* Begin with n moving states at x, with covariance P (packed). Errors: MH_ERR_ARGUMENT (n not 1 to MH_KALMAN_MOVING_MAX), MH_ERR_NOT_FINITE, MH_ERR_SINGULAR (P is not
 * positive definite to the precision of mh_real); in fixed point MH_ERR_RANGE (a variance below 2^-22 of the largest). */
enum mh_status mh_kalman_init(struct mh_kalman *filter, uint8_t n, const mh_real *x, const mh_real *P);

/* One more state, that does not move and that nothing is known of but its mean and variance. Errors: MH_ERR_CAPACITY (there are
 * MH_KALMAN_STATES_MAX), MH_ERR_NOT_FINITE, MH_ERR_SINGULAR (variance not above 0). */
enum mh_status mh_kalman_append(struct mh_kalman *filter, mh_real mean, mh_real variance);

/* x = F x, P = F P F' + Q for the n = filter->moving states. F: n x n, row by row; Q: packed, positive semidefinite. A direction whose
 * variance is lost in the rounding of a larger one keeps 2^-21 of that one. Leading zeros of the rows of F cost nothing: about
 * n (n + 1) (2 n + 10) / 6 multiplications for an upper triangular F, about n^2 (n + 4) for a full one; n divisions. With m states that do
 * not move, m n (n + 1) / 2 or m n^2 multiplications more.
 * Errors: MH_ERR_NOT_FINITE (an input, or the result overflows), MH_ERR_SINGULAR (F P F' + Q has a variance of 0); in fixed point MH_ERR_RANGE (U overflows). */
enum mh_status mh_kalman_predict(struct mh_kalman *filter, const mh_real *F, const mh_real *Q);

/* Take one scalar z = h' x + noise, as `innovation` = z - h' x (for an EKF: z minus the predicted measurement, with h its
 * gradient at x), with noise variance R = `variance` >= 1.2e-38. gate may be NULL. 3 n^2 / 2 + 9 n / 2 multiplications, 2 n + 1 divisions.
 * Errors: MH_NONE (refused by the gate, which counts it; the filter is untouched), MH_ERR_NOT_FINITE (an input, or the result is too
 * large or too small for mh_real), MH_ERR_ARGUMENT (variance below its range, which in fixed point begins at 1.5e-5); in fixed point MH_ERR_RANGE (U overflows). */
enum mh_status mh_kalman_update(struct mh_kalman *filter, const mh_real *h, mh_real innovation, mh_real variance,
                                struct mh_gate *gate);

/* The first `count` rows and columns of P, packed. */
void mh_kalman_covariance_of(const struct mh_kalman *filter, uint8_t count, mh_real *P);

/* Element (i, i) of P. */
mh_real mh_kalman_variance(const struct mh_kalman *filter, uint8_t i);

/* P, packed. */
static inline void mh_kalman_covariance(const struct mh_kalman *filter, mh_real *P)
{
    mh_kalman_covariance_of(filter, filter->n, P);
}

/* U and D of the n states as bytes at *at, which is moved on: the upper halves of IEEE 754 binary32 numbers, 8 significant bits, the same in either arithmetic. Rounding U and D leaves a
 * covariance, rounding P might not. */
#define MH_KALMAN_FACTOR_BYTES(n) (2 * MH_PACKED_SIZE(n))
void mh_kalman_write_factors(const struct mh_kalman *filter, uint8_t **at);

/* And back into a filter whose n is set. Errors: MH_ERR_CORRUPT (an element of U that is none, one of D outside 1e-24 to 1e12, a variance outside 1e-12 to 1e12, in fixed point above 32,767); the filter is then half
 * overwritten. */
enum mh_status mh_kalman_read_factors(struct mh_kalman *filter, const uint8_t **at);

/* F and Q of motion at constant velocity in the plane for dt > 0 seconds, states (x, y, vx, vy), with white acceleration of
 * `intensity` (m/s2)2 s in each axis (Bar-Shalom, Li and Kirubarajan, 2001, Eq. (6.2.2-12)). F: 16 elements, Q: 10, packed. In fixed point the
 * variance of the position is rounded so that Q stays positive semidefinite. */
void mh_kalman_constant_velocity(mh_real dt, mh_real intensity, mh_real *F, mh_real *Q);

#endif
