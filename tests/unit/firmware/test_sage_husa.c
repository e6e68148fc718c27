#include "motehound/sage_husa.h"
#include "port.h"
#include "reals.h"

void setUp(void) {}
void tearDown(void) {}

static struct mh_sage_husa_config config;

static struct mh_sage_husa begin(float estimate)
{
    struct mh_sage_husa filter;
    mh_sage_husa_config_default(&config);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sage_husa_init(&filter, &config, mh_real_from_float(estimate)));
    return filter;
}

static enum mh_status step(struct mh_sage_husa *filter, float measurement, float input, mh_share weight)
{
    return mh_sage_husa_step(filter, &config, mh_real_from_float(measurement), mh_real_from_float(input), weight);
}

static void expect_weight(float expected, uint32_t l)
{
    const mh_share share = mh_sage_husa_weight(MH_REAL(0.97f), l);
    TEST_ASSERT_FLOAT_WITHIN(FLOAT_FIXED(1e-6f, 2e-6f), expected, (float)share / (float)MH_SHARE(1.0f));
}

static void weight(void)
{
    expect_weight(0, 1);
    expect_weight(0.001773f, 3); /* 0.03 (1 - 0.97^2) */
    expect_weight(0.0285292f, 100);
    expect_weight(0.03f, UINT32_MAX);
}

/* The recursion of Appendix 2 by hand, in double precision. */
static void two_steps(void)
{
    struct mh_sage_husa filter = begin(2);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(&filter, 5.0f, 1.5f, MH_SHARE(0.1f)));
    EXPECT_REAL(1e-5f, 5e-5f, 4.2782101f, filter.estimate);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(&filter, 3.0f, -0.5f, MH_SHARE(0.2f)));
    EXPECT_REAL(1e-5f, 5e-5f, 3.4722136f, filter.estimate);
    EXPECT_REAL(1e-5f, 5e-5f, 2.6602433f, filter.estimate_variance);
    EXPECT_REAL(1e-5f, 5e-5f, 0.0010575f, filter.process_mean);
    EXPECT_REAL(1e-5f, 5e-5f, 0.0010000f, filter.process_variance);
    EXPECT_REAL(1e-5f, 5e-5f, -0.0512062f, filter.measurement_mean);
    EXPECT_REAL(1e-5f, 5e-5f, 5.5782501f, filter.measurement_variance);
}

/* With weight 0 it is a Kalman filter, whose variance settles where P^2 + G P = G R. */
static void kalman_limit(void)
{
    struct mh_sage_husa filter = begin(0);
    for (uint8_t i = 0; i < 100; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, step(&filter, 1, 0, MH_SHARE(0.0f)));
    }
    EXPECT_REAL(1e-5f, 5e-5f, 2.7015621f, filter.estimate_variance); /* (sqrt(41) - 1) / 2 */
    EXPECT_REAL(1e-5f, 5e-5f, 1, filter.estimate);
}

/* A measurement that never surprises drives G and R down: they stop at their floors, P stays positive. */
static void floors_hold(void)
{
    struct mh_sage_husa filter = begin(0);
    for (uint16_t i = 0; i < 300; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, step(&filter, 0, 0, MH_SHARE(0.3f)));
        TEST_ASSERT_TRUE(filter.estimate_variance > 0);
        TEST_ASSERT_TRUE(filter.process_variance >= config.process_floor);
        TEST_ASSERT_TRUE(filter.measurement_variance >= config.measurement_floor);
    }
    EXPECT_REAL(0, 0, mh_real_to_float(config.measurement_floor), filter.measurement_variance);
    EXPECT_REAL(1e-4f, 3e-4f, mh_real_to_float(config.process_floor), filter.process_variance);
    /* a surprise of 1e6 m (or 80 m) is a surprise, not the end */
    TEST_ASSERT_EQUAL_INT(MH_OK, step(&filter, FLOAT_FIXED(1e6f, 80.0f), 0, MH_SHARE(1.0f)));
    TEST_ASSERT_TRUE(mh_finite(filter.estimate) && filter.estimate_variance > 0);
}

static void bad_input_changes_nothing(void)
{
    struct mh_sage_husa filter = begin(2);
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, step(&filter, NAN, 0, MH_SHARE(0.1f)));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, step(&filter, 0, INFINITY, MH_SHARE(0.1f)));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, step(&filter, 0, 0, NOT_A_NUMBER));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, step(&filter, FLOAT_FIXED(2e9f, 9000.0f), 0, MH_SHARE(0.1f)));
    TEST_ASSERT_EQUAL_INT(FLOAT_FIXED(MH_ERR_RANGE, MH_ERR_NOT_FINITE), step(&filter, 0, 0, MH_SHARE(1.5f)));
    EXPECT_REAL(0, 0, 2, filter.estimate);
    EXPECT_REAL(0, 0, 10, filter.estimate_variance);
    EXPECT_REAL(0, 0, 0, filter.measurement_mean);
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_sage_husa_init(&filter, &config, NOT_A_NUMBER));
    config.process_floor = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_sage_husa_init(&filter, &config, 0));
    config.process_floor = MH_REAL(1.0f);
    config.measurement_variance = NOT_A_NUMBER;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_sage_husa_init(&filter, &config, 0));
    EXPECT_REAL(0, 0, 2, filter.estimate);
}

#if MH_REAL_FIXED
/* What has no room is refused and leaves the filter as it was: too far a surprise, too large a variance, an estimate or a mean out of the format. */
static void what_has_no_room_is_refused(void)
{
    struct mh_sage_husa filter = begin(2);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(&filter, 5, 1, MH_SHARE(0.1f)));
    filter.measurement_variance = MH_REAL(7990.0f);
    const struct mh_sage_husa kept = filter;
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, step(&filter, 500, 0, MH_SHARE(0.1f)));  /* 500^2 */
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, step(&filter, -175, 0, MH_SHARE(0.1f))); /* R = 9,700 m2 */
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, step(&filter, 7990, 7999, MH_SHARE(0.0f)));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, step(&filter, -7999, 7999, MH_SHARE(0.03f)));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, step(&filter, 40000, 0, MH_SHARE(0.1f)));
    TEST_ASSERT_EQUAL_MEMORY(&kept, &filter, sizeof kept);
    filter.estimate = MH_REAL(7990.0f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(&filter, 7999, 1, MH_SHARE(0.1f)));
    filter.estimate = MH_REAL(8001.0f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, step(&filter, 7999, 0, MH_SHARE(0.1f)));
    config.process_variance = MH_REAL(9000.0f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_sage_husa_init(&filter, &config, 0));
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(weight);
    RUN_TEST(two_steps);
    RUN_TEST(kalman_limit);
    RUN_TEST(floors_hold);
#if MH_REAL_FIXED
    RUN_TEST(what_has_no_room_is_refused);
#endif
    RUN_TEST(bad_input_changes_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
