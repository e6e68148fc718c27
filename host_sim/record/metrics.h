/* What a run is judged by. */
#ifndef MOTEHOUND_SIM_METRICS_H
#define MOTEHOUND_SIM_METRICS_H

#include "record/recorder.h"
#include "record/statistics.h"
#include "scenario/scenario.h"

/* The errors of the estimates of one run, or of many together, at which the source was present; the first
 * metrics.skip_first estimates of each target are left out. */
struct errors {
    struct samples position;     /* m, at the sampling instant */
    struct samples raw_position; /* m, before filtering */
    struct samples
        position_at_arrival; /* m, against the truth at the time that the tracker says the position belongs to */
    struct samples nees;     /* e' P^-1 e, where the tracker states a covariance */
};

/* Metrics in the order of runs.csv. NaN stands for one that does not apply. */
enum metric {
    METRIC_POSITION_RMSE_M,
    METRIC_POSITION_MEDIAN_M,
    METRIC_POSITION_P95_M,
    METRIC_RAW_POSITION_RMSE_M,
    METRIC_POSITION_RMSE_AT_ARRIVAL_M,
    METRIC_NEES_MEDIAN, /* the last that struct errors alone gives */
    METRIC_TRACKED_SHARE,
    METRIC_TRACK_LOST,
    METRIC_ESTIMATES,
    METRIC_FRAMES_SENT,
    METRIC_FRAMES_SENT_BEACONS,
    METRIC_FRAMES_SENT_REPORTS,
    METRIC_FRAMES_SENT_REQUESTS,
    METRIC_FRAMES_RECEIVED,
    METRIC_FRAMES_LOST,
    METRIC_READINGS,
    METRIC_READINGS_REFUSED,
    METRIC_REPORTS,
    METRIC_REPORTS_ASKED,
    METRIC_REPORTS_NO_ROUTE,
    METRIC_MEASUREMENTS,
    METRIC_MEASUREMENTS_LATE,
    METRIC_MEASUREMENTS_OVERFLOWED,
    METRIC_COUNT
};

enum { METRIC_ERRORS_COUNT = METRIC_NEES_MEDIAN + 1 };

/* position_rmse_m, ..., with the unit in the name where there is one. */
extern const char *const metric_names[METRIC_COUNT];

/* The errors of a run; `errors` begins as all zero bytes. Returns 0, or -1 if there is no memory. */
int errors_of(const struct recorder *recorder, const struct scenario *scenario, struct errors *errors);

/* `more` added to `errors`. Returns 0, or -1 if there is no memory. */
int errors_append(struct errors *errors, const struct errors *more);

void errors_free(struct errors *errors);

/* The first METRIC_ERRORS_COUNT metrics, from the errors alone. Puts the errors in ascending order. */
void metrics_of_errors(struct errors *errors, double values[METRIC_ERRORS_COUNT]);

/* All metrics of a run. tracked_share: share of the sampling instants with the source present that gave a position.
 * track_lost: 1 if the error exceeded metrics.lost_m in metrics.lost_samples successive estimates of a target, else 0.
 * Takes the run's errors as errors_of gave them, and puts them in ascending order. */
void metrics_of_run(const struct recorder *recorder, const struct scenario *scenario, struct errors *errors,
                    double values[METRIC_COUNT]);

#endif
