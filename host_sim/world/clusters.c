#include "world/clusters.h"

#include "motehound/config.h"
#include "scenario/recording.h"
#include "scenario/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.141592653589793;

static size_t ring_size(const struct scenario *scenario, size_t cluster)
{
    return (size_t)scenario->clusters.nodes.values[cluster];
}

size_t rings_nodes(const struct scenario *scenario)
{
    size_t nodes = 0;
    for (size_t r = 0; r < scenario->clusters.nodes.count; r++) {
        nodes += ring_size(scenario, r);
    }
    return nodes;
}

static struct point ring_place(const struct scenario *scenario, size_t cluster, size_t index)
{
    const struct scenario_field field = scenario_field(scenario);
    const size_t count = scenario->clusters.nodes.count;
    const size_t columns = (size_t)ceil(sqrt((double)count));
    const size_t rows = (count + columns - 1) / columns;
    const size_t in_row = cluster / columns;
    const double column = (double)(cluster % columns), row = (double)in_row;
    const double angle = 2 * pi * (double)index / (double)ring_size(scenario, cluster) + (double)cluster * pi / 7;
    return (struct point){field.width_m * (column + 0.5) / (double)columns + scenario->clusters.ring_m * cos(angle),
                          field.height_m * (row + 0.5) / (double)rows + scenario->clusters.ring_m * sin(angle)};
}

struct clustered_node rings_node(const struct scenario *scenario, size_t node)
{
    size_t r = 0, i = node;
    while (i >= ring_size(scenario, r)) {
        i -= ring_size(scenario, r++);
    }
    const size_t slower = (size_t)scenario->clusters.rates * i / ring_size(scenario, r);
    return (struct clustered_node){.id = (uint32_t)node,
                                   .place = ring_place(scenario, r, i),
                                   .cluster = r,
                                   .index = i,
                                   .period = (uint64_t)scenario->clusters.every * (1 + slower),
                                   .range_variance_m2 = scenario->clusters.range_variance_m2.values[r]};
}

static int by_id(const void *a, const void *b)
{
    const uint32_t left = ((const struct clustered_node *)a)->id, right = ((const struct clustered_node *)b)->id;
    return (left > right) - (left < right);
}

/* What row `i` of the file says. */
static int read_node(struct clustered_node *node, const struct recording *recording, size_t i,
                     const struct scenario *scenario, char *error, size_t error_size)
{
    const struct recorded_node *place = &recording->nodes[i];
    const struct recorded_member *member = &recording->members[i];
    const double interval_s = scenario->sensor.interval_s, sd_m = scenario->sensor.range_noise_m;
    const double period = member->period_s > 0 ? member->period_s / interval_s : (double)scenario->clusters.every;
    if (fabs(period - round(period)) > 1e-6 || period < 0.5) {
        return fail(error, error_size,
                    "%s:%zu: period_s: expected a whole multiple of sensor.interval_s = %g, found %g",
                    scenario->network.file, member->line, interval_s, member->period_s);
    }
    if (fabs(place->z_m) > 0) {
        return fail(error, error_size, "%s:%zu: z_m: expected 0 for network.protocol fixed, found %g",
                    scenario->network.file, member->line, place->z_m);
    }
    if (member->noise_m2 <= 0 && sd_m <= 0) {
        return fail(error, error_size, "%s:1: expected a column noise_m2 where sensor.range_noise_m is 0, found none",
                    scenario->network.file);
    }
    *node = (struct clustered_node){.id = place->id,
                                    .place = {place->x_m, place->y_m},
                                    .cluster = member->cluster - 1,
                                    .period = (uint64_t)llround(period),
                                    .range_variance_m2 = member->noise_m2 > 0 ? member->noise_m2 : sd_m * sd_m};
    return 0;
}

static int read_nodes(struct clusters *clusters, const struct recording *recording, const struct scenario *scenario,
                      char *error, size_t error_size)
{
    const char *file = scenario->network.file;
    if (recording->members == NULL) {
        return fail(error, error_size, "%s:1: expected a column cluster for network.protocol fixed, found none", file);
    }
    if (recording->node_count > CLUSTERED_NODES_MAX) {
        return fail(error, error_size, "%s: node: expected at most %d nodes for network.protocol fixed, found %zu",
                    file, CLUSTERED_NODES_MAX, recording->node_count);
    }
    clusters->node_count = recording->node_count;
    for (size_t i = 0; i < clusters->node_count; i++) {
        if (read_node(&clusters->nodes[i], recording, i, scenario, error, error_size) != 0) {
            return -1;
        }
    }
    qsort(clusters->nodes, clusters->node_count, sizeof clusters->nodes[0], by_id);
    return 0;
}

/* Count who is where, and number the nodes of each cluster. */
static int number_nodes(struct clusters *clusters, const char *file, char *error, size_t error_size)
{
    for (size_t i = 0; i < clusters->node_count; i++) {
        struct clustered_node *node = &clusters->nodes[i];
        node->index = clusters->sizes[node->cluster]++;
        clusters->count = node->cluster >= clusters->count ? node->cluster + 1 : clusters->count;
    }
    for (size_t r = 0; r < clusters->count; r++) {
        if (clusters->sizes[r] == 0 || clusters->sizes[r] > CLUSTER_NODES_MAX) {
            return fail(error, error_size, "%s: cluster: expected 1 to %d nodes of each of 1 to %zu, found %zu of %zu",
                        file, CLUSTER_NODES_MAX, clusters->count, clusters->sizes[r], r + 1);
        }
    }
    return 0;
}

static int read_file(struct clusters *clusters, const struct scenario *scenario, char *error, size_t error_size)
{
    struct recording recording;
    if (recording_load_nodes(scenario->network.file, &recording, error, error_size) != 0) {
        return -1;
    }
    const int status = read_nodes(clusters, &recording, scenario, error, error_size);
    recording_free(&recording);
    return status != 0 ? -1 : number_nodes(clusters, scenario->network.file, error, error_size);
}

int clusters_make(struct clusters *clusters, const struct scenario *scenario, char *error, size_t error_size)
{
    memset(clusters, 0, sizeof *clusters);
    clusters->shared = (size_t)scenario->clusters.shared;
    if (scenario->network.layout == LAYOUT_FILE && strcmp(scenario->network.protocol, "fixed") == 0) {
        return read_file(clusters, scenario, error, error_size);
    }
    if (scenario->network.layout == LAYOUT_RINGS) {
        clusters->node_count = rings_nodes(scenario);
        for (size_t i = 0; i < clusters->node_count; i++) {
            clusters->nodes[i] = rings_node(scenario, i);
        }
    }
    return number_nodes(clusters, "clusters.nodes", error, error_size);
}

bool clusters_hear(const struct clusters *clusters, size_t cluster, size_t node)
{
    const struct clustered_node *what = &clusters->nodes[node];
    const size_t next = (cluster + 1) % clusters->count;
    return what->cluster == cluster || (what->cluster == next && what->index < clusters->shared);
}

size_t clusters_first(const struct clusters *clusters, size_t cluster)
{
    size_t i = 0;
    while (clusters->nodes[i].cluster != cluster) {
        i++;
    }
    return i;
}
