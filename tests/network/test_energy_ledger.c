/* The ledger of every scenario that is shipped, beside an integrator of the test's own that follows the changes of power. The linker puts
 * the functions below between the network and the ledger (-Wl,--wrap). */
#include "energy/energy.h"
#include "port.h"
#include "scenario/folder.h"
#include "simulation.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Runs are cut short after so many changes. */
enum { CHANGES_MAX = 2000000 };

struct draw {
    double joules, watts;
    double woken_watts; /* in wake windows, if the radio sleeps; else 0 */
    sim_time since;
};

static struct draw *draws;
static sim_time last;
static long changes, motes, dead;
static double battery_j, power_dbm;
static sim_time wake_period, wake_length;
static bool contends; /* radios wait for a free channel, and listen for a frame meanwhile */
static volatile sig_atomic_t stop;
static char line[300];

int __real_energy_make(struct energy *energy, const struct energy_config *config, uint32_t count);
void __real_energy_free(struct energy *energy);
void __real_energy_radio(struct energy *energy, uint32_t mote, sim_time time, enum energy_state state,
                         enum energy_cause cause);
void __real_energy_charge(struct energy *energy, uint32_t mote, sim_time time, enum energy_state state,
                          enum energy_cause cause, uint64_t duration_us);
int __wrap_energy_make(struct energy *energy, const struct energy_config *config, uint32_t count);
void __wrap_energy_free(struct energy *energy);
void __wrap_energy_radio(struct energy *energy, uint32_t mote, sim_time time, enum energy_state state,
                         enum energy_cause cause);
void __wrap_energy_charge(struct energy *energy, uint32_t mote, sim_time time, enum energy_state state,
                          enum energy_cause cause, uint64_t duration_us);

/* mJ/ms, from the data sheets' currents */
static double watts(const struct energy *energy, enum energy_state state)
{
    const struct energy_profile *p = energy->profile;
    const double transmit = energy_profile_transmit(p, power_dbm);
    const double currents[] = {
        [ENERGY_SLEEP] = p->sleep,    [ENERGY_LISTEN] = p->listen, [ENERGY_RECEIVE] = p->receive,
        [ENERGY_TRANSMIT] = transmit, [ENERGY_CPU] = p->cpu,       [ENERGY_SENSING] = p->sensing};
    return state == ENERGY_OFF ? 0 : 1e-3 * p->volts * currents[state];
}

static double idle_watts(const struct energy *energy)
{
    return 1e-3 * energy->profile->volts * energy->profile->cpu_idle;
}

/* Through the wake windows one by one. */
static double drawn_until(const struct draw *draw, sim_time time)
{
    double joules = draw->watts * (double)(time - draw->since) / SIM_TIME_PER_S;
    if (draw->woken_watts > 0) {
        for (sim_time open = draw->since / wake_period * wake_period; open < time; open += wake_period) {
            const sim_time begin = open > draw->since ? open : draw->since;
            const sim_time end = open + wake_length < time ? open + wake_length : time;
            joules += end > begin ? (draw->woken_watts - draw->watts) * (double)(end - begin) / SIM_TIME_PER_S : 0;
        }
    }
    return joules;
}

static void count_change(sim_time time)
{
    last = time > last ? time : last;
    stop = ++changes >= CHANGES_MAX;
}

int __wrap_energy_make(struct energy *energy, const struct energy_config *config, uint32_t count)
{
    draws = calloc(count, sizeof *draws);
    TEST_ASSERT_NOT_NULL(draws);
    last = 0;
    changes = 0;
    power_dbm = config->power_dbm;
    wake_period = config->wake_period;
    wake_length = config->wake_length;
    return __real_energy_make(energy, config, count);
}

void __wrap_energy_radio(struct energy *energy, uint32_t mote, sim_time time, enum energy_state state,
                         enum energy_cause cause)
{
    struct draw *draw = &draws[mote];
    TEST_ASSERT_TRUE(time >= draw->since);
    TEST_ASSERT_TRUE((unsigned)cause < ENERGY_CAUSES);
    if (state == ENERGY_TRANSMIT || state == ENERGY_RECEIVE) {
        TEST_ASSERT_TRUE(cause != ENERGY_IDLE);
    } else {
        TEST_ASSERT_TRUE(cause == ENERGY_IDLE || (state == ENERGY_LISTEN && contends));
    }
    draw->joules += drawn_until(draw, time);
    draw->since = time;
    draw->woken_watts =
        state == ENERGY_SLEEP && wake_period > 0 ? watts(energy, ENERGY_LISTEN) + idle_watts(energy) : 0;
    draw->watts = watts(energy, state) + (state == ENERGY_OFF ? 0 : idle_watts(energy));
    count_change(time);
    __real_energy_radio(energy, mote, time, state, cause);
}

void __wrap_energy_charge(struct energy *energy, uint32_t mote, sim_time time, enum energy_state state,
                          enum energy_cause cause, uint64_t duration_us)
{
    struct draw *draw = &draws[mote];
    if (draw->watts > 0) {
        const double power = watts(energy, state) - (state == ENERGY_CPU ? idle_watts(energy) : 0);
        draw->joules += power * (double)duration_us / SIM_TIME_PER_S;
    }
    count_change(time);
    __real_energy_charge(energy, mote, time, state, cause, duration_us);
}

static void agree(uint32_t mote, const char *what, double one, double other, double tolerance)
{
    if (!(fabs(one - other) <= tolerance)) {
        snprintf(line, sizeof line, "mote %u: %s: %.15g and %.15g J", (unsigned)mote, what, one, other);
        TEST_FAIL_MESSAGE(line);
    }
}

static void check(const struct energy *energy, uint32_t mote)
{
    struct draw *draw = &draws[mote];
    double joules[ENERGY_STATES][ENERGY_CAUSES], states = 0, causes = 0;
    energy_of_mote(energy, mote, last, joules);
    for (int state = 0; state < ENERGY_STATES; state++) {
        double of_state = 0;
        for (int cause = 0; cause < ENERGY_CAUSES; cause++) {
            of_state += joules[state][cause];
        }
        states += of_state;
    }
    for (int cause = 0; cause < ENERGY_CAUSES; cause++) {
        double of_cause = 0;
        for (int state = 0; state < ENERGY_STATES; state++) {
            of_cause += joules[state][cause];
        }
        causes += of_cause;
    }
    const double integral = draw->joules + drawn_until(draw, last);
    agree(mote, "sums over states and causes", states, causes, 1e-9 * states);
    agree(mote, "sum and total", states, energy_used_j(energy, mote, last), 1e-9 * states);
    if (energy_is_dead(energy, mote)) {
        agree(mote, "sum and battery", states, battery_j, 1e-6); /* to the microsecond */
        TEST_ASSERT_TRUE(integral > battery_j - 1e-6);
        dead++;
    } else {
        agree(mote, "sum and integral", states, integral, 1e-9 * integral);
    }
    motes++;
}

void __wrap_energy_free(struct energy *energy)
{
    for (uint32_t mote = 0; mote < energy->count; mote++) {
        check(energy, mote);
    }
    free(draws);
    __real_energy_free(energy);
}

static struct observer observer;

static bool duty_cycled; /* nodes do not relay, and sleep but for wake windows */

static void run(const char *name, const char *path, const char *profile)
{
    char error[500] = "no memory";
    struct scenario scenario;
    struct simulation_counters counters;
    const long motes_before = motes;
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_load(path, &scenario, error, sizeof error), error);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, "energy.profile", profile, error, sizeof error), error);
    if (scenario.network.ideal) { /* no motes whose states could change */
        scenario_free(&scenario);
        return;
    }
    if (duty_cycled) {
        TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "network.protocol", "direct", error, sizeof error));
        TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "radio.wake_period_s", "0.25", error, sizeof error));
        TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "radio.profile", "802154", error, sizeof error));
    }
    scenario.energy.battery_j = battery_j;
    contends = strcmp(scenario.radio.profile, "ideal") != 0;
    stop = 0;
    const int status = simulation_run(&scenario, 1, &observer, &stop, &counters, error, sizeof error);
    TEST_ASSERT_TRUE_MESSAGE(status == 0 || stop, error);
    const int64_t side = scenario.network.grid;
    TEST_ASSERT_TRUE_MESSAGE(
        motes - motes_before > (scenario.network.layout == LAYOUT_STRAT ? side * side : scenario.network.nodes), name);
    printf("  %s, %s, battery %g J: %ld motes, %ld changes in %.0f s\n", name, profile, battery_j, motes - motes_before,
           changes, (double)last / SIM_TIME_PER_S);
    scenario_free(&scenario);
}

static void run_whole(void *context, const char *name, const char *path)
{
    (void)context;
    run(name, path, "mica2");
}

static void run_micaz(void *context, const char *name, const char *path)
{
    (void)context;
    run(name, path, "micaz");
}

void setUp(void)
{
    motes = dead = 0;
    duty_cycled = false;
    observer = (struct observer){0};
}
void tearDown(void) {}

static void all_scenarios_add_up(void)
{
    battery_j = 0;
    TEST_ASSERT_TRUE(scenario_list(run_whole, NULL) >= 4);
    TEST_ASSERT_EQUAL_INT(0, dead);
}

/* Listening alone takes 56 mW, so all nodes die within nine seconds, those that sent more before the others. */
static void all_scenarios_add_up_while_motes_die(void)
{
    battery_j = 0.5;
    TEST_ASSERT_TRUE(scenario_list(run_micaz, NULL) >= 4);
    TEST_ASSERT_TRUE(dead > 1000);
}

static void duty_cycles_add_up(void)
{
    char error[500], path[SCENARIO_PATH_MAX];
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_find("luo_exp1", path, error, sizeof error), error);
    duty_cycled = true;
    battery_j = 0;
    run("luo_exp1", path, "mica2");
    battery_j = 0.05;
    run("luo_exp1", path, "micaz");
    TEST_ASSERT_TRUE(dead > 1000);
}

/* ---- what the observer hears of motes that die ---- */

enum { NODES_MAX = 2000 };
static double died_s[NODES_MAX], used_mj[NODES_MAX];
static long told, frames;

static void hear_mote(void *context, double time_s, mh_node_id id, const struct mote_state *state)
{
    (void)context;
    TEST_ASSERT_TRUE(id < NODES_MAX && state->energy_mj >= used_mj[id]);
    used_mj[id] = state->energy_mj;
    if (state->battery_left < 1) {
        TEST_ASSERT_TRUE(fabs(state->battery_left - (1 - 1e-3 * state->energy_mj / battery_j)) < 1e-6);
    }
    TEST_ASSERT_TRUE(state->alive == (died_s[id] == 0) || (!state->alive && state->battery_left < 1e-5));
    if (!state->alive && died_s[id] == 0) {
        died_s[id] = time_s;
    }
    told++;
}

static void hear_frame(void *context, double time_s, mh_node_id sender, mh_node_id destination, const uint8_t *bytes,
                       size_t length)
{
    (void)context, (void)destination, (void)bytes, (void)length;
    TEST_ASSERT_TRUE(died_s[sender] == 0 || time_s < died_s[sender]);
    frames++;
}

static void the_dead_are_silent(void)
{
    char error[500], path[SCENARIO_PATH_MAX];
    battery_j = 0.5;
    observer = (struct observer){.mote = hear_mote, .frame = hear_frame};
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_find("luo_exp1", path, error, sizeof error), error);
    run("luo_exp1", path, "mica2");
    long sum = 0;
    for (int i = 0; i < NODES_MAX; i++) {
        sum += died_s[i] > 0;
    }
    TEST_ASSERT_EQUAL_INT(1280, sum);
    TEST_ASSERT_EQUAL_INT(9 * 1281, told); /* each 10 s of 97 s */
    TEST_ASSERT_TRUE(frames > 1000);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(all_scenarios_add_up);
    RUN_TEST(all_scenarios_add_up_while_motes_die);
    RUN_TEST(duty_cycles_add_up);
    RUN_TEST(the_dead_are_silent);
    port_exit(UNITY_END() > 0);
    return 0;
}
