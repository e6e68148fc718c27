#include "motehound/prince.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void a_row_is_small(void)
{
#ifdef __AVR__
    TEST_ASSERT_TRUE(sizeof(struct mh_prince_row) <= 300);
#endif
    TEST_ASSERT_TRUE(sizeof(struct mh_prince_row) <= 340);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_row_is_small);
    port_exit(UNITY_END() > 0);
}
