/* Motes that do nothing but keep the network's time, on drifting clocks and a lossy radio of the test's own. */
#ifndef CLOCK_NETWORK_H
#define CLOCK_NETWORK_H

#include "motehound/clock.h"
#include "world/local_clock.h"

enum { CLOCK_MOTES_MAX = 128 };

struct clock_case {
    uint32_t motes;    /* in a line; mote 0 is the root, with an ideal clock */
    uint32_t reach;    /* motes to either side that hear a frame */
    double backoff_us; /* a frame is on the air up to this later than it was handed over; 0: never */
    double loss;       /* probability that one of them loses it */
    double drift_ppm, wander_ppm, offset_s;
    double duration_s, settle_s;
    mh_tick period, wait;
    uint64_t seed;
};

struct clock_network {
    struct clock_case c;
    struct clock_mote {
        struct mh_clock clock;
        struct local_clock local;
        bool dead;
        int64_t ends; /* when its frame on the air ends; negative: none */
        mh_sync_t frame;
    } motes[CLOCK_MOTES_MAX];
    struct mh_clock_config root, other;
    int64_t now;
    uint64_t draws;
    uint64_t frames;
    /* called before each tick of a second; may be NULL */
    void (*second)(struct clock_network *network, int64_t second);
};

void clock_network_make(struct clock_network *network, const struct clock_case *c);

/* Until `end_s`. errors_ms (room for one a mote and second; may be NULL) gets the magnitudes of the error of motes 1 ... in the middle of
 * the tick at each second after the settling time, motes_of_errors their motes. Returns how many. */
size_t clock_network_run(struct clock_network *network, double end_s, double *errors_ms, uint32_t *motes_of_errors);

/* Mote's network time less the true one, in ms, in the middle of the tick of `now`. */
double clock_network_error_ms(const struct clock_network *network, uint32_t mote, int64_t now);

/* The share-th quantile; sorts. */
double clock_quantile(double *values, size_t count, double share);

#endif
