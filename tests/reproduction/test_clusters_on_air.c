/* Zhou's clusters over radios that sleep, collide and lose frames: the track is kept, about as well as in the ideal network, and outlives what breaks on
 * its way. Seeds 0 to 19, 2 h each: docs/clusters.md. */
#include "experiment.h"
#include "port.h"
#include "simulation.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define NEAR_M 50 /* the sensing range: an estimate farther off follows nothing */
#define SAMPLES_SKIPPED 5

void setUp(void) {}
void tearDown(void) {}

struct followed {
    double gap_s, gap_end_s; /* longest time without an estimate near the target, and when it ended */
    double last_s;           /* of such an estimate */
    double sum_m, sink_m;
    unsigned estimates, told;
    double ask_s; /* where the target is then: into x_m, y_m */
    double x_m, y_m;
};

static void end_gap(struct followed *followed, double time_s)
{
    if (time_s - followed->last_s > followed->gap_s) {
        followed->gap_s = time_s - followed->last_s;
        followed->gap_end_s = time_s;
    }
    followed->last_s = time_s;
}

static double error_of(const struct mh_estimate *estimate, const struct truth *truth)
{
    return hypot(estimate->origin.x_mm * 1e-3 + (double)estimate->position.x - truth->x_m,
                 estimate->origin.y_mm * 1e-3 + (double)estimate->position.y - truth->y_m);
}

static void see_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                         const struct truth *at_time, const struct truth *at_arrival)
{
    struct followed *followed = context;
    const double error_m = error_of(estimate, at_time);
    (void)time_s, (void)head, (void)at_arrival;
    if (error_m <= NEAR_M) {
        end_gap(followed, at_time->time_s);
    }
    if (at_time->time_s >= 2 * SAMPLES_SKIPPED) {
        followed->sum_m += error_m;
        followed->estimates++;
    }
}

static void see_sink(void *context, double time_s, const struct mh_estimate *estimate, const struct truth *at_time)
{
    struct followed *followed = context;
    (void)time_s;
    followed->sink_m += error_of(estimate, at_time);
    followed->told++;
}

static void see_truth(void *context, const struct truth *truth)
{
    struct followed *followed = context;
    if (fabs(truth->time_s - followed->ask_s) < 1) {
        followed->x_m = truth->x_m;
        followed->y_m = truth->y_m;
    }
}

static struct followed follow(const char *name, const char *settings, double duration_s, double ask_s, uint64_t seed,
                              struct simulation_counters *counters)
{
    char all[400], error[300] = "";
    struct scenario scenario;
    struct followed followed = {.ask_s = ask_s};
    const struct observer observer = {
        .context = &followed, .estimate = see_estimate, .sink = see_sink, .truth = see_truth};
    snprintf(all, sizeof all, "source.duration_s=%g %s", duration_s, settings);
    experiment_scenario(name, all, &scenario);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, simulation_run(&scenario, seed, &observer, NULL, counters, error, sizeof error),
                                  error);
    end_gap(&followed, duration_s);
    printf("  %s %s, seed %llu: longest gap %.0f s until %.0f s, mean error %.2f m, at the sink %.2f m, %u estimates\n",
           name, all, (unsigned long long)seed, followed.gap_s, followed.gap_end_s, followed.sum_m / followed.estimates,
           followed.sink_m / followed.told, followed.estimates);
    scenario_free(&scenario);
    return followed;
}

/* In 2 runs of 20 min, beside the ideal network with the same target and noise. */
static void the_track_is_kept(void)
{
    struct simulation_counters counters;
    double on_air_m = 0, ideal_m = 0;
    for (uint64_t seed = 1; seed <= 2; seed++) {
        const struct followed on_air = follow("zhou_real", "", 1200, 0, seed, &counters);
        const struct followed ideal = follow("zhou_nominal", "", 1200, 0, seed, &counters);
        expect_at_most("longest gap, s", on_air.gap_s, 10);
        on_air_m += on_air.sum_m / on_air.estimates;
        ideal_m += ideal.sum_m / ideal.estimates;
    }
    expect_at_most("error on the air, of that in the ideal network", on_air_m / ideal_m, 1.3);
}

/* Each minute 3 % of all nodes die, a quarter in the end: now and then it is the head, or the one that was to be the next. */
static void heads_die(void)
{
    struct simulation_counters counters;
    for (uint64_t seed = 1; seed <= 2; seed++) {
        const struct followed followed = follow("zhou_heads", "", 600, 0, seed, &counters);
        expect_at_least("frames lost to the dead", (double)counters.frames_lost_by[LOSS_DEAD], 100);
        expect_at_most("longest gap, s", followed.gap_s, 20);
    }
}

/* Nothing is heard within 200 m of where the target is when that begins, for 90 s. It is found again when it has left the disc, or when
 * the jam is over. */
static void a_jam_interrupts_the_track(void)
{
    enum { FROM_S = 200, FOR_S = 90 };
    struct simulation_counters counters;
    const struct followed before = follow("zhou_real", "", FROM_S + 10, FROM_S, 1, &counters);
    char settings[300];
    snprintf(settings, sizeof settings,
             "faults.jam_from_s=%d faults.jam_for_s=%d faults.jam_radius_m=200 faults.jam_x_m=%.1f faults.jam_y_m=%.1f",
             FROM_S, FOR_S, before.x_m, before.y_m);
    const struct followed jammed = follow("zhou_real", settings, 400, 0, 1, &counters);
    expect_at_least("frames lost to the jam", (double)counters.frames_lost_by[LOSS_JAMMED], 10);
    expect_at_least("longest gap, s", jammed.gap_s, 10);
    expect_at_most("longest gap, s", jammed.gap_s, FOR_S + 20);
}

/* No frame crosses the line on which the target stands when that begins: the head on the other side cannot be told, and there is none. */
static void a_partition_on_the_targets_way(void)
{
    enum { FROM_S = 200, FOR_S = 120 };
    struct simulation_counters counters;
    const struct followed before = follow("zhou_real", "", FROM_S + 10, FROM_S, 2, &counters);
    for (int angle = 0; angle < 2; angle++) {
        char settings[300];
        snprintf(settings, sizeof settings,
                 "faults.partition_from_s=%d faults.partition_for_s=%d faults.partition_x_m=%.1f "
                 "faults.partition_y_m=%.1f faults.partition_angle_rad=%g",
                 FROM_S, FOR_S, before.x_m, before.y_m, angle * 1.57);
        const struct followed parted = follow("zhou_real", settings, 500, 0, 2, &counters);
        expect_at_least("frames lost to the partition", (double)counters.frames_lost_by[LOSS_PARTITION], 100);
        expect_at_most("longest gap, s", parted.gap_s, 20);
    }
}

/* 1,001 motes for 2 h. */
static void two_hours_take_seconds(void)
{
#ifdef __SANITIZE_ADDRESS__
    TEST_IGNORE_MESSAGE("the sanitizer takes its time");
#endif
    struct simulation_counters counters;
    const clock_t begin = clock();
    const struct followed followed =
        follow("zhou_real", "tracker.name=pftl protocol.election=sac", 7200, 0, 1, &counters);
    expect_at_most("processor time, s", (double)(clock() - begin) / CLOCKS_PER_SEC, 10);
    expect_at_least("estimates", followed.estimates, 3550);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_track_is_kept);
    RUN_TEST(heads_die);
    RUN_TEST(a_jam_interrupts_the_track);
    RUN_TEST(a_partition_on_the_targets_way);
    RUN_TEST(two_hours_take_seconds);
    port_exit(UNITY_END() > 0);
    return 0;
}
