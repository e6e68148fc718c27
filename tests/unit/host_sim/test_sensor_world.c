#include "port.h"
#include "scenarios.h"
#include "unity.h"
#include "world/field.h"
#include "world/sensor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NODES = 1000 };

static double concentrations[NODES];
static int32_t counts[NODES];
static struct sensors sensors;

void setUp(void) { sensors = (struct sensors){0}; }
void tearDown(void) { sensors_free(&sensors); }

static void read_all(uint64_t instant, double concentration)
{
    for (int i = 0; i < NODES; i++) {
        concentrations[i] = concentration;
    }
    sensors_read(&sensors, instant, concentrations, counts);
}

static void ideal_converter_gives_q20(void)
{
    const struct scenario scenario = e1();
    const struct mh_sensor_config config = sensor_config(&scenario);
    TEST_ASSERT_EQUAL_INT32(1, config.q20_per_count);
    TEST_ASSERT_EQUAL_INT32(0, config.zero_counts);
    TEST_ASSERT_EQUAL_UINT32(1000, config.interval);
    TEST_ASSERT_EQUAL_INT32(209715, config.threshold);
    TEST_ASSERT_EQUAL_INT(0, sensors_make(&sensors, &scenario, 1, NODES));
    read_all(3, 12.345678);
    TEST_ASSERT_EQUAL_INT32(12945382, counts[7]); /* 12.345678 x 2^20 = 12945381.66 */
    read_all(3, 1e9);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, counts[7]);
}

static void converter_rounds_and_clips(void)
{
    struct scenario scenario = e1();
    scenario.sensor.adc_bits = 10;
    const struct mh_sensor_config config = sensor_config(&scenario);
    TEST_ASSERT_EQUAL_INT32((1 << 26) >> 10, config.q20_per_count);
    TEST_ASSERT_EQUAL_INT32(1023, config.counts_max);
    TEST_ASSERT_EQUAL_INT(0, sensors_make(&sensors, &scenario, 1, NODES));
    read_all(0, 0.0937); /* 1.4992 quanta of 1/16 */
    TEST_ASSERT_EQUAL_INT32(1, counts[0]);
    read_all(0, 0.0938);
    TEST_ASSERT_EQUAL_INT32(2, counts[0]);
    read_all(0, 64);
    TEST_ASSERT_EQUAL_INT32(1023, counts[0]);
}

static void noise_has_its_standard_deviation(void)
{
    struct scenario scenario = e1();
    scenario.sensor.relative_noise = 0.05;
    scenario.sensor.additive_noise = 0.02;
    TEST_ASSERT_EQUAL_INT(0, sensors_make(&sensors, &scenario, 1, NODES));
    enum { INSTANTS = 100 };
    double mean = 0, square = 0;
    for (unsigned p = 0; p < INSTANTS; p++) {
        read_all(p, 10);
        for (int i = 0; i < NODES; i++) {
            const double difference = ldexp(counts[i], -20) - 10;
            mean += difference / (INSTANTS * NODES);
            square += difference * difference / (INSTANTS * NODES);
        }
    }
    const double variance = 0.5 * 0.5 + 0.02 * 0.02, n = INSTANTS * NODES;
    TEST_ASSERT_TRUE(fabs(mean) < 4 * sqrt(variance / n));
    TEST_ASSERT_TRUE(fabs(square / variance - 1) < 4 * sqrt(2 / n));
}

static void readings_are_never_negative(void)
{
    struct scenario scenario = e1();
    scenario.sensor.additive_noise = 0.02;
    TEST_ASSERT_EQUAL_INT(0, sensors_make(&sensors, &scenario, 1, NODES));
    read_all(0, 0);
    int at_zero = 0;
    for (int i = 0; i < NODES; i++) {
        TEST_ASSERT_TRUE(counts[i] >= 0);
        at_zero += counts[i] == 0;
    }
    TEST_ASSERT_TRUE(abs(at_zero - NODES / 2) < 4 * sqrt(NODES / 4.0));
}

static void losses_and_outages(void)
{
    struct scenario scenario = e1();
    scenario.sensor.loss = 0.3;
    scenario.sensor.outage_start_s = 20;
    scenario.sensor.outage_s = 5;
    TEST_ASSERT_EQUAL_INT(0, sensors_make(&sensors, &scenario, 1, NODES));
    unsigned lost = 0;
    for (unsigned p = 0; p < 20; p++) {
        for (unsigned i = 0; i < NODES; i++) {
            lost += sensors_lost(&sensors, p, p, i);
        }
    }
    TEST_ASSERT_TRUE(fabs(lost - 0.3 * 20 * NODES) < 4 * sqrt(20 * NODES * 0.21));
    for (unsigned i = 0; i < NODES; i++) {
        TEST_ASSERT_TRUE(sensors_lost(&sensors, 20, 20, i) && sensors_lost(&sensors, 24, 24, i));
    }
    sensors.loss = 0;
    TEST_ASSERT_FALSE(sensors_lost(&sensors, 19, 19.999, 0));
    TEST_ASSERT_FALSE(sensors_lost(&sensors, 25, 25, 0));
}

/* Path, field, noise and converter together: E2, 1 % + 0.02 g/m2, 12 bits. */
static void known_answers(void)
{
    enum { PLACES = 960, INSTANTS = 126 };
    static float places[PLACES][2], readings[INSTANTS][PLACES];
    FILE *x = fopen(MOTEHOUND_KNOWN_ANSWERS "/luo/g2_X.f32", "rb"),
         *c = fopen(MOTEHOUND_KNOWN_ANSWERS "/luo/g2_C.f32", "rb");
    TEST_ASSERT_TRUE(x && c);
    TEST_ASSERT_EQUAL_UINT(PLACES, fread(places, sizeof places[0], PLACES, x));
    TEST_ASSERT_EQUAL_UINT(INSTANTS, fread(readings, sizeof readings[0], INSTANTS, c));
    fclose(x);
    fclose(c);
    struct scenario scenario = e2();
    scenario.sensor.relative_noise = 0.01;
    scenario.sensor.additive_noise = 0.02;
    scenario.sensor.adc_bits = 12;
    char error[200];
    struct field field;
    TEST_ASSERT_EQUAL_INT(0, field_make(&field, &scenario, 0, error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, sensors_make(&sensors, &scenario, 0, PLACES));
    int different = 0;
    for (int p = 0; p < INSTANTS; p++) {
        TEST_ASSERT_EQUAL_INT(0, field_prepare(&field, p));
        for (int i = 0; i < PLACES; i++) {
            concentrations[i] = field_concentration(&field, (double)places[i][0], (double)places[i][1]);
        }
        sensors_read(&sensors, (uint64_t)p, concentrations, counts);
        for (int i = 0; i < PLACES; i++) {
            const double quanta = (double)readings[p][i] * 64;
            TEST_ASSERT_TRUE(fabs(counts[i] - quanta) <= 1);
            different += counts[i] != (int)lround(quanta);
        }
    }
    field_free(&field);
    TEST_ASSERT_TRUE(different <= 12); /* 1e-4: places rounded to float may tip a reading over a quantum's edge */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(ideal_converter_gives_q20);
    RUN_TEST(converter_rounds_and_clips);
    RUN_TEST(noise_has_its_standard_deviation);
    RUN_TEST(readings_are_never_negative);
    RUN_TEST(losses_and_outages);
    RUN_TEST(known_answers);
    port_exit(UNITY_END() > 0);
    return 0;
}
