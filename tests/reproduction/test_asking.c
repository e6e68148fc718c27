/* The default tracker with and without the silent nodes that it asks for, on the same readings and with nothing lost: their silence says where
 * the source is not. */
#include "experiment.h"
#include "port.h"
#include "readings.h"
#include "record/statistics.h"
#include "roster.h"
#include "trackers.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SEEDS = 10, TICKS_PER_INSTANT = MH_TICKS_PER_S };

void setUp(void) {}
void tearDown(void) {}

static double distance(const struct mh_estimate *estimate, double x_m, double y_m)
{
    return hypot(estimate->origin.x_mm * 1e-3 + (double)estimate->position.x - x_m,
                 estimate->origin.y_mm * 1e-3 + (double)estimate->position.y - y_m);
}

/* What the nodes report at instant k, by themselves and, if there is an interest, because they are in it; returns how many. */
static size_t reports_of(const struct readings *readings, size_t k, mh_q20 chi, bool tracking,
                         const struct mh_interest *interest, struct mh_measurement *reports, size_t *asked)
{
    size_t count = 0;
    for (size_t i = 0; i < readings->deployment.count && count < MH_REPORTS_MAX; i++) {
        const struct recorded_node *node = &readings->deployment.nodes[i];
        struct mh_measurement report = {.node = node->id,
                                        .place = place_from_metres(node->x_m, node->y_m, 0),
                                        .time = (mh_tick)k * TICKS_PER_INSTANT,
                                        .value = readings_at(readings, k, i)->value};
        report.flags = readings_increment(readings, k, i, &report.increment) ? MH_MEASUREMENT_HAS_INCREMENT : 0;
        const bool silent = report.increment < chi && (tracking || report.value <= chi);
        if (!silent || (interest != NULL && mh_place_within(&report.place, &interest->centre, interest->radius_mm))) {
            reports[count++] = report;
            *asked += silent;
        }
    }
    return count;
}

/* Run the tracker on the readings; its errors go to `errors`. Returns how many reports were asked for. */
static size_t track(const struct scenario *scenario, const struct readings *readings, bool asks, struct samples *errors)
{
    static struct mh_measurement reports[MH_REPORTS_MAX];
    char error[300] = "";
    struct tracker_choice choice;
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, tracker_choose(scenario, NULL, &choice, error, sizeof error), error);
    void *state = malloc(choice.tracker->state_size);
    TEST_ASSERT_NOT_NULL(state);
    TEST_ASSERT_EQUAL_INT(MH_OK, choice.tracker->init(state, &choice.config, TICKS_PER_INSTANT));
    const mh_q20 chi = mh_q20_from_real((mh_real)scenario->tracker.chi);
    bool tracking = false;
    int64_t seen = 0;
    size_t asked = 0;
    for (size_t k = 0; k < readings->instants; k++) {
        struct mh_interest interest;
        const bool interested = asks && choice.tracker->interest(state, &interest) == MH_OK;
        const size_t count = reports_of(readings, k, chi, tracking, interested ? &interest : NULL, reports, &asked);
        struct mh_estimate estimate;
        tracking = choice.tracker->step(state, (mh_tick)k * TICKS_PER_INSTANT, reports, count, &estimate) == MH_OK;
        if (tracking && seen++ >= scenario->metrics.skip_first) {
            TEST_ASSERT_EQUAL_INT(0, samples_add(errors, distance(&estimate, readings->x_m[k], readings->y_m[k])));
        }
    }
    free(state);
    return asked;
}

/* Most of the nodes near the source are not silent, so the typical error hardly changes; it is the larger ones that become smaller. */
static void silence_helps(const char *settings)
{
    struct scenario scenario;
    struct samples with = {0}, without = {0};
    size_t asked = 0;
    experiment_scenario("luo_exp2", settings, &scenario);
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct readings readings;
        readings_make(&readings, &scenario, seed);
        asked += track(&scenario, &readings, true, &with);
        TEST_ASSERT_EQUAL_UINT(0, track(&scenario, &readings, false, &without));
        readings_free(&readings);
    }
    scenario_free(&scenario);
    const double asking = samples_quantile(&with, 0.95), not_asking = samples_quantile(&without, 0.95);
    printf("  %s\n", settings);
    printf("    asking %zu silent nodes in %zu estimates: median %.3f m, p95 %.3f m, RMSE %.3f m\n", asked, with.count,
           samples_quantile(&with, 0.5), asking, samples_rms(&with));
    printf("    not asking: median %.3f m, p95 %.3f m, RMSE %.3f m\n", samples_quantile(&without, 0.5), not_asking,
           samples_rms(&without));
    expect_at_most("95th percentile with asking, of that without", asking / not_asking, 0.9);
    samples_free(&with);
    samples_free(&without);
}

static void silence_helps_against_noise(void) { silence_helps("sensor.relative_noise=0.05"); }

static void silence_helps_where_few_nodes_report_by_themselves(void)
{
    silence_helps("sensor.relative_noise=0.01 sensor.additive_noise=0.02 tracker.chi=1");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(silence_helps_against_noise);
    RUN_TEST(silence_helps_where_few_nodes_report_by_themselves);
    port_exit(UNITY_END() > 0);
}
