/* A source that moves along the x axis at 1 m/s and releases 100 g/s into D = 1 m2/s, seen by the nodes of a square grid. */
#ifndef RELEASE_H
#define RELEASE_H

#include "motehound/measurement.h"

enum { RELEASE_MEASUREMENTS = 20, RELEASE_INTERVAL = 1000 };

/* The measurements of sampling instant number `step` from the RELEASE_MEASUREMENTS nodes with an increment above chi = 0.2 g/m2 that
 * are nearest to where the source was one interval before, ordered by node. */
void release_measurements(unsigned step, struct mh_measurement *measurements);

/* The sampling instant as time. */
mh_tick release_time(unsigned step);

#endif
