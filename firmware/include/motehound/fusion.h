/* Fusion of estimates: what several, each with a covariance of its own, say together of one state.
 *
 * If their errors were independent, information would simply add up (mh_fusion_naive). Estimates of one target hardly ever are: they share the
 * target's process noise, a prior, a sensor, or news that has come to both by different ways. Which rule is right depends on what is known of that:
 *
 * | rule | holds if | promises |
 * |---|---|---|
 * | covariance intersection (mh_fusion_intersect) | always | the true covariance is at most the stated one, whatever the correlation |
 * | split covariance intersection (mh_fusion_split) | what is called independent is | the same, and tighter |
 * | inverse covariance intersection (mh_fusion_inverse) | they share one common estimate and nothing else | the same, and tighter |
 * | ellipsoidal intersection (mh_fusion_ellipsoidal) | about the same | tighter still; no guarantee |
 * | increments of information (mh_fusion_add) | each tells only what it has measured since it last told | as good as one filter with all the data |
 * | naive (mh_fusion_naive) | errors are independent | the optimum then, overconfidence else; for comparison |
 *
 * An estimate is a struct mh_gaussian of any number of states up to MH_STATES_MAX. Inputs are checked: whatever is not finite, not positive definite to the
 * precision of mh_real, or not of the same number of states is refused, and the output is as it was. Outputs may be one of the inputs. Results are symmetric
 * positive definite by construction: wherever theory allows it they are sums and products of such matrices, not differences.
 *
 * Errors of all functions that return a status: MH_ERR_ARGUMENT (count is 0 or above MH_FUSED_MAX, the numbers of states differ or are out of range, a weight is
 * negative, their sum is not 1), MH_ERR_NOT_FINITE (an input, or the result overflows), MH_ERR_SINGULAR (a covariance, or the result's, is not positive definite).
 *
 * Scaling and overflow. In fixed point (MH_REAL=fixed) there are covariance intersection, with weights given or by the traces, and the naive rule, of up to
 * MH_KALMAN_MOVING_MAX states; all else returns MH_ERR_ARGUMENT. States and covariances are Q15.16. No information matrix is made: the estimate of the largest weight is a
 * Kalman filter, in the formats of kalman.h, that takes the others as measurements, and the same ranges hold: variances up to 32767, within 2^22 of each other in one
 * estimate, or MH_ERR_RANGE. Weights below 2^-14 count as 0. A state comes within 0.1 % of its standard deviation; the covariance is rounded up, by 2^-10 of itself and
 * n units in the last place of the diagonal, so that it is not below the rule's in any direction. docs/fixed_point.md has the error analysis.
 *
 * Julier and Uhlmann, "A non-divergent estimation algorithm in the presence of unknown correlations", 1997; Xu, Eqs. (29)-(32). Measured costs: docs/costs.md. */
#ifndef MOTEHOUND_FUSION_H
#define MOTEHOUND_FUSION_H

#include "motehound/gaussian.h"

/* The rules by which a fusion centre (fusion_centre.h) joins its clusters' summaries, and the kind of summary that each needs (summary.h). */
enum mh_fusion_rule {
    MH_FUSION_CI,           /* covariance intersection, weights by the traces, Xu, Eq. (32): plain */
    MH_FUSION_CI_TRACE_OPT, /* covariance intersection, trace-optimal weights, Xu, Eq. (31): plain */
    MH_FUSION_CI_DET,       /* covariance intersection, determinant-optimal weights: plain */
    MH_FUSION_SCI,          /* split covariance intersection: split */
    MH_FUSION_ICI,          /* inverse covariance intersection: plain */
    MH_FUSION_EI,           /* ellipsoidal intersection: plain */
    MH_FUSION_HIF,          /* information increments: increment */
    MH_FUSION_HIF_FEEDBACK, /* the same, and the clusters are told the result: increment */
    MH_FUSION_NAIVE,        /* as if independent, for comparison: plain */
    MH_FUSION_CENTRAL       /* no centre: one tracker that gets every sample */
};

/* Covariance intersection with weights w[0 .. count) >= 0 of sum 1 (Xu, Eqs. (29)-(30)):
 *
 *     P^-1 = sum w_i P_i^-1,   x = P sum w_i P_i^-1 x_i
 *
 * Of identical estimates it is that estimate. An estimate of weight 0 is checked but has no say. */
enum mh_status mh_fusion_intersect(const struct mh_gaussian *estimates, uint8_t count, const mh_real *w,
                                   struct mh_gaussian *fused);

/* Its weights, without a search (Xu, Eq. (32)): w_i = (1 / tr P_i) / sum_j (1 / tr P_j). n additions and a division each. The trace adds up what has
 * different units, so states are best scaled to matter alike. Of the estimates only what it reads, the variances, is checked. */
enum mh_status mh_fusion_weights(const struct mh_gaussian *estimates, uint8_t count, mh_real *w);

/* Its weights that make tr P smallest (Xu, Eq. (31)), or det P: by the fixed points w_i <- w_i sqrt(tr(P P_i^-1 P)) and w_i <- w_i tr(P P_i^-1) / n, normalised,
 * each step of which improves on the last. At most MH_FUSION_STEPS steps, fewer once no weight moves by more than 1e-6; a covariance inverse each. The determinant's
 * weights do not depend on the units. */
enum mh_status mh_fusion_weights_trace(const struct mh_gaussian *estimates, uint8_t count, mh_real *w);
enum mh_status mh_fusion_weights_determinant(const struct mh_gaussian *estimates, uint8_t count, mh_real *w);

/* All errors independent: P^-1 = sum P_i^-1, x = P sum P_i^-1 x_i. */
enum mh_status mh_fusion_naive(const struct mh_gaussian *estimates, uint8_t count, struct mh_gaussian *fused);

/* An estimate whose error is the sum of two: one that may depend on the other estimates' in any way (`dependent.P`) and one that is independent of them
 * (`independent`, packed). Each may be singular, even zero; their sum is positive definite. */
struct mh_split_gaussian {
    struct mh_gaussian dependent;
    mh_real independent[MH_PACKED_SIZE(MH_STATES_MAX)];
};

/* Errors: as above. */
enum mh_status mh_split_check(const struct mh_split_gaussian *estimate);

/* Split covariance intersection of two (Julier and Uhlmann, 2001): Pa = Pad / w + Pai, Pb = Pbd / (1 - w) + Pbi, P^-1 = Pa^-1 + Pb^-1, x = P (Pa^-1 xa + Pb^-1 xb),
 * Pi = P (Pa^-1 Pai Pa^-1 + Pb^-1 Pbi Pb^-1) P, Pd = P - Pi, with the w in 0 to 1 that makes tr P smallest. All independent: the naive rule; all dependent:
 * covariance intersection. More than two are joined one after the other; the result depends on the order, a little. */
enum mh_status mh_fusion_split(const struct mh_split_gaussian *a, const struct mh_split_gaussian *b,
                               struct mh_split_gaussian *fused);

/* Inverse covariance intersection of two (Noack, Sijs, Reinhardt and Hanebeck, 2017): P^-1 = Pa^-1 + Pb^-1 - M, M = (w Pa + (1 - w) Pb)^-1,
 * x = P ((Pa^-1 - w M) xa + (Pb^-1 - (1 - w) M) xb), with the w in 0 to 1 that makes tr P smallest. More than two: as above. */
enum mh_status mh_fusion_inverse(const struct mh_gaussian *a, const struct mh_gaussian *b, struct mh_gaussian *fused);

/* Ellipsoidal intersection of two (Sijs and Lazar, 2012): in the basis in which both covariances are diagonal the better of both, direction by direction.
 * Where they are equally good, their mean. More than two: as above. */
enum mh_status mh_fusion_ellipsoidal(const struct mh_gaussian *a, const struct mh_gaussian *b,
                                     struct mh_gaussian *fused);

/* What has been learned: an information matrix and vector, the differences of P^-1 and P^-1 x between two estimates of one instant. Positive semidefinite but for
 * rounding. */
struct mh_information {
    uint8_t n;
    mh_real vector[MH_STATES_MAX];
    mh_real matrix[MH_PACKED_SIZE(MH_STATES_MAX)];
};

/* What `posterior` knows more than `reference`, the same filter's estimate without the measurements since, predicted to the same instant. */
enum mh_status mh_fusion_increment(const struct mh_gaussian *posterior, const struct mh_gaussian *reference,
                                   struct mh_information *increment);

/* P^-1 = P_0^-1 + sum dI_i, P^-1 x = P_0^-1 x_0 + sum di_i: information that adds up (hierarchical fusion without approximation where the increments are of different
 * measurements). count may be 0. MH_ERR_SINGULAR also if an increment takes more than rounding away: P_0^-1 + 1000 dI_i must be positive definite. */
enum mh_status mh_fusion_add(const struct mh_gaussian *prior, const struct mh_information *increments, uint8_t count,
                             struct mh_gaussian *fused);

#endif
