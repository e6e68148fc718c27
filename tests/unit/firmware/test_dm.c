/* The tracker `dm`, in either arithmetic; what it has from the other acoustic trackers, with one target and with another one beside it. */
#include "listeners.h"
#include "motehound/acoustic.h"
#include "port.h"
#include "reals.h"

#include <math.h>

#define R mh_real_from_float
#define F mh_real_to_float

enum { INTERVAL = 2000 };

static struct mh_acoustic state;
static struct mh_acoustic_config config;
static struct mh_estimate estimate;
static uint8_t bytes[MH_TRACK_BYTES_MAX];
static size_t length;
static const struct mh_vec2 rest = {0, 0};

void setUp(void)
{
    mh_acoustic_config_default(&config, MH_REAL(40.0f));
    config.separation = MH_SEPARATION_NONE;
    config.intervals = 40;
}
void tearDown(void) {}

static void begin(void) { TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.init(&state, &config, INTERVAL)); }

static struct mh_vec2 at(float x, float y)
{
    const struct mh_vec2 place = {R(x), R(y)};
    return place;
}

static enum mh_status step(mh_tick time, size_t count)
{
    return mh_tracker_dm.step(&state, time, heard, count, &estimate);
}

static enum mh_status step_at(mh_tick time, float x, float y)
{
    const struct mh_vec2 target = at(x, y);
    hear(time, &target, 1);
    return step(time, heard_count);
}

/* Where the estimate's origin is in the field. */
static float origin_x(void) { return F(mh_place_relative(&estimate.origin, &corner).x); }
static float origin_y(void) { return F(mh_place_relative(&estimate.origin, &corner).y); }

static void assert_at(float tolerance, float x, float y)
{
    TEST_ASSERT_FLOAT_WITHIN(tolerance, x, origin_x() + F(estimate.position.x));
    TEST_ASSERT_FLOAT_WITHIN(tolerance, y, origin_y() + F(estimate.position.y));
}

static void assert_save(void) { TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.save(&state, bytes, &length)); }

/* The fix of the three strongest, with config.fix_sd_m in each axis. */
static void a_first_fix(void)
{
    struct mh_heard three[3];
    struct mh_vec2 fix;
    const struct mh_distance_table table = {MH_REAL(40.0f), 40, MH_DISTANCE_MIDDLE};
    begin();
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(500, 0));
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(1000, 133, 77));
    TEST_ASSERT_EQUAL_UINT(3, mh_strongest(heard, heard_count, &estimate.origin, three, 3));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_distance_fix(three, 3, &table, MH_CIRCLES_UNIFORM, &fix));
    TEST_ASSERT_TRUE(fix.x == estimate.raw.x && fix.y == estimate.raw.y && fix.x == estimate.position.x);
    assert_at(1.0f, 133, 77);
    EXPECT_REAL(1e-3f, 1e-3f, 9, estimate.covariance.xx);
    EXPECT_REAL(1e-3f, 1e-3f, 9, estimate.covariance.yy);
    EXPECT_REAL(1e-3f, 1e-3f, 0, estimate.covariance.xy);
    TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_STARTED | MH_ESTIMATE_REFRESHED, estimate.flags);
    TEST_ASSERT_EQUAL_UINT16(heard_count, estimate.measurements);
    TEST_ASSERT_TRUE(estimate.velocity.x == 0 && estimate.velocity.y == 0);
}

/* One axis of a Kalman filter of constant velocity, whose fixes are as good in each axis. */
struct axis {
    float x, v, xx, xv, vv;
};

static void follow(struct axis *axis, float fix, float seconds)
{
    const float q = 0.5f, noise = 9;
    axis->x += seconds * axis->v;
    axis->xx += seconds * (2 * axis->xv + seconds * axis->vv) + q * seconds * seconds * seconds / 3;
    axis->xv += seconds * axis->vv + q * seconds * seconds / 2;
    axis->vv += q * seconds;
    const float inverse = 1 / (axis->xx + noise), gain = axis->xx * inverse, turn = axis->xv * inverse;
    const float off = fix - axis->x;
    axis->x += gain * off;
    axis->v += turn * off;
    axis->vv -= turn * axis->xv;
    axis->xv *= 1 - gain;
    axis->xx *= 1 - gain;
}

/* at (9, -2) m/s, the clock wrapping on the way */
static void follows_a_straight_line_as_the_textbook(void)
{
    const mh_tick t0 = UINT32_MAX - 3000;
    struct axis x = {0, 0, 9, 0, 100}, y = x;
    begin();
    for (int i = 0; i <= 10; i++) {
        const float true_x = 118 + 18 * (float)i, true_y = 156 - 4 * (float)i;
        TEST_ASSERT_EQUAL_INT(MH_OK, step_at(t0 + (mh_tick)i * INTERVAL, true_x, true_y));
        assert_at(1.5f, true_x, true_y);
        if (i == 0) {
            x.x = F(estimate.raw.x);
            y.x = F(estimate.raw.y);
            continue;
        }
        follow(&x, F(estimate.raw.x), 2);
        follow(&y, F(estimate.raw.y), 2);
        TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_REFRESHED, estimate.flags);
        EXPECT_REAL(1e-3f, 4e-3f, x.x, estimate.position.x);
        EXPECT_REAL(1e-3f, 4e-3f, y.x, estimate.position.y);
        EXPECT_REAL(1e-3f, 2e-3f, x.v, estimate.velocity.x);
        EXPECT_REAL(1e-3f, 2e-3f, y.v, estimate.velocity.y);
        EXPECT_REAL(1e-3f, 4e-3f, x.xx, estimate.covariance.xx);
        EXPECT_REAL(1e-3f, 4e-3f, 0, estimate.covariance.xy);
    }
    TEST_ASSERT_FLOAT_WITHIN(0.3f, 9, F(estimate.velocity.x));
    EXPECT_REAL(1.0f, 1.0f, 9.2f, mh_acoustic_largest_speed(&state));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.predict(&state, t0 + 10 * INTERVAL + 3000, &estimate));
    assert_at(2.5f, 325, 110);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_tracker_dm.predict(&state, t0, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, step_at(t0 + 10 * INTERVAL, 280, 120));
}

/* 90 degrees every 6 s is more than the filter expects: it believes the fixes, and goes on with the velocity between the last two. */
static void follows_turns(void)
{
    struct mh_vec2 before = rest;
    float x = 100, y = 100;
    begin();
    for (int i = 1; i <= 8; i++) {
        *(i / 2 % 2 ? &x : &y) += 60;
        TEST_ASSERT_EQUAL_INT(MH_OK, step_at((mh_tick)i * 6000, x, y));
        assert_at(1.5f, x, y);
        if (i > 2 && estimate.raw.x == estimate.position.x) {
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, F(estimate.raw.x - before.x) / 6, F(estimate.velocity.x));
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, F(estimate.raw.y - before.y) / 6, F(estimate.velocity.y));
        }
        before = estimate.position;
    }
}

/* without a filter: the fix itself, and the velocity between the last two, at most 30 m/s, and none below 1 m/s */
static void plain_fixes(void)
{
    config.filtered = false;
    begin();
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(1000, 100, 100));
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(3000, 120, 95));
    const struct mh_vec2 first = estimate.position;
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(7000, 140, 120));
    TEST_ASSERT_TRUE(estimate.raw.x == estimate.position.x);
    EXPECT_REAL(1e-3f, 1e-3f, F(estimate.raw.x - first.x) / 4, estimate.velocity.x);
    EXPECT_REAL(1e-3f, 1e-3f, F(estimate.raw.y - first.y) / 4, estimate.velocity.y);
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(8000, 180, 120));
    EXPECT_REAL(1e-3f, 1e-3f, 30, mh_vec2_length(estimate.velocity));
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(12000, 180, 120.2f));
    TEST_ASSERT_TRUE(estimate.velocity.x == 0 && estimate.velocity.y == 0);
}

/* Variances of powers of two: the same bytes in both arithmetics, and back. */
static void saved_tracks_are_the_same_in_both_arithmetics(void)
{
    static const uint8_t expected[] = {
        0xb0, 0,    0,    0x03, 0xe8,                               /* kind, moving; time 1000 */
        0x29, 0xb9, 0x27, 0x00, 0xee, 0x1e, 0x5d, 0x00,             /* 700,000,000 and -300,000,000 mm */
        0x0a, 0x80, 0xff, 0x00,                                     /* 10.5 and -1 m/s */
        0x40, 0x80, 0,    0,    0x40, 0x80, 0,    0,    0,    0,    /* U, and D: 4 m2 twice, */
        0x3e, 0x80, 0,    0,    0,    0,    0,    0,    0x3e, 0x80, /* 1/4 (m/s)2 twice */
        0,    0,    0,    0x01, 0};                                 /* speeds; one target, no merges, no splits */
    begin();
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_dm.save(&state, bytes, &length));
    TEST_ASSERT_EQUAL_INT(MH_OK,
                          mh_acoustic_begin(&state, 7, 1000, &corner, at(10.5f, -1), MH_REAL(2.0f), MH_REAL(0.5f)));
    assert_save();
    TEST_ASSERT_EQUAL_UINT(sizeof expected, length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, bytes, sizeof expected);
    begin();
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.load(&state, bytes, length));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.predict(&state, 1000, &estimate));
    EXPECT_REAL(1e-5f, 1e-4f, 4, estimate.covariance.xx);
    EXPECT_REAL(1e-5f, 1e-4f, 0.25f, estimate.covariance_more[7 - 1]);
}

/* Rounded to 8 significant bits, a hand-over changes variances by 1 % at most, and is none of its own after that. */
static void goes_on_from_what_was_saved(void)
{
    uint8_t again[MH_TRACK_BYTES_MAX];
    size_t again_length;
    begin();
    for (int i = 1; i <= 4; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, step_at((mh_tick)i * INTERVAL, 100 + 20 * (float)i, 100));
    }
    const float x = origin_x() + F(estimate.position.x), y = origin_y() + F(estimate.position.y);
    const struct mh_estimate before = estimate;
    assert_save();
    TEST_ASSERT_EQUAL_UINT(42, length);
    begin();
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.among(&state, 77, NULL, 0));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.load(&state, bytes, length));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.predict(&state, 4 * INTERVAL, &estimate));
    assert_at(0.002f, x, y);
    TEST_ASSERT_EQUAL_UINT32(77, estimate.target);
    EXPECT_REAL(0.003f, 0.003f, F(before.velocity.x), estimate.velocity.x);
    const float xx = F(before.covariance.xx), vv = F(before.covariance_more[6]);
    EXPECT_REAL(0.01f * xx, 0.01f * xx, xx, estimate.covariance.xx);
    EXPECT_REAL(0.01f * vv, 0.01f * vv, vv, estimate.covariance_more[6]);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.save(&state, again, &again_length));
    TEST_ASSERT_EQUAL_UINT(length, again_length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(bytes, again, length);
}

static void refuses_what_it_did_not_save(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(1000, 100, 100));
    assert_save();
    begin();
    for (size_t i = 0; i < length; i++) {
        TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_dm.load(&state, bytes, i));
    }
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_dm.load(&state, bytes, length + 1));
    /* kind; a coordinate beyond the map; an element of D of 3e38, one that is no number, one below 0, one of 1e-30; one of U that is no number; no targets */
    static const uint8_t where[] = {0, 5, 17, 17, 17, 17, 19, 40}, value[] = {0, 0x7f, 0x7f, 0x7f, 0xc0, 0x0d, 0x7f, 0};
    static const uint8_t second[] = {0, 0, 0x70, 0xc0, 0x80, 0, 0xc0, 0};
    for (int i = 0; i < 8; i++) {
        const uint8_t good[2] = {bytes[where[i]], bytes[where[i] + 1]};
        bytes[where[i]] = value[i];
        bytes[where[i] + 1] = i >= 2 && i < 7 ? second[i] : good[1];
        TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_dm.load(&state, bytes, length));
        bytes[where[i]] = good[0];
        bytes[where[i] + 1] = good[1];
    }
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_dm.predict(&state, 1000, &estimate)); /* as after init */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.load(&state, bytes, length));
}

static void coasts_and_ends(void)
{
    config.coast_s = MH_REAL(5.0f);
    begin();
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(1000, 100, 100));
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(3000, 120, 100));
    TEST_ASSERT_EQUAL_INT(MH_OK, step(5000, 0));
    TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_COASTED, estimate.flags);
    assert_at(4.0f, 140, 100);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(7000, 1)); /* one node is no place */
    TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_COASTED, estimate.flags);
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(9000, 0));
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(11000, 400, 100));
    TEST_ASSERT_TRUE(estimate.flags & MH_ESTIMATE_STARTED);
    mh_tracker_dm.restart(&state);
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(12000, 100, 100));
    TEST_ASSERT_TRUE(estimate.flags & MH_ESTIMATE_STARTED);
}

/* Nodes on a line hear the same of a target on either side of it: the prediction decides. */
static void a_mirror_image_is_found_out(void)
{
    int mirrored = 0;
    for (int side = -1; side <= 1; side += 2) {
        const float y = 60 + 28 * (float)side;
        const struct mh_place place = mh_place_from_offset(&corner, at(150, y));
        const struct mh_vec2 target = at(170, y);
        begin();
        TEST_ASSERT_EQUAL_INT(MH_OK,
                              mh_acoustic_begin(&state, 5, 1000, &place, at(10, 0), MH_REAL(3.0f), MH_REAL(1.0f)));
        hear(3000, &target, 1);
        size_t count = 0;
        for (size_t i = 0; i < heard_count; i++) {
            if (heard[i].place.y_mm == corner.y_mm + 60000) {
                heard[count++] = heard[i];
            }
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, step(3000, count));
        assert_at(3.0f, 170, y);
        mirrored += (estimate.flags & MH_ESTIMATE_MIRRORED) != 0;
    }
    TEST_ASSERT_GREATER_THAN(0, mirrored);
}

/* Another target `apart` m beside the own one, both at 10 m/s: where the own one is found, by shares of the energies or not. */
static float error_beside(float apart, enum mh_separation separation)
{
    const struct mh_vec2 first = at(100, 130), second = at(100, 130 + apart);
    const struct mh_vec2 targets[] = {at(120, 130), at(120, 130 + apart)};
    struct mh_place place = mh_place_from_offset(&corner, second);
    config.separation = separation;
    begin();
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_acoustic_begin(&state, 2, 0, &place, at(10, 0), MH_REAL(2.0f), MH_REAL(0.5f)));
    assert_save();
    const struct mh_saved_track other = {2, bytes, length};
    place = mh_place_from_offset(&corner, first);
    begin();
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_acoustic_begin(&state, 1, 0, &place, at(10, 0), MH_REAL(2.0f), MH_REAL(0.5f)));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_dm.among(&state, 1, &other, 1));
    hear(INTERVAL, targets, 2);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(INTERVAL, heard_count));
    TEST_ASSERT_EQUAL_UINT32(1, estimate.target);
    TEST_ASSERT_EQUAL_UINT8(apart < 100 ? MH_TARGET_SPARSE : MH_TARGET_SINGLE, estimate.mode);
    const float x = origin_x() + F(estimate.raw.x) - 120, y = origin_y() + F(estimate.raw.y) - 130;
    return sqrtf(x * x + y * y);
}

static void another_target_beside_it(void)
{
    TEST_ASSERT_FLOAT_WITHIN(4.0f, 0, error_beside(60, MH_SEPARATION_DECOMPOSITION));
    TEST_ASSERT_FALSE(estimate.flags & MH_ESTIMATE_UNRESOLVED);
    TEST_ASSERT_FLOAT_WITHIN(4.0f, 0, error_beside(130, MH_SEPARATION_NONE));
    (void)error_beside(12, MH_SEPARATION_NONE); /* nearer than 14 m */
    TEST_ASSERT_TRUE(estimate.flags & MH_ESTIMATE_UNRESOLVED);
    const struct mh_saved_track cut = {2, bytes, length - 1};
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_dm.among(&state, 1, &cut, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_dm.among(&state, 1, NULL, 1));
}

/* On a node; nodes all in one place; energies of nothing, below it and saturated; nodes too far away for the numbers. */
static void degenerate_inputs(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(1000, 120, 90));
    assert_at(1.0f, 120, 90);
    for (size_t i = 0; i < heard_count; i++) {
        heard[i].place = heard[0].place;
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, heard_count));
    TEST_ASSERT_TRUE(mh_vec2_finite(estimate.position) && mh_vec2_finite(estimate.velocity));
    TEST_ASSERT_EQUAL_INT(MH_OK, step_at(3000, 120, 90));
    heard[0].value = 0;
    heard[1].value = -MH_Q20_ONE;
    heard[2].value = INT32_MAX;
    TEST_ASSERT_EQUAL_INT(MH_OK, step(4000, heard_count));
    TEST_ASSERT_EQUAL_UINT16(heard_count - 2, estimate.measurements);
    TEST_ASSERT_TRUE(mh_vec2_finite(estimate.position) && mh_vec2_finite(estimate.velocity));
    const struct mh_vec2 target = at(120, 90);
    hear(5000, &target, 1);
    for (size_t i = 0; i < heard_count; i++) {
        heard[i].place.x_mm -= 1500000000;
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, step(5000, heard_count));
    TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_COASTED, estimate.flags & MH_ESTIMATE_COASTED);
    assert_at(30.0f, 120, 90);
    mh_tracker_dm.restart(&state);
    for (size_t i = 0; i < heard_count; i++) {
        heard[i].value = 0;
    }
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(6000, heard_count));
}

static void configurations_out_of_range(void)
{
    for (int i = 0; i < 9; i++) {
        setUp();
        switch (i) {
        case 0:
            config.sound.loudness_m2 = 0;
            break;
        case 1:
            config.sensing_range_m = NOT_A_NUMBER;
            break;
        case 2:
            config.sensing_range_m = mh_mul(MH_REAL(1.01f), MH_DISTANCE_FIX_RANGE_MAX);
            break;
        case 3:
            config.strongest = 1;
            break;
        case 4:
            config.acceleration_psd = 0;
            break;
        case 5:
            config.fix_sd_m = mh_mul(MH_REAL(1.01f), MH_ACOUSTIC_SD_MAX);
            break;
        case 6:
            config.coast_s = ENDLESS;
            break;
        case 7:
            config.separation = MH_SEPARATION_JOINT;
            break;
        default:
            config.group.mode = MH_GROUP_MEMBERS;
            break;
        }
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_dm.init(&state, &config, INTERVAL));
    }
    setUp();
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_dm.init(&state, &config, 0));
    begin();
    const struct mh_vec2 bad = {NOT_A_NUMBER, 0};
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_acoustic_begin(&state, 1, 0, &corner, rest, 0, MH_REAL(1.0f)));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE,
                          mh_acoustic_begin(&state, 1, 0, &corner, bad, MH_REAL(1.0f), MH_REAL(1.0f)));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_dm.predict(&state, 0, &estimate));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_first_fix);
    RUN_TEST(follows_a_straight_line_as_the_textbook);
    RUN_TEST(follows_turns);
    RUN_TEST(plain_fixes);
    RUN_TEST(saved_tracks_are_the_same_in_both_arithmetics);
    RUN_TEST(goes_on_from_what_was_saved);
    RUN_TEST(refuses_what_it_did_not_save);
    RUN_TEST(coasts_and_ends);
    RUN_TEST(a_mirror_image_is_found_out);
    RUN_TEST(another_target_beside_it);
    RUN_TEST(degenerate_inputs);
    RUN_TEST(configurations_out_of_range);
    port_exit(UNITY_END() > 0);
}
