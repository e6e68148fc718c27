/* What kinds of radio there are, as data: one table, every number with its source. */
#ifndef MOTEHOUND_SIM_RADIO_PROFILE_H
#define MOTEHOUND_SIM_RADIO_PROFILE_H

#include <stdbool.h>
#include <stddef.h>

enum { RADIO_BACKOFF_STEPS = 5 };

struct radio_profile {
    const char *name;
    /* Without contention a frame goes out at once and nobody disturbs anybody; only bitrate_bps, preamble_bytes and header_bytes count. */
    bool contention;
    double bitrate_bps;
    unsigned preamble_bytes; /* before every frame: preamble, start of frame, length */
    unsigned header_bytes;   /* of the MAC: addresses, number. The check sum is part of the frame that is sent. */
    unsigned ack_bytes;      /* on the air, preamble included */

    /* Carrier sense: wait for least_units + (0 ... 2^exponent - 1) backoff units, exponent from backoff_exponents[k] at the k-th try (the last
     * one for all further tries); assess the channel; if it is free, turn the radio round and send. */
    double backoff_unit_us;
    unsigned least_units;
    unsigned backoff_exponents[RADIO_BACKOFF_STEPS];
    unsigned backoffs; /* after the first, when the channel is busy; then the frame is given up */
    double cca_us, turnaround_us;

    /* An acknowledgement follows the frame after ack_turnaround_us; it is waited for ack_wait_us from the end of the frame. */
    double ack_turnaround_us, ack_wait_us;
    unsigned retries; /* further transmissions of a frame that is not acknowledged */

    double sensitivity_dbm;  /* weakest frame that is received */
    double noise_margin_db;  /* noise floor, below the sensitivity */
    double capture_db;       /* a frame survives noise and interference that are together so much weaker */
    double cca_threshold_db; /* above the sensitivity: average power in a channel that is busy */
};

/* Air time of `bytes` bytes on the air, in microseconds, rounded to the nearest. */
unsigned radio_profile_air_us(const struct radio_profile *profile, size_t bytes);

/* The profile called `name`: `ideal`, `802154` or `cc1000`; NULL if there is none. */
const struct radio_profile *radio_profile_find(const char *name);

#endif
