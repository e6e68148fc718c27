/* A sensor node's sample: conversion, differencing and the decision whether it is worth a report. */
#include "bench.h"
#include "motehound/sensor.h"

struct mh_sensor bench_state;
static struct mh_reading reading;
static struct mh_sample sample;
static volatile bool reports;

static const struct mh_sensor_config config = {
    .q20_per_count = MH_Q20(0.005f), /* g/m2 */
    .counts_max = 4095,
    .interval = 1000,
    .threshold = MH_Q20(0.2f),
};

void bench_setup(void) { mh_sensor_init(&bench_state, &config); }

void bench_prepare(unsigned step)
{
    reading.time = step * 1000u;
    reading.counts = (int32_t)(100 + 50 * step);
}

void bench_step(void)
{
    if (mh_sensor_take(&bench_state, &reading, &sample) == MH_OK) {
        reports = mh_sensor_reports(&bench_state, &sample, true);
    }
}

bool bench_worked(void) { return reports && sample.has_increment && sample.time == reading.time; }
