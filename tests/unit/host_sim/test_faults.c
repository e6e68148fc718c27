#include "port.h"
#include "scenarios.h"
#include "unity.h"
#include "world/faults.h"
#include "world/sensor.h"

#include <math.h>
#include <stdlib.h>

enum { NODES = 10000, INSTANTS = 40, FROM = 10, UNTIL = 20 };

static double concentrations[NODES];
static int32_t counts[INSTANTS][NODES];

void setUp(void) {}
void tearDown(void) {}

static struct scenario coarse(void)
{
    struct scenario scenario = e1();
    scenario.sensor.adc_bits = 10; /* a count is 1/16 g/m2 */
    return scenario;
}

/* Every node reads 1/4 g/m2 at instant 0 and one count more at each after that. */
static void read_all(const struct scenario *scenario)
{
    struct sensors sensors;
    TEST_ASSERT_EQUAL_INT(0, sensors_make(&sensors, scenario, 1, NODES));
    for (int k = 0; k < INSTANTS; k++) {
        for (int i = 0; i < NODES; i++) {
            concentrations[i] = (4 + k) / 16.0;
        }
        sensors_read(&sensors, (uint64_t)k, concentrations, counts[k]);
    }
    sensors_free(&sensors);
}

static bool is_right(int instant, int node) { return counts[instant][node] == 4 + instant; }

static int wrong(int instant)
{
    int sum = 0;
    for (int i = 0; i < NODES; i++) {
        sum += !is_right(instant, i);
    }
    return sum;
}

/* A share of 0.2 of 10,000 nodes: 2,000 with a standard deviation of 40. */
static void expect_a_fifth(int instant) { TEST_ASSERT_INT_WITHIN(160, 2000, wrong(instant)); }

static void expect_none_outside(void)
{
    for (int k = 0; k < INSTANTS; k++) {
        if (k < FROM || k >= UNTIL) {
            TEST_ASSERT_EQUAL_INT(0, wrong(k));
        }
    }
}

static void stuck_sensors_repeat_their_last_reading(void)
{
    struct scenario scenario = coarse();
    scenario.faults.stuck.share = 0.2;
    scenario.faults.stuck.from_s = FROM;
    scenario.faults.stuck.for_s = UNTIL - FROM;
    read_all(&scenario);
    expect_none_outside();
    expect_a_fifth(FROM);
    for (int i = 0; i < NODES; i++) {
        const bool stuck = !is_right(FROM, i);
        for (int k = FROM; k < UNTIL; k++) {
            TEST_ASSERT_EQUAL_INT32(stuck ? 4 + FROM - 1 : 4 + k, counts[k][i]);
        }
    }
}

static void biased_sensors_read_too_much(void)
{
    struct scenario scenario = coarse();
    scenario.faults.bias.share = 0.2;
    scenario.faults.bias.from_s = FROM;
    scenario.faults.bias.for_s = UNTIL - FROM;
    scenario.faults.bias.offset = 2;
    read_all(&scenario);
    expect_none_outside();
    expect_a_fifth(FROM);
    for (int i = 0; i < NODES; i++) {
        for (int k = FROM; k < UNTIL; k++) {
            TEST_ASSERT_EQUAL_INT32(4 + k + (is_right(FROM, i) ? 0 : 32), counts[k][i]);
        }
    }
}

static void saturating_sensors_read_no_more(void)
{
    struct scenario scenario = coarse();
    scenario.faults.saturate.share = 0.2;
    scenario.faults.saturate.for_s = 1e6;
    scenario.faults.saturate.at = 20 / 16.0;
    read_all(&scenario);
    for (int k = 0; k <= 16; k++) {
        TEST_ASSERT_EQUAL_INT(0, wrong(k));
    }
    expect_a_fifth(17);
    for (int i = 0; i < NODES; i++) {
        TEST_ASSERT_EQUAL_INT32(is_right(17, i) ? 4 + 39 : 20, counts[39][i]);
    }
}

static void spiking_sensors_spike_now_and_then(void)
{
    struct scenario scenario = coarse();
    scenario.faults.spike.share = 0.2;
    scenario.faults.spike.from_s = FROM;
    scenario.faults.spike.for_s = UNTIL - FROM;
    scenario.faults.spike.chance = 0.5;
    scenario.faults.spike.height = 3;
    read_all(&scenario);
    expect_none_outside();
    int spiking = 0, spikes = 0;
    for (int i = 0; i < NODES; i++) {
        int of_node = 0;
        for (int k = FROM; k < UNTIL; k++) {
            of_node += !is_right(k, i);
            TEST_ASSERT_TRUE(is_right(k, i) || counts[k][i] == 4 + k + 48);
        }
        spiking += of_node > 0;
        spikes += of_node;
    }
    TEST_ASSERT_INT_WITHIN(160, 2000, spiking); /* one in a thousand spiking sensors does not in ten instants */
    TEST_ASSERT_INT_WITHIN(900, 10000, spikes);
}

/* Each period hits other motes, with the same share; faults do not hit the same motes as other faults do. */
static void faults_come_again_and_hit_others(void)
{
    struct scenario scenario = e1();
    struct faults faults;
    scenario.faults.every_s = 100;
    scenario.faults.stuck.share = scenario.faults.reboot.share = 0.5;
    scenario.faults.stuck.from_s = scenario.faults.reboot.from_s = 30;
    scenario.faults.stuck.for_s = scenario.faults.reboot.for_s = 20;
    faults_make(&faults, &scenario, 7);
    int same = 0, both = 0;
    for (uint32_t i = 0; i < NODES; i++) {
        const bool hit = faults_hit(&faults, FAULT_STUCK, 35, i);
        TEST_ASSERT_EQUAL(hit, faults_hit(&faults, FAULT_STUCK, 49.9, i));
        TEST_ASSERT_FALSE(faults_hit(&faults, FAULT_STUCK, 29.9, i) || faults_hit(&faults, FAULT_STUCK, 50, i));
        same += hit == faults_hit(&faults, FAULT_STUCK, 235, i);
        both += hit == faults_hit(&faults, FAULT_REBOOT, 35, i);
    }
    TEST_ASSERT_INT_WITHIN(200, NODES / 2, same);
    TEST_ASSERT_INT_WITHIN(200, NODES / 2, both);
    TEST_ASSERT_TRUE(faults_are_on(&faults, FAULT_STUCK, 1030) && !faults_are_on(&faults, FAULT_STUCK, 1060));
    TEST_ASSERT_TRUE(faults_include(&faults, FAULT_STUCK) && !faults_include(&faults, FAULT_JAM));
}

/* 30, 50, 100, 130, 150, 200 ...: it begins, it ends, and with the next period other motes are drawn. */
static void changes_are_found_one_after_the_other(void)
{
    struct scenario scenario = e1();
    struct faults faults;
    scenario.faults.every_s = 100;
    scenario.faults.reboot.share = 0.5;
    scenario.faults.reboot.from_s = 30;
    scenario.faults.reboot.for_s = 20;
    faults_make(&faults, &scenario, 7);
    const double expected[] = {30, 50, 100, 130, 150, 200};
    double time_s = 0;
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        time_s = faults_next_change_s(&faults, FAULT_REBOOT, time_s);
        TEST_ASSERT_TRUE(fabs(time_s - expected[i]) < 1e-9);
    }
    TEST_ASSERT_TRUE(isinf(faults_next_change_s(&faults, FAULT_DEAD, 0)));
    scenario.faults.every_s = 0;
    faults_make(&faults, &scenario, 7);
    TEST_ASSERT_TRUE(isinf(faults_next_change_s(&faults, FAULT_REBOOT, 50)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(stuck_sensors_repeat_their_last_reading);
    RUN_TEST(biased_sensors_read_too_much);
    RUN_TEST(saturating_sensors_read_no_more);
    RUN_TEST(spiking_sensors_spike_now_and_then);
    RUN_TEST(faults_come_again_and_hit_others);
    RUN_TEST(changes_are_found_one_after_the_other);
    port_exit(UNITY_END() > 0);
}
