/* The scalar Sage-Husa filter of Luo, Chai and Yang, Appendix 2: a random walk with a known input u,
 *
 *     f(l) = f(l-1) + u + w, w ~ N(q, G),      e(l) = f(l) + n, n ~ N(r, R),
 *
 * that estimates the means and variances of both noises along with f. One filter a coordinate. The recursion as published may lose
 * positive variances; here G and R have floors, so G, R and P stay positive for ever. Cost of a step: one division.
 *
 * Scaling and overflow, in fixed point. Positions, means and variances are mh_real (Q15.16), weight and gain mh_share (Q1.30); every product is rounded once, to nearest,
 * so q and r may rest up to 2^-17 / weight from where they belong, 0.25 mm for the nominal weight of 0.03, and G and R 2.5e-4 m2. P is at least half of the smaller floor: it
 * does not round to 0. All sums have room for |f|, |q|, |e|, |u| and |e - (f + q + u)| up to 8,000 m, for G and R up to 8,000 m2, and for a
 * measurement 181 m from its prediction, whose square is the largest variance of the format; a step beyond is refused as MH_ERR_RANGE. */
#ifndef MOTEHOUND_SAGE_HUSA_H
#define MOTEHOUND_SAGE_HUSA_H

#include "motehound/share.h"
#include "motehound/status.h"

/* Where the filter begins, and its floors. All 1e-12 to 1e9 (fixed point: 2.44e-4 to 8,000), in squared units of the state (nominal: m2). */
struct mh_sage_husa_config {
    mh_real process_variance;     /* G at the start; nominal 1 */
    mh_real measurement_variance; /* R at the start; nominal 10 */
    mh_real estimate_variance;    /* P at the start; nominal 10 */
    mh_real process_floor;        /* least G; nominal 1e-3 */
    mh_real measurement_floor;    /* least R; nominal 0.1 */
};

struct mh_sage_husa {
    mh_real estimate;             /* f; its owner may set it, as the start value or where a step is left out */
    mh_real estimate_variance;    /* P; does not hold the error of u, so it is no measure of the error of f */
    mh_real process_mean;         /* q */
    mh_real process_variance;     /* G */
    mh_real measurement_mean;     /* r */
    mh_real measurement_variance; /* R */
};

void mh_sage_husa_config_default(struct mh_sage_husa_config *config);

/* Begin at `estimate` with q = r = 0. Errors: MH_ERR_ARGUMENT (a variance outside its range), MH_ERR_NOT_FINITE. */
enum mh_status mh_sage_husa_init(struct mh_sage_husa *filter, const struct mh_sage_husa_config *config,
                                 mh_real estimate);

/* The weight (1 - b)(1 - b^(l-1)) of measurement number l >= 1 for the forgetting factor 0 < b < 1. Unlike the usual (1 - b)/(1 - b^l)
 * it grows from nothing to 1 - b, which is what keeps the joint estimate of q and r from running away. */
mh_share mh_sage_husa_weight(mh_real forgetting, uint32_t l);

/* One measurement e with input u; weight from mh_sage_husa_weight. Errors: MH_ERR_NOT_FINITE, MH_ERR_RANGE (|e|, |u| or the
 * difference of e from the prediction above 1e9; weight outside 0 to 1;
 * fixed point: what has no room). */
enum mh_status mh_sage_husa_step(struct mh_sage_husa *filter, const struct mh_sage_husa_config *config,
                                 mh_real measurement, mh_real input, mh_share weight);

#endif
