/* A source that moves along the x axis at 1 m/s and releases 100 g/s into D = 1 m2/s, seen by the nodes of a square grid; computed in float
 * whatever mh_real is. */
#ifndef RELEASE_H
#define RELEASE_H

#include "motehound/measurement.h"

enum { RELEASE_MEASUREMENTS = 20, RELEASE_INTERVAL = 1000 };

/* The measurements of sampling instant number `step`, ordered by node: of those nodes of a grid with this pitch (0.5 to 3 m)
 * whose increment is at least `least`, the RELEASE_MEASUREMENTS that are nearest to where the source was one interval before. */
void release_measurements(unsigned step, float pitch_m, mh_q20 least, struct mh_measurement *measurements);

/* The sampling instant as time. */
mh_tick release_time(unsigned step);

#endif
