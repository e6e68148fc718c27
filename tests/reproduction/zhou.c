#include "zhou.h"

#include <math.h>
#include <stdio.h>

struct figures zhou(const char *settings)
{
    printf("  zhou_nominal %s\n", settings);
    return experiment_from(1, "zhou_nominal", settings, ZHOU_SEEDS);
}

static double forgiven(const struct figures *figures, enum metric metric)
{
    return ZHOU_SEEDS < 20 ? 4 * figures->sd[metric] / sqrt(ZHOU_SEEDS) : 0;
}

void zhou_near(const struct figures *figures, enum metric metric, double expected, double share)
{
    expect_near(metric_names[metric], figures->mean[metric], expected, share + forgiven(figures, metric) / expected);
}

void zhou_at_most(const struct figures *figures, enum metric metric, double most)
{
    expect_at_most(metric_names[metric], figures->mean[metric], most + forgiven(figures, metric));
}
