/* Small dense symmetric positive definite matrices: Cholesky factor, solution, inverse.
 *
 * An n x n symmetric matrix is its lower triangle, packed row by row: element (i, j), j <= i, is a[i (i + 1) / 2 + j]. The caller owns
 * the memory, MH_PACKED_SIZE(n) reals. Everything is done in place, n^3/6 multiplications for the factor, n^2 for a solution, n^3/3 for
 * the inverse, with n square roots. 1 <= n <= 100. */
#ifndef MOTEHOUND_MATRIX_H
#define MOTEHOUND_MATRIX_H

#include "motehound/real.h"
#include "motehound/status.h"

#define MH_PACKED_SIZE(n) ((n) * ((n) + 1) / 2)

/* Index of element (row, column) of either triangle. */
static inline int mh_packed_index(int row, int column)
{
    return row >= column ? row * (row + 1) / 2 + column : column * (column + 1) / 2 + row;
}

/* a := L with a = L L', L lower triangular. Errors: MH_ERR_SINGULAR (not positive definite in float: a pivot is below 1e-7 of its
 * diagonal element, or not finite); `a` is then half overwritten. */
enum mh_status mh_cholesky_factor(int n, mh_real *a);

/* b := A^-1 b, where `l` is the factor of A. */
void mh_cholesky_solve(int n, const mh_real *l, mh_real *b);

/* l := A^-1, where `l` is the factor of A. Symmetric positive definite by construction: a product M' M. */
void mh_cholesky_invert(int n, mh_real *l);

#endif
