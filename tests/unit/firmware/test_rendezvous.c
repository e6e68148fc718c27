#include "motehound/rendezvous.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static const struct mh_rendezvous quarter = {250, 10, 2000};

/* Against the definition, tick by tick: the first half of each window but those of sampling instants. */
static void windows_open_as_defined(void)
{
    mh_tick next = 0;
    for (mh_tick time = 6300; time-- > 0;) {
        const bool open = time % 250 <= 5 && time % 2000 > 5;
        next = open ? time : next;
        TEST_ASSERT_EQUAL(open, mh_rendezvous_open(&quarter, time));
        if (time < 6000) {
            TEST_ASSERT_EQUAL_UINT32(next, mh_rendezvous_next(&quarter, time));
        }
    }
}

static void windows_are_counted(void)
{
    TEST_ASSERT_EQUAL_UINT32(500, mh_rendezvous_after(&quarter, 250, 0));
    TEST_ASSERT_EQUAL_UINT32(500, mh_rendezvous_after(&quarter, 499, 0));
    TEST_ASSERT_EQUAL_UINT32(750, mh_rendezvous_after(&quarter, 499, 1));
    TEST_ASSERT_EQUAL_UINT32(2250, mh_rendezvous_after(&quarter, 1750, 0)); /* the one at 2,000 is for asking */
    TEST_ASSERT_EQUAL_UINT32(2500, mh_rendezvous_after(&quarter, 1600, 2));
}

/* All windows are instants', where there is one an instant: they serve for everything. */
static void rare_windows_serve_for_everything(void)
{
    const struct mh_rendezvous rare = {2000, 20, 2000};
    TEST_ASSERT_TRUE(mh_rendezvous_open(&rare, 4000));
    TEST_ASSERT_FALSE(mh_rendezvous_open(&rare, 4011));
    TEST_ASSERT_EQUAL_UINT32(6000, mh_rendezvous_next(&rare, 4011));
}

static void who_listens_all_the_time_is_reached_at_once(void)
{
    const struct mh_rendezvous always = {0, 0, 2000};
    TEST_ASSERT_TRUE(mh_rendezvous_open(&always, 2000));
    TEST_ASSERT_EQUAL_UINT32(77, mh_rendezvous_next(&always, 77));
    TEST_ASSERT_EQUAL_UINT32(77 + 251, mh_rendezvous_after(&always, 77, 0));
    TEST_ASSERT_EQUAL_UINT32(77 + 3 * 251, mh_rendezvous_after(&always, 77, 2));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(windows_open_as_defined);
    RUN_TEST(windows_are_counted);
    RUN_TEST(rare_windows_serve_for_everything);
    RUN_TEST(who_listens_all_the_time_is_reached_at_once);
    port_exit(UNITY_END() > 0);
    return 0;
}
