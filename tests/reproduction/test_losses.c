/* Readings that never came and reports that were lost: whatever is lost, what reaches the head is made of samples that were really taken,
 * and the trackers stay sound. */
#include "experiment.h"
#include "port.h"
#include "readings.h"
#include "simulation.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

void setUp(void) {}
void tearDown(void) {}

static struct check {
    const struct readings *readings;
    double interval_ms;
    unsigned reports, without_increment, estimates;
} check;

/* Every report on the air, on whichever hop, is what its node's samples make it. */
static void hear_frame(void *context, double time_s, mh_node_id sender, mh_node_id destination, const uint8_t *bytes,
                       size_t length)
{
    (void)context, (void)time_s, (void)sender, (void)destination;
    struct mh_message message;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_wire_decode(mh_wire_all, bytes, length, &message));
    if (message.kind != MH_MESSAGE_REPORT) {
        return;
    }
    const mh_report_t *report = &message.as.report;
    const size_t instant = (size_t)lround((uint32_t)report->time_ms / check.interval_ms), node = (size_t)report->origin;
    TEST_ASSERT_TRUE(instant < check.readings->instants && node < check.readings->deployment.count);
    TEST_ASSERT_TRUE(readings_at(check.readings, instant, node)->came);
    TEST_ASSERT_EQUAL_INT32(readings_at(check.readings, instant, node)->value, report->value_q20);
    mh_q20 increment = 0;
    const bool has_increment = readings_increment(check.readings, instant, node, &increment);
    TEST_ASSERT_EQUAL_INT(has_increment, (report->flags & MH_MEASUREMENT_HAS_INCREMENT) != 0);
    TEST_ASSERT_EQUAL_INT32(increment, report->increment_q20);
    check.reports++;
    check.without_increment += !has_increment;
}

static void hear_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                          const struct truth *at_time, const struct truth *at_arrival)
{
    (void)context, (void)time_s, (void)head, (void)at_time, (void)at_arrival;
    const struct mh_sym2 *covariance = &estimate->covariance;
    TEST_ASSERT_TRUE(mh_finite(estimate->position.x) && mh_finite(estimate->position.y));
    TEST_ASSERT_TRUE(mh_finite(estimate->raw.x) && mh_finite(estimate->raw.y));
    TEST_ASSERT_TRUE(mh_finite(estimate->velocity.x) && mh_finite(estimate->velocity.y));
    TEST_ASSERT_TRUE(mh_finite(covariance->xx) && mh_finite(covariance->xy) && mh_finite(covariance->yy));
    const bool none = covariance->xx == 0 && covariance->xy == 0 && covariance->yy == 0;
    TEST_ASSERT_TRUE(none || (covariance->xx > 0 && covariance->xx * covariance->yy > covariance->xy * covariance->xy));
    check.estimates++;
}

/* Every tracker with 10 and 30 % of the readings lost, of the frames lost on each hop, and of the reports lost on the only hop there is; and with
 * 20 samples lost in a row. */
static void what_reaches_the_head_was_measured(void)
{
    static const char *const trackers[] = {"luo", "diffusion"};
    static const char *const losses[] = {
        "sensor.loss=0.1",
        "sensor.loss=0.3",
        "radio.loss=0.1",
        "radio.loss=0.3",
        "network.protocol=direct radio.range_m=200 radio.loss=0.1",
        "network.protocol=direct radio.range_m=200 radio.loss=0.3",
        "sensor.outage_start_s=40 sensor.outage_s=20",
        "sensor.loss=0.3 radio.loss=0.3 sensor.outage_start_s=40 sensor.outage_s=20",
    };
    static const struct observer observer = {.estimate = hear_estimate, .frame = hear_frame};
    for (size_t i = 0; i < 2; i++) {
        for (size_t j = 0; j < sizeof losses / sizeof losses[0]; j++) {
            char settings[300], error[300] = "";
            struct scenario scenario;
            struct readings readings;
            struct simulation_counters counters;
            snprintf(settings, sizeof settings,
                     "tracker.name=%s sensor.relative_noise=0.01 sensor.additive_noise=0.02 %s", trackers[i],
                     losses[j]);
            experiment_scenario("luo_exp1", settings, &scenario);
            const uint64_t seed = 100 + j;
            readings_make(&readings, &scenario, seed);
            check = (struct check){.readings = &readings, .interval_ms = 1000 * scenario.sensor.interval_s};
            TEST_ASSERT_EQUAL_INT_MESSAGE(
                0, simulation_run(&scenario, seed, &observer, NULL, &counters, error, sizeof error), error);
            printf("  %s %s: %u reports on the air, %u without an increment, %u estimates\n", trackers[i], losses[j],
                   check.reports, check.without_increment, check.estimates);
            TEST_ASSERT_TRUE(check.reports > 1000 && check.estimates > 20);
            readings_free(&readings);
            scenario_free(&scenario);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_reaches_the_head_was_measured);
    port_exit(UNITY_END() > 0);
}
