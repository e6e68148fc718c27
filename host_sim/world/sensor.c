#include "world/sensor.h"

#include <math.h>
#include <stdlib.h>

struct mh_sensor_config sensor_config(const struct scenario *scenario)
{
    const int64_t bits = scenario->sensor.adc_bits;
    const bool ideal = bits == 0;
    const double quantum = ideal ? 1 : fmax(1, round(ldexp(scenario->sensor.full_scale, 20 - (int)bits)));
    return (struct mh_sensor_config){
        .q20_per_count = (int32_t)fmin(quantum, INT32_MAX),
        .counts_max = ideal ? INT32_MAX : (int32_t)((INT64_C(1) << bits) - 1),
        .interval = (mh_tick)llround(scenario->sensor.interval_s * MH_TICKS_PER_S),
        .threshold = mh_q20_from_real((mh_real)scenario->tracker.chi),
        .report_always = scenario->source.path == PATH_NONE,
    };
}

int sensors_make(struct sensors *sensors, const struct scenario *scenario, uint64_t seed, size_t count)
{
    const struct mh_sensor_config config = sensor_config(scenario);
    *sensors = (struct sensors){.count = count,
                                .relative_noise = scenario->sensor.relative_noise,
                                .additive_noise = scenario->sensor.additive_noise,
                                .counts_per_unit = ldexp(1.0, 20) / config.q20_per_count,
                                .counts_max = config.counts_max,
                                .loss = scenario->sensor.loss,
                                .outage_start_s = scenario->sensor.outage_start_s,
                                .outage_end_s = scenario->sensor.outage_start_s + scenario->sensor.outage_s,
                                .relative_stream = random_stream(seed, RANDOM_RELATIVE_NOISE),
                                .additive_stream = random_stream(seed, RANDOM_ADDITIVE_NOISE),
                                .loss_stream = random_stream(seed, RANDOM_READING_LOSS),
                                .noise = malloc((count + 1) * sizeof *sensors->noise)};
    return sensors->noise ? 0 : -1;
}

void sensors_free(struct sensors *sensors)
{
    free(sensors->noise);
    *sensors = (struct sensors){0};
}

void sensors_read(const struct sensors *sensors, uint64_t instant, double *concentrations, int32_t *counts)
{
    const size_t count = sensors->count;
    if (sensors->relative_noise > 0) {
        random_normals(sensors->relative_stream, instant * count, count, sensors->noise);
        for (size_t i = 0; i < count; i++) {
            concentrations[i] *= 1 + sensors->relative_noise * sensors->noise[i];
        }
    }
    if (sensors->additive_noise > 0) {
        random_normals(sensors->additive_stream, instant * count, count, sensors->noise);
        for (size_t i = 0; i < count; i++) {
            concentrations[i] += sensors->additive_noise * sensors->noise[i];
        }
    }
    for (size_t i = 0; i < count; i++) {
        counts[i] = (int32_t)lround(fmin(fmax(concentrations[i] * sensors->counts_per_unit, 0), sensors->counts_max));
    }
}

bool sensors_lost(const struct sensors *sensors, uint64_t instant, double time_s, size_t node)
{
    if (time_s >= sensors->outage_start_s && time_s < sensors->outage_end_s) {
        return true;
    }
    return sensors->loss > 0 && random_uniform(sensors->loss_stream, instant * sensors->count + node) < sensors->loss;
}
