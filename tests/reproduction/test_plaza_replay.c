/* The tracker `range` on a real recording whose ranges are 7 % too long: a lawn mower with a radio drives among four others, which it ranges
 * one after the other (Plaza1 of Carnegie Mellon University; Djugash and Singh, "A robust method of localization and mapping using only
 * range", 2008), with the settings of examples/plaza1.yaml. */
#include "motehound/range.h"
#include "port.h"
#include "replayed.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>

void setUp(void) {}
void tearDown(void) {}

enum { READINGS_MAX = 4000, ANCHORS_MAX = 8, INTERVAL = 200 };

struct reading {
    double time_s, range_m;
    int anchor;
};

static struct reading readings[READINGS_MAX];
static struct {
    double id, x_m, y_m;
} anchors[ANCHORS_MAX];
static struct replayed replayed;
static int reading_count, anchor_count;

static int by_time(const void *a, const void *b)
{
    const struct reading *left = a, *right = b;
    return (left->time_s > right->time_s) - (left->time_s < right->time_s);
}

static bool load(void)
{
    FILE *places = replayed_open("plaza/Plaza1_anchors.csv");
    FILE *ranges = replayed_open("plaza/Plaza1_ranges.csv");
    FILE *truth = replayed_open("plaza/Plaza1_truth.csv");
    if (places && ranges && truth) {
        double anchor;
        anchor_count = reading_count = replayed.truth_count = 0;
        while (anchor_count < ANCHORS_MAX && fscanf(places, "%lf,%lf,%lf", &anchors[anchor_count].id,
                                                    &anchors[anchor_count].x_m, &anchors[anchor_count].y_m) == 3) {
            anchor_count++;
        }
        while (reading_count < READINGS_MAX && fscanf(ranges, "%lf,%*f,%lf,%lf", &readings[reading_count].time_s,
                                                      &anchor, &readings[reading_count].range_m) == 3) {
            int at = 0;
            while (at < anchor_count && anchors[at].id != anchor) {
                at++;
            }
            readings[reading_count++].anchor = at;
        }
        qsort(readings, (size_t)reading_count, sizeof *readings, by_time); /* the file goes back twice, by a minute */
        double *row = replayed.truth[0];
        while (replayed.truth_count < TRUTH_MAX && fscanf(truth, "%lf,%lf,%lf", &row[0], &row[1], &row[2]) == 3) {
            replayed_skip_line(truth);
            row = replayed.truth[++replayed.truth_count];
        }
    }
    FILE *const files[] = {places, ranges, truth};
    bool all = true;
    for (int i = 0; i < 3; i++) {
        all = all && files[i];
        if (files[i]) {
            fclose(files[i]);
        }
    }
    return all;
}

/* Each range is false with probability `false_share`: up to 40 m too long. */
static struct replayed_figures drive(double bias_sd_m, double scale_sd, double false_share, unsigned seed)
{
    replayed.row = replayed.compared = replayed.silent = replayed.starts = 0;
    replayed.squares = 0;
    struct mh_range state;
    struct mh_range_config config;
    mh_range_config_default(&config);
    config.range_sd_m = 0.6f;
    config.bias_sd_m = (mh_real)bias_sd_m;
    config.scale_sd = (mh_real)scale_sd;
    config.acceleration_sd_mps2 = 0.5f;
    config.speed_mps = 1;
    config.height_m = 0;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.init(&state, &config, INTERVAL));
    const double start = readings[0].time_s;
    uint32_t random = seed;
    int next = 0;
    for (mh_tick now = INTERVAL; next < reading_count; now += INTERVAL) {
        struct mh_measurement m[16];
        size_t count = 0;
        for (; next < reading_count && readings[next].time_s <= start + 1e-3 * now; next++) {
            const int a = readings[next].anchor;
            TEST_ASSERT_TRUE(count < sizeof m / sizeof *m && a < anchor_count);
            double range_m = readings[next].range_m;
            random = random * 1664525u + 1013904223u;
            if (random * 0x1p-32 < false_share) {
                range_m += 40 * random * 0x1p-32 / false_share;
            }
            m[count++] = (struct mh_measurement){
                .node = (mh_node_id)anchors[a].id,
                .place = {(int32_t)lround(1000 * anchors[a].x_m), (int32_t)lround(1000 * anchors[a].y_m), 0},
                .time = (mh_tick)lround(1000 * (readings[next].time_s - start)),
                .value = mh_q20_from_real((mh_real)range_m)};
        }
        struct mh_estimate e;
        const bool known = mh_tracker_range.step(&state, now, m, count, &e) == MH_OK;
        replayed_compare(&replayed, start + 1e-3 * now, known ? &e : NULL);
    }
    const struct replayed_figures figures = replayed_figures(&replayed);
    TEST_MESSAGE(figures.text);
    return figures;
}

static void learns_scale_and_biases(void)
{
    if (!load()) {
        TEST_IGNORE_MESSAGE("the recording is not at " MOTEHOUND_SHARED_DATA "/plaza");
    }
    TEST_ASSERT_EQUAL_INT(4, anchor_count);
    TEST_ASSERT_EQUAL_INT(3529, reading_count);
    TEST_ASSERT_EQUAL_INT(9658, replayed.truth_count);
    const struct replayed_figures figures = drive(1, 0.1, 0, 1);
    TEST_ASSERT_TRUE_MESSAGE(figures.rmse_m < 1.5, figures.text);
    TEST_ASSERT_TRUE_MESSAGE(figures.nees_median > 0.5 && figures.nees_median < 2, figures.text);
    TEST_ASSERT_TRUE_MESSAGE(figures.nees_mean > 0.8 && figures.nees_mean < 3, figures.text);
    /* silent only for want of ranges: three pauses of 16, 17 and 97 s */
    TEST_ASSERT_TRUE_MESSAGE(replayed.silent < 600 && replayed.starts <= 4, figures.text);
    /* with a bias for each anchor alone, which a scale is not */
    TEST_ASSERT_TRUE(drive(3, 0, 0, 1).rmse_m < 3);
}

static void false_ranges_do_not_lock_it_out(void)
{
    if (!load()) {
        TEST_IGNORE_MESSAGE("the recording is not at " MOTEHOUND_SHARED_DATA "/plaza");
    }
    for (unsigned seed = 1; seed <= 5; seed++) {
        const struct replayed_figures figures = drive(1, 0.1, 0.1, seed);
        TEST_ASSERT_TRUE_MESSAGE(figures.median_m < 2, figures.text);
        TEST_ASSERT_TRUE_MESSAGE(figures.nees_median < 3, figures.text);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(learns_scale_and_biases);
    RUN_TEST(false_ranges_do_not_lock_it_out);
    port_exit(UNITY_END() > 0);
    return 0;
}
