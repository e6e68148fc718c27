/* Searches that begin far from the source, several in each deployment (network.starts, network.start_m). */
#ifndef MOTEHOUND_SIM_CAMPAIGN_H
#define MOTEHOUND_SIM_CAMPAIGN_H

#include "world/deployment.h"

#include <stdbool.h>

/* Run `seed` has the deployment of this seed. */
uint64_t campaign_deployment_seed(const struct scenario *scenario, uint64_t seed);

/* All nodes are connected within radio.range_m, and at least network.starts of them are farther than network.start_m from the source's first
 * place; or network.starts is 0. Cost: the square of the nodes. */
bool campaign_suits(const struct scenario *scenario, const struct deployment *deployment);

/* The node at which run `seed` begins, an index: one of the far ones, drawn without replacement over the runs of a deployment; where
 * network.starts is 0, protocol.start. Returns 0, or -1 with one line in `error` where there is no such node or no memory. */
int campaign_start(const struct scenario *scenario, uint64_t seed, const struct deployment *deployment, uint32_t *start,
                   char *error, size_t error_size);

#endif
