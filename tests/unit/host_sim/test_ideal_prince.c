#include "ideal/ideal.h"
#include "motehound/estimate.h"
#include "port.h"
#include "scenario/folder.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct scenario scenario;
static char error[500];

/* What a run tells, instant by instant. */
struct heard {
    size_t nodes, truths, estimates, groups, single, wrong_count, unlike;
    double time_s;
    unsigned members; /* of the estimates at this instant */
    bool apart_again;
    uint32_t largest_target;
    double sum_m;
};

static void on_node(void *context, mh_node_id id, const struct mh_place *place)
{
    struct heard *heard = context;
    (void)id;
    (void)place;
    heard->nodes++;
}

static void on_truth(void *context, const struct truth *truth)
{
    struct heard *heard = context;
    if (truth->target == 0) { /* a new instant */
        heard->wrong_count += heard->truths > 0 && heard->members != 3;
        heard->members = 0;
    }
    heard->truths++;
    heard->time_s = truth->time_s;
}

static void on_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                        const struct truth *at_time, const struct truth *at_arrival)
{
    struct heard *heard = context;
    (void)head;
    (void)at_arrival;
    TEST_ASSERT_TRUE(fabs(time_s - heard->time_s) < 1e-9);
    const double x_m = 1e-3 * estimate->origin.x_mm + (double)estimate->position.x,
                 y_m = 1e-3 * estimate->origin.y_mm + (double)estimate->position.y;
    heard->estimates++;
    heard->members += estimate->members > 1 ? estimate->members : 1;
    heard->groups += estimate->members > 1;
    heard->single += estimate->members <= 1;
    heard->apart_again = estimate->members <= 1 && heard->groups > 0;
    heard->unlike += estimate->members > 1 && estimate->target != estimate->of[0];
    heard->largest_target = estimate->target > heard->largest_target ? estimate->target : heard->largest_target;
    heard->sum_m += hypot(x_m - at_time->x_m, y_m - at_time->y_m);
}

void setUp(void) {}
void tearDown(void) { scenario_free(&scenario); }

static void load(const char *name)
{
    char path[SCENARIO_PATH_MAX];
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_find(name, path, error, sizeof error), error);
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_load(path, &scenario, error, sizeof error), error);
}

static int run(uint64_t seed, struct heard *heard, struct simulation_counters *counters)
{
    const struct observer observer = {.context = heard, .node = on_node, .truth = on_truth, .estimate = on_estimate};
    *heard = (struct heard){0};
    return ideal_run(&scenario, seed, &observer, NULL, counters, error, sizeof error);
}

/* Each place is found by itself, so the error does not depend on what was before. */
static void scattered_targets_are_found_one_by_one(void)
{
    struct heard heard, again;
    struct simulation_counters counters;
    load("han_table21");
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, run(3, &heard, &counters), error);
    TEST_ASSERT_EQUAL_size_t(1156, heard.nodes);
    TEST_ASSERT_EQUAL_size_t(250, heard.truths);
    TEST_ASSERT_TRUE(heard.estimates >= 248 && heard.sum_m / (double)heard.estimates < 2.5);
    TEST_ASSERT_EQUAL_UINT64(250, counters.samples);
    TEST_ASSERT_EQUAL_INT(0, run(3, &again, &counters));
    TEST_ASSERT_TRUE(again.sum_m >= heard.sum_m && again.sum_m <= heard.sum_m);
}

/* Three lanes: three tracks, one group of three, three tracks. Nobody is lost or counted twice, whatever merges and splits. */
static void lanes_become_a_group_and_part(void)
{
    for (uint64_t seed = 0; seed < 5; seed++) {
        struct heard heard;
        struct simulation_counters counters;
        load("han_group");
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, run(seed, &heard, &counters), error);
        TEST_ASSERT_EQUAL_size_t(0, heard.wrong_count);
        TEST_ASSERT_EQUAL_size_t(0, heard.unlike);
        TEST_ASSERT_TRUE(heard.groups > 10 && heard.single > 30 && heard.apart_again);
        TEST_ASSERT_EQUAL_UINT32(3, heard.largest_target);
        scenario_free(&scenario);
    }
}

static void targets_on_one_spot_are_found_as_a_group(void)
{
    struct heard heard;
    struct simulation_counters counters;
    load("han_group");
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "source.path", "ring", error, sizeof error));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, run(1, &heard, &counters), error);
    TEST_ASSERT_TRUE(heard.groups >= heard.truths / 3 - 2);
    TEST_ASSERT_TRUE(heard.sum_m / (double)heard.estimates < 4);
}

static void only_trackers_of_several_targets_can_follow(void)
{
    struct heard heard;
    struct simulation_counters counters;
    load("han_sparse");
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "tracker.name", "centroid", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(-1, run(0, &heard, &counters));
    TEST_ASSERT_NOT_NULL(strstr(error, "tracker.name: `centroid`"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(scattered_targets_are_found_one_by_one);
    RUN_TEST(lanes_become_a_group_and_part);
    RUN_TEST(targets_on_one_spot_are_found_as_a_group);
    RUN_TEST(only_trackers_of_several_targets_can_follow);
    port_exit(UNITY_END() > 0);
    return 0;
}
