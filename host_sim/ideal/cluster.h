/* Runs of a network in which nothing is lost, nothing collides and messages take no time: the published experiments with ranged targets, sample by
 * sample. Trackers, election rules and geographic routing are the motes' own.
 *
 * At each sampling instant the head asks the nodes that its election rule names (the first time: all answer), those that
 * detect the target answer with their ranges, the tracker makes a position of them, the sink is told if what it knows is off by more than
 * the tolerance, and the rule decides who goes on. If none of those asked detects the target but other nodes do, the one nearest
 * to the prediction alerts its neighbours at the same instant, takes the track over and begins a new cluster.
 *
 * Energy is that of ledger.h, with the messages of messages.h. By causes: localisation is sensing (all who are asked) and computing;
 * measuring is requests, 2 ms of listening for each, and answers; reporting is what goes to the sink hop by hop; clustering is
 * formations, joins, hand-overs and alerts. A hand-over over several hops is charged to its two ends. */
#ifndef MOTEHOUND_SIM_IDEAL_CLUSTER_H
#define MOTEHOUND_SIM_IDEAL_CLUSTER_H

#include "simulation.h"

/* As simulation_run, for a scenario with network.ideal and the protocol `cluster`: sensors that measure ranges, and a tracker that can be handed over. */
int ideal_cluster_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                      const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                      size_t error_size);

#endif
