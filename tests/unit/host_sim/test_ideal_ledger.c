/* The ledger of an ideal network against its formulas, with the numbers of a Mica2 and IEEE 802.15.4. */
#include "ideal/ledger.h"
#include "port.h"
#include "unity.h"

#include <math.h>

static struct scenario scenario;
static struct ledger ledger;

#define TRANSMIT 0.081 /* mJ/ms */
#define RECEIVE 0.03
#define LISTEN 0.009
#define ACK_MS 0.352
#define BYTE_MS 0.032

static void set(const char *key, const char *value)
{
    char error[300] = "";
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, key, value, error, sizeof error), error);
}

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    set("radio.profile", "802154");
    set("energy.profile", "mica2");
    TEST_ASSERT_EQUAL_INT(0, ledger_make(&ledger, &scenario, 4));
}

void tearDown(void)
{
    ledger_free(&ledger);
    scenario_free(&scenario);
}

static void expect_mj(double expected, uint32_t mote)
{
    TEST_ASSERT_TRUE(fabs(ledger.used_mj[mote] - expected) <= 1e-9 + 1e-4 * expected);
}

static double sum_mj(void)
{
    double sum = 0;
    for (int state = 0; state < ENERGY_STATES; state++) {
        for (int cause = 0; cause < ENERGY_CAUSES; cause++) {
            sum += 1e3 * ledger.joules[state][cause];
        }
    }
    return sum;
}

static void broadcast(void)
{
    const uint32_t receivers[] = {1, 2};
    ledger_broadcast(&ledger, ENERGY_CLUSTERING, 0, receivers, 2, 6);
    const double air_ms = (6 + 9 + 2 + 6) * BYTE_MS;
    expect_mj(LISTEN * (1.248 + 0.192) + TRANSMIT * air_ms, 0);
    expect_mj(RECEIVE * air_ms, 1);
    expect_mj(RECEIVE * air_ms, 2);
    TEST_ASSERT_TRUE(fabs(1e3 * ledger.joules[ENERGY_RECEIVE][ENERGY_CLUSTERING] - 2 * RECEIVE * air_ms) < 1e-9);
    ledger_broadcast(&ledger, ENERGY_CLUSTERING, 2, NULL, 0, 6);
    expect_mj(RECEIVE * air_ms + LISTEN * (1.248 + 0.192) + TRANSMIT * air_ms, 2);
}

static void unicast(void)
{
    ledger_unicast(&ledger, ENERGY_MEASURING, 1, 2, 7);
    const double air_ms = (6 + 9 + 2 + 7) * BYTE_MS, listen = LISTEN * (1.248 + 0.384);
    expect_mj(listen + TRANSMIT * air_ms + RECEIVE * ACK_MS, 1);
    expect_mj(listen + RECEIVE * air_ms + TRANSMIT * ACK_MS, 2);
    TEST_ASSERT_TRUE(fabs(sum_mj() - ledger.used_mj[1] - ledger.used_mj[2]) < 1e-9);
}

static void long_messages_take_several_frames(void)
{
    ledger_unicast(&ledger, ENERGY_CLUSTERING, 0, 1, 220); /* 96 + 96 + 28 bytes */
    const double air_ms = (3 * (6 + 9 + 2) + 220) * BYTE_MS, listen = LISTEN * (1.248 + 0.384);
    expect_mj(3 * listen + TRANSMIT * air_ms + 3 * RECEIVE * ACK_MS, 0);
    ledger_unicast(&ledger, ENERGY_CLUSTERING, 2, 1, 96);
    expect_mj(listen + TRANSMIT * (6 + 9 + 2 + 96) * BYTE_MS + RECEIVE * ACK_MS, 2);
}

static void sampling_and_computing(void)
{
    ledger_sense(&ledger, 0);
    expect_mj(0.03, 0);
    ledger_sample(&ledger, 1);
    expect_mj(0.03 + 0.024 * 0.5, 1);
    ledger_compute(&ledger, 2, 10000);
    expect_mj(0.24, 2);
}

static void totals(void)
{
    ledger_unicast(&ledger, ENERGY_REPORTING, 2, 3, 16); /* to the sink */
    expect_mj(0, 3);
    ledger_compute(&ledger, 1, 20000);
    const struct energy_totals totals = ledger_totals(&ledger);
    TEST_ASSERT_TRUE(fabs(totals.hottest_j - 0.48e-3) < 1e-9);
    TEST_ASSERT_TRUE(fabs(sum_mj() - ledger.used_mj[1] - ledger.used_mj[2]) < 1e-9);
    TEST_ASSERT_EQUAL_UINT32(0, totals.dead);

    ledger_free(&ledger);
    set("energy.sink_mains", "false");
    TEST_ASSERT_EQUAL_INT(0, ledger_make(&ledger, &scenario, 4));
    ledger_unicast(&ledger, ENERGY_REPORTING, 2, 3, 16);
    TEST_ASSERT_TRUE(ledger.used_mj[3] > 0);
}

static void without_a_profile_nothing_is_known(void)
{
    ledger_free(&ledger);
    set("energy.profile", "none");
    TEST_ASSERT_EQUAL_INT(0, ledger_make(&ledger, &scenario, 4));
    ledger_sample(&ledger, 0);
    ledger_unicast(&ledger, ENERGY_REPORTING, 0, 1, 16);
    TEST_ASSERT_TRUE(isnan(ledger_totals(&ledger).hottest_j));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(broadcast);
    RUN_TEST(unicast);
    RUN_TEST(long_messages_take_several_frames);
    RUN_TEST(sampling_and_computing);
    RUN_TEST(totals);
    RUN_TEST(without_a_profile_nothing_is_known);
    port_exit(UNITY_END() > 0);
}
