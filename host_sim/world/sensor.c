#include "world/sensor.h"
#include "reals.h"

#include <math.h>
#include <stdlib.h>

struct mh_sensor_config sensor_config(const struct scenario *scenario)
{
    const int64_t bits = scenario->sensor.adc_bits;
    const bool ideal = bits == 0;
    const bool negative = scenario->sensor.quantity != QUANTITY_CONCENTRATION; /* by noise */
    const int32_t counts_max = ideal ? INT32_MAX : (int32_t)((INT64_C(1) << bits) - 1);
    const double quantum = ideal ? 1 : fmax(1, round(ldexp(scenario->sensor.full_scale, 20 - (int)bits)));
    return (struct mh_sensor_config){
        .q20_per_count = (int32_t)fmin(quantum, INT32_MAX),
        .counts_min = !negative ? 0
                      : ideal   ? INT32_MIN
                                : -counts_max,
        .counts_max = counts_max,
        .interval = (mh_tick)llround(scenario->sensor.interval_s * MH_TICKS_PER_S),
        .threshold = q20_of(scenario->tracker.chi),
        .report_always = negative || scenario->source.path == PATH_NONE,
    };
}

int sensors_make(struct sensors *sensors, const struct scenario *scenario, uint64_t seed, size_t count)
{
    const struct mh_sensor_config config = sensor_config(scenario);
    *sensors = (struct sensors){.count = count,
                                .relative_noise = scenario->sensor.relative_noise,
                                .additive_noise = scenario->sensor.additive_noise,
                                .counts_per_unit = ldexp(1.0, 20) / config.q20_per_count,
                                .counts_min = config.counts_min,
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

/* Which faults are on. */
struct distortion {
    bool bias, spike, saturate, stuck;
};

static struct distortion distortion_at(const struct sensors *sensors, double time_s)
{
    const struct faults *faults = &sensors->faults;
    return (struct distortion){.bias = faults_are_on(faults, FAULT_BIAS, time_s),
                               .spike = faults_are_on(faults, FAULT_SPIKE, time_s),
                               .saturate = faults_are_on(faults, FAULT_SATURATE, time_s),
                               .stuck = sensors->last && faults_are_on(faults, FAULT_STUCK, time_s)};
}

/* One value through faults and converter. */
static int32_t convert(struct sensors *sensors, struct distortion on, uint64_t instant, double time_s, size_t node,
                       double value)
{
    const struct faults *faults = &sensors->faults;
    const uint32_t mote = (uint32_t)node;
    if (on.bias && faults_hit(faults, FAULT_BIAS, time_s, mote)) {
        value += sensors->bias;
    }
    if (on.spike && faults_hit(faults, FAULT_SPIKE, time_s, mote) &&
        random_uniform(sensors->spike_stream, instant * sensors->count + node) < sensors->spike_chance) {
        value += sensors->spike;
    }
    if (on.saturate && faults_hit(faults, FAULT_SATURATE, time_s, mote)) {
        value = fmin(value, sensors->saturate_at);
    }
    int32_t counts =
        (int32_t)lround(fmin(fmax(value * sensors->counts_per_unit, sensors->counts_min), sensors->counts_max));
    if (on.stuck && faults_hit(faults, FAULT_STUCK, time_s, mote)) {
        counts = sensors->last[node];
    }
    if (sensors->last) {
        sensors->last[node] = counts;
    }
    return counts;
}

int32_t sensors_convert(struct sensors *sensors, uint64_t instant, double time_s, size_t node, double value)
{
    return convert(sensors, distortion_at(sensors, time_s), instant, time_s, node, value);
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
    const struct distortion on = distortion_at(sensors, time_s);
    for (size_t i = 0; i < count; i++) {
        counts[i] = convert(sensors, on, instant, time_s, i, concentrations[i]);
    }
}

bool sensors_lost(const struct sensors *sensors, uint64_t instant, double time_s, size_t node)
{
    if (time_s >= sensors->outage_start_s && time_s < sensors->outage_end_s) {
        return true;
    }
    return sensors->loss > 0 && random_uniform(sensors->loss_stream, instant * sensors->count + node) < sensors->loss;
}
