/* The default tracker when readings never come and reports are lost: how much worse its positions become. */
#include "experiment.h"
#include "port.h"
#include "simulation.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

#define NOISE "sensor.relative_noise=0.01 sensor.additive_noise=0.02"

/* Every node sends straight to the head, once: what the radio loses are reports (and a few of the head's requests). */
#define SINGLE_HOP "network.protocol=direct radio.range_m=200"

enum { SEEDS = 50, FEWER_SEEDS = 20 };

static const char *const paths[] = {"luo_exp1", "luo_exp2"};

void setUp(void) {}
void tearDown(void) {}

static void lost_reports_and_readings(void)
{
    for (size_t path = 0; path < 2; path++) {
        const double whole =
            experiment(paths[path], SINGLE_HOP " " NOISE, FEWER_SEEDS).pooled[METRIC_POSITION_MEDIAN_M];
        static const struct {
            const char *settings;
            double share; /* of the median without losses, at most */
            unsigned lost;
        } losses[] = {
            {"radio.loss=0.1 " SINGLE_HOP, 2, 0},
            {"radio.loss=0.3 " SINGLE_HOP, 3, 1},
            {"sensor.loss=0.1 " SINGLE_HOP, 2, 0},
            {"sensor.loss=0.3 " SINGLE_HOP, 3, 1},
        };
        for (size_t i = 0; i < sizeof losses / sizeof losses[0]; i++) {
            char settings[200];
            snprintf(settings, sizeof settings, "%s " NOISE, losses[i].settings);
            const struct figures f = experiment(paths[path], settings, FEWER_SEEDS);
            expect_at_most("median, of that without losses", f.pooled[METRIC_POSITION_MEDIAN_M] / whole,
                           losses[i].share);
            expect_at_most("runs lost", f.lost, losses[i].lost);
        }
    }
}

/* ---- twenty samples lost in a row ---- */

enum { GAP_BEGIN_S = 40, GAP_END_S = 60, FOUND_SAMPLES = 3 };

/* When the source is found again: the first of FOUND_SAMPLES successive positions within a metre that readings gave, not dead reckoning. */
static struct gap {
    unsigned right; /* in succession */
    double found_s; /* 0: not yet */
    unsigned far;   /* positions more than 5 m away, from ten samples after the gap on */
} gap;

static void hear_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                          const struct truth *at_time, const struct truth *at_arrival)
{
    (void)context, (void)time_s, (void)head, (void)at_arrival;
    if (at_time->time_s < GAP_END_S || !at_time->present) {
        return;
    }
    const double error = hypot(estimate->origin.x_mm * 1e-3 + (double)estimate->position.x - at_time->x_m,
                               estimate->origin.y_mm * 1e-3 + (double)estimate->position.y - at_time->y_m);
    gap.right = error <= 1 && !(estimate->flags & MH_ESTIMATE_COASTED) ? gap.right + 1 : 0;
    if (gap.right == FOUND_SAMPLES && gap.found_s == 0) {
        gap.found_s = at_time->time_s - (FOUND_SAMPLES - 1);
    }
    gap.far += at_time->time_s >= GAP_END_S + 10 && error > 5;
}

static void source_is_found_again_after_a_gap(void)
{
    static const struct observer observer = {.estimate = hear_estimate};
    for (size_t path = 0; path < 2; path++) {
        struct scenario scenario;
        double worst = 0, sum = 0;
        unsigned far = 0;
        char settings[200];
        snprintf(settings, sizeof settings, "sensor.outage_start_s=%d sensor.outage_s=%d " NOISE, GAP_BEGIN_S,
                 GAP_END_S - GAP_BEGIN_S);
        experiment_scenario(paths[path], settings, &scenario);
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            char error[300] = "";
            struct simulation_counters counters;
            gap = (struct gap){0};
            TEST_ASSERT_EQUAL_INT_MESSAGE(
                0, simulation_run(&scenario, seed, &observer, NULL, &counters, error, sizeof error), error);
            const double samples = gap.found_s > 0 ? gap.found_s - (GAP_END_S - 1) : (double)INFINITY;
            worst = fmax(worst, samples);
            sum += samples;
            far += gap.far;
        }
        scenario_free(&scenario);
        printf("  %s %s: found again at sample %.1f after the gap on average, %u positions beyond 5 m later\n",
               paths[path], settings, sum / SEEDS, far);
        expect_at_most("samples until the source is found again, largest of all runs", worst, 10);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(lost_reports_and_readings);
    RUN_TEST(source_is_found_again_after_a_gap);
    port_exit(UNITY_END() > 0);
}
