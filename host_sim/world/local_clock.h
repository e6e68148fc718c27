/* A mote's own clock: what it shows at a simulated time, and when it shows a given tick.
 *
 * At time t since the run began it shows t + offset + integral of its rate error, which is drift + wander x s(t). s is a sine's likeness made
 * of parabolic arcs, as the temperature drives a crystal, with the period below and a phase of the mote's own. A pure function of the
 * time, in IEEE arithmetic without any library function, so it is the same on every machine; it never runs backwards. */
#ifndef MOTEHOUND_SIM_WORLD_LOCAL_CLOCK_H
#define MOTEHOUND_SIM_WORLD_LOCAL_CLOCK_H

#include "engine/event_queue.h"
#include "motehound/ticks.h"

#include <stdbool.h>
#include <stdint.h>

#define LOCAL_CLOCK_WANDER_PERIOD_S 1800

/* All zero: an ideal clock, which shows the simulated time. */
struct local_clock {
    int64_t offset_us;   /* what it shows at time 0 */
    double drift_ppm;    /* constant part of its rate error, magnitude below 1000 */
    double wander_ppm;   /* amplitude of the slow part, 0 to 1000 */
    double wander_phase; /* where in its period the wander begins, 0 to 1 */
};

/* The clock of `mote`, drawn from the seed: offset uniform in +- offset_s, drift uniform in +- drift_ppm (as a crystal's data sheet gives
 * its tolerance), wander of exactly wander_ppm with a uniform phase. All three zero: an ideal clock. */
struct local_clock local_clock_draw(uint64_t seed, uint32_t mote, double offset_s, double drift_ppm, double wander_ppm);

/* The mote is powered up at `time`: the clock begins at zero, with the rate it has. An ideal clock stays ideal. */
void local_clock_restart(struct local_clock *clock, sim_time time);

bool local_clock_is_ideal(const struct local_clock *clock);

/* What the clock shows, in microseconds, at `time_us` of simulated time (negative: before the run). Never decreases with time. */
int64_t local_clock_us(const struct local_clock *clock, int64_t time_us);

/* The first simulated microsecond at which it shows `local_us` or more. Cost: a few evaluations of local_clock_us. */
int64_t local_clock_time_of_us(const struct local_clock *clock, int64_t local_us);

/* The whole tick that it shows. */
mh_tick local_clock_tick(const struct local_clock *clock, sim_time time);

/* The first simulated microsecond at which it shows `tick`, of all such the nearest to `now`; may be past, and negative. */
int64_t local_clock_time_of(const struct local_clock *clock, sim_time now, mh_tick tick);

#endif
