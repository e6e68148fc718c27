#include "experiment.h"

#include "cli/batch.h"
#include "scenario/folder.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ERROR_SIZE = 1000 };

void experiment_scenario(const char *name, const char *settings, struct scenario *scenario)
{
    char error[ERROR_SIZE] = "no memory", path[SCENARIO_PATH_MAX], words[400];
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_find(name, path, error, sizeof error), error);
    TEST_ASSERT_EQUAL_INT(0, scenario_init(scenario));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_load(path, scenario, error, sizeof error), error);
    TEST_ASSERT_TRUE((size_t)snprintf(words, sizeof words, "%s", settings) < sizeof words);
    char *rest = words;
    for (char *word; (word = strtok_r(rest, " ", &rest)) != NULL;) {
        char *value = strchr(word, '=');
        TEST_ASSERT_NOT_NULL_MESSAGE(value, word);
        *value++ = '\0';
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(scenario, word, value, error, sizeof error), error);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_check(scenario, name, error, sizeof error), error);
}

struct figures experiment_from(uint64_t seed, const char *name, const char *settings, unsigned runs)
{
    char error[ERROR_SIZE] = "";
    struct scenario scenario;
    struct results results;
    struct figures figures;
    experiment_scenario(name, settings, &scenario);
    const struct batch batch = {.scenario = &scenario, .seed = seed, .runs = runs, .jobs = 2, .version = ""};
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0, results_open(&results, "experiment", name, &scenario, batch.seed, false, error, sizeof error), error);
    const int status = batch_execute(&batch, &results, error, sizeof error);
    results_pooled(&results, figures.pooled);
    for (size_t i = 0; i < METRIC_COUNT; i++) {
        struct metric_statistics statistics;
        (void)results_statistics(&results, (enum metric)i, &statistics);
        figures.mean[i] = statistics.mean;
        figures.sd[i] = statistics.sd;
        figures.median[i] = statistics.median;
    }
    results_discard(&results);
    scenario_free(&scenario);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, status, error);
    figures.lost = (unsigned)lround(figures.mean[METRIC_TRACK_LOST] * runs);
    return figures;
}

struct figures experiment(const char *name, const char *settings, unsigned runs)
{
    const struct figures figures = experiment_from(0, name, settings, runs);
    const double *pooled = figures.pooled, *mean = figures.mean;
    printf("  %s %s\n", name, settings);
    printf("    m: median %.3f, p95 %.3f, RMSE %.3f, before filtering %.3f, at arrival %.3f\n",
           pooled[METRIC_POSITION_MEDIAN_M], pooled[METRIC_POSITION_P95_M], pooled[METRIC_POSITION_RMSE_M],
           pooled[METRIC_RAW_POSITION_RMSE_M], pooled[METRIC_POSITION_RMSE_AT_ARRIVAL_M]);
    printf("    NEES %.2f, tracked %.4f, lost %u of %u, frames %.0f, requests %.0f, reports asked for %.0f of %.0f\n",
           pooled[METRIC_NEES_MEDIAN], mean[METRIC_TRACKED_SHARE], figures.lost, runs, mean[METRIC_FRAMES_SENT],
           mean[METRIC_FRAMES_SENT_REQUESTS], mean[METRIC_REPORTS_ASKED], mean[METRIC_REPORTS]);
    return figures;
}

static void expect(bool holds, const char *what, double measured, const char *expected)
{
    char line[300];
    snprintf(line, sizeof line, "%s: %.4g, expected %s", what, measured, expected);
    printf("    %s\n", line);
    TEST_ASSERT_TRUE_MESSAGE(holds, line);
}

void expect_near(const char *what, double measured, double expected, double share)
{
    char text[100];
    snprintf(text, sizeof text, "%g +- %g %%", expected, 100 * share);
    expect(fabs(measured / expected - 1) <= share, what, measured, text);
}

void expect_at_most(const char *what, double measured, double most)
{
    char text[100];
    snprintf(text, sizeof text, "at most %.4g", most);
    expect(measured <= most, what, measured, text);
}

void expect_at_least(const char *what, double measured, double least)
{
    char text[100];
    snprintf(text, sizeof text, "at least %.4g", least);
    expect(measured >= least, what, measured, text);
}
