#include "radio/air.h"

#include <math.h>
#include <stdlib.h>

#define NONE UINT32_MAX

int air_make(struct air *air, const struct places *places, double reach_m, sim_time keep)
{
    *air = (struct air){.places = places, .free = NONE, .reach_m = reach_m, .keep = keep};
    const double width = (double)places->columns * places->cell_m, height = (double)places->rows * places->cell_m;
    const double smallest = fmax(width, height) / sqrt((double)places->count);
    air->cell_m = fmax(reach_m, smallest);
    air->columns = (size_t)(width / air->cell_m) + 1;
    air->rows = (size_t)(height / air->cell_m) + 1;
    air->cells = malloc(air->columns * air->rows * sizeof *air->cells);
    if (!air->cells) {
        return -1;
    }
    for (size_t i = 0; i < air->columns * air->rows; i++) {
        air->cells[i] = NONE;
    }
    return 0;
}

void air_free(struct air *air)
{
    free(air->flights);
    free(air->cells);
    *air = (struct air){0};
}

static size_t column_of(const struct air *air, const struct place *place)
{
    return (size_t)((place->x_m - air->places->x_min_m) / air->cell_m);
}

static size_t row_of(const struct air *air, const struct place *place)
{
    return (size_t)((place->y_m - air->places->y_min_m) / air->cell_m);
}

static int grow(struct air *air)
{
    const size_t capacity = air->capacity ? 2 * air->capacity : 64;
    struct flight *flights = realloc(air->flights, capacity * sizeof *flights);
    if (!flights) {
        return -1;
    }
    air->flights = flights;
    for (size_t i = capacity; i-- > air->capacity;) {
        flights[i].next = air->free;
        air->free = (uint32_t)i;
    }
    air->capacity = capacity;
    return 0;
}

int air_put(struct air *air, const struct flight *what, uint32_t *index)
{
    if (air->free == NONE && grow(air)) {
        return -1;
    }
    *index = air->free;
    struct flight *flight = &air->flights[*index];
    air->free = flight->next;
    const struct place *sender = places_at(air->places, what->sender);
    uint32_t *cell = &air->cells[row_of(air, sender) * air->columns + column_of(air, sender)];
    *flight = *what;
    flight->next = *cell;
    *cell = *index;
    return 0;
}

/* What is forgotten leaves the list on the way. */
static size_t find_in_cell(struct air *air, uint32_t *cell, const struct place *place, sim_time from, sim_time now,
                           uint32_t *found, size_t capacity, size_t count)
{
    for (uint32_t *link = cell; *link != NONE;) {
        const uint32_t index = *link;
        struct flight *flight = &air->flights[index];
        if (flight->end + air->keep < now) {
            *link = flight->next;
            flight->next = air->free;
            air->free = index;
            continue;
        }
        if (flight->start < now && flight->end > from &&
            place_distance_sq(place, places_at(air->places, flight->sender)) <= air->reach_m * air->reach_m) {
            if (count < capacity) {
                found[count] = index;
            }
            count++;
        }
        link = &flight->next;
    }
    return count;
}

size_t air_find(struct air *air, const struct place *place, sim_time from, sim_time now, uint32_t *found,
                size_t capacity)
{
    const size_t column = column_of(air, place), row = row_of(air, place);
    const size_t last_column = column + 1 < air->columns ? column + 1 : column;
    const size_t last_row = row + 1 < air->rows ? row + 1 : row;
    size_t count = 0;
    for (size_t r = row > 0 ? row - 1 : 0; r <= last_row; r++) {
        for (size_t c = column > 0 ? column - 1 : 0; c <= last_column; c++) {
            count = find_in_cell(air, &air->cells[r * air->columns + c], place, from, now, found, capacity, count);
        }
    }
    return count;
}
