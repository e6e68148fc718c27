/* The workers of a run: starts those of this machine, lets others join, and brings every request to its worker and the answer back, whatever
 * the bus loses. What is asked is remote.c's business. */
#ifndef MOTEHOUND_SIM_WORKER_POOL_H
#define MOTEHOUND_SIM_WORKER_POOL_H

#include "hosts/worker_wire.h"

#include <signal.h>

struct worker_pool_config {
    const char *url;     /* of the bus */
    const char *version; /* of this simulator */
    const char *program; /* that is started as `PROGRAM worker ...` */
    const char *images;  /* that these find the images of boards in */
    unsigned local;      /* workers to start */
    unsigned joining;    /* workers to wait for that others start */
    bool mixed;          /* workers may compute in fixed point and in floating point, whatever the run does */
    bool respawn;        /* replace a worker that dies, else the run ends */
    double drop_share;   /* of the messages, in both directions, is dropped on purpose */
    const volatile sig_atomic_t *stop;
};

/* How it went. */
struct worker_pool_statistics {
    unsigned workers, replaced;
    uint64_t windows; /* in which a worker was asked */
    double window_s;  /* spent in them, the motes' own work included */
    uint64_t requests, repeated, not_understood;
};

struct worker_pool;

/* What becomes of answers. A function that returns -1 with one line in `error` ends the run. */
struct worker_answers {
    void *context;
    int (*done)(void *context, unsigned worker, const motehound_worker_done_t *message, char *error, size_t error_size);
    int (*totals)(void *context, unsigned worker, const motehound_worker_totals_t *message, char *error,
                  size_t error_size);
};

/* Start the local workers and wait until all have joined; `waiting` (may be NULL) is called when only others' are missing. Returns NULL
 * with one line in `error`: no bus, a worker that does not come up, or is of another version or arithmetic, stopped. */
struct worker_pool *worker_pool_open(const struct worker_pool_config *config, void (*waiting)(unsigned missing),
                                     char *error, size_t error_size);

/* Release the workers; the local ones have ended when it returns. */
void worker_pool_close(struct worker_pool *pool);

unsigned worker_pool_count(const struct worker_pool *pool);

/* What a request to worker `worker` says first: session, worker and number. */
void worker_pool_address(const struct worker_pool *pool, unsigned worker, int64_t *session, int64_t *key,
                         int64_t *number);

/* Send worker `worker`, which has answered all so far, the request that has just been addressed; `bytes` is new memory, which the pool takes;
 * NULL if there was none. Returns 0, or -1 with one line in `error`. */
int worker_pool_request(struct worker_pool *pool, unsigned worker, enum worker_request kind, uint8_t *bytes,
                        size_t size, char *error, size_t error_size);

/* Wait until every worker has answered. Returns 0, or -1 with one line in `error`: a worker that died and is not replaced, what
 * a worker says it died of, stopped. */
int worker_pool_await(struct worker_pool *pool, const struct worker_answers *answers, char *error, size_t error_size);

/* One more window, which took `seconds`. */
void worker_pool_note_window(struct worker_pool *pool, double seconds);

struct worker_pool_statistics worker_pool_statistics(const struct worker_pool *pool);

#endif
