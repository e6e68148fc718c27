#include "cli/command.h"
#include "scenario/text.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char help[] = "motehound list | run | replay | bench | worker [OPTIONS]\n"
                           "\n"
                           "Tracks a moving or hidden source with a simulated or recorded network of sensor motes.\n"
                           "  motehound list     scenarios, trackers and keys\n"
                           "  motehound run      simulate a scenario\n"
                           "  motehound replay   feed a recording through the same motes\n"
                           "  motehound bench    measure what simulating costs\n"
                           "  motehound worker   host motes of a run that another process leads\n"
                           "  motehound COMMAND --help; motehound --version\n";

/* The one global: a signal handler can reach nothing else. */
static volatile sig_atomic_t stop;

static void on_signal(int number)
{
    (void)number;
    __atomic_store_n(&stop, 1, __ATOMIC_RELAXED); /* other threads look at it */
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
    if (strcmp(name, "bench") == 0) {
        return command_bench(command);
    }
    if (strcmp(name, "worker") == 0) {
        return command_worker(command);
    }
    if (strcmp(name, "--help") == 0 || strcmp(name, "help") == 0) {
        fputs(help, stdout);
        return 0;
    }
    if (strcmp(name, "--version") == 0) {
        puts("motehound " MOTEHOUND_VERSION);
        return 0;
    }
    fail(command->error, sizeof command->error,
         "motehound: expected list, run, replay, bench or worker, found '%.100s'; see motehound --help", name);
    return 1;
}

/* Interrupts end a run in good order, and a reader that has gone is an error of writing like any other. */
static void listen_to_signals(void)
{
    const struct sigaction action = {.sa_handler = on_signal}, ignore = {.sa_handler = SIG_IGN};
    struct sigaction before;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    if (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN) { /* nohup stays nohup */
        sigaction(SIGHUP, &action, NULL);
    }
    sigaction(SIGPIPE, &ignore, NULL);
}

/* A standard stream that came closed leads nowhere, lest a file of ours gets its number. */
static void occupy_standard_streams(void)
{
    int descriptor = open("/dev/null", O_RDWR);
    while (descriptor >= 0 && descriptor <= STDERR_FILENO) {
        descriptor = open("/dev/null", O_RDWR);
    }
    if (descriptor >= 0) {
        close(descriptor);
    }
}

int main(int argc, char **argv)
{
    occupy_standard_streams();
    listen_to_signals();
    struct command command = {.argc = argc > 2 ? argc - 2 : 0, .argv = argv + 2, .stop = &stop};
    int status = dispatch(argc > 1 ? argv[1] : "", &command);
    errno = 0;
    if ((fflush(stdout) != 0 || ferror(stdout)) && status == 0) {
        status = 1;
        fail(command.error, sizeof command.error, "standard output: cannot write: %s",
             errno != 0 ? strerror(errno) : "output error");
    }
    if (status != 0) {
        fprintf(stderr, "%s\n", command.error);
    }
    return status;
}
