#include "world/clusters.h"

#include <math.h>

static const double pi = 3.141592653589793;

size_t clusters_count(const struct scenario *scenario) { return scenario->clusters.nodes.count; }

size_t clusters_size(const struct scenario *scenario, size_t cluster)
{
    return (size_t)scenario->clusters.nodes.values[cluster];
}

size_t clusters_first(const struct scenario *scenario, size_t cluster)
{
    size_t first = 0;
    for (size_t r = 0; r < cluster; r++) {
        first += clusters_size(scenario, r);
    }
    return first;
}

size_t clusters_nodes(const struct scenario *scenario) { return clusters_first(scenario, clusters_count(scenario)); }

struct clustered_node clustered_node(const struct scenario *scenario, size_t node)
{
    size_t r = 0;
    while (node >= clusters_first(scenario, r + 1)) {
        r++;
    }
    const size_t n = clusters_size(scenario, r), i = node - clusters_first(scenario, r);
    const size_t slower = (size_t)scenario->clusters.rates * i / n;
    return (struct clustered_node){.cluster = r,
                                   .index = i,
                                   .period = (uint64_t)scenario->clusters.every * (1 + slower),
                                   .range_variance_m2 = scenario->clusters.range_variance_m2.values[r]};
}

struct point clustered_place(const struct scenario *scenario, size_t node)
{
    const struct scenario_field field = scenario_field(scenario);
    const struct clustered_node what = clustered_node(scenario, node);
    const size_t columns = (size_t)ceil(sqrt((double)clusters_count(scenario)));
    const size_t rows = (clusters_count(scenario) + columns - 1) / columns;
    const double column = (double)(what.cluster % columns), row = (double)(what.cluster / columns);
    const double angle =
        2 * pi * (double)what.index / (double)clusters_size(scenario, what.cluster) + (double)what.cluster * pi / 7;
    return (struct point){field.width_m * (column + 0.5) / (double)columns + scenario->clusters.ring_m * cos(angle),
                          field.height_m * (row + 0.5) / (double)rows + scenario->clusters.ring_m * sin(angle)};
}

bool clusters_hear(const struct scenario *scenario, size_t cluster, size_t node)
{
    const struct clustered_node what = clustered_node(scenario, node);
    const size_t next = (cluster + 1) % clusters_count(scenario);
    return what.cluster == cluster || (what.cluster == next && what.index < (size_t)scenario->clusters.shared);
}
