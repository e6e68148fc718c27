/* The acoustic trackers with one target; several: test_acoustic_among.c, `dm`: test_dm.c. */
#include "listeners.h"
#include "motehound/acoustic.h"
#include "port.h"
#include "unity.h"

enum { INTERVAL = 2000 };

static struct mh_acoustic state;
static struct mh_acoustic_config config;
static struct mh_estimate estimate;
static uint8_t bytes[MH_TRACK_BYTES_MAX];

void setUp(void) { mh_acoustic_config_default(&config, 40); }
void tearDown(void) {}

static void begin(const struct mh_tracker *tracker)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->init(&state, &config, INTERVAL));
}

static enum mh_status step_at(mh_tick time, mh_real x, mh_real y)
{
    const struct mh_vec2 target = {x, y};
    hear(time, &target, 1);
    return mh_tracker_acoustic.step(&state, time, heard, heard_count, &estimate);
}

static void assert_at(mh_real tolerance, mh_real x, mh_real y)
{
    const struct mh_vec2 origin = mh_place_relative(&estimate.origin, &corner);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, x, origin.x + estimate.position.x);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, y, origin.y + estimate.position.y);
}

/* at (9, -2) m/s, the clock wrapping on the way */
static void follows_a_straight_line(void)
{
    const mh_tick t0 = UINT32_MAX - 3000;
    begin(&mh_tracker_acoustic);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_acoustic.predict(&state, t0, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_acoustic.step(&state, t0, NULL, 0, &estimate));
    for (int i = 1; i <= 10; i++) {
        const mh_real x = 100 + 18 * (mh_real)i, y = 160 - 4 * (mh_real)i;
        TEST_ASSERT_EQUAL_INT(MH_OK, step_at(t0 + (mh_tick)i * INTERVAL, x, y));
        assert_at(1.0f, x, y);
        TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_REFRESHED | (i == 1 ? MH_ESTIMATE_STARTED : 0), estimate.flags);
        TEST_ASSERT_EQUAL_UINT16(heard_count, estimate.measurements);
        TEST_ASSERT_EQUAL_UINT8(MH_TARGET_SINGLE, estimate.mode);
        TEST_ASSERT_EQUAL_UINT8(1, estimate.members);
        TEST_ASSERT_TRUE((i == 1) == (estimate.velocity.x == 0)); /* unknown at the first fix */
    }
    TEST_ASSERT_FLOAT_WITHIN(0.2f, 9, estimate.velocity.x);
    TEST_ASSERT_FLOAT_WITHIN(0.2f, -2, estimate.velocity.y);
    TEST_ASSERT_FLOAT_WITHIN(0.4f, 9.22f, mh_acoustic_largest_speed(&state));
    TEST_ASSERT_TRUE(estimate.covariance.xx > 0.3f && estimate.covariance.xx < 9);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.predict(&state, t0 + 10 * INTERVAL + 3000, &estimate));
    assert_at(1.5f, 307, 114);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_tracker_acoustic.predict(&state, t0, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, step_at(t0 + 10 * INTERVAL, 280, 120));
}

/* 90 degrees every 6 s is more than the filter expects: it believes the fixes. */
static void follows_turns(void)
{
    begin(&mh_tracker_acoustic);
    mh_real x = 100, y = 100;
    for (int i = 1; i <= 8; i++) {
        *(i / 2 % 2 ? &x : &y) += 60;
        TEST_ASSERT_EQUAL_INT(MH_OK, step_at((mh_tick)i * 6000, x, y));
        assert_at(2.0f, x, y);
    }
    TEST_ASSERT_FLOAT_WITHIN(1.0f, 10, mh_acoustic_largest_speed(&state));
}

/* without a filter: the fix itself, and the velocity between the last two */
static void plain_fixes(void)
{
    config.filtered = false;
    begin(&mh_tracker_acoustic);
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(1000, 100, 100));
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(3000, 120, 95));
    const struct mh_vec2 first = estimate.position, origin = mh_place_relative(&estimate.origin, &corner);
    TEST_ASSERT_EQUAL_FLOAT(estimate.raw.x, estimate.position.x);
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(7000, 140, 120));
    const struct mh_vec2 moved = mh_place_relative(&estimate.origin, &corner);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, (moved.x + estimate.raw.x - origin.x - first.x) / 4, estimate.velocity.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, (moved.y + estimate.raw.y - origin.y - first.y) / 4, estimate.velocity.y);
    /* impossibly fast, and hardly at all */
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(8000, 180, 120));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 30, mh_sqrt(mh_squared(estimate.velocity.x) + mh_squared(estimate.velocity.y)));
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(12000, 180, 120.2f));
    TEST_ASSERT_EQUAL_FLOAT(0, estimate.velocity.x);
    TEST_ASSERT_EQUAL_FLOAT(0, estimate.velocity.y);
}

static void goes_on_from_what_was_saved(void)
{
    size_t length = 0;
    struct mh_acoustic_summary summary;
    begin(&mh_tracker_acoustic);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_acoustic.save(&state, bytes, &length));
    for (int i = 1; i <= 4; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, step_at((mh_tick)i * 2000, 100 + 20 * (mh_real)i, 100));
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.save(&state, bytes, &length));
    TEST_ASSERT_EQUAL_UINT(42, length);
    const struct mh_estimate before = estimate;
    begin(&mh_tracker_acoustic);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.among(&state, 77, NULL, 0));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.load(&state, bytes, length));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.predict(&state, 8000, &estimate));
    const struct mh_vec2 was = mh_place_relative(&before.origin, &corner);
    assert_at(0.002f, was.x + before.position.x, was.y + before.position.y);
    TEST_ASSERT_FLOAT_WITHIN(0.003f, before.velocity.x, estimate.velocity.x);
    TEST_ASSERT_FLOAT_WITHIN(0.02f * before.covariance.xx, before.covariance.xx, estimate.covariance.xx);
    TEST_ASSERT_FLOAT_WITHIN(0.2f, 10, mh_acoustic_largest_speed(&state));
    TEST_ASSERT_EQUAL_UINT32(77, estimate.target);
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(10000, 200, 100));
    assert_at(1.0f, 200, 100);
    TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_REFRESHED, estimate.flags);

    TEST_ASSERT_EQUAL_INT(MH_OK, mh_acoustic_look(77, bytes, length, 11000, &summary));
    const struct mh_vec2 place = mh_place_relative(&summary.place, &corner);
    TEST_ASSERT_FLOAT_WITHIN(2.0f, 210, place.x);
    TEST_ASSERT_FLOAT_WITHIN(2.0f, 100, place.y);
    TEST_ASSERT_EQUAL_UINT32(8000, summary.fixed);
    TEST_ASSERT_EQUAL_UINT8(1, summary.members);
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_acoustic_look(77, bytes, 5, 11000, &summary));
}

static void refuses_what_it_did_not_save(void)
{
    size_t length;
    begin(&mh_tracker_acoustic);
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(1000, 100, 100));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.save(&state, bytes, &length));
    begin(&mh_tracker_acoustic);
    for (size_t i = 0; i < length; i++) {
        TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_acoustic.load(&state, bytes, i));
    }
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_acoustic.load(&state, bytes, length + 1));
    /* kind; a coordinate beyond the map; a variance that is no number; one below 0; no targets */
    static const uint8_t at[] = {0, 5, 17, 17, 40}, value[] = {0, 0x7f, 0x7f, 0xc0, 0};
    for (int i = 0; i < 5; i++) {
        const uint8_t good[2] = {bytes[at[i]], bytes[at[i] + 1]};
        bytes[at[i]] = value[i];
        bytes[at[i] + 1] = i == 2 ? 0xc0 : good[1];
        TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_acoustic.load(&state, bytes, length));
        bytes[at[i]] = good[0];
        bytes[at[i] + 1] = good[1];
    }
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_acoustic.predict(&state, 1000, &estimate)); /* as after init */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.load(&state, bytes, length));
}

static void coasts_and_ends(void)
{
    config.coast_s = 5;
    begin(&mh_tracker_acoustic);
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(1000, 100, 100));
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(3000, 120, 100));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.step(&state, 5000, NULL, 0, &estimate));
    TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_COASTED, estimate.flags);
    assert_at(3.0f, 140, 100);
    heard_count = 1; /* one node is no place */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.step(&state, 7000, heard, heard_count, &estimate));
    TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_COASTED, estimate.flags);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_acoustic.step(&state, 9000, NULL, 0, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(11000, 400, 100));
    TEST_ASSERT_TRUE(estimate.flags & MH_ESTIMATE_STARTED);
    mh_tracker_acoustic.restart(&state);
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(12000, 100, 100));
    TEST_ASSERT_TRUE(estimate.flags & MH_ESTIMATE_STARTED);
}

/* Nodes on a line hear the same of a target on either side of it: the prediction decides. */
static void a_mirror_image_is_found_out(void)
{
    int mirrored = 0;
    for (int side = -1; side <= 1; side += 2) {
        const mh_real y = 60 + 28 * (mh_real)side;
        struct mh_place place = corner;
        place.x_mm += 150000;
        place.y_mm += (int32_t)(1000 * y);
        const struct mh_vec2 velocity = {10, 0}, target = {170, y};
        begin(&mh_tracker_acoustic);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_acoustic_begin(&state, 5, 1000, &place, velocity, 3, 1));
        hear(3000, &target, 1);
        size_t count = 0;
        for (size_t i = 0; i < heard_count; i++) {
            if (heard[i].place.y_mm == corner.y_mm + 60000) {
                heard[count++] = heard[i];
            }
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.step(&state, 3000, heard, count, &estimate));
        assert_at(2.0f, 170, y);
        mirrored += (estimate.flags & MH_ESTIMATE_MIRRORED) != 0;
    }
    TEST_ASSERT_GREATER_THAN(0, mirrored);
}

static void maximum_likelihood(void)
{
    const struct mh_vec2 target = {133, 77};
    config.separation = MH_SEPARATION_DECOMPOSITION;
    config.filtered = false;
    begin(&mh_tracker_ml);
    hear(1000, &target, 1);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_ml.step(&state, 1000, heard, heard_count, &estimate));
    assert_at(1.5f, 133, 77);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 9, estimate.covariance.xx);
    config.separation = MH_SEPARATION_JOINT;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_ml.init(&state, &config, INTERVAL));
}

/* On a node; nodes all in one place; energies of nothing, below it and saturated. */
static void degenerate_inputs(void)
{
    begin(&mh_tracker_acoustic);
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(1000, 120, 90));
    assert_at(0.5f, 120, 90);
    for (size_t i = 0; i < heard_count; i++) {
        heard[i].place = heard[0].place;
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.step(&state, 2000, heard, heard_count, &estimate));
    TEST_ASSERT_TRUE(mh_finite(estimate.position.x) && mh_finite(estimate.velocity.y));
    step_at(3000, 120, 90);
    heard[0].value = 0;
    heard[1].value = -MH_Q20_ONE;
    heard[2].value = INT32_MAX;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_acoustic.step(&state, 4000, heard, heard_count, &estimate));
    TEST_ASSERT_EQUAL_UINT16(heard_count - 2, estimate.measurements);
    TEST_ASSERT_TRUE(mh_finite(estimate.position.x) && mh_finite(estimate.velocity.y));
    mh_tracker_acoustic.restart(&state);
    for (size_t i = 0; i < heard_count; i++) {
        heard[i].value = 0;
    }
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_acoustic.step(&state, 5000, heard, heard_count, &estimate));
}

static void configurations_out_of_range(void)
{
    for (int i = 0; i < 7; i++) {
        mh_acoustic_config_default(&config, 40);
        switch (i) {
        case 0:
            config.sound.loudness_m2 = 0;
            break;
        case 1:
            config.sensing_range_m = NAN;
            break;
        case 2:
            config.strongest = 1;
            break;
        case 3:
            config.acceleration_psd = 0;
            break;
        case 4:
            config.coast_s = INFINITY;
            break;
        case 5:
            config.sound.source_sd = config.sound.background_sd = 0;
            break;
        default:
            config.group.merge_epochs = 0;
            break;
        }
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_acoustic.init(&state, &config, INTERVAL));
    }
    mh_acoustic_config_default(&config, 40);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_acoustic.init(&state, &config, 0));
    begin(&mh_tracker_acoustic);
    const struct mh_vec2 rest = {0, 0}, bad = {NAN, 0};
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_acoustic_begin(&state, 1, 0, &corner, rest, 0, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_acoustic_begin(&state, 1, 0, &corner, bad, 1, 1));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_acoustic.predict(&state, 0, &estimate));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(follows_a_straight_line);
    RUN_TEST(follows_turns);
    RUN_TEST(plain_fixes);
    RUN_TEST(goes_on_from_what_was_saved);
    RUN_TEST(refuses_what_it_did_not_save);
    RUN_TEST(coasts_and_ends);
    RUN_TEST(a_mirror_image_is_found_out);
    RUN_TEST(maximum_likelihood);
    RUN_TEST(degenerate_inputs);
    RUN_TEST(configurations_out_of_range);
    port_exit(UNITY_END() > 0);
}
