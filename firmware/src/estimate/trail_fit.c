#include "motehound/trail_fit.h"

#define STEPS_MAX 6
#define TRIALS_MAX 4
#define DATA_CAUCHY 4.0f
#define TURN_HUBER 1.5f
#define LOG_RATE_STEP_MAX 1.0f
#define BASE_ERROR 0.1f     /* the frozen trail's share is wrong by about a tenth of itself */
#define ROUNDING 1.0001f    /* on a diagonal: keeps a nearly singular block positive definite */
#define KNOT_DRIFT_M2 1e-4f /* what the linearisation forgets, for each instant */

static int unknowns(const struct mh_trail_fit *fit) { return 2 * fit->knot_count + 2; }

static mh_real interval_s(const struct mh_trail_fit *fit) { return mh_seconds_between(0, fit->model.interval); }

/* rho(r) = r^2 inside, 2 h r - h^2 outside, and the weight that makes r^2 * weight the same slope. */
static mh_real huber(mh_real residual, mh_real bound, mh_real *weight)
{
    const mh_real size = mh_abs(residual);
    *weight = size <= bound ? 1.0f : bound / size;
    return size <= bound ? size * size : bound * (2.0f * size - bound);
}

/* rho(r) = c^2 ln(1 + (r / c)^2): the pull of a row that is far off fades, and does not depend on how exact it claims to be. */
static mh_real cauchy(mh_real residual, mh_real scale, mh_real *weight)
{
    const mh_real excess = 1.0f + mh_squared(residual / scale);
    *weight = 1.0f / excess;
    return mh_squared(scale) * mh_log(excess);
}

/* normal += weight * j j', gradient += weight * residual * j, for the `length` successive unknowns from `first` on. */
static void accumulate(mh_real *normal, mh_real *gradient, int first, int length, const mh_real *j, mh_real weight,
                       mh_real residual)
{
    for (int a = 0; a < length; a++) {
        const mh_real scaled = weight * j[a];
        mh_real *row = normal + mh_packed_index(first + a, first);
        for (int b = 0; b <= a; b++) {
            row[b] += scaled * j[b];
        }
        gradient[first + a] += scaled * residual;
    }
}

/* The knot before the window; without meaning while the trail is empty. */
static const struct mh_trail_knot *last_frozen(const struct mh_trail_fit *fit)
{
    return &fit->trail.knots[fit->trail.count > 0 ? fit->trail.count - 1 : 0];
}

/* Release rate on the way to knot k. */
static mh_real rate_of_segment(const struct mh_trail_fit *fit, int k)
{
    return mh_exp(fit->log_rate + fit->log_rate_step * (mh_real)(k + 1 - fit->knot_count));
}

/* The model's increment of a row, and its derivatives by all unknowns. */
static mh_real row_model(const struct mh_trail_fit *fit, const struct mh_fit_row *row, const mh_real *rates, mh_real *j)
{
    const int n = unknowns(fit);
    mh_real released = 0.0f;
    for (int i = 0; i < n; i++) {
        j[i] = 0.0f;
    }
    for (int k = fit->trail.count > 0 ? 0 : 1; k < fit->knot_count; k++) {
        const struct mh_fit_knot *end = &fit->knots[k];
        const struct mh_trail_knot *frozen = last_frozen(fit);
        struct mh_segment segment = {k > 0 ? fit->knots[k - 1].place : frozen->place, end->place, 0.0f, 0.0f};
        const mh_tick start = k > 0 ? fit->knots[k - 1].time : frozen->time;
        struct mh_segment_field field = {0.0f, {0.0f, 0.0f}, {0.0f, 0.0f}};
        segment.age_a = mh_seconds_between(start, row->time);
        segment.age_b = mh_seconds_between(end->time, row->time);
        mh_segment_add_field(&segment, row->node, fit->model.diffusion_m2ps, 1.0f, &field);
        segment.age_a = mh_seconds_between(start, row->time - fit->model.interval);
        segment.age_b = mh_seconds_between(end->time, row->time - fit->model.interval);
        mh_segment_add_field(&segment, row->node, fit->model.diffusion_m2ps, -1.0f, &field);
        const mh_real rate = rates[k];
        released += rate * field.value;
        j[n - 1] += rate * field.value * (mh_real)(k + 1 - fit->knot_count);
        if (k > 0) {
            j[2 * k - 2] += rate * field.da.x;
            j[2 * k - 1] += rate * field.da.y;
        }
        j[2 * k] += rate * field.db.x;
        j[2 * k + 1] += rate * field.db.y;
    }
    j[n - 2] = released;
    return row->base + released;
}

/* One coordinate of a prior on the motion: coefficients c[0..length-1] of the knots from `first` on, every second unknown. */
static mh_real add_motion(const struct mh_trail_fit *fit, mh_real *normal, mh_real *gradient, int first, int length,
                          const mh_real *c, struct mh_vec2 constant)
{
    mh_real cost = 0.0f;
    for (int axis = 0; axis < 2; axis++) {
        mh_real j[5] = {0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
        mh_real residual = axis == 0 ? constant.x : constant.y;
        for (int k = 0; k < length; k++) {
            const struct mh_vec2 *place = &fit->knots[first + k].place;
            j[2 * k] = c[k];
            residual += c[k] * (axis == 0 ? place->x : place->y);
        }
        mh_real weight;
        cost += huber(residual, TURN_HUBER, &weight);
        accumulate(normal, gradient, 2 * first + axis, 2 * length - 1, j, weight, residual);
    }
    return cost;
}

/* The change of velocity at the knot between two segments, or the velocity itself where no past is known. */
static mh_real add_motion_prior(const struct mh_trail_fit *fit, int k, mh_real *normal, mh_real *gradient)
{
    const struct mh_vec2 none = {0.0f, 0.0f};
    const mh_real after = mh_seconds_between(fit->knots[k - 1].time, fit->knots[k].time);
    if (k == 1 && fit->trail.count == 0) {
        const mh_real c = 1.0f / (fit->model.speed_mps * after);
        const mh_real coefficients[2] = {-c, c};
        return add_motion(fit, normal, gradient, 0, 2, coefficients, none);
    }
    const struct mh_trail_knot *frozen = last_frozen(fit);
    const mh_real before = mh_seconds_between(k > 1 ? fit->knots[k - 2].time : frozen->time, fit->knots[k - 1].time);
    const mh_real scale = 1.0f / (fit->model.turn_mps2 * mh_sqrt(0.5f * (before + after) * interval_s(fit)));
    const mh_real coefficients[3] = {scale / before, -scale / before - scale / after, scale / after};
    if (k > 1) {
        return add_motion(fit, normal, gradient, k - 2, 3, coefficients, none);
    }
    const struct mh_vec2 constant = {coefficients[0] * frozen->place.x, coefficients[0] * frozen->place.y};
    return add_motion(fit, normal, gradient, 0, 2, coefficients + 1, constant);
}

/* Cost where the knots are; the normal matrix and the gradient of half the cost go to the given memory. */
static mh_real linearise(struct mh_trail_fit *fit, mh_real *normal, mh_real *gradient)
{
    const int n = unknowns(fit);
    for (int i = 0; i < MH_PACKED_SIZE(n); i++) {
        normal[i] = 0.0f;
    }
    for (int i = 0; i < n; i++) {
        gradient[i] = 0.0f;
    }

    mh_real rates[MH_FIT_KNOTS];
    for (int k = 0; k < fit->knot_count; k++) {
        rates[k] = rate_of_segment(fit, k);
    }
    mh_real data_cost = 0.0f;
    for (int i = 0; i < fit->row_count; i++) {
        const struct mh_fit_row *row = &fit->rows[i];
        mh_real j[MH_FIT_UNKNOWNS], weight;
        const mh_real excess = row_model(fit, row, rates, j) - row->increment;
        const mh_real information = 1.0f / (row->variance + mh_squared(BASE_ERROR * row->base));
        data_cost += cauchy(excess * mh_sqrt(information), DATA_CAUCHY, &weight);
        accumulate(normal, gradient, 0, n, j, weight * information, excess);
    }
    fit->data_cost = data_cost;

    const struct mh_vec2 off = {fit->knots[0].place.x - fit->prior_place.x, fit->knots[0].place.y - fit->prior_place.y};
    const struct mh_sym2 *information = &fit->prior_information;
    const struct mh_vec2 pull = {information->xx * off.x + information->xy * off.y,
                                 information->xy * off.x + information->yy * off.y};
    normal[0] += information->xx;
    normal[1] += information->xy;
    normal[2] += information->yy;
    gradient[0] += pull.x;
    gradient[1] += pull.y;
    mh_real cost = data_cost + off.x * pull.x + off.y * pull.y;

    for (int k = 1; k < fit->knot_count; k++) {
        cost += add_motion_prior(fit, k, normal, gradient);
    }

    const mh_real prior[2][2] = {{fit->log_rate - fit->prior_log_rate, fit->log_rate_sd},
                                 {fit->log_rate_step, fit->log_rate_step_sd}};
    for (int i = 0; i < 2; i++) {
        const mh_real weight = 1.0f / mh_squared(prior[i][1]);
        const mh_real one = 1.0f;
        accumulate(normal, gradient, n - 2 + i, 1, &one, weight, prior[i][0]);
        cost += weight * mh_squared(prior[i][0]);
    }
    return cost;
}

static void apply_step(struct mh_trail_fit *fit, const mh_real *step)
{
    const struct mh_fit_bounds *bounds = &fit->bounds;
    for (int k = 0; k < fit->knot_count; k++) {
        struct mh_vec2 *place = &fit->knots[k].place;
        place->x = mh_clamp(place->x - step[2 * k], bounds->low.x, bounds->high.x);
        place->y = mh_clamp(place->y - step[2 * k + 1], bounds->low.y, bounds->high.y);
    }
    const mh_real change = mh_clamp(step[2 * fit->knot_count], -LOG_RATE_STEP_MAX, LOG_RATE_STEP_MAX);
    fit->log_rate_step =
        mh_clamp(fit->log_rate_step - step[2 * fit->knot_count + 1], -LOG_RATE_STEP_MAX, LOG_RATE_STEP_MAX);
    fit->log_rate = mh_clamp(fit->log_rate - change, bounds->log_rate_low, bounds->log_rate_high);
}

/* Where the unknowns stand, to come back to. */
struct stand {
    struct mh_vec2 places[MH_FIT_KNOTS];
    mh_real log_rate, log_rate_step, data_cost;
};

static void remember(const struct mh_trail_fit *fit, struct stand *stand)
{
    for (int k = 0; k < fit->knot_count; k++) {
        stand->places[k] = fit->knots[k].place;
    }
    stand->log_rate = fit->log_rate;
    stand->log_rate_step = fit->log_rate_step;
    stand->data_cost = fit->data_cost;
}

static void go_back(struct mh_trail_fit *fit, const struct stand *stand)
{
    for (int k = 0; k < fit->knot_count; k++) {
        fit->knots[k].place = stand->places[k];
    }
    fit->log_rate = stand->log_rate;
    fit->log_rate_step = stand->log_rate_step;
    fit->data_cost = stand->data_cost;
}

/* One Levenberg-Marquardt trial: step by (A + damping diag A)^-1 gradient. Leaves cost, normal matrix (in fit->covariance) and gradient
 * (in fit->step) of the new place; false if there was none or the cost is higher. */
static bool try_step(struct mh_trail_fit *fit, mh_real damping, mh_real *cost)
{
    const int n = unknowns(fit);
    mh_real *factor = fit->covariance;
    for (int i = 0; i < MH_PACKED_SIZE(n); i++) {
        factor[i] = fit->normal[i];
    }
    for (int i = 0; i < n; i++) {
        factor[mh_packed_index(i, i)] *= 1.0f + damping;
        fit->step[i] = fit->gradient[i];
    }
    if (mh_cholesky_factor(n, factor) != MH_OK) {
        return false;
    }
    mh_cholesky_solve(n, factor, fit->step);
    apply_step(fit, fit->step);
    const mh_real trial = linearise(fit, fit->covariance, fit->step);
    if (!(trial <= *cost)) {
        return false;
    }
    *cost = trial;
    return true;
}

static enum mh_status conclude(struct mh_trail_fit *fit, mh_real cost)
{
    const int n = unknowns(fit);
    for (int i = 0; i < MH_PACKED_SIZE(n); i++) {
        fit->covariance[i] = fit->normal[i];
    }
    if (!mh_finite(cost) || mh_cholesky_factor(n, fit->covariance) != MH_OK) {
        return MH_ERR_SINGULAR;
    }
    mh_cholesky_invert(n, fit->covariance);
    fit->cost = cost;
    return MH_OK;
}

enum mh_status mh_trail_fit_assess(struct mh_trail_fit *fit)
{
    const mh_real cost = linearise(fit, fit->normal, fit->gradient);
    return conclude(fit, cost);
}

enum mh_status mh_trail_fit_solve(struct mh_trail_fit *fit)
{
    struct stand before, last;
    remember(fit, &before);
    mh_real cost = linearise(fit, fit->normal, fit->gradient);
    mh_real damping = 1e-3f;
    bool improving = mh_finite(cost);
    for (int step = 0; step < STEPS_MAX && improving; step++) {
        const mh_real old_cost = cost;
        bool taken = false;
        remember(fit, &last);
        for (int trial = 0; trial < TRIALS_MAX && !taken; trial++) {
            taken = try_step(fit, damping, &cost);
            if (taken) {
                damping *= 0.2f;
            } else {
                go_back(fit, &last);
                damping = 8.0f * damping + 0.01f;
            }
        }
        if (taken) {
            const int n = unknowns(fit);
            for (int i = 0; i < MH_PACKED_SIZE(n); i++) {
                fit->normal[i] = fit->covariance[i];
            }
            for (int i = 0; i < n; i++) {
                fit->gradient[i] = fit->step[i];
            }
        }
        improving = taken && old_cost - cost >= 1e-3f * old_cost;
    }
    const enum mh_status status = conclude(fit, cost);
    if (status != MH_OK) {
        go_back(fit, &before);
    }
    return status;
}

void mh_trail_fit_block(const struct mh_trail_fit *fit, int i, int j, mh_real block[4])
{
    for (int a = 0; a < 2; a++) {
        for (int b = 0; b < 2; b++) {
            block[2 * a + b] = fit->covariance[mh_packed_index(2 * i + a, 2 * j + b)];
        }
    }
    if (i == j) {
        block[0] *= ROUNDING;
        block[3] *= ROUNDING;
    }
}

void mh_trail_fit_start(struct mh_trail_fit *fit, struct mh_vec2 place, mh_real sd_m, mh_tick before, mh_tick time)
{
    const struct mh_fit_knot first = {place, before}, second = {place, time};
    fit->trail.count = 0;
    fit->row_count = 0;
    fit->knot_count = 2;
    fit->knots[0] = first;
    fit->knots[1] = second;
    fit->prior_place = place;
    fit->log_rate_step = 0.0f;
    fit->prior_information.xx = fit->prior_information.yy = 1.0f / mh_squared(sd_m);
    fit->prior_information.xy = 0.0f;
}

/* The oldest knot joins the trail, the next becomes the oldest with what is known of it. */
static void slide(struct mh_trail_fit *fit)
{
    const struct mh_trail_knot frozen = {fit->knots[0].place, fit->knots[0].time, rate_of_segment(fit, 0)};
    const bool has_segment = fit->trail.count > 0;
    const struct mh_trail_knot newest = *last_frozen(fit);

    mh_real block[4];
    mh_trail_fit_block(fit, 1, 1, block);
    block[0] += KNOT_DRIFT_M2;
    block[3] += KNOT_DRIFT_M2;
    const mh_real determinant = block[0] * block[3] - block[1] * block[1];
    fit->prior_information.xx = block[3] / determinant;
    fit->prior_information.xy = -block[1] / determinant;
    fit->prior_information.yy = block[0] / determinant;
    fit->prior_place = fit->knots[1].place;

    for (int k = 0; k + 1 < fit->knot_count; k++) {
        fit->knots[k] = fit->knots[k + 1];
    }
    fit->knot_count--;

    int kept = 0;
    for (int i = 0; i < fit->row_count; i++) {
        struct mh_fit_row *row = &fit->rows[i];
        if (mh_tick_before(fit->knots[0].time, row->time)) {
            if (has_segment) {
                row->base += mh_trail_segment_increment(&newest, &frozen, row->node, row->time, fit->model.interval,
                                                        fit->model.diffusion_m2ps);
            }
            fit->rows[kept++] = *row;
        }
    }
    fit->row_count = kept;
    mh_trail_append(&fit->trail, &frozen);
}

void mh_trail_fit_advance(struct mh_trail_fit *fit, mh_tick time)
{
    /* the rate goes on as it went; variance of the sum of two unknowns */
    const int n = unknowns(fit);
    const mh_real *p = fit->covariance;
    const mh_real variance =
        p[mh_packed_index(n - 2, n - 2)] + 2.0f * p[mh_packed_index(n - 1, n - 2)] + p[mh_packed_index(n - 1, n - 1)];
    if (fit->knot_count == MH_FIT_KNOTS) {
        slide(fit);
    }
    fit->log_rate = mh_clamp(fit->log_rate + fit->log_rate_step, fit->bounds.log_rate_low, fit->bounds.log_rate_high);
    fit->prior_log_rate = fit->log_rate;
    fit->log_rate_sd =
        mh_sqrt(variance + mh_squared(fit->log_rate_drift) *
                               mh_seconds_between(fit->knots[fit->knot_count - 1].time, time) / interval_s(fit));
    const struct mh_fit_knot *last = &fit->knots[fit->knot_count - 1];
    const struct mh_fit_knot *older = last - 1;
    struct mh_fit_knot *next = &fit->knots[fit->knot_count];
    const mh_real ratio = mh_seconds_between(last->time, time) / mh_seconds_between(older->time, last->time);
    next->time = time;
    next->place.x =
        mh_clamp(last->place.x + ratio * (last->place.x - older->place.x), fit->bounds.low.x, fit->bounds.high.x);
    next->place.y =
        mh_clamp(last->place.y + ratio * (last->place.y - older->place.y), fit->bounds.low.y, fit->bounds.high.y);
    fit->knot_count++;
}

enum mh_status mh_trail_fit_add_row(struct mh_trail_fit *fit, struct mh_vec2 node, mh_real increment, mh_real variance)
{
    if (fit->row_count == MH_FIT_ROWS) {
        return MH_ERR_CAPACITY;
    }
    const mh_tick time = fit->knots[fit->knot_count - 1].time;
    const struct mh_fit_row row = {
        node, time, increment, variance,
        mh_trail_increment(&fit->trail, node, time, fit->model.interval, fit->model.diffusion_m2ps)};
    fit->rows[fit->row_count++] = row;
    return MH_OK;
}
