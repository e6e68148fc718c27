#include "energy/energy.h"
#include "engine/random.h"
#include "port.h"
#include "trackers.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool near(double expected, double actual) { return fabs(expected - actual) <= 1e-12 * (1 + fabs(expected)); }
#define NEAR(expected, actual) TEST_ASSERT_TRUE(near(expected, actual))

enum { MOTES = 8, SINK = MOTES - 1, TOLD = 64 };

static struct energy energy;
static double joules[ENERGY_STATES][ENERGY_CAUSES];
static struct energy_totals totals;
static uint32_t told[TOLD];
static sim_time told_at[TOLD];
static int told_count;

static void make_waking(const char *profile, double battery_j, sim_time period, sim_time length)
{
    static const uint32_t order[MOTES] = {3, 6, 7, 1, 0, 5, 2, 4};
    const struct energy_config config = {.profile = energy_profile_find(profile),
                                         .battery_j = battery_j,
                                         .wake_period = period,
                                         .wake_length = length,
                                         .on_mains = SINK,
                                         .order = order};
    TEST_ASSERT_EQUAL_INT(0, energy_make(&energy, &config, MOTES));
    told_count = 0;
}

static void make(const char *profile, double battery_j) { make_waking(profile, battery_j, 0, 0); }

void setUp(void) { make("mica2", 0); }
void tearDown(void) { energy_free(&energy); }

static void tell(void *context, uint32_t mote, sim_time at)
{
    (void)context;
    TEST_ASSERT_TRUE(told_count < TOLD);
    told[told_count] = mote;
    told_at[told_count++] = at;
}

static double sum_of(uint32_t mote, sim_time now)
{
    double sum = 0;
    energy_of_mote(&energy, mote, now, joules);
    for (int state = 0; state < ENERGY_STATES; state++) {
        for (int cause = 0; cause < ENERGY_CAUSES; cause++) {
            sum += joules[state][cause];
        }
    }
    return sum;
}

/* Zhou, Table 2, in mJ/ms, which is W. */
static void powers_of_mica2_are_the_papers(void)
{
    static const double watts[] = {[ENERGY_SLEEP] = 0.0015,   [ENERGY_LISTEN] = 0.009, [ENERGY_RECEIVE] = 0.03,
                                   [ENERGY_TRANSMIT] = 0.081, [ENERGY_CPU] = 0.024,    [ENERGY_SENSING] = 0.03};
    for (int state = ENERGY_SLEEP; state <= ENERGY_TRANSMIT; state++) {
        energy_radio(&energy, 0, (sim_time)state * 1000000, (enum energy_state)state, ENERGY_ROUTING);
    }
    energy_radio(&energy, 0, 4000000, ENERGY_SLEEP, ENERGY_IDLE);
    energy_charge(&energy, 0, 4000000, ENERGY_SENSING, ENERGY_LOCALISATION, 1000000);
    energy_charge(&energy, 0, 4000000, ENERGY_CPU, ENERGY_CLUSTERING, 1000000);
    energy_of_mote(&energy, 0, 4000000, joules);
    NEAR(watts[ENERGY_SLEEP], joules[ENERGY_SLEEP][ENERGY_IDLE]);
    NEAR(watts[ENERGY_LISTEN], joules[ENERGY_LISTEN][ENERGY_ROUTING]);
    NEAR(watts[ENERGY_RECEIVE], joules[ENERGY_RECEIVE][ENERGY_ROUTING]);
    NEAR(watts[ENERGY_TRANSMIT], joules[ENERGY_TRANSMIT][ENERGY_ROUTING]);
    NEAR(watts[ENERGY_SENSING], joules[ENERGY_SENSING][ENERGY_LOCALISATION]);
    NEAR(watts[ENERGY_CPU] - 4.5e-5, joules[ENERGY_CPU][ENERGY_CLUSTERING]); /* it would have idled meanwhile */
    NEAR(4 * 4.5e-5, joules[ENERGY_CPU][ENERGY_IDLE]);
    NEAR(watts[ENERGY_SLEEP] + watts[ENERGY_LISTEN] + watts[ENERGY_RECEIVE] + watts[ENERGY_TRANSMIT] +
             watts[ENERGY_SENSING] + watts[ENERGY_CPU] + 3 * 4.5e-5,
         sum_of(0, 4000000));
}

static void a_mote_that_is_off_draws_nothing(void)
{
    energy_radio(&energy, 1, 1000, ENERGY_LISTEN, ENERGY_IDLE);
    energy_radio(&energy, 1, 2000, ENERGY_OFF, ENERGY_IDLE);
    energy_charge(&energy, 1, 5000, ENERGY_CPU, ENERGY_IDLE, 77);
    energy_radio(&energy, 1, 500000, ENERGY_LISTEN, ENERGY_IDLE);
    energy_radio(&energy, 1, 501000, ENERGY_OFF, ENERGY_IDLE);
    NEAR(2000e-6 * (0.009 + 4.5e-5), sum_of(1, 900000));
    NEAR(0, sum_of(2, 900000));
    NEAR(1, energy_battery_left(&energy, 1, 900000));
}

/* Random changes; all is added up again in floating point, state by state as it was drawn. */
static void whatever_happens_all_adds_up(void)
{
    const struct random_stream stream = random_stream(5, RANDOM_RADIO_LOSS);
    uint64_t draw = 0;
    const double watts[] = {0.0015, 0.009, 0.03, 0.081, 0.024 - 4.5e-5, 0.03, 0};
    for (uint32_t mote = 0; mote < MOTES; mote++) {
        sim_time now = 0;
        int state = ENERGY_OFF;
        double integral = 0, by_cause[ENERGY_CAUSES] = {0}, by_state[ENERGY_STATES] = {0}, sum = 0;
        for (int i = 0; i < 2000; i++) {
            const sim_time step = (sim_time)(1e5 * random_uniform(stream, draw++));
            integral += 1e-6 * (double)step * (watts[state] + (state != ENERGY_OFF ? 4.5e-5 : 0));
            now += step;
            const int cause = (int)(ENERGY_CAUSES * random_uniform(stream, draw++));
            if (random_uniform(stream, draw++) < 0.3) {
                const int work = random_uniform(stream, draw++) < 0.5 ? ENERGY_CPU : ENERGY_SENSING;
                energy_charge(&energy, mote, now, (enum energy_state)work, (enum energy_cause)cause, 3000);
                integral += state != ENERGY_OFF ? 3e-3 * watts[work] : 0;
                continue;
            }
            state = (int)((ENERGY_TRANSMIT + 2) * random_uniform(stream, draw++));
            state = state > ENERGY_TRANSMIT ? ENERGY_OFF : state;
            energy_radio(&energy, mote, now, (enum energy_state)state, (enum energy_cause)cause);
        }
        now += 12345;
        integral += 12345e-6 * (watts[state] + (state != ENERGY_OFF ? 4.5e-5 : 0));
        energy_of_mote(&energy, mote, now, joules);
        for (int s = 0; s < ENERGY_STATES; s++) {
            for (int c = 0; c < ENERGY_CAUSES; c++) {
                by_state[s] += joules[s][c];
                by_cause[c] += joules[s][c];
            }
            sum += by_state[s];
        }
        double causes = 0;
        for (int c = 0; c < ENERGY_CAUSES; c++) {
            causes += by_cause[c];
        }
        TEST_ASSERT_TRUE(integral > 0.5);
        NEAR(integral, sum);
        NEAR(integral, causes);
        NEAR(integral, energy_used_j(&energy, mote, now));
    }
}

enum { PERIOD = 250000, LENGTH = 10000 };

/* Time in wake windows, one by one. */
static sim_time time_in_windows(sim_time from, sim_time to)
{
    sim_time sum = 0;
    for (sim_time open = from / PERIOD * PERIOD; open < to; open += PERIOD) {
        const sim_time begin = open > from ? open : from, end = open + LENGTH < to ? open + LENGTH : to;
        sum += end > begin ? end - begin : 0;
    }
    return sum;
}

/* Random changes among sleep and other states, with steps from a microsecond to many periods, each once ending on the edge of a window. */
static void wake_windows_are_listened_through(void)
{
    const struct random_stream stream = random_stream(6, RANDOM_RADIO_LOSS);
    const double watts[] = {0.0015, 0.009, 0.03, 0.081};
    uint64_t draw = 0;
    tearDown();
    make_waking("mica2", 0, PERIOD, LENGTH);
    for (uint32_t mote = 0; mote < MOTES; mote++) {
        sim_time now = 0, asleep = 0, woken = 0, listening = 0;
        double integral = 0;
        int state = ENERGY_OFF;
        for (int i = 0; i < 3000; i++) {
            sim_time next = now + (sim_time)exp(16 * random_uniform(stream, draw++));
            next = i % 5 == 0 ? (next / PERIOD + 1) * PERIOD + (i % 2 ? LENGTH : 0) : next;
            if (state == ENERGY_SLEEP) {
                const sim_time open = time_in_windows(now, next);
                woken += open;
                asleep += next - now - open;
                integral += 1e-6 * ((double)open * 0.009 + (double)(next - now - open) * 0.0015);
            } else if (state != ENERGY_OFF) {
                integral += 1e-6 * (double)(next - now) * watts[state];
                listening += state == ENERGY_LISTEN ? next - now : 0;
            }
            integral += state != ENERGY_OFF ? 4.5e-11 * (double)(next - now) : 0;
            now = next;
            const int choice = (int)(8 * random_uniform(stream, draw++));
            state = choice > ENERGY_TRANSMIT ? ENERGY_SLEEP : choice;
            state = i % 100 == 99 ? ENERGY_OFF : state;
            energy_radio(&energy, mote, now, (enum energy_state)state, ENERGY_IDLE);
        }
        NEAR(integral, sum_of(mote, now));
        NEAR(integral, energy_used_j(&energy, mote, now));
        NEAR(1e-6 * 0.0015 * (double)asleep, joules[ENERGY_SLEEP][ENERGY_IDLE]);
        NEAR(1e-6 * 0.009 * (double)(listening + woken), joules[ENERGY_LISTEN][ENERGY_IDLE]);
        TEST_ASSERT_TRUE(asleep > 100000000 && woken > 1000000);
    }
}

/* In a window 9.045 uJ a millisecond, else 1.545: followed window by window until the battery is empty. */
static void a_battery_empties_between_windows_and_in_them(void)
{
    static bool in_window[2];
    for (int i = 0; i < 40; i++) {
        const uint64_t battery_pj = UINT64_C(100000000000) + (uint64_t)i * 16384000 * 17;
        const sim_time begin = (sim_time)i * 7001;
        tearDown();
        make_waking("mica2", (double)battery_pj / 1e12, PERIOD, LENGTH);
        energy_radio(&energy, 0, begin, ENERGY_SLEEP, ENERGY_IDLE);
        uint64_t left = battery_pj;
        sim_time now = begin;
        for (;;) {
            const sim_time phase = now % PERIOD, edge = now - phase + (phase < LENGTH ? LENGTH : PERIOD);
            const uint64_t power = phase < LENGTH ? 9045 : 1545;
            if ((edge - now) * power > left) {
                now += left / power;
                in_window[phase < LENGTH] = true;
                break;
            }
            left -= (edge - now) * power;
            now = edge;
        }
        while (told_count == 0) {
            const sim_time next = energy_next(&energy);
            energy_run(&energy, next, tell, NULL);
            TEST_ASSERT_TRUE(told_count == 0 || next - told_at[0] <= 1000);
        }
        TEST_ASSERT_EQUAL_UINT64(now, told_at[0]);
        TEST_ASSERT_TRUE(fabs(sum_of(0, now + 5000000) - (double)battery_pj / 1e12) < 1e-7);
    }
    TEST_ASSERT_TRUE(in_window[0] && in_window[1]);
}

/* Listening takes 9.045 mW. */
static void a_battery_empties_at_its_time(void)
{
    tearDown();
    make("mica2", 0.09045);
    for (uint32_t mote = 0; mote < MOTES; mote++) {
        energy_radio(&energy, mote, 0, ENERGY_LISTEN, ENERGY_IDLE);
    }
    NEAR(0.5, energy_battery_left(&energy, 0, 5000000));
    energy_radio(&energy, 1, 4000000, ENERGY_SLEEP, ENERGY_IDLE); /* 1.545 mW */
    energy_radio(&energy, 2, 1000000, ENERGY_OFF, ENERGY_IDLE);
    energy_radio(&energy, 2, 11000000, ENERGY_LISTEN, ENERGY_IDLE);
    energy_charge(&energy, 3, 2000000, ENERGY_SENSING, ENERGY_LOCALISATION, 1000000);
    /* nobody looks in between */
    for (sim_time next; (next = energy_next(&energy)) != SIM_TIME_NEVER;) {
        const int before = told_count;
        energy_run(&energy, next, tell, NULL);
        for (int i = before; i < told_count; i++) {
            TEST_ASSERT_TRUE(told_at[i] <= next && next - told_at[i] <= 1000);
        }
    }
    TEST_ASSERT_EQUAL_INT(MOTES - 1, told_count);
    for (int i = 0; i < told_count; i++) {
        const sim_time expected = told[i] == 1   ? 4000000 + (sim_time)(1e6 * (0.09045 - 4 * 0.009045) / 0.001545)
                                  : told[i] == 2 ? 20000000
                                  : told[i] == 3 ? (sim_time)(1e6 * (0.09045 - 0.03) / 0.009045)
                                                 : 10000000;
        TEST_ASSERT_EQUAL_UINT64(expected, told_at[i]);
        TEST_ASSERT_TRUE(energy_is_dead(&energy, told[i]));
        TEST_ASSERT_TRUE(fabs(sum_of(told[i], 90000000) - 0.09045) < 1e-7); /* a microsecond of it */
        energy_radio(&energy, told[i], 90000000, ENERGY_TRANSMIT, ENERGY_ROUTING);
        energy_charge(&energy, told[i], 90000000, ENERGY_CPU, ENERGY_ROUTING, 1000);
        TEST_ASSERT_TRUE(sum_of(told[i], 99000000) <= 0.09045);
        TEST_ASSERT_TRUE(energy_battery_left(&energy, told[i], 99000000) < 1e-6);
    }
    NEAR(99 * 0.009045, sum_of(SINK, 99000000)); /* on mains */
    TEST_ASSERT_EQUAL_INT(0, energy_total(&energy, 99000000, &totals));
    TEST_ASSERT_EQUAL_UINT32(MOTES - 1, totals.dead);
    NEAR((double)(sim_time)(1e6 * (0.09045 - 0.03) / 0.009045) / 1e6, totals.lifetime_s);
    NEAR(10, totals.lifetime_half_s);
}

static void found_within_a_millisecond_when_nothing_happens(void)
{
    tearDown();
    make("mica2", 2);
    energy_radio(&energy, 4, 0, ENERGY_LISTEN, ENERGY_IDLE);
    int looks = 0;
    while (told_count == 0) {
        const sim_time next = energy_next(&energy);
        TEST_ASSERT_TRUE(next != SIM_TIME_NEVER);
        energy_run(&energy, next, tell, NULL);
        if (told_count > 0) {
            TEST_ASSERT_TRUE(next - told_at[0] <= 1000);
        }
        looks++;
    }
    TEST_ASSERT_EQUAL_UINT64(2000000000000 / 9045, told_at[0]);
    TEST_ASSERT_TRUE(looks < 6000); /* the seven that are off are looked at as well */
}

static void work_that_the_battery_does_not_reach_for_kills(void)
{
    tearDown();
    make("mica2", 0.01);
    energy_radio(&energy, 0, 0, ENERGY_SLEEP, ENERGY_IDLE);
    energy_charge(&energy, 0, 1000000, ENERGY_CPU, ENERGY_LOCALISATION, 1000000); /* 24 mJ, 8.455 mJ are there */
    TEST_ASSERT_TRUE(energy_is_dead(&energy, 0));
    energy_run(&energy, 1000000, tell, NULL);
    TEST_ASSERT_EQUAL_INT(1, told_count);
    TEST_ASSERT_EQUAL_UINT64(1000000, told_at[0]);
    TEST_ASSERT_TRUE(fabs(sum_of(0, 5000000) - 0.01) < 1e-7);
    energy_run(&energy, 2000000, tell, NULL);
    TEST_ASSERT_EQUAL_INT(1, told_count);
}

static void totals_leave_out_the_mote_on_mains(void)
{
    double sum = 0;
    for (uint32_t mote = 0; mote < MOTES; mote++) {
        energy_radio(&energy, mote, 0, ENERGY_TRANSMIT, (enum energy_cause)(mote % ENERGY_CAUSES));
    }
    TEST_ASSERT_EQUAL_INT(0, energy_total(&energy, 3000000, &totals));
    for (int state = 0; state < ENERGY_STATES; state++) {
        for (int cause = 0; cause < ENERGY_CAUSES; cause++) {
            sum += totals.joules[state][cause];
        }
    }
    NEAR(7 * 3 * 0.081045, sum);
    NEAR(3 * 0.081, totals.joules[ENERGY_TRANSMIT][ENERGY_IDLE]); /* mote 0 */
    TEST_ASSERT_EQUAL_UINT32(0, totals.dead);
    TEST_ASSERT_TRUE(isnan(totals.lifetime_s) && isnan(totals.lifetime_half_s));
}

static void transmit_current_follows_the_power(void)
{
    const struct energy_profile *micaz = energy_profile_find("micaz");
    NEAR(17.4, energy_profile_transmit(micaz, 0));
    NEAR(17.4, energy_profile_transmit(micaz, 10));
    NEAR(8.5, energy_profile_transmit(micaz, -40));
    NEAR(11.2, energy_profile_transmit(micaz, -10));
    NEAR((9.9 + 8.5) / 2, energy_profile_transmit(micaz, -20));
    NEAR(27, energy_profile_transmit(energy_profile_find("mica2"), -7));
    TEST_ASSERT_NULL(energy_profile_find("none"));
}

static void profiles_make_sense(void)
{
    const struct energy_profile *profile;
    for (int i = 0; (profile = energy_profile_at(i)) != NULL; i++) {
        TEST_ASSERT_EQUAL_PTR(profile, energy_profile_find(profile->name));
        TEST_ASSERT_TRUE(profile->volts > 0 && profile->cpu > profile->cpu_idle && profile->cpu_mhz > 0);
        TEST_ASSERT_TRUE(profile->sleep < profile->listen && profile->listen <= profile->receive);
        TEST_ASSERT_TRUE(profile->transmit_count >= 1 && profile->transmit[0].current > profile->sleep);
        for (int row = 1; row < profile->transmit_count; row++) {
            TEST_ASSERT_TRUE(profile->transmit[row - 1].dbm < profile->transmit[row].dbm);
        }
        TEST_ASSERT_TRUE(energy_sample_us(profile, ENERGY_CPU_ASSUMED) == 500); /* of an ATmega128 at 7.3728 MHz */
        const char *name, *meaning;
        for (size_t t = 0; tracker_describe(t, &name, &meaning); t++) {
            TEST_ASSERT_TRUE_MESSAGE(energy_tracker_us(profile, ENERGY_CPU_MEASURED, name, 5, 200) > 0, name);
            TEST_ASSERT_TRUE_MESSAGE(energy_tracker_us(profile, ENERGY_CPU_ASSUMED, name, 5, 200) > 0, name);
        }
        NEAR(64989, (double)energy_tracker_us(profile, ENERGY_CPU_ASSUMED, "luo", 20, 0)); /* docs/costs.md */
        NEAR(0, (double)energy_tracker_us(profile, ENERGY_CPU_MEASURED, "no such tracker", 20, 200));
    }
}

static void a_mote_takes_little_memory(void) { TEST_ASSERT_TRUE(sizeof(struct energy_mote) <= 280); }

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(powers_of_mica2_are_the_papers);
    RUN_TEST(a_mote_that_is_off_draws_nothing);
    RUN_TEST(whatever_happens_all_adds_up);
    RUN_TEST(wake_windows_are_listened_through);
    RUN_TEST(a_battery_empties_between_windows_and_in_them);
    RUN_TEST(a_battery_empties_at_its_time);
    RUN_TEST(found_within_a_millisecond_when_nothing_happens);
    RUN_TEST(work_that_the_battery_does_not_reach_for_kills);
    RUN_TEST(totals_leave_out_the_mote_on_mains);
    RUN_TEST(transmit_current_follows_the_power);
    RUN_TEST(profiles_make_sense);
    RUN_TEST(a_mote_takes_little_memory);
    port_exit(UNITY_END() > 0);
    return 0;
}
