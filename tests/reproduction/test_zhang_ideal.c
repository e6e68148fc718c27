/* Zhang et al. in an ideal network: 40 deployments with 10 starts each of the scenarios zhang_a, zhang_m and zhang_b, whose sensors have standard
 * deviations of 3e-6, 1e-4 and 1.73e-3. What is expected of the published filters is what an independent simulation of the same searches gave
 * in double precision. */
#include "experiment.h"
#include "motehound/estimate.h"
#include "port.h"
#include "simulation.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

/* Sanitizers take ten times as long: then fewer deployments, and figures are printed, not judged. */
#ifdef __SANITIZE_ADDRESS__
enum { RUNS = 40, JUDGED = 0 };
#else
enum { RUNS = 400, JUDGED = 1 };
#endif

void setUp(void) {}
void tearDown(void) {}

static struct figures search(const char *scenario, const char *settings)
{
    printf("  %s %s\n", scenario, settings);
    return experiment_from(0, scenario, settings, RUNS);
}

static void within(const char *what, double measured, double least, double most)
{
    char line[200];
    snprintf(line, sizeof line, "%s: %.4g, expected %g to %g", what, measured, least, most);
    printf("    %s\n", line);
    TEST_ASSERT_TRUE_MESSAGE(!JUDGED || (measured >= least && measured <= most), line);
}

static void published_filters_with_good_sensors(void)
{
    const struct figures ukf = search("zhang_a", "tracker.name=gas_ukf");
    within("success of the UKF", ukf.mean[METRIC_SUCCESS_50M], 0.95, 1);
    within("sensors of the UKF until 10 m", ukf.median[METRIC_SENSORS_TO_10M], 17, 21);
    within("heads of the UKF", ukf.mean[METRIC_HOPS], 6.6, 7.4);
    within("median error of the UKF, m", ukf.pooled[METRIC_POSITION_ERROR_MEDIAN_M], 0.12, 0.25);
    const struct figures ekf = search("zhang_a", "tracker.name=gas_ekf");
    within("success of the EKF", ekf.mean[METRIC_SUCCESS_50M], 0.30, 0.53);
    within("sensors of the EKF until 10 m", ekf.median[METRIC_SENSORS_TO_10M], 30, 100);
    within("by its own account the EKF converges", ekf.mean[METRIC_CONVERGED], 0.96, 1);
    within("the UKF succeeds more often", ukf.mean[METRIC_SUCCESS_50M] - ekf.mean[METRIC_SUCCESS_50M], 0.4, 1);
}

static void published_filters_with_fair_sensors(void)
{
    const struct figures ukf = search("zhang_m", "tracker.name=gas_ukf");
    within("success of the UKF", ukf.mean[METRIC_SUCCESS_50M], 0.88, 1);
    const struct figures ekf = search("zhang_m", "tracker.name=gas_ekf");
    within("success of the EKF", ekf.mean[METRIC_SUCCESS_50M], 0.70, 0.90);
}

static void judge_default(const struct figures *f, double least_median_m, double most_median_m)
{
    within("success", f->mean[METRIC_SUCCESS_50M], 0.99, 1);
    within("error over the Cramer-Rao bound", f->pooled[METRIC_ERROR_OVER_CRLB], 0.90, 1.20);
    within("median NEES", f->pooled[METRIC_NEES_MEDIAN], 2.0, 2.9);
    within("median error, m", f->pooled[METRIC_POSITION_ERROR_MEDIAN_M], least_median_m, most_median_m);
}

static void default_with_good_sensors(void)
{
    const struct figures f = search("zhang_a", "");
    judge_default(&f, 0.25, 0.47);
}

static void default_with_fair_sensors(void)
{
    const struct figures f = search("zhang_m", "");
    judge_default(&f, 0.30, 0.70);
}

static void default_with_bad_sensors(void)
{
    const struct figures f = search("zhang_b", "");
    within("success", f.mean[METRIC_SUCCESS_50M], 0.60, 1);
    within("converged, but wrong", f.mean[METRIC_CONVERGED_WRONG], 0, 0.03);
}

/* The plume fluctuates by 30 %, and the wind is taken for 25 % stronger and 10 degrees off. */
static void default_in_other_air_than_it_thinks(void)
{
    const struct figures f =
        search("zhang_m", "source.fluctuation=0.3 tracker.wind_scale=1.25 tracker.wind_off_rad=0.1745");
    within("success", f.mean[METRIC_SUCCESS_50M], 0.97, 1);
    within("mean error, m", f.mean[METRIC_POSITION_RMSE_M], 0, 8);
}

/* A token of 36 bytes that tells of one estimate, linearised. */
static void small_one(void)
{
    const struct figures a = search("zhang_a", "tracker.name=gas_small"),
                         m = search("zhang_m", "tracker.name=gas_small");
    within("success with good sensors", a.mean[METRIC_SUCCESS_50M], 0.99, 1);
    within("success with fair sensors", m.mean[METRIC_SUCCESS_50M], 0.94, 1);
}

/* ---- the walk ---- */

enum { HEADS_MAX = 60 };

struct walk {
    mh_node_id heads[HEADS_MAX];
    size_t count;
};

static void see_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                         const struct truth *at_time, const struct truth *at_arrival)
{
    struct walk *walk = context;
    (void)time_s;
    (void)estimate;
    (void)at_time;
    (void)at_arrival;
    TEST_ASSERT_TRUE(walk->count < HEADS_MAX);
    walk->heads[walk->count++] = head;
}

static struct walk walk_of(const char *name, const char *settings, uint64_t seed)
{
    char error[300] = "";
    struct walk walk = {.count = 0};
    struct scenario scenario;
    struct simulation_counters counters;
    const struct observer observer = {.context = &walk, .estimate = see_estimate};
    experiment_scenario(name, settings, &scenario);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, simulation_run(&scenario, seed, &observer, NULL, &counters, error, sizeof error),
                                  error);
    scenario_free(&scenario);
    return walk;
}

static void assert_walk(const struct walk *walk, const mh_node_id *heads, size_t count)
{
    TEST_ASSERT_EQUAL_size_t(count, walk->count);
    TEST_ASSERT_EQUAL_UINT32_ARRAY(heads, walk->heads, count);
}

/* The heads of the UKF that a simulation in double precision finds, too. */
static void heads_that_are_known(void)
{
    static const struct {
        uint64_t seed;
        size_t count;
        mh_node_id heads[8];
    } known[] = {{0, 7, {35, 92, 84, 62, 8, 5, 80}},      {13, 5, {93, 81, 0, 2, 95}},
                 {27, 8, {12, 15, 86, 3, 0, 25, 94, 26}}, {111, 6, {90, 23, 96, 83, 51, 45}},
                 {205, 6, {36, 53, 94, 67, 29, 81}},      {333, 7, {37, 57, 26, 21, 35, 55, 10}}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        const struct walk walk = walk_of("zhang_a", "tracker.name=gas_ukf", known[i].seed);
        assert_walk(&walk, known[i].heads, known[i].count);
    }
}

/* Release, what is expected of it, noise and sensors in other units; or all that moves the air and what it carries. */
static void units_do_not_matter(void)
{
    static const char *const trackers[] = {"gas", "gas_small", "gas_ekf", "gas_ukf"};
    static const double scales[] = {0.01, 0.25, 1000};
    for (size_t i = 0; i < 4 * 3 * 5; i++) {
        const double s = scales[i / 4 % 3];
        const uint64_t seed = i / 12 * 7;
        char tracker[40], other_units[300], other_air[300];
        snprintf(tracker, sizeof tracker, "tracker.name=%s", trackers[i % 4]);
        snprintf(other_units, sizeof other_units,
                 "%s source.rate_mlps=%.9g tracker.prior_rate_mlps=%.9g tracker.prior_rate_sd_mlps=%.9g "
                 "sensor.noise_ppm=%.9g "
                 "sensor.unit_ppm=%.9g",
                 tracker, 30 * s, 50 * s, 30 * s, 1e-4 * s, 1e-3 * s);
        snprintf(other_air, sizeof other_air,
                 "%s source.rate_mlps=%.9g tracker.prior_rate_mlps=%.9g tracker.prior_rate_sd_mlps=%.9g "
                 "source.mixing_m2ps=%.9g wind.speed_mps=%.9g",
                 tracker, 30 * s, 50 * s, 30 * s, 30 * s, s);
        const struct walk walk = walk_of("zhang_m", tracker, seed);
        const struct walk scaled = walk_of("zhang_m", other_units, seed);
        assert_walk(&scaled, walk.heads, walk.count);
        if (s < 100) {
            const struct walk blown = walk_of("zhang_m", other_air, seed);
            assert_walk(&blown, walk.heads, walk.count);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(published_filters_with_good_sensors);
    RUN_TEST(published_filters_with_fair_sensors);
    RUN_TEST(default_with_good_sensors);
    RUN_TEST(default_with_fair_sensors);
    RUN_TEST(default_with_bad_sensors);
    RUN_TEST(default_in_other_air_than_it_thinks);
    RUN_TEST(small_one);
    RUN_TEST(heads_that_are_known);
    RUN_TEST(units_do_not_matter);
    port_exit(UNITY_END() > 0);
    return 0;
}
