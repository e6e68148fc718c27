#include "energy/account.h"

#include <stdlib.h>

int account_open(struct account *account, const struct scenario *scenario, const uint32_t *order, uint32_t motes,
                 uint32_t sink)
{
    const struct energy_profile *profile = energy_profile_find(scenario->energy.profile);
    *account = (struct account){
        .open = profile != NULL,
        .cpu = scenario->energy.cpu,
        .tracker = scenario->tracker.name,
        .draws = energy_tracker_draws(scenario->energy.cpu, scenario->tracker.name, (int)scenario->tracker.particles)};
    if (!account->open) {
        return 0;
    }
    const struct radio_config radio = radio_config_of(scenario, scenario->radio.range_m);
    const struct energy_config config = {.profile = profile,
                                         .power_dbm = scenario->radio.power_dbm,
                                         .battery_j = scenario->energy.battery_j,
                                         .on_mains = scenario->energy.sink_mains ? sink : UINT32_MAX,
                                         .wake_period = radio.wake_period,
                                         .wake_length = radio.wake_length,
                                         .order = order};
    account->sensing_us = energy_sensing_us();
    account->sample_us = energy_sample_us(profile, scenario->energy.cpu);
    account->frame_us = energy_frame_us(profile, scenario->energy.cpu);
    account->measured = calloc(motes, sizeof *account->measured);
    if (!account->measured || energy_make(&account->ledger, &config, motes)) {
        free(account->measured);
        return -1;
    }
    for (uint32_t i = 0; i < motes; i++) {
        energy_radio(&account->ledger, i, 0, ENERGY_LISTEN, ENERGY_IDLE);
    }
    return 0;
}

void account_close(struct account *account)
{
    if (account->open) {
        energy_free(&account->ledger);
        free(account->measured);
    }
    *account = (struct account){0};
}

enum energy_cause account_cause(enum mh_message_kind kind)
{
    switch (kind) {
    case MH_MESSAGE_REPORT:
    case MH_MESSAGE_POSITION:
    case MH_MESSAGE_LEAK:
    case MH_MESSAGE_TAKEN:
        return ENERGY_REPORTING;
    case MH_MESSAGE_FORM:
    case MH_MESSAGE_JOIN:
    case MH_MESSAGE_HAND_OVER:
    case MH_MESSAGE_ALERT:
    case MH_MESSAGE_TOKEN:
    case MH_MESSAGE_LEAD:
    case MH_MESSAGE_AWAKE:
    case MH_MESSAGE_REST:
    case MH_MESSAGE_FAIL:
    case MH_MESSAGE_SUCCEED:
    case MH_MESSAGE_COMPETE:
    case MH_MESSAGE_DETECTION:
    case MH_MESSAGE_SUPPRESS:
    case MH_MESSAGE_MERGE:
        return ENERGY_CLUSTERING;
    case MH_MESSAGE_REQUEST:
    case MH_MESSAGE_ASK:
    case MH_MESSAGE_ANSWER:
    case MH_MESSAGE_LOCATE:
    case MH_MESSAGE_SOUND:
        return ENERGY_MEASURING;
    case MH_MESSAGE_SYNC:
        return ENERGY_TIME;
    case MH_MESSAGE_BEACON:
    case MH_MESSAGE_HELLO:
    case MH_MESSAGE_LANDMARK:
    case MH_MESSAGE_VICINITY:
    case MH_MESSAGE_KINDS:
        return ENERGY_ROUTING;
    }
    return ENERGY_ROUTING;
}

void account_radio(struct account *account, uint32_t mote, sim_time time, enum radio_state state, uint8_t cause)
{
    static const enum energy_state states[] = {[RADIO_SLEEP] = ENERGY_SLEEP,
                                               [RADIO_LISTEN] = ENERGY_LISTEN,
                                               [RADIO_RECEIVE] = ENERGY_RECEIVE,
                                               [RADIO_TRANSMIT] = ENERGY_TRANSMIT,
                                               [RADIO_OFF] = ENERGY_OFF};
    energy_radio(&account->ledger, mote, time, states[state], (enum energy_cause)cause);
}

/* Work that nobody measures. */
static void assume(struct account *account, uint32_t mote, sim_time time, enum energy_cause cause, uint64_t takes_us)
{
    if (!account->measured[mote]) {
        energy_charge(&account->ledger, mote, time, ENERGY_CPU, cause, takes_us);
    }
}

void account_measured(struct account *account, uint32_t mote)
{
    if (account->open) {
        account->measured[mote] = true;
    }
}

void account_work(struct account *account, uint32_t mote, sim_time time, enum energy_cause cause, uint64_t duration_us)
{
    if (account->open) {
        energy_charge(&account->ledger, mote, time, ENERGY_CPU, cause, duration_us);
    }
}

void account_sample(struct account *account, uint32_t mote, sim_time time)
{
    if (account->open) {
        energy_charge(&account->ledger, mote, time, ENERGY_SENSING, ENERGY_LOCALISATION, account->sensing_us);
        assume(account, mote, time, ENERGY_LOCALISATION, account->sample_us);
    }
}

void account_frame(struct account *account, uint32_t mote, sim_time time, enum energy_cause cause)
{
    if (account->open) {
        assume(account, mote, time, cause, account->frame_us);
    }
}

void account_step(struct account *account, uint32_t mote, sim_time time, int measurements)
{
    if (account->open) {
        const uint64_t takes =
            energy_tracker_us(account->ledger.profile, account->cpu, account->tracker, measurements, account->draws);
        assume(account, mote, time, ENERGY_LOCALISATION, takes);
    }
}
