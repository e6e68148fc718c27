/* The published experiments with a fusion centre in an ideal network: 100 runs, seeds 0 to 99, of the scenario xu_nominal. Expected figures are those of an
 * independent simulation of the same target, clusters and noise. */
#ifndef XU_H
#define XU_H

#include "experiment.h"

enum { XU_RUNS = 100 };

/* Run a scenario with `settings`, and print them. */
struct figures xu(const char *scenario, const char *settings);

/* What `metric` was, pooled over the runs, against expected +- off. */
void xu_near(const struct figures *figures, enum metric metric, double expected, double off);

#endif
