/* An experiment: the runs of a scenario that the command ships, with settings as --set takes them, and what they measured. */
#ifndef EXPERIMENT_H
#define EXPERIMENT_H

#include "record/metrics.h"
#include "scenario/scenario.h"

struct figures {
    double pooled[METRIC_ERRORS_COUNT]; /* over all estimates of all runs together */
    double mean[METRIC_COUNT];          /* over the runs; NaN for what does not apply ... */
    double sd[METRIC_COUNT];            /* ... and their standard deviation */
    double median[METRIC_COUNT];
    unsigned lost; /* runs whose track was lost */
};

/* The scenario `name` with `settings`, "key=value" with a space between; to be freed. Fails the running test if there is no such thing. */
void experiment_scenario(const char *name, const char *settings, struct scenario *scenario);

/* Run it with so many seeds from `seed` on, on two threads. Fails the running test if a run fails. */
struct figures experiment_from(uint64_t seed, const char *name, const char *settings, unsigned runs);

/* The same from seed 0 on; and print its figures. */
struct figures experiment(const char *name, const char *settings, unsigned runs);

/* Print what was measured and what was expected, and fail the running test unless it is
 * near: |measured / expected - 1| <= share; at_most, at_least: on that side of the bound. */
void expect_near(const char *what, double measured, double expected, double share);
void expect_at_most(const char *what, double measured, double most);
void expect_at_least(const char *what, double measured, double least);

#endif
