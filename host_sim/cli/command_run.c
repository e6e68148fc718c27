/* motehound run: simulate a scenario. */
#include "cli/command.h"
#include "cli/options.h"
#include "scenario/folder.h"
#include "scenario/keys.h"
#include "scenario/text.h"

#include <stdio.h>
#include <string.h>

static const char help[] =
    "motehound run SCENARIO [--set key=value]... [--runs N] [--seed S] [--jobs J] [--out DIR] [--bus URL] [--log] "
    "[--sweep]\n"
    "              [--pace X] [--workers N] [--join N] [--mixed] [--respawn] [--emulate NODE=BOARD[,NODE=BOARD]...] "
    "[--images "
    "DIR]\n"
    "\n"
    "Simulates a network of motes. SCENARIO is a YAML file or a name of `motehound list`.\n"
    "  --set key=value  change any key of the scenario (`motehound list --keys`); may be repeated\n"
    "  --runs N         so many runs, each with its own deployment and noise; default 1\n"
    "  --seed S         run r has seed S + r; default 0. The same seeds give the same bytes\n"
    "  --jobs J         runs at the same time; default 1. Changes no byte of the results\n"
    "  --out DIR        folder for the results; default out/NAME\n"
    "  --bus URL        publish everything on this LCM bus too, such as udpm://239.255.76.67:7667?ttl=0;\n"
    "                   default memq://, which stays within the process\n"
    "  --pace X         with --bus: X seconds of the run a second, to look on (docs/view.md); default as fast as can "
    "be\n"
    "  --log            also write events.lcm, all that went over the bus, for lcm-logplayer\n"
    "  --sweep          do all runs for each value of the scenario's `sweep`, into DIR/VALUE\n"
    "  --workers N      let the motes live in N other processes of this machine, over --bus URL\n"
    "  --join N         wait for N workers more, started elsewhere with `motehound worker --bus URL`\n"
    "  --mixed          workers may be of either arithmetic: some motes in floating point, others in fixed point\n"
    "  --respawn        replace a worker that dies (it repeats all that was done), instead of ending the run\n"
    "  --emulate NODE=BOARD[,NODE=BOARD]...\n"
    "                   let these motes live on emulated boards, with the images that are made for them: atmega128,\n"
    "                   cortex-m0, cortex-m3, cortex-m4f, cortex-m33, riscv32 or host; with -fixed behind it the image "
    "in\n"
    "                   fixed point (docs/emulation.md)\n"
    "  --images DIR     folder of the images, DIR/BOARD/IMAGE; default $MOTEHOUND_IMAGES, or else that of "
    "tools/images\n"
    "  --drop-share P   for tests: drop this share of the messages to and from the workers\n"
    "  --help           this text\n"
    "\n"
    "The results do not depend on where the motes live (docs/workers.md).\n"
    "DIR gets summary.json, runs.csv, track.csv, nodes.csv and scenario.json, of targets that are heard truth.csv,\n"
    "of the protocol `prince` watch.csv, of fixed clusters local.csv; whole, or after an error or an interrupt not\n"
    "at all (with --sweep: each DIR/VALUE).\n";

struct run_options {
    const char *scenario, *out, *bus_url;
    uint64_t runs, seed, jobs, workers, joining;
    double drop_share, pace;
    bool log, sweep, mixed, respawn, help;
    const char *images;
    struct emulation emulation;
};

enum {
    SET,
    RUNS,
    SEED,
    JOBS,
    OUT,
    BUS,
    LOG,
    SWEEP,
    PACE,
    WORKERS,
    JOIN,
    MIXED,
    RESPAWN,
    EMULATE,
    IMAGES,
    DROP_SHARE,
    HELP,
    RULES
};

static const struct option_rule rules[RULES] = {
    [SET] = {"--set", true, true},
    [RUNS] = {"--runs", true, false},
    [SEED] = {"--seed", true, false},
    [JOBS] = {"--jobs", true, false},
    [OUT] = {"--out", true, false},
    [BUS] = {"--bus", true, false},
    [LOG] = {"--log", false, false},
    [SWEEP] = {"--sweep", false, false},
    [WORKERS] = {"--workers", true, false},
    [JOIN] = {"--join", true, false},
    [MIXED] = {"--mixed", false, false},
    [RESPAWN] = {"--respawn", false, false},
    [DROP_SHARE] = {"--drop-share", true, false},
    [PACE] = {"--pace", true, false},
    [HELP] = {"--help", false, false},
    [EMULATE] = {"--emulate", true, true},
    [IMAGES] = {"--images", true, false},
};

static int option_pace(const char *value, double *pace, char *error)
{
    if (!text_number(value, strlen(value), pace) || *pace < 1e-3 || *pace > 1e6) {
        return fail(error, COMMAND_ERROR_SIZE, "--pace: expected a number 0.001 to 1000000, found '%.60s'", value);
    }
    return 0;
}

/* All options but --set, whose values wait until the file has been read. */
static int read_options(struct command *command, struct run_options *options)
{
    struct option_reader reader = {.argc = command->argc, .argv = command->argv, .rules = rules, .rule_count = RULES};
    char *error = command->error;
    size_t rule = 0;
    const char *value = NULL;
    *options = (struct run_options){.bus_url = "memq://", .runs = 1, .jobs = 1};
    for (enum option_kind kind;
         (kind = option_next(&reader, &rule, &value, error, COMMAND_ERROR_SIZE)) != OPTION_END;) {
        int status = 0;
        if (kind == OPTION_ERROR) {
            return -1;
        }
        if (kind == OPTION_OPERAND) {
            if (options->scenario != NULL) {
                return fail(error, COMMAND_ERROR_SIZE, "motehound run: expected one scenario, found '%.100s' too",
                            value);
            }
            options->scenario = value;
            continue;
        }
        switch (rule) {
        case RUNS:
            status = option_count("--runs", value, 1, 1000000, &options->runs, error, COMMAND_ERROR_SIZE);
            break;
        case SEED:
            status = option_count("--seed", value, 0, INT64_MAX - 1000000, &options->seed, error, COMMAND_ERROR_SIZE);
            break;
        case JOBS:
            status = option_count("--jobs", value, 1, 1024, &options->jobs, error, COMMAND_ERROR_SIZE);
            break;
        case OUT:
            options->out = value;
            break;
        case BUS:
            options->bus_url = value;
            break;
        case LOG:
            options->log = true;
            break;
        case SWEEP:
            options->sweep = true;
            break;
        case PACE:
            status = option_pace(value, &options->pace, error);
            break;
        case WORKERS:
            status = option_count("--workers", value, 1, 64, &options->workers, error, COMMAND_ERROR_SIZE);
            break;
        case JOIN:
            status = option_count("--join", value, 1, 64, &options->joining, error, COMMAND_ERROR_SIZE);
            break;
        case MIXED:
            options->mixed = true;
            break;
        case RESPAWN:
            options->respawn = true;
            break;
        case EMULATE:
            status = emulation_parse(&options->emulation, value, error, COMMAND_ERROR_SIZE);
            break;
        case IMAGES:
            options->images = value;
            break;
        case DROP_SHARE:
            status = option_share("--drop-share", value, &options->drop_share, error, COMMAND_ERROR_SIZE);
            break;
        case HELP:
            options->help = true;
            break;
        default:
            break;
        }
        if (status != 0) {
            return -1;
        }
    }
    if (options->scenario == NULL && !options->help) {
        return fail(error, COMMAND_ERROR_SIZE,
                    "motehound run: expected a scenario, found nothing; see motehound run --help");
    }
    if (options->pace > 0 && strncmp(options->bus_url, "memq:", 5) == 0) {
        return fail(error, COMMAND_ERROR_SIZE, "--pace: expected --bus URL too, found none that anyone could look on");
    }
    if (options->workers + options->joining == 0 && (options->mixed || options->respawn || options->drop_share > 0)) {
        return fail(error, COMMAND_ERROR_SIZE, "%s: expected --workers or --join too, found neither",
                    options->mixed     ? "--mixed"
                    : options->respawn ? "--respawn"
                                       : "--drop-share");
    }
    if (options->workers + options->joining > 0 && options->jobs > 1) {
        return fail(error, COMMAND_ERROR_SIZE, "--workers: expected one run at a time, found --jobs %llu",
                    (unsigned long long)options->jobs);
    }
    if (options->emulation.count > 0 && options->jobs > 1) {
        return fail(error, COMMAND_ERROR_SIZE, "--emulate: expected one run at a time, found --jobs %llu",
                    (unsigned long long)options->jobs);
    }
    snprintf(options->emulation.images, sizeof options->emulation.images, "%s",
             options->images != NULL ? options->images : emulation_images());
    return 0;
}

/* The scenario's file, then every --set, then what holds between keys. */
static int read_scenario(struct command *command, const char *path, struct scenario *scenario)
{
    char *error = command->error;
    if (scenario_load(path, scenario, error, COMMAND_ERROR_SIZE) != 0) {
        return -1;
    }
    struct option_reader reader = {.argc = command->argc, .argv = command->argv, .rules = rules, .rule_count = RULES};
    size_t rule = 0;
    const char *value = NULL;
    for (enum option_kind kind;
         (kind = option_next(&reader, &rule, &value, error, COMMAND_ERROR_SIZE)) != OPTION_END;) {
        if (kind == OPTION_NAMED && rule == SET && command_set(command, scenario, value) != 0) {
            return -1;
        }
    }
    return scenario_check(scenario, path, error, COMMAND_ERROR_SIZE);
}

/* The name of a scenario without one: its file's. */
static int name_after_file(struct scenario *scenario, const char *path, char *error)
{
    const char *slash = strrchr(path, '/');
    char name[100];
    if (scenario->name[0] != '\0') {
        return 0;
    }
    snprintf(name, sizeof name, "%.90s", slash != NULL ? slash + 1 : path);
    char *dot = strrchr(name, '.');
    if (dot != NULL && dot != name) {
        *dot = '\0';
    }
    return scenario_set(scenario, "name", name, error, COMMAND_ERROR_SIZE);
}

/* Each value of the sweep into DIR/VALUE; all of them are tried on the scenario before the first is simulated. */
static int sweep(struct command *command, struct session *session, struct scenario *scenario, const char *path)
{
    if (scenario->sweep.values_count == 0) {
        fail(command->error, COMMAND_ERROR_SIZE, "%s: sweep: expected a key and values for --sweep, found none", path);
        return 1;
    }
    const char *folder = session->out;
    struct session one = *session;
    for (int pass = 0; pass < 2; pass++) {
        for (unsigned i = 0; i < scenario->sweep.values_count; i++) {
            const char *value = scenario->sweep.values[i];
            char reason[1000], out[OUTPUT_PATH_MAX];
            if (scenario_set(scenario, scenario->sweep.key, value, reason, sizeof reason) != 0) {
                fail(command->error, COMMAND_ERROR_SIZE, "%s: sweep: %s", path, reason);
                return 1;
            }
            if (scenario_check(scenario, path, command->error, COMMAND_ERROR_SIZE) != 0) {
                return 1;
            }
            one.out = command_folder(folder, value, out);
            if (pass == 1) {
                printf("%s = %s: ", scenario->sweep.key, value);
                if (session_execute(command, &one) != 0) {
                    return 1;
                }
            }
        }
    }
    return 0;
}

int command_run(struct command *command)
{
    struct run_options options;
    struct scenario scenario;
    char path[SCENARIO_PATH_MAX], out[OUTPUT_PATH_MAX];
    if (read_options(command, &options) != 0) {
        return 1;
    }
    if (options.help) {
        fputs(help, stdout);
        return 0;
    }
    if (scenario_find(options.scenario, path, command->error, COMMAND_ERROR_SIZE) != 0) {
        return 1;
    }
    if (scenario_init(&scenario) != 0 || read_scenario(command, path, &scenario) != 0 ||
        name_after_file(&scenario, path, command->error) != 0) {
        scenario_free(&scenario);
        return 1;
    }
    struct session session = {
        .batch = {.scenario = &scenario,
                  .seed = options.seed,
                  .runs = (unsigned)options.runs,
                  .jobs = (unsigned)options.jobs,
                  .pace = options.pace,
                  .version = MOTEHOUND_VERSION,
                  .stop = command->stop},
        .out = options.out != NULL ? options.out : command_folder("out", scenario.name, out),
        .bus_url = options.bus_url,
        .workers = (unsigned)options.workers,
        .joining = (unsigned)options.joining,
        .mixed = options.mixed,
        .respawn = options.respawn,
        .emulation = options.emulation,
        .drop_share = options.drop_share,
        .log = options.log,
    };
    const int status = options.sweep ? sweep(command, &session, &scenario, path) : session_execute(command, &session);
    scenario_free(&scenario);
    return status;
}
