/* motehound bench: what simulating costs on this machine. */
#include "cli/command.h"
#include "cli/options.h"
#include "engine/event_queue.h"
#include "engine/random.h"
#include "scenario/folder.h"
#include "scenario/text.h"
#include "trackers.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char help[] =
    "motehound bench NAME [--nodes N] [--seed S]\n"
    "\n"
    "Runs a benchmark and prints one line of JSON. NAME is\n"
    "  queue            the event queue alone: N pending events (default 1,000,000); each that is taken is put back "
    "an\n"
    "                   exponentially distributed time later\n"
    "  s1               scenario bench_s1 with N motes (default 1,000): all broadcast\n"
    "  s2               scenario bench_s2 with N motes (default 1,000): reports travel over many hops\n"
    "  --nodes N        4 to 1,000,000\n"
    "  --seed S         default 0\n"
    "  --help           this text\n"
    "\n"
    "cpu_s is the processor time of the whole run, with setting up. bytes_per_mote is what the run took at its peak\n"
    "beyond the memory of a tiny one, by the mote, without the state of the mote's own firmware.\n";

enum { NODES_MIN = 4 };

struct bench {
    const char *name;
    uint64_t nodes, seed;
    double cpu_s;
    uint64_t events;
};

static double cpu_seconds(void)
{
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Not getrusage's: that begins with the memory of the process that has started this one. 0 where there is no such file. */
static double peak_bytes(void)
{
    static const char key[] = "VmHWM:";
    char line[200];
    double bytes = 0;
    FILE *file = fopen("/proc/self/status", "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, key, sizeof key - 1) == 0) {
            bytes = 1024 * strtod(line + sizeof key - 1, NULL);
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return bytes;
}

static double rounded(double value, double unit) { return round(value / unit) * unit; }

/* Takes `more`. Returns a command's exit status. */
static int put_line(struct command *command, const struct bench *bench, json_t *more)
{
    json_t *line = json_pack("{s:s, s:I, s:f, s:I, s:I}", "name", bench->name, "n", (json_int_t)bench->nodes, "cpu_s",
                             rounded(bench->cpu_s, 1e-4), "events", (json_int_t)bench->events, "events_per_s",
                             (json_int_t)((double)bench->events / bench->cpu_s));
    json_t *last = json_pack("{s:I, s:s}", "peak_rss", (json_int_t)peak_bytes(), "version", MOTEHOUND_VERSION);
    char *text = NULL;
    if (json_object_update(line, more) == 0 && json_object_update(line, last) == 0) {
        text = json_dumps(line, JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(9));
    }
    json_decref(line);
    json_decref(more);
    json_decref(last);
    if (text == NULL) {
        fail(command->error, COMMAND_ERROR_SIZE, "motehound bench: out of memory");
        return 1;
    }
    puts(text);
    free(text);
    return 0;
}

/* The hold model (Vaucher and Duval, "A comparison of simulation event list algorithms", Communications of the ACM 18, 1975). */
static int bench_queue(struct command *command, struct bench *bench)
{
    enum { DELAYS = 65536, TAKEN = 10000000 };
    static sim_time delays[DELAYS]; /* drawn beforehand: to draw them is not the queue's work */
    const struct random_stream stream = random_stream(bench->seed, RANDOM_TRAFFIC);
    for (uint64_t i = 0; i < DELAYS; i++) {
        delays[i] = (sim_time)(-(double)SIM_TIME_PER_S * log1p(-random_uniform(stream, i)));
    }
    struct event_queue queue = {0};
    struct event event = {0};
    int status = 0;
    for (uint64_t i = 0; i < bench->nodes && status == 0; i++) {
        status = event_queue_push(&queue, delays[random_bits(stream, DELAYS + i) % DELAYS], (uint32_t)i);
    }
    double began_s = 0;
    for (uint64_t i = 0; i < bench->nodes + TAKEN && status == 0; i++) {
        if (i == bench->nodes) { /* each pending event has been put back once */
            began_s = cpu_seconds();
        }
        event_queue_pop(&queue, &event);
        status = event_queue_push(&queue, event.time + delays[5 * i % DELAYS], event.content);
    }
    bench->cpu_s = cpu_seconds() - began_s;
    bench->events = TAKEN;
    event_queue_free(&queue);
    if (status != 0) {
        fail(command->error, COMMAND_ERROR_SIZE, "motehound bench: out of memory for %llu events",
             (unsigned long long)bench->nodes);
        return 1;
    }
    return put_line(command, bench, json_object());
}

/* The scenario's network with another number of motes: as many rows as columns, the sink in the middle. */
static int resize(struct scenario *scenario, uint64_t nodes, char *error)
{
    const double side_m = scenario->network.spacing_m * ceil(sqrt((double)nodes));
    scenario->network.nodes = (int64_t)nodes;
    scenario->field.width_m = scenario->field.height_m = side_m;
    scenario->network.sink_x_m = scenario->network.sink_y_m = side_m / 2;
    return scenario_check(scenario, scenario->name, error, COMMAND_ERROR_SIZE);
}

/* Bytes that a mote itself needs. */
static int firmware_bytes(const struct scenario *scenario, double *bytes, char *error)
{
    struct protocol_choice protocol;
    if (protocol_choose(scenario->network.protocol, scenario, &protocol, error, COMMAND_ERROR_SIZE) != 0) {
        return -1;
    }
    *bytes = (double)(sizeof(struct mh_mote) + sizeof(struct mh_mote_config) + protocol.protocol->state_size);
    return 0;
}

static int run(struct command *command, struct bench *bench, struct scenario *scenario)
{
    static const struct observer nobody;
    struct simulation_counters counters;
    double firmware;
    if (firmware_bytes(scenario, &firmware, command->error) != 0) {
        return 1;
    }
    double memory_before = 0, began_s = 0;
    for (int pass = 0; pass < 2; pass++) { /* a tiny run first, so that the program itself is in memory */
        if (resize(scenario, pass == 0 ? NODES_MIN : bench->nodes, command->error) != 0) {
            return 1;
        }
        memory_before = peak_bytes();
        began_s = cpu_seconds();
        if (simulation_run(scenario, bench->seed, &nobody, command->stop, &counters, command->error,
                           COMMAND_ERROR_SIZE) != 0) {
            return 1;
        }
    }
    bench->cpu_s = cpu_seconds() - began_s;
    bench->events = counters.events;
    uint64_t sent = 0;
    for (int kind = 0; kind < MH_MESSAGE_KINDS; kind++) {
        sent += counters.frames_sent[kind];
    }
    const double host_bytes = (peak_bytes() - memory_before) / (double)bench->nodes - firmware;
    return put_line(command, bench,
                    json_pack("{s:I, s:I, s:f, s:I}", "transmissions", (json_int_t)sent, "receptions",
                              (json_int_t)counters.frames_received, "us_per_transmission",
                              rounded(1e6 * bench->cpu_s / (double)sent, 1e-3), "bytes_per_mote",
                              (json_int_t)host_bytes));
}

static int bench_scenario(struct command *command, struct bench *bench, const char *name)
{
    char path[SCENARIO_PATH_MAX];
    struct scenario scenario;
    int status = 1;
    if (scenario_find(name, path, command->error, COMMAND_ERROR_SIZE) != 0) {
        return 1;
    }
    if (scenario_init(&scenario) == 0 && scenario_load(path, &scenario, command->error, COMMAND_ERROR_SIZE) == 0) {
        status = run(command, bench, &scenario);
    }
    scenario_free(&scenario);
    return status;
}

int command_bench(struct command *command)
{
    enum { NODES, SEED, HELP, RULES };
    static const struct option_rule rules[RULES] = {
        [NODES] = {"--nodes", true, false}, [SEED] = {"--seed", true, false}, [HELP] = {"--help", false, false}};
    struct option_reader reader = {.argc = command->argc, .argv = command->argv, .rules = rules, .rule_count = RULES};
    struct bench bench = {.name = ""};
    char *error = command->error;
    size_t rule = 0;
    const char *value = NULL;
    int status = 0;
    for (enum option_kind kind;
         status == 0 && (kind = option_next(&reader, &rule, &value, error, COMMAND_ERROR_SIZE)) != OPTION_END;) {
        if (kind == OPTION_ERROR) {
            return 1;
        }
        if (kind == OPTION_OPERAND && bench.name[0] != '\0') {
            status =
                fail(error, COMMAND_ERROR_SIZE, "motehound bench: expected one benchmark, found '%.100s' too", value);
        } else if (kind == OPTION_OPERAND) {
            bench.name = value;
        } else if (rule == NODES) {
            status = option_count("--nodes", value, NODES_MIN, 1000000, &bench.nodes, error, COMMAND_ERROR_SIZE);
        } else if (rule == SEED) {
            status = option_count("--seed", value, 0, INT64_MAX - 1000000, &bench.seed, error, COMMAND_ERROR_SIZE);
        } else {
            fputs(help, stdout);
            return 0;
        }
    }
    if (status != 0) {
        return 1;
    }
    const bool is_queue = strcmp(bench.name, "queue") == 0;
    bench.nodes = bench.nodes != 0 ? bench.nodes : is_queue ? 1000000 : 1000;
    if (is_queue) {
        return bench_queue(command, &bench);
    }
    if (strcmp(bench.name, "s1") == 0) {
        return bench_scenario(command, &bench, "bench_s1");
    }
    if (strcmp(bench.name, "s2") == 0) {
        return bench_scenario(command, &bench, "bench_s2");
    }
    fail(error, COMMAND_ERROR_SIZE, "motehound bench: expected queue, s1 or s2, found '%.100s'", bench.name);
    return 1;
}
