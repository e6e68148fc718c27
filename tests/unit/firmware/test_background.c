#include "motehound/background.h"
#include "port.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

static uint32_t random_state;

/* Even in [0, 1). */
static mh_real chance(void)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (mh_real)(random_state >> 8) * (1.0f / 16777216.0f);
}

static void begins_with_the_first_reading(void)
{
    const struct mh_background_config config = {.quantile = 0.2f, .step = 0.1f};
    struct mh_background background = {.known = false};
    mh_real excess = -1;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_background_take(&background, &config, 2.0f, &excess));
    TEST_ASSERT_EQUAL_FLOAT(0, excess);
    TEST_ASSERT_EQUAL_FLOAT(2.0f, background.level);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_background_take(&background, &config, 3.0f, &excess));
    TEST_ASSERT_EQUAL_FLOAT(1.0f, excess); /* above the level before */
    TEST_ASSERT_EQUAL_FLOAT(2.02f, background.level);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_background_take(&background, &config, 1.0f, &excess));
    TEST_ASSERT_EQUAL_FLOAT(-1.02f, excess);
    TEST_ASSERT_EQUAL_FLOAT(1.94f, background.level);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_background_take(&background, &config, 1.93f, &excess));
    TEST_ASSERT_EQUAL_FLOAT(1.93f, background.level); /* not beyond the reading */
}

static void settles_at_the_quantile_whatever_the_spikes(void)
{
    const struct mh_background_config config = {.quantile = 0.2f, .step = 0.002f};
    struct mh_background background = {.known = false};
    mh_real excess, mean = 0;
    random_state = 1;
    for (uint16_t i = 0; i < 20000; i++) {
        const mh_real reading = chance() < 0.1f ? 2000.0f : 2.0f + chance();
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_background_take(&background, &config, reading, &excess));
        mean += i < 10000 ? 0 : background.level / 10000.0f;
    }
    /* one in ten is a spike: 0.2 of all is 0.2 / 0.9 of the others */
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 2.0f + 0.2f / 0.9f, mean);
}

static void refuses_what_is_no_number(void)
{
    const struct mh_background_config config = {.quantile = 0.2f, .step = 0.1f};
    struct mh_background background = {.known = true, .level = 2.0f};
    mh_real excess = 7;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_background_take(&background, &config, NAN, &excess));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_background_take(&background, &config, INFINITY, &excess));
    TEST_ASSERT_EQUAL_FLOAT(2.0f, background.level);
    TEST_ASSERT_EQUAL_FLOAT(7.0f, excess);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(begins_with_the_first_reading);
    RUN_TEST(settles_at_the_quantile_whatever_the_spikes);
    RUN_TEST(refuses_what_is_no_number);
    port_exit(UNITY_END() > 0);
    return 0;
}
