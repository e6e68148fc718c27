/* A run's memory depends on its motes, not on how long it runs. */
#define _DEFAULT_SOURCE
#include "port.h"
#include "scenario/folder.h"
#include "simulation.h"
#include "unity.h"

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

/* In a process of its own. */
static long peak_kb(const char *name, double duration_s)
{
    struct rusage usage;
    int status;
    const pid_t child = fork();
    if (child == 0) {
        _exit(run(name, duration_s) == 0 ? 0 : 1);
    }
    TEST_ASSERT_TRUE(child > 0 && wait4(child, &status, 0, &usage) == child);
    TEST_ASSERT_EQUAL_INT(0, status);
    return usage.ru_maxrss;
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
    RUN_TEST(memory_does_not_grow_with_time);
    port_exit(UNITY_END() > 0);
    return 0;
}
