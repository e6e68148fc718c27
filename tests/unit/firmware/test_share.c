/* Shares against what they stand for, computed in float. */
#include "motehound/share.h"
#include "port.h"
#include "reals.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

static float value(mh_share share) { return (float)share / (float)MH_SHARE(1.0f); }

static void parts(void)
{
    EXPECT_REAL(1e-4f, 1e-5f, 0.03f * 1234.5f, mh_part(MH_SHARE(0.03f), MH_REAL(1234.5f)));
    EXPECT_REAL(1e-4f, 1e-5f, -0.03f * 1234.5f, mh_part(MH_SHARE(-0.03f), MH_REAL(1234.5f)));
    EXPECT_REAL(0, 0, 32000, mh_part(MH_SHARE(1.0f), MH_REAL(32000.0f)));
    EXPECT_REAL(1e-3f, 2e-5f, 0.25f * -8000 + 0.75f * 16000,
                mh_blend(MH_SHARE(0.75f), MH_REAL(-8000.0f), MH_REAL(16000.0f)));
    TEST_ASSERT_FLOAT_WITHIN(1e-9f, 1e-3f, value(mh_share_of(MH_REAL(0.0625f), MH_REAL(62.5f))));
    TEST_ASSERT_FLOAT_WITHIN(1e-7f, 1, value(mh_share_of(MH_REAL(5.0f), MH_REAL(5.0f))));
}

static void powers(void)
{
    const mh_share share = MH_SHARE(0.9375f);
    float expected = 1;
    for (uint8_t n = 0; n < 100; n++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, expected, value(mh_share_power(share, n)));
        expected *= 0.9375f;
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-9f, 0, value(mh_share_power(share, UINT32_MAX)));
}

/* All directions, from the last place of a real to as far as there is room. */
static void turns(void)
{
    for (uint8_t i = 0; i < 24; i++) {
        const float angle = 0.2618f * (float)i + 0.1f;
        for (int k = 0; k < 30; k += 3) {
            const mh_real size = mh_real_from_ratio((int32_t)1 << k, 65536);
            const mh_real a = mh_mul(mh_real_from_float((float)cosf(angle)), size),
                          b = mh_mul(mh_real_from_float((float)sinf(angle)), size);
            mh_share c, s;
            if (a == 0 && b == 0) {
                continue;
            }
            TEST_ASSERT_TRUE(mh_turn(a, b, &c, &s));
            const float x = mh_real_to_float(a), y = mh_real_to_float(b), length = (float)sqrtf(x * x + y * y);
            TEST_ASSERT_FLOAT_WITHIN(3e-7f, x / length, value(c));
            TEST_ASSERT_FLOAT_WITHIN(3e-7f, y / length, value(s));
            TEST_ASSERT_FLOAT_WITHIN(1e-6f * length + FLOAT_FIXED(0, 1e-5f), length,
                                     mh_real_to_float(mh_turned(c, a, s, b)));
            TEST_ASSERT_FLOAT_WITHIN(1e-6f * length + FLOAT_FIXED(0, 1e-5f), 0,
                                     mh_real_to_float(mh_turned(c, b, -s, a)));
            TEST_ASSERT_FLOAT_WITHIN(1e-6f * length + FLOAT_FIXED(0, 1e-5f), length, mh_real_to_float(mh_hypot(a, b)));
        }
    }
    mh_share c, s;
    TEST_ASSERT_FALSE(mh_turn(0, 0, &c, &s));
    EXPECT_REAL(0, 0, 0, mh_hypot(0, 0));
    EXPECT_REAL(1e-2f, 2e-3f, 18000, mh_hypot(0, MH_REAL(-18000.0f)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(parts);
    RUN_TEST(powers);
    RUN_TEST(turns);
    port_exit(UNITY_END() > 0);
    return 0;
}
