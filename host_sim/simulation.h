/* One run: builds the world and the motes of a scenario, runs them in simulated time and tells an observer what happens. */
#ifndef MOTEHOUND_SIM_SIMULATION_H
#define MOTEHOUND_SIM_SIMULATION_H

#include "bounds/bounds.h"
#include "energy/energy.h"
#include "motehound/mote.h"
#include "radio/loss.h"
#include "scenario/recording.h"
#include "scenario/scenario.h"

#include <signal.h>

/* Where the source truly is, and what it does. */
struct truth {
    double time_s, x_m, y_m;
    bool present; /* it is on its way (it has begun and not ended); else all but the time is 0 */
    double vx_mps, vy_mps;
    uint32_t target; /* number of the target, from 0 */
    double rate;     /* at which it releases, in the unit of an estimate's: mL/s of gas; 0 where no estimate has one */
};

/* How the nodes around a target stand, as its new head tells them. */
struct watch_news {
    uint32_t target;         /* its identifier in the network */
    uint32_t number;         /* of the target, from 0; UINT32_MAX: of none, or of a group */
    mh_node_id head, prince; /* prince MH_BROADCAST: none */
    double prince_s;         /* when the target enters the prince's sensing range */
    double x_m, y_m, vx_mps, vy_mps,
        sd_m;         /* the target now, as the head has it; both velocities 0, sd NaN: not known */
    double extent_m;  /* of a group, else 0 */
    unsigned members; /* of a group, else 1 */
};

/* How a mote is. */
struct mote_state {
    double energy_mj;    /* used so far */
    double battery_left; /* share, 1 on mains */
    bool alive;
    double clock_error_ms; /* its network time minus the true one */
};

/* What a run tells. Any of the functions may be NULL. Called in the order of simulated time. */
struct observer {
    void *context;
    /* Once for every mote, before all else: the nodes by id, then the sink, whose id is the largest. */
    void (*node)(void *context, mh_node_id id, const struct mh_place *place);
    /* At every sampling instant, for each target. */
    void (*truth)(void *context, const struct truth *truth);
    /* Mote `head` has a position, told at time_s. `at_time`: truth at the sampling instant estimate->time, whose time in
     * seconds is at_time->time_s. `at_arrival`: truth at that instant less the estimate's age. Neither is NULL. */
    void (*estimate)(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                     const struct truth *at_time, const struct truth *at_arrival);
    /* With clusters, at every sampling instant once the sink knows of the track: where it has the target at estimate->time, after what was
     * reported for that instant; only time, position, velocity and target count. */
    void (*sink)(void *context, double time_s, const struct mh_estimate *estimate, const struct truth *at_time);
    /* With fixed clusters, what cluster `cluster`, from 0, has by itself whenever it tells the fusion centre, by its node `head`; the sink's estimates are then the
     * centre's. */
    void (*local)(void *context, double time_s, uint8_t cluster, mh_node_id head, const struct mh_estimate *estimate,
                  const struct truth *at_time);
    /* Who follows a track from now on: its head and those that it asks. `is_new`: it counts as a cluster formed. */
    void (*cluster)(void *context, double time_s, uint32_t track, mh_node_id head, const mh_node_id *members,
                    size_t count, bool is_new);
    /* By the protocol `prince`: a new head tells those around it of its target. */
    void (*watch)(void *context, double time_s, const struct watch_news *watch);
    /* A frame goes on the air. */
    void (*frame)(void *context, double time_s, mh_node_id sender, mh_node_id destination, const uint8_t *bytes,
                  size_t length);
    /* Every mote, by id and the sink last, each metrics.mote_interval_s. */
    void (*mote)(void *context, double time_s, mh_node_id id, const struct mote_state *state);
};

/* What became of the clusters of a run. */
struct cluster_counters {
    bool present; /* there are clusters; else all is 0 */
    struct mh_cluster_counters total;
};

/* Totals of a run, beside what the observer was told. */
struct simulation_counters {
    uint64_t events;  /* that motes handled: readings, frames heard, fates of frames, alarms ... */
    uint64_t windows; /* of simulated time that the motes were run through together */
    uint64_t samples; /* sampling instants while the source was present */
    uint64_t frames_sent[MH_MESSAGE_KINDS + 1]; /* by kind; the last: of none of the library's */
    uint64_t frames_received, frames_lost;      /* receptions; the last one is the sum over the reasons at a receiver */
    uint64_t
        double_heads; /* prince: heads that were told of a target's generation that had one, whether or not they ever heard of each other */
    uint64_t frames_lost_by[LOSS_REASONS], frames_repeated, frames_duplicate;
    struct mh_mote_counters motes; /* summed over all motes */
    struct mh_head_counters head;
    struct mh_protocol_counters protocol; /* summed over all motes */
    struct cluster_counters clusters;
    struct energy_totals energy; /* all NaN where energy is not accounted for */
    /* of the motes' network time, once it has settled; NaN where clocks are ideal */
    double clock_error_median_ms, clock_error_p99_ms, clock_known_share;
    struct bounds bounds; /* filled by bounds_of, not by the run */
};

/* Run `scenario` with `seed`. Deterministic: the same scenario, seed and library give the same calls. `stop` (may be NULL) is
 * looked at between windows: when it becomes nonzero the run ends early. Returns 0, or -1 with one line in `error`: a
 * deployment file that cannot be read, a run that was stopped, no memory. Thread-safe: runs share nothing. */
int simulation_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                   const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                   size_t error_size);

struct host_provider;

/* The same with the motes where `hosts` says (hosts/host.h; NULL: in this process). The calls are the same wherever that is. */
int simulation_run_on(const struct host_provider *hosts, const struct scenario *scenario, uint64_t seed,
                      const struct observer *observer, const volatile sig_atomic_t *stop,
                      struct simulation_counters *counters, char *error, size_t error_size);

/* Feed a recording through the same motes: its nodes and readings instead of the scenario's field, deployment and sensor.
 * scenario->sensor.interval_s is the sampling interval (0: recording->interval_s); sampling instants are the first reading's time and
 * whole intervals from it. Times that the observer hears are the recording's. Every node is one hop from the sink. The truth, where the recording has one, is interpolated linearly between
 * its rows and present from the first to the last; without one, `present` is always false. As simulation_run otherwise. */
int simulation_replay(const struct scenario *scenario, const struct recording *recording, uint64_t seed,
                      const struct observer *observer, const volatile sig_atomic_t *stop,
                      struct simulation_counters *counters, char *error, size_t error_size);

#endif
