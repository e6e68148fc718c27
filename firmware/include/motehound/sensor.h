/* The sensor node's half of estimation, in integers only: ADC counts to a quantity, differencing of consecutive samples
 * (Luo, Eq. (8) = (13)) and the decision whether the sample is worth a report.
 *
 * Scaling and overflow: Q11.20 whatever mh_real is; products and differences in 64 bits, saturated to +-2048 of the sensor's unit, which heads count (head.h). Nothing is rounded. */
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
    int32_t zero_counts; /* counts of a quantity of zero */
    int32_t
        q20_per_count;  /* the quantity of one count, Q11.20, >= 1 (1: an ideal converter that gives Q11.20 itself) */
    int32_t counts_min; /* readings outside counts_min..counts_max are refused; */
    int32_t counts_max; /* INT32_MIN and INT32_MAX: no limit */
    mh_tick interval;   /* between samples, 1 to 3,600,000; jitter of up to a quarter of it is tolerated */
    mh_q20 threshold;   /* chi: report when increment >= chi, or value > chi while nothing is tracked */
    bool report_always; /* report every reading (ranges), whatever chi says */
    /* The reports of one instant leave spread over so long, so that neighbours who sample together do not all speak at once. Below
     * interval; 0: at once. Leave them the rest of the head's window to travel. */
    mh_tick report_spread;
};

/* A sample that was taken. */
struct mh_sample {
    mh_tick time;
    mh_q20 value;
    mh_q20 increment;   /* value - value one interval before, saturated; 0 unless has_increment */
    bool has_increment; /* the sample one interval before was really taken */
    bool reported;      /* mh_sensor_mark_reported was called for it */
    uint8_t target;
};

struct mh_sensor {
    const struct mh_sensor_config *config; /* outlives the sensor */
    struct mh_sensor_past {
        mh_tick time;
        mh_q20 value;
        uint8_t target;
        bool reported;
    } past[MH_SENSOR_HISTORY]; /* newest first, shared by all targets */
    uint8_t count;
};

/* Begin with an empty history. Errors: MH_ERR_ARGUMENT (a null pointer, interval, q20_per_count or
 * report_spread outside its range, counts_min > counts_max). */
enum mh_status mh_sensor_init(struct mh_sensor *sensor, const struct mh_sensor_config *config);

/* Take one reading. A late one (older than the newest) fills its gap and is differenced against its own predecessor: the
 * kept sample of the same target that was taken one interval before, give or take interval/4. Without one there is no
 * increment: a reading that never came is never made up. The conversion and the difference saturate to the range of Q11.20.
 * Cost: O(MH_SENSOR_HISTORY), no division.
 * Errors: MH_ERR_RANGE (counts outside the converter's), MH_ERR_REPEATED (a sample of that time and target is kept
 * already), MH_ERR_TIME (older than all that is kept, with the history full; so too after a pause of more than 24.8 days,
 * half the range of ticks, or when a clock was set back: begin anew with mh_sensor_init then). */
enum mh_status mh_sensor_take(struct mh_sensor *sensor, const struct mh_reading *reading, struct mh_sample *sample);

/* True if the sample is the one of `instant`: taken within interval/4 of it. */
bool mh_sensor_is_of(const struct mh_sensor *sensor, const struct mh_sample *sample, mh_tick instant);

/* The kept sample of `instant`, the nearest in time if there are several. Errors: MH_NONE (not kept). */
enum mh_status mh_sensor_recall(const struct mh_sensor *sensor, mh_tick instant, struct mh_sample *sample);

/* Remember that `sample`, as taken or recalled, was reported. No effect if it is no longer kept. */
void mh_sensor_mark_reported(struct mh_sensor *sensor, const struct mh_sample *sample);

/* Luo, Algorithm 1, steps 2 and 3, as a node decides them alone: increment >= chi, or value > chi while no track exists. */
bool mh_sensor_reports(const struct mh_sensor *sensor, const struct mh_sample *sample, bool tracking);

#endif
