#include "radio/radio.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static size_t column_of(const struct radio *radio, double x_m)
{
    return (size_t)fmin(fmax((x_m - radio->x_min_m) / radio->cell_m, 0), (double)(radio->columns - 1));
}

static size_t row_of(const struct radio *radio, double y_m)
{
    return (size_t)fmin(fmax((y_m - radio->y_min_m) / radio->cell_m, 0), (double)(radio->rows - 1));
}

/* Half a range wide, but never so small that there are many more cells than places. */
static void size_grid(struct radio *radio, const double *x_m, const double *y_m)
{
    double x_max = -HUGE_VAL, y_max = -HUGE_VAL;
    radio->x_min_m = radio->y_min_m = HUGE_VAL;
    for (size_t i = 0; i < radio->count; i++) {
        radio->x_min_m = fmin(radio->x_min_m, x_m[i]);
        radio->y_min_m = fmin(radio->y_min_m, y_m[i]);
        x_max = fmax(x_max, x_m[i]);
        y_max = fmax(y_max, y_m[i]);
    }
    const double width = x_max - radio->x_min_m, height = y_max - radio->y_min_m;
    const double smallest = fmax(fmax(width, height) / sqrt((double)radio->count), 1e-3);
    radio->cell_m = fmax(0.5 * radio->config.range_m, smallest);
    radio->columns = (size_t)(width / radio->cell_m) + 1;
    radio->rows = (size_t)(height / radio->cell_m) + 1;
}

/* Counting sort of the places by cell. */
static void fill_grid(struct radio *radio, const double *x_m, const double *y_m)
{
    const size_t cells = radio->columns * radio->rows;
    for (size_t i = 0; i < radio->count; i++) {
        radio->cell_start[row_of(radio, y_m[i]) * radio->columns + column_of(radio, x_m[i]) + 1]++;
    }
    for (size_t c = 0; c < cells; c++) {
        radio->cell_start[c + 1] += radio->cell_start[c];
    }
    for (size_t i = radio->count; i-- > 0;) {
        const size_t cell = row_of(radio, y_m[i]) * radio->columns + column_of(radio, x_m[i]);
        const size_t at = --radio->cell_start[cell + 1];
        radio->sorted[at] = (struct radio_place){x_m[i], y_m[i], (uint32_t)i};
        radio->position[i] = (uint32_t)at;
    }
    /* Each entry has moved down to the start of its cell, one place to the right of where it belongs. */
    memmove(radio->cell_start, radio->cell_start + 1, cells * sizeof *radio->cell_start);
    radio->cell_start[cells] = radio->count;
}

int radio_make(struct radio *radio, const struct radio_config *config, const double *x_m, const double *y_m,
               size_t count, uint64_t seed)
{
    *radio = (struct radio){.config = *config, .loss_stream = random_stream(seed, RANDOM_RADIO_LOSS), .count = count};
    size_grid(radio, x_m, y_m);
    radio->sorted = malloc(count * sizeof *radio->sorted);
    radio->position = malloc(count * sizeof *radio->position);
    radio->cell_start = calloc(radio->columns * radio->rows + 1, sizeof *radio->cell_start);
    if (!radio->sorted || !radio->position || !radio->cell_start) {
        radio_free(radio);
        return -1;
    }
    fill_grid(radio, x_m, y_m);
    return 0;
}

void radio_free(struct radio *radio)
{
    free(radio->sorted);
    free(radio->position);
    free(radio->cell_start);
    free(radio->flights);
    free(radio->free_flights);
    *radio = (struct radio){0};
}

static int grow(struct radio *radio)
{
    const size_t capacity = radio->flights_capacity ? 2 * radio->flights_capacity : 256;
    struct radio_frame *flights = realloc(radio->flights, capacity * sizeof *flights);
    if (!flights) {
        return -1;
    }
    radio->flights = flights;
    uint32_t *free_flights = realloc(radio->free_flights, capacity * sizeof *free_flights);
    if (!free_flights) {
        return -1;
    }
    radio->free_flights = free_flights;
    for (size_t i = capacity; i-- > radio->flights_capacity;) {
        free_flights[radio->free_count++] = (uint32_t)i;
    }
    radio->flights_capacity = capacity;
    return 0;
}

int radio_send(struct radio *radio, uint32_t sender, uint32_t destination, const uint8_t *bytes, size_t length,
               uint32_t *flight, sim_time *takes)
{
    if (radio->free_count == 0 && grow(radio)) {
        return -1;
    }
    *flight = radio->free_flights[--radio->free_count];
    struct radio_frame *frame = &radio->flights[*flight];
    *frame =
        (struct radio_frame){.number = radio->sent++, .sender = sender, .destination = destination, .length = length};
    memcpy(frame->bytes, bytes, length);
    const double air_s = 8.0 * (double)(length + RADIO_HEADER_BYTES) / radio->config.bitrate_bps;
    *takes = (sim_time)llround((radio->config.delay_s + air_s) * SIM_TIME_PER_S);
    return 0;
}

static bool hears(const struct radio *radio, const struct radio_place *sender, const struct radio_place *receiver)
{
    const double dx = receiver->x_m - sender->x_m, dy = receiver->y_m - sender->y_m;
    return dx * dx + dy * dy <= radio->config.range_m * radio->config.range_m;
}

static bool gets_through(struct radio *radio, const struct radio_frame *frame, uint32_t receiver)
{
    if (radio->config.loss > 0 &&
        random_uniform(radio->loss_stream, frame->number * radio->count + receiver) < radio->config.loss) {
        radio->lost++;
        return false;
    }
    radio->received++;
    return true;
}

void radio_land(struct radio *radio, uint32_t flight,
                void (*receive)(void *context, uint32_t receiver, const uint8_t *bytes, size_t length), void *context)
{
    const struct radio_frame frame = radio->flights[flight]; /* receivers may send, which may move the flights */
    radio->free_flights[radio->free_count++] = flight;
    const struct radio_place sender = radio->sorted[radio->position[frame.sender]];

    if (frame.destination != RADIO_ALL) {
        if (!hears(radio, &sender, &radio->sorted[radio->position[frame.destination]])) {
            radio->lost++;
        } else if (gets_through(radio, &frame, frame.destination)) {
            receive(context, frame.destination, frame.bytes, frame.length);
        }
        return;
    }
    const double range = radio->config.range_m;
    const size_t first_column = column_of(radio, sender.x_m - range),
                 last_column = column_of(radio, sender.x_m + range);
    const size_t last_row = row_of(radio, sender.y_m + range);
    for (size_t row = row_of(radio, sender.y_m - range); row <= last_row; row++) {
        const size_t *starts = &radio->cell_start[row * radio->columns];
        for (size_t at = starts[first_column]; at < starts[last_column + 1]; at++) {
            const struct radio_place *place = &radio->sorted[at];
            if (place->index != frame.sender && hears(radio, &sender, place) &&
                gets_through(radio, &frame, place->index)) {
                receive(context, place->index, frame.bytes, frame.length);
            }
        }
    }
}
