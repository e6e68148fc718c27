/* Xu et al. in an ideal network: accuracy and consistency of the rules of fusion, and what the paper claims. */
#include "port.h"
#include "unity.h"
#include "xu.h"

#include <math.h>
#include <stdio.h>

void setUp(void) {}
void tearDown(void) {}

static double rmse(const struct figures *figures) { return figures->pooled[METRIC_POSITION_RMSE_M]; }

static double anees(const struct figures *figures) { return figures->pooled[METRIC_ANEES]; }

/* The scenario xu_nominal as it is: covariance intersection. */
static struct figures nominal;

/* Over runs whose bounds differ, as a root mean square. */
static double pooled_bound(const struct figures *figures, enum metric metric)
{
    const double share = (XU_RUNS - 1.0) / XU_RUNS;
    return sqrt(pow(figures->mean[metric], 2) + share * pow(figures->sd[metric], 2));
}

static void run_nominal(void) { nominal = xu("xu_nominal", ""); }

static void covariance_intersection(void)
{
    const struct figures ci = nominal;
    xu_near(&ci, METRIC_POSITION_RMSE_M, 0.0545, 0.0025);
    xu_near(&ci, METRIC_SMSE_M, 5.64, 0.25);
    expect_near("its mean in summary.json", ci.mean[METRIC_SMSE_M], ci.pooled[METRIC_SMSE_M], 1e-12);
    xu_near(&ci, METRIC_ANEES, 2.43, 0.15);
    xu_near(&ci, METRIC_CLAIMED_OVER_RMSE, 1.54, 0.06);
    expect_at_most("after 10 s, at any time", ci.pooled[METRIC_POSITION_RMSE_WORST_M], 0.1);
    const double locals[LOCAL_CLUSTERS] = {0.179, 0.146, 0.119, 0.182};
    for (int c = 0; c < LOCAL_CLUSTERS; c++) {
        const enum metric local = (enum metric)((int)METRIC_LOCAL_POSITION_RMSE_M_1 + c);
        const enum metric bound = (enum metric)((int)METRIC_LOCAL_CCRB_M_1 + c);
        xu_near(&ci, local, locals[c], 0.06 * locals[c]);
        expect_at_most("CI over a cluster by itself", rmse(&ci) / ci.pooled[local], 0.5);
        xu_near(&ci, (enum metric)((int)METRIC_LOCAL_ANEES_1 + c), 4.0, 0.3);
        expect_near("its RMSE over its bound", ci.pooled[local] / pooled_bound(&ci, bound), 1.0, 0.05);
    }
    expect_near("posterior bound", ci.mean[METRIC_PCRB_M], 0.0466, 0.005);
    expect_near("bound along the paths", pooled_bound(&ci, METRIC_CCRB_M), 0.0475, 0.01);
}

static void other_intersections(void)
{
    static const struct {
        const char *rule;
        double rmse_m, anees;
    } wanted[] = {{"ci_trace_opt", 0.0572, 2.7}, {"ci_det", 0.0616, 2.9}, {"ici", 0.0545, 3.1}, {"ei", 0.0573, 4.0}};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        char settings[100];
        snprintf(settings, sizeof settings, "fusion.rule=%s", wanted[i].rule);
        const struct figures f = xu("xu_nominal", settings);
        xu_near(&f, METRIC_POSITION_RMSE_M, wanted[i].rmse_m, 0.05 * wanted[i].rmse_m);
        xu_near(&f, METRIC_ANEES, wanted[i].anees, 0.08 * wanted[i].anees);
    }
}

static void fusion_that_knows_what_is_shared(void)
{
    const struct figures sci = xu("xu_nominal", "fusion.rule=sci"), hif = xu("xu_nominal", "fusion.rule=hif");
    const struct figures told = xu("xu_nominal", "fusion.rule=hif_feedback");
    const struct figures central = xu("xu_nominal", "fusion.rule=central"),
                         naive = xu("xu_nominal", "fusion.rule=naive");
    expect_at_most("split CI", rmse(&sci), 0.0520);
    xu_near(&sci, METRIC_ANEES, 3.69, 0.25);
    expect_near("HIF over central", rmse(&hif) / rmse(&central), 1, 0.01);
    expect_near("HIF with feedback over central", rmse(&told) / rmse(&central), 1, 0.01);
    expect_at_most("HIF over the posterior bound", rmse(&hif) / hif.mean[METRIC_PCRB_M], 1.06);
    xu_near(&central, METRIC_ANEES, 4.02, 0.25);
    xu_near(&hif, METRIC_ANEES, 4.02, 0.25);
    xu_near(&naive, METRIC_ANEES, 9.0, 0.7);
    xu_near(&naive, METRIC_CLAIMED_OVER_RMSE, 0.81, 0.04);
}

/* What covariance intersection is for. */
static void noise_that_all_share(void)
{
    const struct figures ci = xu("xu_correlated", ""), central = xu("xu_correlated", "fusion.rule=central");
    const struct figures sci = xu("xu_correlated", "fusion.rule=sci");
    expect_at_most("ANEES of CI", anees(&ci), 4);
    expect_at_least("ANEES of central", anees(&central), 5.5);
    expect_at_least("ANEES of split CI", anees(&sci), 5);
    expect_at_most("RMSE of CI over central", rmse(&ci) / rmse(&central), 1.03);
}

static void sensors_that_two_clusters_hear(void)
{
    const double limits[2][2] = {{2.8, 5.2}, {3.0, 5.9}};
    for (int i = 0; i < 2; i++) {
        const struct figures ci = xu("xu_nominal", i == 0 ? "clusters.shared=1" : "clusters.shared=3");
        const struct figures hif =
            xu("xu_nominal", i == 0 ? "clusters.shared=1 fusion.rule=hif" : "clusters.shared=3 fusion.rule=hif");
        xu_near(&ci, METRIC_ANEES, limits[i][0], 0.08 * limits[i][0]);
        xu_near(&hif, METRIC_ANEES, limits[i][1], 0.08 * limits[i][1]);
    }
}

static void poor_start(void)
{
    const struct figures ukf = xu("xu_hard_start", ""), ekf = xu("xu_hard_start", "tracker.name=cv_ekf");
    expect_at_most("SMSE of the UKF over the EKF's", ukf.pooled[METRIC_SMSE_M] / ekf.pooled[METRIC_SMSE_M], 0.72);
    const struct figures linear = xu("xu_nominal", "tracker.name=cv_ekf");
    expect_near("from a sane start", rmse(&nominal) / rmse(&linear), 1, 0.01);
}

static void several_rates(void)
{
    const struct figures many = nominal, slow = xu("xu_nominal", "clusters.every=6 clusters.rates=1");
    const struct figures budget = xu("xu_nominal", "clusters.every=3 clusters.rates=1");
    const struct figures fast = xu("xu_nominal", "clusters.every=2 clusters.rates=1");
    const enum metric local = METRIC_LOCAL_POSITION_RMSE_M_1;
    expect_near("CI, several rates over all slow", rmse(&many) / rmse(&slow), 0.72, 0.04 / 0.72);
    expect_near("cluster 1, several rates over all slow", many.pooled[local] / slow.pooled[local], 0.79, 0.12 / 0.79);
    expect_near("CI, several rates over as many samples at one", rmse(&many) / rmse(&budget), 0.93, 0.05);
    expect_near("cluster 1, the same", many.pooled[local] / budget.pooled[local], 1.01, 0.06);
    expect_at_most("CI, all fast over several rates", rmse(&fast) / rmse(&many), 1);
}

static void lost_and_rare_reports(void)
{
    const double share[2] = {0.2, 0.5}, ci_m[2] = {0.0576, 0.0664}, hif_m[2] = {0.0506, 0.0591};
    for (int i = 0; i < 2; i++) {
        char settings[100];
        snprintf(settings, sizeof settings, "fusion.report_loss=%g", share[i]);
        const struct figures ci = xu("xu_nominal", settings);
        snprintf(settings, sizeof settings, "fusion.report_loss=%g fusion.rule=hif", share[i]);
        const struct figures hif = xu("xu_nominal", settings);
        xu_near(&ci, METRIC_POSITION_RMSE_M, ci_m[i], 0.05 * ci_m[i]);
        xu_near(&hif, METRIC_POSITION_RMSE_M, hif_m[i], 0.05 * hif_m[i]);
    }
    const struct figures rare = xu("xu_nominal", "fusion.report_s=10 metrics.skip_first=1 fusion.rule=hif");
    const struct figures central = xu("xu_nominal", "fusion.report_s=10 metrics.skip_first=1 fusion.rule=central");
    expect_near("HIF told every 10 s over central", rmse(&rare) / rmse(&central), 1, 0.03);
}

/* Sanitizers take ten times as long: then no more than what runs all of the code. */
#ifdef __SANITIZE_ADDRESS__
enum { EVERYTHING = 0 };
#else
enum { EVERYTHING = 1 };
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(run_nominal);
    RUN_TEST(covariance_intersection);
    RUN_TEST(fusion_that_knows_what_is_shared);
    if (EVERYTHING) {
        RUN_TEST(other_intersections);
        RUN_TEST(noise_that_all_share);
        RUN_TEST(sensors_that_two_clusters_hear);
        RUN_TEST(poor_start);
        RUN_TEST(several_rates);
        RUN_TEST(lost_and_rare_reports);
    }
    port_exit(UNITY_END() > 0);
    return 0;
}
