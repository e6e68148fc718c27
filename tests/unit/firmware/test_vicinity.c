#include "motehound/vicinity.h"
#include "port.h"
#include "unity.h"

enum { HERE = 50 };

static struct mh_vicinity vicinity;
static struct mh_place places[MH_VICINITY_MAX];

void setUp(void)
{
    const struct mh_place here = {1000, 0, 0};
    TEST_ASSERT_EQUAL(MH_OK, mh_vicinity_init(&vicinity, HERE, &here, 10000));
}

void tearDown(void) {}

static size_t around(mh_node_id candidate) { return mh_vicinity_around(&vicinity, candidate, 100, places); }

static void bad_arguments_are_refused(void)
{
    const struct mh_place here = {0, 0, 0};
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_vicinity_init(NULL, HERE, &here, 10000));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_vicinity_init(&vicinity, HERE, NULL, 10000));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_vicinity_init(&vicinity, HERE, &here, 511));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_vicinity_init(&vicinity, HERE, &here, 3600001));
}

static void the_candidate_comes_first_then_who_is_near_it_by_identifier(void)
{
    mh_vicinity_hear(&vicinity, 0, 70, 1090, 0);
    mh_vicinity_hear(&vicinity, 0, 30, 1100, 0); /* exactly as far from here as reaches */
    mh_vicinity_hear(&vicinity, 0, 90, 1201, 0);
    mh_vicinity_hear(&vicinity, 0, 10, 1130, 40);
    TEST_ASSERT_EQUAL(4, around(30));
    TEST_ASSERT_EQUAL_INT32(1100, places[0].x_mm);
    TEST_ASSERT_EQUAL_INT32(1130, places[1].x_mm); /* 10 */
    TEST_ASSERT_EQUAL_INT32(40, places[1].y_mm);
    TEST_ASSERT_EQUAL_INT32(1000, places[2].x_mm); /* this node */
    TEST_ASSERT_EQUAL_INT32(1090, places[3].x_mm); /* 70; not 90, a millimetre too far */
    TEST_ASSERT_EQUAL(0, around(31));
}

static void who_is_not_told_of_is_forgotten(void)
{
    mh_vicinity_hear(&vicinity, 1000, 30, 1100, 0);
    mh_vicinity_hear(&vicinity, 1000, 31, 1101, 0);
    mh_vicinity_age(&vicinity, 10000);
    TEST_ASSERT_EQUAL_UINT8(3, vicinity.count);
    mh_vicinity_hear(&vicinity, 10000, 31, 1102, 0); /* it has moved, too */
    mh_vicinity_age(&vicinity, 12000);
    TEST_ASSERT_EQUAL(0, around(30));
    TEST_ASSERT_EQUAL(1, around(31));
    TEST_ASSERT_EQUAL_INT32(1102, places[0].x_mm);
    mh_vicinity_age(&vicinity, 100000);
    TEST_ASSERT_EQUAL_UINT8(1, vicinity.count); /* this node stays */
    mh_vicinity_hear(&vicinity, 100000, 31, 1102, 0);
    mh_vicinity_forget(&vicinity, 31);
    mh_vicinity_forget(&vicinity, 31);
    mh_vicinity_forget(&vicinity, HERE);
    TEST_ASSERT_EQUAL_UINT8(1, vicinity.count);
}

static void a_node_does_not_believe_others_about_itself(void)
{
    mh_vicinity_hear(&vicinity, 0, HERE, 5, 5);
    TEST_ASSERT_EQUAL(1, around(HERE));
    TEST_ASSERT_EQUAL_INT32(1000, places[0].x_mm);
}

static void the_farthest_gives_way(void)
{
    for (int32_t i = 1; i < MH_VICINITY_MAX; i++) {
        mh_vicinity_hear(&vicinity, 0, (mh_node_id)(1000 - i), 1000 + 10 * i, 0);
    }
    TEST_ASSERT_EQUAL_UINT8(MH_VICINITY_MAX, vicinity.count);
    TEST_ASSERT_EQUAL_UINT16(0, vicinity.crowded);
    mh_vicinity_hear(&vicinity, 0, 2000, 1000 + 10 * MH_VICINITY_MAX, 0); /* farther than all */
    TEST_ASSERT_EQUAL(0, around(2000));
    mh_vicinity_hear(&vicinity, 0, 3, 1005, 0);
    TEST_ASSERT_TRUE(around(3) > 1);
    TEST_ASSERT_EQUAL(0, around(1000 - (MH_VICINITY_MAX - 1)));
    TEST_ASSERT_TRUE(around(1000 - (MH_VICINITY_MAX - 2)) > 0);
    TEST_ASSERT_EQUAL_UINT8(MH_VICINITY_MAX, vicinity.count);
    TEST_ASSERT_EQUAL_UINT16(2, vicinity.crowded);
    for (uint8_t i = 1; i < vicinity.count; i++) {
        TEST_ASSERT_TRUE(vicinity.list[i - 1].id < vicinity.list[i].id);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bad_arguments_are_refused);
    RUN_TEST(the_candidate_comes_first_then_who_is_near_it_by_identifier);
    RUN_TEST(who_is_not_told_of_is_forgotten);
    RUN_TEST(a_node_does_not_believe_others_about_itself);
    RUN_TEST(the_farthest_gives_way);
    port_exit(UNITY_END() > 0);
    return 0;
}
