/* What no tracker can undercut, because it knows the target's whole path beforehand: how often a head must hand over to another, and how
 * often it must report. A path is the target's place at successive sampling instants, all equally far apart. */
#ifndef MOTEHOUND_SIM_HINDSIGHT_H
#define MOTEHOUND_SIM_HINDSIGHT_H

#include "scenario/recording.h"
#include "world/trajectory.h"

#include <stddef.h>

/* The least number of changes of the head -> *hand_overs, where the head senses the target, within range_m, at each sample at which any
 * node does: each head in turn is the node that goes on sensing it for longest, which is optimal for intervals. The first head is no
 * change. Returns 0, or -1 if there is no memory. Cost: nodes x samples. */
int hindsight_hand_overs(const struct recorded_node *nodes, size_t node_count, const struct point *path, size_t samples,
                         double range_m, size_t *hand_overs);

/* The least number of reports, each a position and a velocity that hold until the next, that follow the path within tolerance_m at every
 * sample -> *reports: each in turn goes as far as any straight uniform motion can, which is optimal too. One motion fits some samples if the
 * minimax fit does; Lawson's algorithm (Lawson, "Contributions to the theory of linear least maximum approximation", 1961), weighted least
 * squares with each weight multiplied by its residual, encloses the minimax error between the weighted root mean square and the greatest
 * residual. A motion still undecided after 200 rounds counts as one that fits, so that the number stays a lower bound. Returns 0, or
 * -1 if there is no memory. */
int hindsight_reports(const struct point *path, size_t samples, double tolerance_m, size_t *reports);

#endif
