/* What the nodes of a run read, without a network around it: the world of the simulator, instant by instant. */
#ifndef READINGS_H
#define READINGS_H

#include "motehound/real.h"
#include "scenario/scenario.h"
#include "world/deployment.h"

#include <stdbool.h>

struct readings {
    struct deployment deployment;
    size_t instants;
    struct reading {
        bool came;
        mh_q20 value;  /* with a converter that gives Q11.20 itself */
    } * all;           /* of node i at instant k: [k * deployment.count + i] */
    double *x_m, *y_m; /* where the source is at instant k */
};

/* Those of a run of `scenario`, which has an ideal converter, with `seed`; to be freed. Fails the running test if there is no memory. */
void readings_make(struct readings *readings, const struct scenario *scenario, uint64_t seed);

void readings_free(struct readings *readings);

/* Of node `node` at instant `instant`. */
const struct reading *readings_at(const struct readings *readings, size_t instant, size_t node);

/* The increment of that instant: true if both its readings came. */
bool readings_increment(const struct readings *readings, size_t instant, size_t node, mh_q20 *increment);

#endif
