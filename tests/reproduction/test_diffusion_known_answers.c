/* The sliding-window fit against the same method computed in double precision: three whole runs. */
#include "motehound/diffusion.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FOLDER MOTEHOUND_KNOWN_ANSWERS "/luo/"
#define COLUMNS 16
#define OUTPUTS_MAX 200
#define IGNORED_OUTPUTS 3 /* how a track settles is its start's affair */

void setUp(void) {}
void tearDown(void) {}

static FILE *open_answers(const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, FOLDER "%s", name);
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        TEST_IGNORE_MESSAGE("tests/known_answers/luo is incomplete");
    }
    return file;
}

/* All floats of a file. The files are little-endian, as is every host that the simulator is built for. */
static float *floats(const char *name, size_t *count)
{
    FILE *file = open_answers(name);
    fseek(file, 0, SEEK_END);
    *count = (size_t)ftell(file) / sizeof(float);
    rewind(file);
    float *values = malloc(*count * sizeof *values);
    TEST_ASSERT_NOT_NULL(values);
    TEST_ASSERT_EQUAL_size_t(*count, fread(values, sizeof *values, *count, file));
    fclose(file);
    return values;
}

struct answer {
    double time, true_x, true_y, x, y;
};

static size_t read_track(const char *name, struct answer *answers)
{
    FILE *file = open_answers(name);
    char line[1024];
    size_t count = 0;
    TEST_ASSERT_NOT_NULL(fgets(line, sizeof line, file));
    while (fgets(line, sizeof line, file) != NULL && count < OUTPUTS_MAX) {
        double v[COLUMNS];
        int n = 0;
        for (char *field = strtok(line, ",\r\n"); field != NULL && n < COLUMNS; field = strtok(NULL, ",\r\n")) {
            v[n++] = strtod(field, NULL);
        }
        TEST_ASSERT_EQUAL_INT(COLUMNS, n);
        const struct answer answer = {v[1], v[12], v[13], v[14], v[15]};
        answers[count++] = answer;
    }
    fclose(file);
    return count;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Only the nodes that the tracker asks for, and those whose increment is significant, report; before there is a track, all. */
static size_t collect(const struct mh_diffusion *state, const float *places, const float *now, const float *before,
                      size_t nodes, struct mh_measurement *reports)
{
    struct mh_interest interest = {{0, 0, 0}, 0};
    const bool tracking = mh_tracker_diffusion.interest(state, &interest) == MH_OK;
    size_t count = 0;
    for (size_t i = 0; i < nodes; i++) {
        struct mh_measurement m = {.node = (mh_node_id)i, .flags = MH_MEASUREMENT_HAS_INCREMENT};
        m.place.x_mm = (int32_t)lroundf(places[2 * i] * 1000.0f);
        m.place.y_mm = (int32_t)lroundf(places[2 * i + 1] * 1000.0f);
        m.value = mh_q20_from_real(now[i]);
        m.increment = m.value - (before != NULL ? mh_q20_from_real(before[i]) : 0);
        if (!tracking || m.increment >= MH_Q20(0.2f) ||
            mh_place_within(&m.place, &interest.centre, interest.radius_mm)) {
            reports[count++] = m;
        }
    }
    return count;
}

static void run(const char *name, mh_tick interval, double expected_rmse)
{
    char file[64];
    size_t nodes, samples;
    snprintf(file, sizeof file, "%s_X.f32", name);
    float *places = floats(file, &nodes);
    nodes /= 2;
    snprintf(file, sizeof file, "%s_C.f32", name);
    float *readings = floats(file, &samples);
    samples /= nodes;
    static struct answer answers[OUTPUTS_MAX];
    snprintf(file, sizeof file, "%s_track.csv", name);
    const size_t outputs = read_track(file, answers);

    struct mh_diffusion_config config;
    mh_diffusion_config_default(&config);
    const struct mh_region field = {-2000, 82000, -2000, 82000};
    config.region = field;
    static struct mh_diffusion state;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_diffusion.init(&state, &config, interval));

    struct mh_measurement *reports = malloc(nodes * sizeof *reports);
    static double differences[OUTPUTS_MAX];
    double squares = 0;
    size_t compared = 0, next = 0;
    for (size_t k = 0; k < samples; k++) {
        const mh_tick time = (mh_tick)k * interval;
        const float *now = readings + k * nodes;
        const size_t count = collect(&state, places, now, k > 0 ? now - nodes : NULL, nodes, reports);
        struct mh_estimate e;
        const enum mh_status status = mh_tracker_diffusion.step(&state, time, reports, count, &e);
        if (next < outputs && fabs(answers[next].time - time * 0.001) < 1e-6) {
            if (status == MH_OK && next >= IGNORED_OUTPUTS) {
                const double x = (double)e.position.x + e.origin.x_mm * 0.001;
                const double y = (double)e.position.y + e.origin.y_mm * 0.001;
                differences[compared++] = hypot(x - answers[next].x, y - answers[next].y);
                squares += (x - answers[next].true_x) * (x - answers[next].true_x) +
                           (y - answers[next].true_y) * (y - answers[next].true_y);
            }
            next++;
        }
    }
    TEST_ASSERT_EQUAL_size_t(outputs, next);
    TEST_ASSERT_EQUAL_size_t(outputs - IGNORED_OUTPUTS, compared);
    qsort(differences, compared, sizeof differences[0], ascending);
    const double rmse = sqrt(squares / (double)compared);
    char figures[120];
    snprintf(figures, sizeof figures, "%s: median difference %.4f m, RMSE %.4f m", name, differences[compared / 2],
             rmse);
    TEST_MESSAGE(figures);
    TEST_ASSERT_TRUE_MESSAGE(differences[compared / 2] <= 0.003, figures);
    TEST_ASSERT_TRUE_MESSAGE(rmse <= 1.2 * expected_rmse, figures);
    free(places);
    free(readings);
    free(reports);
}

static void straight_and_curved_path(void) { run("g1", 1000, 0.0236); }
static void noise_and_sharp_turns(void) { run("g2", 1000, 0.127); }
static void long_interval(void) { run("g3", 2000, 0.0280); }

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(straight_and_curved_path);
    RUN_TEST(noise_and_sharp_turns);
    RUN_TEST(long_interval);
    port_exit(UNITY_END() > 0);
    return 0;
}
