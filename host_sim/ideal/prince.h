/* Targets that are heard, in an ideal network (network.protocol prince with network.ideal): at every sampling instant all nodes take a sample, and one
 * tracker a target or group has those of all nodes that detect something. Nobody is head, and no message is sent.
 *
 * - source.path scattered: at every instant the tracker begins anew and makes one fix.
 * - Otherwise each target is known when it begins, within 3 m and 2 m/s; identifiers are 1, 2, ... in the order of the targets. Where groups are followed, of those that begin
 *   less than 20 m from another only their mean velocity is: how many they are, and where, is found as source_count.h says.
 *
 * At an instant every track is stepped among the others as they were saved at the instant before; then groups that fall apart are
 * split, and tracks that have come together joined; then what there is is told. A track that has no position any more ends. */
#ifndef MOTEHOUND_SIM_IDEAL_PRINCE_H
#define MOTEHOUND_SIM_IDEAL_PRINCE_H

#include "simulation.h"

/* As simulation_run. Of the counters only samples and head.measurements are filled in. */
int ideal_prince_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                     const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                     size_t error_size);

#endif
