/* A target walks over a grid of nodes at 4.5 m/s; the nodes nearest to it measure their ranges to 5 m. */
#ifndef RANGING_H
#define RANGING_H

#include "motehound/measurement.h"

enum { RANGING_INTERVAL = 2000, RANGING_FEW = 4, RANGING_MEASUREMENTS = 8, RANGING_MEASUREMENTS_MAX = 12 };

/* Where it is at instant number `step`. */
struct mh_place ranging_target(unsigned step);

/* What the `count` nearest nodes measure at instant number `step`; count 1 to RANGING_MEASUREMENTS_MAX. */
void ranging_measurements(unsigned step, uint8_t count, struct mh_measurement *measurements);

#endif
