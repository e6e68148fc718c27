/* A target walks over a grid of nodes at 4.5 m/s; its eight nearest nodes measure their ranges to 5 m. */
#ifndef RANGING_H
#define RANGING_H

#include "motehound/measurement.h"

enum { RANGING_INTERVAL = 2000, RANGING_MEASUREMENTS = 8 };

/* What is measured at instant number `step`. */
void ranging_measurements(unsigned step, struct mh_measurement measurements[RANGING_MEASUREMENTS]);

#endif
