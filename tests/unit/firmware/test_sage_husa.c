#include "motehound/sage_husa.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static struct mh_sage_husa_config config;

static struct mh_sage_husa begin(mh_real estimate)
{
    struct mh_sage_husa filter;
    mh_sage_husa_config_default(&config);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sage_husa_init(&filter, &config, estimate));
    return filter;
}

static void weight(void)
{
    TEST_ASSERT_FLOAT_WITHIN(1e-8f, 0, mh_sage_husa_weight(0.97f, 1));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.001773f, mh_sage_husa_weight(0.97f, 3)); /* 0.03 (1 - 0.97^2) */
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.0285292f, mh_sage_husa_weight(0.97f, 100));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.03f, mh_sage_husa_weight(0.97f, UINT32_MAX));
}

/* The recursion of Appendix 2 by hand, in double precision. */
static void two_steps(void)
{
    struct mh_sage_husa filter = begin(2);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sage_husa_step(&filter, &config, 5.0f, 1.5f, 0.1f));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 4.2782101f, filter.estimate);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sage_husa_step(&filter, &config, 3.0f, -0.5f, 0.2f));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 3.4722136f, filter.estimate);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 2.6602433f, filter.estimate_variance);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.0010575f, filter.process_mean);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.0010000f, filter.process_variance);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, -0.0512062f, filter.measurement_mean);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 5.5782501f, filter.measurement_variance);
}

/* With weight 0 it is a Kalman filter, whose variance settles where P^2 + G P = G R. */
static void kalman_limit(void)
{
    struct mh_sage_husa filter = begin(0);
    for (uint8_t i = 0; i < 100; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_sage_husa_step(&filter, &config, 1, 0, 0));
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 2.7015621f, filter.estimate_variance); /* (sqrt(41) - 1) / 2 */
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1, filter.estimate);
}

/* A measurement that never surprises drives G and R down: they stop at their floors, P stays positive. */
static void floors_hold(void)
{
    struct mh_sage_husa filter = begin(0);
    for (uint16_t i = 0; i < 300; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_sage_husa_step(&filter, &config, 0, 0, 0.3f));
        TEST_ASSERT_TRUE(filter.estimate_variance > 0);
        TEST_ASSERT_TRUE(filter.process_variance >= config.process_floor);
        TEST_ASSERT_TRUE(filter.measurement_variance >= config.measurement_floor);
    }
    TEST_ASSERT_EQUAL_FLOAT(config.measurement_floor, filter.measurement_variance);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, config.process_floor, filter.process_variance);
    /* a surprise of 1e6 m is a surprise, not the end */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sage_husa_step(&filter, &config, 1e6f, 0, 1));
    TEST_ASSERT_TRUE(mh_finite(filter.estimate) && filter.estimate_variance > 0);
}

static void bad_input_changes_nothing(void)
{
    struct mh_sage_husa filter = begin(2);
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_sage_husa_step(&filter, &config, NAN, 0, 0.1f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_sage_husa_step(&filter, &config, 0, INFINITY, 0.1f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_sage_husa_step(&filter, &config, 0, 0, NAN));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_sage_husa_step(&filter, &config, 2e9f, 0, 0.1f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_sage_husa_step(&filter, &config, 0, 0, 1.5f));
    TEST_ASSERT_EQUAL_FLOAT(2, filter.estimate);
    TEST_ASSERT_EQUAL_FLOAT(10, filter.estimate_variance);
    TEST_ASSERT_EQUAL_FLOAT(0, filter.measurement_mean);
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_sage_husa_init(&filter, &config, NAN));
    config.process_floor = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_sage_husa_init(&filter, &config, 0));
    config.process_floor = 1;
    config.measurement_variance = NAN;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_sage_husa_init(&filter, &config, 0));
    TEST_ASSERT_EQUAL_FLOAT(2, filter.estimate);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(weight);
    RUN_TEST(two_steps);
    RUN_TEST(kalman_limit);
    RUN_TEST(floors_hold);
    RUN_TEST(bad_input_changes_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
