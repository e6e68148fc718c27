/* Which target an identifier stands for. */
#include "port.h"
#include "unity.h"
#include "world/identify.h"

#include <math.h>
#include <stddef.h>

static struct scenario scenario;
static struct targets targets;
static struct identify identify;
static char error[300];

static void set(const char *key, const char *value)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, key, value, error, sizeof error), error);
}

/* Target 0 along y = 0 from 0 s, 1 along y = 50, 2 far away at 300, 0 from 10 s on. */
void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    set("source.path", "scripted");
    set("sensor.quantity", "sound");
    set("targets", "0,10,1: 0,0; 300,0 | 0,10,1: 0,50; 300,50 | 10,1,1: 300,0; 320,0");
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, targets_make(&targets, &scenario, 1, error, sizeof error), error);
    identify = (struct identify){.range_m = 40};
}

void tearDown(void)
{
    targets_free(&targets);
    scenario_free(&scenario);
}

static uint32_t who(uint32_t id, double x_m, double y_m, double time_s)
{
    return identify_target(&identify, &targets, id, (struct point){x_m, y_m}, time_s);
}

static void first_come(void)
{
    TEST_ASSERT_EQUAL_UINT32(1, who(16, 3, 30, 0));   /* 20 m from target 1, 30 m from 0 */
    TEST_ASSERT_EQUAL_UINT32(0, who(32, 3, 30, 0));   /* target 1 is taken */
    TEST_ASSERT_EQUAL_UINT32(1, who(16, 100, 0, 10)); /* it has changed over: found out */
}

static void not_one_far_away(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, who(16, 0, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(1, who(32, 0, 50, 0));
    TEST_ASSERT_EQUAL_UINT32(0, who(48, 100, 5, 10)); /* begun anew: target 2, free, is 200 m away */
    TEST_ASSERT_EQUAL_UINT32(2, who(64, 290, 0, 12));
}

static void nobody_there(void)
{
    TEST_ASSERT_EQUAL_UINT32(NOT_IDENTIFIED, who(16, 0, 0, 99));
    TEST_ASSERT_EQUAL_UINT32(0, who(16, 0, 0, 1)); /* it was not kept */
}

static void of_a_group_the_middle(void)
{
    struct mh_estimate estimate = {.origin = {95000, 20000, 0},
                                   .position = {MH_REAL(5.0f), MH_REAL(6.0f)},
                                   .members = 2,
                                   .target = 16,
                                   .of = {16, 32}};
    const struct identified found = identify_estimate(&identify, &targets, &estimate, 10);
    TEST_ASSERT_EQUAL_UINT32(NOT_IDENTIFIED, found.number);
    TEST_ASSERT_TRUE(found.state.present);
    TEST_ASSERT_TRUE(hypot(found.state.at.x_m - 100, found.state.at.y_m - 25) < 1e-9);
    TEST_ASSERT_TRUE(hypot(found.state.velocity.x_m - 10, found.state.velocity.y_m) < 1e-9);
    estimate.members = 1;
    estimate.target = 32;
    const struct identified alone = identify_estimate(&identify, &targets, &estimate, 12);
    TEST_ASSERT_NOT_EQUAL(NOT_IDENTIFIED, alone.number);
    TEST_ASSERT_TRUE(fabs(alone.state.at.x_m - 120) < 1e-9);
    TEST_ASSERT_EQUAL_size_t(1, identify.count); /* in the group nobody was told apart */
}

static void the_oldest_is_forgotten(void)
{
    for (uint32_t id = 1; id <= IDENTIFIED_MAX + 5; id++) {
        (void)who(id, 0, 0, 0);
    }
    TEST_ASSERT_EQUAL_size_t(IDENTIFIED_MAX + 5, identify.count);
    const size_t before = identify.count;
    (void)who(IDENTIFIED_MAX + 5, 0, 0, 0);
    TEST_ASSERT_EQUAL_size_t(before, identify.count); /* known */
    (void)who(1, 0, 0, 0);
    TEST_ASSERT_EQUAL_size_t(before + 1, identify.count); /* forgotten, and known anew */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(first_come);
    RUN_TEST(not_one_far_away);
    RUN_TEST(nobody_there);
    RUN_TEST(of_a_group_the_middle);
    RUN_TEST(the_oldest_is_forgotten);
    port_exit(UNITY_END() > 0);
}
