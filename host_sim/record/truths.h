/* The true ways of a run's targets, from what the recorder has: straight between sampling instants. */
#ifndef MOTEHOUND_SIM_TRUTHS_H
#define MOTEHOUND_SIM_TRUTHS_H

#include "record/recorder.h"
#include "world/trajectory.h"

/* Target `number` is there at time_s. */
bool truths_present(const struct recorder *recorder, size_t number, double time_s);

/* Where it is then -> *place; before and after its time, where it began and ended. Returns false if there is no such target. Cost: a binary search, and
 * the targets. */
bool truths_at(const struct recorder *recorder, size_t number, double time_s, struct point *place);

/* How far it goes from from_s to to_s; 0 unless that is later. Cost: the instants between. */
double truths_way_m(const struct recorder *recorder, size_t number, double from_s, double to_s);

/* At time_s it has at most 150 m to go, until it or the run ends. Cost: as truths_way_m. */
bool truths_near_end(const struct recorder *recorder, size_t number, double time_s);

#endif
