/* Many runs of one scenario, in parallel, their results in order. */
#ifndef MOTEHOUND_SIM_BATCH_H
#define MOTEHOUND_SIM_BATCH_H

#include "hosts/host.h"
#include "record/results.h"
#include "scenario/recording.h"
#include "simulation.h"

struct batch {
    const struct scenario *scenario;
    const struct recording *recording; /* to replay, or NULL to simulate */
    uint64_t seed;                     /* run r has seed + r */
    unsigned runs, jobs;
    const struct host_provider *hosts; /* of simulated runs; NULL: the motes live in this process; else `jobs` is 1 */
    lcm_t *outside;                    /* see bus.h; may be NULL */
    double pace;                       /* of what goes outside, see bus.h */
    const char *version;
    const volatile sig_atomic_t *stop;
    /* Called from the calling thread when a run's results are in, and some times a second. May be NULL. */
    void (*progress)(void *context, unsigned done, unsigned runs);
    void *progress_context;
};

/* Do all runs on `jobs` threads and add each to `results` in order. The bytes of the results do not depend on `jobs`.
 * Returns 0, or -1 with one line in `error`. */
int batch_execute(const struct batch *batch, struct results *results, char *error, size_t error_size);

#endif
