#include "motehound/trail.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static struct mh_trail trail;

/* the source runs along the x axis at 1 m/s and 100 g/s */
static struct mh_trail_knot knot_at(int second)
{
    const struct mh_trail_knot knot = {{(mh_real)second, 0.0f}, (mh_tick)second * 1000u, 100.0f};
    return knot;
}

static void a_full_trail_still_holds_the_whole_path(void)
{
    const int seconds = 3 * MH_TRAIL_KNOTS_MAX;
    trail.count = 0;
    for (int k = 0; k <= seconds; k++) {
        const struct mh_trail_knot knot = knot_at(k);
        mh_trail_append(&trail, &knot);
    }
    TEST_ASSERT_EQUAL_INT(MH_TRAIL_KNOTS_MAX, trail.count);
    TEST_ASSERT_EQUAL_UINT32(0, trail.knots[0].time);
    mh_real mass = 0.0f;
    for (int k = 1; k < trail.count; k++) {
        mass += trail.knots[k].rate * 0.001f * (mh_real)(trail.knots[k].time - trail.knots[k - 1].time);
    }
    TEST_ASSERT_FLOAT_WITHIN(0.01f * (mh_real)seconds, 100.0f * (mh_real)seconds, mass);

    const mh_tick time = (mh_tick)seconds * 1000u + 1000u;
    for (int back = 2; back < seconds; back += seconds / 6) {
        const struct mh_vec2 node = {(mh_real)(seconds - back), 2.0f};
        mh_real exact = 0.0f;
        for (int k = 1; k <= seconds; k++) {
            const struct mh_trail_knot a = knot_at(k - 1), b = knot_at(k);
            exact += mh_trail_segment_increment(&a, &b, node, time, 1000u, 1.0f);
        }
        TEST_ASSERT_FLOAT_WITHIN(0.02f + 0.02f * mh_abs(exact), exact,
                                 mh_trail_increment(&trail, node, time, 1000u, 1.0f));
    }
}

static void time_may_wrap(void)
{
    const struct mh_trail_knot a = {{0.0f, 0.0f}, 0xfffffc18u, 100.0f}, b = {{1.0f, 0.0f}, 0u, 100.0f};
    const struct mh_trail_knot c = {{0.0f, 0.0f}, 1000u, 100.0f}, d = {{1.0f, 0.0f}, 2000u, 100.0f};
    const struct mh_vec2 node = {0.5f, 1.0f};
    TEST_ASSERT_EQUAL_FLOAT(mh_trail_segment_increment(&c, &d, node, 4000u, 1000u, 1.0f),
                            mh_trail_segment_increment(&a, &b, node, 2000u, 1000u, 1.0f));
}

static void what_lies_weeks_back_is_forgotten(void)
{
    trail.count = 0;
    for (int k = 0; k < 3; k++) {
        struct mh_trail_knot knot = knot_at(k);
        if (k == 2) {
            knot.time = 0x40000100u;
        }
        mh_trail_append(&trail, &knot);
    }
    TEST_ASSERT_EQUAL_INT(2, trail.count);
    TEST_ASSERT_EQUAL_UINT32(1000u, trail.knots[0].time);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_full_trail_still_holds_the_whole_path);
    RUN_TEST(time_may_wrap);
    RUN_TEST(what_lies_weeks_back_is_forgotten);
    port_exit(UNITY_END() > 0);
    return 0;
}
