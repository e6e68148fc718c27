/* A scenario: everything that one simulation run is made of, as the YAML file gives it. Units stand in the names.
 *
 * The key of a member in a file or in --set is its path: scenario.source.speed_mps is `source.speed_mps`. keys.c holds
 * the one table of all keys with their defaults, ranges and meaning; `motehound list --keys` prints it. Errors are one
 * line in `error`: file, line, key and what was expected. */
#ifndef MOTEHOUND_SIM_SCENARIO_H
#define MOTEHOUND_SIM_SCENARIO_H

#include "energy/profile.h"
#include "motehound/acoustic.h"
#include "motehound/circles.h"
#include "motehound/election.h"
#include "motehound/fusion.h"
#include "motehound/group.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum path_kind {
    PATH_WAYPOINTS, /* straight legs between points, each leg at its own speed factor */
    PATH_ARCS,      /* two circular arcs of 90 degrees, turning left then right, from the first point to the second */
    PATH_STILL,     /* stays at the first point for duration_s */
    PATH_GAUSS_MARKOV, /* struct target's random walk for duration_s, its own for every seed */
    PATH_WHITE_ACCELERATION, /* at constant velocity but for struct target's accelerations, for duration_s, its own for every seed */
    PATH_NONE,               /* there is no source: for duration_s the nodes report synthetic traffic */
    PATH_SCRIPTED, /* the targets of `targets`, each on its own way */
    PATH_PARALLEL, /* target.count targets side by side; this and all below: world/targets.h */
    PATH_CROSSING,
    PATH_BOUNCE,
    PATH_LANES,
    PATH_TURN,
    PATH_RING,
    PATH_RANDOM,
    PATH_SCATTERED
};

struct waypoint {
    double x_m, y_m;
    double speed_factor; /* of the leg that ends here, times source.speed_mps; ignored for the first point */
};

/* One target of PATH_SCRIPTED. */
struct scripted_target {
    double start_s; /* it is there from source.start_s and this on, until the end of its way */
    double speed_mps;
    double loudness; /* as source.loudness */
    struct waypoint *points;
    unsigned points_count;
};

enum propagation_kind { PROPAGATION_DISC, PROPAGATION_LOG_DISTANCE };

enum sync_kind { SYNC_NONE, SYNC_FLOODING };

enum routing_kind { ROUTING_TREE, ROUTING_GEOGRAPHIC, ROUTING_GREEDY };

/* What sensors measure and trackers work on. */
enum quantity { QUANTITY_CONCENTRATION, QUANTITY_RANGE, QUANTITY_GAS, QUANTITY_SOUND };

/* Who follows the target next: firmware/election.h's rules of the protocol `cluster`, and those of `prince`. */
enum election_rule { ELECTION_PRINCE = MH_ELECTIONS, ELECTION_COMPETITION, ELECTION_TIMESTAMP };

enum resampling_kind { RESAMPLING_PRC, RESAMPLING_SYSTEMATIC };

enum layout_kind { LAYOUT_UNIFORM, LAYOUT_R2, LAYOUT_GRID, LAYOUT_HASHED, LAYOUT_FILE, LAYOUT_RINGS, LAYOUT_STRAT };

enum { SCENARIO_NUMBERS_MAX = 16, TARGETS_MAX = 16 };

struct number_list {
    double values[SCENARIO_NUMBERS_MAX];
    unsigned count;
};

struct scenario {
    char *name;        /* of the experiment */
    char *description; /* one sentence for `motehound list` */
    struct {
        double width_m, height_m; /* the field is [0, width] x [0, height] */
    } field;
    struct {
        enum path_kind path;
        struct waypoint *points;
        unsigned points_count;
        double speed_mps;
        double duration_s;        /* of PATH_STILL, PATH_GAUSS_MARKOV and PATH_NONE; 0: the path's own */
        double release_gps;       /* mean release rate mu */
        double release_variation; /* mu(t) = release (1 + variation sin(2 pi t / release_period)), 0 to 0.95 */
        double release_period_s;
        double diffusion_m2ps; /* D of the field (the tracker has its own) */
        double rate_mlps;      /* of QUANTITY_GAS: q ... */
        double mixing_m2ps;    /* ... and K, the air's turbulent diffusion */
        double fluctuation;    /* sd of what comes to a sensor, as a share of its mean */
        double start_s;  /* of PATH_SCRIPTED and what follows it: when targets begin, or scripted ones count from */
        double loudness; /* of QUANTITY_SOUND: energy of a target at sensor.range_m, in units of the threshold */
    } source;
    struct {
        double speed_mps, direction_rad; /* it blows towards, counter-clockwise from the x axis */
    } wind;
    struct {
        double speed_mph;                      /* mean speed of PATH_GAUSS_MARKOV */
        double speed_sd;                       /* of the speed, as a share of its mean */
        double heading_sd_rad;                 /* of the heading */
        double memory;                         /* of both from step to step: 0 draws them anew, 1 keeps them */
        double x_m, y_m, vx_mps, vy_mps;       /* mean start of PATH_WHITE_ACCELERATION ... */
        double position_sd_m, velocity_sd_mps; /* ... and sd of each coordinate */
        double acceleration_x_mps2, acceleration_y_mps2; /* sd of its accelerations */
        int64_t count;                                   /* of PATH_PARALLEL and what follows it */
        double spacing_m, apart_m; /* between neighbours; before and after, where they do not keep it */
        double turn_deg;
        int64_t turns;
    } target;
    struct scripted_target *targets; /* of PATH_SCRIPTED */
    unsigned targets_count;
    struct {
        int64_t nodes;
        enum layout_kind layout;
        char *file;       /* nodes.csv of LAYOUT_FILE, relative to the scenario */
        double spacing_m; /* of LAYOUT_GRID; 0: the nodes fill the field */
        double jitter;    /* of LAYOUT_GRID: share of a cell by which a node may stand off its middle */
        double
            density; /* mean number of nodes within sensor.range_m of a place, which then gives the field; 0: field.* does */
        double sink_x_m, sink_y_m;
        int64_t grid;   /* of LAYOUT_STRAT: cells along a side, which gives the number of nodes */
        int64_t starts; /* consecutive seeds that share a deployment, each with its own start of the search; 0: none */
        double start_m; /* these starts are farther than this from the source */
        char *protocol; /* collection, direct, cluster, prince, fixed, token or chatter */
        bool ideal;     /* clusters without frames: nothing is lost, collides or takes time */
    } network;
    struct {
        enum routing_kind routing;
        double hello_s;        /* between a node's hellos to its neighbours */
        unsigned election;     /* enum mh_election or election_rule */
        int64_t members;       /* of a cluster beside its head; 0: the election rule's own number */
        int64_t horizon;       /* predicted samples that an election looks at */
        int64_t least_answers; /* fewer than so many nodes that measure the target bring about an election */
        int64_t start;         /* token: the node that begins, unless network.starts chooses */
        int64_t heads_max;     /* token: the search ends after so many heads ... */
        int64_t calm;          /* ... or when so many in succession find nothing new */
        double watch_s;        /* a node that has heard of no track for a while looks for a target itself this often */
        unsigned guards;       /* prince: 1 with the guards against turns and losses, 0 without */
        bool entries;          /* prince: nodes around where targets begin expect them */
        int64_t replies;       /* prince: a query is content with so many */
        double lead_m;         /* prince: the next fix is due after about this way */
        bool farthest;         /* prince: ... or as late as can be */
    } protocol;
    struct {
        struct number_list nodes;             /* of each cluster of LAYOUT_RINGS */
        double ring_m;                        /* radius */
        struct number_list range_variance_m2; /* of each cluster's sensors */
        int64_t every;                        /* sampling instants between samples of the fastest nodes */
        int64_t rates;                        /* the slowest take so many times as long */
        int64_t shared;                       /* nodes of the next cluster that one hears too */
    } clusters;
    struct {
        enum mh_fusion_rule rule;
        double report_s;    /* between reports of the clusters to the centre */
        double report_loss; /* probability that one is lost; of an ideal network */
        double wait_s;      /* the centre waits for reports so long */
        double keep_s;      /* a silent cluster's last report is predicted for so long */
    } fusion;
    struct {
        int64_t sources; /* nodes that report once in sensor.interval_s where source.path is none */
    } traffic;
    struct {
        enum quantity quantity;          /* what is measured */
        double interval_s;               /* between samples, T */
        double relative_noise;           /* sd as a share of the reading */
        double additive_noise;           /* sd, g/m2 */
        int64_t adc_bits;                /* 0: an ideal converter */
        double full_scale;               /* of the converter, g/m2 */
        double loss;                     /* probability that a reading never comes */
        double outage_start_s, outage_s; /* no reading of any node comes in this time; 0, 0 for none */
        double range_m;                  /* of QUANTITY_RANGE: how far a target is detected */
        double range_noise_m;            /* sd of a range */
        double noise_correlation;        /* of the noise of two ranges of an instant */
        bool noisy_detection;            /* by the noisy range, not the true one */
        double source_noise;             /* of QUANTITY_SOUND: tau ... */
        double background_noise;         /* ... and eta */
        double noise_ppm;                /* of QUANTITY_GAS: sd */
        double unit_ppm;                 /* concentration that is 1 in what the sensor gives */
    } sensor;
    struct {
        double range_m;     /* unit disc */
        double delay_s;     /* of one hop, besides the air time */
        double bitrate_bps; /* gives the air time */
        double loss;        /* probability that a frame is lost, each receiver independently */
        double burst_loss, burst_good_s,
            burst_bad_s; /* the same in bursts; mean duration of what they last and the time between */
        char *profile;   /* ideal, 802154 or cc1000 */
        enum propagation_kind propagation;
        double path_loss_exponent, reference_loss_db; /* of the path; loss at 1 m */
        double shadowing_db;                          /* standard deviation */
        double power_dbm, sensitivity_dbm;            /* sensitivity 0: the profile's */
        int64_t retries, backoffs;                    /* -1: the profile's */
        int64_t queue;                                /* frames a radio holds */
        double wake_period_s, wake_length_s;          /* of a radio that sleeps; period 0: it does not wake */
    } radio;
    struct {
        double every_s; /* all faults come again with this period, and then hit other motes; 0: once */
        struct {
            double share, from_s, for_s; /* share of the motes, from when on, for how long; so below */
        } stuck;
        struct {
            double share, from_s, for_s, chance, height; /* of a reading; g/m2 */
        } spike;
        struct {
            double share, from_s, for_s, at; /* g/m2 */
        } saturate;
        struct {
            double share, from_s, for_s, offset; /* g/m2 */
        } bias;
        struct {
            double share, from_s;
        } dead;
        struct {
            double share, from_s, for_s;
        } reboot;
        struct {
            double from_s, for_s, x_m, y_m, angle_rad; /* the line through (x, y) */
        } partition;
        struct {
            double from_s, for_s;
        } mute;
        struct {
            double from_s, for_s, x_m, y_m, radius_m;
        } jam;
    } faults;
    struct {
        double drift_ppm, offset_s, wander_ppm; /* of the motes' clocks: local_clock.h */
        enum sync_kind sync;
        double sync_period_s;
    } clock;
    struct {
        char *name; /* diffusion, luo, range, pftl, msl or centroid */
        double diffusion_m2ps;
        double chi;
        double release_gps;              /* diffusion: expected release rate */
        double additive_sd, relative_sd; /* diffusion: assumed noise */
        double forgetting;               /* luo */
        bool nonlinear;                  /* luo */
        double range_sd_m;               /* of a range; 0: the sensor's in a simulation, 0.3 of a recording */
        double bias_sd_m, scale_sd;      /* range */
        double acceleration_sd_mps2;     /* range; 0: that of the target's walk, 1 where there is none */
        double height_m;                 /* range */
        double speed_mps, speed_sd_mps;  /* of the target, as the tracker knows it; 0: as it is */
        double tolerance_m;              /* the sink may be this much off before it is told */
        int64_t particles;               /* pftl, msl */
        enum resampling_kind resampling; /* pftl */
        bool literal;                    /* pftl: the region widens as published */
        double ukf_alpha;                /* cv_ukf, gas_ukf: spread of the sigma points */
        double ukf_beta;                 /* gas_ukf */
        /* gas, where the wind is measured and the leak is at one of several places: the air's mixing length K / u, sd of the plume's axis about the
         * wind, the share of a sensor's readings below its background and how fast that may move, ppm/h, how long it is learned, for how long readings are
         * remembered and how long their errors stay alike, and the sd of the leak about its place */
        double mixing_m, wind_sd_rad, background_quantile, background_ppmph, learn_s, memory_s, correlation_s,
            place_sd_m;
        double window_s; /* reports are waited for this long after a sampling instant; 0: half the interval */
        double prior_x_m, prior_y_m, prior_sd_x_m,
            prior_sd_y_m; /* gas: where the source is expected; 0, 0, 0, 0: the field */
        double prior_rate_mlps, prior_rate_sd_mlps;
        double wind_scale, wind_off_rad; /* gas: the wind as the tracker has it, from what it is */
        double noise_ppm;                /* gas: assumed noise; 0: the sensor's */
        double calm_step_m, calm_sd_m;   /* gas: an estimate that is calm */
        int64_t intervals;               /* dm: of the table of distances; 0: the distance itself */
        enum mh_circles_variant variant; /* dm: of three circles */
        enum mh_separation separation;   /* acoustic, dm, ml: of several targets' sounds */
        double share_range_m;            /* decomposition: targets farther from a node have no share; 0: 3 R */
        int64_t strongest;               /* acoustic, dm, ml: nodes that a fix is made from; 0: all */
        bool filtered;                   /* acoustic, dm, ml */
        enum mh_group_mode groups;       /* acoustic, dm: targets that are near each other */
    } tracker;
    struct {
        enum energy_cpu cpu; /* what work costs the processor */
        char *profile;       /* which mote's currents; `none`: energy is not accounted for */
        double battery_j;    /* that each mote has; 0: on mains */
        bool sink_mains;     /* the sink has no battery, and its energy is left out of the totals */
    } energy;
    struct {
        int64_t skip_first;     /* estimates of each track left out of the error metrics */
        double lost_m;          /* a track is lost when its error exceeds this ... */
        int64_t lost_samples;   /* ... in so many successive samples */
        double mote_interval_s; /* between the states of the motes on a bus; 0: never */
        double clock_settle_s;  /* errors of clocks count from then on */
    } metrics;
    struct {
        char *key; /* what `motehound run --sweep` varies; empty for nothing */
        char **values;
        unsigned values_count;
    } sweep;
};

/* All keys at their defaults. Returns 0, or -1 if there is no memory. */
int scenario_init(struct scenario *scenario);

/* Release what the scenario holds; it may be all zero bytes. */
void scenario_free(struct scenario *scenario);

/* Apply a YAML document to `scenario`, which scenario_init has filled; `name` stands for the file in errors. Returns 0,
 * or -1 with one line in `error` (the scenario is then half filled, and to be freed). */
int scenario_parse(const char *yaml, size_t length, const char *name, struct scenario *scenario, char *error,
                   size_t error_size);

/* scenario_parse of the file at `path`. A relative network.file is taken from the scenario file's own folder. */
int scenario_load(const char *path, struct scenario *scenario, char *error, size_t error_size);

/* Set one key from text, as --set does: numbers, words, `source.points` as `x,y[,factor]; ...`,
 * `targets` as `start_s,speed_mps,loudness: points | ...`, `sweep.values` as `a,
 * b, ...`. An unknown key's error names the nearest known one. Returns 0, or -1 with one line in `error` and the
 * scenario as it was. */
int scenario_set(struct scenario *scenario, const char *path, const char *value, char *error, size_t error_size);

/* What only holds between keys: at least four nodes, a path with its points, an outage inside the run, the sink in the
 * field. Returns 0, or -1 with one line in `error`; `name` stands for the file. */
int scenario_check(const struct scenario *scenario, const char *name, char *error, size_t error_size);

/* Where the nodes are laid out and where the sink stands. */
struct scenario_field {
    double width_m, height_m;
    double sink_x_m, sink_y_m;
};

/* As field.* and network.sink_* say; but where there is a network.density, the field is a square of side
 * sensor.range_m sqrt(nodes pi / density) with the sink in its middle. */
struct scenario_field scenario_field(const struct scenario *scenario);

/* Where a leak is expected and what it releases, as tracker.prior_* say; where they are 0, anywhere in the field. */
struct scenario_prior {
    double x_m, y_m, sd_x_m, sd_y_m;
    double rate, rate_sd; /* mL/s */
};

struct scenario_prior scenario_prior(const struct scenario *scenario);

/* Sensor nodes: network.nodes, or those of network.grid. */
size_t scenario_nodes(const struct scenario *scenario);

/* Whole sampling intervals in source.duration_s. */
size_t scenario_steps(const struct scenario *scenario);

/* The part of it that a replay needs, where there is no source and no deployment. */
int scenario_check_tracking(const struct scenario *scenario, const char *name, char *error, size_t error_size);

#endif
