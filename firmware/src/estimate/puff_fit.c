#include "motehound/puff_fit.h"

#if MH_REAL_FIXED
#define EXPONENT_MAX MH_REAL(10.0f)
#define DIFFUSION_MIN MH_REAL(0.01f)
#define DIFFUSION_MAX MH_REAL(500.0f)
static mh_real in_grams(mh_concentration concentration) { return mh_q20_to_real(concentration); }
static bool is_finite(mh_concentration concentration) { return concentration < INT32_MAX; }
static mh_real half(mh_wide a) { return mh_wide_to_real(a >> 1); }
#else
#define EXPONENT_MAX 20.0f
#define DIFFUSION_MIN MH_REAL_MIN
#define DIFFUSION_MAX MH_REAL_MAX
static mh_real in_grams(mh_concentration concentration) { return concentration; }
static bool is_finite(mh_concentration concentration) { return mh_finite(concentration); }
static mh_real half(mh_wide a) { return a / 2; }
#endif

static enum mh_status check(const struct mh_puff_sample *sample)
{
    if (!mh_finite(sample->position.x) || !mh_finite(sample->position.y) || !is_finite(sample->concentration)) {
        return MH_ERR_NOT_FINITE;
    }
    return sample->concentration > 0 ? MH_OK : MH_ERR_RANGE;
}

/* Eq. (A2) of one sample: the mass that gives it its concentration from a puff of `age` at `position`. The exponent is limited so
 * that a puff too far away for its age gives a large mass, not infinity. */
static mh_real mass_through(const struct mh_puff_sample *sample, mh_real diffusion, struct mh_vec2 position,
                            mh_real age)
{
    const mh_real spread = mh_mul(mh_mul(MH_REAL(4.0f), diffusion), age);
    const mh_wide square = mh_vec2_square(mh_vec2_between(position, sample->position));
    const mh_real exponent = spread > 0 ? mh_wide_div(square, spread) : 0;
    return mh_mul(mh_mul(mh_mul(in_grams(sample->concentration), MH_PI), spread),
                  mh_exp(mh_min(exponent, EXPONENT_MAX)));
}

enum mh_status mh_puff_linear_begin(struct mh_puff_linear *fit, mh_real diffusion,
                                    const struct mh_puff_sample *reference)
{
    const enum mh_status status = check(reference);
    if (status != MH_OK) {
        return status;
    }
    if (!mh_finite(diffusion)) {
        return MH_ERR_NOT_FINITE;
    }
    if (!mh_within(diffusion, DIFFUSION_MIN, DIFFUSION_MAX)) {
        return MH_ERR_RANGE;
    }
    fit->diffusion = diffusion;
    fit->reference = *reference;
#if MH_REAL_FIXED
    fit->logarithm = mh_log(mh_real_from_bits(reference->concentration));
#endif
    mh_least_squares_begin(&fit->equations, 3);
    return MH_OK;
}

/* Half of Eq. (A2) of the sample minus that of the reference; unknowns are the position (e, n) relative to the reference and the age
 * s = t - tau: dx e + dy n + 2 D ln(c_Q / c_k) s = (dx^2 + dy^2) / 2. */
enum mh_status mh_puff_linear_add(struct mh_puff_linear *fit, const struct mh_puff_sample *sample)
{
    const enum mh_status status = check(sample);
    if (status != MH_OK) {
        return status;
    }
    const struct mh_vec2 away = mh_vec2_between(fit->reference.position, sample->position);
#if MH_REAL_FIXED
    const mh_real logarithm = fit->logarithm - mh_log(mh_real_from_bits(sample->concentration));
#else
    const mh_real logarithm = mh_log(fit->reference.concentration / sample->concentration);
#endif
    const mh_real row[3] = {away.x, away.y, mh_mul(2 * fit->diffusion, logarithm)};
    const mh_real right = half(mh_vec2_square(away));
    return mh_finite(right) ? mh_least_squares_add(&fit->equations, row, right) : MH_ERR_RANGE;
}

enum mh_status mh_puff_linear_solve(const struct mh_puff_linear *fit, mh_real age_max, struct mh_puff_answer *answer)
{
    if (fit->equations.rows < MH_PUFF_SAMPLES_MIN) {
        return MH_ERR_TOO_FEW;
    }
    mh_real z[3];
    enum mh_bound bound;
    const enum mh_status status = mh_least_squares_solve(&fit->equations, 0, age_max, z, &bound);
    if (status != MH_OK) {
        return status;
    }
    const struct mh_vec2 position = {mh_add(fit->reference.position.x, z[0]), mh_add(fit->reference.position.y, z[1])};
    if (!mh_finite(position.x) || !mh_finite(position.y)) {
        return MH_ERR_RANGE;
    }
    const mh_real mass = mass_through(&fit->reference, fit->diffusion, position, z[2]);
    const struct mh_puff_answer solved = {{position, z[2], mass}, bound};
    *answer = solved;
    return MH_OK;
}

#if !MH_REAL_FIXED

#define PASSES_MAX 24
#define DAMPING_BEGIN 1e-3f
#define DAMPING_MAX 1e4f
#define CONVERGED 1e-4f /* share of the cost that the last step still took off */

enum mh_status mh_puff_nonlinear_begin(struct mh_puff_nonlinear *fit, mh_real diffusion,
                                       const struct mh_puff_sample *reference, struct mh_vec2 position, mh_real age,
                                       mh_real age_max)
{
    const enum mh_status status = check(reference);
    if (status != MH_OK) {
        return status;
    }
    if (!mh_finite(diffusion) || !mh_finite(position.x) || !mh_finite(position.y) || !mh_finite(age) ||
        !mh_finite(age_max)) {
        return MH_ERR_NOT_FINITE;
    }
    if (!(diffusion > 0) || !(age_max > 0)) {
        return MH_ERR_RANGE;
    }
    fit->diffusion = diffusion;
    fit->age_min = MH_PUFF_AGE_SHARE_MIN * age_max;
    fit->age_max = age_max;
    fit->damping = DAMPING_BEGIN;
    fit->passes = 0;
    fit->trial.position = position;
    fit->trial.age = mh_clamp(age, fit->age_min, age_max);
    fit->trial.mass = mass_through(reference, diffusion, position, fit->trial.age);
    mh_least_squares_begin(&fit->trial_equations, 4);
    fit->trial_residual = 0;
    return MH_OK;
}

/* The linearised equation: slope . step = c_k - c(trial). Age comes last because it is the one with bounds. */
enum mh_status mh_puff_nonlinear_add(struct mh_puff_nonlinear *fit, const struct mh_puff_sample *sample)
{
    const enum mh_status status = check(sample);
    if (status != MH_OK) {
        return status;
    }
    struct mh_puff_slope slope;
    const mh_real c = mh_puff_concentration(&fit->trial, fit->diffusion, sample->position, &slope);
    const mh_real row[4] = {slope.x, slope.y, slope.log_mass, slope.age};
    const enum mh_status added = mh_least_squares_add(&fit->trial_equations, row, sample->concentration - c);
    if (added == MH_OK) {
        fit->trial_residual = mh_hypot(fit->trial_residual, fit->trial_equations.left);
    }
    return added;
}

/* Sum of the squared right sides, which the rotations keep. */
static mh_real cost_of(const struct mh_least_squares *equations, mh_real residual)
{
    mh_real sum = residual * residual;
    for (uint8_t i = 0; i < equations->unknowns; i++) {
        const mh_real d = equations->r[i][equations->unknowns];
        sum += d * d;
    }
    return sum;
}

/* A Levenberg-Marquardt step from the best puff, at most as far as its neighbourhood looks like the linearised one. */
static enum mh_status damped_step(struct mh_puff_nonlinear *fit)
{
    struct mh_least_squares damped = fit->best_equations;
    for (uint8_t k = 0; k < 4; k++) {
        mh_real column = 0;
        for (uint8_t i = 0; i <= k; i++) {
            column += fit->best_equations.r[i][k] * fit->best_equations.r[i][k];
        }
        mh_real row[4] = {0, 0, 0, 0};
        row[k] = mh_sqrt(fit->damping * column);
        const enum mh_status status = mh_least_squares_add(&damped, row, 0);
        if (status != MH_OK) {
            return status;
        }
    }
    const struct mh_puff *best = &fit->best;
    mh_real z[4];
    enum mh_bound bound;
    const enum mh_status status = mh_least_squares_solve(&damped, mh_max(fit->age_min - best->age, -0.5f * best->age),
                                                         mh_min(fit->age_max - best->age, best->age), z, &bound);
    if (status != MH_OK) {
        return status;
    }
    const mh_real far = mh_sqrt((z[0] * z[0] + z[1] * z[1]) / (4.0f * fit->diffusion * best->age));
    const mh_real part = 1.0f / mh_max(1.0f, mh_max(far, mh_abs(z[2])));
    fit->trial.position.x = best->position.x + part * z[0];
    fit->trial.position.y = best->position.y + part * z[1];
    fit->trial.mass = mh_clamp(best->mass * mh_exp(part * z[2]), 1e-12f, 1e12f);
    fit->trial.age = mh_clamp(best->age + part * z[3], fit->age_min, fit->age_max);
    mh_least_squares_begin(&fit->trial_equations, 4);
    fit->trial_residual = 0;
    return MH_OK;
}

enum mh_status mh_puff_nonlinear_advance(struct mh_puff_nonlinear *fit, struct mh_puff_answer *answer)
{
    if (fit->trial_equations.rows < MH_PUFF_SAMPLES_MIN) {
        return MH_ERR_TOO_FEW;
    }
    const mh_real cost = cost_of(&fit->trial_equations, fit->trial_residual);
    const bool first = fit->passes == 0;
    const bool better = first || cost < fit->cost;
    bool done = false;
    if (better) {
        done = !first && fit->cost - cost <= CONVERGED * fit->cost;
        fit->best = fit->trial;
        fit->best_equations = fit->trial_equations;
        fit->cost = cost;
        fit->damping *= 0.2f;
    } else {
        fit->damping *= 8.0f;
    }
    fit->passes++;
    if (!done && fit->passes < PASSES_MAX && fit->damping <= DAMPING_MAX && cost > 0) {
        const enum mh_status status = damped_step(fit);
        if (status == MH_OK) {
            return MH_NONE;
        }
        if (first) {
            return status;
        }
    }
    answer->puff = fit->best;
    answer->bound = fit->best.age >= 0.999999f * fit->age_max   ? MH_BOUND_HIGH
                    : fit->best.age <= 1.000001f * fit->age_min ? MH_BOUND_LOW
                                                                : MH_BOUND_NONE;
    return MH_OK;
}

#endif
