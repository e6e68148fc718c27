/* The fixed clusters of the layout `rings`: who is in which, where each node stands, how often it samples and how well (Xu, Eqs. (7)-(10)).
 *
 * Cluster r stands in cell r of the field, row by row in a square grid of cells; its n nodes stand on a circle around the middle, node i at the angle
 * 2 pi i / n + r pi / 7. Nodes are numbered cluster by cluster. */
#ifndef MOTEHOUND_SIM_CLUSTERS_H
#define MOTEHOUND_SIM_CLUSTERS_H

#include "scenario/scenario.h"
#include "world/trajectory.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct clustered_node {
    size_t cluster, index; /* its number in the cluster */
    uint64_t period;       /* it samples at the sampling instants that are whole multiples of this, from the first on */
    double range_variance_m2;
};

/* Of scenario->clusters. */
size_t clusters_count(const struct scenario *scenario);

/* Nodes of one cluster, and the number of its first. */
size_t clusters_size(const struct scenario *scenario, size_t cluster);
size_t clusters_first(const struct scenario *scenario, size_t cluster);

/* Of all; the number that follows the last node's. */
size_t clusters_nodes(const struct scenario *scenario);

/* Node number `node`, below clusters_nodes(). */
struct clustered_node clustered_node(const struct scenario *scenario, size_t node);

/* Where it stands. */
struct point clustered_place(const struct scenario *scenario, size_t node);

/* Its samples go to this cluster's head: those of its own, and of the first clusters.shared nodes of the next (after the last comes the first). */
bool clusters_hear(const struct scenario *scenario, size_t cluster, size_t node);

#endif
