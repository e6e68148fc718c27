#include "xu.h"

#include <stdio.h>

struct figures xu(const char *scenario, const char *settings)
{
    printf("  %s %s\n", scenario, settings);
    return experiment_from(0, scenario, settings, XU_RUNS);
}

void xu_near(const struct figures *figures, enum metric metric, double expected, double off)
{
    expect_near(metric_names[metric], figures->pooled[metric], expected, off / expected);
}
