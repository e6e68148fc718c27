/* The tracker `range`: constant velocity in the plane, measured by ranges, one scalar update a range.
 *
 * Measurements are slant ranges in m from anchors whose places have a z. An extended Kalman filter (kalman.h) with states x, y,
 * vx, vy takes them in the order of time, each at its own time, and the estimate is predicted from the last one to the sampling
 * instant. One target: all measurements are taken for its.
 *
 * Start: the first instant with at least three ranges that agree on a place (multilateration.h, which states the ambiguity), at rest with
 * a standard deviation of 5 s x acceleration_sd in speed. A track that has taken no range for 10 s is dropped, and starts again so.
 * Outliers: a range that is off by more than three standard deviations of its innovation is refused. That cannot lock a lost filter
 * out: after five instants in a row at which most ranges were refused the track starts again as above if it can, and after
 * ten refusals in a row without an exception the next range is believed and the covariance widened to fit it (mh_gate). Ranges not
 * above 0, older than the newest taken, or later than the instant are left out.
 *
 * What an estimate holds: `covariance` of position; `raw` equals position; `age` 0; `measurements` the ranges taken; `flags` STARTED
 * and COASTED; `origin` the first anchor heard at the start, with the target's height as z; mh_real resolves 1 mm 10 km from it.
 * step() gives MH_NONE while there is no track. interest() does not exist: every anchor reports unasked. */
#ifndef MOTEHOUND_RANGE_H
#define MOTEHOUND_RANGE_H

#include "motehound/kalman.h"
#include "motehound/tracker.h"

struct mh_range_config {
    /* Standard deviation of one range, 1e-3 to 100 m, as white noise. Where the error keeps its sign over n readings in a row (as the
     * bias of a radio does), their mean is no better than one of them: give sqrt(n) times the sensor's standard deviation.
     * Nominal 0.3: a UWB radio of 0.1 m whose error lasts about a second, read ten times a second. */
    mh_real range_sd_m;
    /* Of the target: its velocity wanders by this much in 1 s, and with the square root of time; 1e-3 to 1e3 m/s2. Nominal 1: a
     * walking person or a robot, which gains or loses its walking speed in about a second. */
    mh_real acceleration_sd_mps2;
    /* Of the target in the field's frame (z), within +- 1e5 m, so that slant ranges can be used in the plane. Nominal 1: in
     * a hand, on a belt or on a cart. */
    mh_real height_m;
};

/* The state, in the header so that it can be allocated statically; its members are the tracker's own. */
struct mh_range {
    struct mh_range_config config;
    struct mh_kalman filter;
    struct mh_gate gate;
    struct mh_place origin;
    mh_tick time;     /* of the last step */
    mh_tick updated;  /* the filter's time */
    mh_tick accepted; /* of the last range taken */
    uint8_t doubted;  /* instants in a row at which most ranges were refused */
    bool stepped;     /* `time` is set */
    bool tracking;
};

extern const struct mh_tracker mh_tracker_range;

void mh_range_config_default(struct mh_range_config *config);

#endif
