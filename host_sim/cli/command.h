/* The commands of `motehound`. Each takes the words after its name and returns the exit status: 0, or 1 with one line
 * in `error`. */
#ifndef MOTEHOUND_SIM_COMMAND_H
#define MOTEHOUND_SIM_COMMAND_H

#include "cli/batch.h"
#include "hosts/boards.h"
#include "record/output.h"

enum { COMMAND_ERROR_SIZE = 5000 };

struct command {
    int argc;
    char **argv;
    const volatile sig_atomic_t *stop; /* nonzero once the user has interrupted */
    char error[COMMAND_ERROR_SIZE];
};

int command_list(struct command *command);
int command_run(struct command *command);
int command_replay(struct command *command);
int command_bench(struct command *command);
int command_worker(struct command *command);

/* What run and replay have in common: a batch into folder `out`, with progress on a terminal, and a table of results on
 * standard output. Returns as a command does. */
struct session {
    struct batch batch;
    const char *out;
    const char *bus_url;
    unsigned workers, joining;  /* that host the motes, on bus_url; neither: this process does */
    bool mixed, respawn;        /* see struct worker_pool_config */
    struct emulation emulation; /* motes that live on boards */
    double drop_share;          /* of the messages to and from workers */
    bool log;
};
int session_execute(struct command *command, struct session *session);

/* FOLDER/NAME in `path`, which is returned; whatever the name, it stays within the folder. */
const char *command_folder(const char *folder, const char *name, char path[OUTPUT_PATH_MAX]);

/* Apply one `key=value` of --set. Returns 0, or -1 with one line in command->error. */
int command_set(struct command *command, struct scenario *scenario, const char *assignment);

#endif
