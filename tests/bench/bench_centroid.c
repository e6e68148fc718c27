/* The mean place of 8 nodes. BENCH_FEW: four. */
#include "bench.h"
#include "motehound/centroid.h"
#include "ranging.h"

#ifdef BENCH_FEW
enum { COUNT = RANGING_FEW };
#else
enum { COUNT = RANGING_MEASUREMENTS };
#endif

struct mh_centroid_state bench_state;
static struct mh_measurement measurements[COUNT];
static struct mh_estimate estimate;
static unsigned now;

void bench_setup(void)
{
    struct mh_centroid_config config;
    mh_centroid_config_default(&config);
    mh_tracker_centroid.init(&bench_state, &config, RANGING_INTERVAL);
}

void bench_prepare(unsigned step)
{
    now = step;
    ranging_measurements(step, COUNT, measurements);
}

void bench_step(void)
{
    mh_tracker_centroid.step(&bench_state, (mh_tick)now * RANGING_INTERVAL, measurements, COUNT, &estimate);
}

bool bench_worked(void) { return estimate.measurements == COUNT; }
