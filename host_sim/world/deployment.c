#include "world/deployment.h"

#include "engine/random.h"
#include "world/campaign.h"
#include "world/clusters.h"
#include "world/recipe.h"
#include "world/splitmix.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DRAWS_MAX = 10000 }; /* of a deployment that suits a campaign */

static void lay_uniform(struct deployment *deployment, double width_m, double height_m, uint64_t seed, uint64_t draw)
{
    const struct random_stream stream = random_stream(seed, RANDOM_DEPLOYMENT);
    const uint64_t first = draw * deployment->count;
    for (size_t i = 0; i < deployment->count; i++) {
        deployment->nodes[i].x_m = width_m * random_uniform(stream, 2 * (first + i));
        deployment->nodes[i].y_m = height_m * random_uniform(stream, 2 * (first + i) + 1);
    }
}

static void lay_hashed(struct deployment *deployment, double width_m, double height_m, uint64_t seed)
{
    for (size_t i = 0; i < deployment->count; i++) {
        deployment->nodes[i].x_m = width_m * recipe_uniform(seed, RECIPE_NODE_X, i);
        deployment->nodes[i].y_m = height_m * recipe_uniform(seed, RECIPE_NODE_Y, i);
    }
}

/* The sequence in fixed point, where frac() is the overflow of 64 bits: exact for every index and seed. */
static void lay_r2(struct deployment *deployment, double width_m, double height_m, uint64_t seed)
{
    const uint64_t x_step = (uint64_t)(0.7548776662466927 * 0x1p64), y_step = (uint64_t)(0.5698402909980532 * 0x1p64);
    const uint64_t half = UINT64_C(1) << 63;
    for (size_t i = 0; i < deployment->count; i++) {
        const uint64_t n = i + 1 + 1000 * seed;
        deployment->nodes[i].x_m = width_m * (double)((half + n * x_step) >> 11) * 0x1p-53;
        deployment->nodes[i].y_m = height_m * (double)((half + n * y_step) >> 11) * 0x1p-53;
    }
}

/* How far cells of that shape are from square: at least 1. */
static double elongation(double width_m, double height_m, size_t columns, size_t rows)
{
    const double ratio = (width_m / (double)columns) / (height_m / (double)rows);
    return fmax(ratio, 1 / ratio);
}

static size_t grid_columns(size_t count, double width_m, double height_m)
{
    size_t best = 1;
    for (size_t columns = 2; columns <= count; columns++) {
        if (count % columns == 0 && elongation(width_m, height_m, columns, count / columns) <
                                        elongation(width_m, height_m, best, count / best) * (1 - 1e-12)) {
            best = columns;
        }
    }
    if (elongation(width_m, height_m, best, count / best) <= 2) {
        return best;
    }
    const double square = ceil(sqrt((double)count * width_m / height_m));
    return (size_t)fmin(fmax(square, 1), (double)count);
}

static void lay_grid(struct deployment *deployment, const struct scenario *scenario, uint64_t seed)
{
    const struct scenario_field field = scenario_field(scenario);
    const struct random_stream stream = random_stream(seed, RANDOM_DEPLOYMENT);
    const size_t count = deployment->count;
    const double spacing_m = scenario->network.spacing_m, jitter = scenario->network.jitter;
    const bool fills = spacing_m <= 0;
    const size_t columns =
        fills ? grid_columns(count, field.width_m, field.height_m) : (size_t)(field.width_m / spacing_m * (1 + 1e-9));
    const size_t rows = (count + columns - 1) / columns;
    const double width_m = fills ? field.width_m : spacing_m * (double)columns;
    const double height_m = fills ? field.height_m : spacing_m * (double)rows;
    for (size_t i = 0; i < count; i++) {
        const size_t row = i / columns;
        const size_t in_row = row + 1 < rows || !fills ? columns : count - row * columns;
        const double x_off = jitter * (2 * random_uniform(stream, 2 * i) - 1);
        const double y_off = jitter * (2 * random_uniform(stream, 2 * i + 1) - 1);
        deployment->nodes[i].x_m = width_m * ((double)(i % columns) + 0.5 + x_off) / (double)in_row;
        deployment->nodes[i].y_m = height_m * ((double)row + 0.5 + y_off) / (double)rows;
    }
}

static void lay_rings(struct deployment *deployment, const struct scenario *scenario)
{
    for (size_t i = 0; i < deployment->count; i++) {
        const struct point place = rings_node(scenario, i).place;
        deployment->nodes[i].x_m = place.x_m;
        deployment->nodes[i].y_m = place.y_m;
    }
}

static void lay_strata(struct deployment *deployment, const struct scenario *scenario, uint64_t seed)
{
    const struct scenario_field field = scenario_field(scenario);
    const size_t side = (size_t)scenario->network.grid;
    struct splitmix stream = splitmix_begin(seed, SPLITMIX_DEPLOYMENT);
    for (size_t i = 0; i < deployment->count; i++) {
        struct recorded_node *node = &deployment->nodes[i];
        const size_t row = i / side;
        node->x_m = ((double)(i % side) + splitmix_uniform(&stream)) * (field.width_m / (double)side);
        node->y_m = ((double)row + splitmix_uniform(&stream)) * (field.height_m / (double)side);
    }
}

static int by_id(const void *a, const void *b)
{
    const uint32_t left = ((const struct recorded_node *)a)->id, right = ((const struct recorded_node *)b)->id;
    return (left > right) - (left < right);
}

int deployment_copy(struct deployment *deployment, const struct recorded_node *nodes, size_t count, char *error,
                    size_t error_size)
{
    *deployment = (struct deployment){.nodes = malloc(count * sizeof *nodes + 1), .count = count};
    if (!deployment->nodes) {
        snprintf(error, error_size, "out of memory for %zu nodes", count);
        return -1;
    }
    memcpy(deployment->nodes, nodes, count * sizeof *nodes);
    qsort(deployment->nodes, count, sizeof *nodes, by_id);
    return 0;
}

static int from_file(struct deployment *deployment, const char *path, char *error, size_t error_size)
{
    struct recording recording = {0};
    if (recording_load_nodes(path, &recording, error, error_size)) {
        return -1;
    }
    const int result = deployment_copy(deployment, recording.nodes, recording.node_count, error, error_size);
    recording_free(&recording);
    return result;
}

int deployment_make(struct deployment *deployment, const struct scenario *scenario, uint64_t seed, char *error,
                    size_t error_size)
{
    const struct scenario_field field = scenario_field(scenario);
    if (scenario->network.layout == LAYOUT_FILE) {
        return from_file(deployment, scenario->network.file, error, error_size);
    }
    *deployment = (struct deployment){.count = scenario_nodes(scenario)};
    deployment->nodes = calloc(deployment->count, sizeof *deployment->nodes);
    if (!deployment->nodes) {
        snprintf(error, error_size, "network.nodes: out of memory for %zu nodes", deployment->count);
        return -1;
    }
    for (size_t i = 0; i < deployment->count; i++) {
        deployment->nodes[i].id = (uint32_t)i;
    }
    seed = campaign_deployment_seed(scenario, seed);
    switch (scenario->network.layout) {
    case LAYOUT_UNIFORM:
        for (uint64_t draw = 0; draw == 0 || (draw < DRAWS_MAX && !campaign_suits(scenario, deployment)); draw++) {
            lay_uniform(deployment, field.width_m, field.height_m, seed, draw);
        }
        break;
    case LAYOUT_R2:
        lay_r2(deployment, field.width_m, field.height_m, seed);
        break;
    case LAYOUT_GRID:
        lay_grid(deployment, scenario, seed);
        break;
    case LAYOUT_HASHED:
        lay_hashed(deployment, field.width_m, field.height_m, seed);
        break;
    case LAYOUT_RINGS:
        lay_rings(deployment, scenario);
        break;
    case LAYOUT_STRAT:
        lay_strata(deployment, scenario, seed);
        break;
    case LAYOUT_FILE:
        break;
    }
    if (!campaign_suits(scenario, deployment)) {
        deployment_free(deployment);
        snprintf(error, error_size,
                 "network.starts: no deployment is connected and has %lld nodes farther than network.start_m = %g m "
                 "from the source",
                 (long long)scenario->network.starts, scenario->network.start_m);
        return -1;
    }
    return 0;
}

void deployment_free(struct deployment *deployment)
{
    free(deployment->nodes);
    *deployment = (struct deployment){0};
}

size_t deployment_find(const struct deployment *deployment, uint32_t id)
{
    if (id < deployment->count && deployment->nodes[id].id == id) {
        return id;
    }
    const struct recorded_node key = {.id = id};
    const struct recorded_node *found = bsearch(&key, deployment->nodes, deployment->count, sizeof key, by_id);
    return found ? (size_t)(found - deployment->nodes) : deployment->count;
}
