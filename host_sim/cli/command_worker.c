/* motehound worker: host motes of a run that another process leads. */
#include "cli/command.h"
#include "cli/options.h"
#include "hosts/boards.h"
#include "hosts/worker.h"
#include "scenario/text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static const char help[] =
    "motehound worker --bus URL [--images DIR]\n"
    "\n"
    "Waits on an LCM bus for a run that calls for workers (`motehound run ... --bus URL --join N`), joins it, hosts\n"
    "its share of the motes and ends when the run does. The run's results do not depend on where its motes live.\n"
    "  --bus URL        the bus of the run, such as udpm://239.255.76.67:7667?ttl=1\n"
    "  --images DIR     images of boards, for motes that live on some (docs/emulation.md)\n"
    "  --drop-share P   for tests: drop this share of the messages sent\n"
    "  --help           this text\n"
    "\n"
    "Both must be the same version of motehound, and compute in the same arithmetic unless the run has --mixed.\n"
    "`motehound run --workers N` starts workers of this machine by itself. See docs/workers.md.\n";

enum { BUS, SESSION, KEY, IMAGES, DROP_SHARE, HELP, RULES };

/* --session and --key are how `motehound run` tells its own workers who they are, with a pipe as their standard input. */
static const struct option_rule rules[RULES] = {
    [BUS] = {"--bus", true, false},
    [IMAGES] = {"--images", true, false},
    [SESSION] = {"--session", true, false},
    [KEY] = {"--key", true, false},
    [DROP_SHARE] = {"--drop-share", true, false},
    [HELP] = {"--help", false, false},
};

static int read_number(struct command *command, const char *name, const char *value, int64_t *number)
{
    char *end;
    errno = 0;
    const unsigned long long read = strtoull(value, &end, 16);
    if (*value == '\0' || *end != '\0' || errno != 0 || read < 1 || read > INT64_MAX) {
        return fail(command->error, COMMAND_ERROR_SIZE, "%s: expected a hexadecimal number, found '%.100s'", name,
                    value);
    }
    *number = (int64_t)read;
    return 0;
}

int command_worker(struct command *command)
{
    struct worker_config config = {
        .version = MOTEHOUND_VERSION, .images = emulation_images(), .lifeline = -1, .stop = command->stop};
    struct option_reader reader = {.argc = command->argc, .argv = command->argv, .rules = rules, .rule_count = RULES};
    size_t rule = 0;
    const char *value = NULL;
    for (enum option_kind kind;
         (kind = option_next(&reader, &rule, &value, command->error, COMMAND_ERROR_SIZE)) != OPTION_END;) {
        if (kind == OPTION_ERROR) {
            return 1;
        }
        if (kind == OPTION_OPERAND) {
            fail(command->error, COMMAND_ERROR_SIZE, "motehound worker: expected options only, found '%.100s'", value);
            return 1;
        }
        int status = 0;
        switch (rule) {
        case BUS:
            config.url = value;
            break;
        case SESSION:
            status = read_number(command, "--session", value, &config.session);
            break;
        case KEY:
            status = read_number(command, "--key", value, &config.worker);
            config.lifeline = STDIN_FILENO;
            break;
        case IMAGES:
            config.images = value;
            break;
        case DROP_SHARE:
            status = option_share("--drop-share", value, &config.drop_share, command->error, COMMAND_ERROR_SIZE);
            break;
        default:
            fputs(help, stdout);
            return 0;
        }
        if (status != 0) {
            return 1;
        }
    }
    if (config.url == NULL) {
        fail(command->error, COMMAND_ERROR_SIZE, "motehound worker: expected --bus URL, found nothing");
        return 1;
    }
    return worker_serve(&config, command->error, COMMAND_ERROR_SIZE) == 0 ? 0 : 1;
}
