/* What each fault does to the default tracker: it degrades, says so through its covariance and its counters, and recovers. */
#include "experiment.h"
#include "port.h"
#include "simulation.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOTES_MAX = 1300, SEEDS = 2, CLAIM_SAMPLES = 10, BEGIN_S = 30, OVER_S = 75, END_S = 97 };

static const char *const radios[] = {"ideal", "802154"};

/* A scenario faults_NAME: what its frames are lost to; whether it lasts to the end; whether it leaves the head without measurements. */
static const struct fault {
    const char *name;
    enum loss_reason reason;
    bool lasts, silences;
} faults[] = {
    {"none", LOSS_NONE, false, false},   {"loss", LOSS_RANDOM, true, false},
    {"burst", LOSS_RANDOM, true, false}, {"dead", LOSS_DEAD, true, false},
    {"reboot", LOSS_DEAD, false, false}, {"stuck", LOSS_NONE, false, false},
    {"spike", LOSS_NONE, false, false},  {"saturate", LOSS_NONE, false, false},
    {"bias", LOSS_NONE, false, false},   {"partition", LOSS_PARTITION, false, true},
    {"mute", LOSS_MUTE, false, true},    {"jam", LOSS_JAMMED, false, false},
};

enum { FAULTS_TESTED = sizeof faults / sizeof faults[0] };

void setUp(void) {}
void tearDown(void) {}

static struct seen {
    double x_m[MOTES_MAX], y_m[MOTES_MAX];
    unsigned motes;
    struct {
        unsigned least, most;
    } neighbours[MOTES_MAX];
    uint64_t transmissions, least, most; /* frames on the air, and how many should hear them */
    unsigned estimates, beyond, beyond_longest;
    double before_square, before, during_square, during, after_square, after;
    double sd_before, sd_widest; /* at the beginning of the fault, and the largest while it lasts */
} seen;

static void see_node(void *context, mh_node_id id, const struct mh_place *place)
{
    (void)context;
    TEST_ASSERT_TRUE(id == seen.motes && id < MOTES_MAX); /* in these scenarios identifiers are indices */
    seen.x_m[id] = place->x_mm * 1e-3;
    seen.y_m[id] = place->y_mm * 1e-3;
    seen.motes++;
}

/* All within radio.range_m, brute force; a mote's place is known to a millimetre. */
static void find_neighbours(mh_node_id id)
{
    for (unsigned i = 0; i < seen.motes; i++) {
        const double distance = hypot(seen.x_m[i] - seen.x_m[id], seen.y_m[i] - seen.y_m[id]);
        seen.neighbours[id].least += i != id && distance <= 15 - 2e-3;
        seen.neighbours[id].most += i != id && distance <= 15 + 2e-3;
    }
}

static void see_frame(void *context, double time_s, mh_node_id sender, mh_node_id destination, const uint8_t *bytes,
                      size_t length)
{
    (void)context, (void)bytes, (void)length;
    const bool to_all = destination == MH_BROADCAST;
    if (to_all && seen.neighbours[sender].most == 0) {
        find_neighbours(sender);
    }
    seen.transmissions++;
    seen.most += to_all ? seen.neighbours[sender].most : 1;
    if (time_s < END_S - 0.05) { /* later ones may be in the air at the end */
        seen.least += to_all ? seen.neighbours[sender].least : 1;
    }
}

static void see_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                         const struct truth *at_time, const struct truth *at_arrival)
{
    (void)context, (void)time_s, (void)head, (void)at_arrival;
    const struct mh_sym2 *p = &estimate->covariance;
    TEST_ASSERT_TRUE(mh_finite(estimate->position.x) && mh_finite(estimate->position.y));
    TEST_ASSERT_TRUE(mh_finite(estimate->velocity.x) && mh_finite(estimate->velocity.y));
    TEST_ASSERT_TRUE(mh_finite(p->xx) && mh_finite(p->yy) && p->xx > 0 && p->xx * p->yy > p->xy * p->xy);
    if (!at_time->present) {
        return;
    }
    const double t = at_time->time_s, sd = sqrt((double)(p->xx + p->yy) / 2);
    const double error = hypot(estimate->origin.x_mm * 1e-3 + (double)estimate->position.x - at_time->x_m,
                               estimate->origin.y_mm * 1e-3 + (double)estimate->position.y - at_time->y_m);
    seen.estimates++;
    seen.beyond = error > 3 * sd ? seen.beyond + 1 : 0;
    seen.beyond_longest = seen.beyond > seen.beyond_longest ? seen.beyond : seen.beyond_longest;
    if (t >= 10 && t < BEGIN_S) {
        seen.before_square += error * error;
        seen.before++;
        seen.sd_before = sd;
    } else if (t >= BEGIN_S && t < OVER_S) {
        seen.during_square += error * error;
        seen.during++;
        seen.sd_widest = fmax(seen.sd_widest, sd);
    } else if (t >= OVER_S) {
        seen.after_square += error * error;
        seen.after++;
    }
}

/* What was counted here and there is the same. */
static void expect_sound(const struct simulation_counters *c, const struct scenario *scenario)
{
    uint64_t sent = 0, lost = 0;
    for (int kind = 0; kind <= MH_MESSAGE_KINDS; kind++) {
        sent += c->frames_sent[kind];
    }
    for (int reason = 0; reason < LOSS_REASONS; reason++) {
        lost += LOSS_AT_RECEIVER(reason) ? c->frames_lost_by[reason] : 0;
    }
    TEST_ASSERT_TRUE(sent == seen.transmissions);
    TEST_ASSERT_TRUE(lost == c->frames_lost);
    /* who should hear a frame does, or has it already, or loses it for a reason */
    const uint64_t ends = c->frames_received + c->frames_duplicate + lost;
    TEST_ASSERT_TRUE(ends >= seen.least && ends <= seen.most);
    /* a mote is handed what its radio received, once */
    TEST_ASSERT_TRUE(c->frames_received ==
                     c->motes.frames_received + c->motes.frames_corrupt + c->motes.frames_unknown);
    TEST_ASSERT_TRUE(c->motes.frames_corrupt == 0 && c->motes.frames_unknown == 0);
    /* what a mote hands its radio goes on the air, or is given up; at the end or at a death some may wait */
    const uint64_t begun = sent - c->frames_repeated;
    TEST_ASSERT_TRUE(begun <= c->motes.frames_sent);
    if (scenario->faults.dead.share <= 0 && scenario->faults.reboot.share <= 0) {
        TEST_ASSERT_TRUE(c->motes.frames_sent - begun <=
                         c->frames_lost_by[LOSS_BUSY] + c->frames_lost_by[LOSS_QUEUE] + 300);
    }
    TEST_ASSERT_TRUE(c->head.measurements <= c->motes.reports);
}

static void run(const struct fault *fault, const char *radio, uint64_t seed, struct simulation_counters *counters)
{
    static const struct observer observer = {.node = see_node, .frame = see_frame, .estimate = see_estimate};
    char name[50], settings[50], error[300] = "";
    struct scenario scenario;
    snprintf(name, sizeof name, "faults_%s", fault->name);
    snprintf(settings, sizeof settings, "radio.profile=%s", radio);
    experiment_scenario(name, settings, &scenario);
    seen.motes = seen.estimates = seen.beyond = seen.beyond_longest = 0;
    seen.transmissions = seen.least = seen.most = 0;
    memset(seen.neighbours, 0, sizeof seen.neighbours);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, simulation_run(&scenario, seed, &observer, NULL, counters, error, sizeof error),
                                  error);
    expect_sound(counters, &scenario);
    scenario_free(&scenario);
}

static double rms(double square, double count) { return count > 0 ? sqrt(square / count) : (double)NAN; }

static void test_fault(const struct fault *fault, const char *radio, bool contention)
{
    const struct seen nothing = {.motes = 0};
    double widest = 0, before = 0;
    uint64_t lost = 0;
    unsigned longest = 0, estimates = 0;
    seen = nothing;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct simulation_counters counters;
        seen.sd_before = seen.sd_widest = 0;
        run(fault, radio, seed, &counters);
        widest += seen.sd_widest / SEEDS;
        before += seen.sd_before / SEEDS;
        longest = seen.beyond_longest > longest ? seen.beyond_longest : longest;
        estimates += seen.estimates;
        lost += fault->reason < LOSS_REASONS ? counters.frames_lost_by[fault->reason] : 0;
        for (int reason = LOSS_DEAD; reason <= LOSS_MUTE; reason++) {
            TEST_ASSERT_TRUE(reason == (int)fault->reason || counters.frames_lost_by[reason] == 0);
        }
    }
    const double after = rms(seen.after_square, seen.after);
    printf("  %s %s: RMSE %.2f m before, %.2f m from %d s, %.2f m from %d s; widest standard deviation %.2f m after "
           "%.2f m; longest "
           "overconfidence %u samples; %llu frames lost to it\n",
           fault->name, radio, rms(seen.before_square, seen.before), rms(seen.during_square, seen.during), BEGIN_S,
           after, OVER_S, widest, before, longest, (unsigned long long)lost);
    TEST_ASSERT_TRUE(fault->reason == LOSS_NONE || lost > 100);
    expect_at_most("longest overconfidence, samples", longest, CLAIM_SAMPLES);
    expect_at_least("positions", estimates, SEEDS * 30);
    if (fault->silences) {
        expect_at_least("standard deviation without measurements, of that before", widest / before, 10);
    }
    if (!contention && !fault->lasts) {
        expect_at_most("RMSE when the fault is over, m", after, 0.5);
    }
}

static void faults_without_contention(void)
{
    for (size_t i = 0; i < FAULTS_TESTED; i++) {
        test_fault(&faults[i], radios[0], false);
    }
}

static void faults_on_802154(void)
{
    for (size_t i = 0; i < FAULTS_TESTED; i++) {
        test_fault(&faults[i], radios[1], true);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(faults_without_contention);
    RUN_TEST(faults_on_802154);
    port_exit(UNITY_END() > 0);
}
