#include "motehound/estimate.h"
#include "port.h"
#include "record/followed.h"
#include "record/grouping.h"
#include "unity.h"

#include <math.h>
#include <string.h>

enum { ROOM = 2000 };

/* Unity is built without double. */
static bool near(double expected, double actual) { return fabs(expected - actual) <= 1e-9 * (1 + fabs(expected)); }
#define NEAR(expected, actual) TEST_ASSERT_TRUE(near(expected, actual))

static struct scenario scenario;
static struct recorder recorder;
static motehound_track_t tracks[ROOM];
static motehound_truth_t truths[ROOM];

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    scenario.metrics.lost_m = 40;
    scenario.metrics.lost_samples = 3;
    scenario.metrics.skip_first = 0;
    scenario.sensor.interval_s = 2;
    scenario.network.ideal = true;
    recorder = (struct recorder){.tracks = tracks, .truths = truths};
}
void tearDown(void) { scenario_free(&scenario); }

static void be_at(double time_s, int32_t target, double x_m, double y_m)
{
    TEST_ASSERT_TRUE(recorder.truth_count < ROOM);
    truths[recorder.truth_count++] =
        (motehound_truth_t){.time_s = time_s, .target = target, .present = 1, .x_m = x_m, .y_m = y_m};
    recorder.targets = target >= recorder.targets ? target + 1 : recorder.targets;
    recorder.first_s = recorder.samples == 0 ? time_s : recorder.first_s;
    recorder.samples += recorder.samples == 0 || time_s > recorder.last_s;
    recorder.last_s = time_s;
}

/* The track of `number`, whose identifier is 70 more. */
static motehound_track_t *follow(double time_s, int32_t number, double x_m, double y_m)
{
    TEST_ASSERT_TRUE(recorder.track_count < ROOM);
    motehound_track_t *track = &tracks[recorder.track_count++];
    *track = (motehound_track_t){.time_s = time_s,
                                 .target = 70 + number,
                                 .number = number,
                                 .mode = MH_TARGET_SINGLE,
                                 .members = 1,
                                 .x_m = x_m,
                                 .y_m = y_m,
                                 .vx_mps = 10,
                                 .measurements = 5};
    return track;
}

static motehound_track_t *follow_group(double time_s, int32_t first, int32_t count, double x_m, double y_m,
                                       double extent_m)
{
    motehound_track_t *track = follow(time_s, first, x_m, y_m);
    track->number = -1;
    track->mode = MH_TARGET_GROUP;
    track->members = count;
    track->extent_m = extent_m;
    for (int32_t i = 0; i < count; i++) {
        track->of[i] = 70 + first + i;
    }
    return track;
}

/* Two targets along x, so far apart; their tracks are off by what offset() says. */
static struct followed two_of(double spacing_m, void (*offset)(int instant, double offsets_m[2]))
{
    for (int i = 0; i < 40; i++) {
        double offsets_m[2] = {0};
        offset(i, offsets_m);
        for (int k = 0; k < 2; k++) {
            be_at(2.0 * i, k, 20.0 * i, spacing_m * k);
        }
        for (int k = 0; k < 2; k++) {
            (void)follow(2.0 * i, k, 20.0 * i, spacing_m * k + offsets_m[k]);
        }
    }
    return followed_of(&recorder, &scenario);
}

static void not_at_all(int instant, double offsets_m[2])
{
    (void)instant;
    (void)offsets_m;
}

static void exchanged(int instant, double offsets_m[2])
{
    offsets_m[0] = instant >= 20 ? 30 : 0;
    offsets_m[1] = instant >= 20 ? -30 : 0;
}

static void exchanged_for_a_while(int instant, double offsets_m[2])
{
    exchanged(instant >= 30 ? 0 : instant, offsets_m);
}

static void one_comes_to_the_other(int instant, double offsets_m[2]) { offsets_m[1] = instant >= 37 ? -16 : 0; }

static void one_comes_late_to_the_other(int instant, double offsets_m[2]) { offsets_m[1] = instant >= 38 ? -16 : 0; }

static void tracks_on_their_targets_are_a_success(void)
{
    const struct followed followed = two_of(30, not_at_all);
    TEST_ASSERT_FALSE(followed.lost || followed.coalesced || followed.unresolved);
    TEST_ASSERT_EQUAL_UINT(0, followed.swaps);
    NEAR(20, followed.longest_gap_m);
}

static void an_exchange_counts_in_the_end(void)
{
    struct followed followed = two_of(30, exchanged);
    TEST_ASSERT_EQUAL_UINT(1, followed.swaps);
    TEST_ASSERT_EQUAL_UINT(1, followed.swaps_claimed);
    TEST_ASSERT_FALSE(followed.lost || followed.coalesced);
    for (size_t i = 1; i < recorder.track_count; i += 2) {
        tracks[i].flags = MH_ESTIMATE_UNRESOLVED;
    }
    followed = followed_of(&recorder, &scenario);
    TEST_ASSERT_TRUE(followed.unresolved);
    TEST_ASSERT_EQUAL_UINT(1, followed.swaps);
    TEST_ASSERT_EQUAL_UINT(1, followed.swaps_claimed); /* one of the two still claims */
    recorder.track_count = recorder.truth_count = recorder.samples = 0;
    TEST_ASSERT_EQUAL_UINT(0, two_of(30, exchanged_for_a_while).swaps);
}

static void two_tracks_on_one_target_are_one(void)
{
    TEST_ASSERT_TRUE(two_of(30, one_comes_to_the_other).coalesced);
    recorder.track_count = recorder.truth_count = recorder.samples = 0;
    TEST_ASSERT_FALSE(two_of(30, one_comes_late_to_the_other).coalesced);
}

/* One target 400 m along x at 10 m/s; fixes each 50 m, each 3 m off, until `last_m`. */
static struct followed fixed_until(int last_m)
{
    recorder.track_count = recorder.truth_count = recorder.samples = 0;
    for (int i = 0; i <= 40; i++) {
        be_at(i, 0, 10.0 * i, 0);
    }
    for (int x_m = 25; x_m <= last_m; x_m += 50) {
        (void)follow(x_m / 10.0, 0, x_m, 3);
    }
    return followed_of(&recorder, &scenario);
}

static void a_target_without_a_fix_at_the_end_is_lost(void)
{
    const struct followed all = fixed_until(400), nearly = fixed_until(275), lost = fixed_until(225);
    NEAR(50, all.longest_gap_m);
    NEAR(125, nearly.longest_gap_m);
    NEAR(175, lost.longest_gap_m);
    TEST_ASSERT_TRUE(!all.lost && !nearly.lost && lost.lost);
    for (size_t i = 0; i < recorder.track_count; i++) {
        tracks[i].y_m = 41;
    }
    NEAR(400, followed_of(&recorder, &scenario).longest_gap_m);
}

static void ways_are_straight_between_instants(void)
{
    struct point place;
    be_at(0, 0, 0, 0);
    be_at(0, 1, 0, 100);
    be_at(2, 0, 20, 0);
    be_at(4, 0, 20, 10);
    be_at(4, 1, 0, 300);
    TEST_ASSERT_TRUE(truths_at(&recorder, 0, 3, &place));
    NEAR(20, place.x_m);
    NEAR(5, place.y_m);
    TEST_ASSERT_TRUE(truths_at(&recorder, 1, 1, &place));
    NEAR(150, place.y_m);
    NEAR(25, truths_way_m(&recorder, 0, 0, 3));
    NEAR(15, truths_way_m(&recorder, 0, 1, 3));
    NEAR(0, truths_way_m(&recorder, 0, 3, 1));
    NEAR(30, truths_way_m(&recorder, 0, -5, 50));
    TEST_ASSERT_TRUE(truths_present(&recorder, 1, 4) && truths_present(&recorder, 0, 2.5));
    TEST_ASSERT_FALSE(truths_present(&recorder, 1, 4.1) || truths_present(&recorder, 2, 1) ||
                      truths_at(&recorder, 2, 1, &place));
}

/* ---- groups ---- */

/* Two targets 10 m apart from instant 10 to 29, else 50 m; they are one group of `extent_m` from `merged` to `split`. */
static struct grouping together(int merged, int split, double extent_m)
{
    for (int i = 0; i < 40; i++) {
        const double half_m = i >= 10 && i < 30 ? 5 : 25;
        be_at(2.0 * i, 0, 20.0 * i, -half_m);
        be_at(2.0 * i, 1, 20.0 * i, half_m);
        if (i >= merged && i < split) {
            (void)follow_group(2.0 * i, 0, 2, 20.0 * i, 0, extent_m);
        } else {
            (void)follow(2.0 * i, 0, 20.0 * i, -half_m);
            (void)follow(2.0 * i, 1, 20.0 * i, half_m);
        }
    }
    return grouping_of(&recorder, &scenario);
}

static void delays_count_from_the_true_instants(void)
{
    const struct grouping late = together(12, 33, 7);
    NEAR(4, late.merge_delay_s);
    NEAR(6, late.split_delay_s);
    NEAR((18 * 2 + 3 * (7 - 25.0)) / 21, late.extent_bias_m);
    NEAR(2 * 60 / 78.0, late.mode_changes_pmin);
    NEAR(0, late.spurious_splits_pmin);
    NEAR(1, late.count_right);
    NEAR(1, late.apart_at_end);
}

static void what_is_reported_too_early_has_a_negative_delay(void)
{
    const struct grouping early = together(8, 28, 5);
    NEAR(-4, early.merge_delay_s);
    NEAR(-4, early.split_delay_s);
    NEAR(60 / 40.0, early.spurious_splits_pmin);
}

static void what_is_never_reported_takes_until_the_end(void)
{
    const struct grouping never = together(40, 40, 5);
    NEAR(40, never.merge_delay_s);
    TEST_ASSERT_TRUE(isnan(never.split_delay_s) && isnan(never.extent_bias_m));
    recorder.track_count = recorder.truth_count = recorder.samples = 0;
    const struct grouping forever = together(10, 40, 5);
    NEAR(0, forever.merge_delay_s);
    NEAR(18, forever.split_delay_s);
    NEAR(0, forever.apart_at_end);
}

/* Three in a row, 15 m from each other: the outer ones are together by the middle one. */
static void targets_are_together_by_a_chain(void)
{
    for (int i = 0; i < 20; i++) {
        const double spacing_m = i < 5 ? 60 : 15;
        for (int k = 0; k < 3; k++) {
            be_at(2.0 * i, k, 20.0 * i, spacing_m * k);
        }
        for (int k = 0; k < (i < 7 ? 3 : 0); k++) {
            (void)follow(2.0 * i, k, 20.0 * i, spacing_m * k);
        }
        if (i >= 7) {
            (void)follow_group(2.0 * i, 0, i < 9 ? 2 : 3, 20.0 * i, 15, 12);
        }
        if (i == 7 || i == 8) {
            (void)follow(2.0 * i, 2, 20.0 * i, 30);
        }
    }
    const struct grouping grouping = grouping_of(&recorder, &scenario);
    NEAR((4 + 8 + 8) / 3.0, grouping.merge_delay_s);
    NEAR(2 * 60 / 38.0, grouping.mode_changes_pmin);
    NEAR((2 * (12 - 7.5) + 11 * (12 - sqrt(150))) / 13, grouping.extent_bias_m);
}

static void a_target_that_nobody_follows_is_missed_in_the_count(void)
{
    for (int i = 0; i < 10; i++) {
        be_at(2.0 * i, 0, 20.0 * i, 0);
        be_at(2.0 * i, 1, 20.0 * i, 50);
        (void)follow(2.0 * i, 0, 20.0 * i, 0);
        if (i < 6) {
            (void)follow(2.0 * i, 1, 20.0 * i, 50);
        }
    }
    NEAR(0.6, grouping_of(&recorder, &scenario).count_right);
    scenario.metrics.skip_first = 4;
    NEAR(2 / 6.0, grouping_of(&recorder, &scenario).count_right);
    scenario.network.ideal = false;
    TEST_ASSERT_TRUE(isnan(grouping_of(&recorder, &scenario).count_right));
}

/* Two targets by themselves over 780 m, the second until `last_m`. */
static double apart_until(double last_m)
{
    recorder.track_count = recorder.truth_count = recorder.samples = 0;
    for (int i = 0; i < 40; i++) {
        be_at(2.0 * i, 0, 20.0 * i, 0);
        be_at(2.0 * i, 1, 20.0 * i, 50);
        (void)follow(2.0 * i, 0, 20.0 * i, 0);
        if (20.0 * i <= last_m) {
            (void)follow(2.0 * i, 1, 20.0 * i, 50);
        }
    }
    return grouping_of(&recorder, &scenario).apart_at_end;
}

static void a_target_that_is_followed_no_more_is_not_followed_by_itself(void)
{
    NEAR(1, apart_until(780));
    NEAR(1, apart_until(640));
    NEAR(0, apart_until(620));
    NEAR(0, apart_until(-1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(tracks_on_their_targets_are_a_success);
    RUN_TEST(an_exchange_counts_in_the_end);
    RUN_TEST(two_tracks_on_one_target_are_one);
    RUN_TEST(a_target_without_a_fix_at_the_end_is_lost);
    RUN_TEST(ways_are_straight_between_instants);
    RUN_TEST(delays_count_from_the_true_instants);
    RUN_TEST(what_is_reported_too_early_has_a_negative_delay);
    RUN_TEST(what_is_never_reported_takes_until_the_end);
    RUN_TEST(targets_are_together_by_a_chain);
    RUN_TEST(a_target_that_nobody_follows_is_missed_in_the_count);
    RUN_TEST(a_target_that_is_followed_no_more_is_not_followed_by_itself);
    port_exit(UNITY_END() > 0);
    return 0;
}
