/* The tracker `range` in the field of Zhou et al. where every node that detects the target answers: its error beside the posterior
 * Cramer-Rao bound, whether its covariance says the truth, and what dual prediction costs and saves.
 *
 * PFTL with 50 particles has 1.2 to 1.9 of the bound. */
#include "bounds/pcrb.h"
#include "experiment.h"
#include "port.h"
#include "trackers.h"
#include "unity.h"
#include "world/deployment.h"
#include "world/mobility.h"
#include "world/ranging.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

enum { SEEDS = 20, STEPS = 3600, SKIPPED = 5, ANSWERS_MAX = 128, INTERVAL = 2000 };

static const double reach_m = 50;

/* Sums over all seeds and samples. */
struct score {
    double squares, bounds, nees, sink;
    double off; /* largest distance of what is stored from the estimate */
    long samples, silent, reports, restarts;
};

static void follow(const struct scenario *scenario, uint64_t seed, struct score *score)
{
    char error[200];
    struct deployment deployment;
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, deployment_make(&deployment, scenario, seed, error, sizeof error), error);
    const struct mobility mobility = mobility_of(scenario);
    const struct ranging ranging = ranging_of(scenario, NULL, seed);
    const struct mh_region region = {0, 1000000000, 0, 1000000000};
    struct tracker_choice choice;
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, tracker_choose(scenario, &region, &choice, error, sizeof error), error);
    struct mh_range state;
    TEST_ASSERT_EQUAL_INT(MH_OK, choice.tracker->init(&state, &choice.config, INTERVAL));
    struct mobility_state target = mobility_start(&mobility, seed);
    struct pcrb pcrb;
    pcrb_begin(&pcrb, &mobility);
    for (mh_tick sample = 0; sample <= STEPS; sample++) {
        if (sample > 0) {
            const struct mobility_state before = target;
            mobility_next(&mobility, seed, sample, &target);
            pcrb_step(&pcrb, &mobility, &before, &target);
        }
        struct mh_measurement answers[ANSWERS_MAX];
        size_t count = 0;
        struct information information = {0, 0, 0};
        for (size_t i = 0; i < deployment.count; i++) {
            const struct recorded_node *node = &deployment.nodes[i];
            const struct point place = {node->x_m, node->y_m};
            const double x_m = place.x_m - target.at.x_m, y_m = place.y_m - target.at.y_m;
            double range_m;
            if (x_m * x_m + y_m * y_m > reach_m * reach_m ||
                !ranging_detects(&ranging, sample, (uint32_t)i, sqrt(x_m * x_m + y_m * y_m), &range_m)) {
                continue;
            }
            information_add_range(&information, &target.at, &place, ranging.noise_m);
            TEST_ASSERT_TRUE(count < ANSWERS_MAX);
            answers[count++] = (struct mh_measurement){
                .node = node->id,
                .place = {(int32_t)lround(1000 * place.x_m), (int32_t)lround(1000 * place.y_m), 0},
                .time = (mh_tick)(INTERVAL * sample),
                .value = mh_q20_from_real((mh_real)range_m)};
        }
        pcrb_measure(&pcrb, &information);
        struct mh_estimate e;
        const enum mh_status status = choice.tracker->step(&state, (mh_tick)(INTERVAL * sample), answers, count, &e);
        if (sample < SKIPPED) {
            continue;
        }
        if (status != MH_OK) {
            score->silent++;
            continue;
        }
        const double ex = (double)e.position.x + 0.001 * e.origin.x_mm - target.at.x_m;
        const double ey = (double)e.position.y + 0.001 * e.origin.y_mm - target.at.y_m;
        const double sx = (double)(e.stored.x - e.position.x), sy = (double)(e.stored.y - e.position.y);
        const double xx = (double)e.covariance.xx, xy = (double)e.covariance.xy, yy = (double)e.covariance.yy;
        TEST_ASSERT_TRUE(xx > 0 && xx * yy > xy * xy);
        score->samples++;
        score->squares += ex * ex + ey * ey;
        score->bounds += pcrb_bound(&pcrb);
        score->nees += (yy * ex * ex - 2 * xy * ex * ey + xx * ey * ey) / (xx * yy - xy * xy);
        score->sink += hypot(ex + sx, ey + sy) / reach_m;
        score->off = e.measurements > 0 ? fmax(score->off, hypot(sx, sy)) : score->off;
        score->reports += (e.flags & MH_ESTIMATE_REFRESHED) != 0;
        score->restarts += (e.flags & MH_ESTIMATE_STARTED) != 0;
    }
    deployment_free(&deployment);
}

static struct score run(const char *settings)
{
    struct score score = {0};
    struct scenario scenario;
    experiment_scenario("zhou_nominal", settings, &scenario);
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        follow(&scenario, seed, &score);
    }
    scenario_free(&scenario);
    return score;
}

static void near_the_bound(void)
{
    static const double mph[] = {4, 10, 25}, noise_m[] = {1, 5, 10}, wanted[] = {1.06, 1.15, 1.25};
    for (int n = 0; n < 3; n++) {
        for (int v = 0; v < 3; v++) {
            char settings[128];
            snprintf(settings, sizeof settings, "sensor.range_noise_m=%g target.speed_mph=%g", noise_m[n], mph[v]);
            const struct score score = run(settings);
            printf("  %s\n", settings);
            expect_at_most("error over the bound", sqrt(score.squares / score.bounds), wanted[n]);
            /* its model is not the target's, and a range bends over the spread of a prediction */
            expect_near("mean NEES", score.nees / (double)score.samples, 2, 0.2);
            TEST_ASSERT_EQUAL_INT(0, score.silent);
        }
    }
}

static void dual_prediction(void)
{
    static const double tolerance_m[] = {5, 10, 20}, reports[] = {0.39, 0.22, 0.123}, sink[] = {0.065, 0.101, 0.182};
    for (int i = 0; i < 3; i++) {
        char settings[64];
        snprintf(settings, sizeof settings, "tracker.tolerance_m=%g", tolerance_m[i]);
        const struct score score = run(settings);
        printf("  %s\n", settings);
        expect_at_most("reports a sample", (double)score.reports / (double)score.samples, reports[i]);
        expect_at_most("error at the sink in ranges", score.sink / (double)score.samples, sink[i]);
        TEST_ASSERT_TRUE(score.off <= tolerance_m[i] * (1 + 1e-5));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(near_the_bound);
    RUN_TEST(dual_prediction);
    port_exit(UNITY_END() > 0);
    return 0;
}
