/* The fit of a source's recent path to the increments it left at the nodes: a window of knots, one a sampling instant, joined by straight
 * segments, and the release rate, by Levenberg-Marquardt on the exact line-source model of Luo, Eq. (1)-(2), (7).
 *
 * Unknowns: the m + 1 knots of the window, oldest first, two coordinates each, then ln(release rate) on the newest segment and its step from
 * segment to segment: n = 2 (m + 1) + 2.
 * Residuals:
 *   data    (y - h) / sqrt(R), Cauchy 4 (sensors fail): y the increment of a node at an instant in the window, h what the model says: the frozen trail's share
 *           (the row's `base`) plus rate times the segments since, now minus one interval before;
 *   prior   of the oldest knot, Gaussian; of the changes of velocity from segment to segment, Huber 1.5 (a source mostly keeps its course, and
 *           sometimes turns sharply); of ln(rate) and its step, Gaussian.
 * A fit without any row is the prior's prediction, with its covariance. */
#ifndef MOTEHOUND_TRAIL_FIT_H
#define MOTEHOUND_TRAIL_FIT_H

#if MH_REAL_FIXED
#error "motehound/trail_fit.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/matrix.h"
#include "motehound/status.h"
#include "motehound/trail.h"

enum {
    MH_FIT_KNOTS = MH_DIFFUSION_WINDOW + 1,
    MH_FIT_UNKNOWNS = 2 * MH_FIT_KNOTS + 2,
    MH_FIT_ROWS = MH_DIFFUSION_WINDOW * (MH_DIFFUSION_NEAR + MH_DIFFUSION_STRONG)
};

struct mh_fit_knot {
    struct mh_vec2 place; /* metres */
    mh_tick time;
};

struct mh_fit_row {
    struct mh_vec2 node; /* metres */
    mh_tick time;        /* of the instant */
    mh_real increment;   /* g/m2, over the interval before */
    mh_real variance;    /* of the increment, without the model's own error; > 0 */
    mh_real base;        /* the frozen trail's share; kept up to date by the functions here */
};

/* What does not change from instant to instant. */
struct mh_fit_model {
    mh_real diffusion_m2ps;
    mh_real turn_mps2; /* sd of the acceleration */
    mh_real speed_mps; /* sd of the velocity of a source of which no past is known */
    mh_tick interval;  /* over which increments are taken */
};

/* A rectangle in metres that the knots stay in. */
struct mh_fit_bounds {
    struct mh_vec2 low, high;
    mh_real log_rate_low, log_rate_high;
};

struct mh_trail_fit {
    struct mh_fit_model model;
    struct mh_fit_bounds bounds;

    struct mh_trail trail; /* before the window, its newest knot one before knots[0]; may be empty */
    struct mh_fit_knot knots[MH_FIT_KNOTS];
    struct mh_fit_row rows[MH_FIT_ROWS];
    int knot_count, row_count;
    mh_real log_rate;      /* of the newest segment */
    mh_real log_rate_step; /* from segment to segment */

    struct mh_vec2 prior_place;       /* of knots[0] */
    struct mh_sym2 prior_information; /* inverse covariance */
    mh_real prior_log_rate, log_rate_sd;
    mh_real log_rate_step_sd; /* about 0 */
    mh_real log_rate_drift;   /* sd of the change of log_rate beyond its step, over one interval */

    mh_real cost;      /* all residuals' rho at the solution */
    mh_real data_cost; /* the rows' share */
    /* inverse normal matrix at the solution, packed; work space in between */
    mh_real covariance[MH_PACKED_SIZE(MH_FIT_UNKNOWNS)];
    mh_real normal[MH_PACKED_SIZE(MH_FIT_UNKNOWNS)]; /* work */
    mh_real gradient[MH_FIT_UNKNOWNS], step[MH_FIT_UNKNOWNS];
};

/* An empty trail and window that start at `place`, where the source is believed to stand with standard deviation sd_m from `before` to `time`. */
void mh_trail_fit_start(struct mh_trail_fit *fit, struct mh_vec2 place, mh_real sd_m, mh_tick before, mh_tick time);

/* The window moves on to `time`, after the newest knot, by dead reckoning. When it is full its oldest knot is frozen into the trail first, and what was learnt of the
 * next becomes the prior; rows that no longer see the window go. Needs a solution, and at least two knots. */
void mh_trail_fit_advance(struct mh_trail_fit *fit, mh_tick time);

/* One more row, at the time of the newest knot. Errors: MH_ERR_CAPACITY. */
enum mh_status mh_trail_fit_add_row(struct mh_trail_fit *fit, struct mh_vec2 node, mh_real increment, mh_real variance);

/* Improve knots and log_rate from where they are; sets cost, data_cost and covariance. At most 6 steps of at most 4 trials, so at most 25
 * evaluations of the model; one takes up to 8 exponentials for each row and each segment that the row sees, twice.
 * Errors: MH_ERR_SINGULAR (not finite or not positive definite; knots and log_rate as before, covariance lost). */
enum mh_status mh_trail_fit_solve(struct mh_trail_fit *fit);

/* cost, data_cost and covariance where the knots are. Errors as above. */
enum mh_status mh_trail_fit_assess(struct mh_trail_fit *fit);

/* Block of the covariance: knots i and j. For i = j it is the covariance of that knot's place. */
void mh_trail_fit_block(const struct mh_trail_fit *fit, int i, int j, mh_real block[4]);

#endif
