#include "trackers.h"

#include "radio/radio.h"
#include "reals.h"
#include "roster.h"
#include "world/mobility.h"
#include "world/targets.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static mh_tick ticks(double seconds) { return (mh_tick)lround(seconds * MH_TICKS_PER_S); }

/* ---- trackers that exist in both arithmetics ---- */

/* C of source.loudness. */
static mh_real loudness_of(const struct scenario *scenario)
{
    return real_of(scenario->source.loudness * scenario->sensor.range_m * scenario->sensor.range_m);
}

static void set_up_centroid(struct tracker_choice *choice, const struct scenario *scenario,
                            const struct mh_region *region)
{
    (void)region;
    mh_centroid_config_default(&choice->config.centroid);
    choice->config.centroid.sensing_range_m = real_of(scenario->sensor.range_m);
    if (scenario->sensor.quantity == QUANTITY_SOUND) {
        choice->measures = QUANTITY_SOUND;
        choice->config.centroid.strongest = 3; /* Han 2.1 */
    }
}

static void set_up_luo(struct tracker_choice *choice, const struct scenario *scenario, const struct mh_region *region)
{
    struct mh_luo_config *config = &choice->config.luo;
    mh_luo_config_default(config);
    config->diffusion_m2ps = real_of(scenario->tracker.diffusion_m2ps);
    config->chi = real_of(scenario->tracker.chi);
    config->forgetting = real_of(scenario->tracker.forgetting);
    config->nonlinear = scenario->tracker.nonlinear;
    if (region) {
        config->stop_outside = true;
        config->region = *region;
    }
}

/* What a tracker knows of the target: what the scenario tells it, or else how it is. Where it comes from a recording there is no `region`, and
 * nothing is known. */
struct known_target {
    double range_sd_m, acceleration_sd_mps2, height_m, speed_mps, speed_sd_mps;
};

static struct known_target target_of(const struct scenario *scenario, const struct mh_region *region)
{
    const bool walks = region && scenario->source.path == PATH_GAUSS_MARKOV;
    const struct mobility walk = mobility_of(scenario);
    const double smallest_sd_m = 0.01; /* of a sensor without noise */
    const double least_mps2 = 1e-3;    /* of a walk that never turns */
    struct known_target target = {.range_sd_m = region ? fmax(scenario->sensor.range_noise_m, smallest_sd_m) : 0.3,
                                  .acceleration_sd_mps2 = 1,
                                  .height_m = region ? 0 : scenario->tracker.height_m,
                                  .speed_mps = walks    ? walk.speed_mps
                                               : region ? scenario->source.speed_mps
                                                        : 1};
    if (walks) {
        /* a step changes each coordinate of the velocity by half the variance of the step's changes along and across the way */
        const double blur_sq = 1 - walk.memory * walk.memory;
        const double along = walk.speed_sd_mps, across = walk.heading_sd_rad * walk.speed_mps;
        const double acceleration = sqrt(blur_sq * (along * along + across * across) / 2 / walk.interval_s);
        target.acceleration_sd_mps2 = fmax(acceleration, least_mps2);
    }
    if (scenario->tracker.range_sd_m > 0) {
        target.range_sd_m = scenario->tracker.range_sd_m;
    }
    if (scenario->tracker.acceleration_sd_mps2 > 0) {
        target.acceleration_sd_mps2 = scenario->tracker.acceleration_sd_mps2;
    }
    if (scenario->tracker.speed_mps > 0) {
        target.speed_mps = scenario->tracker.speed_mps;
    }
    target.speed_sd_mps = scenario->tracker.speed_sd_mps > 0 ? scenario->tracker.speed_sd_mps
                          : walks                            ? scenario->target.speed_sd * target.speed_mps
                                                             : 0.2 * target.speed_mps;
    return target;
}

static uint32_t draws_of_pftl(const void *state) { return ((const struct mh_pftl *)state)->draws; }

static void set_up_pftl(struct tracker_choice *choice, const struct scenario *scenario, const struct mh_region *region)
{
    const struct known_target target = target_of(scenario, region);
    struct mh_pftl_config *config = &choice->config.pftl;
    mh_pftl_config_default(config);
    choice->seed = &config->seed;
    choice->draws = draws_of_pftl;
    config->speed_mps = real_of(target.speed_mps);
    config->speed_sd_mps = real_of(target.speed_sd_mps);
    config->sensing_range_m = real_of(scenario->sensor.range_m);
    config->range_sd_m = real_of(target.range_sd_m);
    config->tolerance_m = real_of(scenario->tracker.tolerance_m);
    config->particles = (uint16_t)scenario->tracker.particles;
    config->literal = scenario->tracker.literal;
    config->systematic = scenario->tracker.resampling == RESAMPLING_SYSTEMATIC;
}

static void set_up_acoustic(struct tracker_choice *choice, const struct scenario *scenario,
                            const struct mh_region *region)
{
    const bool joint = choice->tracker->join != NULL; /* one fit for all, and groups */
    const double least = 1e-3, slowest_mps = 0.1;     /* of a sensor without noise; what the tracker bears */
    struct mh_acoustic_config *config = &choice->config.acoustic;
    mh_acoustic_config_default(config, real_of(scenario->sensor.range_m));
    config->sound.loudness_m2 = loudness_of(scenario);
    config->sound.source_sd = real_of(scenario->sensor.source_noise);
    config->sound.background_sd = real_of(fmax(scenario->sensor.background_noise, least));
    config->variant = scenario->tracker.variant;
    config->intervals = (uint8_t)scenario->tracker.intervals;
    config->strongest = (uint8_t)(scenario->tracker.strongest > 0 ? scenario->tracker.strongest : UINT8_MAX);
    config->separation = scenario->tracker.separation == MH_SEPARATION_JOINT && !joint ? MH_SEPARATION_DECOMPOSITION
                                                                                       : scenario->tracker.separation;
    if (scenario->tracker.share_range_m > 0) {
        config->share_range_m = real_of(scenario->tracker.share_range_m);
    }
    config->filtered = scenario->tracker.filtered;
    config->mirror_check = scenario->protocol.guards > 0;
    config->speed_mps = real_of(fmax(target_of(scenario, region).speed_mps, slowest_mps));
    mh_group_config_default(&config->group, scenario->tracker.groups);
}

/* ---- trackers that need float ---- */

#if MH_REAL_FIXED
#define FLOAT_ONLY(tracker, set_up) NULL, NULL

mh_tick tracker_tell_clusters(struct tracker_choice *choice, const struct clusters *clusters)
{
    (void)choice;
    (void)clusters;
    return 0;
}

void centre_choose(const struct scenario *scenario, size_t count, struct centre_choice *choice)
{
    (void)scenario;
    (void)count;
    choice->centre = NULL;
}

#else
#define FLOAT_ONLY(tracker, set_up) &(tracker), (set_up)

static void set_up_diffusion(struct tracker_choice *choice, const struct scenario *scenario,
                             const struct mh_region *region)
{
    struct mh_diffusion_config *config = &choice->config.diffusion;
    mh_diffusion_config_default(config);
    config->diffusion_m2ps = real_of(scenario->tracker.diffusion_m2ps);
    config->chi = real_of(scenario->tracker.chi);
    config->release_gps = real_of(scenario->tracker.release_gps);
    config->additive_sd = real_of(scenario->tracker.additive_sd);
    config->relative_sd = real_of(scenario->tracker.relative_sd);
    if (region) {
        config->region = *region;
    }
}

static void set_up_range(struct tracker_choice *choice, const struct scenario *scenario, const struct mh_region *region)
{
    const struct known_target target = target_of(scenario, region);
    struct mh_range_config *config = &choice->config.range;
    mh_range_config_default(config);
    config->range_sd_m = real_of(target.range_sd_m);
    config->bias_sd_m = real_of(scenario->tracker.bias_sd_m);
    config->scale_sd = real_of(scenario->tracker.scale_sd);
    config->acceleration_sd_mps2 = real_of(target.acceleration_sd_mps2);
    config->speed_mps = real_of(target.speed_mps);
    config->height_m = real_of(target.height_m);
    config->sensing_range_m = region ? real_of(scenario->sensor.range_m) : 0;
    config->tolerance_m = real_of(scenario->tracker.tolerance_m);
}

static uint32_t draws_of_msl(const void *state) { return ((const struct mh_msl *)state)->draws; }

static void set_up_msl(struct tracker_choice *choice, const struct scenario *scenario, const struct mh_region *region)
{
    const struct known_target target = target_of(scenario, region);
    struct mh_msl_config *config = &choice->config.msl;
    mh_msl_config_default(config);
    choice->seed = &config->seed;
    choice->draws = draws_of_msl;
    config->speed_mps = real_of(target.speed_mps);
    config->speed_sd_mps = real_of(target.speed_sd_mps);
    config->sensing_range_m = real_of(scenario->sensor.range_m);
    config->particles = (uint16_t)scenario->tracker.particles;
}

/* As the target moves, and at its height: fixed clusters and their centre know all of that. */
static struct mh_white_acceleration motion_of(const struct scenario *scenario)
{
    const double x = scenario->target.acceleration_x_mps2, y = scenario->target.acceleration_y_mps2;
    return (struct mh_white_acceleration){.tick = (mh_tick)lround(scenario->sensor.interval_s * MH_TICKS_PER_S),
                                          .variance = {real_of(x * x), real_of(y * y)}};
}

/* Mean and packed covariance of the start, (x, vx, y, vy). */
static void start_of(const struct scenario *scenario, mh_real *mean, mh_real *covariance)
{
    const double means[MH_CV_STATES] = {scenario->target.x_m, scenario->target.vx_mps, scenario->target.y_m,
                                        scenario->target.vy_mps};
    const double sds[2] = {scenario->target.position_sd_m, scenario->target.velocity_sd_mps};
    for (int i = 0; i < MH_PACKED_SIZE(MH_CV_STATES); i++) {
        covariance[i] = 0;
    }
    for (int i = 0; i < MH_CV_STATES; i++) {
        mean[i] = real_of(means[i]);
        covariance[MH_PACKED(i, i)] = real_of(sds[i % 2] * sds[i % 2]);
    }
}

static void set_up_cv(struct tracker_choice *choice, const struct scenario *scenario, const struct mh_region *region)
{
    const struct known_target target = target_of(scenario, region);
    struct mh_cv_config *config = &choice->config.cv;
    mh_cv_config_default(config);
    config->motion = motion_of(scenario);
    start_of(scenario, config->mean, config->covariance);
    config->variance = real_of(target.range_sd_m * target.range_sd_m);
    config->origin.z_mm = (int32_t)lround(1000 * target.height_m);
    config->alpha = real_of(scenario->tracker.ukf_alpha);
    if (scenario->fusion.rule != MH_FUSION_CENTRAL) {
        config->summary = mh_summary_kind_of(scenario->fusion.rule);
    }
}

static void set_up_gas(struct tracker_choice *choice, const struct scenario *scenario, const struct mh_region *region)
{
    const double towards_rad = scenario->wind.direction_rad + scenario->tracker.wind_off_rad;
    const double least = 1e-6; /* of its unit: what the sensor resolves */
    const double noise_ppm = scenario->tracker.noise_ppm > 0 ? scenario->tracker.noise_ppm : scenario->sensor.noise_ppm;
    struct mh_gas_config *config = &choice->config.gas;
    mh_gas_config_default(config);
    config->plume.diffusion_m2ps = real_of(scenario->source.mixing_m2ps);
    config->plume.wind_mps = real_of(scenario->wind.speed_mps * scenario->tracker.wind_scale);
    config->plume.downwind.x = real_of(cos(towards_rad));
    config->plume.downwind.y = real_of(sin(towards_rad));
    config->unit = real_of(scenario->sensor.unit_ppm);
    config->noise = real_of(fmax(noise_ppm / scenario->sensor.unit_ppm, least));
    config->ukf.alpha = real_of(scenario->tracker.ukf_alpha);
    config->ukf.beta = real_of(scenario->tracker.ukf_beta);
    config->calm_step_m = real_of(scenario->tracker.calm_step_m);
    config->calm_sd_m = real_of(scenario->tracker.calm_sd_m);
    const struct scenario_prior prior = scenario_prior(scenario);
    config->prior = place_from_metres(prior.x_m, prior.y_m, 0);
    config->prior_sd_m.x = real_of(prior.sd_x_m);
    config->prior_sd_m.y = real_of(prior.sd_y_m);
    config->prior_rate = real_of(prior.rate);
    config->prior_rate_sd = real_of(prior.rate_sd);
    if (region) {
        config->area = *region;
    }
}

/* Where the leak can be, as the recording says, or else the middles of the cells of a grid. Returns the sd of the leak about its place. */
static double set_places(struct mh_gas_wind_config *config, const struct recording *recording, double place_sd_m)
{
    config->place_count = (uint16_t)recording->candidate_count;
    for (uint16_t i = 0; i < config->place_count; i++) {
        config->places[i] = place_from_metres(recording->candidates[i].x_m, recording->candidates[i].y_m, 0);
    }
    if (config->place_count > 0) {
        return place_sd_m;
    }
    const int side = (int)sqrt(MH_LEAK_PLACES_MAX);
    const struct recorded_node *nodes = recording->nodes;
    double x_min = nodes[0].x_m, x_max = x_min, y_min = nodes[0].y_m, y_max = y_min;
    for (size_t i = 1; i < recording->node_count; i++) {
        x_min = fmin(x_min, nodes[i].x_m);
        x_max = fmax(x_max, nodes[i].x_m);
        y_min = fmin(y_min, nodes[i].y_m);
        y_max = fmax(y_max, nodes[i].y_m);
    }
    const double width_m = (x_max - x_min) / side, height_m = (y_max - y_min) / side;
    for (int i = 0; i < side; i++) {
        for (int j = 0; j < side; j++) {
            config->places[config->place_count++] =
                place_from_metres(x_min + (i + 0.5) * width_m, y_min + (j + 0.5) * height_m, 0);
        }
    }
    return fmax(place_sd_m, sqrt((width_m * width_m + height_m * height_m) / 24)); /* even over a cell */
}

static void set_up_gas_wind(struct tracker_choice *choice, const struct scenario *scenario,
                            const struct recording *recording, double interval_s)
{
    const double unit_ppm = scenario->sensor.unit_ppm, hours = interval_s / 3600;
    struct mh_gas_wind_config *config = &choice->config.gas_wind;
    *choice = (struct tracker_choice){.tracker = &mh_tracker_gas_wind, .measures = QUANTITY_GAS, .wants_wind = true};
    mh_gas_wind_config_default(config);
    config->place_sd_m = real_of(fmin(set_places(config, recording, scenario->tracker.place_sd_m), 1000));
    config->unit = real_of(unit_ppm);
    config->mixing_m = real_of(scenario->tracker.mixing_m);
    config->direction_sd_rad = real_of(scenario->tracker.wind_sd_rad);
    config->background.quantile = real_of(scenario->tracker.background_quantile);
    config->background.step = real_of(scenario->tracker.background_ppmph * hours / unit_ppm);
    config->learn = ticks(scenario->tracker.learn_s);
    config->memory = ticks(scenario->tracker.memory_s);
    config->correlation = real_of(fmax(scenario->tracker.correlation_s / interval_s, 1));
}

mh_tick tracker_tell_clusters(struct tracker_choice *choice, const struct clusters *clusters)
{
    for (size_t i = 0; i < clusters->node_count; i++) {
        const struct clustered_node *node = &clusters->nodes[i];
        choice->noise[i] = (struct mh_cv_noise){node->id, real_of(node->range_variance_m2)};
    }
    choice->config.cv.noise = choice->noise;
    choice->config.cv.noise_count = (uint16_t)clusters->node_count;
    return choice->config.cv.lag;
}

void centre_choose(const struct scenario *scenario, size_t count, struct centre_choice *choice)
{
    struct mh_fusion_centre_config *config = &choice->config;
    choice->centre = scenario->fusion.rule == MH_FUSION_CENTRAL ? NULL : &mh_centre_fusion;
    mh_fusion_centre_config_default(config);
    config->rule = scenario->fusion.rule;
    config->clusters = (uint8_t)count;
    config->motion = motion_of(scenario);
    config->keep = (mh_tick)lround(scenario->fusion.keep_s * MH_TICKS_PER_S);
    config->start.n = MH_CV_STATES;
    start_of(scenario, config->start.x, config->start.P);
}
#endif

/* ---- all ---- */

static const struct {
    const char *name;
    const struct mh_tracker *tracker; /* NULL: not in this build */
    void (*set_up)(struct tracker_choice *choice, const struct scenario *scenario, const struct mh_region *region);
    enum quantity measures;
    const char *meaning;
} trackers[] = {
    {"diffusion", FLOAT_ONLY(mh_tracker_diffusion, set_up_diffusion), QUANTITY_CONCENTRATION,
     "moving diffusion source: sliding window of its path, fitted with the exact model"},
    {"luo", &mh_tracker_luo, set_up_luo, QUANTITY_CONCENTRATION,
     "moving diffusion source: least squares and Sage-Husa filter (Luo, Chai and Yang)"},
    {"range", FLOAT_ONLY(mh_tracker_range, set_up_range), QUANTITY_RANGE,
     "ranged target: maximum likelihood of an instant, Kalman filter of constant velocity"},
    {"pftl", &mh_tracker_pftl, set_up_pftl, QUANTITY_RANGE,
     "ranged target: particles drawn anew about its predicted place (Zhou et al.)"},
    {"msl", FLOAT_ONLY(mh_tracker_msl, set_up_msl), QUANTITY_RANGE,
     "ranged target: particles that all who detect it can have (MSL, range-free)"},
    {"centroid", &mh_tracker_centroid, set_up_centroid, QUANTITY_RANGE,
     "ranged target: the middle of those who detect it (range-free); of sound the three who hear it best"},
    {"cv_ukf", FLOAT_ONLY(mh_tracker_cv_ukf, set_up_cv), QUANTITY_RANGE,
     "ranged target at nearly constant velocity: unscented Kalman filter, samples at any rate (Xu)"},
    {"cv_ekf", FLOAT_ONLY(mh_tracker_cv_ekf, set_up_cv), QUANTITY_RANGE, "the same with an extended Kalman filter"},
    {"gas", FLOAT_ONLY(mh_tracker_gas, set_up_gas), QUANTITY_GAS,
     "gas leak in the wind: all samples of all heads, from a grid of places on which the rate is eliminated"},
    {"gas_small", FLOAT_ONLY(mh_tracker_gas_small, set_up_gas), QUANTITY_GAS,
     "gas leak in the wind: iterated extended Kalman filter of place and logarithm of the rate"},
    {"gas_ekf", FLOAT_ONLY(mh_tracker_gas_ekf, set_up_gas), QUANTITY_GAS,
     "gas leak in the wind: extended Kalman filter (Zhang et al.)"},
    {"gas_ukf", FLOAT_ONLY(mh_tracker_gas_ukf, set_up_gas), QUANTITY_GAS,
     "gas leak in the wind: unscented Kalman filter (Zhang et al.)"},
    {"acoustic", FLOAT_ONLY(mh_tracker_acoustic, set_up_acoustic), QUANTITY_SOUND,
     "targets that are heard: median of triples and Gauss-Newton, several together, groups"},
    {"dm", &mh_tracker_dm, set_up_acoustic, QUANTITY_SOUND,
     "targets that are heard: distances from a table, three circles (Han)"},
    {"ml", FLOAT_ONLY(mh_tracker_ml, set_up_acoustic), QUANTITY_SOUND,
     "targets that are heard: maximum likelihood on a grid (Han)"},
};

enum { TRACKERS = sizeof trackers / sizeof trackers[0] };

bool tracker_describe(size_t i, const char **name, const char **meaning)
{
    for (size_t k = 0; k < TRACKERS; k++) {
        if (trackers[k].tracker && i-- == 0) {
            *name = trackers[k].name;
            *meaning = trackers[k].meaning;
            return true;
        }
    }
    return false;
}

/* The trackers that there are -> text, "a, b or c". */
static void list_trackers(char *text, size_t size)
{
    const char *name, *meaning, *after;
    size_t length = 0;
    text[0] = 0;
    for (size_t i = 0; tracker_describe(i, &name, &meaning) && length < size; i++) {
        const char *between = i == 0 ? "" : tracker_describe(i + 1, &after, &meaning) ? ", " : " or ";
        length += (size_t)snprintf(text + length, size - length, "%s%s", between, name);
    }
}

int tracker_choose(const struct scenario *scenario, const struct mh_region *region, struct tracker_choice *choice,
                   char *error, size_t error_size)
{
    char all[200];
    bool is_one = false;
    for (size_t i = 0; i < TRACKERS; i++) {
        const bool is_it = strcmp(scenario->tracker.name, trackers[i].name) == 0;
        is_one = is_one || is_it;
        if (is_it && trackers[i].tracker) {
            *choice = (struct tracker_choice){.tracker = trackers[i].tracker, .measures = trackers[i].measures};
            trackers[i].set_up(choice, scenario, region);
            return 0;
        }
    }
    list_trackers(all, sizeof all);
    snprintf(error, error_size, "tracker.name: `%s`%s, expected %s", scenario->tracker.name,
             is_one ? " is not in this build (MH_REAL=fixed)" : "", all);
    return -1;
}

int tracker_choose_of_recording(const struct scenario *scenario, const struct recording *recording, double interval_s,
                                struct tracker_choice *choice, char *error, size_t error_size)
{
    const bool is_gas = strcmp(scenario->tracker.name, "gas") == 0;
    if (recording->candidate_count > 0 && !is_gas) {
        snprintf(error, error_size, "tracker.name: `%s`, expected gas where there are candidates",
                 scenario->tracker.name);
        return -1;
    }
    if (recording->candidate_count > 0 && !recording->has_wind) {
        snprintf(error, error_size,
                 "the readings have no columns wind_speed_mps and wind_toward_rad, which candidates need");
        return -1;
    }
#if MH_REAL_FIXED
    (void)interval_s;
#else
    if (is_gas && recording->has_wind) {
        set_up_gas_wind(choice, scenario, recording, interval_s);
        return 0;
    }
#endif
    return tracker_choose(scenario, NULL, choice, error, error_size);
}

void tracker_seed(struct tracker_choice *choice, uint32_t seed)
{
    if (choice->seed) {
        *choice->seed = seed;
    }
}

uint32_t tracker_draws(const struct tracker_choice *choice, const void *state)
{
    return choice->draws ? choice->draws(state) : 0;
}

struct mh_election_config election_config_of(const struct scenario *scenario)
{
    struct mh_election_config config;
    mh_election_config_default(&config, (enum mh_election)scenario->protocol.election);
    if (scenario->protocol.members > 0) {
        config.members = (uint8_t)scenario->protocol.members;
    }
    config.horizon = (uint8_t)scenario->protocol.horizon;
    config.least_answers = (uint8_t)scenario->protocol.least_answers;
    config.sensing_range_m = real_of(scenario->sensor.range_m);
    config.radio_range_m = real_of(radio_nominal_range_m(scenario));
    config.interval = ticks(scenario->sensor.interval_s);
    return config;
}

static void set_up_collection(struct protocol_choice *choice, const struct scenario *scenario)
{
    const uint32_t range_mm = (uint32_t)fmin(fmax(radio_nominal_range_m(scenario) * 1000, 1), 1e9);
    if (scenario->protocol.routing == ROUTING_TREE) {
        choice->protocol = &mh_protocol_collection;
        mh_collection_config_default(&choice->config.collection);
        choice->config.collection.range_mm = range_mm;
    } else {
        struct mh_geographic_collection_config *config = &choice->config.geographic;
        choice->protocol = &mh_protocol_geographic;
        mh_geographic_collection_config_default(config);
        config->collection.range_mm = range_mm;
        config->hello_period = (mh_tick)lround(scenario->protocol.hello_s * MH_TICKS_PER_S);
        config->faces = scenario->protocol.routing == ROUTING_GEOGRAPHIC;
    }
}

static void set_up_cluster(struct protocol_choice *choice, const struct scenario *scenario)
{
    const struct mh_place nowhere = {0, 0, 0};
    struct mh_cluster_config *config = &choice->config.cluster;
    choice->protocol = &mh_protocol_cluster;
    choice->in_turns = true;
    mh_cluster_config_default(config, (enum mh_election)scenario->protocol.election, MH_BROADCAST - 1, &nowhere);
    config->election = election_config_of(scenario);
    config->wake_period = ticks(scenario->radio.wake_period_s);
    config->wake_length = ticks(scenario->radio.wake_length_s);
    config->watch_period = (mh_tick)fmax(config->election.interval, ticks(scenario->protocol.watch_s));
    const mh_tick half = config->election.interval / 2;
    config->window = scenario->tracker.window_s > 0 ? ticks(scenario->tracker.window_s)
                     : config->window < half        ? config->window
                                                    : half;
}

/* Protocols of trackers that need float. */
#if !MH_REAL_FIXED
static void set_up_fixed(struct protocol_choice *choice, const struct scenario *scenario)
{
    struct mh_fixed_config *config = &choice->config.fixed;
    choice->own_rates = true;
    if (scenario->fusion.rule == MH_FUSION_CENTRAL) {
        set_up_collection(choice, scenario); /* the clusters lead nothing */
        return;
    }
    choice->protocol = &mh_protocol_fixed;
    choice->fixed = true;
    mh_fixed_config_default(config);
    config->port = &mh_mote_fixed;
    config->report_interval = config->fuse_interval = ticks(scenario->fusion.report_s);
    config->wait = ticks(fmin(scenario->fusion.wait_s, scenario->fusion.report_s));
    config->acknowledges = scenario->fusion.rule == MH_FUSION_HIF || scenario->fusion.rule == MH_FUSION_HIF_FEEDBACK;
    config->hello_period = ticks(scenario->protocol.hello_s);
}

static void set_up_token(struct protocol_choice *choice, const struct scenario *scenario)
{
    const struct mh_place nowhere = {0, 0, 0};
    struct mh_token_config *config = &choice->config.token;
    choice->protocol = &mh_protocol_token;
    choice->in_turns = true;
    mh_token_config_default(config, MH_BROADCAST - 1, &nowhere);
    config->range_mm = (uint32_t)fmin(fmax(radio_nominal_range_m(scenario) * 1000, 1), 1e9);
    config->interval = ticks(scenario->sensor.interval_s);
    const mh_tick half = config->interval / 2;
    config->window = scenario->tracker.window_s > 0 ? ticks(scenario->tracker.window_s)
                     : config->window < half        ? config->window
                                                    : half;
    config->calm = (uint8_t)scenario->protocol.calm;
    config->heads_max = (uint8_t)scenario->protocol.heads_max;
}
#endif

void protocol_tell_clusters(struct protocol_choice *choice, const struct clusters *clusters)
{
    if (!choice->fixed) {
        return;
    }
    struct mh_fixed_member *first = choice->members;
    for (size_t r = 0; r < clusters->count; r++) {
        choice->clusters[r] = (struct mh_fixed_cluster){first, (uint8_t)clusters->sizes[r]};
        first += clusters->sizes[r];
    }
    for (size_t i = 0; i < clusters->node_count; i++) {
        const struct clustered_node *node = &clusters->nodes[i];
        const size_t before = (size_t)(choice->clusters[node->cluster].members - choice->members);
        choice->members[before + node->index] =
            (struct mh_fixed_member){node->id, place_from_metres(node->place.x_m, node->place.y_m, 0)};
    }
    choice->config.fixed.clusters = choice->clusters;
    choice->config.fixed.cluster_count = (uint8_t)clusters->count;
}

static void set_up_prince(struct protocol_choice *choice, const struct scenario *scenario)
{
    struct mh_prince_config *config = &choice->config.prince;
    choice->protocol = &mh_protocol_prince;
    choice->in_turns = true;
    mh_prince_config_default(config, (enum mh_prince_election)(scenario->protocol.election - ELECTION_PRINCE),
                             scenario->protocol.guards > 0, real_of(scenario->sensor.range_m),
                             real_of(radio_nominal_range_m(scenario)));
    config->port = &mh_mote_prince;
    config->replies = (uint8_t)scenario->protocol.replies;
    config->farthest = scenario->protocol.farthest;
    config->loudness_m2 = loudness_of(scenario);
    config->step_m = real_of(scenario->protocol.lead_m);
    config->tick = ticks(scenario->sensor.interval_s);
    config->watch_period = ticks(scenario->protocol.watch_s);
    config->wake_period = ticks(scenario->radio.wake_period_s);
    config->wake_length = ticks(scenario->radio.wake_length_s);
}

int protocol_tell_entries(struct protocol_choice *choice, const struct scenario *scenario, uint64_t seed, char *error,
                          size_t error_size)
{
    struct targets targets;
    if (!protocol_is(choice->protocol, "prince") || !scenario->protocol.entries) {
        return 0;
    }
    if (targets_make(&targets, scenario, seed, error, error_size)) {
        return -1;
    }
    for (size_t i = 0; i < targets.count; i++) {
        const double start_s = targets.list[i].start_s;
        const struct point at = targets_at(&targets, i, start_s).at;
        choice->entries[i] = (struct mh_prince_entry){place_from_metres(at.x_m, at.y_m, 0), ticks(start_s)};
    }
    choice->config.prince.entries = choice->entries;
    choice->config.prince.entry_count = (uint8_t)targets.count;
    targets_free(&targets);
    return 0;
}

int protocol_choose(const char *name, const struct scenario *scenario, struct protocol_choice *choice, char *error,
                    size_t error_size)
{
    if (strcmp(name, mh_protocol_collection.name) == 0) {
        set_up_collection(choice, scenario);
        return 0;
    }
    if (strcmp(name, mh_protocol_direct.name) == 0) {
        choice->protocol = &mh_protocol_direct;
        mh_direct_config_default(&choice->config.direct);
        return 0;
    }
    if (strcmp(name, mh_protocol_cluster.name) == 0) {
        set_up_cluster(choice, scenario);
        return 0;
    }
    if (strcmp(name, mh_protocol_prince.name) == 0) {
        set_up_prince(choice, scenario);
        return 0;
    }
    if (strcmp(name, chatter_protocol.name) == 0) {
        choice->protocol = &chatter_protocol;
        choice->config.chatter.interval = (mh_tick)llround(scenario->sensor.interval_s * MH_TICKS_PER_S);
        return 0;
    }
#if !MH_REAL_FIXED
    if (strcmp(name, "fixed") == 0) {
        set_up_fixed(choice, scenario);
        return 0;
    }
    if (strcmp(name, "token") == 0) {
        set_up_token(choice, scenario);
        return 0;
    }
#endif
    snprintf(error, error_size, "network.protocol: `%s`, expected collection, direct, cluster, prince, %s", name,
             MH_REAL_FIXED ? "or chatter (MH_REAL=fixed)" : "fixed, token or chatter");
    return -1;
}
