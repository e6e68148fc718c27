/* Xu et al. over the air: members, heads and the sink as motes of a network, beside the ideal one with the same seeds. */
#include "port.h"
#include "unity.h"
#include "xu.h"

#include <stdio.h>

enum { RUNS = 20, REPORTS = 100 };

void setUp(void) {}
void tearDown(void) {}

static struct figures run(const char *settings)
{
    printf("  xu_real %s\n", settings);
    return experiment_from(0, "xu_real", settings, RUNS);
}

static double rmse(const struct figures *figures) { return figures->pooled[METRIC_POSITION_RMSE_M]; }

/* Both modes draw the same, and the same code works on it. Before the motes know their neighbours a summary or two are on their way for long, so
 * metrics begin after 10 s. */
static void without_loss_nothing_differs(void)
{
    const char *rules[] = {"ci", "sci", "hif", "hif_feedback"};
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++) {
        char settings[200];
        snprintf(settings, sizeof settings, "radio.profile=ideal radio.loss=0 fusion.rule=%s", rules[i]);
        const struct figures air = run(settings);
        snprintf(settings, sizeof settings, "network.ideal=true fusion.rule=%s", rules[i]);
        const struct figures ideal = run(settings);
        expect_near("RMSE over the ideal network's", rmse(&air) / rmse(&ideal), 1, 1e-3);
        expect_near("ANEES over the ideal network's", air.pooled[METRIC_ANEES] / ideal.pooled[METRIC_ANEES], 1, 1e-3);
        expect_near("cluster 4 by itself",
                    air.pooled[METRIC_LOCAL_POSITION_RMSE_M_4] / ideal.pooled[METRIC_LOCAL_POSITION_RMSE_M_4], 1, 1e-3);
        expect_near("summaries", air.mean[METRIC_SUMMARIES], LOCAL_CLUSTERS * REPORTS, 0);
        expect_near("positions", air.mean[METRIC_FUSED], REPORTS, 0);
        expect_at_most("samples late", air.mean[METRIC_MEASUREMENTS_LATE], 0);
    }
}

/* All samples travel to the sink, which has the only track. */
static void one_head_for_all(void)
{
    const struct figures air = run("radio.profile=ideal radio.loss=0 fusion.rule=central");
    const struct figures ideal = run("network.ideal=true fusion.rule=central");
    const struct figures lossy = run("fusion.rule=central");
    expect_near("RMSE over the ideal network's", rmse(&air) / rmse(&ideal), 1, 1e-3);
    expect_near("ANEES over the ideal network's", air.pooled[METRIC_ANEES] / ideal.pooled[METRIC_ANEES], 1, 1e-3);
    expect_near("positions", air.mean[METRIC_ESTIMATES], REPORTS, 0);
    expect_at_most("summaries", air.mean[METRIC_SUMMARIES], 0);
    expect_near("RMSE with collisions and losses", rmse(&lossy) / rmse(&ideal), 1, 0.05);
    expect_near("ANEES with collisions and losses", lossy.pooled[METRIC_ANEES], 4, 0.3);
}

/* Collisions, and 5 % of the frames lost. */
static void over_the_air(void)
{
    const struct figures ci = run(""), hif = run("fusion.rule=hif"), ideal = run("network.ideal=true"),
                         exact = run("network.ideal=true fusion.rule=hif");
    expect_near("CI over the ideal network's", rmse(&ci) / rmse(&ideal), 1, 0.05);
    expect_near("HIF over the ideal network's", rmse(&hif) / rmse(&exact), 1, 0.05);
    expect_near("ANEES of HIF", hif.pooled[METRIC_ANEES], 4, 0.1);
    expect_at_least("share of the summaries that arrive", ci.mean[METRIC_SUMMARIES_TAKEN] / (LOCAL_CLUSTERS * REPORTS),
                    0.95);
    expect_near("positions", ci.mean[METRIC_FUSED], REPORTS, 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_loss_nothing_differs);
    RUN_TEST(one_head_for_all);
    RUN_TEST(over_the_air);
    port_exit(UNITY_END() > 0);
    return 0;
}
