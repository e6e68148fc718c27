#include "record/results.h"

#include "record/scenario_json.h"
#include "scenario/text.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Digits of a number in a file: more than any quantity is known to, and the same on every machine. */
#define DIGITS 10

#define SAME_INSTANT_S 1e-6

static void put_number(FILE *file, double value)
{
    if (!isfinite(value)) {
        fputc(',', file);
    } else {
        fprintf(file, ",%.*g", DIGITS, value == 0 ? 0.0 : value); /* no -0 */
    }
}

int results_open(struct results *results, const char *out, const char *scenario_name, const struct scenario *scenario,
                 uint64_t seed, bool log, char *error, size_t error_size)
{
    *results = (struct results){.scenario_name = scenario_name, .scenario = scenario, .seed = seed};
    if (output_open(&results->output, out, error, error_size) != 0) {
        return -1;
    }
    char path[OUTPUT_PATH_MAX];
    results->runs = output_create(&results->output, "runs.csv", error, error_size);
    results->track = results->runs != NULL ? output_create(&results->output, "track.csv", error, error_size) : NULL;
    if (log && results->track != NULL) {
        results->log = lcm_eventlog_create(output_path(&results->output, "events.lcm", path), "w");
        if (results->log == NULL) {
            fail(error, error_size, "%s/events.lcm: cannot write", out);
        }
    }
    if (results->track == NULL || (log && results->log == NULL)) {
        results_discard(results);
        return -1;
    }
    fputs("run,seed", results->runs);
    for (size_t i = 0; i < METRIC_COUNT; i++) {
        fprintf(results->runs, ",%s", metric_names[i]);
    }
    fputc('\n', results->runs);
    fputs(
        "run,target,time_s,x_m,y_m,raw_x_m,raw_y_m,sd_m,true_x_m,true_y_m,vx_mps,vy_mps,cov_xx_m2,cov_xy_m2,cov_yy_m2,"
        "measurements,arrival_time_s,true_at_arrival_x_m,true_at_arrival_y_m,flags,head,sink_x_m,sink_y_m,states,rate,"
        "true_rate,number,mode,members,extent_m,of_0,of_1,of_2,of_3\n",
        results->track);
    return 0;
}

const char *results_log_path(const struct results *results, unsigned run, char path[OUTPUT_PATH_MAX])
{
    char name[40];
    snprintf(name, sizeof name, "events-%u.lcm", run);
    return results->log != NULL ? output_path(&results->output, name, path) : NULL;
}

/* Of a target or a node, which fields are left empty for. */
static double number_of(int32_t id) { return id >= 0 ? id : (double)NAN; }

/* `sink`: what the sink had at that instant, or NULL. */
static void put_track(FILE *file, unsigned run, const motehound_track_t *track, const motehound_track_t *sink)
{
    const bool covariance = track->cov_xx_m2 > 0;
    const double none = (double)NAN;
    fprintf(file, "%u,%lu", run, (unsigned long)(uint32_t)track->target);
    put_number(file, track->time_s);
    put_number(file, track->x_m);
    put_number(file, track->y_m);
    put_number(file, track->raw_x_m);
    put_number(file, track->raw_y_m);
    put_number(file, covariance ? sqrt((track->cov_xx_m2 + track->cov_yy_m2) / 2) : none);
    put_number(file, track->true_known ? track->true_x_m : none);
    put_number(file, track->true_known ? track->true_y_m : none);
    put_number(file, track->vx_mps);
    put_number(file, track->vy_mps);
    put_number(file, covariance ? track->cov_xx_m2 : none);
    put_number(file, covariance ? track->cov_xy_m2 : none);
    put_number(file, covariance ? track->cov_yy_m2 : none);
    put_number(file, track->measurements);
    put_number(file, track->arrival_s);
    put_number(file, track->arrival_known ? track->arrival_x_m : none);
    put_number(file, track->arrival_known ? track->arrival_y_m : none);
    fprintf(file, ",%ld,%lu", (long)track->flags, (unsigned long)(uint32_t)track->head);
    put_number(file, sink != NULL ? sink->x_m : none);
    put_number(file, sink != NULL ? sink->y_m : none);
    fprintf(file, ",%ld", (long)track->states);
    put_number(file, track->rate);
    put_number(file, track->true_known ? track->true_rate : none);
    put_number(file, number_of(track->number));
    fprintf(file, ",%ld,%ld", (long)track->mode, (long)track->members);
    put_number(file, track->members > 1 ? track->extent_m : none);
    for (size_t i = 0; i < sizeof track->of / sizeof track->of[0]; i++) {
        put_number(file, track->of[i] != 0 ? (double)(uint32_t)track->of[i] : none);
    }
    fputc('\n', file);
}

/* What the sink had of a track at its instant, or NULL. Both lists are ordered by time; `from` is where the search begins, and moves on. */
static const motehound_track_t *sink_of(const struct recorder *recorder, const motehound_track_t *track, size_t *from)
{
    const motehound_track_t *sinks = recorder->sinks;
    while (*from < recorder->sink_count && sinks[*from].time_s < track->time_s - SAME_INSTANT_S) {
        (*from)++;
    }
    for (size_t s = *from; s < recorder->sink_count && sinks[s].time_s <= track->time_s + SAME_INSTANT_S; s++) {
        if (sinks[s].target == track->target) {
            return &sinks[s];
        }
    }
    return NULL;
}

static void put_tracks(const struct results *results, const struct recorder *recorder)
{
    size_t from = 0;
    for (size_t i = 0; i < recorder->track_count; i++) {
        const motehound_track_t *track = &recorder->tracks[i];
        put_track(results->track, results->run_count, track, sink_of(recorder, track, &from));
    }
}

/* The file `*file` of all runs, begun with its header when there is first something to put. */
static int begin_file(const struct results *results, FILE **file, const char *name, const char *header, char *error,
                      size_t error_size)
{
    if (*file == NULL) {
        *file = output_create(&results->output, name, error, error_size);
        if (*file == NULL) {
            return -1;
        }
        fputs(header, *file);
    }
    return 0;
}

static int put_locals(struct results *results, const struct recorder *recorder, char *error, size_t error_size)
{
    if (recorder->local_count > 0 &&
        begin_file(results, &results->local, "local.csv",
                   "run,cluster,time_s,x_m,y_m,sd_m,true_x_m,true_y_m,vx_mps,vy_mps,head\n", error, error_size) != 0) {
        return -1;
    }
    for (size_t i = 0; i < recorder->local_count; i++) {
        const motehound_track_t *track = &recorder->locals[i].track;
        const double none = (double)NAN;
        fprintf(results->local, "%u,%ld", results->run_count, (long)recorder->locals[i].cluster);
        put_number(results->local, track->time_s);
        put_number(results->local, track->x_m);
        put_number(results->local, track->y_m);
        put_number(results->local, sqrt((track->cov_xx_m2 + track->cov_yy_m2) / 2));
        put_number(results->local, track->true_known ? track->true_x_m : none);
        put_number(results->local, track->true_known ? track->true_y_m : none);
        put_number(results->local, track->vx_mps);
        put_number(results->local, track->vy_mps);
        fprintf(results->local, ",%lu\n", (unsigned long)(uint32_t)track->head);
    }
    return 0;
}

static int put_watches(struct results *results, const struct recorder *recorder, char *error, size_t error_size)
{
    if (recorder->watch_count > 0 &&
        begin_file(results, &results->watch, "watch.csv",
                   "run,time_s,target,number,head,prince,prince_s,x_m,y_m,vx_mps,vy_mps,sd_m,extent_m,members\n", error,
                   error_size) != 0) {
        return -1;
    }
    for (size_t i = 0; i < recorder->watch_count; i++) {
        const motehound_watch_t *watch = &recorder->watches[i];
        const double none = (double)NAN;
        const bool moves = watch->vx_mps != 0 || watch->vy_mps != 0;
        fprintf(results->watch, "%u", results->run_count);
        put_number(results->watch, watch->time_s);
        fprintf(results->watch, ",%lu", (unsigned long)(uint32_t)watch->target);
        put_number(results->watch, number_of(watch->number));
        fprintf(results->watch, ",%lu", (unsigned long)(uint32_t)watch->head);
        put_number(results->watch, number_of(watch->prince));
        put_number(results->watch, watch->prince >= 0 ? watch->prince_s : none);
        put_number(results->watch, watch->x_m);
        put_number(results->watch, watch->y_m);
        put_number(results->watch, moves ? watch->vx_mps : none);
        put_number(results->watch, moves ? watch->vy_mps : none);
        put_number(results->watch, watch->sd_m);
        put_number(results->watch, watch->members > 1 ? watch->extent_m : none);
        fprintf(results->watch, ",%ld\n", (long)watch->members);
    }
    return 0;
}

static int put_truths(struct results *results, const struct scenario *scenario, const struct recorder *recorder,
                      char *error, size_t error_size)
{
    if (recorder->targets < 2 && scenario->sensor.quantity != QUANTITY_SOUND) { /* beside its estimates is enough */
        return 0;
    }
    if (begin_file(results, &results->truth, "truth.csv", "run,time_s,target,x_m,y_m,vx_mps,vy_mps\n", error,
                   error_size) != 0) {
        return -1;
    }
    for (size_t i = 0; i < recorder->truth_count; i++) {
        const motehound_truth_t *truth = &recorder->truths[i];
        fprintf(results->truth, "%u", results->run_count);
        put_number(results->truth, truth->time_s);
        fprintf(results->truth, ",%ld", (long)truth->target);
        put_number(results->truth, truth->x_m);
        put_number(results->truth, truth->y_m);
        put_number(results->truth, truth->vx_mps);
        put_number(results->truth, truth->vy_mps);
        fputc('\n', results->truth);
    }
    return 0;
}

/* The first run's motes, in the format that network.file and a replay read. */
static int put_nodes(const struct results *results, const struct recorder *recorder, char *error, size_t error_size)
{
    FILE *file = output_create(&results->output, "nodes.csv", error, error_size);
    if (file == NULL) {
        return -1;
    }
    fputs("node,x_m,y_m,z_m\n", file);
    for (size_t i = 0; i < recorder->node_count; i++) {
        const motehound_node_t *node = &recorder->nodes[i];
        fprintf(file, "%lu", (unsigned long)(uint32_t)node->node);
        put_number(file, node->x_m);
        put_number(file, node->y_m);
        put_number(file, node->z_m);
        fputc('\n', file);
    }
    return output_finish(file, "nodes.csv", error, error_size);
}

/* Append the run's own log to the log of all, later than all before, and remove it. */
static int take_log(struct results *results, char *error, size_t error_size)
{
    char path[OUTPUT_PATH_MAX];
    lcm_eventlog_t *log = lcm_eventlog_create(results_log_path(results, results->run_count, path), "r");
    if (log == NULL) {
        return fail(error, error_size, "events.lcm: the log of run %u cannot be read", results->run_count);
    }
    int64_t last = results->log_offset_us;
    int status = 0;
    for (lcm_eventlog_event_t *event; status == 0 && (event = lcm_eventlog_read_next_event(log)) != NULL;) {
        last = event->timestamp += results->log_offset_us;
        status = lcm_eventlog_write_event(results->log, event);
        lcm_eventlog_free_event(event);
    }
    lcm_eventlog_destroy(log);
    unlink(path);
    results->log_offset_us = last;
    return status == 0 ? 0 : fail(error, error_size, "events.lcm: cannot write run %u", results->run_count);
}

int results_add(struct results *results, uint64_t seed, const struct scenario *scenario,
                const struct recorder *recorder, char *error, size_t error_size)
{
    struct errors errors = {0};
    double values[METRIC_COUNT];
    bool memory = errors_of(recorder, scenario, &errors) == 0 && errors_append(&results->pooled, &errors) == 0;
    metrics_of_run(recorder, scenario, &errors, values);
    errors_free(&errors);
    fprintf(results->runs, "%u,%llu", results->run_count, (unsigned long long)seed);
    for (size_t i = 0; i < METRIC_COUNT; i++) {
        put_number(results->runs, values[i]);
        memory = memory && (isnan(values[i]) || samples_add(&results->metrics[i], values[i]) == 0);
    }
    fputc('\n', results->runs);
    put_tracks(results, recorder);
    results->last = recorder->track_count > 0 ? recorder->tracks[recorder->track_count - 1] : (motehound_track_t){0};
    if (!memory) {
        return fail(error, error_size, "run %u: no memory", results->run_count);
    }
    if (put_locals(results, recorder, error, error_size) != 0 ||
        put_watches(results, recorder, error, error_size) != 0 ||
        put_truths(results, scenario, recorder, error, error_size) != 0 ||
        (results->run_count == 0 && put_nodes(results, recorder, error, error_size) != 0) ||
        (results->log != NULL && take_log(results, error, error_size) != 0)) {
        return -1;
    }
    results->run_count++;
    return 0;
}

bool results_statistics(struct results *results, enum metric metric, struct metric_statistics *statistics)
{
    struct samples *samples = &results->metrics[metric];
    double pooled[METRIC_ERRORS_COUNT];
    const bool over_runs = metric_is_over_runs(metric);
    if (over_runs) {
        results_pooled(results, pooled);
    }
    *statistics = (struct metric_statistics){
        .mean = over_runs ? pooled[metric] : samples_mean(samples),
        .sd = samples_sd(samples),
        .median = samples_quantile(samples, 0.5),
        .p95 = samples_quantile(samples, 0.95),
        .n = samples->count,
    };
    return samples->count > 0;
}

void results_pooled(struct results *results, double values[METRIC_ERRORS_COUNT])
{
    metrics_of_errors(&results->pooled, values);
}

/* JSON has no infinity. */
static json_t *number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

static json_t *board_summary(const struct board_result *board)
{
    const double mean = board->events > 0 ? (double)board->cycles / (double)board->events : 0;
    json_t *object = json_pack("{s:I, s:s, s:s, s:s, s:I, s:f, s:I, s:f, s:I, s:I, s:I, s:I}", "node",
                               (json_int_t)board->node, "board", board->board, "image", board->image, "arithmetic",
                               board->fixed ? "fixed" : "float", "events", (json_int_t)board->events, "cycles_mean",
                               mean, "cycles_max", (json_int_t)board->cycles_max, "rate_hz", board->rate_hz, "late",
                               (json_int_t)board->missed, "overlapped", (json_int_t)board->overlapped, "reports_max",
                               (json_int_t)board->reports_max, "neighbours_max", (json_int_t)board->neighbours_max);
    if (object && step_cycles_number(&board->steps) > 0) {
        json_object_set_new(object, "steps",
                            json_pack("{s:I, s:f, s:f, s:I}", "n", (json_int_t)step_cycles_number(&board->steps),
                                      "cycles_median", step_cycles_quantile(&board->steps, 0.5), "cycles_p95",
                                      step_cycles_quantile(&board->steps, 0.95), "cycles_max",
                                      (json_int_t)board->steps.longest));
    }
    if (object && board->ram > 0) {
        json_object_update_new(object,
                               json_pack("{s:I, s:I, s:I, s:I}", "ram_b", (json_int_t)board->ram, "ram_static_b",
                                         (json_int_t)board->variables, "stack_b", (json_int_t)board->stack,
                                         "ram_free_b", (json_int_t)board_ram_free(board)));
    }
    return object;
}

static json_t *summary(struct results *results, const char *version)
{
    json_t *metrics = json_object(), *pooled = json_object();
    double values[METRIC_ERRORS_COUNT];
    int status = metrics == NULL || pooled == NULL;
    for (size_t i = 0; i < METRIC_COUNT; i++) {
        struct metric_statistics s;
        if (results_statistics(results, (enum metric)i, &s)) {
            status |=
                json_object_set_new(metrics, metric_names[i],
                                    json_pack("{s:o, s:o, s:o, s:o, s:I}", "mean", number(s.mean), "std", number(s.sd),
                                              "median", number(s.median), "p95", number(s.p95), "n", (json_int_t)s.n));
        }
    }
    results_pooled(results, values);
    for (size_t i = 0; i < METRIC_ERRORS_COUNT; i++) {
        if (!isnan(values[i])) {
            status |= json_object_set_new(pooled, metric_names[i], number(values[i]));
        }
    }
    json_t *whole = json_pack("{s:s, s:I, s:I, s:s, s:o, s:o}", "scenario", results->scenario_name, "seed",
                              (json_int_t)results->seed, "runs", (json_int_t)results->run_count, "version", version,
                              "metrics", metrics, "pooled", pooled);
    if (results->boards.count > 0) {
        json_t *boards = json_array();
        for (size_t i = 0; i < results->boards.count; i++) {
            status |= json_array_append_new(boards, board_summary(&results->boards.list[i]));
        }
        status |= json_object_set_new(whole, "boards", boards);
    }
    if (status != 0) {
        json_decref(whole);
        return NULL;
    }
    return whole;
}

/* Write `whole`, which is released, as a file of the folder. */
static int put_json(struct results *results, const char *name, json_t *whole, char *error, size_t error_size)
{
    if (whole == NULL) {
        return fail(error, error_size, "%s: no memory, or a text that is not UTF-8", name);
    }
    FILE *file = output_create(&results->output, name, error, error_size);
    if (file == NULL) {
        json_decref(whole);
        return -1;
    }
    json_dumpf(whole, file, JSON_INDENT(2) | JSON_REAL_PRECISION(DIGITS));
    fputc('\n', file);
    json_decref(whole);
    return output_finish(file, name, error, error_size);
}

int results_commit(struct results *results, const char *version, char *error, size_t error_size)
{
    const char *names[9] = {"runs.csv", "track.csv", "nodes.csv", "summary.json"};
    size_t count = 4;
    const bool logged = results->log != NULL;
    bool sound = put_json(results, "summary.json", summary(results, version), error, error_size) == 0 &&
                 output_sync(results->runs, "runs.csv", error, error_size) == 0 &&
                 output_sync(results->track, "track.csv", error, error_size) == 0;
    if (sound && results->scenario != NULL) {
        names[count++] = "scenario.json";
        sound = put_json(results, "scenario.json", scenario_json(results->scenario), error, error_size) == 0;
    }
    const struct {
        FILE *file;
        const char *name;
    } further[] = {{results->local, "local.csv"}, {results->watch, "watch.csv"}, {results->truth, "truth.csv"}};
    for (size_t i = 0; sound && i < sizeof further / sizeof further[0]; i++) {
        if (further[i].file != NULL) {
            names[count++] = further[i].name;
            sound = output_sync(further[i].file, further[i].name, error, error_size) == 0;
        }
    }
    if (sound && logged) {
        names[count++] = "events.lcm";
        sound = output_sync(results->log->f, "events.lcm", error, error_size) == 0;
    }
    if (sound) {
        sound = output_commit(&results->output, names, count, error, error_size) == 0;
    }
    results_discard(results);
    return sound ? 0 : -1;
}

void results_discard(struct results *results)
{
    FILE *const files[] = {results->runs, results->track, results->local, results->watch, results->truth};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        if (files[i] != NULL) {
            fclose(files[i]);
        }
    }
    if (results->log != NULL) {
        lcm_eventlog_destroy(results->log);
    }
    for (size_t i = 0; i < METRIC_COUNT; i++) {
        samples_free(&results->metrics[i]);
    }
    errors_free(&results->pooled);
    output_discard(&results->output);
    *results = (struct results){0};
}
