/* What `motehound run luo_exp1` costs as the number of motes grows: the tables of docs/scale.md. Every run is a process of its own, so
 * that its memory can be told; of five equal runs the quickest counts. */
#include "scenario/folder.h"
#include "scenario/scenario.h"
#include "simulation.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

enum { REPEATS = 5, SMALLEST = 1280 };

struct cost {
    double cpu_s, memory_mb;
    struct simulation_counters counters;
};

static void die(const char *what)
{
    fprintf(stderr, "scale: %s\n", what);
    exit(1);
}

static void load(struct scenario *scenario, int nodes, double side_m)
{
    char path[SCENARIO_PATH_MAX], error[300] = "no memory", value[2][40];
    snprintf(value[0], sizeof value[0], "%d", nodes);
    snprintf(value[1], sizeof value[1], "%.3f", side_m);
    const char *const settings[][2] = {{"network.nodes", value[0]},
                                       {"field.width_m", value[1]},
                                       {"field.height_m", value[1]},
                                       {"sensor.relative_noise", "0.01"},
                                       {"sensor.additive_noise", "0.02"}};
    if (scenario_find("luo_exp1", path, error, sizeof error) != 0 || scenario_init(scenario) != 0 ||
        scenario_load(path, scenario, error, sizeof error) != 0) {
        die(error);
    }
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        if (scenario_set(scenario, settings[i][0], settings[i][1], error, sizeof error) != 0) {
            die(error);
        }
    }
}

/* The run, in a process of its own that hands its counters back through a pipe. */
static struct cost run(int nodes, double side_m)
{
    struct cost cost;
    struct rusage usage;
    int ends[2], status;
    if (pipe(ends) != 0) {
        die("no pipe");
    }
    const pid_t child = fork();
    if (child < 0) {
        die("no process");
    }
    if (child == 0) {
        static const struct observer observer;
        char error[300];
        struct scenario scenario;
        load(&scenario, nodes, side_m);
        if (simulation_run(&scenario, 0, &observer, NULL, &cost.counters, error, sizeof error) != 0) {
            die(error);
        }
        _exit(write(ends[1], &cost.counters, sizeof cost.counters) == (ssize_t)sizeof cost.counters ? 0 : 1);
    }
    close(ends[1]);
    const ssize_t size = read(ends[0], &cost.counters, sizeof cost.counters);
    close(ends[0]);
    if (wait4(child, &status, 0, &usage) != child || status != 0 || size != (ssize_t)sizeof cost.counters) {
        die("a run failed");
    }
    cost.cpu_s = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                 1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    cost.memory_mb = (double)usage.ru_maxrss / 1024;
    return cost;
}

static void table(bool grows)
{
    static const int sizes[] = {1280, 2560, 5120, 10240, 20000};
    puts("| motes | field | CPU | CPU, a mote and sample | events, a mote | beacons, a mote | other frames, a mote | "
         "memory |");
    puts("|---:|---:|---:|---:|---:|---:|---:|---:|");
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        const double side_m = 80 * (grows ? sqrt((double)sizes[i] / SMALLEST) : 1);
        struct cost cost = run(sizes[i], side_m);
        for (int repeat = 1; repeat < REPEATS; repeat++) {
            const struct cost again = run(sizes[i], side_m);
            cost = again.cpu_s < cost.cpu_s ? again : cost;
        }
        const struct simulation_counters *counters = &cost.counters;
        printf("| %d | %.0f m | %.3f s | %.2f us | %.1f | %.2f | %.2f | %.1f MB |\n", sizes[i], side_m, cost.cpu_s,
               1e6 * cost.cpu_s / ((double)sizes[i] * (double)counters->samples), (double)counters->events / sizes[i],
               (double)counters->frames_sent[MH_MESSAGE_BEACON] / sizes[i],
               (double)(counters->frames_sent[MH_MESSAGE_REPORT] + counters->frames_sent[MH_MESSAGE_REQUEST]) /
                   sizes[i],
               cost.memory_mb);
        fflush(stdout);
    }
}

int main(void)
{
    puts("The field grows with the number of motes:\n");
    table(true);
    puts("\nThe field stays, so the motes stand closer:\n");
    table(false);
    return 0;
}
