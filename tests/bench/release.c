#include "release.h"

#include <math.h>

enum { TRAIL_S = 12, PUFFS_PER_S = 4, SIDE = 9 };
static const float release_gps = 100.0f, ring_m = 0.1f;

mh_tick release_time(unsigned step) { return (mh_tick)(step + TRAIL_S) * RELEASE_INTERVAL; }

static float source_x(unsigned step) { return (float)(step + TRAIL_S) + 0.37f; }

/* Luo, Eq. (1), the integral by midpoints: the concentration at (x, y) at instant number `step`. */
static float concentration(float x, float y, unsigned step)
{
    float sum = 0;
    for (unsigned i = 0; i < TRAIL_S * PUFFS_PER_S; i++) {
        const float age_s = ((float)i + 0.5f) / (float)PUFFS_PER_S;
        const float dx = x - (source_x(step) - age_s);
        sum += release_gps / (float)PUFFS_PER_S / (3.14159265f * 4.0f * age_s) *
               (float)expf(-(dx * dx + y * y) / (4.0f * age_s));
    }
    return sum;
}

static mh_q20 q20_of(float c) { return (mh_q20)(c * 1048576.0f + 0.5f); }

void release_measurements(unsigned step, float pitch_m, mh_q20 least, struct mh_measurement *measurements)
{
    const float centre_m = source_x(step) - 1.0f;
    const int first_column = (int)(centre_m / pitch_m) - SIDE / 2;
    unsigned count = 0;
    for (float radius_m = ring_m; radius_m < SIDE / 2 * pitch_m; radius_m += ring_m) { /* rings outwards */
        for (int i = 0; i < SIDE * SIDE && count < RELEASE_MEASUREMENTS; i++) {
            const int column = first_column + i / SIDE;
            const int row = i % SIDE - SIDE / 2;
            const float x = (float)column * pitch_m;
            const float y = ((float)row + 0.21f) * pitch_m;
            const float distance_m = (float)sqrtf((x - centre_m) * (x - centre_m) + y * y);
            if (distance_m > radius_m || distance_m <= radius_m - ring_m) {
                continue;
            }
            const mh_q20 now = q20_of(concentration(x, y, step));
            const mh_q20 before = q20_of(concentration(x, y, step - 1));
            if (now - before < least) {
                continue;
            }
            const struct mh_measurement measurement = {
                .node = (mh_node_id)(column * SIDE + row + SIDE / 2),
                .place = {(int32_t)(x * 1000.0f), (int32_t)(y * 1000.0f), 0},
                .time = release_time(step),
                .value = now,
                .increment = now - before,
                .flags = MH_MEASUREMENT_HAS_INCREMENT,
            };
            unsigned at = count++;
            for (; at > 0 && measurements[at - 1].node > measurement.node; at--) {
                measurements[at] = measurements[at - 1];
            }
            measurements[at] = measurement;
        }
    }
}
