#include "radio/radio.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What an event is: two bits of kind, thirty of index: a flight; a mote and its power. */
enum { EVENT_BEGIN, EVENT_LAND, EVENT_POWER };

#define EVENT(kind, index) ((uint32_t)(kind) << 30 | (uint32_t)(index))

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
    radio->free_from = calloc(count, sizeof *radio->free_from);
    radio->power = calloc(count, sizeof *radio->power);
    radio->receivers = malloc(count * sizeof *radio->receivers);
    if (!radio->sorted || !radio->position || !radio->cell_start || !radio->free_from || !radio->power ||
        !radio->receivers) {
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
    event_queue_free(&radio->queue);
    free(radio->flights);
    free(radio->free_flights);
    free(radio->free_from);
    free(radio->power);
    free(radio->receivers);
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

static sim_time air_time(const struct radio *radio, size_t length)
{
    const double air_s = 8.0 * (double)(length + RADIO_HEADER_BYTES) / radio->config.bitrate_bps;
    return (sim_time)llround(air_s * SIM_TIME_PER_S);
}

int radio_send(struct radio *radio, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *bytes,
               size_t length, uint8_t cause)
{
    if (radio->free_count == 0 && grow(radio)) {
        return -1;
    }
    const uint32_t flight = radio->free_flights[--radio->free_count];
    struct radio_frame *frame = &radio->flights[flight];
    frame->number = radio->sent++;
    frame->sender = sender;
    frame->destination = destination;
    frame->cause = cause;
    frame->length = (uint8_t)length;
    memcpy(frame->bytes, bytes, length);
    const sim_time begins = time > radio->free_from[sender] ? time : radio->free_from[sender];
    radio->free_from[sender] = begins + air_time(radio, length);
    return event_queue_push(&radio->queue, begins, EVENT(EVENT_BEGIN, flight));
}

int radio_power(struct radio *radio, sim_time time, uint32_t mote, enum radio_power power)
{
    return event_queue_push(&radio->queue, time, EVENT(EVENT_POWER, mote << 2 | power));
}

static bool hears(const struct radio *radio, const struct radio_place *sender, const struct radio_place *receiver)
{
    const double dx = receiver->x_m - sender->x_m, dy = receiver->y_m - sender->y_m;
    return dx * dx + dy * dy <= radio->config.range_m * radio->config.range_m;
}

static bool gets_through(struct radio *radio, const struct radio_frame *frame, uint32_t receiver)
{
    enum loss_reason reason;
    if (radio->power[receiver] != RADIO_POWER_ON) {
        reason = radio->power[receiver] == RADIO_POWER_OFF ? LOSS_DEAD : LOSS_ASLEEP;
    } else if (radio->config.loss > 0 &&
               random_uniform(radio->loss_stream, frame->number * radio->count + receiver) < radio->config.loss) {
        reason = LOSS_RANDOM;
    } else {
        radio->received++;
        return true;
    }
    radio->lost[reason]++;
    return false;
}

static uint32_t receivers_in_range(struct radio *radio, const struct radio_frame *frame)
{
    const struct radio_place sender = radio->sorted[radio->position[frame->sender]];
    const double range = radio->config.range_m;
    const size_t first_column = column_of(radio, sender.x_m - range),
                 last_column = column_of(radio, sender.x_m + range);
    const size_t last_row = row_of(radio, sender.y_m + range);
    uint32_t count = 0;
    for (size_t row = row_of(radio, sender.y_m - range); row <= last_row; row++) {
        const size_t *starts = &radio->cell_start[row * radio->columns];
        for (size_t at = starts[first_column]; at < starts[last_column + 1]; at++) {
            const struct radio_place *place = &radio->sorted[at];
            if (place->index != frame->sender && hears(radio, &sender, place) &&
                gets_through(radio, frame, place->index)) {
                radio->receivers[count++] = place->index;
            }
        }
    }
    return count;
}

static uint32_t addressee_in_range(struct radio *radio, const struct radio_frame *frame)
{
    const struct radio_place *places = radio->sorted;
    if (!hears(radio, &places[radio->position[frame->sender]], &places[radio->position[frame->destination]])) {
        radio->lost[LOSS_RANGE]++;
        return 0;
    }
    radio->receivers[0] = frame->destination;
    return gets_through(radio, frame, frame->destination);
}

static void free_flight(struct radio *radio, uint32_t flight) { radio->free_flights[radio->free_count++] = flight; }

static int begin(struct radio *radio, sim_time time, uint32_t flight, const struct radio_sink *sink)
{
    const struct radio_frame *frame = &radio->flights[flight];
    if (radio->power[frame->sender] == RADIO_POWER_OFF) {
        free_flight(radio, flight);
        return 0;
    }
    sink->on_air(sink->context, time, frame->sender, frame->destination, frame->bytes, frame->length);
    if (sink->state) {
        sink->state(sink->context, time, frame->sender, RADIO_TRANSMIT, frame->cause);
    }
    return event_queue_push(&radio->queue, time + air_time(radio, frame->length), EVENT(EVENT_LAND, flight));
}

static enum radio_state at_rest(const struct radio *radio, uint32_t mote)
{
    static const enum radio_state states[] = {RADIO_LISTEN, RADIO_SLEEP, RADIO_OFF};
    return states[radio->power[mote]];
}

static void land(struct radio *radio, sim_time time, uint32_t flight, const struct radio_sink *sink)
{
    const struct radio_frame *frame = &radio->flights[flight];
    const bool to_all = frame->destination == RADIO_ALL;
    free_flight(radio, flight);
    if (radio->power[frame->sender] == RADIO_POWER_OFF) {
        return; /* cut off in the middle */
    }
    const uint32_t count = to_all ? receivers_in_range(radio, frame) : addressee_in_range(radio, frame);
    if (sink->state) {
        sink->state(sink->context, time, frame->sender, at_rest(radio, frame->sender), 0);
    }
    if (count > 0) {
        sink->heard(sink->context, time, frame->bytes, frame->length, radio->receivers, count);
    }
    sink->sent(sink->context, time, frame->sender, to_all || count > 0 ? MH_SENT_OK : MH_SENT_NO_ACK);
}

static void switch_power(struct radio *radio, sim_time time, uint32_t mote, uint8_t power,
                         const struct radio_sink *sink)
{
    radio->power[mote] = power;
    if (sink->state) {
        sink->state(sink->context, time, mote, at_rest(radio, mote), 0);
    }
}

sim_time radio_next(const struct radio *radio) { return event_queue_next(&radio->queue); }

int radio_run(struct radio *radio, sim_time until, const struct radio_sink *sink)
{
    int result = 0;
    struct event event;
    while (result == 0 && event_queue_next(&radio->queue) < until && event_queue_pop(&radio->queue, &event)) {
        const uint32_t index = event.content & UINT32_C(0x3FFFFFFF);
        switch (event.content >> 30) {
        case EVENT_BEGIN:
            result = begin(radio, event.time, index, sink);
            break;
        case EVENT_LAND:
            land(radio, event.time, index, sink);
            break;
        case EVENT_POWER:
            switch_power(radio, event.time, index >> 2, index & 3, sink);
            break;
        default:
            break;
        }
    }
    return result;
}

const uint32_t *radio_order(const struct radio *radio) { return radio->position; }
