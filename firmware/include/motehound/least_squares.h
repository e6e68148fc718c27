/* Linear least squares, min |A z - b|, for up to four unknowns, with bounds on the last one.
 *
 * The rows of A and b are rotated one by one (Givens) into the triangular factor R z = d of A, so memory does not grow with their
 * number and the normal equations, which would square the condition number, are never formed.
 *
 * Bounds: with the last unknown fixed, the other rows of R z = d are the least-squares problem of the unknowns that remain, and what
 * is left is a parabola in the last unknown. So the exact bounded minimiser is the free last unknown, put on the bound
 * that it violates, followed by back substitution; nothing iterates.
 *
 * Cost: one row of n unknowns takes n square roots, n divisions and about 2 n (n + 3) multiplications; a solution n divisions.
 *
 * Scaling and overflow, in fixed point. Rows come in and unknowns go out as mh_real (Q15.16). The factor and its right sides share one
 * scale: they begin with 24 fractional bits, MH_LEAST_SQUARES_GUARD_BITS beyond those of a row, and all give up one whenever one of them
 * passes 2^29, so that the largest keeps 28 significant bits whatever the number of rows; 65,535 rows of 32,767 still have 6 fractional bits.
 * A turn keeps the length of a column, which is below sqrt(5) 2^29: nothing wraps. Every sum of products is rounded once, to
 * nearest. An unknown beyond +-32,767 saturates and is refused as MH_ERR_SINGULAR. What is left of a right side is not told. */
#ifndef MOTEHOUND_LEAST_SQUARES_H
#define MOTEHOUND_LEAST_SQUARES_H

#include "motehound/share.h"
#include "motehound/status.h"

#define MH_LEAST_SQUARES_UNKNOWNS 4

/* A column whose part independent of the columns before it is a smaller share than MH_LEAST_SQUARES_RANK is taken as dependent. Entries of A
 * and b are at most MH_LEAST_SQUARES_ENTRY_MAX in size, so that no sum overflows. */
#if MH_REAL_FIXED
#define MH_LEAST_SQUARES_RANK MH_REAL(1.22e-4f) /* 2^-13: the last place of metres is 1.5e-5 */
#define MH_LEAST_SQUARES_ENTRY_MAX MH_REAL(32767.0f)
#define MH_LEAST_SQUARES_GUARD_BITS 8
#else
#define MH_LEAST_SQUARES_RANK 1e-5f
#define MH_LEAST_SQUARES_ENTRY_MAX 1e15f
#endif

struct mh_least_squares {
    uint8_t unknowns;
    uint16_t rows;                                                       /* taken so far, saturating */
    mh_real r[MH_LEAST_SQUARES_UNKNOWNS][MH_LEAST_SQUARES_UNKNOWNS + 1]; /* upper triangle R; column `unknowns`: d */
#if MH_REAL_FIXED
    int8_t scale; /* r is held 2^scale times as large */
#else
    mh_real left; /* of the last row's b; the length of all rows' is |A z - b| at the free minimiser */
#endif
};

/* Which bound the answer lies on. */
enum mh_bound { MH_BOUND_LOW = -1, MH_BOUND_NONE = 0, MH_BOUND_HIGH = 1 };

/* Begin with no rows. `unknowns`: 1 to MH_LEAST_SQUARES_UNKNOWNS. */
void mh_least_squares_begin(struct mh_least_squares *problem, uint8_t unknowns);

/* Take one equation row . z = b; `row` has one entry an unknown. Errors: MH_ERR_NOT_FINITE, MH_ERR_RANGE (an entry above
 * MH_LEAST_SQUARES_ENTRY_MAX). */
enum mh_status mh_least_squares_add(struct mh_least_squares *problem, const mh_real *row, mh_real b);

/* The minimiser z with low <= z[last] <= high; `bound` says whether a bound is active (a free minimiser that lies just on one is
 * free). If only the last unknown is undetermined it is put on `high`. Errors: MH_ERR_ARGUMENT (low > high, or NaN), MH_ERR_TOO_FEW
 * (fewer rows than unknowns), MH_ERR_SINGULAR (the other unknowns are not determined, or one is too large for mh_real). */
enum mh_status mh_least_squares_solve(const struct mh_least_squares *problem, mh_real low, mh_real high, mh_real *z,
                                      enum mh_bound *bound);

#endif
