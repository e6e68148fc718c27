/* What only holds between the keys of a scenario. */
#include "motehound/config.h"
#include "radio/profile.h"
#include "radio/radio.h"
#include "scenario/keys.h"
#include "scenario/text.h"
#include "world/clusters.h"
#include "world/faults.h"
#include "world/mobility.h"
#include "world/targets.h"

#include <math.h>
#include <string.h>

/* A mote's clock wraps after 49.7 days and tells times apart up to half of that. */
#define RUN_MAX_S 2e6

#define FIELD_MAX_M 1e5

/* Of what trackers are told of their target. */
#define TRACKER_LEAST 1e-3

static double leg_length(const struct waypoint *a, const struct waypoint *b)
{
    return hypot(b->x_m - a->x_m, b->y_m - a->y_m);
}

/* How long there are targets; 0 where they cannot be made. */
static double targets_duration(const struct scenario *scenario)
{
    struct targets targets;
    char error[200];
    if (targets_make(&targets, scenario, 0, error, sizeof error) != 0) {
        return 0;
    }
    const double duration_s = targets.duration_s;
    targets_free(&targets);
    return duration_s;
}

/* How long the source is on its way. */
static double duration(const struct scenario *scenario)
{
    const struct waypoint *points = scenario->source.points;
    double seconds = 0;
    switch (scenario->source.path) {
    case PATH_WAYPOINTS:
        for (unsigned i = 1; i < scenario->source.points_count; i++) {
            seconds += leg_length(&points[i - 1], &points[i]) / (scenario->source.speed_mps * points[i].speed_factor);
        }
        return seconds;
    case PATH_ARCS: /* two quarters of a circle whose chords are each half the way */
        return leg_length(&points[0], &points[1]) / (4 * sin(acos(-1) / 4)) * acos(-1) / scenario->source.speed_mps;
    case PATH_GAUSS_MARKOV:
    case PATH_WHITE_ACCELERATION:
        return (double)scenario_steps(scenario) * scenario->sensor.interval_s;
    case PATH_STILL:
    case PATH_NONE:
        return scenario->source.duration_s;
    default:
        return targets_duration(scenario);
    }
}

struct scenario_field scenario_field(const struct scenario *scenario)
{
    const double density = scenario->network.density;
    if (density <= 0) {
        return (struct scenario_field){scenario->field.width_m, scenario->field.height_m, scenario->network.sink_x_m,
                                       scenario->network.sink_y_m};
    }
    const double side_m = scenario->sensor.range_m * sqrt((double)scenario_nodes(scenario) * acos(-1) / density);
    return (struct scenario_field){side_m, side_m, side_m / 2, side_m / 2};
}

struct scenario_prior scenario_prior(const struct scenario *scenario)
{
    const struct scenario_field field = scenario_field(scenario);
    const double share = 0.3; /* of the field's extent: about the sd of a place anywhere in it */
    const double x_m = scenario->tracker.prior_x_m, y_m = scenario->tracker.prior_y_m;
    const double sd_x_m = scenario->tracker.prior_sd_x_m, sd_y_m = scenario->tracker.prior_sd_y_m;
    const bool said = fabs(x_m) + fabs(y_m) > 0;
    return (struct scenario_prior){.x_m = said ? x_m : field.width_m / 2,
                                   .y_m = said ? y_m : field.height_m / 2,
                                   .sd_x_m = sd_x_m > 0 ? sd_x_m : share * field.width_m,
                                   .sd_y_m = sd_y_m > 0 ? sd_y_m : share * field.height_m,
                                   .rate = scenario->tracker.prior_rate_mlps,
                                   .rate_sd = scenario->tracker.prior_rate_sd_mlps};
}

size_t scenario_nodes(const struct scenario *scenario)
{
    const size_t side = (size_t)scenario->network.grid;
    return scenario->network.layout == LAYOUT_STRAT ? side * side : (size_t)scenario->network.nodes;
}

size_t scenario_steps(const struct scenario *scenario)
{
    return (size_t)(scenario->source.duration_s / scenario->sensor.interval_s + 1e-9);
}

/* The field that there is, and a walk's room in it. */
static int check_field(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    const struct scenario_field field = scenario_field(scenario);
    if (scenario->network.density > 0 && scenario->network.layout == LAYOUT_FILE) {
        return fail(error, error_size, "%s: network.density: expected 0 for layout file, found %g", name,
                    scenario->network.density);
    }
    if (scenario->network.density > 0 && (field.width_m < 1 || field.width_m > FIELD_MAX_M)) {
        return fail(error, error_size, "%s: network.density: expected one that gives a field of 1 to %g m, found %g m",
                    name, FIELD_MAX_M, field.width_m);
    }
    if (scenario->source.path == PATH_GAUSS_MARKOV) {
        const struct mobility walk = mobility_of(scenario);
        const double room_m = fmin(field.width_m, field.height_m) - 2 * walk.margin_m;
        const double step_m = MOBILITY_FASTEST * walk.speed_mps * walk.interval_s;
        if (room_m <= 0) {
            return fail(error, error_size,
                        "%s: source.path: expected a field wider than 2 sensor.range_m = %g m for gauss_markov, found "
                        "%g m",
                        name, 2 * walk.margin_m, fmin(field.width_m, field.height_m));
        }
        if (room_m <= step_m) {
            return fail(error, error_size,
                        "%s: target.speed_mph: expected steps shorter than the %g m that lie sensor.range_m inside "
                        "the field, found up to %g m",
                        name, room_m, step_m);
        }
    }
    if (field.sink_x_m < 0 || field.sink_x_m > field.width_m) {
        return fail(error, error_size, "%s: network.sink_x_m: expected a number 0 to field.width_m = %g, found %g",
                    name, field.width_m, field.sink_x_m);
    }
    if (field.sink_y_m < 0 || field.sink_y_m > field.height_m) {
        return fail(error, error_size, "%s: network.sink_y_m: expected a number 0 to field.height_m = %g, found %g",
                    name, field.height_m, field.sink_y_m);
    }
    return 0;
}

static int check_faults(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    const double every_s = scenario->faults.every_s;
    struct faults faults;
    if (every_s > 0 && every_s < scenario->sensor.interval_s) {
        return fail(error, error_size, "%s: faults.every_s: expected 0 or at least sensor.interval_s = %g, found %g",
                    name, scenario->sensor.interval_s, every_s);
    }
    faults_make(&faults, scenario, 0);
    for (int i = 0; i < FAULTS; i++) {
        if (every_s > 0 && faults_include(&faults, (enum fault)i) && faults.windows[i].from_s >= every_s) {
            return fail(error, error_size,
                        "%s: faults.every_s: expected 0 or more than %g, when one of the faults begins, found %g", name,
                        faults.windows[i].from_s, every_s);
        }
    }
    return 0;
}

/* What motes that follow a target in clusters cannot do. */
static int check_rhythm(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    if (scenario->sensor.interval_s < 0.1) {
        return fail(error, error_size,
                    "%s: sensor.interval_s: expected at least 0.1 for network.protocol cluster, found %g", name,
                    scenario->sensor.interval_s);
    }
    if (scenario->tracker.window_s > 0 && scenario->tracker.window_s < 0.02) {
        return fail(error, error_size,
                    "%s: tracker.window_s: expected 0 or at least 0.02 for network.protocol cluster, found %g", name,
                    scenario->tracker.window_s);
    }
    if (scenario->radio.wake_period_s > 0 && scenario->radio.wake_length_s < 0.004) {
        return fail(error, error_size,
                    "%s: radio.wake_length_s: expected at least 0.004 for network.protocol cluster, found %g", name,
                    scenario->radio.wake_length_s);
    }
    return 0;
}

/* The lists of clusters that stand on rings. */
static int check_rings(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    if (scenario->network.layout != LAYOUT_RINGS) {
        return 0;
    }
    const unsigned count = scenario->clusters.nodes.count;
    for (unsigned r = 0; r < count; r++) {
        const double size = scenario->clusters.nodes.values[r];
        if (size > floor(size)) {
            return fail(error, error_size, "%s: clusters.nodes: expected whole numbers, found %g", name, size);
        }
        if ((double)scenario->clusters.shared > size) {
            return fail(error, error_size,
                        "%s: clusters.shared: expected at most the nodes of each cluster, found %lld", name,
                        (long long)scenario->clusters.shared);
        }
    }
    if (scenario->clusters.range_variance_m2.count != count) {
        return fail(error, error_size,
                    "%s: clusters.range_variance_m2: expected as many numbers as clusters.nodes has, %u, found %u",
                    name, count, scenario->clusters.range_variance_m2.count);
    }
    if ((double)scenario->network.nodes < (double)rings_nodes(scenario) ||
        (double)scenario->network.nodes > (double)rings_nodes(scenario)) {
        return fail(error, error_size, "%s: network.nodes: expected those of clusters.nodes together, %zu, found %lld",
                    name, rings_nodes(scenario), (long long)scenario->network.nodes);
    }
    if (scenario->sensor.noisy_detection) {
        return fail(error, error_size, "%s: sensor.noisy_detection: expected false for network.layout rings", name);
    }
    return 0;
}

/* Fixed clusters know how their target starts and moves. */
static int check_fixed(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    const bool fixed = strcmp(scenario->network.protocol, "fixed") == 0;
    const bool tracks = strncmp(scenario->tracker.name, "cv_", 3) == 0;
    if (fixed != tracks) {
        return fail(
            error, error_size,
            "%s: tracker.name: expected cv_ukf or cv_ekf for network.protocol fixed, and for that alone, found %s",
            name, scenario->tracker.name);
    }
    if (!fixed) {
        return 0;
    }
    const bool rings = scenario->network.layout == LAYOUT_RINGS;
    if ((!rings && scenario->network.layout != LAYOUT_FILE) || scenario->source.path != PATH_WHITE_ACCELERATION ||
        scenario->sensor.quantity != QUANTITY_RANGE) {
        return fail(error, error_size,
                    "%s: network.protocol: expected fixed only where network.layout is rings or file, source.path is "
                    "white_acceleration and sensor.quantity is range",
                    name);
    }
    const double ratio = scenario->fusion.report_s / scenario->sensor.interval_s;
    if (ratio < 1 - 1e-9 || fabs(ratio - round(ratio)) > 1e-9) {
        return fail(error, error_size,
                    "%s: fusion.report_s: expected a whole multiple of sensor.interval_s = %g, found %g", name,
                    scenario->sensor.interval_s, scenario->fusion.report_s);
    }
    if (rings && scenario->clusters.nodes.count > MH_FUSED_MAX) {
        return fail(error, error_size, "%s: clusters.nodes: expected at most %d clusters for network.protocol fixed",
                    name, MH_FUSED_MAX);
    }
    if (!rings && scenario->sensor.noisy_detection) {
        return fail(error, error_size, "%s: sensor.noisy_detection: expected false for network.protocol fixed", name);
    }
    if (!scenario->network.ideal && (scenario->fusion.report_loss > 0 || scenario->clusters.shared > 0)) {
        return fail(error, error_size,
                    "%s: fusion.report_loss, clusters.shared: expected 0 unless network.ideal is true", name);
    }
    return 0;
}

/* What motes that search cannot do. */
static int check_search(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    const double interval_s = scenario->sensor.interval_s, window_s = scenario->tracker.window_s;
    if (interval_s < 0.5) {
        return fail(error, error_size,
                    "%s: sensor.interval_s: expected at least 0.5 for network.protocol token, found %g", name,
                    interval_s);
    }
    if (window_s > 0 && (window_s < 0.1 || window_s > interval_s / 2)) {
        return fail(error, error_size,
                    "%s: tracker.window_s: expected 0, or 0.1 to half of sensor.interval_s for network.protocol token, "
                    "found %g",
                    name, window_s);
    }
    return 0;
}

static int check_scripted(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    if (scenario->targets_count == 0) {
        return fail(error, error_size, "%s: targets: expected at least one for source.path scripted, found none", name);
    }
    for (unsigned i = 0; i < scenario->targets_count; i++) {
        const struct scripted_target *target = &scenario->targets[i];
        double length_m = 0;
        for (unsigned j = 1; j < target->points_count; j++) {
            length_m += leg_length(&target->points[j - 1], &target->points[j]);
        }
        if (length_m <= 0) {
            return fail(error, error_size, "%s: targets[%u].points: expected at least 2 different ones, found %u", name,
                        i, target->points_count);
        }
    }
    return 0;
}

/* Several targets can only be heard, and where they go. */
static int check_targets(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    const enum path_kind path = scenario->source.path;
    const bool sound = scenario->sensor.quantity == QUANTITY_SOUND;
    if (path != PATH_SCRIPTED && scenario->targets_count > 0) {
        return fail(error, error_size, "%s: targets: expected none unless source.path is scripted, found %u", name,
                    scenario->targets_count);
    }
    if (!targets_are_several(path)) {
        return scenario->target.count > 1 ? fail(error, error_size,
                                                 "%s: target.count: expected 1 where source.path has one source alone, "
                                                 "found %lld",
                                                 name, (long long)scenario->target.count)
                                          : 0;
    }
    if (!sound) {
        return fail(error, error_size,
                    "%s: source.path: expected one of a single source unless sensor.quantity is sound", name);
    }
    if (path == PATH_SCRIPTED) {
        return check_scripted(scenario, name, error, error_size);
    }
    if (path == PATH_SCATTERED && scenario->target.count > 1) {
        return fail(error, error_size, "%s: target.count: expected 1 for source.path scattered, found %lld", name,
                    (long long)scenario->target.count);
    }
    const struct scenario_field field = scenario_field(scenario);
    if (path == PATH_RANDOM || path == PATH_SCATTERED) {
        if (fmin(field.width_m, field.height_m) <= 2 * scenario->sensor.range_m) {
            return fail(error, error_size,
                        "%s: source.path: expected a field wider than 2 sensor.range_m = %g m for random and "
                        "scattered, found %g m",
                        name, 2 * scenario->sensor.range_m, fmin(field.width_m, field.height_m));
        }
        if (scenario_steps(scenario) < 1) {
            return fail(error, error_size, "%s: source.duration_s: expected at least sensor.interval_s = %g, found %g",
                        name, scenario->sensor.interval_s, scenario->source.duration_s);
        }
        return 0;
    }
    const unsigned points = scenario->source.points_count;
    if (points < 2 || leg_length(&scenario->source.points[0], &scenario->source.points[1]) <= 0) {
        return fail(error, error_size, "%s: source.points: expected 2 different ones, found %u", name, points);
    }
    return 0;
}

/* What nodes that hear targets and lead each other to them must be able to. */
static int check_prince(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    const double range_m = scenario->sensor.range_m, interval_s = scenario->sensor.interval_s;
    const double radio_m = radio_nominal_range_m(scenario);
    if (scenario->source.path == PATH_SCATTERED) {
        return fail(error, error_size,
                    "%s: source.path: expected one that leads somewhere for network.protocol prince over the air, "
                    "found scattered",
                    name);
    }
    if (range_m < 1 || range_m > 1000) {
        return fail(error, error_size, "%s: sensor.range_m: expected 1 to 1000 for network.protocol prince, found %g",
                    name, range_m);
    }
    if (radio_m <= range_m || radio_m > 1e4) {
        return fail(error, error_size,
                    "%s: radio.range_m: expected radios that reach farther than sensor.range_m = %g, and at most "
                    "10000 m, for network.protocol prince, found %g m",
                    name, range_m, radio_m);
    }
    if (interval_s < 0.02 || interval_s > 60) {
        return fail(error, error_size,
                    "%s: sensor.interval_s: expected 0.02 to 60 for network.protocol prince, found %g", name,
                    interval_s);
    }
    if (scenario->protocol.watch_s > 0 && scenario->protocol.watch_s < interval_s) {
        return fail(error, error_size, "%s: protocol.watch_s: expected 0 or at least sensor.interval_s = %g, found %g",
                    name, interval_s, scenario->protocol.watch_s);
    }
    return 0;
}

/* Clusters follow a target that is ranged, a token walks to a source of gas, and the ideal network has nothing but them. */
static int check_clusters(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    const bool clusters = strcmp(scenario->network.protocol, "cluster") == 0;
    const bool fixed = strcmp(scenario->network.protocol, "fixed") == 0;
    const bool walks = strcmp(scenario->network.protocol, "token") == 0;
    const bool hears = strcmp(scenario->network.protocol, "prince") == 0;
    const bool prince_rule = scenario->protocol.election >= (unsigned)MH_ELECTIONS;
    if (check_rings(scenario, name, error, error_size) != 0 || check_fixed(scenario, name, error, error_size) != 0) {
        return -1;
    }
    if ((clusters && prince_rule) || (hears && !prince_rule)) {
        return fail(error, error_size, "%s: protocol.election: expected %s for network.protocol %s", name,
                    hears ? "prince, competition or timestamp" : "none of prince, competition and timestamp",
                    scenario->network.protocol);
    }
    if (hears && (scenario->sensor.quantity != QUANTITY_SOUND || scenario->source.path == PATH_NONE)) {
        return fail(error, error_size,
                    "%s: network.protocol: expected prince only where sensor.quantity is sound and there is a source",
                    name);
    }
    if (scenario->network.ideal && !clusters && !fixed && !walks && !hears) {
        return fail(error, error_size,
                    "%s: network.ideal: expected true for network.protocol cluster, prince, fixed and token alone, "
                    "found %s",
                    name, scenario->network.protocol);
    }
    if (walks && (scenario->sensor.quantity != QUANTITY_GAS || scenario->source.path == PATH_NONE)) {
        return fail(error, error_size,
                    "%s: network.protocol: expected token only where sensor.quantity is gas and there is a source",
                    name);
    }
    if (clusters && (scenario->sensor.quantity != QUANTITY_RANGE || scenario->source.path == PATH_NONE)) {
        return fail(error, error_size,
                    "%s: network.protocol: expected cluster only where sensor.quantity is range and there is a source",
                    name);
    }
    if (!scenario->network.ideal) {
        return clusters ? check_rhythm(scenario, name, error, error_size)
               : walks  ? check_search(scenario, name, error, error_size)
               : hears  ? check_prince(scenario, name, error, error_size)
                        : 0;
    }
    struct faults faults;
    faults_make(&faults, scenario, 0);
    for (int i = 0; i < FAULTS; i++) {
        if (faults_include(&faults, (enum fault)i)) {
            return fail(error, error_size, "%s: network.ideal: expected false where there are faults.*", name);
        }
    }
    if (scenario->sensor.loss > 0 || scenario->sensor.outage_s > 0) {
        return fail(error, error_size,
                    "%s: network.ideal: expected false where sensor.loss or sensor.outage_s is not 0", name);
    }
    if (scenario->sensor.adc_bits > 0) {
        return fail(error, error_size, "%s: network.ideal: expected false where sensor.adc_bits is not 0, found %lld",
                    name, (long long)scenario->sensor.adc_bits);
    }
    if (scenario->clock.sync != SYNC_NONE ||
        fmax(scenario->clock.offset_s, fmax(scenario->clock.drift_ppm, scenario->clock.wander_ppm)) > 0) {
        return fail(error, error_size, "%s: network.ideal: expected false where clocks are not ideal (clock.*)", name);
    }
    if (scenario->energy.battery_j > 0) {
        return fail(error, error_size, "%s: network.ideal: expected false where energy.battery_j is not 0, found %g J",
                    name, scenario->energy.battery_j);
    }
    return 0;
}

int scenario_check(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    const unsigned points = scenario->source.points_count;
    if (scenario->source.path == PATH_WAYPOINTS && points < 2) {
        return fail(error, error_size, "%s: source.points: expected at least 2 for waypoints, found %u", name, points);
    }
    if (scenario->source.path == PATH_ARCS &&
        (points != 2 || leg_length(&scenario->source.points[0], &scenario->source.points[1]) <= 0)) {
        return fail(error, error_size, "%s: source.points: expected 2 different ones for arcs, found %u", name, points);
    }
    if ((scenario->source.path == PATH_STILL || scenario->source.path == PATH_NONE) &&
        scenario->source.duration_s <= 0) {
        return fail(error, error_size,
                    "%s: source.duration_s: expected more than 0 for a still source or none, found 0", name);
    }
    if ((scenario->source.path == PATH_GAUSS_MARKOV || scenario->source.path == PATH_WHITE_ACCELERATION) &&
        scenario_steps(scenario) < 1) {
        return fail(error, error_size, "%s: source.duration_s: expected at least sensor.interval_s = %g, found %g",
                    name, scenario->sensor.interval_s, scenario->source.duration_s);
    }
    if (check_targets(scenario, name, error, error_size) != 0) {
        return -1;
    }
    const double run_s = duration(scenario);
    if (!(run_s > 0) || run_s > RUN_MAX_S) {
        return fail(error, error_size, "%s: source: expected a path of more than 0 and at most %g s, found %g s", name,
                    RUN_MAX_S, run_s);
    }
    if (scenario->sensor.outage_s > 0 && scenario->sensor.outage_start_s + scenario->sensor.outage_s > run_s) {
        return fail(error, error_size, "%s: sensor.outage_s: expected an end within the run of %g s, found %g s", name,
                    run_s, scenario->sensor.outage_start_s + scenario->sensor.outage_s);
    }
    if (scenario->network.starts > 0 &&
        (scenario->network.layout != LAYOUT_UNIFORM || scenario->source.path != PATH_STILL)) {
        return fail(error, error_size,
                    "%s: network.starts: expected 0 unless network.layout is uniform and source.path still, found %lld",
                    name, (long long)scenario->network.starts);
    }
    if (scenario->network.layout == LAYOUT_FILE && scenario->network.file[0] == '\0') {
        return fail(error, error_size, "%s: network.file: expected a nodes.csv for layout file, found nothing", name);
    }
    const double spacing_m = scenario->network.spacing_m;
    const double cells = spacing_m > 0 ? floor(scenario_field(scenario).width_m / spacing_m * (1 + 1e-9)) *
                                             floor(scenario_field(scenario).height_m / spacing_m * (1 + 1e-9))
                                       : (double)INFINITY;
    if (scenario->network.layout == LAYOUT_GRID && cells < (double)scenario->network.nodes) {
        return fail(error, error_size, "%s: network.spacing_m: expected cells for %lld nodes in the field, found %.0f",
                    name, (long long)scenario->network.nodes, cells);
    }
    if (scenario->traffic.sources > 0 && scenario->source.path != PATH_NONE) {
        return fail(error, error_size, "%s: traffic.sources: expected 0 unless source.path is none, found %lld", name,
                    (long long)scenario->traffic.sources);
    }
    if (check_field(scenario, name, error, error_size) != 0) {
        return -1;
    }
    const double loudest_dbm = scenario->radio.power_dbm - scenario->radio.reference_loss_db;
    const double sensitivity_dbm = scenario->radio.sensitivity_dbm < 0
                                       ? scenario->radio.sensitivity_dbm
                                       : radio_profile_find(scenario->radio.profile)->sensitivity_dbm;
    if (scenario->radio.propagation == PROPAGATION_LOG_DISTANCE && sensitivity_dbm >= loudest_dbm) {
        return fail(
            error, error_size,
            "%s: radio.sensitivity_dbm: expected less than radio.power_dbm - radio.reference_loss_db = %g, found %g",
            name, loudest_dbm, sensitivity_dbm);
    }
    if (scenario->radio.wake_period_s > 0 && scenario->radio.wake_length_s >= scenario->radio.wake_period_s) {
        return fail(error, error_size, "%s: radio.wake_length_s: expected less than radio.wake_period_s = %g, found %g",
                    name, scenario->radio.wake_period_s, scenario->radio.wake_length_s);
    }
    if (scenario->energy.battery_j > 0 && strcmp(scenario->energy.profile, "none") == 0) {
        return fail(error, error_size, "%s: energy.battery_j: expected 0 for energy.profile none, found %g", name,
                    scenario->energy.battery_j);
    }
    if (check_faults(scenario, name, error, error_size) != 0 ||
        check_clusters(scenario, name, error, error_size) != 0) {
        return -1;
    }
    if (scenario->sweep.key[0] != '\0' &&
        (scenario_key_find(scenario->sweep.key) == NULL || strncmp(scenario->sweep.key, "sweep.", 6) == 0 ||
         scenario->sweep.values_count == 0)) {
        return fail(error, error_size,
                    "%s: sweep: expected a key of another section and at least one value, found '%.60s' and %u", name,
                    scenario->sweep.key, scenario->sweep.values_count);
    }
    return scenario_check_tracking(scenario, name, error, error_size);
}

/* Of trackers of targets that are heard. */
static int check_hearing(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    const double range_m = scenario->sensor.range_m, loudness_m2 = scenario->source.loudness * range_m * range_m;
    if (range_m < 1 || loudness_m2 < 1 || loudness_m2 > 1e8) {
        return fail(error, error_size,
                    "%s: sensor.range_m: expected at least 1, and source.loudness sensor.range_m^2 from 1 to 1e8 m2, "
                    "found %g m and %g m2",
                    name, range_m, loudness_m2);
    }
    if (scenario->tracker.strongest == 1) {
        return fail(error, error_size, "%s: tracker.strongest: expected 0 or at least 2, found 1", name);
    }
    if (scenario->tracker.groups != MH_GROUP_NONE && strcmp(scenario->tracker.name, "acoustic") != 0) {
        return fail(error, error_size, "%s: tracker.groups: expected none unless tracker.name is acoustic, found %s",
                    name, scenario->tracker.name);
    }
    return 0;
}

int scenario_check_tracking(const struct scenario *scenario, const char *name, char *error, size_t error_size)
{
    const struct {
        const char *key;
        double value;
    } told[] = {{"tracker.range_sd_m", scenario->tracker.range_sd_m},
                {"tracker.acceleration_sd_mps2", scenario->tracker.acceleration_sd_mps2},
                {"tracker.speed_mps", scenario->tracker.speed_mps}};
    for (size_t i = 0; i < sizeof told / sizeof told[0]; i++) {
        if (told[i].value > 0 && told[i].value < TRACKER_LEAST) {
            return fail(error, error_size, "%s: %s: expected 0 or at least %g, found %g", name, told[i].key,
                        TRACKER_LEAST, told[i].value);
        }
    }
    if (scenario->tracker.window_s >= scenario->sensor.interval_s) {
        return fail(error, error_size, "%s: tracker.window_s: expected less than sensor.interval_s = %g, found %g",
                    name, scenario->sensor.interval_s, scenario->tracker.window_s);
    }
    if (scenario->sensor.quantity == QUANTITY_SOUND && check_hearing(scenario, name, error, error_size) != 0) {
        return -1;
    }
    if (strcmp(scenario->tracker.name, "diffusion") == 0 && scenario->tracker.chi < 1e-3) {
        return fail(error, error_size, "%s: tracker.chi: expected at least 0.001 for tracker diffusion, found %g", name,
                    scenario->tracker.chi);
    }
    return 0;
}
