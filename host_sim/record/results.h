/* The files of one or many runs: summary.json, runs.csv, track.csv, nodes.csv, scenario.json, of fixed clusters local.csv, of the protocol `prince`
 * watch.csv, of targets that are heard truth.csv and, with a log, events.lcm. Runs are added in their order, whatever order they ended in, so the same runs give the same bytes.
 *
 * summary.json: {"scenario", "seed", "runs", "version", "metrics", "pooled"}. "metrics" holds for each metric the
 * "mean", "std" (divisor n - 1), "median", "p95" and "n" over the runs to which it applies; "pooled" the error metrics
 * over all estimates of all runs together, which is also the "mean" of a metric that is defined over runs (metrics.h). Where motes lived on boards there is "boards", a list with one object a board: "node", "board", "image",
 * "arithmetic", "events", "cycles_mean", "cycles_max", "rate_hz", "late", "overlapped", "reports_max", "neighbours_max", where it had estimates "steps" with "n", "cycles_median", "cycles_p95" and "cycles_max" (hosts/step_cycles.h), and where it has its own memory "ram_b", "ram_static_b", "stack_b", "ram_free_b". track.csv: one row an estimate of the node `head`; sd_m is the standard deviation of one
 * coordinate, sqrt((cov_xx + cov_yy) / 2); sink_x_m, sink_y_m are what the sink of clusters had of it at that instant; number is that
 * of the true target that it is compared with, extent_m that of a group and of_0 ... the identifiers of its targets. Fields that do not apply are empty. nodes.csv: where the motes of the first
 * run stand. local.csv: of fixed clusters, one row for whatever each of them had by itself when it told the sink. watch.csv: one row for
 * each new head of a target: who it is, who is to follow it and when, and where the target was then. truth.csv: where each target was at every sampling
 * instant. scenario.json: the scenario as it was simulated; none for a recording. */
#ifndef MOTEHOUND_SIM_RESULTS_H
#define MOTEHOUND_SIM_RESULTS_H

#include "hosts/boards.h"
#include "record/metrics.h"
#include "record/output.h"

#include <lcm/lcm.h>
#include <stdbool.h>
#include <stdint.h>

struct results {
    struct output output;
    const char *scenario_name;
    const struct scenario *scenario; /* NULL for a recording */
    uint64_t seed;
    FILE *runs, *track;
    FILE *local, *watch, *truth; /* each NULL until there is something to put */
    lcm_eventlog_t *log;         /* NULL without --log */
    int64_t log_offset_us;       /* one run after the other */
    unsigned run_count;
    motehound_track_t last; /* estimate of the run added last; all zero where there was none */
    struct samples metrics[METRIC_COUNT];
    struct errors pooled;
    struct board_results boards; /* of motes that lived on boards: whoever runs them adds to it */
};

/* Begin in folder `out`; `scenario` is the one that is simulated, or NULL for a recording. It and the name stay valid
 * until results_commit. Returns 0, or -1 with one line in `error` and nothing left behind. */
int results_open(struct results *results, const char *out, const char *scenario_name, const struct scenario *scenario,
                 uint64_t seed, bool log, char *error, size_t error_size);

/* Where the log of a run is to be written: a file in the hidden folder that results_add takes over. In `path`, which is
 * returned; NULL without a log. */
const char *results_log_path(const struct results *results, unsigned run, char path[OUTPUT_PATH_MAX]);

/* Add the next run. Returns 0, or -1 with one line in `error`. */
int results_add(struct results *results, uint64_t seed, const struct scenario *scenario,
                const struct recorder *recorder, char *error, size_t error_size);

/* Write the summary and let everything appear. Frees `results`. Returns 0, or -1 with one line in `error`. */
int results_commit(struct results *results, const char *version, char *error, size_t error_size);

/* Leave nothing behind. Frees `results`; harmless after results_commit. */
void results_discard(struct results *results);

/* Statistics of a metric over the runs added so far, its mean as in summary.json; false if it applies to none. */
struct metric_statistics {
    double mean, sd, median, p95;
    size_t n;
};
bool results_statistics(struct results *results, enum metric metric, struct metric_statistics *statistics);

/* The runs' error metrics pooled over all estimates; NaN where one does not apply. */
void results_pooled(struct results *results, double values[METRIC_ERRORS_COUNT]);

#endif
