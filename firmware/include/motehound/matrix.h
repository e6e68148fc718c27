/* Small dense symmetric positive definite matrices: Cholesky factor, solution, inverse.
 *
 * An n x n symmetric matrix is its upper triangle, packed column by column (or, the same numbers, its lower triangle row
 * by row): (0,0), (0,1), (1,1), (0,2), ... The caller owns the memory, MH_PACKED_SIZE(n) reals. Everything is done in place,
 * n^3/6 multiplications for the factor, n^2 for a solution, n^3/3 for the inverse, with n square roots. 1 <= n <= 100. All
 * but the packing needs MH_REAL=float; fixed point has mh_ud_factor (scaled_fixed.h), and solves nothing (kalman.h, fusion.h). */
#ifndef MOTEHOUND_MATRIX_H
#define MOTEHOUND_MATRIX_H

#include "motehound/real.h"
#include "motehound/status.h"

#define MH_PACKED_SIZE(n) ((n) * ((n) + 1) / 2)

/* The same of a number known at run time, n <= 16. */
static inline uint_fast8_t mh_packed_size(uint8_t n) { return (uint_fast8_t)MH_PACKED_SIZE(n); }

/* Index of element (row, column), row <= column; a constant where both are. */
#define MH_PACKED(row, column) ((column) * ((column) + 1) / 2 + (row))

/* The same for either triangle. */
static inline int mh_packed_index(int row, int column)
{
    return row <= column ? MH_PACKED(row, column) : MH_PACKED(column, row);
}

/* a := L with a = L L', L lower triangular. Errors: MH_ERR_SINGULAR (not positive definite in float: a pivot is below 1e-7 of its
 * diagonal element, or not finite); `a` is then half overwritten. */
enum mh_status mh_cholesky_factor(int n, mh_real *a);

/* The same, but a pivot that is lost in rounding, below MH_PIVOT_FLOOR of its diagonal element, is raised to that, as if the diagonal element
 * had been larger: the factor of A + D, D diagonal and not negative. `*raised`: whether D is not zero. Errors: MH_ERR_SINGULAR (a diagonal element is
 * not positive or not finite, or a pivot is further below zero than rounding explains, 16 times that: A is indefinite); `a` is then half overwritten. */
#define MH_PIVOT_FLOOR (1.0f / 1048576.0f) /* 16 units in the last place */
enum mh_status mh_cholesky_factor_raised(int n, mh_real *a, bool *raised);

/* l := L L', of the factor L. */
void mh_cholesky_multiply(int n, mh_real *l);

/* b := L b, and b := L^-1 b, of the factor L. */
void mh_lower_multiply(int n, const mh_real *l, mh_real *b);
void mh_lower_solve(int n, const mh_real *l, mh_real *b);

/* b := A^-1 b, where `l` is the factor of A. */
void mh_cholesky_solve(int n, const mh_real *l, mh_real *b);

/* l := L^-1, of the factor L; lower triangular too. */
void mh_cholesky_invert_factor(int n, mh_real *l);

/* l := A^-1, where `l` is the factor of A. Symmetric positive definite by construction: a product M' M. */
void mh_cholesky_invert(int n, mh_real *l);

#endif
