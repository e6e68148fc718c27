/* The acoustic trackers with others around; one target: test_acoustic.c. */
#include "listeners.h"
#include "motehound/acoustic.h"
#include "port.h"
#include "unity.h"

enum { INTERVAL = 2000, TARGETS = 2 };

static struct mh_acoustic state;
static struct mh_acoustic_config config;
static struct mh_estimate estimate;
static uint8_t saved[TARGETS][64];
static size_t lengths[TARGETS];
static mh_real largest_error;
static uint16_t flags;
static uint8_t mode;

void setUp(void) { mh_acoustic_config_default(&config, 40); }
void tearDown(void) {}

static void save(int k)
{
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.save(&state, bytes, &lengths[k]));
    TEST_ASSERT_TRUE(lengths[k] <= sizeof saved[k]);
    memcpy(saved[k], bytes, lengths[k]);
}

static void begin(int k, struct mh_vec2 at, struct mh_vec2 velocity)
{
    const struct mh_place place = mh_place_from_offset(&corner, at);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.init(&state, &config, INTERVAL));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_acoustic_begin(&state, (uint32_t)(k + 1), 0, &place, velocity, 2, 0.5f));
    save(k);
}

/* Target k's track on to what is heard now, the other beside it as last saved. */
static void step(int k, mh_tick time, struct mh_vec2 truth, const struct mh_saved_track *other)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.init(&state, &config, INTERVAL));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.among(&state, (uint32_t)(k + 1), other, 1));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.load(&state, saved[k], lengths[k]));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.step(&state, time, heard, heard_count, &estimate));
    const struct mh_vec2 origin = mh_place_relative(&estimate.origin, &corner);
    const mh_real x = origin.x + estimate.position.x - truth.x, y = origin.y + estimate.position.y - truth.y;
    largest_error = mh_max(largest_error, mh_sqrt(x * x + y * y));
    TEST_ASSERT_EQUAL_UINT32((uint32_t)k + 1, estimate.target);
    flags |= estimate.flags;
    mode = estimate.mode;
}

/* Both for `instants` of 2 s, from `at` with `velocity`. */
static void follow(const struct mh_vec2 *at, const struct mh_vec2 *velocity, int instants)
{
    struct mh_vec2 truth[TARGETS] = {at[0], at[1]};
    largest_error = 0;
    flags = 0;
    begin(0, at[0], velocity[0]);
    begin(1, at[1], velocity[1]);
    for (int i = 1; i <= instants; i++) {
        const mh_tick time = (mh_tick)i * INTERVAL;
        for (int k = 0; k < TARGETS; k++) {
            truth[k].x += 2 * velocity[k].x;
            truth[k].y += 2 * velocity[k].y;
        }
        hear(time, truth, TARGETS);
        uint8_t before[sizeof saved[0]];
        memcpy(before, saved[0], sizeof before);
        const struct mh_saved_track second = {2, saved[1], lengths[1]}, first = {1, before, lengths[0]};
        step(0, time, truth[0], &second);
        save(0);
        step(1, time, truth[1], &first);
        save(1);
    }
}

static void side_by_side(mh_real apart, int instants)
{
    const struct mh_vec2 at[TARGETS] = {{100, 130}, {100, 130 + apart}}, velocity[TARGETS] = {{10, 0}, {10, 0}};
    follow(at, velocity, instants);
}

static void the_joint_fit_tells_apart_what_is_close(void)
{
    side_by_side(25, 8);
    TEST_ASSERT_FLOAT_WITHIN(1.5f, 0, largest_error);
    TEST_ASSERT_EQUAL_UINT8(MH_TARGET_SPARSE, mode);
    TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_REFRESHED, flags);
}

static void shares_do_for_what_is_not(void)
{
    config.separation = MH_SEPARATION_DECOMPOSITION;
    side_by_side(60, 8);
    const mh_real decomposed = largest_error;
    config.separation = MH_SEPARATION_NONE;
    side_by_side(60, 8);
    TEST_ASSERT_FLOAT_WITHIN(4.0f, 0, decomposed);
    TEST_ASSERT_GREATER_THAN_FLOAT(10.0f, largest_error); /* each with the other's sound */
}

/* from a gap of 100 m on two are sparse, until there are 120 m between them */
static void modes_have_hysteresis(void)
{
    const mh_real gaps[] = {130, 110, 95, 110, 118, 125, 110};
    const uint8_t modes[] = {MH_TARGET_SINGLE, MH_TARGET_SINGLE, MH_TARGET_SPARSE, MH_TARGET_SPARSE,
                             MH_TARGET_SPARSE, MH_TARGET_SINGLE, MH_TARGET_SINGLE};
    const struct mh_vec2 at = {120, 100}, rest = {0, 0};
    begin(0, at, rest);
    for (int i = 0; i < 7; i++) {
        const struct mh_vec2 truth[TARGETS] = {at, {120 + gaps[i], 100}};
        begin(1, truth[1], rest);
        const struct mh_saved_track second = {2, saved[1], lengths[1]};
        hear((mh_tick)(i + 1) * INTERVAL, truth, TARGETS);
        step(0, (mh_tick)(i + 1) * INTERVAL, at, &second);
        save(0);
        TEST_ASSERT_EQUAL_UINT8(modes[i], mode);
    }
}

static void who_may_have_been_exchanged_stays_unresolved(void)
{
    const struct mh_vec2 at[TARGETS] = {{60, 90}, {60, 170}}, velocity[TARGETS] = {{8, 5}, {8, -5}};
    follow(at, velocity, 14);
    TEST_ASSERT_FLOAT_WITHIN(6.0f, 0, largest_error);
    TEST_ASSERT_TRUE(flags & MH_ESTIMATE_UNRESOLVED);
    TEST_ASSERT_TRUE(estimate.flags & MH_ESTIMATE_UNRESOLVED); /* still, 60 m later, after all the hand-overs */
    side_by_side(60, 8);
    TEST_ASSERT_FALSE(flags & MH_ESTIMATE_UNRESOLVED);
}

/* A new target beside one that is known: of what is heard, what that does not explain. */
static void a_new_target_beside_a_known_one(void)
{
    const struct mh_vec2 truth[TARGETS] = {{100, 100}, {165, 130}}, rest = {0, 0};
    begin(0, truth[0], rest);
    const struct mh_saved_track first = {1, saved[0], lengths[0]};
    hear(INTERVAL, truth, TARGETS);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.init(&state, &config, INTERVAL));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.among(&state, 2, &first, 1));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.step(&state, INTERVAL, heard, heard_count, &estimate));
    const struct mh_vec2 origin = mh_place_relative(&estimate.origin, &corner);
    TEST_ASSERT_FLOAT_WITHIN(8.0f, truth[1].x, origin.x + estimate.position.x);
    TEST_ASSERT_FLOAT_WITHIN(8.0f, truth[1].y, origin.y + estimate.position.y);
    TEST_ASSERT_EQUAL_UINT32(2, estimate.target);

    /* and where there is none there is nothing */
    hear(INTERVAL, truth, 1);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.init(&state, &config, INTERVAL));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.among(&state, 2, &first, 1));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_acoustic.step(&state, INTERVAL, heard, heard_count, &estimate));
}

static void others_that_are_none_are_refused(void)
{
    const struct mh_vec2 at = {100, 100}, velocity = {10, 0}, truth = {120, 100};
    begin(1, at, velocity);
    begin(0, at, velocity);
    const struct mh_saved_track cut = {2, saved[1], lengths[1] - 1};
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_acoustic.among(&state, 1, &cut, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_acoustic.among(&state, 1, NULL, 1));
    hear(INTERVAL, &truth, 1);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.step(&state, INTERVAL, heard, heard_count, &estimate));
    TEST_ASSERT_EQUAL_UINT8(MH_TARGET_SINGLE, estimate.mode);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_joint_fit_tells_apart_what_is_close);
    RUN_TEST(shares_do_for_what_is_not);
    RUN_TEST(modes_have_hysteresis);
    RUN_TEST(who_may_have_been_exchanged_stays_unresolved);
    RUN_TEST(a_new_target_beside_a_known_one);
    RUN_TEST(others_that_are_none_are_refused);
    port_exit(UNITY_END() > 0);
}
