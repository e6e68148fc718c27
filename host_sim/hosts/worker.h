/* A worker: a process that hosts motes of a run that another process leads, over LCM. */
#ifndef MOTEHOUND_SIM_WORKER_H
#define MOTEHOUND_SIM_WORKER_H

#include "hosts/worker_wire.h"

#include <signal.h>

struct worker_config {
    const char *url;     /* of the bus */
    const char *version; /* of this simulator */
    int64_t session;     /* to join; 0: the first that calls */
    int64_t worker;      /* its number; 0: a random one */
    const char *images;  /* folder of images of boards */
    int lifeline;        /* a descriptor that comes to its end when the run does; -1: none */
    double drop_share;   /* of the messages is dropped on purpose */
    const volatile sig_atomic_t *stop;
};

struct worker;

/* A worker that listens on `link`, which outlives it: each message is served as it is handled. Returns NULL with one line in `error`. */
struct worker *worker_open(const struct worker_config *config, struct worker_link *link, char *error,
                           size_t error_size);

void worker_close(struct worker *worker);

/* Wait for a run that calls for workers, join it, host its motes until it is over. Returns 0, or -1 with one line in `error`: no
 * bus, a scenario that cannot be used, a run that went silent, stopped. */
int worker_serve(const struct worker_config *config, char *error, size_t error_size);

#endif
