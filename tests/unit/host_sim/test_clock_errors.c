#include "record/clock_errors.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

static void test_quantiles_of_known_errors(void)
{
    struct clock_errors errors = {0};
    TEST_ASSERT_TRUE(isnan(clock_errors_quantile_ms(&errors, 0.99)) && isnan(clock_errors_known_share(&errors)));
    for (int i = 1; i <= 1000; i++) { /* 0.01 to 10 ms, of either sign */
        TEST_ASSERT_EQUAL(0, clock_errors_add(&errors, (i % 2 ? 1e-5 : -1e-5) * i));
    }
    TEST_ASSERT_TRUE(fabs(clock_errors_quantile_ms(&errors, 0.99) / 9.9 - 1) < 0.005);
    TEST_ASSERT_TRUE(fabs(clock_errors_quantile_ms(&errors, 0.5) / 5 - 1) < 0.005);
    TEST_ASSERT_TRUE(fabs(clock_errors_quantile_ms(&errors, 1) / 10 - 1) < 0.005);
    clock_errors_free(&errors);
}

static void test_unknown_is_no_error_but_counts(void)
{
    struct clock_errors errors = {0};
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL(0, clock_errors_add(&errors, i == 0 ? (double)NAN : 0.0));
    }
    TEST_ASSERT_TRUE(clock_errors_quantile_ms(&errors, 0.99) < 1e-30);
    TEST_ASSERT_TRUE(fabs(clock_errors_known_share(&errors) - 0.75) < 1e-12);
    clock_errors_free(&errors);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_quantiles_of_known_errors);
    RUN_TEST(test_unknown_is_no_error_but_counts);
    return UNITY_END();
}
