/* One position from 12 ranges of one instant: where nothing is known before (BENCH_MULTILATERATION), and near a prediction that is 2 m off (BENCH_RANGE_FIX). */
#include "bench.h"
#include "ranging.h"

#ifdef BENCH_MULTILATERATION
#include "motehound/multilateration.h"
struct mh_fix bench_state;
#else
#include "motehound/range_fix.h"
struct mh_range_fix bench_state;
#endif

static const mh_real sd_m = 5.0f;
static struct mh_measurement measurements[RANGING_MEASUREMENTS_MAX];
static struct mh_place origin;
static struct mh_vec2 target;
static enum mh_status status;

void bench_setup(void) {}

void bench_prepare(unsigned step)
{
    ranging_measurements(step, RANGING_MEASUREMENTS_MAX, measurements);
    origin = measurements[0].place;
    const struct mh_place place = ranging_target(step);
    target = mh_place_relative(&place, &origin);
}

void bench_step(void)
{
#ifdef BENCH_MULTILATERATION
    status = mh_multilaterate(measurements, RANGING_MEASUREMENTS_MAX, &origin, 0, sd_m, &bench_state);
#else
    const struct mh_vec2 near = {target.x + 1.4f, target.y - 1.4f};
    status = mh_range_fix(measurements, RANGING_MEASUREMENTS_MAX, &origin, 0, sd_m, near, &bench_state);
#endif
}

bool bench_worked(void)
{
    return status == MH_OK && mh_abs(bench_state.position.x - target.x) < 10 &&
           mh_abs(bench_state.position.y - target.y) < 10;
}
