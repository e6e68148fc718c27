#include "bounds/fix_bound.h"
#include "port.h"
#include "unity.h"

#include <math.h>

/* Unity is built without double. */
#define NEAR(expected, actual, share) TEST_ASSERT_TRUE(fabs((expected) - (actual)) <= (share)*fabs(expected))

void setUp(void) {}
void tearDown(void) {}

/* A node in distance d tells the distance alone, with variance (d / 2)^2 (tau^2 + (eta d^2 / C)^2). */
static void two_nodes_at_right_angles_have_the_closed_form(void)
{
    const struct heard_target target = {{100, 200}, 1600};
    struct fix_information information = {.targets = 1};
    fix_information_add(&information, &target, (struct point){100, 220}, 0.19, 0.05);
    TEST_ASSERT_TRUE(isnan(fix_bound_m2(&information)));
    fix_information_add(&information, &target, (struct point){60, 200}, 0.19, 0.05);
    const double near = 100 * (0.0361 + pow(0.05 / 4, 2)), far = 400 * (0.0361 + 0.0025);
    NEAR(near + far, fix_bound_m2(&information), 1e-12);
}

/* Two targets far apart, each with nodes of its own, are two single ones; brought together they are known worse. */
static void a_second_target_takes_information_away(void)
{
    static const struct point offsets[] = {{20, 0}, {-5, 25}, {-18, -12}, {8, -30}};
    double apart = 0, single = 0;
    for (int far = 0; far < 2; far++) {
        const struct heard_target both[] = {{{0, 0}, 1600}, {{far ? 1e6 : 20, 0}, 1600}};
        struct fix_information joint = {.targets = 2}, one = {.targets = 1};
        for (size_t i = 0; i < 4; i++) {
            for (size_t k = 0; k < 2; k++) {
                const struct point node = {both[k].place.x_m + offsets[i].x_m, offsets[i].y_m};
                fix_information_add(&joint, both, node, 0.19, 0.05);
            }
            fix_information_add(&one, both, offsets[i], 0.19, 0.05);
        }
        single = fix_bound_m2(&one);
        if (far) {
            NEAR(single, fix_bound_m2(&joint), 1e-6);
        } else {
            apart = fix_bound_m2(&joint);
        }
    }
    TEST_ASSERT_TRUE(apart > single);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(two_nodes_at_right_angles_have_the_closed_form);
    RUN_TEST(a_second_target_takes_information_away);
    port_exit(UNITY_END() > 0);
    return 0;
}
