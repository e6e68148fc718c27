/* The tracker `range` with its default settings on a real recording: a tag carried around four UWB anchors, outdoors, to 50 m from
 * them (Hanyang University, github.com/cucudasluv/UWB-dataset, LOS, trajectory A, case 1).
 *
 * Published with the recording, for positions in the plane: least squares 1.04 m, error-state Kalman filter with an inertial
 * unit 1.12 m. */
#include "motehound/range.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

void setUp(void) {}
void tearDown(void) {}

enum { READINGS_MAX = 10000, TRUTH_MAX = 3000, INTERVAL = 100 };

struct reading {
    double stamp_ns, x, y, z, range_m;
    int anchor;
};

static struct reading readings[READINGS_MAX];
static int reading_count;
static double truth[TRUTH_MAX][3]; /* ns, m, m */
static int truth_count;

static FILE *open_data(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/uwb_hanyang/LOS_A_case1/%s.csv", MOTEHOUND_SHARED_DATA, name);
    return fopen(path, "r");
}

static void skip_line(FILE *file)
{
    for (int c = fgetc(file); c != '\n' && c != EOF;) {
        c = fgetc(file);
    }
}

static int by_stamp(const void *a, const void *b)
{
    const struct reading *left = a, *right = b;
    return (left->stamp_ns > right->stamp_ns) - (left->stamp_ns < right->stamp_ns);
}

static bool load(void)
{
    static const char *const names[] = {"A3", "A5", "A9", "A12"};
    for (int i = 0; i < 4; i++) {
        FILE *file = open_data(names[i]);
        if (!file) {
            return false;
        }
        skip_line(file);
        struct reading *r = &readings[reading_count];
        while (reading_count < READINGS_MAX && fscanf(file, "%*[^,],%lf,%d,%lf,%lf,%lf,%lf", &r->stamp_ns, &r->anchor,
                                                      &r->x, &r->y, &r->z, &r->range_m) == 6) {
            skip_line(file);
            r = &readings[++reading_count];
        }
        fclose(file);
    }
    qsort(readings, (size_t)reading_count, sizeof *readings, by_stamp);
    FILE *file = open_data("trajectory");
    if (!file) {
        return false;
    }
    skip_line(file);
    while (truth_count < TRUTH_MAX &&
           fscanf(file, "%lf,%lf,%lf", &truth[truth_count][0], &truth[truth_count][1], &truth[truth_count][2]) == 3) {
        skip_line(file);
        truth_count++;
    }
    fclose(file);
    return true;
}

static double squares, nees[READINGS_MAX];
static int compared;

static int by_value(const void *a, const void *b)
{
    const double left = *(const double *)a, right = *(const double *)b;
    return (left > right) - (left < right);
}

static void compare(const struct mh_estimate *e, double now_ns)
{
    static int row;
    while (row + 2 < truth_count && truth[row + 1][0] < now_ns) {
        row++;
    }
    if (now_ns < truth[row][0] || now_ns > truth[row + 1][0]) {
        return;
    }
    const double share = (now_ns - truth[row][0]) / (truth[row + 1][0] - truth[row][0]);
    const double ex =
        (double)e->position.x + 0.001 * e->origin.x_mm - truth[row][1] - share * (truth[row + 1][1] - truth[row][1]);
    const double ey =
        (double)e->position.y + 0.001 * e->origin.y_mm - truth[row][2] - share * (truth[row + 1][2] - truth[row][2]);
    const double xx = (double)e->covariance.xx, xy = (double)e->covariance.xy, yy = (double)e->covariance.yy;
    squares += ex * ex + ey * ey;
    nees[compared++] = (yy * ex * ex - 2 * xy * ex * ey + xx * ey * ey) / (xx * yy - xy * xy);
}

static void better_than_published(void)
{
    if (!load()) {
        TEST_IGNORE_MESSAGE("the recording is not at " MOTEHOUND_SHARED_DATA "/uwb_hanyang");
    }
    TEST_ASSERT_EQUAL_INT(8405, reading_count);
    TEST_ASSERT_EQUAL_INT(1881, truth_count);
    struct mh_range state;
    struct mh_range_config config;
    mh_range_config_default(&config);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.init(&state, &config, INTERVAL));
    const double start = readings[0].stamp_ns;
    int next = 0, started = 0, silent = 0;
    for (mh_tick now = INTERVAL; next < reading_count; now += INTERVAL) {
        struct mh_measurement m[16];
        size_t count = 0;
        for (; next < reading_count && readings[next].stamp_ns <= start + 1e6 * now; next++) {
            const struct reading *r = &readings[next];
            TEST_ASSERT_TRUE(count < sizeof m / sizeof *m);
            m[count++] = (struct mh_measurement){
                .node = (mh_node_id)r->anchor,
                .place = {(int32_t)lround(1000 * r->x), (int32_t)lround(1000 * r->y), (int32_t)lround(1000 * r->z)},
                .time = (mh_tick)((r->stamp_ns - start) * 1e-6),
                .value = mh_q20_from_real((mh_real)r->range_m)};
        }
        struct mh_estimate e;
        if (mh_tracker_range.step(&state, now, m, count, &e) != MH_OK) {
            silent++;
            continue;
        }
        started += (e.flags & MH_ESTIMATE_STARTED) != 0;
        compare(&e, start + 1e6 * now);
    }
    qsort(nees, (size_t)compared, sizeof *nees, by_value);
    const double rmse = sqrt(squares / compared), median = nees[compared / 2];
    char message[160];
    snprintf(message, sizeof message,
             "rmse %.3f m over %d instants, %d without a position, %d starts, median NEES %.2f (1.39 is exact)", rmse,
             compared, silent, started, median);
    TEST_MESSAGE(message);
    TEST_ASSERT_TRUE_MESSAGE(rmse < 1.0, message);
    TEST_ASSERT_TRUE_MESSAGE(median > 0.5 && median < 3, message);
    TEST_ASSERT_TRUE_MESSAGE(silent == 0 && started == 1, message);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(better_than_published);
    port_exit(UNITY_END() > 0);
    return 0;
}
