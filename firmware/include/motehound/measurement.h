/* What a sensor node contributes at one sampling instant, self-contained: the head needs no table of nodes; and whom a head asks
 * for it. */
#ifndef MOTEHOUND_MEASUREMENT_H
#define MOTEHOUND_MEASUREMENT_H

#include "motehound/geometry.h"
#include "motehound/real.h"
#include "motehound/ticks.h"

#include <stddef.h>

typedef uint32_t mh_node_id;

enum {
    MH_MEASUREMENT_HAS_INCREMENT = 1, /* the sample one interval before was really taken */
    MH_MEASUREMENT_ASKED = 2          /* reported only because a head asked */
};

/* Targets that stand for what an anemometer measures: the wind blows so fast towards +x and towards +y, m/s. */
enum { MH_TARGET_WIND_X = 254, MH_TARGET_WIND_Y = 255 };

struct mh_measurement {
    mh_node_id node;
    struct mh_place place; /* of the node */
    mh_tick time;          /* when the sample was taken */
    mh_q20 value;          /* the sample: concentration in g/m2, range in m, ... */
    mh_q20 increment;      /* value - value one interval before, Eq. (8)/(13) of Luo; 0 unless flagged */
    uint8_t flags;         /* MH_MEASUREMENT_* */
    uint8_t target;        /* which target was measured where a sensor can tell, else 0 */
};

/* The nodes around a place, within a horizontal distance. */
struct mh_interest {
    struct mh_place centre;
    uint32_t radius_mm;
};

/* Mean place of the nodes that measured, relative to `origin`; count >= 1. */
static inline struct mh_vec2 mh_centroid(const struct mh_measurement *measurements, size_t count,
                                         const struct mh_place *origin)
{
    struct mh_place_sum sum = {0, 0};
    for (size_t i = 0; i < count; i++) {
        mh_place_sum_add(&sum, &measurements[i].place, origin);
    }
    return mh_place_sum_mean(&sum, (int32_t)count);
}

#endif
