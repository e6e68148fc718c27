/* The workers of a session: where `motehound run` lets its motes live with --workers and --join. */
#ifndef MOTEHOUND_SIM_WORKERS_H
#define MOTEHOUND_SIM_WORKERS_H

#include "hosts/host.h"
#include "hosts/worker_pool.h"
#include "scenario/scenario.h"

struct workers {
    struct worker_pool *pool;
    char *scenario; /* as the workers are told it */
    struct host_provider provider;
};

/* Start `config->local` workers, wait for `config->joining` more, and have them ready for runs of `scenario`. Returns 0, or -1 with one line in
 * `error` and nothing to close. */
int workers_open(struct workers *workers, const struct worker_pool_config *config, const struct scenario *scenario,
                 char *error, size_t error_size);

/* How it went, as one line on standard output. */
void workers_report(const struct workers *workers);

void workers_close(struct workers *workers);

#endif
