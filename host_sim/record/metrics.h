/* What a run is judged by. */
#ifndef MOTEHOUND_SIM_METRICS_H
#define MOTEHOUND_SIM_METRICS_H

#include "record/recorder.h"
#include "record/statistics.h"
#include "scenario/scenario.h"

enum { LOCAL_CLUSTERS = 4 }; /* fixed clusters that have metrics of their own */

/* The errors of the estimates of one run, or of many together, at which the source was present; the first
 * metrics.skip_first estimates of each target are left out; of a search (sensor.quantity gas) only the last one counts. */
struct errors {
    struct samples position;      /* m, at the sampling instant */
    struct samples single, group; /* the same of single targets, and of the centroids of groups */
    struct samples raw_position;  /* m, before filtering */
    struct samples
        position_at_arrival; /* m, against the truth at the time that the tracker says the position belongs to */
    struct samples found;    /* of a search (sensor.quantity gas) the same, m; so below */
    struct samples rate;     /* of the rate of release, as a share of the true one */
    struct samples
        efficiency;         /* of the position over its Cramer-Rao bound, at most 5, where the search has succeeded */
    struct samples nees;    /* e' P^-1 e, of all states that the tracker states a covariance of */
    struct samples claimed; /* m2, variance of the position that the tracker states, both coordinates added */
    struct samples local_position[LOCAL_CLUSTERS], local_nees[LOCAL_CLUSTERS]; /* of fixed clusters by themselves */
    /* Of fixed clusters, all estimates: the sum of their squared errors, m2, and their number, by sampling instants since the first; and how many of these
     * instants are left out. */
    struct samples squares, counts;
    size_t squares_skipped;
};

/* Metrics in the order of runs.csv, the totals last: identifier, name with its unit, meaning. NaN stands for one that does not apply. */
/* clang-format off */
#define METRICS_OF_ERRORS(X) /* what struct errors alone gives */                                                           \
    X(POSITION_RMSE_M, "position_rmse_m", "root mean square error of the position")                                         \
    X(POSITION_ERROR_M, "position_error_m", "mean error of the position of single targets")                                 \
    X(GROUP_CENTROID_ERROR_M, "group_centroid_error_m", "sound: mean error of the centroid of groups")                      \
    X(POSITION_MEDIAN_M, "position_median_m", "median error of the position")                                               \
    X(POSITION_P95_M, "position_p95_m", "95th percentile of the error")                                                     \
    X(RAW_POSITION_RMSE_M, "raw_position_rmse_m", "root mean square error before the filter")                               \
    X(POSITION_RMSE_AT_ARRIVAL_M, "position_rmse_at_arrival_m", "error against the position at the estimated time of arrival") \
    X(POSITION_ERROR_MEDIAN_M, "position_error_median_m", "gas: median over the searches of the error of the position that they end with")  \
    X(RATE_ERROR_MEDIAN, "rate_error_median", "gas: the same of the rate of release, as a share of the true one")          \
    X(ERROR_OVER_CRLB, "error_over_crlb", "gas: root mean square, over the searches that succeed within 50 m, of the position's error over its Cramer-Rao bound, each at most 5") \
    X(NEES_MEDIAN, "nees_median", "median normalised squared error of all states (exact: 1.39 of two, 2.37 of three, 3.36 of four)") \
    X(ANEES, "anees", "mean normalised squared error of all states (their number is exact, more is overconfident)")         \
    X(CLAIMED_OVER_RMSE, "claimed_over_rmse", "the root mean square error that the tracker claims over that which it has")  \
    X(SMSE_M, "smse_m", "fixed clusters: the root mean square error over the runs, added up over all instants with a position") \
    X(POSITION_RMSE_WORST_M, "position_rmse_worst_m", "fixed clusters: the root mean square error over the runs at the worst instant") \
    X(LOCAL_POSITION_RMSE_M_1, "local_position_rmse_m_1", "root mean square error of the first fixed cluster by itself")    \
    X(LOCAL_POSITION_RMSE_M_2, "local_position_rmse_m_2", "of the second")                                                  \
    X(LOCAL_POSITION_RMSE_M_3, "local_position_rmse_m_3", "of the third")                                                   \
    X(LOCAL_POSITION_RMSE_M_4, "local_position_rmse_m_4", "of the fourth")                                                  \
    X(LOCAL_ANEES_1, "local_anees_1", "mean normalised squared error of the first fixed cluster by itself (4 is exact)")    \
    X(LOCAL_ANEES_2, "local_anees_2", "of the second")                                                                      \
    X(LOCAL_ANEES_3, "local_anees_3", "of the third")                                                                       \
    X(LOCAL_ANEES_4, "local_anees_4", "of the fourth")

#define METRICS_OF_TRACK(X)                                                                                                 \
    X(TRACKED_SHARE, "tracked_share", "share of the sampling instants with the source present that gave a position")        \
    X(TRACK_LOST, "track_lost", "1 if the error exceeded metrics.lost_m in metrics.lost_samples successive estimates, else 0; prince: or if a target had no fix on the last 150 m of its way") \
    X(COVERED_SHARE, "covered_share", "share of the positions whose error was at most three times the standard deviation that they state") \
    X(OVERCONFIDENT_SAMPLES, "overconfident_samples", "longest succession of positions whose error was larger than that")   \
    X(ESTIMATES, "estimates", "positions that the head reported")                                                           \
    X(LOCALISATION_ERROR_RS, "localisation_error_rs", "ranged target: mean error of the heads' positions, as a share of sensor.range_m, from sample metrics.skip_first on") \
    X(SINK_ERROR_RS, "sink_error_rs", "clusters: the same of the positions that the sink has")                              \
    X(RMSE_OVER_PCRB, "rmse_over_pcrb", "ranged walk: position_rmse_m over pcrb_m")                                         \
    X(SUCCESS_50M, "success_50m", "gas: 1 if the search ended by itself within 50 m of the source, else 0")                 \
    X(SUCCESS_10M, "success_10m", "gas: the same within 10 m")                                                              \
    X(CONVERGED, "converged", "gas: 1 if it ended by itself wherever, 0 if it was broken off")                              \
    X(CONVERGED_WRONG, "converged_wrong", "gas: 1 if it ended by itself, but 50 m or more from the source, else 0")         \
    X(HOPS, "hops", "gas: heads that have led the search")                                                                 \
    X(SENSORS_USED, "sensors_used", "gas: different sensors that were heard")                                               \
    X(SENSORS_TO_10M, "sensors_to_10m", "gas: the same until the error fell below 10 m for good")                          \
    X(CRLB_M, "crlb_m", "gas: the Cramer-Rao bound of the position from the samples that were heard")                      \
    X(RATE_CRLB, "rate_crlb", "gas: the same of the rate of release, as a share of it")                                    \
    X(LONGEST_GAP_S, "longest_gap_s", "ranged target: longest time without a head's position within sensor.range_m of the target") \
    X(SUCCESS, "success", "sound: 1 if no target was lost, or taken for another in the end, and no two tracks became one, else 0") \
    X(IDENTITY_SWAPS, "identity_swaps", "sound: exchanges of identifiers that would set right the tracks that are with each other's targets in the end") \
    X(SWAPS_CLAIMED, "swaps_claimed", "sound: of these between tracks that do not say that they cannot tell who is who")     \
    X(UNRESOLVED, "unresolved", "sound: 1 if a target's track says so in the end, else 0")                                  \
    X(LONGEST_GAP_M, "longest_gap_m", "sound: the largest distance that a target travels between two fixes, or after the last") \
    X(MERGE_DELAY_S, "merge_delay_s", "groups: mean time from when two targets come together (a chain of steps within 20 m) until they are in one group") \
    X(SPLIT_DELAY_S, "split_delay_s", "groups: the same from when they come apart (30 m) until they are not")               \
    X(EXTENT_BIAS_M, "extent_bias_m", "groups: mean of the extent, less the root mean square distance of the targets from their centroid") \
    X(MODE_CHANGES_PER_MIN, "mode_changes_per_min", "sound: instants a minute at which a target becomes single, one of several or part of a group") \
    X(SPURIOUS_SPLITS_PER_MIN, "spurious_splits_per_min", "groups: instants a minute at which one loses targets that are together, of the time that targets are") \
    X(COUNT_RIGHT, "count_right", "sound, ideal network: share of the sampling instants at which as many targets are followed as there are, those in groups with them") \
    X(APART_AT_END, "apart_at_end", "sound: 1 if every target is followed by itself in the end (on the last 150 m of its way), else 0") \
    X(RMSE_OVER_CRLB, "rmse_over_crlb", "sound: position_rmse_m over fix_crlb_m")                                           \
    X(RATE_RATIO, "rate_ratio", "leak: the last estimate of its rate of release over the true one")
/* clang-format on */

#define METRIC_ENUMERATOR(id, name, meaning) METRIC_##id,
#define METRIC_ENUMERATOR_OF_TOTAL(id, name, value, meaning) METRIC_##id,
enum metric {
    METRICS_OF_ERRORS(METRIC_ENUMERATOR) METRICS_OF_TRACK(METRIC_ENUMERATOR) TOTALS(METRIC_ENUMERATOR_OF_TOTAL)
        METRIC_COUNT
};

enum { METRIC_ERRORS_COUNT = METRIC_TRACKED_SHARE, METRIC_FIRST_TOTAL = METRIC_COUNT - TOTAL_COUNT };

/* True of the error metrics that are defined over many runs, so that a mean of what single runs have would be another thing. */
bool metric_is_over_runs(enum metric metric);

extern const char *const metric_names[METRIC_COUNT];
extern const char *const metric_meanings[METRIC_COUNT];

/* The errors of a run; `errors` begins as all zero bytes. Returns 0, or -1 if there is no memory. */
int errors_of(const struct recorder *recorder, const struct scenario *scenario, struct errors *errors);

/* `more` added to `errors`. Returns 0, or -1 if there is no memory. */
int errors_append(struct errors *errors, const struct errors *more);

void errors_free(struct errors *errors);

/* The first METRIC_ERRORS_COUNT metrics, from the errors alone. Puts the errors in ascending order. */
void metrics_of_errors(struct errors *errors, double values[METRIC_ERRORS_COUNT]);

/* All metrics of a run. Takes the run's errors as errors_of gave them, and puts them in ascending order. */
void metrics_of_run(const struct recorder *recorder, const struct scenario *scenario, struct errors *errors,
                    double values[METRIC_COUNT]);

#endif
