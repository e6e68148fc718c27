/* Motes in other processes: the table of host.h over a pool of workers. */
#ifndef MOTEHOUND_SIM_REMOTE_H
#define MOTEHOUND_SIM_REMOTE_H

#include "hosts/host.h"
#include "hosts/worker_pool.h"

/* `count` motes, spread evenly over the workers, mote i in the order of order[i], so that neighbours share a worker. `scenario` is the run's, as
 * YAML or JSON, and `seed` too. `pool`, `order` and `scenario` outlive the host; a pool serves one host at a time. Returns 0, or -1 if
 * there is no memory. */
int host_remote(struct host *host, uint32_t count, const uint32_t *order, const char *scenario, uint64_t seed,
                struct worker_pool *pool);

#endif
