/* How a search for a source of gas went, from what the recorder has. */
#ifndef MOTEHOUND_SIM_SEARCH_H
#define MOTEHOUND_SIM_SEARCH_H

#include "record/recorder.h"
#include "scenario/scenario.h"

struct search {
    bool converged;           /* the estimates of the last protocol.calm heads were calm */
    double error_m;           /* of the last estimate, infinite where there is none; so below */
    double rate_error;        /* as a share of the true rate; NaN where nothing is released */
    double crlb_m, rate_crlb; /* of the samples that were heard; NaN without noise */
    size_t heads, sensors;    /* the latter each once */
    double sensors_to_10m;    /* heard when the error fell below 10 m for good; NaN: it never did */
};

struct search search_of(const struct recorder *recorder, const struct scenario *scenario);

#endif
