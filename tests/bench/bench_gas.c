/* The trackers of a gas leak: a head with nine samples. Which of them, and of how many sensors it knows, is defined where this is compiled. */
#include "bench.h"
#include "leaking.h"

#if defined(BENCH_GAS_15) || defined(BENCH_GAS_30)
#define TRACKER mh_tracker_gas
#define KNOWN bench_state.count
struct mh_gas bench_state;
#else
#define KNOWN SENSORS
struct mh_gas_gaussian bench_state;
#ifdef BENCH_GAS_SMALL
#define TRACKER mh_tracker_gas_small
#elif defined(BENCH_GAS_UKF)
#define TRACKER mh_tracker_gas_ukf
#else
#define TRACKER mh_tracker_gas_ekf
#endif
#endif

#ifdef BENCH_GAS_15
enum { SENSORS = 15 };
#else
enum { SENSORS = MH_GAS_SENSORS_MAX < 30 ? 20 : 30 }; /* those of an ATmega128 take 15 s */
#endif

static struct mh_measurement measurements[LEAKING_MEASUREMENTS];
static struct mh_estimate estimate;
static unsigned now;

void bench_setup(void)
{
    struct mh_gas_config config;
    leaking_config(&config);
    TRACKER.init(&bench_state, &config, LEAKING_INTERVAL);
}

void bench_prepare(unsigned step)
{
    now = step;
    leaking_measurements(step, SENSORS, measurements);
}

void bench_step(void)
{
    TRACKER.step(&bench_state, (mh_tick)now * LEAKING_INTERVAL, measurements, LEAKING_MEASUREMENTS, &estimate);
}

bool bench_worked(void) { return estimate.measurements == LEAKING_MEASUREMENTS && KNOWN == SENSORS; }
