/* Runs of a network without frames (network.ideal), as published: messages take no time. What else holds is the protocol's. */
#ifndef MOTEHOUND_SIM_IDEAL_H
#define MOTEHOUND_SIM_IDEAL_H

#include "simulation.h"

/* As simulation_run, for a scenario with network.ideal. */
int ideal_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
              const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error, size_t error_size);

#endif
