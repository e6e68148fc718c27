/* motehound replay: feed a real recording through the same motes. */
#include "cli/command.h"
#include "cli/options.h"
#include "scenario/folder.h"
#include "scenario/text.h"

#include <stdio.h>

static const char help[] =
    "motehound replay --nodes nodes.csv --readings readings.csv --tracker NAME [--truth truth.csv] [--candidates "
    "places.csv]\n"
    "                 [--scenario SCENARIO] [--set key=value]... [--out DIR] [--bus URL] [--log]\n"
    "\n"
    "Feeds a recording of a real network through the same motes that `motehound run` simulates.\n"
    "  --nodes FILE     node,x_m,y_m[,z_m]\n"
    "  --readings FILE  time_s,node,value[,target][,bearing_rad][,wind_speed_mps,wind_toward_rad], in order of time\n"
    "  --truth FILE     time_s,x_m,y_m[,target][,rate_mlps], in order of time; with it the errors are reported\n"
    "  --candidates F   place,x_m,y_m: where a leak can be; tracker gas then tells which of them leaks, by the winds;\n"
    "                   without, it looks for the leak on a grid over the rectangle in which the nodes stand\n"
    "  --tracker NAME   as --set tracker.name=NAME\n"
    "  --scenario S     a YAML file or a name of `motehound list` to take the settings from\n"
    "  --set key=value  change any key (`motehound list --keys`); may be repeated\n"
    "  --out DIR        folder for the results; default out/replay\n"
    "  --bus, --log     as in `motehound run`\n"
    "  --help           this text\n"
    "\n"
    "The sampling interval is the median spacing of the recording unless sensor.interval_s is set.\n";

enum { NODES, READINGS, TRUTH, CANDIDATES, TRACKER, SCENARIO, SET, OUT, BUS, LOG, HELP, RULES };

static const struct option_rule rules[RULES] = {
    [NODES] = {"--nodes", true, false},     [READINGS] = {"--readings", true, false},
    [TRUTH] = {"--truth", true, false},     [CANDIDATES] = {"--candidates", true, false},
    [TRACKER] = {"--tracker", true, false}, [SCENARIO] = {"--scenario", true, false},
    [SET] = {"--set", true, true},          [OUT] = {"--out", true, false},
    [BUS] = {"--bus", true, false},         [LOG] = {"--log", false, false},
    [HELP] = {"--help", false, false},
};

/* Value of every option but --set; flags have their own name. */
static int read_options(struct command *command, const char *values[RULES])
{
    struct option_reader reader = {.argc = command->argc, .argv = command->argv, .rules = rules, .rule_count = RULES};
    size_t rule = 0;
    const char *value = NULL;
    for (enum option_kind kind;
         (kind = option_next(&reader, &rule, &value, command->error, COMMAND_ERROR_SIZE)) != OPTION_END;) {
        if (kind == OPTION_ERROR) {
            return -1;
        }
        if (kind == OPTION_OPERAND) {
            return fail(command->error, COMMAND_ERROR_SIZE, "motehound replay: expected options only, found '%.100s'",
                        value);
        }
        values[rule] = value != NULL ? value : rules[rule].name;
    }
    for (size_t i = NODES; i <= READINGS && values[HELP] == NULL; i++) {
        if (values[i] == NULL) {
            return fail(command->error, COMMAND_ERROR_SIZE, "motehound replay: expected %s FILE, found nothing",
                        rules[i].name);
        }
    }
    if (values[TRACKER] == NULL && values[SCENARIO] == NULL && values[HELP] == NULL) {
        return fail(command->error, COMMAND_ERROR_SIZE, "motehound replay: expected --tracker NAME, found nothing");
    }
    return 0;
}

/* Settings of the scenario, if one is given, then of --tracker and --set. */
static int read_settings(struct command *command, const char *const values[RULES], struct scenario *scenario)
{
    char path[SCENARIO_PATH_MAX];
    if (scenario_set(scenario, "name", "replay", command->error, COMMAND_ERROR_SIZE) != 0) {
        return -1;
    }
    scenario->sensor.interval_s = 0; /* the recording's, unless something sets it */
    if (values[SCENARIO] != NULL && (scenario_find(values[SCENARIO], path, command->error, COMMAND_ERROR_SIZE) != 0 ||
                                     scenario_load(path, scenario, command->error, COMMAND_ERROR_SIZE) != 0)) {
        return -1;
    }
    char reason[1000];
    if (values[TRACKER] != NULL &&
        scenario_set(scenario, "tracker.name", values[TRACKER], reason, sizeof reason) != 0) {
        return fail(command->error, COMMAND_ERROR_SIZE, "--tracker: %s", reason);
    }
    struct option_reader reader = {.argc = command->argc, .argv = command->argv, .rules = rules, .rule_count = RULES};
    size_t rule = 0;
    const char *value = NULL;
    for (enum option_kind kind;
         (kind = option_next(&reader, &rule, &value, command->error, COMMAND_ERROR_SIZE)) != OPTION_END;) {
        if (kind == OPTION_NAMED && rule == SET && command_set(command, scenario, value) != 0) {
            return -1;
        }
    }
    return 0;
}

static int replay(struct command *command, const char *const values[RULES], struct scenario *scenario,
                  struct recording *recording)
{
    if (recording_load(values[NODES], values[READINGS], values[TRUTH], recording, command->error, COMMAND_ERROR_SIZE) !=
        0) {
        return 1;
    }
    if (values[CANDIDATES] != NULL &&
        recording_load_candidates(values[CANDIDATES], recording, command->error, COMMAND_ERROR_SIZE) != 0) {
        return 1;
    }
    if (recording_check_targets(recording, values[READINGS], values[TRUTH], command->error, COMMAND_ERROR_SIZE) != 0) {
        return 1;
    }
    if (scenario->sensor.interval_s <= 0) {
        char interval[40], reason[500];
        snprintf(interval, sizeof interval, "%.3f", recording->interval_s);
        if (scenario_set(scenario, "sensor.interval_s", interval, reason, sizeof reason) != 0) {
            fail(command->error, COMMAND_ERROR_SIZE,
                 "%.3000s: the median spacing of a node's readings is no interval: %s", values[READINGS], reason);
            return 1;
        }
    }
    if (scenario_check_tracking(scenario, values[SCENARIO] != NULL ? values[SCENARIO] : "--set", command->error,
                                COMMAND_ERROR_SIZE) != 0) {
        return 1;
    }
    struct session session = {
        .batch = {.scenario = scenario,
                  .recording = recording,
                  .runs = 1,
                  .jobs = 1,
                  .version = MOTEHOUND_VERSION,
                  .stop = command->stop},
        .out = values[OUT] != NULL ? values[OUT] : "out/replay",
        .bus_url = values[BUS] != NULL ? values[BUS] : "memq://",
        .log = values[LOG] != NULL,
    };
    return session_execute(command, &session);
}

int command_replay(struct command *command)
{
    const char *values[RULES] = {NULL};
    struct scenario scenario;
    struct recording recording = {0};
    if (read_options(command, values) != 0) {
        return 1;
    }
    if (values[HELP] != NULL) {
        fputs(help, stdout);
        return 0;
    }
    if (scenario_init(&scenario) != 0) {
        fail(command->error, COMMAND_ERROR_SIZE, "motehound replay: no memory");
        return 1;
    }
    const int status =
        read_settings(command, values, &scenario) != 0 ? 1 : replay(command, values, &scenario, &recording);
    recording_free(&recording);
    scenario_free(&scenario);
    return status;
}
