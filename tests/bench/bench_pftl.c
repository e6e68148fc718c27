/* Zhou's particle filter with 50 particles and 8 ranges. */
#include "bench.h"
#include "motehound/pftl.h"
#include "ranging.h"

struct mh_pftl bench_state;
static struct mh_measurement measurements[RANGING_MEASUREMENTS];
static struct mh_estimate estimate;
static unsigned now;

void bench_setup(void)
{
    struct mh_pftl_config config;
    mh_pftl_config_default(&config);
    mh_tracker_pftl.init(&bench_state, &config, RANGING_INTERVAL);
}

void bench_prepare(unsigned step)
{
    now = step;
    ranging_measurements(step, RANGING_MEASUREMENTS, measurements);
}

void bench_step(void)
{
    mh_tracker_pftl.step(&bench_state, (mh_tick)now * RANGING_INTERVAL, measurements, RANGING_MEASUREMENTS, &estimate);
}

bool bench_worked(void) { return estimate.measurements == RANGING_MEASUREMENTS; }
