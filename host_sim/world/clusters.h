/* Fixed clusters: who is in which, where each node stands, how often it samples and how well (Xu, Eqs. (7)-(10)).
 *
 * Of the layout `rings`: cluster r stands in cell r of the field, row by row in a square grid of cells; its n nodes stand on a circle around the middle, node i at the
 * angle 2 pi i / n + r pi / 7. Nodes are numbered cluster by cluster.
 *
 * Of the layout `file`: the columns `cluster` and, optionally, `period_s` and `noise_m2` of network.file say it; without them a node samples at each clusters.every-th
 * instant, with sensor.range_noise_m. */
#ifndef MOTEHOUND_SIM_CLUSTERS_H
#define MOTEHOUND_SIM_CLUSTERS_H

#include "scenario/scenario.h"
#include "world/trajectory.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CLUSTER_NODES_MAX = 32, CLUSTERED_NODES_MAX = CLUSTER_NODES_MAX * SCENARIO_NUMBERS_MAX };

struct clustered_node {
    uint32_t id;
    struct point place;
    size_t cluster, index; /* its number in the cluster, by identifier */
    uint64_t period;       /* it samples at the sampling instants that are whole multiples of this, from the first on */
    double range_variance_m2;
};

struct clusters {
    size_t count, node_count;           /* 0: there are none */
    size_t sizes[SCENARIO_NUMBERS_MAX]; /* nodes of each */
    size_t shared;
    struct clustered_node nodes[CLUSTERED_NODES_MAX]; /* by identifier, as in the deployment */
};

/* Those of the layout `rings`, or of `file` with the protocol `fixed`; otherwise none. Returns 0, or -1 with one line in `error` (the file cannot be used: no column
 * `cluster`, a cluster without nodes or of more than 32, more nodes than there is room for, a period that is no whole number of sensor.interval_s, a node that does not stand on the ground). */
int clusters_make(struct clusters *clusters, const struct scenario *scenario, char *error, size_t error_size);

/* Samples of node number `node` go to the head of `cluster`: those of its own, and of the first `shared` nodes of the next (after the last comes the first). */
bool clusters_hear(const struct clusters *clusters, size_t cluster, size_t node);

/* The number of the first node of a cluster, by identifier. */
size_t clusters_first(const struct clusters *clusters, size_t cluster);

/* Nodes of all rings together. */
size_t rings_nodes(const struct scenario *scenario);

/* Node number `node` of the rings, below rings_nodes(). */
struct clustered_node rings_node(const struct scenario *scenario, size_t node);

#endif
