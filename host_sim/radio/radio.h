/* The radio: who hears a frame, and when.
 *
 * A unit disc: every node within range hears a broadcast, the addressee alone is handed a unicast. A frame takes one hop's delay and its
 * air time; each receiver loses it independently. Nothing collides: a frame is in flight from radio_send to
 * radio_land, where a model of interference would decide what its receivers make of it.
 *
 * Receivers are found through a grid of cells, so a frame costs time in the nodes about its range, not in the network's size. */
#ifndef MOTEHOUND_SIM_RADIO_H
#define MOTEHOUND_SIM_RADIO_H

#include "engine/event_queue.h"
#include "engine/random.h"
#include "motehound/config.h"

#include <stddef.h>
#include <stdint.h>

/* Preamble, start of frame and length of IEEE 802.15.4, sent before every frame. */
#define RADIO_HEADER_BYTES 6

#define RADIO_ALL UINT32_MAX

struct radio_config {
    double range_m; /* HUGE_VAL: all hear all */
    double delay_s, bitrate_bps, loss;
};

struct radio_frame {
    uint64_t number;              /* of the transmission, from 0 */
    uint32_t sender, destination; /* index of a place, or RADIO_ALL */
    size_t length;
    uint8_t bytes[MH_FRAME_MAX];
};

/* A place, kept in the order of the cells. */
struct radio_place {
    double x_m, y_m;
    uint32_t index;
};

struct radio {
    struct radio_config config;
    struct random_stream loss_stream;
    size_t count;
    struct radio_place *sorted;
    uint32_t *position; /* of place i in `sorted` */
    double x_min_m, y_min_m, cell_m;
    size_t columns, rows;
    size_t *cell_start; /* columns x rows + 1 */
    struct radio_frame *flights;
    uint32_t *free_flights;
    size_t flights_capacity, free_count;
    uint64_t sent, received, lost; /* received and lost: once per receiver */
};

/* Places 0 ... count - 1; each finite. Returns 0, or -1 if there is no memory (nothing to free). */
int radio_make(struct radio *radio, const struct radio_config *config, const double *x_m, const double *y_m,
               size_t count, uint64_t seed);

void radio_free(struct radio *radio);

/* Put a frame of at most MH_FRAME_MAX bytes on the air; radio_land is to be called with *flight, `*takes` later. Returns 0, or -1 if
 * there is no memory. */
int radio_send(struct radio *radio, uint32_t sender, uint32_t destination, const uint8_t *bytes, size_t length,
               uint32_t *flight, sim_time *takes);

/* The frame has arrived: `receive` is called for everyone who hears it, and may send. */
void radio_land(struct radio *radio, uint32_t flight,
                void (*receive)(void *context, uint32_t receiver, const uint8_t *bytes, size_t length), void *context);

#endif
