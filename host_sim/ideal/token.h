/* A search for a source of gas that walks from head to head (Zhang, Fig. 2), in a network in which nothing is lost, nothing collides and messages
 * take no time. The tracker is the motes' own.
 *
 * At each sampling instant the head and all who stand within radio.range_m of it sample; the tracker takes the head's sample first, then those
 * of its neighbours by identifier. After protocol.heads_max heads, or when the estimate was calm (MH_ESTIMATE_CALM) at protocol.calm heads in
 * succession, the search is over; else what the tracker saves goes to the neighbour that it scores highest, of equal ones that with the lowest
 * identifier. Where the tracker has no more estimate, the search ends too.
 *
 * Who is heard is told as the members of a cluster, before the estimate that comes of it. Energy is not accounted for. */
#ifndef MOTEHOUND_SIM_IDEAL_TOKEN_H
#define MOTEHOUND_SIM_IDEAL_TOKEN_H

#include "simulation.h"

/* As simulation_run, for a scenario with network.ideal and the protocol token. */
int ideal_token_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                    const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                    size_t error_size);

#endif
