#include "cli/command.h"

#include <stdio.h>
#include <string.h>

static const char help[] = "motehound list | run | replay [OPTIONS]\n"
                           "\n"
                           "Tracks a moving or hidden source with a simulated or recorded network of sensor motes.\n"
                           "  motehound list     scenarios, trackers and keys\n"
                           "  motehound run      simulate a scenario\n"
                           "  motehound replay   feed a recording through the same motes\n"
                           "  motehound COMMAND --help; motehound --version\n";

/* The one global: a signal handler can reach nothing else. */
static volatile sig_atomic_t stop;

static void on_signal(int number)
{
    (void)number;
    stop = 1;
}

static int dispatch(const char *name, struct command *command)
{
    if (strcmp(name, "list") == 0) {
        return command_list(command);
    }
    if (strcmp(name, "run") == 0) {
        return command_run(command);
    }
    if (strcmp(name, "replay") == 0) {
        return command_replay(command);
    }
    if (strcmp(name, "--help") == 0 || strcmp(name, "help") == 0) {
        fputs(help, stdout);
        return 0;
    }
    if (strcmp(name, "--version") == 0) {
        puts("motehound " MOTEHOUND_VERSION);
        return 0;
    }
    snprintf(command->error, sizeof command->error,
             "motehound: expected list, run or replay, found '%.100s'; see motehound --help", name);
    return 1;
}

int main(int argc, char **argv)
{
    const struct sigaction action = {.sa_handler = on_signal};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    struct command command = {.argc = argc > 2 ? argc - 2 : 0, .argv = argv + 2, .stop = &stop};
    const int status = dispatch(argc > 1 ? argv[1] : "", &command);
    if (status != 0) {
        fprintf(stderr, "%s\n", command.error);
    }
    return status;
}
