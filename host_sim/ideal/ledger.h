/* What an ideal network costs, message by message: each frame is sent once and arrives, and nobody waits for a busy channel.
 *
 * A frame is on the air for (preamble + header + payload + check sum) bytes. Its sender first listens for the mean first backoff and the
 * assessment of the channel (CSMA) and turns its radio round; one sent to a single node is acknowledged. More payload than
 * LEDGER_PAYLOAD_MAX goes in several frames. Not in the ledger: sleeping, waking up, and idle processors, which are the same for all. Powers are the
 * energy profile's, times and overheads the radio profile's. */
#ifndef MOTEHOUND_SIM_IDEAL_LEDGER_H
#define MOTEHOUND_SIM_IDEAL_LEDGER_H

#include "energy/energy.h"
#include "radio/profile.h"
#include "scenario/scenario.h"

#include <stddef.h>
#include <stdint.h>

enum { LEDGER_PAYLOAD_MAX = 96 }; /* bytes of a frame */

struct ledger {
    const struct energy_profile *profile; /* NULL: nothing is charged */
    enum energy_cpu cpu;
    struct radio_profile radio;
    double power_mw[ENERGY_STATES];
    double csma_ms, turnaround_ms, ack_turnaround_ms, ack_ms;
    uint32_t count;
    uint32_t mains;  /* the mote that is not charged; `count`: none */
    double *used_mj; /* by each mote */
    double joules[ENERGY_STATES][ENERGY_CAUSES];
};

/* Of `scenario` with `count` motes, the last of which is the sink. Returns 0, or -1 if there is no memory. */
int ledger_make(struct ledger *ledger, const struct scenario *scenario, uint32_t count);

void ledger_free(struct ledger *ledger);

/* Mote `mote` is in `state` for so long. */
void ledger_charge(struct ledger *ledger, uint32_t mote, enum energy_state state, enum energy_cause cause, double ms);

/* It takes a sample: the sensor alone, or with what a node that does not compute makes of it. */
void ledger_sense(struct ledger *ledger, uint32_t mote);
void ledger_sample(struct ledger *ledger, uint32_t mote);

/* It computes for so long, as a head. */
void ledger_compute(struct ledger *ledger, uint32_t mote, double us);

/* Mote `sender` sends so many bytes to all, and each of `receivers` takes them. */
void ledger_broadcast(struct ledger *ledger, enum energy_cause cause, uint32_t sender, const uint32_t *receivers,
                      size_t count, unsigned payload);

/* ... to one neighbour, who acknowledges them. */
void ledger_unicast(struct ledger *ledger, enum energy_cause cause, uint32_t sender, uint32_t receiver,
                    unsigned payload);

/* All NaN without a profile. No mote dies. */
struct energy_totals ledger_totals(const struct ledger *ledger);

#endif
