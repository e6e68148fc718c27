/* The sliding-window fit against the same method computed in double precision: three whole runs; and what loss does to one of them. */
#include "known_answers.h"
#include "motehound/diffusion.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COLUMNS 16
#define OUTPUTS_MAX 200
#define IGNORED_OUTPUTS 3 /* how a track settles is its start's affair */

void setUp(void) {}
void tearDown(void) {}

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
        TEST_ASSERT_EQUAL_size_t(COLUMNS, read_numbers(line, v, COLUMNS));
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

/* One run: its files, and what happens to the reports on their way. */
struct run {
    const char *name;
    mh_tick interval;
    unsigned lost_percent;         /* of the reports, at random */
    size_t outage_from, outage_to; /* samples of which no report arrives */
    float *places, *readings;
    size_t nodes, samples, outputs;
    struct answer answers[OUTPUTS_MAX];
    double errors[OUTPUTS_MAX];      /* against the truth */
    double differences[OUTPUTS_MAX]; /* against the same method in double */
    size_t compared;
    size_t found; /* samples after the outage until the error is below 1 m */
};

/* A small generator is enough to choose which reports are lost. */
static unsigned next_percent(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (unsigned)(((uint64_t)*state * 100u) >> 32);
}

/* Only the nodes that the tracker asks for, and those whose increment is significant, report; before there is a track, all. */
static size_t collect(const struct mh_diffusion *state, const struct run *run, size_t sample, uint32_t *random,
                      struct mh_measurement *reports)
{
    const float *now = run->readings + sample * run->nodes, *before = sample > 0 ? now - run->nodes : NULL;
    struct mh_interest interest = {{0, 0, 0}, 0};
    const bool tracking = mh_tracker_diffusion.interest(state, &interest) == MH_OK;
    size_t count = 0;
    for (size_t i = 0; i < run->nodes; i++) {
        struct mh_measurement m = {.node = (mh_node_id)i, .flags = MH_MEASUREMENT_HAS_INCREMENT};
        m.place.x_mm = (int32_t)lroundf(run->places[2 * i] * 1000.0f);
        m.place.y_mm = (int32_t)lroundf(run->places[2 * i + 1] * 1000.0f);
        m.value = mh_q20_from_real(now[i]);
        m.increment = m.value - (before != NULL ? mh_q20_from_real(before[i]) : 0);
        const bool sent =
            !tracking || m.increment >= MH_Q20(0.2f) || mh_place_within(&m.place, &interest.centre, interest.radius_mm);
        if (sent && next_percent(random) >= run->lost_percent) {
            reports[count++] = m;
        }
    }
    return sample >= run->outage_from && sample < run->outage_to ? 0 : count;
}

static void load(struct run *run)
{
    char file[64];
    snprintf(file, sizeof file, "luo/%s_X.f32", run->name);
    run->places = read_floats(file, &run->nodes);
    run->nodes /= 2;
    snprintf(file, sizeof file, "luo/%s_C.f32", run->name);
    run->readings = read_floats(file, &run->samples);
    run->samples /= run->nodes;
    snprintf(file, sizeof file, "luo/%s_track.csv", run->name);
    run->outputs = read_track(file, run->answers);
}

/* The field's border is 2 m outside the nodes, as in the known answers. */
static void track(struct run *run)
{
    load(run);
    struct mh_diffusion_config config;
    mh_diffusion_config_default(&config);
    const struct mh_region field = {-2000, 82000, -2000, 82000};
    config.region = field;
    static struct mh_diffusion state;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_diffusion.init(&state, &config, run->interval));

    struct mh_measurement *reports = malloc(run->nodes * sizeof *reports);
    uint32_t random = 1;
    size_t next = 0;
    for (size_t k = 0; k < run->samples; k++) {
        const size_t count = collect(&state, run, k, &random, reports);
        const mh_tick time = (mh_tick)k * run->interval;
        struct mh_estimate e;
        const enum mh_status status = mh_tracker_diffusion.step(&state, time, reports, count, &e);
        if (next < run->outputs && fabs(run->answers[next].time - time * 0.001) < 1e-6) {
            const struct answer *answer = &run->answers[next++];
            const double x = (double)e.position.x + e.origin.x_mm * 0.001;
            const double y = (double)e.position.y + e.origin.y_mm * 0.001;
            const double error = hypot(x - answer->true_x, y - answer->true_y);
            if (status == MH_OK && next > IGNORED_OUTPUTS && (k < run->outage_from || k >= run->outage_to)) {
                run->differences[run->compared] = hypot(x - answer->x, y - answer->y);
                run->errors[run->compared++] = error;
            }
            if (run->found == 0 && k >= run->outage_to && status == MH_OK && error < 1.0) {
                run->found = k + 1 - run->outage_to;
            }
        }
    }
    TEST_ASSERT_EQUAL_size_t(run->outputs, next);
    free(run->places);
    free(run->readings);
    free(reports);
}

static double median(double *values, size_t count)
{
    qsort(values, count, sizeof *values, ascending);
    return values[count / 2];
}

static void same_statistics(const char *name, mh_tick interval, double expected_rmse)
{
    static struct run run;
    const struct run fresh = {.name = name, .interval = interval};
    run = fresh;
    track(&run);
    TEST_ASSERT_EQUAL_size_t(run.outputs - IGNORED_OUTPUTS, run.compared);
    double squares = 0;
    for (size_t i = 0; i < run.compared; i++) {
        squares += run.errors[i] * run.errors[i];
    }
    const double rmse = sqrt(squares / (double)run.compared);
    const double difference = median(run.differences, run.compared);
    char figures[120];
    snprintf(figures, sizeof figures, "%s: median difference %.4f m, RMSE %.4f m", name, difference, rmse);
    TEST_MESSAGE(figures);
    TEST_ASSERT_TRUE_MESSAGE(difference <= 0.003, figures);
    TEST_ASSERT_TRUE_MESSAGE(rmse <= 1.2 * expected_rmse, figures);
}

static void straight_and_curved_path(void) { same_statistics("g1", 1000, 0.0236); }
static void noise_and_sharp_turns(void) { same_statistics("g2", 1000, 0.127); }
static void long_interval(void) { same_statistics("g3", 2000, 0.0280); }

/* Noisy run with sharp turns: median error without loss 0.043 m. */
static void reports_are_lost(void)
{
    static struct run run;
    static const struct {
        unsigned percent;
        double largest_median;
    } cases[] = {{10, 0.086}, {30, 0.15}};
    for (int i = 0; i < 2; i++) {
        const struct run fresh = {.name = "g2", .interval = 1000, .lost_percent = cases[i].percent};
        run = fresh;
        track(&run);
        TEST_ASSERT_TRUE(run.compared + 4 >= run.outputs - IGNORED_OUTPUTS);
        const double error = median(run.errors, run.compared);
        char figures[120];
        snprintf(figures, sizeof figures, "%u %% lost: median error %.3f m, largest %.2f m", cases[i].percent, error,
                 run.errors[run.compared - 1]);
        TEST_MESSAGE(figures);
        TEST_ASSERT_TRUE_MESSAGE(error <= cases[i].largest_median, figures);
        TEST_ASSERT_TRUE_MESSAGE(run.errors[run.compared - 1] < 5.0, figures);
    }
}

static void twenty_samples_are_lost(void)
{
    static struct run run;
    for (size_t from = 10; from <= 90; from += 10) {
        const struct run fresh = {.name = "g2", .interval = 1000, .outage_from = from, .outage_to = from + 20};
        run = fresh;
        track(&run);
        char figures[120];
        snprintf(figures, sizeof figures, "lost from %u: found after %u samples", (unsigned)from, (unsigned)run.found);
        TEST_MESSAGE(figures);
        TEST_ASSERT_TRUE_MESSAGE(run.found >= 1 && run.found <= 10, figures);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(straight_and_curved_path);
    RUN_TEST(noise_and_sharp_turns);
    RUN_TEST(long_interval);
    RUN_TEST(reports_are_lost);
    RUN_TEST(twenty_samples_are_lost);
    port_exit(UNITY_END() > 0);
    return 0;
}
