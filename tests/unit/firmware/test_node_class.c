#include "motehound/node_class.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static struct mh_vec2 at(mh_real x, mh_real y)
{
    const struct mh_vec2 v = {x, y};
    return v;
}

/* Along the direction (3, 4) / 5 from the fix, and to the left of it. */
static struct mh_vec2 along(struct mh_vec2 fix, mh_real ahead, mh_real left)
{
    return at(fix.x + mh_mul(MH_REAL(0.6f), ahead) - mh_mul(MH_REAL(0.8f), left),
              fix.y + mh_mul(MH_REAL(0.8f), ahead) + mh_mul(MH_REAL(0.6f), left));
}

static const struct mh_course COURSE = {.head = {MH_REAL(100.0f), MH_REAL(90.0f)},
                                        .fix = {MH_REAL(110.0f), MH_REAL(110.0f)},
                                        .velocity = {MH_REAL(6.0f), MH_REAL(8.0f)}};

static struct mh_strips strips(mh_real extent)
{
    return mh_strips(MH_REAL(40.0f), MH_REAL(8.0f), MH_REAL(80.0f), extent);
}

static void strips_lie_on_both_sides_of_the_path(void)
{
    const struct {
        mh_real off;
        enum mh_node_class single, group; /* of extent 10 */
    } CASES[] = {{MH_REAL(0.0f), MH_NODE_INNER, MH_NODE_INNER},   {MH_REAL(31.9f), MH_NODE_INNER, MH_NODE_INNER},
                 {MH_REAL(32.1f), MH_NODE_BORDER, MH_NODE_INNER}, {MH_REAL(39.9f), MH_NODE_BORDER, MH_NODE_INNER},
                 {MH_REAL(40.1f), MH_NODE_OUTER, MH_NODE_INNER},  {MH_REAL(42.1f), MH_NODE_OUTER, MH_NODE_BORDER},
                 {MH_REAL(50.1f), MH_NODE_OUTER, MH_NODE_OUTER},  {MH_REAL(79.9f), MH_NODE_OUTER, MH_NODE_OUTER},
                 {MH_REAL(80.1f), MH_NODE_NONE, MH_NODE_OUTER},   {MH_REAL(90.1f), MH_NODE_NONE, MH_NODE_NONE}};
    const struct mh_strips single = strips(MH_REAL(0.0f)), group = strips(MH_REAL(10.0f));
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        for (int16_t ahead = -20; ahead <= 120; ahead = (int16_t)(ahead + 70)) {
            const struct mh_vec2 left = along(COURSE.fix, mh_real_from_int(ahead), CASES[i].off);
            const struct mh_vec2 right = along(COURSE.fix, mh_real_from_int(ahead), -CASES[i].off);
            TEST_ASSERT_EQUAL_INT(CASES[i].single, mh_node_class(&single, &COURSE, left));
            TEST_ASSERT_EQUAL_INT(CASES[i].single, mh_node_class(&single, &COURSE, right));
            TEST_ASSERT_EQUAL_INT(CASES[i].group, mh_node_class(&group, &COURSE, left));
            TEST_ASSERT_EQUAL_INT(CASES[i].group, mh_node_class(&group, &COURSE, right));
        }
    }
}

/* The perpendicular goes through the head, which is 22 m behind the fix here. */
static void who_stands_behind_the_head_sleeps(void)
{
    const struct mh_strips single = strips(MH_REAL(0.0f));
    for (int8_t left = -70; left <= 70; left = (int8_t)(left + 35)) {
        TEST_ASSERT_EQUAL_INT(
            MH_NODE_NONE, mh_node_class(&single, &COURSE, along(COURSE.fix, MH_REAL(-22.1f), mh_real_from_int(left))));
        TEST_ASSERT_TRUE(mh_node_class(&single, &COURSE, along(COURSE.fix, MH_REAL(-21.9f), mh_real_from_int(left))) !=
                         MH_NODE_NONE);
    }
    TEST_ASSERT_EQUAL_INT(MH_NODE_INNER, mh_node_class(&single, &COURSE, COURSE.head)); /* the border is ahead */
}

static void without_a_velocity_all_contend(void)
{
    const struct mh_strips single = strips(MH_REAL(0.0f));
    const struct mh_course standing = {.head = COURSE.head, .fix = COURSE.fix};
    TEST_ASSERT_EQUAL_INT(MH_NODE_COMPETITOR,
                          mh_node_class(&single, &standing, along(COURSE.fix, MH_REAL(-100.0f), MH_REAL(0.0f))));
    TEST_ASSERT_EQUAL_INT(MH_NODE_COMPETITOR,
                          mh_node_class(&single, &standing, along(COURSE.fix, MH_REAL(0.0f), MH_REAL(100.0f))));
}

static void what_is_not_finite_has_no_class(void)
{
    const struct mh_strips single = strips(MH_REAL(0.0f));
    const mh_real wrong[] = {mh_real_from_float(NAN), mh_real_from_float(INFINITY), mh_real_from_float(-INFINITY)};
    for (uint8_t i = 0; i < 3; i++) {
        struct mh_course course = COURSE;
        TEST_ASSERT_EQUAL_INT(MH_NODE_NONE, mh_node_class(&single, &course, at(wrong[i], MH_REAL(110.0f))));
        TEST_ASSERT_EQUAL_INT(MH_NODE_NONE, mh_node_class(&single, &course, at(MH_REAL(110.0f), wrong[i])));
        course.velocity.x = wrong[i];
        TEST_ASSERT_EQUAL_INT(MH_NODE_NONE, mh_node_class(&single, &course, at(MH_REAL(110.0f), MH_REAL(110.0f))));
        course = COURSE;
        course.fix.y = wrong[i];
        TEST_ASSERT_EQUAL_INT(MH_NODE_NONE, mh_node_class(&single, &course, at(MH_REAL(110.0f), MH_REAL(110.0f))));
        course = COURSE;
        course.head.y = wrong[i];
        TEST_ASSERT_EQUAL_INT(MH_NODE_NONE, mh_node_class(&single, &course, at(MH_REAL(110.0f), MH_REAL(110.0f))));
        course = COURSE;
        course.velocity = at(MH_REAL(0.0f), MH_REAL(0.0f));
        TEST_ASSERT_EQUAL_INT(MH_NODE_NONE, mh_node_class(&single, &course, at(MH_REAL(110.0f), wrong[i])));
    }
}

/* Node `id` stands `ahead` of the fix and `left` of the path; 10 m/s, 1 s after the fix. */
static void consider(struct mh_prince_choice *best, bool farthest, mh_node_id id, mh_real ahead, mh_real left)
{
    const struct mh_strips single = strips(MH_REAL(0.0f));
    const struct mh_prince_rule rule = {.step_m = MH_REAL(60.0f), .lead_s = MH_REAL(0.8f), .farthest = farthest};
    mh_prince_consider(best, &rule, &single, &COURSE, MH_REAL(1.0f), id, along(COURSE.fix, ahead, left));
}

/* A node 24 m beside the path is entered sqrt(40^2 - 24^2) = 32 m before the target passes it. */
static void the_path_ends_where_the_range_begins(void)
{
    struct mh_prince_choice best = {0};
    consider(&best, false, 7, MH_REAL(82.0f), MH_REAL(-24.0f));
    TEST_ASSERT_TRUE(best.found);
    TEST_ASSERT_EQUAL_UINT32(7, best.id);
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 2e-3f : 1e-3f, 50.0f, mh_real_to_float(best.path_m));
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 2e-4f : 1e-4f, 5.0f, mh_real_to_float(best.entry_s));
}

static void the_prince_is_entered_nearest_to_the_step(void)
{
    struct mh_prince_choice best = {0};
    consider(&best, false, 1, MH_REAL(92.0f), MH_REAL(24.0f)); /* path 60 */
    TEST_ASSERT_EQUAL_UINT32(1, best.id);
    consider(&best, false, 2, MH_REAL(95.0f), MH_REAL(0.0f));  /* 55: less near */
    consider(&best, false, 3, MH_REAL(106.0f), MH_REAL(0.0f)); /* 66 */
    consider(&best, false, 4, MH_REAL(98.0f), MH_REAL(33.0f)); /* border */
    TEST_ASSERT_EQUAL_UINT32(1, best.id);
    best.found = false;
    consider(&best, false, 3, MH_REAL(106.0f), MH_REAL(0.0f));
    consider(&best, false, 2, MH_REAL(95.0f), MH_REAL(0.0f));
    TEST_ASSERT_EQUAL_UINT32(2, best.id);
}

static void the_farthest_prince_has_the_longest_path(void)
{
    struct mh_prince_choice best = {0};
    consider(&best, true, 1, MH_REAL(92.0f), MH_REAL(24.0f)); /* 60 */
    consider(&best, true, 2, MH_REAL(95.0f), MH_REAL(0.0f));  /* 55 */
    TEST_ASSERT_EQUAL_UINT32(1, best.id);
    consider(&best, true, 3, MH_REAL(106.0f), MH_REAL(0.0f)); /* 66 */
    TEST_ASSERT_EQUAL_UINT32(3, best.id);
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 2e-3f : 1e-3f, 66.0f, mh_real_to_float(best.path_m));
}

/* In range 1.7 s after the fix is too early when 1 s has passed and 0.8 s are wanted; so is whom the target is in range of already. */
static void a_prince_has_time_to_be_told(void)
{
    for (uint8_t farthest = 0; farthest < 2; farthest++) {
        struct mh_prince_choice best = {0};
        consider(&best, farthest, 1, MH_REAL(57.0f), MH_REAL(0.0f));
        consider(&best, farthest, 2, MH_REAL(20.0f), MH_REAL(0.0f));
        consider(&best, farthest, 3, MH_REAL(-10.0f), MH_REAL(0.0f));
        TEST_ASSERT_FALSE(best.found);
        consider(&best, farthest, 4, MH_REAL(59.0f), MH_REAL(0.0f));
        TEST_ASSERT_TRUE(best.found);
        TEST_ASSERT_EQUAL_UINT32(4, best.id);
    }
}

static void equal_paths_go_to_the_lower_identifier(void)
{
    for (uint8_t farthest = 0; farthest < 2; farthest++) {
        struct mh_prince_choice best = {0};
        consider(&best, farthest, 8, MH_REAL(95.0f), MH_REAL(0.0f));
        consider(&best, farthest, 5, MH_REAL(95.0f), MH_REAL(0.0f));
        TEST_ASSERT_EQUAL_UINT32(5, best.id);
        consider(&best, farthest, 9, MH_REAL(95.0f), MH_REAL(0.0f));
        TEST_ASSERT_EQUAL_UINT32(5, best.id);
    }
}

static void nobody_is_prince_of_a_course_that_is_not_known(void)
{
    const struct mh_strips single = strips(MH_REAL(0.0f));
    const struct mh_prince_rule rule = {.step_m = MH_REAL(60.0f), .lead_s = MH_REAL(0.8f)};
    const struct mh_course standing = {.head = COURSE.head, .fix = COURSE.fix};
    struct mh_prince_choice best = {0};
    mh_prince_consider(&best, &rule, &single, &standing, MH_REAL(0.0f), 1,
                       along(COURSE.fix, MH_REAL(60.0f), MH_REAL(0.0f)));
    mh_prince_consider(&best, &rule, &single, &COURSE, MH_REAL(0.0f), 1, at(mh_real_from_float(NAN), MH_REAL(0.0f)));
    TEST_ASSERT_FALSE(best.found);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(strips_lie_on_both_sides_of_the_path);
    RUN_TEST(who_stands_behind_the_head_sleeps);
    RUN_TEST(without_a_velocity_all_contend);
    RUN_TEST(what_is_not_finite_has_no_class);
    RUN_TEST(the_path_ends_where_the_range_begins);
    RUN_TEST(the_prince_is_entered_nearest_to_the_step);
    RUN_TEST(the_farthest_prince_has_the_longest_path);
    RUN_TEST(a_prince_has_time_to_be_told);
    RUN_TEST(equal_paths_go_to_the_lower_identifier);
    RUN_TEST(nobody_is_prince_of_a_course_that_is_not_known);
    port_exit(UNITY_END() > 0);
}
