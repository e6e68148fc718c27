/* The sensor node's half of estimation, in integers only: ADC counts to a quantity, differencing of consecutive samples
 * (Luo, Eq. (8) = (13)) and the decision whether the sample is worth a report. */
#ifndef MOTEHOUND_SENSOR_H
#define MOTEHOUND_SENSOR_H

#include "motehound/config.h"
#include "motehound/real.h"
#include "motehound/status.h"
#include "motehound/ticks.h"

/* One reading as the converter gives it. */
struct mh_reading {
    mh_tick time;   /* when it was sampled */
    int32_t counts; /* ADC counts */
    uint8_t target; /* which target, where the sensor can tell, else 0 */
};

struct mh_sensor_config {
    int32_t zero_counts;  /* counts of a quantity of zero */
    int32_t q20_per_count; /* the quantity of one count, Q11.20 (so 1 for an ideal converter that gives Q11.20 itself) */
    int32_t counts_max;   /* readings outside 0..counts_max are refused; INT32_MAX with counts_min for no limit */
    int32_t counts_min;
    mh_tick interval;     /* between samples; differences are taken between samples interval +- interval/4 apart */
    mh_q20 threshold;     /* chi: report when increment >= chi, or value > chi while nothing is tracked */
    bool report_always;   /* report every reading (ranges), whatever chi says */
};

/* A sample that was taken. */
struct mh_sample {
    mh_tick time;
    mh_q20 value;
    mh_q20 increment;   /* 0 unless has_increment */
    bool has_increment; /* the sample one interval before was really taken */
};

struct mh_sensor {
    const struct mh_sensor_config *config; /* outlives the sensor */
    struct { mh_tick time; mh_q20 value; } past[MH_SENSOR_HISTORY]; /* newest first */
    uint8_t count;
};

/* Begin with an empty history. Errors: MH_ERR_ARGUMENT (interval 0, q20_per_count < 1, counts_min > counts_max). */
enum mh_status mh_sensor_init(struct mh_sensor *sensor, const struct mh_sensor_config *config);

/* Take one reading. A late one (older than the newest, younger than the oldest kept) fills its gap and is differenced
 * against its own predecessor. A saturating conversion clips to the range of Q11.20. Cost: O(MH_SENSOR_HISTORY), no division.
 * Errors: MH_ERR_RANGE (counts outside the converter's), MH_ERR_REPEATED (a sample of that time is kept already),
 * MH_ERR_TIME (older than all that is kept, with the history full). */
enum mh_status mh_sensor_take(struct mh_sensor *sensor, const struct mh_reading *reading, struct mh_sample *sample);

/* The kept sample taken within interval/4 of `time`. Errors: MH_NONE (not kept). */
enum mh_status mh_sensor_recall(const struct mh_sensor *sensor, mh_tick time, struct mh_sample *sample);

/* Luo, Algorithm 1, steps 2 and 3, as a node decides them alone: increment >= chi, or value > chi while no track exists. */
bool mh_sensor_reports(const struct mh_sensor *sensor, const struct mh_sample *sample, bool tracking);

#endif
