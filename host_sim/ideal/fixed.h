/* Fixed clusters in a network without frames: the published experiments with a fusion centre, sampling instant by sampling instant.
 *
 * At each instant every node whose period it is samples; every cluster's head has its nodes' ranges at once and steps its tracker, samples or none. Every fusion.report_s the
 * heads summarise their tracks; each summary is lost with probability fusion.report_loss, number (instant x clusters + cluster) of the stream RANDOM_SUMMARIES; the centre takes
 * the others, joins them, and the heads are told what arrived and, if the rule has it so, what came of it. With the rule `central` one tracker has all samples instead.
 *
 * Trackers and centre are the motes' own. Estimates are the centre's, by the sink. Energy is not accounted for. */
#ifndef MOTEHOUND_SIM_IDEAL_FIXED_H
#define MOTEHOUND_SIM_IDEAL_FIXED_H

#include "simulation.h"

/* As simulation_run, for a scenario with network.ideal and the protocol `fixed`. */
int ideal_fixed_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                    const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                    size_t error_size);

#endif
