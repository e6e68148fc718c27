/* The default tracker: one sampling instant of a running track with 20 measurements. */
#include "bench.h"
#include "motehound/diffusion.h"
#include "release.h"

struct mh_diffusion bench_state;
static struct mh_measurement measurements[RELEASE_MEASUREMENTS];
static struct mh_estimate estimate;
static enum mh_status status;
static unsigned now;

void bench_setup(void)
{
    struct mh_diffusion_config config;
    mh_diffusion_config_default(&config);
    mh_tracker_diffusion.init(&bench_state, &config, RELEASE_INTERVAL);
}

void bench_prepare(unsigned step)
{
    now = step;
    release_measurements(step, 2.2f, INT32_MIN, measurements); /* silent ones too, 0.2 nodes a square metre */
}

void bench_step(void)
{
    status = mh_tracker_diffusion.step(&bench_state, release_time(now), measurements, RELEASE_MEASUREMENTS, &estimate);
}

bool bench_worked(void)
{
    return status == MH_OK && (estimate.flags & (MH_ESTIMATE_STARTED | MH_ESTIMATE_COASTED)) == 0;
}
