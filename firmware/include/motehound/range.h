/* The tracker `range`: one target at nearly constant velocity in the plane, measured by ranges; for many sensors that answer at once
 * as for few that are read one after the other.
 *
 * Measurements are slant ranges in m from anchors whose places have a z. A Kalman filter (kalman.h) with states x, y, vx, vy takes them
 * in the order of time, and the estimate is predicted from the last one to the sampling instant.
 * - Three or more ranges while the target moves less than a tenth of a range's standard deviation are one instant's: they become a position
 *   by maximum likelihood from the predicted one (range_fix.h), which is one linear measurement. If it lies outside the chi-square
 *   gate of 12, the target is manoeuvring: its velocity is taken to have changed by sqrt(2) x speed at the instant before.
 * - Fewer, or such as do not agree on a position, are taken one by one by an extended filter, where the circle bends by more than the noise
 *   with the second-order terms of the range (Bar-Shalom, Li and Kirubarajan, 2001, Eqs. (10.3.2-4) and (10.3.2-7)): d + p / (2 d), variance
 *   p^2 / (2 d^2) for a variance p across the line of sight. A range that is off by more than three standard deviations of its innovation is
 *   refused, unless a manoeuvre as above would explain it.
 * - A lost filter is not locked out: when the last 20 or so of these innovations were more than 2.8 standard deviations (root mean square,
 *   outliers counted as five) the track starts again if it can, and after ten refusals in a row without an exception the next range is
 *   believed and the covariance widened to fit it (mh_gate).
 * - Ranges older than the newest taken, or later than the instant, are left out. They may be negative, as noise makes them.
 *
 * Errors of the ranges (bias_sd_m, scale_sd > 0): a range is (1 + scale) distance + bias + noise, with one scale for all, for that is the
 * radios' make, and a bias for each anchor. They are states of the filter, so that their uncertainty is in the covariance of position;
 * ranges are then taken one by one. What was learned outlives a track that fell silent, not one that went astray.
 *
 * Start: where the sensors' range is known, at the centre of those that answer, and from there the maximum likelihood if there is one; else
 * as soon as the last ranges of at least three anchors, none older than 10 s, agree on a place (multilateration.h, which states the
 * ambiguity). At rest with a standard deviation of 0.77 x speed. A track that has taken no range for 10 s and five intervals is
 * dropped, and starts again so.
 *
 * What an estimate holds: `covariance` of position; `raw` equals position; `age` 0; `measurements` the ranges taken; `flags` STARTED,
 * COASTED and REFRESHED; `origin` an anchor heard at the start, with the target's height as z; mh_real resolves 1 mm 10 km from it.
 * `stored` is the extrapolation of the state as last reported (followed.h); where the estimate leaves it by more than the
 * tolerance, it is the state itself, and REFRESHED. step() gives MH_NONE while there is no track. interest() does not exist: whoever hears
 * the target reports.
 *
 * Cost of a step with 12 ranges of one instant: about 800 additions and multiplications, 50 roots and divisions (docs/costs.md). A saved track
 * takes 60 bytes; what was learned of the ranges' errors is not in it. */
#ifndef MOTEHOUND_RANGE_H
#define MOTEHOUND_RANGE_H

#if MH_REAL_FIXED
#error "motehound/range.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/followed.h"
#include "motehound/kalman.h"
#include "motehound/tracker.h"

#define MH_RANGE_SAVED 60 /* bytes of a saved track */

struct mh_range_config {
    /* Standard deviation of one range, 1e-3 to 100 m, as white noise. Where the error keeps its sign over n readings in a row (as the
     * bias of a radio does), their mean is no better than one of them: give sqrt(n) times the sensor's standard deviation.
     * Nominal 0.3: a UWB radio of 0.1 m whose error lasts about a second, read ten times a second. */
    mh_real range_sd_m;
    /* Standard deviations of an anchor's constant bias, 0 to 100 m, and of the scale of all ranges, as a share, 0 to 0.5; nominal 0: it is
     * right, and not learned. */
    mh_real bias_sd_m, scale_sd;
    /* No sensor hears the target from farther away, 0 to 1e5 m; nominal 0: unknown. */
    mh_real sensing_range_m;
    /* Of the target: its velocity wanders by this much in 1 s, and with the square root of time; 1e-3 to 1e3 m/s2. Nominal 1: a
     * walking person or a robot, which gains or loses its walking speed in about a second. Where speed and heading are redrawn every T seconds
     * as a Gauss-Markov process with memory a: sqrt((1 - a^2) (speed_sd^2 + (heading_sd x speed)^2) / (2 T)). */
    mh_real acceleration_sd_mps2;
    /* Of the target: how fast it usually is, 1e-3 to 1e4 m/s. Nominal 1.5. */
    mh_real speed_mps;
    /* Of the target in the field's frame (z), within +- 1e5 m, so that slant ranges can be used in the plane. Nominal 1: in
     * a hand, on a belt or on a cart. */
    mh_real height_m;
    /* How far the estimate may be from what is stored of the track, 0 to 1e5 m. Nominal 0: every one is reported. */
    mh_real tolerance_m;
};

/* The state, in the header so that it can be allocated statically; its members are the tracker's own. */
struct mh_range {
    struct mh_range_config config;
    struct mh_kalman filter;
    mh_node_id anchors[MH_RANGE_BIASES_MAX + 1]; /* whose bias is state 4 + i */
    struct mh_measurement
        heard[MH_RANGE_HEARD_MAX]; /* while there is no track: the last range of each anchor, in the order of time */
    struct mh_gate gate;
    struct mh_followed followed;
    struct mh_place origin;
    mh_tick interval;
    mh_tick time;     /* of the last step */
    mh_tick updated;  /* the filter's time: of the last range taken */
    mh_real surprise; /* mean of the last innovations, squared, in units of their variance */
    uint8_t heard_count;
    bool stepped; /* `time` is set */
    bool tracking;
};

extern const struct mh_tracker mh_tracker_range;

void mh_range_config_default(struct mh_range_config *config);

#endif
