/* How many equal sources of sound there are near a place, and roughly where, from the energies that nodes measure: their intensity x_g on a grid of cells g, and
 * its sum is the number. With a_ig the energy of one source in cell g at node i, e_i = sum_g a_ig x_g and the energies y_i measured, it goes down to the least sum_i e_i / y_i - ln(e_i / y_i),
 * which for small deviations is half the sum of squares of ln(y_i / e_i), by
 *
 *     x_g <- x_g sum_i(a_ig / e_i) / sum_i(a_ig / y_i),
 *
 * the EM algorithm of emission tomography (Shepp and Vardi, IEEE Trans. Medical Imaging 1, 1982): x stays positive, and every update lowers that sum.
 *
 * The grid is a square of MH_COUNT_AREA_M about the mean of the nodes, weighted by energies of up to 16. R being the distance at which one source has the energy 1, a cell is left out
 * where a node is nearer to it than 0.8 R / sqrt(max(energy, 1)), and where fewer than 0.7 of the nodes with an energy of at least 1 are within R than in the cell with most of them: what
 * hears nothing need not be known. Ten updates.
 *
 * With five to six nodes within R the number is right in 98 % and more of two and of three sources on a circle of up to 0.4 R, and they are found to 0.07 R of their centroid; that there is only one is
 * found in 88 %, and a fit of one source tells it better. Work: some 40 MH_COUNT_SIDE^2 divisions a node; stack 4 (MH_COUNT_SIDE^2 + MH_COUNT_NODES_MAX) bytes and registers. */
#ifndef MOTEHOUND_SOURCE_COUNT_H
#define MOTEHOUND_SOURCE_COUNT_H

#if MH_REAL_FIXED
#error "motehound/source_count.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/config.h"
#include "motehound/sound_fix.h"

#define MH_COUNT_AREA_M 120.0f

/* Of the nodes the first MH_COUNT_NODES_MAX are used, which should be the strongest; those of an energy below 1 only say where nothing is.
 * -> places[0 .. *sources), at least one and at most `most`, 1 to MH_SOURCES_MAX; no two are the same. Errors: MH_ERR_ARGUMENT (most, or sound not valid), MH_ERR_NOT_FINITE,
 * MH_ERR_TOO_FEW (no node has an energy of 1), MH_ERR_SINGULAR (no cell is left). */
enum mh_status mh_source_count(const struct mh_sound *sound, const struct mh_heard *heard, size_t count, uint8_t most,
                               struct mh_vec2 *places, uint8_t *sources);

#endif
