/* Luo's method against answers computed in double precision: 40 single solutions of Eq. (10) and three whole runs of Algorithm 1. */
#include "known_answers.h"
#include "motehound/luo.h"
#include "motehound/puff_fit.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_MAX_CHARS 4096

void setUp(void) {}
void tearDown(void) {}

static mh_concentration concentration(double g)
{
#if MH_REAL_FIXED
    return (mh_q20)lround(g * 1048576);
#else
    return (float)g;
#endif
}

/* In fixed point the cases whose concentrations a sensor node can send: of at least 0.01 g/m2, which its 20 fractional bits round by 5e-5. */
static void solutions_of_equation_10(void)
{
    FILE *file = open_answers("luo/ls10.csv");
    char line[LINE_MAX_CHARS];
    TEST_ASSERT_NOT_NULL(fgets(line, sizeof line, file));
    int cases = 0;
    int bounded = 0;
    while (fgets(line, sizeof line, file) != NULL) {
        double v[10 + 3 * 100];
        const size_t count = read_numbers(line, v, sizeof v / sizeof v[0]);
        const size_t q = (size_t)v[5];
        TEST_ASSERT_EQUAL_size_t(10 + 3 * q, count);
        struct mh_puff_sample samples[100];
        size_t largest = 0;
        double least = HUGE_VAL;
        for (size_t k = 0; k < q; k++) {
            const double *node = &v[10 + 3 * k];
            samples[k].position.x = mh_real_from_float((float)node[0]);
            samples[k].position.y = mh_real_from_float((float)node[1]);
            samples[k].concentration = concentration(node[2]);
            largest = samples[k].concentration > samples[largest].concentration ? k : largest;
            least = fmin(least, node[2]);
        }
        if (MH_REAL_FIXED && least < 0.01) {
            continue;
        }
        struct mh_puff_linear fit;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_begin(&fit, MH_REAL(1.0f), &samples[largest]));
        for (size_t k = 0; k < q; k++) {
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_add(&fit, &samples[k]));
        }
        struct mh_puff_answer answer;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_solve(&fit, mh_real_from_float((float)v[4]), &answer));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)v[6], mh_real_to_float(answer.puff.position.x));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)v[7], mh_real_to_float(answer.puff.position.y));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)v[8], mh_real_to_float(answer.puff.age));
        TEST_ASSERT_EQUAL_INT((int)v[9], answer.bound);
        cases++;
        bounded += answer.bound != MH_BOUND_NONE;
    }
    fclose(file);
    TEST_ASSERT_EQUAL_INT(MH_REAL_FIXED ? 33 : 40, cases);
    TEST_ASSERT_EQUAL_INT(MH_REAL_FIXED ? 11 : 14, bounded);
}

enum { N, T, Q, FLAG, PRE_X, PRE_Y, TAU, FILTERED, FIL_X, FIL_Y, COLUMNS = 16 };

/* How far the tracker is from the answers over one run. */
struct deviation {
    double pre, filtered, tau; /* largest, over the rows before an active bound differs */
    int rows, bound_differs;
};

/* Feed one run sample by sample, as the sensor nodes would: readings in Q11.20, differences of consecutive readings, the reading
 * before the first one 0, places in whole millimetres. */
static struct deviation run(const char *name, mh_tick interval)
{
    char file_name[32];
    size_t count;
    snprintf(file_name, sizeof file_name, "luo/%s_X.f32", name);
    float *places = read_floats(file_name, &count);
    const size_t nodes = count / 2;
    snprintf(file_name, sizeof file_name, "luo/%s_C.f32", name);
    float *readings = read_floats(file_name, &count);
    const size_t samples = count / nodes;
    struct mh_measurement *measurements = calloc(nodes, sizeof *measurements);
    mh_q20 *previous = calloc(nodes, sizeof *previous);
    TEST_ASSERT_TRUE(measurements != NULL && previous != NULL);
    for (size_t i = 0; i < nodes; i++) {
        measurements[i].node = (mh_node_id)i;
        measurements[i].place.x_mm = (int32_t)lround(1000.0 * (double)places[2 * i]);
        measurements[i].place.y_mm = (int32_t)lround(1000.0 * (double)places[2 * i + 1]);
        measurements[i].flags = MH_MEASUREMENT_HAS_INCREMENT;
    }
    snprintf(file_name, sizeof file_name, "luo/%s_track.csv", name);
    FILE *answers = open_answers(file_name);
    char line[LINE_MAX_CHARS];
    TEST_ASSERT_NOT_NULL(fgets(line, sizeof line, answers));

    struct mh_luo luo;
    struct mh_luo_config config;
    mh_luo_config_default(&config);
    config.stop_outside = true;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_luo.init(&luo, &config, interval));
    struct deviation deviation = {0};
    for (size_t p = 0; p < samples; p++) {
        const mh_tick time = (mh_tick)p * interval;
        for (size_t i = 0; i < nodes; i++) {
            const mh_q20 value = (mh_q20)lroundf(readings[p * nodes + i] * 1048576);
            measurements[i].time = time;
            measurements[i].value = value;
            measurements[i].increment = value - previous[i];
            previous[i] = value;
        }
        struct mh_estimate estimate;
        if (mh_tracker_luo.step(&luo, time, measurements, nodes, &estimate) != MH_OK) {
            continue;
        }
        char message[64];
        snprintf(message, sizeof message, "%s, position %d", name, deviation.rows + 1);
        TEST_ASSERT_NOT_NULL_MESSAGE(fgets(line, sizeof line, answers), message);
        double row[COLUMNS];
        TEST_ASSERT_EQUAL_size_t(COLUMNS, read_numbers(line, row, COLUMNS));
        deviation.rows++;
        TEST_ASSERT_EQUAL_INT_MESSAGE((int)row[N], deviation.rows, message);
        TEST_ASSERT_EQUAL_INT_MESSAGE(lround(1000.0 * row[T]), time, message);
        TEST_ASSERT_EQUAL_INT_MESSAGE((int)row[Q], estimate.measurements, message);
        TEST_ASSERT_EQUAL_INT_MESSAGE((int)row[FILTERED], (estimate.flags & MH_ESTIMATE_FILTERED) != 0, message);
        TEST_ASSERT_EQUAL_INT_MESSAGE(deviation.rows == 1, (estimate.flags & MH_ESTIMATE_STARTED) != 0, message);
        const int bound = (estimate.flags & MH_ESTIMATE_AGE_HIGH) != 0  ? 1
                          : (estimate.flags & MH_ESTIMATE_AGE_LOW) != 0 ? -1
                                                                        : 0;
        deviation.bound_differs += bound != (int)row[FLAG];

        const double raw_x = estimate.origin.x_mm * 0.001 + (double)mh_real_to_float(estimate.raw.x);
        const double raw_y = estimate.origin.y_mm * 0.001 + (double)mh_real_to_float(estimate.raw.y);
        const double x = estimate.origin.x_mm * 0.001 + (double)mh_real_to_float(estimate.position.x);
        const double y = estimate.origin.y_mm * 0.001 + (double)mh_real_to_float(estimate.position.y);
        if (deviation.bound_differs == 0) {
            deviation.pre = fmax(deviation.pre, hypot(raw_x - row[PRE_X], raw_y - row[PRE_Y]));
            deviation.filtered = fmax(deviation.filtered, hypot(x - row[FIL_X], y - row[FIL_Y]));
            deviation.tau = fmax(deviation.tau, fabs(time * 0.001 - (double)mh_real_to_float(estimate.age) - row[TAU]));
        }
    }
    TEST_ASSERT_NULL_MESSAGE(fgets(line, sizeof line, answers), "positions are missing at the end");
    fclose(answers);
    free(places);
    free(readings);
    free(measurements);
    free(previous);
    printf("%s: %d positions, %d bounds differ, largest deviation pre %.5f m, tau %.5f s, filtered %.5f m\n", name,
           deviation.rows, deviation.bound_differs, deviation.pre, deviation.tau, deviation.filtered);
    return deviation;
}

static void expect_the_answers(const char *name, mh_tick interval)
{
    const struct deviation deviation = run(name, interval);
    TEST_ASSERT_EQUAL_INT(0, deviation.bound_differs);
    TEST_ASSERT_TRUE(deviation.pre <= 0.02);
    TEST_ASSERT_TRUE(deviation.filtered <= 0.02);
}

static void run_of_experiment_1(void) { expect_the_answers("g1", 1000); }
static void run_of_experiment_2_with_noise(void) { expect_the_answers("g2", 1000); }
static void run_of_experiment_1_at_2_s(void) { expect_the_answers("g3", 2000); }

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(solutions_of_equation_10);
    RUN_TEST(run_of_experiment_1);
    RUN_TEST(run_of_experiment_2_with_noise);
    RUN_TEST(run_of_experiment_1_at_2_s);
    port_exit(UNITY_END() > 0);
    return 0;
}
