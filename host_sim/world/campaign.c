#include "world/campaign.h"

#include "world/recipe.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

uint64_t campaign_deployment_seed(const struct scenario *scenario, uint64_t seed)
{
    return scenario->network.starts > 0 ? seed / (uint64_t)scenario->network.starts : seed;
}

static double apart_m(const struct recorded_node *a, const struct recorded_node *b)
{
    return hypot(a->x_m - b->x_m, a->y_m - b->y_m);
}

/* Who is reached from node 0, in the order in which they are. */
static bool is_connected(const struct deployment *deployment, double range_m)
{
    const size_t count = deployment->count;
    uint32_t *waiting = calloc(count + 1, sizeof *waiting);
    bool *reached = calloc(count + 1, sizeof *reached);
    size_t found = 0;
    if (waiting && reached && count > 0) {
        waiting[found++] = 0;
        reached[0] = true;
        for (size_t next = 0; next < found; next++) {
            for (uint32_t i = 0; i < count; i++) {
                if (!reached[i] && apart_m(&deployment->nodes[waiting[next]], &deployment->nodes[i]) <= range_m) {
                    reached[i] = true;
                    waiting[found++] = i;
                }
            }
        }
    }
    free(waiting);
    free(reached);
    return found == count;
}

static bool is_far(const struct scenario *scenario, const struct recorded_node *node)
{
    const struct waypoint *source = &scenario->source.points[0];
    return hypot(node->x_m - source->x_m, node->y_m - source->y_m) > scenario->network.start_m;
}

bool campaign_suits(const struct scenario *scenario, const struct deployment *deployment)
{
    if (scenario->network.starts == 0) {
        return true;
    }
    int64_t far = 0;
    for (size_t i = 0; i < deployment->count; i++) {
        far += is_far(scenario, &deployment->nodes[i]);
    }
    return far >= scenario->network.starts && is_connected(deployment, scenario->radio.range_m);
}

int campaign_start(const struct scenario *scenario, uint64_t seed, const struct deployment *deployment, uint32_t *start,
                   char *error, size_t error_size)
{
    const uint64_t starts = (uint64_t)scenario->network.starts;
    if (starts == 0) {
        const size_t found = deployment_find(deployment, (uint32_t)scenario->protocol.start);
        if (found == deployment->count) {
            snprintf(error, error_size, "protocol.start: expected a node of the network, found %lld",
                     (long long)scenario->protocol.start);
            return -1;
        }
        *start = (uint32_t)found;
        return 0;
    }
    uint32_t *far = calloc(deployment->count + starts, sizeof *far);
    size_t count = 0;
    if (!far) {
        snprintf(error, error_size, "out of memory");
        return -1;
    }
    for (uint32_t i = 0; i < deployment->count; i++) {
        if (is_far(scenario, &deployment->nodes[i])) {
            far[count++] = i;
        }
    }
    const uint64_t number = seed % starts;
    for (uint64_t k = 0; k <= number; k++) {
        const double u = recipe_uniform(campaign_deployment_seed(scenario, seed), RECIPE_FIRST_HEAD, k);
        const size_t drawn = k + (size_t)(u * (double)(count - k));
        const uint32_t node = far[drawn];
        far[drawn] = far[k];
        far[k] = node;
    }
    *start = far[number];
    free(far);
    return 0;
}
