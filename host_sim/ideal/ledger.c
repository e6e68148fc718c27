#include "ideal/ledger.h"

#include "radio/radio.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHECK_SUM_BYTES = 2 };

static double mean_csma_us(const struct radio_profile *radio)
{
    const double units = radio->least_units + ((1u << radio->backoff_exponents[0]) - 1u) / 2.0;
    return units * radio->backoff_unit_us + radio->cca_us;
}

int ledger_make(struct ledger *ledger, const struct scenario *scenario, uint32_t count)
{
    const struct radio_config radio = radio_config_of(scenario, scenario->radio.range_m);
    const struct energy_profile *profile = energy_profile_find(scenario->energy.profile);
    *ledger = (struct ledger){.profile = profile,
                              .cpu = scenario->energy.cpu,
                              .radio = radio.profile,
                              .count = count,
                              .mains = scenario->energy.sink_mains ? count - 1 : count};
    if (!profile) {
        return 0;
    }
    const double currents[ENERGY_STATES] = {
        [ENERGY_SLEEP] = profile->sleep,
        [ENERGY_LISTEN] = profile->listen,
        [ENERGY_RECEIVE] = profile->receive,
        [ENERGY_TRANSMIT] = energy_profile_transmit(profile, scenario->radio.power_dbm),
        [ENERGY_CPU] = profile->cpu,
        [ENERGY_SENSING] = profile->sensing};
    for (int state = 0; state < ENERGY_STATES; state++) {
        ledger->power_mw[state] = currents[state] * profile->volts;
    }
    ledger->csma_ms = ledger->radio.contention ? mean_csma_us(&ledger->radio) / 1e3 : 0;
    ledger->turnaround_ms = ledger->radio.turnaround_us / 1e3;
    ledger->ack_turnaround_ms = ledger->radio.ack_turnaround_us / 1e3;
    ledger->ack_ms = radio_profile_air_us(&ledger->radio, ledger->radio.ack_bytes) / 1e3;
    ledger->used_mj = calloc(count, sizeof *ledger->used_mj);
    return ledger->used_mj ? 0 : -1;
}

void ledger_free(struct ledger *ledger)
{
    free(ledger->used_mj);
    *ledger = (struct ledger){0};
}

void ledger_charge(struct ledger *ledger, uint32_t mote, enum energy_state state, enum energy_cause cause, double ms)
{
    if (!ledger->profile || mote == ledger->mains) {
        return;
    }
    const double mj = ms * ledger->power_mw[state] / 1e3;
    ledger->used_mj[mote] += mj;
    ledger->joules[state][cause] += mj / 1e3;
}

void ledger_sense(struct ledger *ledger, uint32_t mote)
{
    ledger_charge(ledger, mote, ENERGY_SENSING, ENERGY_LOCALISATION, (double)energy_sensing_us() / 1e3);
}

void ledger_sample(struct ledger *ledger, uint32_t mote)
{
    ledger_sense(ledger, mote);
    if (ledger->profile) {
        ledger_compute(ledger, mote, (double)energy_sample_us(ledger->profile, ledger->cpu));
    }
}

void ledger_compute(struct ledger *ledger, uint32_t mote, double us)
{
    ledger_charge(ledger, mote, ENERGY_CPU, ENERGY_LOCALISATION, us / 1e3);
}

static double air_ms(const struct ledger *ledger, unsigned payload)
{
    const struct radio_profile *radio = &ledger->radio;
    return radio_profile_air_us(radio, radio->preamble_bytes + radio->header_bytes + payload + CHECK_SUM_BYTES) / 1e3;
}

/* Bytes of the next frame; the rest stays in *payload. */
static unsigned next_frame(unsigned *payload)
{
    const unsigned bytes = *payload < LEDGER_PAYLOAD_MAX ? *payload : LEDGER_PAYLOAD_MAX;
    *payload -= bytes;
    return bytes;
}

void ledger_broadcast(struct ledger *ledger, enum energy_cause cause, uint32_t sender, const uint32_t *receivers,
                      size_t count, unsigned payload)
{
    do {
        const double air = air_ms(ledger, next_frame(&payload));
        ledger_charge(ledger, sender, ENERGY_LISTEN, cause, ledger->csma_ms + ledger->turnaround_ms);
        ledger_charge(ledger, sender, ENERGY_TRANSMIT, cause, air);
        for (size_t i = 0; i < count; i++) {
            ledger_charge(ledger, receivers[i], ENERGY_RECEIVE, cause, air);
        }
    } while (payload > 0);
}

void ledger_unicast(struct ledger *ledger, enum energy_cause cause, uint32_t sender, uint32_t receiver,
                    unsigned payload)
{
    const double listened = ledger->csma_ms + ledger->turnaround_ms + ledger->ack_turnaround_ms;
    do {
        const double air = air_ms(ledger, next_frame(&payload));
        ledger_charge(ledger, sender, ENERGY_LISTEN, cause, listened);
        ledger_charge(ledger, sender, ENERGY_TRANSMIT, cause, air);
        ledger_charge(ledger, sender, ENERGY_RECEIVE, cause, ledger->ack_ms);
        ledger_charge(ledger, receiver, ENERGY_LISTEN, cause, listened);
        ledger_charge(ledger, receiver, ENERGY_RECEIVE, cause, air);
        ledger_charge(ledger, receiver, ENERGY_TRANSMIT, cause, ledger->ack_ms);
    } while (payload > 0);
}

struct energy_totals ledger_totals(const struct ledger *ledger)
{
    if (!ledger->profile) {
        return energy_total_unknown();
    }
    struct energy_totals totals = {.lifetime_s = (double)NAN, .lifetime_half_s = (double)NAN};
    memcpy(totals.joules, ledger->joules, sizeof totals.joules);
    for (uint32_t i = 0; i < ledger->count; i++) {
        totals.hottest_j = fmax(totals.hottest_j, ledger->used_mj[i] / 1e3);
    }
    return totals;
}
