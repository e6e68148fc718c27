/* The acoustic tracker with targets that come together, go on as a group, and part. */
#include "listeners.h"
#include "motehound/acoustic.h"
#include "port.h"
#include "unity.h"

enum { INTERVAL = 2000 };

static struct mh_acoustic states[2];
static struct mh_acoustic_config config;
static struct mh_estimate estimates[2];
static uint8_t bytes[2][MH_ACOUSTIC_SAVED_MAX];
static size_t lengths[2];
static uint32_t targets[2];

static const struct mh_tracker *const tracker = &mh_tracker_acoustic;

void setUp(void)
{
    mh_acoustic_config_default(&config, 40);
    mh_group_config_default(&config.group, MH_GROUP_MEMBERS);
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->init(&states[0], &config, INTERVAL));
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->init(&states[1], &config, INTERVAL));
}
void tearDown(void) {}

static void assert_at(mh_real tolerance, mh_real x, mh_real y, const struct mh_estimate *estimate)
{
    const struct mh_vec2 origin = mh_place_relative(&estimate->origin, &corner);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, x, origin.x + estimate->position.x);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, y, origin.y + estimate->position.y);
}

static void save(int which)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->save(&states[which], bytes[which], &lengths[which]));
    TEST_ASSERT_TRUE(lengths[which] <= sizeof bytes[which]);
}

/* The state goes on with what it had saved, as another head does. */
static void hand_over(int which)
{
    save(which);
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->init(&states[which], &config, INTERVAL));
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->among(&states[which], targets[which], NULL, 0));
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->load(&states[which], bytes[which], lengths[which]));
}

static void begin_at(int which, uint32_t target, mh_real x, mh_real y, mh_real vx, mh_real vy)
{
    const struct mh_vec2 offset = {x, y}, velocity = {vx, vy};
    const struct mh_place place = mh_place_from_offset(&corner, offset);
    targets[which] = target;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_acoustic_begin(&states[which], target, 0, &place, velocity, 3, 1));
}

static void step_both(mh_tick time)
{
    save(0);
    save(1);
    for (int i = 0; i < 2; i++) {
        const struct mh_saved_track other = {targets[1 - i], bytes[1 - i], lengths[1 - i]};
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->among(&states[i], targets[i], &other, 1));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&states[i], time, heard, heard_count, &estimates[i]));
    }
}

/* Nobody has told that there are two. */
static void two_are_found_as_a_group(void)
{
    targets[0] = 48;
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->among(&states[0], 48, NULL, 0));
    for (int i = 1; i <= 6; i++) {
        const mh_real x = 200 + 15 * (mh_real)i;
        const struct mh_vec2 two[2] = {{x, 144}, {x, 160}};
        hear((mh_tick)i * INTERVAL, two, 2);
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&states[0], (mh_tick)i * INTERVAL, heard, heard_count, estimates));
        TEST_ASSERT_EQUAL_UINT8(2, estimates[0].members);
        TEST_ASSERT_EQUAL_UINT8(MH_TARGET_GROUP, estimates[0].mode);
        TEST_ASSERT_EQUAL_UINT32(48, estimates[0].target);
        TEST_ASSERT_EQUAL_UINT32(48, estimates[0].of[0]);
        TEST_ASSERT_EQUAL_UINT32(49, estimates[0].of[1]);
        TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_REFRESHED | (i == 1 ? MH_ESTIMATE_STARTED : 0), estimates[0].flags);
        assert_at(2.0f, x, 152, &estimates[0]);
        hand_over(0);
    }
    TEST_ASSERT_FLOAT_WITHIN(1.5f, 8, estimates[0].extent);
    TEST_ASSERT_FLOAT_WITHIN(0.5f, 7.5f, estimates[0].velocity.x);
}

static void one_is_no_group(void)
{
    const struct mh_vec2 one = {200, 150};
    hear(INTERVAL, &one, 1);
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&states[0], INTERVAL, heard, heard_count, &estimates[0]));
    TEST_ASSERT_EQUAL_UINT8(1, estimates[0].members);
}

/* Two tracks whose ways cross at 4 m/s: 20 m from each other they become one, beyond 30 m two again. */
static void they_merge_and_part(void)
{
    int merged = 0, split = 0;
    begin_at(0, 5, 100, 185, 8, -2);
    begin_at(1, 3, 100, 139, 8, 2);
    for (int i = 1; i <= 14 && split == 0; i++) {
        const mh_tick time = (mh_tick)i * INTERVAL;
        const mh_real x = 100 + 16 * (mh_real)i, half = 23 - 4 * (mh_real)i;
        const struct mh_vec2 two[2] = {{x, 162 + half}, {x, 162 - half}};
        hear(time, two, 2);
        if (merged == 0) {
            step_both(time);
            assert_at(2.0f, x, 162 + half, &estimates[0]);
            assert_at(2.0f, x, 162 - half, &estimates[1]);
            TEST_ASSERT_FALSE(estimates[0].flags & MH_ESTIMATE_MERGE); /* 3 says so */
            if (estimates[1].flags & MH_ESTIMATE_MERGE) {
                TEST_ASSERT_EQUAL_UINT32(5, estimates[1].near);
                save(0);
                const struct mh_saved_track other = {5, bytes[0], lengths[0]};
                TEST_ASSERT_EQUAL_INT(MH_OK, tracker->join(&states[1], &other));
                merged = i;
            }
            continue;
        }
        hand_over(1);
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&states[1], time, heard, heard_count, &estimates[1]));
        assert_at(1.5f, x, 162, &estimates[1]);
        TEST_ASSERT_EQUAL_UINT8(2, estimates[1].members);
        TEST_ASSERT_EQUAL_UINT32(3, estimates[1].target);
        TEST_ASSERT_EQUAL_UINT32(5, estimates[1].of[1]);
        TEST_ASSERT_FALSE(estimates[1].flags & MH_ESTIMATE_UNRESOLVED);
        split = estimates[1].flags & MH_ESTIMATE_SPLIT ? i : 0;
    }
    TEST_ASSERT_EQUAL_INT(5, merged); /* 14 and 6 m apart at 4 and 5 */
    TEST_ASSERT_EQUAL_INT(12, split); /* 34, 42 and 50 m apart at 10, 11 and 12 */

    hand_over(1); /* the new head parts them */
    const mh_real y[2] = {162 + 25, 162 - 25};
    for (uint8_t k = 0; k < 2; k++) {
        uint32_t target = 0;
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->part(&states[1], k, &target, bytes[0], &lengths[0]));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->init(&states[0], &config, INTERVAL));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->among(&states[0], target, NULL, 0));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->load(&states[0], bytes[0], lengths[0]));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->predict(&states[0], 12 * INTERVAL, &estimates[0]));
        /* 3 came from below and goes on upwards; that both turned back is not much less likely */
        TEST_ASSERT_TRUE(target == 3 || target == 5);
        assert_at(3.0f, 292, target == 3 ? y[0] : y[1], &estimates[0]);
        TEST_ASSERT_FLOAT_WITHIN(1.0f, target == 3 ? 2 : -2, estimates[0].velocity.y);
        TEST_ASSERT_FLOAT_WITHIN(0.1f, 6.25f, estimates[0].covariance.xx);
        TEST_ASSERT_EQUAL_UINT8(1, estimates[0].members);
        TEST_ASSERT_TRUE(estimates[0].flags & MH_ESTIMATE_UNRESOLVED);
    }
    uint32_t target = 0;
    TEST_ASSERT_EQUAL_INT(MH_NONE, tracker->part(&states[1], 2, &target, bytes[0], &lengths[0]));
}

static void a_group_by_weights(void)
{
    struct mh_place places[2];
    const struct mh_vec2 offsets[2] = {{180, 144}, {180, 160}}, velocity = {7.5f, 0};
    mh_group_config_default(&config.group, MH_GROUP_WEIGHTS);
    setUp();
    mh_group_config_default(&config.group, MH_GROUP_WEIGHTS);
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->init(&states[0], &config, INTERVAL));
    for (int k = 0; k < 2; k++) {
        places[k] = mh_place_from_offset(&corner, offsets[k]);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_acoustic_begin_group(&states[0], 48, 0, places, 2, velocity, 3, 1));
    for (int i = 1; i <= 8; i++) {
        /* they part at 2 x 12 m/s from the third instant on */
        const mh_real x = 180 + 15 * (mh_real)i, half = i < 3 ? 8 : 8 + 12 * (mh_real)(i - 2);
        const struct mh_vec2 two[2] = {{x, 152 - half}, {x, 152 + half}};
        hear((mh_tick)i * INTERVAL, two, 2);
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&states[0], (mh_tick)i * INTERVAL, heard, heard_count, estimates));
        assert_at(6.0f, x, 152, &estimates[0]);
        TEST_ASSERT_EQUAL(i == 7 || i == 8, (estimates[0].flags & MH_ESTIMATE_SPLIT) != 0);
    }
}

/* Neither from a message nor from its owner. */
static void who_follows_no_groups_takes_none(void)
{
    static const struct mh_tracker *const plain[] = {&mh_tracker_dm, &mh_tracker_ml};
    const struct mh_place places[2] = {corner, mh_place_from_offset(&corner, (struct mh_vec2){10, 0})};
    const struct mh_vec2 velocity = {10, 0};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_acoustic_begin_group(&states[0], 48, 0, places, 2, velocity, 3, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_acoustic_begin_group(&states[1], 48, 0, places, 1, velocity, 3, 1));
    save(0);
    config.separation = MH_SEPARATION_NONE;
    mh_group_config_default(&config.group, MH_GROUP_NONE);
    for (size_t i = 0; i < sizeof plain / sizeof plain[0]; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, plain[i]->init(&states[1], &config, INTERVAL));
        TEST_ASSERT_EQUAL_INT(MH_OK, plain[i]->among(&states[1], 48, NULL, 0));
        TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, plain[i]->load(&states[1], bytes[0], lengths[0]));
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_acoustic_begin_group(&states[1], 48, 0, places, 2, velocity, 3, 1));
        TEST_ASSERT_EQUAL_INT(MH_NONE, plain[i]->predict(&states[1], INTERVAL, &estimates[1]));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(two_are_found_as_a_group);
    RUN_TEST(one_is_no_group);
    RUN_TEST(they_merge_and_part);
    RUN_TEST(a_group_by_weights);
    RUN_TEST(who_follows_no_groups_takes_none);
    port_exit(UNITY_END() > 0);
}
