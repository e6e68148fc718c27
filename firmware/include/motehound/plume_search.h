/* Where a leak can be, given what sensors read of its plume (plume.h): a grid of places on which the rate of release is eliminated, to start from and to
 * see whether more than one place is likely.
 *
 * At a given place the model is linear in the rate q, so that the best rate follows from two sums, put within three standard deviations of the prior; three
 * Gauss-Newton steps in ln q then take the prior in. What is minimised is
 *
 *     f(s) = min over q of  sum (z - q g(s))^2 / R + (ln q - l)^2 / var(l) + (s - m)' diag(var(m))^-1 (s - m)
 *
 * and exp(-f / 2) is the weight of a place in the moments. The cells are as square as an area of any shape allows, MH_GAS_CELLS of them or a few fewer; each
 * is represented by its centre. A step of search costs one root, one exponential and one division for each cell and sensor. */
#ifndef MOTEHOUND_PLUME_SEARCH_H
#define MOTEHOUND_PLUME_SEARCH_H

#if MH_REAL_FIXED
#error "motehound/plume_search.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/config.h"
#include "motehound/plume.h"

#define MH_PLUME_STARTS 3
#define MH_PLUME_APART 2 /* cells: of two starts that are no farther apart in x and y only the better one counts */

struct mh_plume_problem {
    const struct mh_plume *plume;
    struct mh_vec2 low, high; /* corners of the area, m */
    mh_real prior[3];         /* mean of x, y and ln q, ... */
    mh_real variance[3];      /* ... independent, > 0 */
    uint16_t count;           /* of samples */
    const struct mh_vec2 *places;
    const mh_real *z;      /* sample = scale * q * concentration(plume.h) + noise ... */
    const mh_real *weight; /* ... of variance 1 / weight */
    mh_real scale;
};

struct mh_plume_search {
    uint8_t starts;                    /* how many of the best cells there are */
    mh_real start[MH_PLUME_STARTS][3]; /* their x, y and ln q, the best first ... */
    mh_real cost[MH_PLUME_STARTS];     /* ... and f */
    mh_real mean[3], variance[3];      /* of x, y and ln q over the grid, weighted by exp(-f / 2) */
};

/* `gains`: room for problem->count reals. Errors: MH_ERR_NOT_FINITE (no cell has a finite cost). */
enum mh_status mh_plume_search(const struct mh_plume_problem *problem, mh_real *gains, struct mh_plume_search *search);

#endif
