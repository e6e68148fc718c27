/* How many equal sources of sound there are near a place, and roughly where, from the energies that nodes measure: their intensity is estimated on a grid of
 * cells by multiplicative updates (maximum likelihood for energies that are spread exponentially, as Lee and Seung, NIPS 13, 2001, with the Itakura-Saito
 * divergence of Fevotte, Bertin and Durrieu, Neural Computation 21, 2009, take it), and its sum is the number.
 *
 * The grid is a square of MH_COUNT_AREA_M about the centre. A cell is left out where a node is nearer to it than 0.8 of the distance at which one source would
 * give the energy that the node measures. Ten updates. Work: MH_COUNT_SIDE^2 x 20 x nodes divisions; stack 4 (MH_COUNT_SIDE^2 + 7 MH_COUNT_NODES_MAX) bytes. */
#ifndef MOTEHOUND_SOURCE_COUNT_H
#define MOTEHOUND_SOURCE_COUNT_H

#include "motehound/config.h"
#include "motehound/geometry.h"
#include "motehound/status.h"

#include <stddef.h>

#define MH_COUNT_AREA_M 120.0f

/* What a node measured: where, and the energy in units of the detection threshold. */
struct mh_heard_sound {
    struct mh_vec2 place;
    mh_real energy;
};

/* `loudness`: energy of one source at 1 m, 1e-3 to 1e9 m2. Of the nodes, 1 and more, the MH_COUNT_NODES_MAX loudest are used, and those of an energy below 0.01 are not.
 * -> places[0 .. *sources), at least one and at most `most`, 1 to MH_SOURCES_MAX. Errors: MH_ERR_ARGUMENT, MH_ERR_NOT_FINITE, MH_ERR_TOO_FEW (no node has an
 * energy of use), MH_ERR_SINGULAR (no cell is left: what is measured does not come from here). */
enum mh_status mh_source_count(mh_real loudness, const struct mh_heard_sound *nodes, size_t count,
                               struct mh_vec2 centre, uint8_t most, struct mh_vec2 *places, uint8_t *sources);

#endif
