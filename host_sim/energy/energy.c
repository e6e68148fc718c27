#include "energy/energy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NOBODY UINT32_MAX
#define PJ_PER_J 1e12

/* A battery that may be nearly empty is looked at this often. */
#define SHORTEST_US 1000

const char *const energy_state_names[ENERGY_STATES] = {"sleep", "listen", "receive", "transmit", "cpu", "sensing"};
const char *const energy_cause_names[ENERGY_CAUSES] = {"idle",      "localisation", "measuring", "clustering",
                                                       "reporting", "routing",      "time"};

/* Where the time of a state begins among the cells; the first four have a cell for each cause. */
enum {
    IDLE_LISTEN_CELL = ENERGY_CAUSES + ENERGY_IDLE,
    CPU_CELLS = 3 * ENERGY_CAUSES,
    SLEEP_CELL = 4 * ENERGY_CAUSES,
    SENSING_CELL
};

static const uint8_t first_cell[ENERGY_STATES + 1] = {
    [ENERGY_RECEIVE] = 0,        [ENERGY_LISTEN] = ENERGY_CAUSES, [ENERGY_TRANSMIT] = 2 * ENERGY_CAUSES,
    [ENERGY_CPU] = CPU_CELLS,    [ENERGY_SLEEP] = SLEEP_CELL,     [ENERGY_SENSING] = SENSING_CELL,
    [ENERGY_OFF] = ENERGY_CELLS,
};

static uint8_t cell_of(enum energy_state state, enum energy_cause cause)
{
    const uint8_t first = first_cell[state];
    return (uint8_t)(first < SLEEP_CELL ? first + cause : first);
}

/* mA at volts to whole microwatts */
static uint32_t microwatts(double current, double volts) { return (uint32_t)lround(1e3 * current * volts); }

static struct energy_mote *mote_of(const struct energy *energy, uint32_t index)
{
    return &energy->motes[energy->order ? energy->order[index] : index];
}

static uint32_t radio_power(const struct energy *energy, uint8_t state)
{
    return state == ENERGY_OFF ? 0 : energy->power_uw[state] + energy->cpu_idle_uw;
}

/* The earliest time at which a mote's battery can be empty, were it to do everything at once. */
static sim_time earliest_end(const struct energy *energy, const struct energy_mote *mote, sim_time now)
{
    uint32_t radio = 0;
    for (int state = ENERGY_SLEEP; state <= ENERGY_TRANSMIT; state++) {
        radio = energy->power_uw[state] > radio ? energy->power_uw[state] : radio;
    }
    const uint32_t most = radio + energy->cpu_idle_uw + energy->power_uw[ENERGY_CPU] + energy->power_uw[ENERGY_SENSING];
    const sim_time ahead = (sim_time)mote->left_pj / most;
    return now + (ahead > SHORTEST_US ? ahead : SHORTEST_US);
}

int energy_make(struct energy *energy, const struct energy_config *config, uint32_t count)
{
    const struct energy_profile *profile = config->profile;
    const double volts = profile->volts;
    *energy = (struct energy){
        .profile = profile,
        .order = config->order,
        .count = count,
        .on_mains = config->on_mains,
        .power_uw = {[ENERGY_SLEEP] = microwatts(profile->sleep, volts),
                     [ENERGY_LISTEN] = microwatts(profile->listen, volts),
                     [ENERGY_RECEIVE] = microwatts(profile->receive, volts),
                     [ENERGY_TRANSMIT] = microwatts(energy_profile_transmit(profile, config->power_dbm), volts),
                     [ENERGY_CPU] = microwatts(profile->cpu - profile->cpu_idle, volts),
                     [ENERGY_SENSING] = microwatts(profile->sensing, volts)},
        .cpu_idle_uw = microwatts(profile->cpu_idle, volts),
        .wake_period = config->wake_period,
        .wake_length = config->wake_length,
        .battery_pj = llround(config->battery_j * PJ_PER_J),
        .first_dead = NOBODY,
        .last_dead = NOBODY,
        .motes = calloc(count, sizeof *energy->motes),
    };
    if (!energy->motes) {
        return -1;
    }
    for (uint32_t i = 0; i < count; i++) {
        struct energy_mote *mote = mote_of(energy, i);
        mote->state = ENERGY_OFF;
        mote->cell = ENERGY_CELLS;
        mote->next_dead = NOBODY;
        mote->mains = energy->battery_pj == 0 || i == config->on_mains;
        mote->left_pj = mote->mains ? INT64_MAX : energy->battery_pj;
        if (!mote->mains && event_queue_push(&energy->checks, earliest_end(energy, mote, 0), i)) {
            energy_free(energy);
            return -1;
        }
    }
    return 0;
}

void energy_free(struct energy *energy)
{
    event_queue_free(&energy->checks);
    free(energy->motes);
    *energy = (struct energy){0};
}

static void die(struct energy *energy, uint32_t index, sim_time time)
{
    struct energy_mote *mote = mote_of(energy, index);
    mote->dead = true;
    mote->since = time;
    mote->state = ENERGY_OFF;
    mote->cell = ENERGY_CELLS;
    if (energy->last_dead == NOBODY) {
        energy->first_dead = index;
    } else {
        mote_of(energy, energy->last_dead)->next_dead = index;
    }
    energy->last_dead = index;
}

/* Of the time before `time`, how much lies in wake windows. */
static uint64_t in_windows(const struct energy *energy, sim_time time)
{
    const uint64_t last = time % energy->wake_period;
    return time / energy->wake_period * energy->wake_length + (last < energy->wake_length ? last : energy->wake_length);
}

/* The part of [mote->since, time) in which the radio, as it is, listens in wake windows. */
static uint64_t listened(const struct energy *energy, const struct energy_mote *mote, sim_time time)
{
    const bool wakes = mote->state == ENERGY_SLEEP && energy->wake_period > 0;
    return wakes ? in_windows(energy, time) - in_windows(energy, mote->since) : 0;
}

/* What the mote uses until `time` if its radio stays as it is, pJ. */
static int64_t use_until(const struct energy *energy, const struct energy_mote *mote, sim_time time)
{
    const uint64_t listening = listened(energy, mote, time), rest = time - mote->since - listening;
    return (int64_t)(rest * radio_power(energy, mote->state) + listening * radio_power(energy, ENERGY_LISTEN));
}

/* That comes to pass, and the battery lasts. */
static void pass(const struct energy *energy, struct energy_mote *mote, sim_time time)
{
    const uint64_t listening = listened(energy, mote, time);
    mote->left_pj -= use_until(energy, mote, time);
    mote->time_us[mote->cell] += time - mote->since - listening;
    mote->time_us[IDLE_LISTEN_CELL] += listening;
    mote->since = time;
}

/* The last microsecond until which the battery lasts, if not until `time`: by bisection, once in a mote's life. */
static sim_time end_of(const struct energy *energy, const struct energy_mote *mote, sim_time time)
{
    sim_time lasts = mote->since;
    while (time - lasts > 1) {
        const sim_time middle = lasts + (time - lasts) / 2;
        *(use_until(energy, mote, middle) <= mote->left_pj ? &lasts : &time) = middle;
    }
    return lasts;
}

/* Account for the radio's state until `time`. */
static void settle(struct energy *energy, uint32_t index, sim_time time)
{
    struct energy_mote *mote = mote_of(energy, index);
    if (use_until(energy, mote, time) <= mote->left_pj) {
        pass(energy, mote, time);
    } else {
        pass(energy, mote, end_of(energy, mote, time));
        die(energy, index, mote->since);
    }
}

void energy_radio(struct energy *energy, uint32_t index, sim_time time, enum energy_state state,
                  enum energy_cause cause)
{
    struct energy_mote *mote = mote_of(energy, index);
    if (mote->dead) {
        return;
    }
    settle(energy, index, time);
    if (!mote->dead) {
        mote->state = (uint8_t)state;
        mote->cell = cell_of(state, cause);
    }
}

void energy_charge(struct energy *energy, uint32_t index, sim_time time, enum energy_state state,
                   enum energy_cause cause, uint64_t duration_us)
{
    struct energy_mote *mote = mote_of(energy, index);
    if (mote->dead || mote->state == ENERGY_OFF) {
        return;
    }
    if (time > mote->since) {
        settle(energy, index, time);
        if (mote->dead) {
            return;
        }
    }
    const uint32_t power = energy->power_uw[state];
    const bool enough = (int64_t)(duration_us * power) <= mote->left_pj;
    const uint64_t lasts = enough ? duration_us : (uint64_t)mote->left_pj / power;
    mote->time_us[cell_of(state, cause)] += lasts;
    mote->left_pj -= (int64_t)(lasts * power);
    if (!enough) {
        die(energy, index, mote->since);
    }
}

sim_time energy_next(const struct energy *energy) { return event_queue_next(&energy->checks); }

void energy_run(struct energy *energy, sim_time now, void (*dies)(void *context, uint32_t mote, sim_time at),
                void *context)
{
    struct event check;
    while (event_queue_next(&energy->checks) <= now && event_queue_pop(&energy->checks, &check)) {
        struct energy_mote *mote = mote_of(energy, check.content);
        if (!mote->dead && check.time > mote->since) {
            settle(energy, check.content, check.time);
        }
        if (!mote->dead) {
            /* never fails: there is the room of the one that was taken out */
            (void)event_queue_push(&energy->checks, earliest_end(energy, mote, mote->since), check.content);
        }
    }
    while (energy->first_dead != NOBODY) {
        struct energy_mote *mote = mote_of(energy, energy->first_dead);
        dies(context, energy->first_dead, mote->since);
        energy->first_dead = mote->next_dead;
    }
    energy->last_dead = NOBODY;
}

bool energy_is_dead(const struct energy *energy, uint32_t mote) { return mote_of(energy, mote)->dead; }

bool energy_is_on(const struct energy *energy, uint32_t mote) { return mote_of(energy, mote)->state != ENERGY_OFF; }

/* A mote's ledger until `now`, the original untouched. */
static struct energy_mote settled(const struct energy *energy, uint32_t index, sim_time now)
{
    struct energy_mote mote = *mote_of(energy, index);
    if (!mote.dead && now > mote.since) {
        pass(energy, &mote, now);
    }
    return mote;
}

/* Time of the powered mote in all states of its radio. */
static uint64_t time_on(const struct energy_mote *mote)
{
    uint64_t sum = mote->time_us[SLEEP_CELL];
    for (int cell = 0; cell < CPU_CELLS; cell++) {
        sum += mote->time_us[cell];
    }
    return sum;
}

void energy_of_mote(const struct energy *energy, uint32_t index, sim_time now,
                    double joules[ENERGY_STATES][ENERGY_CAUSES])
{
    const struct energy_mote mote = settled(energy, index, now);
    memset(joules, 0, ENERGY_STATES * sizeof *joules);
    for (int state = 0; state < ENERGY_STATES; state++) {
        const bool one_cause = state == ENERGY_SLEEP || state == ENERGY_SENSING;
        const int only = state == ENERGY_SLEEP ? ENERGY_IDLE : ENERGY_LOCALISATION;
        for (int cause = 0; cause < ENERGY_CAUSES; cause++) {
            const uint8_t cell = cell_of((enum energy_state)state, (enum energy_cause)cause);
            if (!one_cause || cause == only) {
                joules[state][cause] = (double)(mote.time_us[cell] * energy->power_uw[state]) / PJ_PER_J;
            }
        }
    }
    joules[ENERGY_CPU][ENERGY_IDLE] += (double)(time_on(&mote) * energy->cpu_idle_uw) / PJ_PER_J;
}

double energy_used_j(const struct energy *energy, uint32_t index, sim_time now)
{
    const struct energy_mote mote = settled(energy, index, now);
    const int64_t full = mote.mains ? INT64_MAX : energy->battery_pj;
    return (double)(full - mote.left_pj) / PJ_PER_J;
}

double energy_battery_left(const struct energy *energy, uint32_t index, sim_time now)
{
    const struct energy_mote mote = settled(energy, index, now);
    if (mote.mains) {
        return 1;
    }
    return mote.left_pj > 0 ? (double)mote.left_pj / (double)energy->battery_pj : 0;
}

static int by_value(const void *a, const void *b)
{
    const sim_time left = *(const sim_time *)a, right = *(const sim_time *)b;
    return (left > right) - (left < right);
}

/* Deaths in order of time, and from them the lifetimes. */
static int lifetimes(const struct energy *energy, struct energy_totals *totals)
{
    sim_time *deaths = malloc((energy->count + 1) * sizeof *deaths); /* of at least one byte */
    if (!deaths) {
        return -1;
    }
    uint32_t dead = 0, mortal = 0;
    for (uint32_t i = 0; i < energy->count; i++) {
        mortal += !energy->motes[i].mains;
        if (energy->motes[i].dead) {
            deaths[dead++] = energy->motes[i].since;
        }
    }
    qsort(deaths, dead, sizeof *deaths, by_value);
    const uint32_t half = (mortal + 1) / 2;
    totals->dead = dead;
    totals->lifetime_s = dead > 0 ? (double)deaths[0] / SIM_TIME_PER_S : (double)NAN;
    totals->lifetime_half_s = half > 0 && dead >= half ? (double)deaths[half - 1] / SIM_TIME_PER_S : (double)NAN;
    free(deaths);
    return 0;
}

struct energy_totals energy_total_unknown(void)
{
    struct energy_totals totals = {.hottest_j = (double)NAN, .lifetime_s = (double)NAN, .lifetime_half_s = (double)NAN};
    for (int state = 0; state < ENERGY_STATES; state++) {
        for (int cause = 0; cause < ENERGY_CAUSES; cause++) {
            totals.joules[state][cause] = (double)NAN;
        }
    }
    return totals;
}

int energy_total(const struct energy *energy, sim_time now, struct energy_totals *totals)
{
    *totals = (struct energy_totals){0};
    for (uint32_t i = 0; i < energy->count; i++) {
        double joules[ENERGY_STATES][ENERGY_CAUSES];
        if (i == energy->on_mains) {
            continue;
        }
        energy_of_mote(energy, i, now, joules);
        double used_j = 0;
        for (int state = 0; state < ENERGY_STATES; state++) {
            for (int cause = 0; cause < ENERGY_CAUSES; cause++) {
                totals->joules[state][cause] += joules[state][cause];
                used_j += joules[state][cause];
            }
        }
        totals->hottest_j = fmax(totals->hottest_j, used_j);
    }
    return lifetimes(energy, totals);
}
