/* What goes wrong in a run, with whom and when, as the scenario's faults.* say. A function of the seed, the mote and the time alone: so
 * sensors, radio and network agree without telling each other. */
#ifndef MOTEHOUND_SIM_FAULTS_H
#define MOTEHOUND_SIM_FAULTS_H

#include "engine/random.h"
#include "scenario/scenario.h"

#include <stdbool.h>
#include <stdint.h>

enum fault {
    FAULT_STUCK,
    FAULT_SPIKE,
    FAULT_SATURATE,
    FAULT_BIAS,
    FAULT_DEAD,
    FAULT_REBOOT,
    FAULT_PARTITION,
    FAULT_MUTE,
    FAULT_JAM,
    FAULTS
};

struct faults {
    double every_s;
    struct {
        double share, from_s, until_s; /* within each period of every_s */
    } windows[FAULTS];
    struct random_stream stream;
    double line_x, line_y, line_at; /* the partition: x line_x + y line_y = line_at */
    double jam_x_m, jam_y_m, jam_radius_m;
};

void faults_make(struct faults *faults, const struct scenario *scenario, uint64_t seed);

/* It can happen at all in this run. */
bool faults_include(const struct faults *faults, enum fault fault);

/* It is on at `time_s`, for those whom it hits. */
bool faults_are_on(const struct faults *faults, enum fault fault, double time_s);

/* It is on at `time_s` and hits `mote`: each with the fault's share as probability, drawn anew for every fault and every period. */
bool faults_hit(const struct faults *faults, enum fault fault, double time_s, uint32_t mote);

/* The first time after `time_s` at which it may begin, end, or hit others; HUGE_VAL: none. */
double faults_next_change_s(const struct faults *faults, enum fault fault, double time_s);

/* The partition lies between two places at `time_s`. */
bool faults_part(const struct faults *faults, double time_s, double ax_m, double ay_m, double bx_m, double by_m);

/* A place is jammed at `time_s`. */
bool faults_jam(const struct faults *faults, double time_s, double x_m, double y_m);

#endif
