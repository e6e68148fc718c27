/* What the nodes' sensors make of the field: noise, the converter, readings that never come, and what is wrong with some of them. */
#ifndef MOTEHOUND_SIM_WORLD_SENSOR_H
#define MOTEHOUND_SIM_WORLD_SENSOR_H

#include "engine/random.h"
#include "motehound/sensor.h"
#include "scenario/scenario.h"
#include "world/faults.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* How scenario->sensor converts: the quantum is full_scale / 2^adc_bits, as a whole number of 2^-20 g/m2 (at least 1), so that the
 * mote's q20_per_count states it exactly; with adc_bits 0 it is 2^-20 g/m2 itself, to the end of Q11.20. Ranges, in m in its place, may be
 * negative down to the same magnitude. Where they are measured, or there is no source, every sample is reported. Threshold
 * chi and interval come from scenario->tracker and scenario->sensor. */
struct mh_sensor_config sensor_config(const struct scenario *scenario);

struct sensors {
    size_t count;
    double relative_noise, additive_noise;
    double counts_per_unit, counts_min, counts_max;
    double loss, outage_start_s, outage_end_s;
    double interval_s;
    struct faults faults;
    double spike_chance, spike, saturate_at, bias;
    struct random_stream relative_stream, additive_stream, loss_stream, spike_stream;
    double *noise; /* one row of normals */
    int32_t *last; /* what each sensor read last; NULL if none ever sticks */
};

/* The sensors of `count` nodes. Returns 0, or -1 if there is no memory (nothing to free). */
int sensors_make(struct sensors *sensors, const struct scenario *scenario, uint64_t seed, size_t count);

void sensors_free(struct sensors *sensors);

/* concentrations[i] of node i at instant number `instant` -> counts[i]: C (1 + relative g1) + additive g2, clipped at the
 * converter's first (0) and last count, rounded. g1 and g2 are number (instant x count + i) of their streams. A fault adds its bias or spike before that,
 * saturates before the converter does, sticks after it. Overwrites concentrations. Instants in ascending order. */
void sensors_read(struct sensors *sensors, uint64_t instant, double *concentrations, int32_t *counts);

/* One value, in the unit of the quantity measured, of `node` near instant number `instant` -> counts, as sensors_read does it from the faults on; what
 * noise it has is in it already. The instants of one node in ascending order. */
int32_t sensors_convert(struct sensors *sensors, uint64_t instant, double time_s, size_t node, double value);

/* The reading of `node` at instant number `instant`, which is at `time_s`, never comes. */
bool sensors_lost(const struct sensors *sensors, uint64_t instant, double time_s, size_t node);

#endif
