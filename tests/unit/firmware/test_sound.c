#include "motehound/sound.h"
#include "port.h"
#include "unity.h"

#include <math.h>

#define R mh_real_from_float
#define F mh_real_to_float

void setUp(void) {}
void tearDown(void) {}

static const struct mh_sound sound = {MH_REAL(1600.0f), MH_REAL(0.19f), MH_REAL(0.05f)};

static void energy_falls_with_the_square_of_the_distance(void)
{
    TEST_ASSERT_EQUAL_FLOAT(1, F(mh_sound_energy(&sound, R(1600))));
    TEST_ASSERT_EQUAL_FLOAT(4, F(mh_sound_energy(&sound, R(400))));
    TEST_ASSERT_EQUAL_FLOAT(1600, F(mh_sound_energy(&sound, R(1))));
    TEST_ASSERT_EQUAL_FLOAT(1600, F(mh_sound_energy(&sound, R(0.3f))));
    TEST_ASSERT_EQUAL_FLOAT(1600, F(mh_sound_energy(&sound, R(0)))); /* on the node */
}

static void variances(void)
{
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 1e-4f : 1e-6f, 0.0361f * 16 + 0.0025f, F(mh_sound_variance(&sound, R(4))));
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 1e-4f : 1e-6f, 0.0361f + 0.0025f / 16,
                             F(mh_sound_log_variance(&sound, R(4))));
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 1e-4f : 1e-6f, 0.0025f, F(mh_sound_variance(&sound, R(0))));
}

/* exp(-lambda (d - 32)^beta) between 32 and 48 m, computed with 64 bits */
static void detection_fades_over_the_margin(void)
{
    const struct mh_sound_detection detection = {R(40), R(8), R(0.0061f), R(2.28f)};
    TEST_ASSERT_EQUAL_FLOAT(1, F(mh_sound_detected(&detection, R(0))));
    TEST_ASSERT_EQUAL_FLOAT(1, F(mh_sound_detected(&detection, R(32))));
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 2e-3f : 1e-5f, 0.9939186f, F(mh_sound_detected(&detection, R(33))));
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 2e-3f : 1e-5f, 0.8659841f, F(mh_sound_detected(&detection, R(36))));
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 2e-3f : 1e-5f, 0.4971639f, F(mh_sound_detected(&detection, R(40))));
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 2e-3f : 1e-5f, 0.0335711f, F(mh_sound_detected(&detection, R(48))));
    TEST_ASSERT_EQUAL_FLOAT(0, F(mh_sound_detected(&detection, R(48.01f))));
}

static void ranges_of_the_model(void)
{
    TEST_ASSERT_TRUE(mh_sound_valid(&sound));
    const struct mh_sound wrong[] = {
        {R(0), R(0.19f), R(0.05f)},    {R(-1600), R(0.19f), R(0.05f)},   {R(NAN), R(0.19f), R(0.05f)},
        {R(1600), R(-0.1f), R(0.05f)}, {R(1600), R(0.19f), R(-1)},       {R(1600), R(0), R(0)},
        {R(1600), R(NAN), R(0.05f)},   {R(1600), R(0.19f), R(INFINITY)}, {R(INFINITY), R(0.19f), R(0)}};
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        TEST_ASSERT_FALSE(mh_sound_valid(&wrong[i]));
    }
    const struct mh_sound additive = {R(1600), 0, R(0.36f)};
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
