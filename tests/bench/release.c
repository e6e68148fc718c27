#include "release.h"

enum { PUFFS = 12, SIDE = 9 };
static const mh_real pitch_m = 0.9f, release_gps = 100.0f;

mh_tick release_time(unsigned step) { return (mh_tick)(step + PUFFS) * RELEASE_INTERVAL; }

static mh_real source_x(unsigned step) { return (mh_real)step + 0.37f; }

/* Luo, Eq. (1) and (2) with one puff a second: the concentration at (x, y) at instant number `step`. */
static mh_real concentration(mh_real x, mh_real y, unsigned step)
{
    mh_real sum = 0;
    for (unsigned age = 1; age <= PUFFS; age++) {
        const mh_real four_dt = 4.0f * (mh_real)age;
        const mh_real dx = x - (source_x(step + PUFFS) - (mh_real)age);
        sum += release_gps / (MH_PI * four_dt) * mh_exp(-(dx * dx + y * y) / four_dt);
    }
    return sum;
}

void release_measurements(unsigned step, struct mh_measurement *measurements)
{
    const mh_real centre_m = source_x(step + PUFFS) - 1.0f;
    const int first_column = (int)(centre_m / pitch_m) - SIDE / 2;
    unsigned count = 0;
    for (mh_real radius_m = 0.5f; radius_m < 5.0f; radius_m += 0.1f) { /* rings outwards */
        for (int i = 0; i < SIDE * SIDE && count < RELEASE_MEASUREMENTS; i++) {
            const int column = first_column + i / SIDE;
            const int row = i % SIDE - SIDE / 2;
            const mh_real x = (mh_real)column * pitch_m;
            const mh_real y = ((mh_real)row + 0.21f) * pitch_m;
            const mh_real distance_m = mh_sqrt((x - centre_m) * (x - centre_m) + y * y);
            if (distance_m > radius_m || distance_m <= radius_m - 0.1f) {
                continue;
            }
            const mh_q20 now = mh_q20_from_real(concentration(x, y, step));
            const mh_q20 before = mh_q20_from_real(concentration(x, y, step - 1));
            if (now - before < MH_Q20(0.25f)) {
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
