/* Quantiles of counts in classes, against the exact ones. */
#include "hosts/step_cycles.h"
#include "port.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

static void quantiles_are_within_five_percent(void)
{
    struct step_cycles steps = {.longest = 0};
    for (uint64_t i = 1; i <= 2000; i++) {
        step_cycles_count(&steps, i * i * 1000); /* 1e3 to 4e9 */
    }
    TEST_ASSERT_EQUAL_INT64(2000, step_cycles_number(&steps));
    static const double orders[] = {0.05, 0.25, 0.5, 0.75, 0.95};
    for (int i = 0; i < 5; i++) {
        const double exact = (2000 * orders[i]) * (2000 * orders[i]) * 1000;
        TEST_ASSERT_TRUE(fabs(step_cycles_quantile(&steps, orders[i]) - exact) < 0.05 * exact);
    }
    TEST_ASSERT_EQUAL_UINT64(4000000000u, steps.longest);
}

static void at_the_ends(void)
{
    struct step_cycles steps = {.longest = 0}, none = {.longest = 0};
    TEST_ASSERT_TRUE(step_cycles_quantile(&none, 0.5) == 0);
    step_cycles_count(&steps, 0);
    step_cycles_count(&steps, 100000);
    TEST_ASSERT_TRUE(step_cycles_quantile(&steps, 0.5) <= 512);
    TEST_ASSERT_TRUE(fabs(step_cycles_quantile(&steps, 0.9) - 100000) < 5000);
    step_cycles_count(&steps, UINT64_MAX);
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, steps.longest);
    step_cycles_add(&none, &steps);
    step_cycles_add(&none, &steps);
    TEST_ASSERT_EQUAL_INT64(6, step_cycles_number(&none));
    TEST_ASSERT_TRUE(step_cycles_quantile(&steps, 0.5) == step_cycles_quantile(&none, 0.5));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(quantiles_are_within_five_percent);
    RUN_TEST(at_the_ends);
    port_exit(UNITY_END() > 0);
    return 0;
}
