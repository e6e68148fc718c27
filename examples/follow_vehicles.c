/* Two vehicles drive side by side through a field of microphones, 25 m apart. Every 2 s each node that hears something says how loud. One tracker a vehicle follows it, told where the
 * other one was when it was last saved. */
#include "motehound/acoustic.h"
#include "motehound/random.h"

#include <stdio.h>
#include <string.h>

enum { VEHICLES = 2, ROWS = 10, COLUMNS = 20, INTERVAL_MS = 2000, INSTANTS = 25 };

/* What is kept of a vehicle from one instant to the next, or sent from one mote to the next. */
struct saved {
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length;
};

static struct mh_vec2 place_of(int vehicle, int instant)
{
    const struct mh_vec2 place = {50 + 20 * (mh_real)instant, 130 + 25 * (mh_real)vehicle};
    return place;
}

/* Standard normal, nearly: a sum of twelve uniform numbers. */
static mh_real normal(struct mh_random *random)
{
    mh_real sum = -6;
    for (int i = 0; i < 12; i++) {
        sum += mh_random_unit(random);
    }
    return sum;
}

/* Nodes stand 30 m apart, more or less. Energy falls with the square of the distance; a vehicle is just heard 40 m away. */
static size_t hear(int instant, struct mh_measurement *heard)
{
    struct mh_random deployment, noise;
    size_t count = 0;
    mh_random_init(&deployment, 7);
    mh_random_init(&noise, (uint32_t)instant);
    for (int node = 0; node < ROWS * COLUMNS; node++) {
        const mh_real x = 30 * ((mh_real)(node % COLUMNS) + mh_random_unit(&deployment));
        const mh_real y = 30 * ((mh_real)(node / COLUMNS) + mh_random_unit(&deployment));
        mh_real energy = 0;
        for (int k = 0; k < VEHICLES; k++) {
            const struct mh_vec2 vehicle = place_of(k, instant);
            energy += 1600 / mh_max(mh_squared(x - vehicle.x) + mh_squared(y - vehicle.y), 1);
        }
        energy = energy * mh_exp(0.19f * normal(&noise)) + 0.05f * normal(&noise);
        if (energy >= 1) {
            const struct mh_measurement one = {.node = (mh_node_id)node,
                                               .place = {(int32_t)(1000 * x), (int32_t)(1000 * y), 0},
                                               .time = (mh_tick)instant * INTERVAL_MS,
                                               .value = mh_q20_from_real(energy)};
            heard[count++] = one;
        }
    }
    return count;
}

int main(void)
{
    const struct mh_tracker *tracker = &mh_tracker_acoustic;
    struct mh_acoustic_config config;
    struct saved saved[VEHICLES];
    mh_real squares = 0;
    mh_acoustic_config_default(&config, 40);
    for (int k = 0; k < VEHICLES; k++) {
        /* they are seen to come in, 5 m more or less */
        struct mh_acoustic state;
        const struct mh_place field = {0, 0, 0}, place = mh_place_from_offset(&field, place_of(k, 0));
        const struct mh_vec2 velocity = {8, 0};
        if (tracker->init(&state, &config, INTERVAL_MS) != MH_OK ||
            mh_acoustic_begin(&state, 100 + (uint32_t)k, 0, &place, velocity, 5, 3) != MH_OK ||
            tracker->save(&state, saved[k].bytes, &saved[k].length) != MH_OK) {
            return 1;
        }
    }
    for (int instant = 1; instant <= INSTANTS; instant++) {
        struct mh_measurement heard[ROWS * COLUMNS];
        const size_t count = hear(instant, heard);
        struct saved next[VEHICLES];
        for (int k = 0; k < VEHICLES; k++) {
            const int o = VEHICLES - 1 - k;
            const struct mh_saved_track other = {100 + (uint32_t)o, saved[o].bytes, saved[o].length};
            struct mh_acoustic state;
            struct mh_estimate estimate;
            if (tracker->init(&state, &config, INTERVAL_MS) != MH_OK ||
                tracker->among(&state, 100 + (uint32_t)k, &other, 1) != MH_OK ||
                tracker->load(&state, saved[k].bytes, saved[k].length) != MH_OK ||
                tracker->step(&state, (mh_tick)instant * INTERVAL_MS, heard, count, &estimate) != MH_OK ||
                tracker->save(&state, next[k].bytes, &next[k].length) != MH_OK) {
                return 1;
            }
            const struct mh_vec2 truth = place_of(k, instant);
            const mh_real x = (mh_real)estimate.origin.x_mm * 0.001f + estimate.position.x;
            const mh_real y = (mh_real)estimate.origin.y_mm * 0.001f + estimate.position.y;
            squares += mh_squared(x - truth.x) + mh_squared(y - truth.y);
            if (instant % 5 == 0) {
                printf("%2d s: vehicle %u at (%.1f, %.1f) m, +- %.1f and %.1f m, by %u nodes%s\n",
                       instant * INTERVAL_MS / 1000, (unsigned)estimate.target, (double)x, (double)y,
                       (double)mh_sqrt(estimate.covariance.xx), (double)mh_sqrt(estimate.covariance.yy),
                       (unsigned)estimate.measurements,
                       estimate.flags & MH_ESTIMATE_UNRESOLVED ? "; which is which is not known" : "");
            }
        }
        memcpy(saved, next, sizeof saved);
    }
    printf("off by %.2f m, root mean square; %u bytes a track\n", (double)mh_sqrt(squares / (VEHICLES * INSTANTS)),
           (unsigned)saved[0].length);
    return 0;
}
