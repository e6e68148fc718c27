/* A run's memory depends on its motes, not on how long it runs, nor much on how many of them could lead. */
#define _DEFAULT_SOURCE
#include "hosts/host.h"
#include "motehound/collection.h"
#include "motehound/luo.h"
#include "port.h"
#include "scenario/folder.h"
#include "simulation.h"
#include "unity.h"

#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

void setUp(void) {}
void tearDown(void) {}

static int run(const char *name, double duration_s)
{
    static const struct observer nobody;
    struct simulation_counters counters;
    struct scenario scenario;
    char path[SCENARIO_PATH_MAX], error[500];
    if (scenario_find(name, path, error, sizeof error) != 0 || scenario_init(&scenario) != 0 ||
        scenario_load(path, &scenario, error, sizeof error) != 0 ||
        scenario_set(&scenario, "energy.profile", "mica2", error, sizeof error) != 0) {
        return -1;
    }
    scenario.network.nodes = 300;
    scenario.source.duration_s = duration_s;
    const int result = simulation_run(&scenario, 0, &nobody, NULL, &counters, error, sizeof error);
    const bool worked = result == 0 && (double)counters.frames_received > 50 * duration_s;
    scenario_free(&scenario);
    return worked ? 0 : -1;
}

/* Bring up 2,000 motes, of which all could lead or none. */
static int bring_up(bool heads)
{
    enum { MOTES = 2000 };
    struct mh_collection_config collection;
    struct mh_luo_config luo;
    struct host host;
    struct host_actions actions = {0};
    struct host_event start[MOTES];
    uint32_t order[MOTES];
    char error[200];
    mh_collection_config_default(&collection);
    mh_luo_config_default(&luo);
    const struct mh_head_config head = {
        .tracker = &mh_tracker_luo, .tracker_config = &luo, .interval = 1000, .window = 500};
    for (uint32_t i = 0; i < MOTES; i++) {
        order[i] = i;
    }
    if (host_in_process(&host, MOTES, order, &mh_protocol_collection)) {
        return -1;
    }
    for (uint32_t i = 0; i < MOTES; i++) {
        const struct host_mote what = {
            .id = i, .head = heads ? &head : NULL, .protocol = &mh_protocol_collection, .protocol_config = &collection};
        start[i] = (struct host_event){.kind = HOST_START, .mote = i};
        if (host.add(host.state, i, &what)) {
            return -1;
        }
    }
    const int result = host.run(host.state, 1000, start, MOTES, &actions, error, sizeof error);
    host_actions_free(&actions);
    host.destroy(host.state);
    return result;
}

/* In a process of its own; without a name bring_up(duration_s > 0). */
static long peak_kb(const char *name, double duration_s)
{
    struct rusage usage;
    int status;
    const pid_t child = fork();
    if (child == 0) {
        _exit((name ? run(name, duration_s) : bring_up(duration_s > 0)) == 0 ? 0 : 1);
    }
    TEST_ASSERT_TRUE(child > 0 && wait4(child, &status, 0, &usage) == child);
    TEST_ASSERT_EQUAL_INT(0, status);
    return usage.ru_maxrss;
}

/* Room for 1,024 measurements takes 32 KB, of which a mote that never leads touches three pages or four. */
static void heads_that_never_lead_take_little(void)
{
#ifdef __SANITIZE_ADDRESS__
    TEST_IGNORE_MESSAGE("the sanitizer's memory is not lazy");
#endif
    TEST_ASSERT_LESS_THAN_INT(2000 * 16, peak_kb(NULL, 1) - peak_kb(NULL, 0));
}

/* Linux counts resident memory to within some 100 KB. The longer run hears 100,000 frames more and more. */
static void memory_does_not_grow_with_time(void)
{
#ifdef __SANITIZE_ADDRESS__
    TEST_IGNORE_MESSAGE("the sanitizer keeps what is freed for a while");
#endif
    static const char *const names[] = {"bench_s1", "bench_s2"};
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_LESS_THAN_INT(peak_kb(names[i], 100) + 256, peak_kb(names[i], 1500));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(heads_that_never_lead_take_little);
    RUN_TEST(memory_does_not_grow_with_time);
    port_exit(UNITY_END() > 0);
    return 0;
}
