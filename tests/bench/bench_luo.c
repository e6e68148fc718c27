/* Luo's method: bounded least squares over 20 measurements and a Sage-Husa step on both coordinates. */
#include "bench.h"
#include "motehound/luo.h"
#include "release.h"

struct mh_luo bench_state;
static struct mh_measurement measurements[RELEASE_MEASUREMENTS];
static struct mh_estimate estimate;
static unsigned now;

void bench_setup(void)
{
    struct mh_luo_config config;
    mh_luo_config_default(&config);
    mh_tracker_luo.init(&bench_state, &config, RELEASE_INTERVAL);
}

void bench_prepare(unsigned step)
{
    now = step;
    release_measurements(step, 0.9f, MH_Q20(0.25f), measurements); /* all above chi */
}

void bench_step(void)
{
    mh_tracker_luo.step(&bench_state, release_time(now), measurements, RELEASE_MEASUREMENTS, &estimate);
}

bool bench_worked(void)
{
    return estimate.measurements == RELEASE_MEASUREMENTS && (estimate.flags & MH_ESTIMATE_FILTERED) != 0;
}
