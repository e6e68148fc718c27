/* Where the radios stand, in a grid of cells, so that those near a point are found in time that depends on their number alone. */
#ifndef MOTEHOUND_SIM_RADIO_PLACES_H
#define MOTEHOUND_SIM_RADIO_PLACES_H

#include <stddef.h>
#include <stdint.h>

struct place {
    double x_m, y_m;
    uint32_t index;
};

struct places {
    size_t count;
    struct place *sorted; /* in the order of the cells, row by row */
    uint32_t *position;   /* of place i in `sorted` */
    double x_min_m, y_min_m, cell_m;
    size_t columns, rows;
    size_t *cell_start; /* columns x rows + 1 */
};

/* Places 0 ... count - 1, each finite, for questions about discs of `radius_m` (HUGE_VAL is allowed). Returns 0, or -1 if
 * there is no memory (nothing to free). */
int places_make(struct places *places, const double *x_m, const double *y_m, size_t count, double radius_m);

void places_free(struct places *places);

static inline const struct place *places_at(const struct places *places, uint32_t index)
{
    return &places->sorted[places->position[index]];
}

static inline double place_distance_sq(const struct place *a, const struct place *b)
{
    const double dx = a->x_m - b->x_m, dy = a->y_m - b->y_m;
    return dx * dx + dy * dy;
}

/* The places within `radius_m` of place `index`, itself left out, into `found`, which has room for all. Returns their
 * number. Cost: the places of the cells that the disc's bounding square touches. */
size_t places_within(const struct places *places, uint32_t index, double radius_m, uint32_t *found);

#endif
