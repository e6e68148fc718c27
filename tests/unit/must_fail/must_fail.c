/* One test that passes and one that fails: see expect.cmake. */
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void holds(void) { TEST_ASSERT_EQUAL_INT(4, 2 + 2); }

static void fails(void) { TEST_ASSERT_EQUAL_INT(5, 2 + 2); }

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(holds);
    RUN_TEST(fails);
    port_exit(UNITY_END() > 0);
    return 0;
}
