/* motehound list: what there is to run, and the keys to set. */
#include "cli/command.h"
#include "cli/options.h"
#include "record/metrics.h"
#include "scenario/folder.h"
#include "scenario/keys.h"
#include "scenario/text.h"
#include "trackers.h"

#include <stdio.h>
#include <string.h>

static const char help[] =
    "motehound list [--keys | --metrics]\n"
    "\n"
    "Lists the scenarios that `motehound run` knows by name, and the trackers.\n"
    "  --keys     list all keys of a scenario and of --set, with default, range and meaning\n"
    "  --metrics  list the metrics of runs.csv and summary.json with their meaning\n"
    "  --help     this text\n"
    "\n"
    "Scenarios are looked for in $MOTEHOUND_SCENARIOS, then in `scenarios` beside the program, in\n"
    "../share/motehound/scenarios from it, and in the source tree.\n";

static void put_scenario(void *context, const char *name, const char *path)
{
    (void)context;
    struct scenario scenario;
    char error[500] = "no memory";
    if (scenario_init(&scenario) == 0 && scenario_load(path, &scenario, error, sizeof error) == 0) {
        printf("  %-14s %s\n", name, scenario.description);
    } else {
        printf("  %-14s (not usable: %s)\n", name, error);
    }
    scenario_free(&scenario);
}

static void put_keys(void)
{
    for (size_t i = 0; i < scenario_key_count; i++) {
        const struct scenario_key *key = &scenario_keys[i];
        char expectation[300];
        printf("%-30s %-20s %s%s%s\n", key->path, key->standard[0] != '\0' ? key->standard : "-",
               scenario_key_expectation(key, expectation, sizeof expectation), key->help[0] != '\0' ? "; " : "",
               key->help);
    }
}

static void put_metrics(void)
{
    for (size_t i = 0; i < METRIC_COUNT; i++) {
        printf("%-34s %s\n", metric_names[i], metric_meanings[i]);
    }
}

static void put_scenarios_and_trackers(void)
{
    puts("scenarios");
    if (scenario_list(put_scenario, NULL) == 0) {
        puts("  none found: set MOTEHOUND_SCENARIOS to a folder of .yaml files");
    }
    puts("trackers");
    const char *name, *meaning;
    for (size_t i = 0; tracker_describe(i, &name, &meaning); i++) {
        printf("  %-14s %s\n", name, meaning);
    }
}

static void put_help(void) { fputs(help, stdout); }

int command_list(struct command *command)
{
    enum { KEYS, METRICS, HELP, RULES };
    static const struct option_rule rules[RULES] = {
        [KEYS] = {"--keys", false, false}, [METRICS] = {"--metrics", false, false}, [HELP] = {"--help", false, false}};
    static void (*const put[RULES])(void) = {put_keys, put_metrics, put_help};
    struct option_reader reader = {.argc = command->argc, .argv = command->argv, .rules = rules, .rule_count = RULES};
    void (*chosen)(void) = put_scenarios_and_trackers;
    size_t rule = 0;
    const char *value = NULL;
    for (enum option_kind kind;
         (kind = option_next(&reader, &rule, &value, command->error, sizeof command->error)) != OPTION_END;) {
        if (kind == OPTION_ERROR) {
            return 1;
        }
        if (kind == OPTION_OPERAND) {
            fail(command->error, sizeof command->error, "motehound list: expected options only, found '%.100s'", value);
            return 1;
        }
        chosen = put[rule];
    }
    chosen();
    return 0;
}
