/* Localisation by sound against answers computed in double precision. */
#include "known_answers.h"
#include "motehound/sound_fix.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_MAX_CHARS 1024
#define TOLERANCE 1e-3 /* m */
#define TOUCHING 1e-2  /* of a circle that touches three, about centres nearly on a line */

void setUp(void) {}
void tearDown(void) {}

/* The rows of a file, each handed to `row` without its label, if it has one. */
static int for_rows(const char *name, bool labelled, void (*row)(const double *v, size_t count))
{
    FILE *file = open_answers(name);
    char line[LINE_MAX_CHARS];
    TEST_ASSERT_NOT_NULL(fgets(line, sizeof line, file));
    int rows = 0;
    while (fgets(line, sizeof line, file) != NULL) {
        double v[32];
        char *numbers = labelled ? strchr(line, ',') + 1 : line;
        row(v, read_numbers(numbers, v, sizeof v / sizeof v[0]));
        rows++;
    }
    fclose(file);
    return rows;
}

static void distance_row(const double *v, size_t count)
{
    TEST_ASSERT_EQUAL_size_t(7, count);
    for (uint8_t mode = MH_DISTANCE_OUTER; mode <= MH_DISTANCE_LINEAR; mode++) {
        const struct mh_distance_table table = {40, (uint8_t)v[0], mode};
        TEST_ASSERT_FLOAT_WITHIN(1e-5 * v[2 + mode], v[2 + mode], mh_distance(&table, (float)v[1]));
    }
    const struct mh_distance_table undivided = {40, 0, 0};
    TEST_ASSERT_FLOAT_WITHIN(1e-5 * v[6], v[6], mh_distance(&undivided, (float)v[1]));
}

static void distances(void) { TEST_ASSERT_EQUAL_INT(39, for_rows("han/dm_table.csv", false, distance_row)); }

static struct mh_circle circle(const double *v)
{
    const struct mh_circle c = {{(float)v[0], (float)v[1]}, (float)v[2]};
    return c;
}

static void assert_near(double tolerance, const double *expected, struct mh_vec2 point)
{
    TEST_ASSERT_FLOAT_WITHIN(tolerance, expected[0], point.x);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, expected[1], point.y);
}

static void two_circles_row(const double *v, size_t count)
{
    TEST_ASSERT_EQUAL_size_t(10, count);
    const struct mh_circle a = circle(v), b = circle(v + 3);
    assert_near(1e-4, v + 6, mh_two_circles(&a, &b));
    assert_near(1e-4, v + 8, mh_two_circles_chord(&a, &b));
}

static void two_circles(void) { TEST_ASSERT_EQUAL_INT(60, for_rows("han/two_circles.csv", false, two_circles_row)); }

static void three_circles_row(const double *v, size_t count)
{
    TEST_ASSERT_EQUAL_size_t(16, count);
    const struct mh_circle c[] = {circle(v), circle(v + 3), circle(v + 6)};
    assert_near(TOUCHING, v + 10, mh_three_circles(c, MH_CIRCLES_CASES));
    assert_near(TOLERANCE, v + 12, mh_three_circles(c, MH_CIRCLES_UNIFORM));
    assert_near(TOUCHING, v + 14, mh_three_circles(c, MH_CIRCLES_JOINT));
}

static void three_circles(void)
{
    TEST_ASSERT_EQUAL_INT(212, for_rows("han/three_circles.csv", true, three_circles_row));
}

static uint64_t random_state;

static uint64_t next_random(void) /* SplitMix64 */
{
    uint64_t z = random_state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}

static double uniform(void) { return (double)(next_random() >> 11) * 0x1p-53; }

enum { CELLS = 34, HEARD = 6 };

static void place_of(uint64_t seed, unsigned node, double place[2])
{
    random_state = seed * 0x9E3779B97F4A7C15u;
    for (unsigned draw = 0; draw < 2 * node; draw++) {
        next_random();
    }
    place[0] = (node % CELLS + uniform()) * 1000 / CELLS;
    place[1] = (node / CELLS + uniform()) * 1000 / CELLS;
}

static size_t spaced_numbers(char *field, double *values)
{
    size_t count = 0;
    for (char *end = field; count < HEARD; field = end) {
        values[count] = strtod(field, &end);
        if (end == field) {
            break;
        }
        count++;
    }
    return count;
}

/* One row of fixes.csv. The origin is the strongest node. */
static void check_fixes(char *line)
{
    char *fields[20];
    size_t count = 0;
    for (char *field = strtok(line, ",\r\n"); field != NULL; field = strtok(NULL, ",\r\n")) {
        fields[count++] = field;
    }
    TEST_ASSERT_EQUAL_size_t(17, count);
    double nodes[HEARD], energies[HEARD], origin[2];
    const size_t n = (size_t)atoi(fields[3]);
    TEST_ASSERT_EQUAL_size_t(n, spaced_numbers(fields[4], nodes));
    TEST_ASSERT_EQUAL_size_t(n, spaced_numbers(fields[5], energies));
    const uint64_t seed = strtoull(fields[0], NULL, 10);
    place_of(seed, (unsigned)nodes[0], origin);
    struct mh_heard heard[HEARD];
    for (size_t i = 0; i < n; i++) {
        double place[2];
        place_of(seed, (unsigned)nodes[i], place);
        heard[i].place.x = (float)(place[0] - origin[0]);
        heard[i].place.y = (float)(place[1] - origin[1]);
        heard[i].energy = (float)energies[i];
    }
    double expected[5][2]; /* three nodes, median, and its 1, 2, 3 refinements */
    for (int i = 0; i < 5; i++) {
        expected[i][0] = strtod(fields[6 + 2 * i], NULL) - origin[0];
        expected[i][1] = strtod(fields[7 + 2 * i], NULL) - origin[1];
    }
    const struct mh_sound sound = {1600, 0.19f, 0.05f};
    const struct mh_distance_table table = {40, 40, MH_DISTANCE_MIDDLE};
    struct mh_vec2 p, median;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_distance_fix(heard, n, &table, MH_CIRCLES_UNIFORM, &p));
    assert_near(TOLERANCE, expected[0], p);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_median_fix(heard, n, &table, &median));
    assert_near(TOLERANCE, expected[1], median);
    for (uint8_t iterations = 1; iterations <= 3; iterations++) {
        p = median;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_refine(&sound, heard, n, NULL, iterations, &p, NULL));
        assert_near(TOLERANCE, expected[1 + iterations], p);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_fix(&sound, heard, n, NULL, &p, NULL));
    assert_near(TOLERANCE, expected[3], p);
}

static void fixes(void)
{
    FILE *file = open_answers("han/fixes.csv");
    char line[LINE_MAX_CHARS];
    TEST_ASSERT_NOT_NULL(fgets(line, sizeof line, file));
    int rows = 0;
    for (; fgets(line, sizeof line, file) != NULL; rows++) {
        check_fixes(line);
    }
    fclose(file);
    TEST_ASSERT_EQUAL_INT(10, rows);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(distances);
    RUN_TEST(two_circles);
    RUN_TEST(three_circles);
    RUN_TEST(fixes);
    port_exit(UNITY_END() > 0);
    return 0;
}
