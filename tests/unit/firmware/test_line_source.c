#include "motehound/line_source.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

struct known {
    struct mh_segment segment;
    struct mh_vec2 node;
    mh_real diffusion, value;
};

static struct mh_segment_field field_of(const struct mh_segment *segment, struct mh_vec2 node, mh_real diffusion)
{
    struct mh_segment_field field = {0.0f, {0.0f, 0.0f}, {0.0f, 0.0f}};
    mh_segment_add_field(segment, node, diffusion, 1.0f, &field);
    return field;
}

/* integrated in double with 200,000 points: young, old, ending in the future, ending shortly ago */
static void known_integrals(void)
{
    static const struct known cases[] = {
        {{{0.0f, 0.0f}, {1.0f, 0.0f}, 1.0f, 0.0f}, {1.5f, 0.5f}, 1.0f, 0.09081231f},
        {{{0.0f, 0.0f}, {1.0f, 0.5f}, 1.0f, 0.0f}, {-0.5f, 1.0f}, 1.0f, 0.05318829f},
        {{{0.0f, 0.0f}, {3.0f, 1.0f}, 2.0f, 0.0f}, {3.2f, 2.0f}, 0.5f, 0.02500728f},
        {{{0.0f, 0.0f}, {1.0f, 0.0f}, 2.0f, 1.0f}, {0.5f, 1.0f}, 1.0f, 0.04535749f},
        {{{-4.0f, 2.0f}, {-2.0f, 3.0f}, 7.0f, 5.0f}, {1.0f, 1.0f}, 1.0f, 0.01253658f},
        {{{0.0f, 0.0f}, {2.0f, 0.0f}, 1.0f, -1.0f}, {0.5f, 0.5f}, 1.0f, 0.1497242f},
        {{{0.0f, 0.0f}, {2.0f, 0.0f}, 3.0f, 0.1f}, {1.0f, 0.5f}, 1.0f, 0.1677668f},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const mh_real value = field_of(&cases[i].segment, cases[i].node, cases[i].diffusion).value;
        TEST_ASSERT_FLOAT_WITHIN(1e-3f * cases[i].value, cases[i].value, value);
    }
}

/* a source at rest for T: E1(r^2 / (4 D T)) / (4 pi D); E1(1) = 0.2193839 */
static void source_at_rest_is_an_exponential_integral(void)
{
    const struct mh_segment rest = {{0.0f, 0.0f}, {0.0f, 0.0f}, 1.0f, 0.0f};
    const struct mh_vec2 node = {0.0f, 2.0f};
    TEST_ASSERT_FLOAT_WITHIN(2e-5f, 0.2193839f / (4.0f * MH_PI), field_of(&rest, node, 1.0f).value);
}

static void derivatives_are_finite_differences(void)
{
    static const mh_real ages[3][2] = {{1.0f, 0.0f}, {2.5f, 1.5f}, {0.8f, -0.2f}};
    const struct mh_vec2 node = {1.4f, 0.9f};
    const mh_real h = 0.01f;
    for (int i = 0; i < 3; i++) {
        const struct mh_segment segment = {{0.0f, 0.1f}, {1.0f, -0.2f}, ages[i][0], ages[i][1]};
        const struct mh_segment_field field = field_of(&segment, node, 0.7f);
        const mh_real analytic[4] = {field.da.x, field.da.y, field.db.x, field.db.y};
        for (int p = 0; p < 4; p++) {
            struct mh_segment low = segment, high = segment;
            mh_real *coordinates[2][4] = {{&low.a.x, &low.a.y, &low.b.x, &low.b.y},
                                          {&high.a.x, &high.a.y, &high.b.x, &high.b.y}};
            *coordinates[0][p] -= h;
            *coordinates[1][p] += h;
            const mh_real difference =
                (field_of(&high, node, 0.7f).value - field_of(&low, node, 0.7f).value) / (2.0f * h);
            TEST_ASSERT_FLOAT_WITHIN(5e-5f, difference, analytic[p]);
        }
    }
}

static void future_adds_nothing_and_signs_cancel(void)
{
    const struct mh_segment future = {{0.0f, 0.0f}, {1.0f, 0.0f}, 0.0f, -1.0f};
    const struct mh_segment now = {{0.0f, 0.0f}, {1.0f, 0.0f}, 1.0f, 0.0f};
    const struct mh_vec2 node = {0.5f, 0.5f};
    struct mh_segment_field field = field_of(&future, node, 1.0f);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, field.value);
    mh_segment_add_field(&now, node, 1.0f, 1.0f, &field);
    TEST_ASSERT_TRUE(field.value > 0.1f);
    mh_segment_add_field(&now, node, 1.0f, -1.0f, &field);
    TEST_ASSERT_FLOAT_WITHIN(1e-7f, 0.0f, field.value);
    TEST_ASSERT_FLOAT_WITHIN(1e-7f, 0.0f, field.db.x);
}

static void midpoint_rule_agrees_where_it_is_meant_to(void)
{
    const struct mh_vec2 node = {1.0f, 1.0f};
    for (int age = 1; age < 30; age += 3) {
        const struct mh_segment segment = {{0.0f, 0.0f}, {1.0f, 0.3f}, (mh_real)(age + 1), (mh_real)age};
        const mh_real exact = field_of(&segment, node, 1.0f).value;
        TEST_ASSERT_FLOAT_WITHIN(0.004f * exact, exact, mh_segment_old_field(&segment, node, 1.0f));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(known_integrals);
    RUN_TEST(source_at_rest_is_an_exponential_integral);
    RUN_TEST(derivatives_are_finite_differences);
    RUN_TEST(future_adds_nothing_and_signs_cancel);
    RUN_TEST(midpoint_rule_agrees_where_it_is_meant_to);
    port_exit(UNITY_END() > 0);
    return 0;
}
