/* Han's targets that are heard, from sampling instant to sampling instant without messages: single fixes (Table 2-1 and the default), several targets side by side,
 * crossing and nearly meeting, and groups. What is expected is what an independent simulation of the same gave in double precision. */
#include "experiment.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Sanitizers take ten times as long: then figures are printed, not judged. */
#ifdef __SANITIZE_ADDRESS__
enum { RUNS = 4, MANY_RUNS = 4, JUDGED = 0 };
#else
enum { RUNS = 20, MANY_RUNS = 60, JUDGED = 1 };
#endif

void setUp(void) {}
void tearDown(void) {}

static struct figures run(const char *scenario, const char *settings)
{
    printf("  %s %s\n", scenario, settings);
    return experiment_from(0, scenario, settings, getenv("MOTEHOUND_LONG_TESTS") ? MANY_RUNS : RUNS);
}

static void within(const char *what, double measured, double least, double most)
{
    char line[200];
    snprintf(line, sizeof line, "%s: %.4g, expected %g to %g", what, measured, least, most);
    printf("    %s\n", line);
    TEST_ASSERT_TRUE_MESSAGE(!JUDGED || (measured >= least && measured <= most), line);
}

static void near(const char *what, double measured, double expected, double off)
{
    within(what, measured, expected - off, expected + off);
}

/* ---- one target, one fix ---- */

/* Of fixes at all places, so that hard ones are not left out. */
static double error_of_fix(const char *settings)
{
    const struct figures f = run("han_table21", settings);
    within("places with a fix", f.mean[METRIC_TRACKED_SHARE], 0.999, 1);
    return f.pooled[METRIC_POSITION_ERROR_M];
}

static void table_2_1_centroid(void) { near("centroid", error_of_fix("tracker.name=centroid"), 9.34, 0.4); }

static void table_2_1_by_cases(void)
{
    near("4 intervals", error_of_fix("tracker.name=dm tracker.strongest=3 tracker.variant=cases tracker.intervals=4"),
         5.42, 0.28);
    near("8 intervals", error_of_fix("tracker.name=dm tracker.strongest=3 tracker.variant=cases tracker.intervals=8"),
         4.00, 0.20);
    near("40 intervals", error_of_fix("tracker.name=dm tracker.strongest=3 tracker.variant=cases tracker.intervals=40"),
         3.33, 0.20);
}

static void table_2_1_uniform(void)
{
    near("4 intervals", error_of_fix("tracker.name=dm tracker.strongest=3 tracker.variant=uniform tracker.intervals=4"),
         5.13, 0.26);
    near("8 intervals", error_of_fix("tracker.name=dm tracker.strongest=3 tracker.variant=uniform tracker.intervals=8"),
         3.76, 0.19);
    near("40 intervals",
         error_of_fix("tracker.name=dm tracker.strongest=3 tracker.variant=uniform tracker.intervals=40"), 3.14, 0.19);
}

static void likelihood_on_a_grid(void) { near("maximum likelihood", error_of_fix("tracker.name=ml"), 2.60, 0.15); }

static void default_localiser(void)
{
    const struct figures f = run("han_table21", "tracker.name=acoustic");
    within("places with a fix", f.mean[METRIC_TRACKED_SHARE], 0.999, 1);
    within("mean error, m", f.pooled[METRIC_POSITION_ERROR_M], 1.70, 1.97);
    within("over the Cramer-Rao bound of all nodes", f.mean[METRIC_RMSE_OVER_CRLB], 0.95, 1.15);
    within("the bound, m", f.mean[METRIC_FIX_CRLB_M], 2.05, 2.25);
}

/* ---- several targets ---- */

#define PUBLISHED "tracker.name=dm tracker.separation=decomposition tracker.share_range_m=40 "

static void decomposition_as_published(void)
{
    const struct figures wide = run("han_sparse", PUBLISHED "target.spacing_m=60"),
                         narrow = run("han_sparse", PUBLISHED "target.spacing_m=40");
    within("success 60 m apart", wide.mean[METRIC_SUCCESS], 0.85, 1);
    within("mean error, m", wide.pooled[METRIC_POSITION_ERROR_M], 2.5, 6);
    within("success 40 m apart", narrow.mean[METRIC_SUCCESS], 0, 0.75);
}

static void joint_solution(void)
{
    const struct figures wide = run("han_sparse", "target.spacing_m=30"),
                         narrow = run("han_sparse", "target.spacing_m=20"),
                         three = run("han_sparse", "target.count=3 target.spacing_m=40");
    within("success 30 m apart", wide.mean[METRIC_SUCCESS], 0.90, 1);
    within("mean error, m", wide.pooled[METRIC_POSITION_ERROR_M], 1.5, 2.4);
    within("success 20 m apart", narrow.mean[METRIC_SUCCESS], 0.75, 1);
    within("success of three 40 m apart", three.mean[METRIC_SUCCESS], 0.90, 1);
}

static void crossing_targets_keep_their_identities(void)
{
    const struct figures f = run("han_sparse", "source.path=crossing target.turn_deg=90");
    within("identity swaps", f.mean[METRIC_IDENTITY_SWAPS], 0, 0.1);
    within("success", f.mean[METRIC_SUCCESS], 0.85, 1); /* no swaps among what is lost say nothing */
}

static void who_is_who_after_a_bounce_is_not_known(void)
{
    const struct figures f = run("han_sparse", "source.path=bounce target.turn_deg=40 target.spacing_m=10");
    within("unresolved", f.mean[METRIC_UNRESOLVED], 0.95, 1);
    within("swaps that no track warns of", f.mean[METRIC_SWAPS_CLAIMED], 0, 0.05);
    const struct figures apart = run("han_sparse", "target.spacing_m=60");
    within("unresolved at 60 m", apart.mean[METRIC_UNRESOLVED], 0, 0.05);
}

/* ---- groups ---- */

static void a_group_of_three(void)
{
    const struct figures f = run("han_group", "source.path=ring target.count=3 target.spacing_m=10");
    within("error of the centroid, m", f.pooled[METRIC_GROUP_CENTROID_ERROR_M], 1.2, 2.3);
    within("bias of the extent, m", f.mean[METRIC_EXTENT_BIAS_M], -6.5, 6.5);
    within("spurious splits a minute", f.mean[METRIC_SPURIOUS_SPLITS_PER_MIN], 0, 0.1);
    within("count right", f.mean[METRIC_COUNT_RIGHT], 0.95, 1);
}

static void groups_merge_and_split(void)
{
    const struct figures f = run("han_group", "source.path=lanes target.count=3 target.apart_m=80 target.spacing_m=8");
    within("merged after, s", f.mean[METRIC_MERGE_DELAY_S], 0, 7.5);
    within("split after, s", f.mean[METRIC_SPLIT_DELAY_S], 0, 7.5);
    within("three tracks in the end", f.mean[METRIC_APART_AT_END], 0.95, 1);
    within("unresolved who is who then", f.mean[METRIC_UNRESOLVED], 0.95,
           1); /* they draw near and part as in a bounce */
    within("swaps that no track warns of", f.mean[METRIC_SWAPS_CLAIMED], 0, 0.05);
}

static void modes_have_hysteresis(void)
{
    const struct figures f = run("han_group", "source.path=parallel target.count=2 target.spacing_m=23");
    within("mode changes a minute", f.mean[METRIC_MODE_CHANGES_PER_MIN], 0, 0.8);
    within("count right", f.mean[METRIC_COUNT_RIGHT], 0.95, 1); /* what is not followed does not change */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(table_2_1_centroid);
    RUN_TEST(table_2_1_by_cases);
    RUN_TEST(table_2_1_uniform);
    RUN_TEST(likelihood_on_a_grid);
    RUN_TEST(default_localiser);
    RUN_TEST(decomposition_as_published);
    RUN_TEST(joint_solution);
    RUN_TEST(crossing_targets_keep_their_identities);
    RUN_TEST(who_is_who_after_a_bounce_is_not_known);
    RUN_TEST(a_group_of_three);
    RUN_TEST(groups_merge_and_split);
    RUN_TEST(modes_have_hysteresis);
    port_exit(UNITY_END() > 0);
    return 0;
}
