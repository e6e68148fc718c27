#include "radio/places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t column_of(const struct places *places, double x_m)
{
    return (size_t)fmin(fmax((x_m - places->x_min_m) / places->cell_m, 0), (double)(places->columns - 1));
}

static size_t row_of(const struct places *places, double y_m)
{
    return (size_t)fmin(fmax((y_m - places->y_min_m) / places->cell_m, 0), (double)(places->rows - 1));
}

/* Half a radius wide, but never so small that there are many more cells than places. */
static void size_grid(struct places *places, const double *x_m, const double *y_m, double radius_m)
{
    double x_max = -HUGE_VAL, y_max = -HUGE_VAL;
    places->x_min_m = places->y_min_m = HUGE_VAL;
    for (size_t i = 0; i < places->count; i++) {
        places->x_min_m = fmin(places->x_min_m, x_m[i]);
        places->y_min_m = fmin(places->y_min_m, y_m[i]);
        x_max = fmax(x_max, x_m[i]);
        y_max = fmax(y_max, y_m[i]);
    }
    const double width = x_max - places->x_min_m, height = y_max - places->y_min_m;
    const double smallest = fmax(fmax(width, height) / sqrt((double)places->count), 1e-3);
    places->cell_m = fmax(0.5 * radius_m, smallest);
    places->columns = (size_t)(width / places->cell_m) + 1;
    places->rows = (size_t)(height / places->cell_m) + 1;
}

/* Counting sort of the places by cell. */
static void fill_grid(struct places *places, const double *x_m, const double *y_m)
{
    const size_t cells = places->columns * places->rows;
    for (size_t i = 0; i < places->count; i++) {
        places->cell_start[row_of(places, y_m[i]) * places->columns + column_of(places, x_m[i]) + 1]++;
    }
    for (size_t c = 0; c < cells; c++) {
        places->cell_start[c + 1] += places->cell_start[c];
    }
    for (size_t i = places->count; i-- > 0;) {
        const size_t cell = row_of(places, y_m[i]) * places->columns + column_of(places, x_m[i]);
        const size_t at = --places->cell_start[cell + 1];
        places->sorted[at] = (struct place){x_m[i], y_m[i], (uint32_t)i};
        places->position[i] = (uint32_t)at;
    }
    /* Each entry has moved down to the start of its cell, one place to the right of where it belongs. */
    memmove(places->cell_start, places->cell_start + 1, cells * sizeof *places->cell_start);
    places->cell_start[cells] = places->count;
}

int places_make(struct places *places, const double *x_m, const double *y_m, size_t count, double radius_m)
{
    *places = (struct places){.count = count};
    size_grid(places, x_m, y_m, radius_m);
    places->sorted = malloc(count * sizeof *places->sorted);
    places->position = malloc(count * sizeof *places->position);
    places->cell_start = calloc(places->columns * places->rows + 1, sizeof *places->cell_start);
    if (!places->sorted || !places->position || !places->cell_start) {
        places_free(places);
        return -1;
    }
    fill_grid(places, x_m, y_m);
    return 0;
}

void places_free(struct places *places)
{
    free(places->sorted);
    free(places->position);
    free(places->cell_start);
    *places = (struct places){0};
}

size_t places_within(const struct places *places, uint32_t index, double radius_m, uint32_t *found)
{
    const struct place *middle = places_at(places, index);
    const size_t first_column = column_of(places, middle->x_m - radius_m),
                 last_column = column_of(places, middle->x_m + radius_m);
    const size_t last_row = row_of(places, middle->y_m + radius_m);
    size_t count = 0;
    for (size_t row = row_of(places, middle->y_m - radius_m); row <= last_row; row++) {
        const size_t *starts = &places->cell_start[row * places->columns];
        for (size_t at = starts[first_column]; at < starts[last_column + 1]; at++) {
            const struct place *place = &places->sorted[at];
            if (place->index != index && place_distance_sq(middle, place) <= radius_m * radius_m) {
                found[count++] = place->index;
            }
        }
    }
    return count;
}
