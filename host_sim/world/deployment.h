/* Where the nodes stand. */
#ifndef MOTEHOUND_SIM_DEPLOYMENT_H
#define MOTEHOUND_SIM_DEPLOYMENT_H

#include "scenario/recording.h"
#include "scenario/scenario.h"

#include <stddef.h>
#include <stdint.h>

/* Ordered by id, each id once. */
struct deployment {
    struct recorded_node *nodes;
    size_t count;
};

/* Lay out the nodes of scenario->network; ids are 0, 1, 2 ... but for LAYOUT_FILE, which brings its own.
 *
 * uniform: node i = (width u_2i, height u_2i+1), u from the SplitMix64 stream of `seed`; where the deployment does not suit a campaign
 *   (campaign.h), the next numbers of the stream are taken, and so on.
 * r2: node i = (width, height) * frac(1/2 + (i + 1 + 1000 seed) * (0.7548776662466927, 0.5698402909980532)), Roberts' R2 sequence.
 * grid: cell-centred, row by row, each coordinate off the middle of its cell by up to network.jitter of the cell's side (uniform; u_2i and
 *   u_2i+1 of the same stream). Cells are squares of network.spacing_m, as many in a row as the field is wide, or fill the field: the number of columns divides the number of nodes, so that the cells are as square as can be (of
 *   two equally square ones the one with fewer columns: 32 x 40 for 1,280 in a square). Where that leaves cells longer than
 *   2 : 1 they are made square and the last row has fewer nodes, evenly spread.
 * hashed: node i = (width U(seed, 1, i), height U(seed, 2, i)) of recipe.h.
 * rings: as clusters.h says.
 * strat: network.grid x network.grid cells that fill the field, row by row, one node uniform in each: x, then y of splitmix.h.
 * file: the nodes of scenario->network.file, sorted.
 *
 * With network.starts the seed is that of the campaign's deployment. Returns 0, or -1 with one line in `error` (a file that cannot be used, no
 * deployment that suits, no memory) and nothing to free. */
int deployment_make(struct deployment *deployment, const struct scenario *scenario, uint64_t seed, char *error,
                    size_t error_size);

/* A copy of `nodes`, sorted by id. Returns as deployment_make. */
int deployment_copy(struct deployment *deployment, const struct recorded_node *nodes, size_t count, char *error,
                    size_t error_size);

void deployment_free(struct deployment *deployment);

/* Index of node `id`, or deployment->count if there is none. O(1) where ids are 0, 1, 2 ..., else O(log n). */
size_t deployment_find(const struct deployment *deployment, uint32_t id);

#endif
