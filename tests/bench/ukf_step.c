/* One step of a nonlinear filter: a target at nearly constant velocity among four anchors, 4 states, 4 ranges, predict and update. Each filter is
 * a function of its own, so that an image holds what its workload needs. bench_ukf_setup() and
 * bench_ukf_prepare() are not part of the step. */
#include "ukf_step.h"

#include "motehound/ekf.h"
#include "motehound/geometry.h"
#include "motehound/iterated_ekf.h"
#include "motehound/ukf.h"

static struct mh_gaussian bench_state;
static enum mh_status told;
static mh_real east_m, north_m; /* where the target is */

static const struct mh_vec2 anchors[4] = {{0, 0}, {40, 0}, {0, 40}, {40, 40}};
static const mh_real F[16] = {1, 0.5f, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.5f, 0, 0, 0, 1};
static const mh_real Q[10] = {1e-3f, 4e-3f, 2e-2f, 0, 0, 1e-3f, 0, 0, 4e-3f, 2e-2f};
static const mh_real variance[4] = {0.02f, 0.02f, 0.02f, 0.02f};
static mh_real z[4];

static enum mh_status move(const void *context, const mh_real *x, mh_real *next, mh_real *jacobian)
{
    (void)context;
    (void)jacobian;
    next[0] = x[0] + 0.5f * x[1];
    next[1] = x[1];
    next[2] = x[2] + 0.5f * x[3];
    next[3] = x[3];
    return MH_OK;
}

static enum mh_status predict_range(const void *context, uint16_t k, const mh_real *x, mh_real *range,
                                    mh_real *gradient)
{
    const struct mh_vec2 *at = context;
    const mh_real dx = x[0] - at[k].x, dy = x[2] - at[k].y;
    const mh_real distance = mh_sqrt(dx * dx + dy * dy);
    if (gradient) {
        gradient[0] = dx / distance;
        gradient[2] = dy / distance;
        gradient[1] = gradient[3] = 0;
    }
    *range = distance;
    return MH_OK;
}

static const struct mh_ukf_weights weights = {1, 2, 0};
static const struct mh_transition transition = {0, move};
static const struct mh_observations observations = {4, z, variance, anchors, predict_range, 0};

void bench_ukf_setup(void)
{
    const struct mh_gaussian start = {4, {10, 0.8f, 20, 0.6f}, {1, 0, 0.04f, 0, 0, 1, 0, 0, 0, 0.04f}};
    bench_state = start;
    east_m = 10.5f;
    north_m = 19.7f;
}

void bench_ukf_prepare(unsigned step)
{
    static const mh_real off[4] = {0.1f, -0.05f, 0.02f, -0.12f};
    east_m += 0.4f;
    north_m += 0.3f;
    for (unsigned k = 0; k < 4; k++) {
        const mh_real x[4] = {east_m, 0, north_m, 0};
        predict_range(anchors, (uint16_t)k, x, &z[k], 0);
        z[k] += off[(step + k) % 4];
    }
}

void bench_ukf_step(void)
{
    told = mh_ukf_predict(&bench_state, &weights, &transition, Q);
    if (told == MH_OK) {
        told = mh_ukf_update_stacked(&bench_state, &weights, &observations);
    }
}

void bench_ukf_step_linear(void)
{
    told = mh_gaussian_predict(&bench_state, F, Q);
    if (told == MH_OK) {
        told = mh_ukf_update(&bench_state, &weights, &observations);
    }
}

void bench_ekf_step(void)
{
    told = mh_gaussian_predict(&bench_state, F, Q);
    if (told == MH_OK) {
        told = mh_ekf_update(&bench_state, &observations);
    }
}

void bench_iterated_ekf_step(void)
{
    static const struct mh_iterated_ekf_config config = {20, 0.01f, 1e-4f};
    told = mh_gaussian_predict(&bench_state, F, Q);
    if (told == MH_OK) {
        told = mh_iterated_ekf_update(&bench_state, &config, 0, &observations, 0);
    }
}

bool bench_ukf_worked(void)
{
    return told == MH_OK && mh_abs(bench_state.x[0] - east_m) < 1 && mh_abs(bench_state.x[2] - north_m) < 1;
}
