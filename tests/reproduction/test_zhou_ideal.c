/* Zhou et al. in an ideal network: the nominal experiment with each tracker and election, and what holds at every sample. The
 * figures over speeds, noise and densities are in test_zhou_experiments.c. */
#include "port.h"
#include "simulation.h"
#include "unity.h"
#include "zhou.h"

#include <math.h>
#include <stdio.h>

void setUp(void) {}
void tearDown(void) {}

/* Nothing is random in it but what the recipe gives. */
static void centroid_is_exact(void)
{
    static const struct {
        double density, error, energy_mj;
    } wanted[] = {{8, 0.23657, 0}, {12, 0.18649, 28930}, {16, 0.15978, 0}, {24, 0.12800, 0}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        char settings[100];
        snprintf(settings, sizeof settings, "tracker.name=centroid protocol.election=scm network.density=%g",
                 wanted[i].density);
        const struct figures f = zhou(settings);
        zhou_near(&f, METRIC_LOCALISATION_ERROR_RS, wanted[i].error, 1e-4 / wanted[i].error);
        if (wanted[i].energy_mj > 0) {
            zhou_near(&f, METRIC_ENERGY_MJ, wanted[i].energy_mj, 0.04);
        }
    }
}

static void pftl_where_all_answer(void)
{
    const struct figures f = zhou("tracker.name=pftl protocol.election=scm");
    zhou_near(&f, METRIC_LOCALISATION_ERROR_RS, 0.0526, 0.04);
    zhou_near(&f, METRIC_SINK_ERROR_RS, 0.0621, 0.04);
    zhou_near(&f, METRIC_REPORTS_PER_SAMPLE, 0.553, 0.05);
    zhou_near(&f, METRIC_CLUSTERS, 2638, 0.02);
    zhou_near(&f, METRIC_ENERGY_MJ, 38630, 0.04);
}

static void msl_where_all_answer(void)
{
    const struct figures msl = zhou("tracker.name=msl protocol.election=scm");
    zhou_near(&msl, METRIC_LOCALISATION_ERROR_RS, 0.1044, 0.03);
    zhou_near(&msl, METRIC_ENERGY_MJ, 39080, 0.04);
}

static void small_clusters(void)
{
    const struct figures rho = zhou("tracker.name=pftl protocol.election=rho");
    zhou_near(&rho, METRIC_CLUSTERS, 847, 0.05);
    zhou_near(&rho, METRIC_ENERGY_MJ, 13290, 0.04);
    const struct figures sac = zhou("tracker.name=pftl protocol.election=sac");
    zhou_near(&sac, METRIC_CLUSTERS, 623, 0.05);
    zhou_near(&sac, METRIC_LOCALISATION_ERROR_RS, 0.0772, 0.05);
    zhou_near(&sac, METRIC_ENERGY_MJ, 12350, 0.04);
    expect_at_most("clusters, SAC over RHO", sac.mean[METRIC_CLUSTERS] / rho.mean[METRIC_CLUSTERS], 0.78);
}

static void default_where_all_answer(void)
{
    const struct figures f = zhou("protocol.election=scm");
    zhou_at_most(&f, METRIC_RMSE_OVER_PCRB, 1.15);
    zhou_at_most(&f, METRIC_REPORTS_PER_SAMPLE, 0.39);
    zhou_at_most(&f, METRIC_SINK_ERROR_RS, 0.065);
}

static void default_in_clusters(void)
{
    const struct figures f = zhou("");
    zhou_at_most(&f, METRIC_LOCALISATION_ERROR_RS, 0.056);
    zhou_at_most(&f, METRIC_CLUSTERS, 1.35 * 336);
    zhou_at_most(&f, METRIC_ENERGY_MJ, 11300);
}

/* ---- at every sample ---- */

struct watch {
    double tolerance_m;
    struct mh_estimate last;
    unsigned samples, reports;
};

static void watch_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                           const struct truth *at_time, const struct truth *at_arrival)
{
    struct watch *watch = context;
    (void)time_s;
    (void)head;
    (void)at_time;
    (void)at_arrival;
    const double off_m =
        hypot((double)(estimate->stored.x - estimate->position.x), (double)(estimate->stored.y - estimate->position.y));
    TEST_ASSERT_TRUE(off_m <= watch->tolerance_m * (1 + 1e-5));
    watch->last = *estimate;
    watch->samples++;
    watch->reports += (estimate->flags & MH_ESTIMATE_REFRESHED) != 0;
}

static void watch_sink(void *context, double time_s, const struct mh_estimate *known, const struct truth *at_time)
{
    const struct watch *watch = context;
    (void)time_s;
    (void)at_time;
    TEST_ASSERT_EQUAL_UINT32(watch->last.time, known->time);
    const double x_m = (known->origin.x_mm - watch->last.origin.x_mm) * 1e-3 + (double)known->position.x;
    const double y_m = (known->origin.y_mm - watch->last.origin.y_mm) * 1e-3 + (double)known->position.y;
    TEST_ASSERT_TRUE(hypot(x_m - (double)watch->last.stored.x, y_m - (double)watch->last.stored.y) <= 0.01);
}

/* What is stored is never farther than the tolerance from what was localised, and is what the sink has. */
static void both_ends_know_the_same(void)
{
    const char *trackers[] = {"range", "pftl", "msl", "centroid"};
    const double tolerances_m[] = {0, 1, 5, 20};
    for (size_t i = 0; i < 16; i++) {
        char settings[200], error[300] = "";
        snprintf(settings, sizeof settings, "tracker.name=%s tracker.tolerance_m=%g source.duration_s=2000",
                 trackers[i / 4], tolerances_m[i % 4]);
        struct watch watch = {.tolerance_m = tolerances_m[i % 4]};
        const struct observer observer = {.context = &watch, .estimate = watch_estimate, .sink = watch_sink};
        struct scenario scenario;
        struct simulation_counters counters;
        experiment_scenario("zhou_nominal", settings, &scenario);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, simulation_run(&scenario, 1, &observer, NULL, &counters, error, sizeof error),
                                      error);
        TEST_ASSERT_EQUAL_UINT(1001, watch.samples);
        TEST_ASSERT_EQUAL_UINT(counters.clusters.total.reports, watch.reports);
        TEST_ASSERT_EQUAL(watch.tolerance_m > 0 && i < 8, watch.reports < watch.samples);
        scenario_free(&scenario);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(centroid_is_exact);
    RUN_TEST(pftl_where_all_answer);
    RUN_TEST(msl_where_all_answer);
    RUN_TEST(small_clusters);
    RUN_TEST(default_where_all_answer);
    RUN_TEST(default_in_clusters);
    RUN_TEST(both_ends_know_the_same);
    port_exit(UNITY_END() > 0);
}
