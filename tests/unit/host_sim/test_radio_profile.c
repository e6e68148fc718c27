#include "port.h"
#include "radio/csma.h"
#include "radio/profile.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

static void expect_near(double tolerance, double expected, double value)
{
    TEST_ASSERT_TRUE(fabs(value - expected) <= tolerance);
}

/* 250 kb/s: 32 us a byte. A frame of 30 bytes: 4 preamble + 1 start + 1 length + 9 header + 30 = 45 bytes = 1,440 us; the
 * acknowledgement 11 bytes = 352 us; the longest frame of the standard, 127 bytes after the length byte, 133 bytes = 4,256 us. */
static void air_time_of_802154(void)
{
    const struct radio_profile *profile = radio_profile_find("802154");
    TEST_ASSERT_EQUAL_UINT(15, profile->preamble_bytes + profile->header_bytes);
    TEST_ASSERT_EQUAL_UINT(1440, radio_profile_air_us(profile, 15 + 30));
    TEST_ASSERT_EQUAL_UINT(352, radio_profile_air_us(profile, profile->ack_bytes));
    TEST_ASSERT_EQUAL_UINT(4256, radio_profile_air_us(profile, 133));
}

/* 19.2 kb/s: 416 2/3 us a byte. A TinyOS packet of 29 bytes and 2 of check sum: 8 preamble + 2 synchronisation + 5 header + 31
 * = 46 bytes = 19,166 2/3 us; an acknowledgement 16 bytes = 6,666 2/3 us; 3 bytes 1,250 us. */
static void air_time_of_cc1000(void)
{
    const struct radio_profile *profile = radio_profile_find("cc1000");
    TEST_ASSERT_EQUAL_UINT(15, profile->preamble_bytes + profile->header_bytes);
    TEST_ASSERT_EQUAL_UINT(19167, radio_profile_air_us(profile, 15 + 31));
    TEST_ASSERT_EQUAL_UINT(6667, radio_profile_air_us(profile, profile->ack_bytes));
    TEST_ASSERT_EQUAL_UINT(1250, radio_profile_air_us(profile, 3));
}

static void names(void)
{
    TEST_ASSERT_NOT_NULL(radio_profile_find("ideal"));
    TEST_ASSERT_NULL(radio_profile_find("802.15.4"));
}

/* Waits are `step_us` apart, from `least_us`, each of `count` as often as the others: chi-square with count - 1 degrees of freedom stays below
 * count + 5 sqrt(2 count). */
static void expect_uniform(struct csma csma, const struct radio_profile *profile, double least_us, double step_us,
                           unsigned count)
{
    enum { DRAWS = 32000 };
    unsigned times[64] = {0};
    const struct random_stream stream = random_stream(3, RANDOM_RADIO_BACKOFF);
    for (unsigned i = 0; i < DRAWS; i++) {
        const double units = ((double)csma_wait(&csma, profile, stream, 5) - least_us) / step_us;
        const unsigned unit = (unsigned)(units + 0.5);
        expect_near(0.6 / step_us, unit, units);
        TEST_ASSERT_TRUE(unit < count);
        times[unit]++;
    }
    double chi_square = 0;
    for (unsigned unit = 0; unit < count; unit++) {
        const double expected = (double)DRAWS / count, off = times[unit] - expected;
        chi_square += off * off / expected;
    }
    TEST_ASSERT_TRUE((chi_square - count) * (chi_square - count) < 50 * count);
}

/* 802.15.4: 0 ... 2^BE - 1 backoffs of 320 us, BE 3, 4, 5, 5, 5, then an assessment of 128 us. */
static void backoff_of_802154(void)
{
    const struct radio_profile *profile = radio_profile_find("802154");
    const unsigned windows[] = {8, 16, 32, 32, 32};
    struct csma csma = {0};
    for (unsigned k = 0; k < 5; k++) {
        expect_uniform(csma, profile, 128, 320, windows[k]);
        TEST_ASSERT_EQUAL_INT(k < 4, csma_was_busy(&csma, profile));
    }
}

/* CC1000: 1 ... 32 bytes at first, 1 ... 16 whenever the channel was busy, without end. */
static void backoff_of_cc1000(void)
{
    const struct radio_profile *profile = radio_profile_find("cc1000");
    struct csma csma = {0};
    expect_uniform(csma, profile, 416.667 + 350, 416.6667, 32);
    for (unsigned k = 0; k < 100; k++) {
        TEST_ASSERT_TRUE(csma_was_busy(&csma, profile));
    }
    expect_uniform(csma, profile, 416.667 + 350, 416.6667, 16);
}

static void retries_begin_anew(void)
{
    const struct radio_profile *profile = radio_profile_find("802154");
    struct csma csma = {.busy = 4};
    for (unsigned k = 0; k < 3; k++) {
        TEST_ASSERT_TRUE(csma_not_acknowledged(&csma, profile));
        TEST_ASSERT_EQUAL_UINT(0, csma.busy);
    }
    TEST_ASSERT_FALSE(csma_not_acknowledged(&csma, profile));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(air_time_of_802154);
    RUN_TEST(air_time_of_cc1000);
    RUN_TEST(names);
    RUN_TEST(backoff_of_802154);
    RUN_TEST(backoff_of_cc1000);
    RUN_TEST(retries_begin_anew);
    port_exit(UNITY_END() > 0);
    return 0;
}
