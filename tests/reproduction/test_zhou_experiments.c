/* Zhou et al. in an ideal network: the figures over speeds, noise, densities, tolerances and numbers of particles. */
#include "port.h"
#include "unity.h"
#include "zhou.h"

#include <stdio.h>

void setUp(void) {}
void tearDown(void) {}

/* `format` with one number in it. */
static struct figures zhou_with(const char *format, double value)
{
    char settings[200];
    snprintf(settings, sizeof settings, format, value);
    return zhou(settings);
}

static void pftl_where_all_answer(void)
{
    static const struct {
        const char *settings;
        double localised, at_sink, reports;
    } wanted[] = {
        {"target.speed_mph=4", 0.0540, 0.0765, 0.264},      {"target.speed_mph=25", 0.0576, 0.0636, 0.743},
        {"sensor.range_noise_m=1", 0.01257, 0.0418, 0.296}, {"sensor.range_noise_m=10", 0.0977, 0.1015, 0.751},
        {"network.density=8", 0.0664, 0.0735, 0.619},       {"network.density=24", 0.0376, 0.0525, 0.440}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        char settings[200];
        snprintf(settings, sizeof settings, "tracker.name=pftl protocol.election=scm %s", wanted[i].settings);
        const struct figures f = zhou(settings);
        zhou_near(&f, METRIC_LOCALISATION_ERROR_RS, wanted[i].localised, 0.04);
        zhou_near(&f, METRIC_SINK_ERROR_RS, wanted[i].at_sink, 0.04);
        zhou_near(&f, METRIC_REPORTS_PER_SAMPLE, wanted[i].reports, 0.05);
    }
}

static void pftl_tolerances(void)
{
    static const struct {
        double tolerance_m, at_sink, reports;
    } wanted[] = {{1, 0.0523, 0.978}, {10, 0.1129, 0.216}, {20, 0.1808, 0.126}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        const struct figures f =
            zhou_with("tracker.name=pftl protocol.election=scm tracker.tolerance_m=%g", wanted[i].tolerance_m);
        zhou_near(&f, METRIC_SINK_ERROR_RS, wanted[i].at_sink, 0.04);
        zhou_near(&f, METRIC_REPORTS_PER_SAMPLE, wanted[i].reports, 0.05);
    }
}

static void pftl_particles(void)
{
    static const struct {
        double particles, localised;
    } wanted[] = {{5, 0.0662}, {20, 0.0537}, {200, 0.0522}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        const struct figures f =
            zhou_with("tracker.name=pftl protocol.election=scm tracker.particles=%g", wanted[i].particles);
        zhou_near(&f, METRIC_LOCALISATION_ERROR_RS, wanted[i].localised, 0.04);
    }
}

static void msl_speeds(void)
{
    const struct figures slow = zhou("tracker.name=msl protocol.election=scm target.speed_mph=4");
    zhou_near(&slow, METRIC_LOCALISATION_ERROR_RS, 0.1189, 0.03);
    const struct figures fast = zhou("tracker.name=msl protocol.election=scm target.speed_mph=25");
    zhou_near(&fast, METRIC_LOCALISATION_ERROR_RS, 0.1099, 0.03);
}

static void clusters_at_other_speeds(void)
{
    static const struct {
        double speed_mph, scm, rho, sac, sac_error;
    } wanted[] = {{4, 1495, 346, 261, 0.0766}, {25, 3436, 2007, 1436, 0.0991}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        const double mph = wanted[i].speed_mph;
        const struct figures scm = zhou_with("tracker.name=pftl protocol.election=scm target.speed_mph=%g", mph);
        const struct figures rho = zhou_with("tracker.name=pftl protocol.election=rho target.speed_mph=%g", mph);
        const struct figures sac = zhou_with("tracker.name=pftl protocol.election=sac target.speed_mph=%g", mph);
        zhou_near(&scm, METRIC_CLUSTERS, wanted[i].scm, 0.02);
        zhou_near(&rho, METRIC_CLUSTERS, wanted[i].rho, 0.05);
        zhou_near(&sac, METRIC_CLUSTERS, wanted[i].sac, 0.05);
        zhou_near(&sac, METRIC_LOCALISATION_ERROR_RS, wanted[i].sac_error, 0.05);
        expect_at_most("clusters, SAC over RHO", sac.mean[METRIC_CLUSTERS] / rho.mean[METRIC_CLUSTERS], 0.78);
    }
}

static void default_over_the_bound(void)
{
    static const struct {
        double sd_m, over_bound;
    } wanted[] = {{1, 1.06}, {5, 1.15}, {10, 1.25}};
    const double speeds_mph[] = {4, 10, 25};
    for (size_t i = 0; i < 9; i++) {
        char settings[200];
        snprintf(settings, sizeof settings, "protocol.election=scm target.speed_mph=%g sensor.range_noise_m=%g",
                 speeds_mph[i / 3], wanted[i % 3].sd_m);
        const struct figures f = zhou(settings);
        zhou_at_most(&f, METRIC_RMSE_OVER_PCRB, wanted[i % 3].over_bound);
    }
}

static void dual_prediction(void)
{
    static const struct {
        double tolerance_m, at_sink, reports;
    } wanted[] = {{10, 0.101, 0.22}, {20, 0.182, 0.123}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        const struct figures f = zhou_with("protocol.election=scm tracker.tolerance_m=%g", wanted[i].tolerance_m);
        zhou_at_most(&f, METRIC_SINK_ERROR_RS, wanted[i].at_sink);
        zhou_at_most(&f, METRIC_REPORTS_PER_SAMPLE, wanted[i].reports);
    }
}

static void default_in_clusters_at_other_speeds(void)
{
    static const struct {
        double speed_mph, localised, hindsight, energy_j;
    } wanted[] = {{4, 0.047, 137, 10.5}, {25, 0.070, 787, 12.6}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        const struct figures f = zhou_with("target.speed_mph=%g", wanted[i].speed_mph);
        zhou_at_most(&f, METRIC_LOCALISATION_ERROR_RS, wanted[i].localised);
        zhou_at_most(&f, METRIC_CLUSTERS, 1.35 * wanted[i].hindsight);
        zhou_at_most(&f, METRIC_ENERGY_MJ, 1e3 * wanted[i].energy_j);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(pftl_where_all_answer);
    RUN_TEST(pftl_tolerances);
    RUN_TEST(pftl_particles);
    RUN_TEST(msl_speeds);
    RUN_TEST(clusters_at_other_speeds);
    RUN_TEST(default_over_the_bound);
    RUN_TEST(dual_prediction);
    RUN_TEST(default_in_clusters_at_other_speeds);
    port_exit(UNITY_END() > 0);
}
