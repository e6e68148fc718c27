/* Shares of a sound and time windows against known answers, which were computed in double. */
#include "motehound/decomposition.h"
#include "motehound/time_window.h"
#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RANGE 40.0f
#define LOUDNESS (RANGE * RANGE)

void setUp(void) {}
void tearDown(void) {}

/* The next row's numbers, NAN where it says "none" -> how many, 0 at the end. The first row is a heading. */
static int next_row(FILE *file, mh_real *numbers, int most)
{
    char line[1024];
    if (fgets(line, sizeof line, file) == NULL) {
        return 0;
    }
    int count = 0;
    for (char *field = strtok(line, ",\n"); field && count < most; field = strtok(NULL, ",\n")) {
        numbers[count++] = strcmp(field, "none") == 0 ? NAN : strtof(field, NULL);
    }
    return count;
}

static FILE *open_answers(const char *name)
{
    char path[512];
    mh_real heading[32];
    snprintf(path, sizeof path, MOTEHOUND_KNOWN_ANSWERS "/han/%s", name);
    FILE *file = fopen(path, "r");
    TEST_ASSERT_NOT_NULL(file);
    TEST_ASSERT_GREATER_THAN(0, next_row(file, heading, 32));
    return file;
}

static struct mh_vec2 point(const mh_real *xy)
{
    const struct mh_vec2 p = {xy[0], xy[1]};
    return p;
}

static void shares_of_three_sources(void)
{
    FILE *file = open_answers("decompose.csv");
    mh_real row[18];
    int rows = 0;
    for (; next_row(file, row, 18) == 18; rows++) {
        const struct mh_vec2 node = point(row), sources[3] = {point(row + 3), point(row + 5), point(row + 7)};
        const mh_real energy = row[2];
        for (size_t k = 0; k < 3; k++) {
            const mh_real *answers = row + 9 + 3 * k;
            const mh_real tolerance = 3e-6f * energy;
            TEST_ASSERT_FLOAT_WITHIN(tolerance, answers[0], energy * mh_sound_share(sources, 3, k, node, RANGE));
            TEST_ASSERT_FLOAT_WITHIN(tolerance, answers[1], energy * mh_sound_share(sources, 3, k, node, 3 * RANGE));
            /* a small difference of large energies */
            TEST_ASSERT_FLOAT_WITHIN(10 * tolerance, answers[2],
                                     mh_sound_residual(LOUDNESS, sources, 3, k, node, energy));
        }
    }
    fclose(file);
    TEST_ASSERT_EQUAL_INT(20, rows);
}

static void windows_of_a_moving_target(void)
{
    FILE *file = open_answers("time_window.csv");
    mh_real row[9];
    int rows = 0, passed_by = 0;
    for (; next_row(file, row, 9) == 9; rows++) {
        const struct mh_vec2 node = {row[5] - row[0], row[6] - row[1]};
        struct mh_time_window window;
        const enum mh_status status = mh_time_window(node, point(row + 2), RANGE, &window);
        if (isnan(row[7])) {
            TEST_ASSERT_EQUAL_INT(MH_NONE, status);
            passed_by++;
            continue;
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, status);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f + 2e-5f * mh_abs(row[7]), row[7], row[4] + window.in);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f + 2e-5f * mh_abs(row[8]), row[8], row[4] + window.out);
    }
    fclose(file);
    TEST_ASSERT_EQUAL_INT(20, rows);
    TEST_ASSERT_GREATER_THAN(0, passed_by);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(shares_of_three_sources);
    RUN_TEST(windows_of_a_moving_target);
    return UNITY_END();
}
