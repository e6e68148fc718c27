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
                                .interval_s = config.interval / (double)MH_TICKS_PER_S,
                                .spike_chance = scenario->faults.spike.chance,
                                .spike = scenario->faults.spike.height,
                                .saturate_at = scenario->faults.saturate.at,
                                .bias = scenario->faults.bias.offset,
                                .relative_stream = random_stream(seed, RANDOM_RELATIVE_NOISE),
                                .additive_stream = random_stream(seed, RANDOM_ADDITIVE_NOISE),
                                .loss_stream = random_stream(seed, RANDOM_READING_LOSS),
                                .spike_stream = random_stream(seed, RANDOM_SPIKES),
                                .noise = malloc((count + 1) * sizeof *sensors->noise)};
    faults_make(&sensors->faults, scenario, seed);
    const bool sticks = faults_include(&sensors->faults, FAULT_STUCK);
    sensors->last = sticks ? calloc(count + 1, sizeof *sensors->last) : NULL;
    if (!sensors->noise || (sticks && !sensors->last)) {
        sensors_free(sensors);
        return -1;
    }
    return 0;
}

void sensors_free(struct sensors *sensors)
{
    free(sensors->noise);
    free(sensors->last);
    *sensors = (struct sensors){0};
}

/* What faults make of the readings before it is converted. */
static void distort(const struct sensors *sensors, uint64_t instant, double time_s, double *concentrations)
{
    const struct faults *faults = &sensors->faults;
    if (faults_are_on(faults, FAULT_BIAS, time_s)) {
        for (size_t i = 0; i < sensors->count; i++) {
            concentrations[i] += faults_hit(faults, FAULT_BIAS, time_s, (uint32_t)i) ? sensors->bias : 0;
        }
    }
    if (faults_are_on(faults, FAULT_SPIKE, time_s)) {
        for (size_t i = 0; i < sensors->count; i++) {
            const double draw = random_uniform(sensors->spike_stream, instant * sensors->count + i);
            concentrations[i] += draw < sensors->spike_chance && faults_hit(faults, FAULT_SPIKE, time_s, (uint32_t)i)
                                     ? sensors->spike
                                     : 0;
        }
    }
    if (faults_are_on(faults, FAULT_SATURATE, time_s)) {
        for (size_t i = 0; i < sensors->count; i++) {
            if (faults_hit(faults, FAULT_SATURATE, time_s, (uint32_t)i)) {
                concentrations[i] = fmin(concentrations[i], sensors->saturate_at);
            }
        }
    }
}

/* Sensors that stick repeat their last reading. */
static void stick(struct sensors *sensors, double time_s, int32_t *counts)
{
    const bool on = faults_are_on(&sensors->faults, FAULT_STUCK, time_s);
    for (size_t i = 0; i < sensors->count; i++) {
        if (on && faults_hit(&sensors->faults, FAULT_STUCK, time_s, (uint32_t)i)) {
            counts[i] = sensors->last[i];
        }
        sensors->last[i] = counts[i];
    }
}

void sensors_read(struct sensors *sensors, uint64_t instant, double *concentrations, int32_t *counts)
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
    const double time_s = (double)instant * sensors->interval_s;
    distort(sensors, instant, time_s, concentrations);
    for (size_t i = 0; i < count; i++) {
        counts[i] = (int32_t)lround(fmin(fmax(concentrations[i] * sensors->counts_per_unit, 0), sensors->counts_max));
    }
    if (sensors->last) {
        stick(sensors, time_s, counts);
    }
}

bool sensors_lost(const struct sensors *sensors, uint64_t instant, double time_s, size_t node)
{
    if (time_s >= sensors->outage_start_s && time_s < sensors->outage_end_s) {
        return true;
    }
    return sensors->loss > 0 && random_uniform(sensors->loss_stream, instant * sensors->count + node) < sensors->loss;
}
