/* The tracker `gas` among five places: a minute of eight sensors and the wind, which turns. */
#include "bench.h"
#include "motehound/gas_wind.h"

enum { SENSORS = 8, PLACES = 5, INTERVAL = 1000 };

struct mh_gas_wind bench_state;
static struct mh_measurement measurements[SENSORS + 2];
static struct mh_estimate estimate;
static mh_tick now;

void bench_setup(void)
{
    struct mh_gas_wind_config config;
    mh_gas_wind_config_default(&config);
    config.learn = 0;
    config.place_count = PLACES;
    for (uint8_t i = 0; i < PLACES; i++) {
        const struct mh_vec2 at = mh_direction((mh_real)i - 2.0f);
        const struct mh_place place = {(int32_t)(at.x * 20000.0f), (int32_t)(at.y * 20000.0f), 0};
        config.places[i] = place;
    }
    mh_tracker_gas_wind.init(&bench_state, &config, INTERVAL);
}

void bench_prepare(unsigned step)
{
    const struct mh_vec2 wind = mh_direction(0.3f * (mh_real)step - 3.0f);
    now = (mh_tick)step * INTERVAL;
    for (uint8_t i = 0; i < SENSORS; i++) {
        const struct mh_vec2 at = mh_direction(0.7f * (mh_real)i - 3.0f);
        const mh_real plume = mh_max(wind.x * at.x + wind.y * at.y, 0);
        const struct mh_measurement m = {.node = i,
                                         .place = {(int32_t)(at.x * 50000.0f), (int32_t)(at.y * 50000.0f), 0},
                                         .time = now,
                                         .value = mh_q20_from_real(2.0f + 5.0f * plume * plume)};
        measurements[i] = m;
    }
    measurements[SENSORS] = measurements[SENSORS + 1] = measurements[0];
    measurements[SENSORS].target = MH_TARGET_WIND_X;
    measurements[SENSORS].value = mh_q20_from_real(3.0f * wind.x);
    measurements[SENSORS + 1].target = MH_TARGET_WIND_Y;
    measurements[SENSORS + 1].value = mh_q20_from_real(3.0f * wind.y);
}

void bench_step(void) { mh_tracker_gas_wind.step(&bench_state, now, measurements, SENSORS + 2, &estimate); }

bool bench_worked(void) { return estimate.measurements == SENSORS && bench_state.blows[1]; }
