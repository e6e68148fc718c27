/* The ideal network: who hears whom, ways to the sink, and runs in fields that leave the target unseen. */
#include "ideal/ideal.h"
#include "ideal/vicinity.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

void setUp(void) {}
void tearDown(void) {}

/* ---- vicinity ---- */

struct way {
    const struct vicinity *vicinity;
    unsigned hops;
    uint32_t at;
};

static void follow_hop(void *context, uint32_t from, uint32_t to)
{
    struct way *way = context;
    TEST_ASSERT_EQUAL_UINT32(way->at, from);
    bool hears = false;
    for (size_t k = way->vicinity->first[from]; k < way->vicinity->first[from + 1]; k++) {
        hears = hears || way->vicinity->neighbours[k] == to;
    }
    TEST_ASSERT_TRUE(hears);
    way->at = to;
    way->hops++;
}

static void neighbours_are_those_in_range(void)
{
    enum { COUNT = 200 };
    mh_node_id ids[COUNT];
    struct mh_place places[COUNT];
    uint64_t state = 1;
    for (uint32_t i = 0; i < COUNT; i++) {
        ids[i] = 3 * i + 7;
        state = state * UINT64_C(6364136223846793005) + 1;
        places[i] = (struct mh_place){(int32_t)(state >> 45), (int32_t)(state >> 26 & 0x7FFFF), 0}; /* 524 m */
    }
    struct vicinity vicinity;
    TEST_ASSERT_EQUAL_INT(0, vicinity_make(&vicinity, COUNT, ids, places, 100));
    for (uint32_t i = 0; i < COUNT; i++) {
        size_t expected = 0;
        for (uint32_t j = 0; j < COUNT; j++) {
            expected += i != j && mh_place_within(&places[i], &places[j], 100000);
        }
        TEST_ASSERT_EQUAL_UINT(expected, vicinity.first[i + 1] - vicinity.first[i]);
        TEST_ASSERT_EQUAL_UINT32(i, vicinity_find(&vicinity, ids[i]));
        for (int again = 0; again < 2; again++) { /* the second time along what is remembered */
            struct way way = {&vicinity, 0, i};
            TEST_ASSERT_TRUE(vicinity_walk(&vicinity, i, follow_hop, &way));
            TEST_ASSERT_EQUAL_UINT32(COUNT - 1, way.at);
        }
    }
    vicinity_free(&vicinity);
}

/* A cup of nodes around a sink that is beyond its wall: greedy forwarding ends in it, the walk around the face does not. */
static void ways_lead_around_holes(void)
{
    const struct mh_place places[] = {{0, 0, 0},           {60000, 0, 0},       {60000, 80000, 0},
                                      {60000, -80000, 0},  {140000, 140000, 0}, {240000, 140000, 0},
                                      {330000, 100000, 0}, {330000, 10000, 0}};
    const mh_node_id ids[] = {0, 1, 2, 3, 4, 5, 6, 7};
    struct vicinity vicinity;
    TEST_ASSERT_EQUAL_INT(0, vicinity_make(&vicinity, 8, ids, places, 101));
    struct way way = {&vicinity, 0, 0};
    TEST_ASSERT_TRUE(vicinity_walk(&vicinity, 0, follow_hop, &way));
    TEST_ASSERT_EQUAL_UINT32(7, way.at);
    TEST_ASSERT_TRUE(way.hops >= 6);
    vicinity_free(&vicinity);

    TEST_ASSERT_EQUAL_INT(0, vicinity_make(&vicinity, 8, ids, places, 85)); /* the sink is cut off */
    way = (struct way){&vicinity, 0, 0};
    TEST_ASSERT_FALSE(vicinity_walk(&vicinity, 0, follow_hop, &way));
    vicinity_free(&vicinity);
}

/* ---- runs ---- */

struct heard {
    unsigned estimates, sinks, clusters, first_clusters;
    bool sane;
};

static void on_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                        const struct truth *at_time, const struct truth *at_arrival)
{
    struct heard *heard = context;
    (void)head;
    (void)at_arrival;
    heard->estimates++;
    heard->sane =
        heard->sane && mh_finite(estimate->position.x) && mh_finite(estimate->position.y) && time_s == at_time->time_s;
}

static void on_sink(void *context, double time_s, const struct mh_estimate *estimate, const struct truth *at_time)
{
    struct heard *heard = context;
    (void)time_s;
    (void)estimate;
    (void)at_time;
    heard->sinks++;
}

static void on_cluster(void *context, double time_s, uint32_t track, mh_node_id head, const mh_node_id *members,
                       size_t count, bool is_new)
{
    struct heard *heard = context;
    (void)time_s;
    (void)track;
    for (size_t i = 0; i < count; i++) {
        heard->sane = heard->sane && members[i] != head;
    }
    heard->clusters += is_new;
    heard->first_clusters += !is_new;
}

static struct heard run(const char *const settings[][2], struct simulation_counters *counters)
{
    static const char *const common[][2] = {
        {"source.path", "gauss_markov"}, {"source.duration_s", "1000"}, {"network.layout", "hashed"},
        {"network.nodes", "300"},        {"network.density", "12"},     {"network.protocol", "cluster"},
        {"network.ideal", "true"},       {"sensor.quantity", "range"},  {"sensor.interval_s", "2"},
        {"radio.range_m", "100"},        {"radio.profile", "802154"},   {NULL, NULL}};
    char error[300] = "";
    struct scenario scenario;
    struct heard heard = {.sane = true};
    const struct observer observer = {
        .context = &heard, .estimate = on_estimate, .sink = on_sink, .cluster = on_cluster};
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    for (size_t i = 0; common[i][0]; i++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, common[i][0], common[i][1], error, sizeof error),
                                      error);
    }
    for (size_t i = 0; settings[i][0]; i++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, settings[i][0], settings[i][1], error, sizeof error),
                                      error);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_check(&scenario, "test", error, sizeof error), error);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, ideal_run(&scenario, 1, &observer, NULL, counters, error, sizeof error), error);
    scenario_free(&scenario);
    TEST_ASSERT_TRUE(heard.sane);
    TEST_ASSERT_EQUAL_UINT(501, counters->samples);
    TEST_ASSERT_EQUAL_UINT(counters->clusters.total.formed, heard.clusters);
    TEST_ASSERT_TRUE(counters->clusters.total.recoveries <= heard.clusters);
    TEST_ASSERT_TRUE(counters->clusters.total.answered <= counters->clusters.total.asked);
    return heard;
}

static const char *const trackers[] = {"range", "pftl", "msl", "centroid"};
static const char *const elections[] = {"sacx", "sac", "rho", "scm", "scm_near", "scm_set"};

static void all_pairs_follow(void)
{
    for (size_t i = 0; i < 24; i++) {
        struct simulation_counters counters;
        const char *const settings[][2] = {
            {"tracker.name", trackers[i % 4]}, {"protocol.election", elections[i / 4]}, {NULL, NULL}};
        const struct heard heard = run(settings, &counters);
        TEST_ASSERT_EQUAL_UINT(501, heard.estimates);
        TEST_ASSERT_EQUAL_UINT(501, heard.sinks);
        TEST_ASSERT_EQUAL_UINT(1, heard.first_clusters);
        TEST_ASSERT_TRUE(heard.clusters > 10 && heard.clusters < 500);
    }
}

/* So few nodes that the target is mostly alone, with radios that reach no farther than the sensors. */
static void lonely_target(void)
{
    unsigned unseen = 0;
    for (size_t i = 0; i < 24; i++) {
        struct simulation_counters counters;
        const char *const settings[][2] = {{"tracker.name", trackers[i % 4]},
                                           {"protocol.election", elections[i / 4]},
                                           {"network.density", "0.7"},
                                           {"radio.range_m", "50"},
                                           {NULL, NULL}};
        const struct heard heard = run(settings, &counters);
        unseen += counters.clusters.total.answered < counters.samples;
        TEST_ASSERT_TRUE(heard.sinks <= 501 && heard.estimates <= 501 && heard.estimates > 0);
    }
    TEST_ASSERT_EQUAL_UINT(24, unseen);
}

static void target_that_nobody_sees(void)
{
    struct simulation_counters counters;
    const char *const settings[][2] = {{"tracker.name", "range"},
                                       {"network.density", "0.001"},
                                       {"sensor.range_m", "1"},
                                       {"target.speed_mph", "0.1"},
                                       {NULL, NULL}};
    const struct heard heard = run(settings, &counters);
    TEST_ASSERT_EQUAL_UINT(0, heard.estimates + heard.sinks + heard.clusters + heard.first_clusters);
    TEST_ASSERT_TRUE(counters.energy.joules[ENERGY_SENSING][ENERGY_LOCALISATION] == 0);
}

/* Two fields are two runs, the same one is the same. */
static void runs_repeat(void)
{
    struct simulation_counters first, second;
    const char *const settings[][2] = {{"tracker.name", "pftl"}, {NULL, NULL}};
    (void)run(settings, &first);
    (void)run(settings, &second);
    TEST_ASSERT_EQUAL_MEMORY(&first.clusters, &second.clusters, sizeof first.clusters);
    TEST_ASSERT_EQUAL_MEMORY(&first.energy.joules, &second.energy.joules, sizeof first.energy.joules);
}

static void other_trackers_are_refused(void)
{
    char error[300] = "";
    struct scenario scenario;
    struct simulation_counters counters;
    const struct observer observer = {0};
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "source.path", "gauss_markov", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "source.duration_s", "10", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "tracker.name", "luo", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(-1, ideal_run(&scenario, 1, &observer, NULL, &counters, error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("network.ideal: no such thing for network.protocol collection", error);
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "network.protocol", "cluster", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(-1, ideal_run(&scenario, 1, &observer, NULL, &counters, error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("tracker.name: `luo`, expected range, pftl, msl or centroid in an ideal network", error);
    scenario_free(&scenario);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(neighbours_are_those_in_range);
    RUN_TEST(ways_lead_around_holes);
    RUN_TEST(all_pairs_follow);
    RUN_TEST(lonely_target);
    RUN_TEST(target_that_nobody_sees);
    RUN_TEST(runs_repeat);
    RUN_TEST(other_trackers_are_refused);
    port_exit(UNITY_END() > 0);
}
