#include "bounds/hindsight.h"
#include "engine/random.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdbool.h>

enum { SAMPLES = 9 };

static struct random_stream stream;
static uint64_t drawn;

void setUp(void)
{
    stream = random_stream(1, RANDOM_TRAFFIC);
    drawn = 0;
}

void tearDown(void) {}

static double uniform(void) { return random_uniform(stream, drawn++); }

static size_t reports_of(const struct point *path, size_t samples, double tolerance_m)
{
    size_t reports;
    TEST_ASSERT_EQUAL_INT(0, hindsight_reports(path, samples, tolerance_m, &reports));
    return reports;
}

/* ---- the least number of parts, by dynamic programming over all partitions ---- */

static size_t fewest_parts(size_t samples, bool (*is_part)(const void *context, size_t begin, size_t end),
                           const void *context)
{
    size_t fewest[SAMPLES + 1] = {0};
    for (size_t end = 1; end <= samples; end++) {
        fewest[end] = end; /* each sample by itself */
        for (size_t begin = 0; begin < end; begin++) {
            if (fewest[begin] + 1 < fewest[end] && is_part(context, begin, end)) {
                fewest[end] = fewest[begin] + 1;
            }
        }
    }
    return fewest[samples];
}

/* ---- one motion within a tolerance, without weights ---- */

struct path {
    const struct point *at;
    double tolerance_m;
};

/* A path on a line. The minimax error of a straight line in time is the greatest of those of any three samples, since it has two
 * parameters (de la Vallee Poussin); of three it is known. */
static bool fits_on_a_line(const void *context, size_t begin, size_t end)
{
    const struct path *path = context;
    const double unit = 1 / hypot(3, 4);
    for (size_t i = begin; i < end; i++) {
        for (size_t j = i + 1; j < end; j++) {
            for (size_t k = j + 1; k < end; k++) {
                const double a = (double)(k - j), b = (double)(k - i), c = (double)(j - i);
                const double xi = path->at[i].x_m * 3 * unit + path->at[i].y_m * 4 * unit;
                const double xj = path->at[j].x_m * 3 * unit + path->at[j].y_m * 4 * unit;
                const double xk = path->at[k].x_m * 3 * unit + path->at[k].y_m * 4 * unit;
                if (fabs(a * xi - b * xj + c * xk) / (a + b + c) > path->tolerance_m) {
                    return false;
                }
            }
        }
    }
    return true;
}

/* The smallest circle around `count` points is that of two or three of them. */
static double smallest_circle(const struct point *p, size_t count)
{
    double radius2 = 0;
    for (size_t i = 0; i < count; i++) {
        for (size_t j = 0; j < i; j++) {
            const double x = p[i].x_m - p[j].x_m, y = p[i].y_m - p[j].y_m, half2 = (x * x + y * y) / 4;
            radius2 = fmax(radius2, half2);
            for (size_t k = 0; k < j; k++) {
                const double u = p[k].x_m - p[j].x_m, v = p[k].y_m - p[j].y_m, cross = x * v - y * u;
                const double xx = x * x + y * y, uu = u * u + v * v, xu = x * u + y * v;
                const bool acute = xu > 0 && xx > xu && uu > xu;
                if (acute) {
                    radius2 = fmax(radius2, xx * uu * (xx + uu - 2 * xu) / (4 * cross * cross));
                }
            }
        }
    }
    return sqrt(radius2);
}

/* The circle that the samples leave when a velocity is taken off them. */
static double circle_at(const struct point *at, size_t count, double vx, double vy)
{
    struct point moved[SAMPLES];
    for (size_t n = 0; n < count; n++) {
        moved[n] = (struct point){at[n].x_m - vx * (double)n, at[n].y_m - vy * (double)n};
    }
    return smallest_circle(moved, count);
}

/* Its radius is convex in the velocity: two nested searches by thirds. */
static double least_circle_over_vy(const struct point *at, size_t count, double vx)
{
    double low = -2, high = 2;
    for (int i = 0; i < 45; i++) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        if (circle_at(at, count, vx, a) < circle_at(at, count, vx, b)) {
            high = b;
        } else {
            low = a;
        }
    }
    return circle_at(at, count, vx, low);
}

static bool fits_in_the_plane(const void *context, size_t begin, size_t end)
{
    const struct path *path = context;
    double low = -2, high = 2;
    for (int i = 0; i < 45; i++) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        if (least_circle_over_vy(&path->at[begin], end - begin, a) <
            least_circle_over_vy(&path->at[begin], end - begin, b)) {
            high = b;
        } else {
            low = a;
        }
    }
    return least_circle_over_vy(&path->at[begin], end - begin, low) <= path->tolerance_m;
}

static void reports_of_a_path_on_a_line(void)
{
    size_t parts = 0;
    for (int repeat = 0; repeat < 300; repeat++) {
        struct point at[SAMPLES];
        double way = 0;
        for (size_t n = 0; n < SAMPLES; n++) {
            at[n] = (struct point){3 * way, 4 * way};
            way += uniform();
        }
        const struct path path = {at, 0.2 + 0.6 * uniform()};
        const size_t fewest = fewest_parts(SAMPLES, fits_on_a_line, &path);
        TEST_ASSERT_EQUAL_size_t(fewest, reports_of(at, SAMPLES, path.tolerance_m));
        parts += fewest;
    }
    TEST_ASSERT_TRUE(parts > 450 && parts < 1500); /* neither one nor a pair of samples each */
}

static void reports_of_a_path_in_the_plane(void)
{
    size_t parts = 0;
    for (int repeat = 0; repeat < 6; repeat++) {
        struct point at[SAMPLES];
        struct point here = {0, 0};
        for (size_t n = 0; n < SAMPLES; n++) {
            at[n] = here;
            here.x_m += uniform();
            here.y_m += uniform() - 0.5;
        }
        const struct path path = {at, 0.1 + 0.2 * uniform()};
        const size_t fewest = fewest_parts(SAMPLES, fits_in_the_plane, &path);
        TEST_ASSERT_EQUAL_size_t(fewest, reports_of(at, SAMPLES, path.tolerance_m));
        parts += fewest;
    }
    TEST_ASSERT_TRUE(parts > 9 && parts < 27);
}

static void reports_at_the_limits(void)
{
    struct point straight[1000];
    for (size_t n = 0; n < 1000; n++) {
        straight[n] = (struct point){100 + 0.25 * (double)n, 7 - 3 * (double)n};
    }
    TEST_ASSERT_EQUAL_size_t(0, reports_of(straight, 0, 1));
    TEST_ASSERT_EQUAL_size_t(1, reports_of(straight, 1, 1));
    TEST_ASSERT_EQUAL_size_t(1, reports_of(straight, 1000, 1e-6));
    for (size_t n = 500; n < 1000; n++) { /* turned back on itself: one motion before it, one after */
        straight[n] = straight[999 - n];
    }
    TEST_ASSERT_EQUAL_size_t(2, reports_of(straight, 1000, 1e-6));
    TEST_ASSERT_EQUAL_size_t(1, reports_of(straight, 1000, 2000));
    const struct point still[3] = {{5, 5}, {5, 5}, {5, 5}};
    TEST_ASSERT_EQUAL_size_t(1, reports_of(still, 3, 0));
    const struct point corner[3] = {{0, 0}, {1, 0}, {1, 1}}; /* off by a quarter of the second difference */
    TEST_ASSERT_EQUAL_size_t(1, reports_of(corner, 3, sqrt(2) / 4 + 1e-9));
    TEST_ASSERT_EQUAL_size_t(2, reports_of(corner, 3, sqrt(2) / 4 - 1e-9));
}

/* ---- heads ---- */

struct field {
    const struct recorded_node *nodes;
    size_t count;
    const struct point *path;
    double range_m;
};

static bool one_node_senses(const void *context, size_t begin, size_t end)
{
    const struct field *field = context;
    for (size_t i = 0; i < field->count; i++) {
        size_t n = begin;
        while (n < end && hypot(field->nodes[i].x_m - field->path[n].x_m, field->nodes[i].y_m - field->path[n].y_m) <=
                              field->range_m) {
            n++;
        }
        if (n == end) {
            return true;
        }
    }
    return false;
}

static void heads_by_brute_force(void)
{
    enum { NODES = 40 };
    size_t changes = 0;
    for (int repeat = 0; repeat < 300; repeat++) {
        struct recorded_node nodes[NODES];
        struct point path[SAMPLES];
        for (uint32_t i = 0; i < NODES; i++) {
            nodes[i] = (struct recorded_node){i, 3 * uniform(), 3 * uniform(), 0};
        }
        bool always_sensed = true;
        struct field field = {nodes, NODES, path, 0.6 + 0.3 * uniform()};
        for (size_t n = 0; n < SAMPLES; n++) {
            path[n] = (struct point){0.5 + 0.25 * (double)n, 1 + uniform()};
            always_sensed = always_sensed && one_node_senses(&field, n, n + 1);
        }
        if (always_sensed) {
            size_t hand_overs;
            TEST_ASSERT_EQUAL_INT(0, hindsight_hand_overs(nodes, NODES, path, SAMPLES, field.range_m, &hand_overs));
            TEST_ASSERT_EQUAL_size_t(fewest_parts(SAMPLES, one_node_senses, &field) - 1, hand_overs);
            changes += hand_overs;
        }
    }
    TEST_ASSERT_TRUE(changes > 300);
}

/* Where no node senses the target there is no head, and the next one is a change. */
static void heads_on_a_row_with_a_hole(void)
{
    const struct recorded_node nodes[] = {{0, 10, 0, 0}, {1, 20, 0, 0}, {2, 50, 0, 0}};
    struct point path[61];
    for (size_t n = 0; n < 61; n++) {
        path[n] = (struct point){(double)n, 0};
    }
    size_t hand_overs;
    TEST_ASSERT_EQUAL_INT(0, hindsight_hand_overs(nodes, 3, path, 61, 10, &hand_overs));
    TEST_ASSERT_EQUAL_size_t(2, hand_overs);
    TEST_ASSERT_EQUAL_INT(0, hindsight_hand_overs(nodes, 1, path, 61, 10, &hand_overs));
    TEST_ASSERT_EQUAL_size_t(0, hand_overs);
    TEST_ASSERT_EQUAL_INT(0, hindsight_hand_overs(nodes, 0, path, 61, 10, &hand_overs));
    TEST_ASSERT_EQUAL_size_t(0, hand_overs);
    TEST_ASSERT_EQUAL_INT(0, hindsight_hand_overs(nodes, 3, path, 0, 10, &hand_overs));
    TEST_ASSERT_EQUAL_size_t(0, hand_overs);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(reports_of_a_path_on_a_line);
    RUN_TEST(reports_of_a_path_in_the_plane);
    RUN_TEST(reports_at_the_limits);
    RUN_TEST(heads_by_brute_force);
    RUN_TEST(heads_on_a_row_with_a_hole);
    port_exit(UNITY_END() > 0);
    return 0;
}
