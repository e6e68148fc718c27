#include "motehound/sensor.h"

#include <stddef.h>
#include <string.h>

static mh_q20 saturate(int64_t a) { return a > INT32_MAX ? INT32_MAX : a < INT32_MIN ? INT32_MIN : (mh_q20)a; }

/* |later - earlier - nominal|, without overflow for any ticks. */
static uint32_t deviation(mh_tick earlier, mh_tick later, mh_tick nominal)
{
    const int64_t difference = (int64_t)mh_ticks_between(earlier, later) - (int64_t)nominal;
    return (uint32_t)(difference < 0 ? -difference : difference);
}

/* The kept sample, of `target` or of any (-1), that is nearest to `elapsed` ticks before `time`, at most interval/4 off. */
static const struct mh_sensor_past *find(const struct mh_sensor *sensor, mh_tick time, mh_tick elapsed, int target)
{
    const struct mh_sensor_past *found = NULL;
    uint32_t nearest = (sensor->config->interval >> 2) + 1;
    for (uint8_t i = 0; i < sensor->count; i++) {
        const struct mh_sensor_past *past = &sensor->past[i];
        const uint32_t off = deviation(past->time, time, elapsed);
        if (off < nearest && (target < 0 || past->target == target)) {
            nearest = off;
            found = past;
        }
    }
    return found;
}

/* Eq. (8) = (13) of Luo, where both samples were really taken. */
static struct mh_sample sample_of(const struct mh_sensor *sensor, const struct mh_sensor_past *past)
{
    const struct mh_sensor_past *before = find(sensor, past->time, sensor->config->interval, past->target);
    const struct mh_sample sample = {
        .time = past->time,
        .value = past->value,
        .increment = before ? saturate((int64_t)past->value - before->value) : 0,
        .has_increment = before != NULL,
        .reported = past->reported,
        .target = past->target,
    };
    return sample;
}

enum mh_status mh_sensor_init(struct mh_sensor *sensor, const struct mh_sensor_config *config)
{
    if (!sensor || !config || config->interval < 1 || config->interval > 3600000u || config->q20_per_count < 1 ||
        config->counts_min > config->counts_max || config->report_spread >= config->interval) {
        return MH_ERR_ARGUMENT;
    }
    memset(sensor, 0, sizeof *sensor);
    sensor->config = config;
    return MH_OK;
}

enum mh_status mh_sensor_take(struct mh_sensor *sensor, const struct mh_reading *reading, struct mh_sample *sample)
{
    const struct mh_sensor_config *config = sensor->config;
    if (reading->counts < config->counts_min || reading->counts > config->counts_max) {
        return MH_ERR_RANGE;
    }
    uint8_t place = 0; /* of the new sample: behind all that are newer */
    for (uint8_t i = 0; i < sensor->count; i++) {
        if (sensor->past[i].time == reading->time && sensor->past[i].target == reading->target) {
            return MH_ERR_REPEATED;
        }
        place = (uint8_t)(place + mh_tick_before(reading->time, sensor->past[i].time));
    }
    if (place == MH_SENSOR_HISTORY) {
        return MH_ERR_TIME;
    }
    if (sensor->count < MH_SENSOR_HISTORY) {
        sensor->count++;
    }
    for (uint8_t i = (uint8_t)(sensor->count - 1); i > place; i--) {
        sensor->past[i] = sensor->past[i - 1];
    }
    /* 33 bits times 31 bits fit in 64 with the sign */
    const struct mh_sensor_past taken = {
        .time = reading->time,
        .value = saturate(((int64_t)reading->counts - config->zero_counts) * config->q20_per_count),
        .target = reading->target,
    };
    sensor->past[place] = taken;
    *sample = sample_of(sensor, &taken);
    return MH_OK;
}

bool mh_sensor_is_of(const struct mh_sensor *sensor, const struct mh_sample *sample, mh_tick instant)
{
    return deviation(sample->time, instant, 0) <= sensor->config->interval >> 2;
}

enum mh_status mh_sensor_recall(const struct mh_sensor *sensor, mh_tick instant, struct mh_sample *sample)
{
    const struct mh_sensor_past *past = find(sensor, instant, 0, -1);
    if (!past) {
        return MH_NONE;
    }
    *sample = sample_of(sensor, past);
    return MH_OK;
}

void mh_sensor_mark_reported(struct mh_sensor *sensor, const struct mh_sample *sample)
{
    for (uint8_t i = 0; i < sensor->count; i++) {
        struct mh_sensor_past *past = &sensor->past[i];
        past->reported |= past->time == sample->time && past->target == sample->target;
    }
}

bool mh_sensor_reports(const struct mh_sensor *sensor, const struct mh_sample *sample, bool tracking)
{
    const mh_q20 chi = sensor->config->threshold;
    return sensor->config->report_always || (sample->has_increment && sample->increment >= chi) ||
           (!tracking && sample->value > chi);
}
