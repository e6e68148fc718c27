/* The distance of a target by the energy of its sound, in a few intervals: the distance measurement of Han (2.1), which a node can do without a
 * division or a root, and send in a few bits.
 *
 * The sensing range R is divided into n intervals of width D = R / n. Interval k, from (k - 1) D to k D, is that of the energies n_k <= y < n_(k-1) with
 * n_k = (n / k)^2, in units of the energy at R; n_0 is infinite. For all n that divide 40, so for 4, 8, 10, 20 and 40, the n_k are constants in flash; for
 * others they are computed. Binary search: at most log2(n) + 1 comparisons.
 *
 * Scaling and overflow (fixed point): 16 fractional bits. n_k is rounded to 8e-6 of the least energy; n_1 of more than 181 intervals is infinite, and so are the energies that
 * would belong to the first. A distance is right to n roundings of the width, n 8e-6 m, undivided to 1e-5 of it. */
#ifndef MOTEHOUND_DISTANCE_TABLE_H
#define MOTEHOUND_DISTANCE_TABLE_H

#include "motehound/real.h"

/* What is said of interval k */
enum mh_distance_mode {
    MH_DISTANCE_OUTER,    /* the middle; in the first interval its outer end D (Han, Fig. 2-5) */
    MH_DISTANCE_MIDDLE,   /* the middle; the default */
    MH_DISTANCE_CENTROID, /* the middle; in the first interval 2 D / 3, the mean distance of a disc's points */
    MH_DISTANCE_LINEAR    /* between its ends by the energy, Eq. (2-5); in the first interval D n_1 / y */
};

struct mh_distance_table {
    mh_real range_m;   /* R, > 0 */
    uint8_t intervals; /* n, 1 to 255; 0: the distance itself, R / sqrt(y), at least 1 m */
    uint8_t mode;      /* enum mh_distance_mode; of no account if n = 0 */
};

/* k, 1 to n; n + 1 where y < 1, beyond the range. n = 1 to 255. */
uint16_t mh_distance_interval(uint8_t intervals, mh_real energy);

/* The distance, m; R where y < 1, so for energies of 0 and below too. The energy must be finite. */
mh_real mh_distance(const struct mh_distance_table *table, mh_real energy);

#endif
