/* What is charged when: keeps the ledger of a running network. Without a profile all of it does nothing. */
#ifndef MOTEHOUND_SIM_ENERGY_ACCOUNT_H
#define MOTEHOUND_SIM_ENERGY_ACCOUNT_H

#include "energy/energy.h"
#include "motehound/wire.h"
#include "radio/radio.h"
#include "scenario/scenario.h"

struct account {
    struct energy ledger;
    bool open; /* there is a profile */
    enum energy_cpu cpu;
    uint64_t sensing_us, sample_us, frame_us; /* what work takes */
    const char *tracker;
    uint32_t draws; /* of particles in one of its steps, if it has any */
    bool *measured; /* of each mote: what its processor does is measured */
};

/* All radios listen from time 0. `order`: as in struct energy_config. Returns 0, or -1 if there is no memory (nothing to close). */
int account_open(struct account *account, const struct scenario *scenario, const uint32_t *order, uint32_t motes,
                 uint32_t sink);

void account_close(struct account *account);

/* What frames with such a message are for; MH_MESSAGE_KINDS stands for unknown ones, which are booked as routing. */
enum energy_cause account_cause(enum mh_message_kind kind);

/* The radio changes its state, because of a frame for this cause. */
void account_radio(struct account *account, uint32_t mote, sim_time time, enum radio_state state, uint8_t cause);

/* The mote takes a sample. */
void account_sample(struct account *account, uint32_t mote, sim_time time);

/* Its processor handles a frame that it sends or has heard. */
void account_frame(struct account *account, uint32_t mote, sim_time time, enum energy_cause cause);

/* From now on mote `mote` is charged for its processor's work as it is measured, by account_work alone. */
void account_measured(struct account *account, uint32_t mote);

/* Its processor has worked so long for this cause. */
void account_work(struct account *account, uint32_t mote, sim_time time, enum energy_cause cause, uint64_t duration_us);

/* It computes a position. */
void account_step(struct account *account, uint32_t mote, sim_time time, int measurements);

#endif
