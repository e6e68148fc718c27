#include "motehound/sound.h"
#include "port.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

static const struct mh_sound sound = {1600, 0.19f, 0.05f};

static void energy_falls_with_the_square_of_the_distance(void)
{
    TEST_ASSERT_EQUAL_FLOAT(1, mh_sound_energy(&sound, 1600));
    TEST_ASSERT_EQUAL_FLOAT(4, mh_sound_energy(&sound, 400));
    TEST_ASSERT_EQUAL_FLOAT(1600, mh_sound_energy(&sound, 1));
    TEST_ASSERT_EQUAL_FLOAT(1600, mh_sound_energy(&sound, 0.3f));
    TEST_ASSERT_EQUAL_FLOAT(1600, mh_sound_energy(&sound, 0)); /* on the node */
}

static void variances(void)
{
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.0361f * 16 + 0.0025f, mh_sound_variance(&sound, 4));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.0361f + 0.0025f / 16, mh_sound_log_variance(&sound, 4));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.0025f, mh_sound_variance(&sound, 0));
}

/* exp(-lambda (d - 32)^beta) between 32 and 48 m, computed with 64 bits */
static void detection_fades_over_the_margin(void)
{
    const struct mh_sound_detection detection = {40, 8, 0.0061f, 2.28f};
    TEST_ASSERT_EQUAL_FLOAT(1, mh_sound_detected(&detection, 0));
    TEST_ASSERT_EQUAL_FLOAT(1, mh_sound_detected(&detection, 32));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.9939186f, mh_sound_detected(&detection, 33));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.8659841f, mh_sound_detected(&detection, 36));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.4971639f, mh_sound_detected(&detection, 40));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.0335711f, mh_sound_detected(&detection, 48));
    TEST_ASSERT_EQUAL_FLOAT(0, mh_sound_detected(&detection, 48.01f));
}

static void ranges_of_the_model(void)
{
    TEST_ASSERT_TRUE(mh_sound_valid(&sound));
    const struct mh_sound wrong[] = {{0, 0.19f, 0.05f},    {-1600, 0.19f, 0.05f},   {NAN, 0.19f, 0.05f},
                                     {1600, -0.1f, 0.05f}, {1600, 0.19f, -1},       {1600, 0, 0},
                                     {1600, NAN, 0.05f},   {1600, 0.19f, INFINITY}, {INFINITY, 0.19f, 0}};
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        TEST_ASSERT_FALSE(mh_sound_valid(&wrong[i]));
    }
    const struct mh_sound additive = {1600, 0, 0.36f};
    TEST_ASSERT_TRUE(mh_sound_valid(&additive));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(energy_falls_with_the_square_of_the_distance);
    RUN_TEST(variances);
    RUN_TEST(detection_fades_over_the_margin);
    RUN_TEST(ranges_of_the_model);
    port_exit(UNITY_END() > 0);
    return 0;
}
