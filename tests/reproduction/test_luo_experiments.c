/* The experiments of Luo, Chai and Yang with their own method: it finds the path, and lags on it. The expected figures are those of an
 * independent simulation with other random numbers. */
#include "experiment.h"
#include "port.h"
#include "unity.h"

#include <stdio.h>

enum { SEEDS = 50, FEWER_SEEDS = 20 };

void setUp(void) {}
void tearDown(void) {}

static struct figures luo(const char *scenario, const char *settings, unsigned runs)
{
    char all[200];
    snprintf(all, sizeof all, "tracker.name=luo %s", settings);
    return experiment(scenario, all, runs);
}

static double rmse_m(const char *scenario, const char *settings)
{
    return luo(scenario, settings, FEWER_SEEDS).pooled[METRIC_POSITION_RMSE_M];
}

static void without_noise(const char *scenario, double least_squares, double filtered, double at_arrival)
{
    const struct figures f = luo(scenario, "", SEEDS);
    expect_near("least squares, RMSE m", f.pooled[METRIC_RAW_POSITION_RMSE_M], least_squares, 0.08);
    expect_near("filtered, RMSE m", f.pooled[METRIC_POSITION_RMSE_M], filtered, 0.08);
    expect_near("filtered, against the truth at the estimated arrival, RMSE m",
                f.pooled[METRIC_POSITION_RMSE_AT_ARRIVAL_M], at_arrival, 0.12);
    expect_at_least("share of the samples with a position", f.mean[METRIC_TRACKED_SHARE], 0.97);
}

static void experiment_1(void) { without_noise("luo_exp1", 3.31, 3.53, 1.75); }

static void experiment_2(void) { without_noise("luo_exp2", 3.64, 4.10, 2.94); }

/* The larger the sampling interval, the larger the error; 1 s is experiment 1. */
static void experiment_3(void)
{
    expect_near("T = 0.5 s", rmse_m("luo_exp3", "sensor.interval_s=0.5"), 1.92, 0.15);
    expect_near("T = 2 s", rmse_m("luo_exp3", "sensor.interval_s=2"), 6.31, 0.15);
    expect_near("T = 4 s", rmse_m("luo_exp3", "sensor.interval_s=4"), 10.9, 0.15);
}

/* The more nodes, the smaller the error, but hardly: it is bias, not variance; 1,280 are experiment 2. */
static void experiment_4(void)
{
    expect_near("640 nodes", rmse_m("luo_exp4", "network.nodes=640"), 4.49, 0.10);
    expect_near("960 nodes", rmse_m("luo_exp4", "network.nodes=960"), 4.20, 0.10);
    expect_near("1,920 nodes", rmse_m("luo_exp4", "network.nodes=1920"), 4.02, 0.10);
}

/* The threshold chi is the paper's answer to noise. Against noise in proportion to the reading it is none: the noise of the large old readings
 * passes it, and the position falls back to where the source has been. */
static void threshold_is_no_answer_to_relative_noise(void)
{
    const char *settings = "tracker.chi=0.2 sensor.relative_noise=0.05";
    expect_near("E1, least squares, RMSE m", luo("luo_exp1", settings, FEWER_SEEDS).pooled[METRIC_RAW_POSITION_RMSE_M],
                18.2, 0.10);
    expect_near("E2, least squares, RMSE m", luo("luo_exp2", settings, FEWER_SEEDS).pooled[METRIC_RAW_POSITION_RMSE_M],
                19.1, 0.10);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(experiment_1);
    RUN_TEST(experiment_2);
    RUN_TEST(experiment_3);
    RUN_TEST(experiment_4);
    RUN_TEST(threshold_is_no_answer_to_relative_noise);
    port_exit(UNITY_END() > 0);
}
