/* The bus of one run: what an observer of the simulation is told, as LCM messages (lcm_types/motehound_bus.lcm).
 *
 * Every message goes to the run's own in-memory LCM, to a log if there is one, and to an outside LCM if there is one.
 * Subscribers on the run's own LCM are called before the observing function returns, so a recorder sees everything, in
 * order, whatever the network outside does. Frames, clusters, the state of motes, and the nodes of runs after the first are
 * published only if there is a log or an outside. */
#ifndef MOTEHOUND_SIM_BUS_H
#define MOTEHOUND_SIM_BUS_H

#include "simulation.h"

#include <lcm/lcm.h>

#define BUS_HELLO "MOTEHOUND_HELLO" /* an empty message to the outside, before any run, to see whether there is one */
#define BUS_RUN_BEGIN "MOTEHOUND_RUN_BEGIN"
#define BUS_NODE "MOTEHOUND_NODE"
#define BUS_TRUTH "MOTEHOUND_TRUTH"
#define BUS_FRAME "MOTEHOUND_FRAME"
#define BUS_TRACK "MOTEHOUND_TRACK"
#define BUS_SINK "MOTEHOUND_SINK"
#define BUS_LOCAL "MOTEHOUND_LOCAL"
#define BUS_CLUSTER "MOTEHOUND_CLUSTER"
#define BUS_WATCH "MOTEHOUND_WATCH"
#define BUS_MOTE "MOTEHOUND_MOTE"
#define BUS_TOTALS "MOTEHOUND_TOTALS"
#define BUS_RUN_END "MOTEHOUND_RUN_END"

struct bus {
    lcm_t *lcm;          /* memq://; subscribe here */
    lcm_t *outside;      /* NULL or shared by all runs: LCM's publishing is thread-safe */
    lcm_eventlog_t *log; /* NULL or a standard LCM log, its timestamps the simulated time in microseconds */
    int32_t run;
    bool searches;  /* who is heard counts (record/search.h): nodes and clusters are published in any case */
    double pace;    /* simulated seconds a second of what goes outside; 0: as fast as it is simulated */
    double began_s; /* by the machine's clock, what was simulated time 0 at that pace */
    double time_s;  /* of the last message */
    bool failed;    /* a message could not be made, delivered or logged */
};

/* Call once before there are threads: lcm-gen's code computes the fingerprint of a type at its first use, unguarded. */
void bus_prepare(void);

/* `log_path` and `outside` may be NULL; `pace` concerns `outside`. Returns 0, or -1 with one line in `error`. */
int bus_open(struct bus *bus, int32_t run, const char *log_path, lcm_t *outside, double pace, char *error,
             size_t error_size);

/* The observer that publishes on this bus. `bus` outlives it. */
struct observer bus_observer(struct bus *bus);

void bus_begin(struct bus *bus, uint64_t seed, const char *scenario, const char *version);
void bus_end(struct bus *bus, const struct simulation_counters *counters);

/* Returns 0, or -1 with one line in `error` if any message was lost. */
int bus_close(struct bus *bus, char *error, size_t error_size);

/* An LCM on `url` for bus_open's `outside`; *outside is NULL for memq://. LCM's own lines about a URL that it cannot
 * serve are kept from standard error, so call it before there are threads. Returns 0, or -1 with one line in `error`.
 */
int bus_outside(const char *url, lcm_t **outside, char *error, size_t error_size);

#endif
