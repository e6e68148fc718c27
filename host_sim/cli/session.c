#include "cli/command.h"

#include "bus/bus.h"
#include "cli/progress.h"
#include "cli/workers.h"
#include "scenario/text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

int command_set(struct command *command, struct scenario *scenario, const char *assignment)
{
    const char *equals = strchr(assignment, '=');
    char key[200], reason[1000];
    if (equals == NULL || (size_t)(equals - assignment) >= sizeof key) {
        return fail(command->error, sizeof command->error, "--set %.60s: expected key=value", assignment);
    }
    snprintf(key, sizeof key, "%.*s", (int)(equals - assignment), assignment);
    if (scenario_set(scenario, key, equals + 1, reason, sizeof reason) != 0) {
        return fail(command->error, sizeof command->error, "--set %s", reason);
    }
    return 0;
}

const char *command_folder(const char *folder, const char *name, char path[OUTPUT_PATH_MAX])
{
    const bool is_name = name[0] != '\0' && strcmp(name, ".") != 0 && strcmp(name, "..") != 0;
    const int before = snprintf(path, OUTPUT_PATH_MAX, "%.3400s/%s", folder, is_name ? "" : "_");
    snprintf(path + before, (size_t)(OUTPUT_PATH_MAX - before), "%.200s", name);
    for (char *c = path + before; *c != '\0'; c++) {
        *c = *c == '/' || iscntrl((unsigned char)*c) ? '_' : *c;
    }
    return path;
}

static void put_cell(double value)
{
    if (isnan(value)) {
        printf(" %10s", "-");
    } else {
        printf(" %10.4g", value);
    }
}

/* What a single run makes of a leak: where it is, which of the candidates that is, and what it releases. */
static void put_leak(const struct session *session, const struct results *results)
{
    const motehound_track_t *last = &results->last;
    const struct recording *recording = session->batch.recording;
    if (results->run_count != 1 || !(last->rate > 0)) {
        return;
    }
    printf("leak at x %.1f m, y %.1f m", last->x_m, last->y_m);
    if (recording != NULL && recording->candidate_count > 0) {
        const struct recorded_place *nearest = recording->candidates;
        for (size_t i = 1; i < recording->candidate_count; i++) {
            const struct recorded_place *place = &recording->candidates[i];
            if (hypot(place->x_m - last->x_m, place->y_m - last->y_m) <
                hypot(nearest->x_m - last->x_m, nearest->y_m - last->y_m)) {
                nearest = place;
            }
        }
        printf(" (place %lu)", (unsigned long)nearest->id);
    }
    printf(", releases %.4g mL/s", last->rate);
    if (last->true_known && last->true_rate > 0) {
        printf("; true: x %.1f m, y %.1f m, %.4g mL/s", last->true_x_m, last->true_y_m, last->true_rate);
    }
    putchar('\n');
}

static void put_table(const struct session *session, struct results *results)
{
    static const enum metric shown[] = {METRIC_POSITION_RMSE_M,
                                        METRIC_POSITION_MEDIAN_M,
                                        METRIC_POSITION_P95_M,
                                        METRIC_RAW_POSITION_RMSE_M,
                                        METRIC_POSITION_RMSE_AT_ARRIVAL_M,
                                        METRIC_NEES_MEDIAN,
                                        METRIC_RATE_RATIO,
                                        METRIC_TRACKED_SHARE,
                                        METRIC_TRACK_LOST,
                                        METRIC_ESTIMATES,
                                        METRIC_LOCALISATION_ERROR_RS,
                                        METRIC_SINK_ERROR_RS,
                                        METRIC_RMSE_OVER_PCRB,
                                        METRIC_LONGEST_GAP_S,
                                        METRIC_SUCCESS_50M,
                                        METRIC_CONVERGED_WRONG,
                                        METRIC_POSITION_ERROR_MEDIAN_M,
                                        METRIC_RATE_ERROR_MEDIAN,
                                        METRIC_ERROR_OVER_CRLB,
                                        METRIC_HOPS,
                                        METRIC_SENSORS_TO_10M,
                                        METRIC_ANEES,
                                        METRIC_SMSE_M,
                                        METRIC_LOCAL_POSITION_RMSE_M_1,
                                        METRIC_LOCAL_POSITION_RMSE_M_2,
                                        METRIC_LOCAL_POSITION_RMSE_M_3,
                                        METRIC_LOCAL_POSITION_RMSE_M_4,
                                        METRIC_CLUSTERS,
                                        METRIC_RECOVERIES,
                                        METRIC_REPORTS_PER_SAMPLE,
                                        METRIC_FRAMES_SENT,
                                        METRIC_DELIVERY_SHARE,
                                        METRIC_ENERGY_MJ,
                                        METRIC_LIFETIME_S};
    double pooled[METRIC_ERRORS_COUNT];
    results_pooled(results, pooled);
    const struct scenario *scenario = session->batch.scenario;
    printf("%s, tracker %s, %u run%s from seed %llu\n", scenario->name, scenario->tracker.name, results->run_count,
           results->run_count == 1 ? "" : "s", (unsigned long long)results->seed);
    printf("%-28s %10s %10s %10s %10s %10s\n", "", "mean", "std", "median", "p95", "pooled");
    for (size_t i = 0; i < sizeof shown / sizeof shown[0]; i++) {
        struct metric_statistics s;
        if (results_statistics(results, shown[i], &s)) {
            printf("%-28s", metric_names[shown[i]]);
            put_cell(s.mean);
            put_cell(s.sd);
            put_cell(s.median);
            put_cell(s.p95);
            put_cell((size_t)shown[i] < METRIC_ERRORS_COUNT ? pooled[shown[i]] : (double)NAN);
            putchar('\n');
        }
    }
}

static void put_boards(const struct results *results)
{
    for (size_t i = 0; i < results->boards.count; i++) {
        const struct board_result *board = &results->boards.list[i];
        const double mean = board->events > 0 ? (double)board->cycles / (double)board->events : 0;
        printf("node %lu on %s: %llu events, %.3g ms in the mean, %.3g ms at most; %llu late, %llu overlapped",
               (unsigned long)board->node, board->board, (unsigned long long)board->events, 1e3 * mean / board->rate_hz,
               1e3 * (double)board->cycles_max / board->rate_hz, (unsigned long long)board->missed,
               (unsigned long long)board->overlapped);
        if (step_cycles_number(&board->steps) > 0) {
            printf("; steps %.3g ms in the median, 95 %% within %.3g ms, %.3g ms at most",
                   1e3 * step_cycles_quantile(&board->steps, 0.5) / board->rate_hz,
                   1e3 * step_cycles_quantile(&board->steps, 0.95) / board->rate_hz,
                   1e3 * (double)board->steps.longest / board->rate_hz);
        }
        if (board->ram > 0) {
            printf("; %lu of %lu bytes of RAM never used", (unsigned long)board_ram_free(board),
                   (unsigned long)board->ram);
        }
        putchar('\n');
    }
}

static int execute(struct session *session, struct results *results, char *error)
{
    struct progress progress;
    progress_begin(&progress);
    session->batch.progress = progress_show;
    session->batch.progress_context = &progress;
    const int status = batch_execute(&session->batch, results, error, COMMAND_ERROR_SIZE);
    progress_end(&progress);
    return status;
}

static int open_boards(void *context, struct host *host, uint32_t count, const uint32_t *order,
                       const struct mh_protocol *protocol, uint64_t seed)
{
    const struct session *session = context;
    (void)seed;
    return host_boards(host, count, order, protocol, session->emulation.images);
}

static int execute_with_boards(struct session *session, struct results *results, char *error)
{
    const struct host_provider provider = {session, open_boards, &session->emulation, &results->boards};
    session->batch.hosts = &provider;
    return execute(session, results, error);
}

static int execute_on_workers(struct session *session, struct results *results, char *error)
{
    const struct worker_pool_config config = {.url = session->bus_url,
                                              .version = session->batch.version,
                                              .program = "/proc/self/exe",
                                              .images = session->emulation.images,
                                              .local = session->workers,
                                              .joining = session->joining,
                                              .mixed = session->mixed,
                                              .respawn = session->respawn,
                                              .drop_share = session->drop_share,
                                              .stop = session->batch.stop};
    struct workers workers;
    if (workers_open(&workers, &config, session->batch.scenario, error, COMMAND_ERROR_SIZE) != 0) {
        return -1;
    }
    workers.provider.emulation = &session->emulation;
    workers.provider.boards = &results->boards;
    session->batch.hosts = &workers.provider;
    const int status = execute(session, results, error);
    if (status == 0) {
        workers_report(&workers);
    }
    workers_close(&workers);
    return status;
}

int session_execute(struct command *command, struct session *session)
{
    char *error = command->error;
    struct results results;
    const struct scenario *simulated = session->batch.recording == NULL ? session->batch.scenario : NULL;
    if (results_open(&results, session->out, session->batch.scenario->name, simulated, session->batch.seed,
                     session->log, error, COMMAND_ERROR_SIZE) != 0) {
        return 1;
    }
    int status = bus_outside(session->bus_url, &session->batch.outside, error, COMMAND_ERROR_SIZE);
    if (status == 0) {
        status = session->workers + session->joining > 0 ? execute_on_workers(session, &results, error)
                 : session->emulation.count > 0          ? execute_with_boards(session, &results, error)
                                                         : execute(session, &results, error);
    }
    if (session->batch.outside != NULL) {
        lcm_destroy(session->batch.outside);
    }
    if (*command->stop != 0) {
        results_discard(&results);
        fail(error, COMMAND_ERROR_SIZE, "motehound: interrupted, nothing was written to %.4000s", session->out);
        return 1;
    }
    if (status != 0) {
        results_discard(&results);
        return 1;
    }
    put_table(session, &results);
    put_leak(session, &results);
    put_boards(&results);
    if (results_commit(&results, session->batch.version, error, COMMAND_ERROR_SIZE) != 0) {
        return 1;
    }
    printf("in %s\n", session->out);
    return 0;
}
