/* The published experiments with ranged targets in an ideal network: two hours, seeds 1 to 20, of the scenario zhou_nominal. Expected figures are
 * those of an independent simulation of the same places, walks and ranges; means over the seeds. */
#ifndef ZHOU_H
#define ZHOU_H

#include "experiment.h"

/* Sanitizers take ten times as long: then fewer seeds, and what these differ from the others by chance is forgiven, four standard errors. */
#ifdef __SANITIZE_ADDRESS__
enum { ZHOU_SEEDS = 3 };
#else
enum { ZHOU_SEEDS = 20 };
#endif

/* Run it with `settings`, and print them. */
struct figures zhou(const char *settings);

/* What `metric` was, against what is expected: see expect_near() and expect_at_most(). */
void zhou_near(const struct figures *figures, enum metric metric, double expected, double share);
void zhou_at_most(const struct figures *figures, enum metric metric, double most);

#endif
