/* A board that is a child process, its serial line the child's standard input and output. Between events it is stopped, so that a board that waits costs no
 * time, and its clock stands still. */
#include "hosts/board.h"
#include "scenario/text.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif

struct process {
    pid_t child;
    int line,
        complaints; /* descriptors; the other ends are the child's standard input and output, and standard error */
};

/* In the child, after fork: it lives no longer than who started it. Only what may be called there. */
static void become(const char *const *arguments, int line, int complaints)
{
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    if (dup2(line, STDIN_FILENO) >= 0 && dup2(line, STDOUT_FILENO) >= 0 && dup2(complaints, STDERR_FILENO) >= 0) {
        execvp(arguments[0], (char *const *)arguments);
    }
    const char *reason = errno == ENOENT   ? ": cannot be started: not installed?"
                         : errno == EACCES ? ": cannot be started: may not be run"
                                           : ": cannot be started";
    (void)!write(STDERR_FILENO, arguments[0], strlen(arguments[0]));
    (void)!write(STDERR_FILENO, reason, strlen(reason));
    _exit(127);
}

/* What became of the child, and the first line that it complains with. */
static int tell_end(const struct process *process, char *error, size_t error_size)
{
    char complaint[200] = "";
    const ssize_t length = read(process->complaints, complaint, sizeof complaint - 1);
    complaint[length > 0 ? length : 0] = '\0';
    complaint[strcspn(complaint, "\n")] = '\0';
    int status = 0;
    const char *colon = complaint[0] != '\0' ? ": " : "";
    if (waitpid(process->child, &status, WNOHANG) != process->child) {
        return fail(error, error_size, "has closed its line%s%s", colon, complaint);
    }
    if (WIFSIGNALED(status)) {
        return fail(error, error_size, "was ended by signal %d%s%s", WTERMSIG(status), colon, complaint);
    }
    return fail(error, error_size, "has ended with status %d%s%s", WEXITSTATUS(status), colon, complaint);
}

static int put(void *state, const uint8_t *bytes, size_t count, char *error, size_t error_size)
{
    const struct process *process = state;
    kill(process->child, SIGCONT);
    for (size_t at = 0; at < count;) {
        const ssize_t taken = send(process->line, bytes + at, count - at, MSG_NOSIGNAL);
        if (taken < 0 && errno != EINTR) {
            return tell_end(process, error, error_size);
        }
        at += taken > 0 ? (size_t)taken : 0;
    }
    return 0;
}

static long get(void *state, uint8_t *bytes, size_t room, double patience_s, char *error, size_t error_size)
{
    const struct process *process = state;
    struct pollfd what = {process->line, POLLIN, 0};
    const int ready = poll(&what, 1, (int)(1e3 * patience_s));
    if (ready <= 0) {
        return 0; /* interrupted too: whoever waits asks again, or gives up */
    }
    const ssize_t got = read(process->line, bytes, room);
    if (got > 0) {
        return (long)got;
    }
    const struct timespec moment = {0, 50000000}; /* the line goes before the process */
    nanosleep(&moment, NULL);
    return tell_end(process, error, error_size);
}

static void rest(void *state)
{
    const struct process *process = state;
    kill(process->child, SIGSTOP);
}

static void close_process(void *state)
{
    struct process *process = state;
    kill(process->child, SIGKILL);
    waitpid(process->child, NULL, 0);
    close(process->line);
    close(process->complaints);
    free(process);
}

static bool keep_to_ourselves(const int *descriptors, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (fcntl(descriptors[i], F_SETFD, FD_CLOEXEC) != 0) {
            return false;
        }
    }
    return true;
}

int board_process_open(struct board_line *line, const char *const *arguments, char *error, size_t error_size)
{
    struct process *process = calloc(1, sizeof *process);
    int ends[4] = {-1, -1, -1, -1};
    if (process && socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0 && pipe(ends + 2) == 0 &&
        keep_to_ourselves(ends, 4) && fcntl(ends[2], F_SETFL, O_NONBLOCK) == 0) {
        *process = (struct process){fork(), ends[0], ends[2]};
        if (process->child == 0) {
            become(arguments, ends[1], ends[3]);
        }
        if (process->child > 0) {
            close(ends[1]);
            close(ends[3]);
            *line = (struct board_line){process, put, get, rest, close_process};
            return 0;
        }
    }
    for (int i = 0; i < 4; i++) {
        if (ends[i] >= 0) {
            close(ends[i]);
        }
    }
    free(process);
    return fail(error, error_size, "%s: cannot be started: %s", arguments[0], strerror(errno));
}
