/* The default tracker of a ranged target: an instant with 12 ranges. BENCH_FEW: four. */
#include "bench.h"
#include "motehound/range.h"
#include "ranging.h"

#ifdef BENCH_FEW
enum { COUNT = RANGING_FEW };
#else
enum { COUNT = RANGING_MEASUREMENTS_MAX };
#endif

struct mh_range bench_state;
static struct mh_measurement measurements[COUNT];
static struct mh_estimate estimate;
static unsigned now;

void bench_setup(void)
{
    struct mh_range_config config;
    mh_range_config_default(&config);
    config.range_sd_m = 5;
    config.sensing_range_m = 50;
    config.acceleration_sd_mps2 = 0.43f;
    config.speed_mps = 4.47f;
    config.height_m = 0;
    config.tolerance_m = 5;
    mh_tracker_range.init(&bench_state, &config, RANGING_INTERVAL);
}

void bench_prepare(unsigned step)
{
    now = step;
    ranging_measurements(step, COUNT, measurements);
}

void bench_step(void)
{
    mh_tracker_range.step(&bench_state, (mh_tick)now * RANGING_INTERVAL, measurements, COUNT, &estimate);
}

bool bench_worked(void) { return estimate.measurements == COUNT; }
