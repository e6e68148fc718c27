/* 81 sensor nodes and a tracker follow a source that drifts through their field and releases 100 g/s of something that
 * diffuses. What passes from the nodes to the tracker would go over a radio; mote_network.c shows that with whole motes. */
#include "motehound/diffusion.h"
#include "motehound/puff.h"
#include "motehound/sensor.h"
#include <stdio.h>

enum { SIDE = 9, NODES = SIDE * SIDE, SPACING_MM = 3000, INTERVAL = 1000, END = 20000 };

static struct mh_vec2 source_at(mh_tick time)
{
    return (struct mh_vec2){2 + (mh_real)time / 1000, 12 + 5 * sinf((mh_real)time / 5000)};
}

/* What the source has released until now, a puff of 10 g every 0.1 s, spread at 1 m2/s; in counts of 0.001 g/m2. */
static int32_t convert(mh_tick now, const struct mh_place *place)
{
    mh_real sum = 0;
    for (mh_tick release = 50; release < now; release += 100) {
        const struct mh_puff puff = {source_at(release), (mh_real)(now - release) / 1000, 10};
        sum += mh_puff_concentration(&puff, 1, mh_place_relative(place, &(struct mh_place){0}), NULL);
    }
    return (int32_t)(1000 * sum);
}

int main(void)
{
    static struct mh_sensor sensors[NODES];
    static struct mh_measurement reports[NODES];
    static struct mh_diffusion track;
    struct mh_diffusion_config config;
    struct mh_interest asked = {.radius_mm = 0};
    struct mh_estimate estimate = {.time = 0};
    /* zero, Q11.20 a count, smallest and largest count, ticks between samples, chi, report always */
    const struct mh_sensor_config sensor = {0, MH_Q20_ONE / 1000, 0, 65535, INTERVAL, MH_Q20(0.2f), false, 0};
    mh_diffusion_config_default(&config);
    mh_tracker_diffusion.init(&track, &config, INTERVAL);
    for (mh_node_id i = 0; i < NODES; i++) {
        mh_sensor_init(&sensors[i], &sensor);
    }
    for (mh_tick now = 0; now <= END; now += INTERVAL) {
        size_t count = 0;
        for (mh_node_id i = 0; i < NODES; i++) {
            const struct mh_place place = {(int32_t)(i % SIDE) * SPACING_MM, (int32_t)(i / SIDE) * SPACING_MM, 0};
            const struct mh_reading reading = {.time = now, .counts = convert(now, &place)};
            struct mh_sample sample;
            /* a node reports what has risen by chi, and whatever it measures where the tracker asked for it */
            if (mh_sensor_take(&sensors[i], &reading, &sample) == MH_OK &&
                (mh_sensor_reports(&sensors[i], &sample, track.tracking) ||
                 mh_place_within(&place, &asked.centre, asked.radius_mm))) {
                const uint8_t flags = sample.has_increment ? MH_MEASUREMENT_HAS_INCREMENT : 0;
                reports[count++] = (struct mh_measurement){i, place, now, sample.value, sample.increment, flags, 0};
            }
        }
        if (mh_tracker_diffusion.step(&track, now, reports, count, &estimate) == MH_OK) {
            const struct mh_place found = mh_place_from_offset(&estimate.origin, estimate.position);
            const struct mh_vec2 source = source_at(now);
            printf("%2u s, %2u reports: source at %5.2f %5.2f m, estimated at %5.2f %5.2f m\n", (unsigned)now / 1000,
                   (unsigned)count, (double)source.x, (double)source.y, found.x_mm / 1e3, found.y_mm / 1e3);
        }
        mh_tracker_diffusion.interest(&track, &asked);
    }
    return estimate.time == END ? 0 : 1;
}
