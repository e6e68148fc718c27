/* What no tracker and no protocol can undercut in a run, from its scenario and seed alone: the same in an ideal network and in a real one. */
#ifndef MOTEHOUND_SIM_BOUNDS_H
#define MOTEHOUND_SIM_BOUNDS_H

#include "scenario/scenario.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BOUNDS_LOCAL = 4 };

struct bounds {
    bool apply;    /* the sensors measure ranges of a source; else there is nothing below */
    bool follow;   /* ... and are not in fixed clusters, which hand over nothing: what was to be known in hindsight */
    double pcrb_m; /* of the position, from sample metrics.skip_first on (pcrb.h); NaN unless the source walks as
                      mobility.h says and its true distance decides who detects it */
    /* Of fixed clusters pcrb_m is the posterior bound of pcrb_fixed.h and ccrb_m the one along the run's own path, of all nodes and of each of the first
     * clusters by itself; NaN for others. */
    double ccrb_m, local_ccrb_m[BOUNDS_LOCAL];
    uint64_t hand_overs; /* between heads that sense the target at every sample (hindsight.h) */
    uint64_t reports;    /* that follow it within tracker.tolerance_m */
    bool heard;          /* the sensors hear targets */
    double
        fix_crlb_m; /* then the bound of fix_bound.h from all nodes that detect a target, root mean square over the sampling instants at which
                            they determine the places of all targets */
};

/* Returns 0, or -1 with one line in `error`: as deployment_make and trajectory_make. Cost: nodes x samples. */
int bounds_of(const struct scenario *scenario, uint64_t seed, struct bounds *bounds, char *error, size_t error_size);

#endif
