#include "motehound/gaussian.h"
#include "motehound/white_acceleration.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static const struct mh_white_acceleration model = {500, {5e-5f, 1e-4f}};

static void one_tick(void)
{
    mh_real F[16], Q[10];
    mh_white_acceleration(&model, 500, F, Q);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, F[1]);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, F[11]);
    TEST_ASSERT_FLOAT_WITHIN(1e-12f, 7.8125e-7f, Q[MH_PACKED(0, 0)]);
    TEST_ASSERT_FLOAT_WITHIN(1e-12f, 3.125e-6f, Q[MH_PACKED(0, 1)]);
    TEST_ASSERT_FLOAT_WITHIN(1e-11f, 1.25e-5f, Q[MH_PACKED(1, 1)]);
    TEST_ASSERT_FLOAT_WITHIN(1e-12f, 1.5625e-6f, Q[MH_PACKED(2, 2)]);
    TEST_ASSERT_FLOAT_WITHIN(1e-11f, 2.5e-5f, Q[MH_PACKED(3, 3)]);
    mh_white_acceleration(&model, 0, F, Q);
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_EQUAL_FLOAT(0, Q[i]);
    }
}

/* m ticks and a rest are that many predictions, one after the other */
static void is_a_chain_of_ticks(void)
{
    struct mh_gaussian chained = {4, {10, 0.8f, 20, 0.6f}, {1e-6f, 0, 1e-6f, 0, 0, 1e-6f, 0, 0, 0, 1e-6f}};
    struct mh_gaussian at_once = chained;
    const struct mh_white_acceleration shorter = {200, {5e-5f * 2.5f, 1e-4f * 2.5f}};
    mh_real F[16], Q[10];
    mh_white_acceleration(&model, 500, F, Q);
    for (int tick = 0; tick < 7; tick++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_predict(&chained, F, Q));
    }
    mh_white_acceleration(&shorter, 200, F, Q);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_predict(&chained, F, Q));
    mh_white_acceleration(&model, 3700, F, Q);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_predict(&at_once, F, Q));
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, chained.x[i], at_once.x[i]);
    }
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-5f * mh_abs(chained.P[i]) + 1e-12f, chained.P[i], at_once.P[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(one_tick);
    RUN_TEST(is_a_chain_of_ticks);
    port_exit(UNITY_END() > 0);
    return 0;
}
