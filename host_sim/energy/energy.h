/* What each mote has used, by what it was doing (state) and what for (cause), and the batteries that empty.
 *
 * The radio is in one state at any time, and draws that state's power from the change to it until the next; the idle
 * processor draws beside it. One that sleeps may open for a short window once in a period: then it listens, idly. Sensing and processing come on
 * top, charged whole when they begin. The ledger counts microseconds, and powers are whole microwatts, so all sums are exact in integers (1 uW for 1
 * us is 1 pJ).
 *
 * A change of state costs a few ns, however many windows have passed; a mote takes sizeof(struct energy_mote) = 272 bytes. */
#ifndef MOTEHOUND_SIM_ENERGY_H
#define MOTEHOUND_SIM_ENERGY_H

#include "energy/profile.h"
#include "engine/event_queue.h"

#include <stdbool.h>
#include <stdint.h>

enum energy_state {
    ENERGY_SLEEP, /* states of the radio ... */
    ENERGY_LISTEN,
    ENERGY_RECEIVE,
    ENERGY_TRANSMIT, /* ... until here */
    ENERGY_CPU,
    ENERGY_SENSING,
    ENERGY_STATES,
    ENERGY_OFF = ENERGY_STATES /* the mote is off: draws nothing */
};

enum energy_cause {
    ENERGY_IDLE,         /* nothing: waiting, sleeping */
    ENERGY_LOCALISATION, /* sampling, computing a position */
    ENERGY_MEASURING,    /* asking for readings, and answers */
    ENERGY_CLUSTERING,   /* forming clusters, handing tracks over */
    ENERGY_REPORTING,    /* carrying readings and positions to where they are wanted */
    ENERGY_ROUTING,      /* finding ways and neighbours */
    ENERGY_TIME,         /* keeping clocks together */
    ENERGY_CAUSES
};

/* As in the metrics: "sleep", "localisation" ... */
extern const char *const energy_state_names[ENERGY_STATES];
extern const char *const energy_cause_names[ENERGY_CAUSES];

/* Sleeping is idle and sensing is localisation, whatever cause is said: one cell each. The other states have one a cause. */
enum { ENERGY_CELLS = 2 + 4 * ENERGY_CAUSES };

struct energy_mote {
    sim_time since;  /* the radio is in its state; for a dead mote: its death */
    int64_t left_pj; /* in the battery; on mains more than can be used */
    uint32_t next_dead;
    uint8_t state, cell; /* of the radio now, and where its time goes */
    bool dead, mains;
    uint64_t
        time_us[ENERGY_CELLS + 1]; /* those of receiving and of listening idly first: they change most; the last: off */
};

struct energy_config {
    const struct energy_profile *profile;
    double power_dbm; /* of the radio */
    sim_time wake_period,
        wake_length;   /* a radio that sleeps listens in [k period, k period + length); 0, 0: it does not */
    double battery_j;  /* 0: all motes are on mains; at most 1e6 */
    uint32_t on_mains; /* the one mote that has no battery and is left out of the totals; UINT32_MAX: none */
    /* Mote i's part of the ledger is its order[i]-th, a permutation that outlives it: those whose radios change together lie side by
     * side. NULL: the i-th. */
    const uint32_t *order;
};

struct energy {
    const struct energy_profile *profile;
    struct energy_mote *motes;
    const uint32_t *order;
    uint32_t count, on_mains;
    uint32_t power_uw[ENERGY_STATES + 1]; /* on top of cpu_idle_uw, which every state but off draws */
    uint32_t cpu_idle_uw;
    int64_t battery_pj;
    sim_time wake_period, wake_length;
    struct event_queue checks; /* when each battery could be empty at the earliest */
    uint32_t first_dead;       /* a list, through next_dead, of those not yet told */
    uint32_t last_dead;
};

/* All motes off, batteries full. Returns 0, or -1 if there is no memory (nothing to free). */
int energy_make(struct energy *energy, const struct energy_config *config, uint32_t count);

void energy_free(struct energy *energy);

/* The radio of mote `index` is in `state` (up to ENERGY_TRANSMIT, or ENERGY_OFF) from `time` on, which is not before the last
 * change. Ignored for the dead. */
void energy_radio(struct energy *energy, uint32_t index, sim_time time, enum energy_state state,
                  enum energy_cause cause);

/* ENERGY_CPU or ENERGY_SENSING for so long, beginning at `time`. Ignored for the dead and for those who are off. */
void energy_charge(struct energy *energy, uint32_t index, sim_time time, enum energy_state state,
                   enum energy_cause cause, uint64_t duration_us);

/* When energy_run is to be called again, at the latest; SIM_TIME_NEVER if no battery can empty any more. */
sim_time energy_next(const struct energy *energy);

/* Tell of each mote whose battery has been found empty by `now`, once; `at` is when it was, to the microsecond. It is
 * found within 1 ms of that, or as much later as one piece of work takes. */
void energy_run(struct energy *energy, sim_time now, void (*dies)(void *context, uint32_t mote, sim_time at),
                void *context);

bool energy_is_dead(const struct energy *energy, uint32_t mote);

/* Neither dead nor switched off. */
bool energy_is_on(const struct energy *energy, uint32_t mote);

/* What mote `index` has used until `now`, J. */
void energy_of_mote(const struct energy *energy, uint32_t index, sim_time now,
                    double joules[ENERGY_STATES][ENERGY_CAUSES]);

double energy_used_j(const struct energy *energy, uint32_t index, sim_time now);

/* Share of the battery that is left, 1 on mains. */
double energy_battery_left(const struct energy *energy, uint32_t index, sim_time now);

struct energy_totals {
    double joules[ENERGY_STATES][ENERGY_CAUSES];
    double hottest_j; /* what the mote used that used most */
    uint32_t dead;
    double lifetime_s, lifetime_half_s; /* until the first, and half of the motes with batteries died; else NaN */
};

/* Totals of a run whose energy is not accounted for. */
struct energy_totals energy_total_unknown(void);

/* Of all motes but the one on mains. Returns 0, or -1 if there is no memory. */
int energy_total(const struct energy *energy, sim_time now, struct energy_totals *totals);

#endif
