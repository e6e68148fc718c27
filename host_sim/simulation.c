#include "simulation.h"

#include "hosts/boards.h"
#include "ideal/ideal.h"
#include "network.h"
#include "reals.h"
#include "scenario/text.h"
#include "world/field.h"
#include "world/gas.h"
#include "world/identify.h"
#include "world/ranging.h"
#include "world/sensor.h"
#include "world/sound.h"
#include "world/targets.h"
#include "world/traffic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum power { POWER_ON, POWER_OFF, POWER_DEAD };

struct run {
    const struct scenario *scenario;
    const struct observer *observer;
    struct roster roster;
    struct traffic traffic; /* where there is no source; else the next eight */
    struct targets targets;
    struct identify identify;
    enum quantity quantity; /* that the sensors measure */
    struct field field;     /* of a concentration */
    struct ranging ranging;
    struct gas gas;
    struct sound sound;
    struct sensors sensors;
    double *concentrations;
    int32_t *counts;
    struct faults faults;
    enum power *power;    /* of each node; NULL where the faults leave all on */
    sim_time next_switch; /* of them; SIM_TIME_NEVER: none */
    sim_time interval;
    uint64_t instants, next; /* in all, and the one to come */
    sim_time end;
    struct network network;
};

static struct truth truth_of(const struct run *run, const struct target_state *state, uint32_t target, double time_s)
{
    struct truth truth = {.time_s = time_s, .present = state->present, .target = target};
    if (truth.present) {
        truth.x_m = state->at.x_m;
        truth.y_m = state->at.y_m;
        truth.vx_mps = state->velocity.x_m;
        truth.vy_mps = state->velocity.y_m;
        truth.rate = run->quantity == QUANTITY_GAS ? run->gas.rate_mlps : 0;
    }
    return truth;
}

static struct truth truth_at(const struct run *run, uint32_t target, double time_s)
{
    const struct target_state state = targets_at(&run->targets, target, time_s);
    return truth_of(run, &state, target, time_s);
}

/* Of the target, or of the middle of the group, that an estimate is of. */
static struct truth truth_behind(struct run *run, const struct mh_estimate *estimate, double time_s)
{
    const struct identified found = identify_estimate(&run->identify, &run->targets, estimate, time_s);
    return truth_of(run, &found.state, found.number, time_s);
}

/* The heads of fixed clusters have an estimate at each instant; told are those of a report interval, and not the start. */
static bool is_reported(const struct run *run, const struct mh_estimate *estimate)
{
    const mh_tick interval = (mh_tick)lround(run->scenario->fusion.report_s * MH_TICKS_PER_S);
    return estimate->time > 0 && estimate->time % interval == 0;
}

static void report_local(const struct run *run, uint32_t mote, double now_s, double time_s,
                         const struct mh_estimate *estimate)
{
    const struct truth truth = truth_at(run, 0, time_s);
    if (run->observer->local && is_reported(run, estimate)) {
        const uint8_t cluster = (uint8_t)run->roster.kit.clusters.nodes[mote].cluster;
        run->observer->local(run->observer->context, now_s, cluster, roster_id(&run->roster, mote), estimate, &truth);
    }
}

static void report(void *context, uint32_t mote, double now_s, double time_s, const struct mh_estimate *estimate)
{
    struct run *run = context;
    const bool is_sink = mote == run->roster.deployment.count;
    if (!is_sink && run->roster.kit.protocol.fixed) {
        report_local(run, mote, now_s, time_s, estimate);
    } else if (is_sink && run->roster.kit.protocol.in_turns) {
        if (run->observer->sink) {
            const struct truth at_time = truth_behind(run, estimate, time_s);
            run->observer->sink(run->observer->context, now_s, estimate, &at_time);
        }
    } else if (run->observer->estimate && (!run->roster.kit.protocol.own_rates || is_reported(run, estimate))) {
        const struct truth at_time = truth_behind(run, estimate, time_s);
        const struct truth at_arrival = truth_behind(run, estimate, time_s - number_of(estimate->age));
        run->observer->estimate(run->observer->context, now_s, roster_id(&run->roster, mote), estimate, &at_time,
                                &at_arrival);
    }
}

/* A new head tells those around it of its target. */
static void awake(void *context, double time_s, double found_s, const mh_awake_t *message)
{
    struct run *run = context;
    if (!run->observer->watch) {
        return;
    }
    const double vx_mps = message->vx_cmps / 1e2, vy_mps = message->vy_cmps / 1e2;
    struct watch_news news = {.target = (uint32_t)message->target,
                              .number = UINT32_MAX,
                              .head = (mh_node_id)message->sender,
                              .prince = (mh_node_id)message->prince,
                              .prince_s = found_s + message->enters_cs / 1e2,
                              .x_m = message->x_mm / 1e3 + vx_mps * (time_s - found_s),
                              .y_m = message->y_mm / 1e3 + vy_mps * (time_s - found_s),
                              .vx_mps = vx_mps,
                              .vy_mps = vy_mps,
                              .sd_m = (double)NAN,
                              .extent_m = (uint16_t)message->extent_cm / 1e2,
                              .members = message->members > 1 ? (unsigned)message->members : 1};
    if (news.members == 1) {
        const struct point at = {message->x_mm / 1e3, message->y_mm / 1e3};
        news.number = identify_target(&run->identify, &run->targets, news.target, at, found_s);
    }
    run->observer->watch(run->observer->context, time_s, &news);
}

/* Nodes die and restart. What begins now has begun: asked half a microsecond later, so that rounding does not count. */
static int switch_nodes(struct run *run)
{
    const double time_s = network_time_s(&run->network) + 0.5 / SIM_TIME_PER_S;
    for (uint32_t i = 0; i < run->roster.deployment.count; i++) {
        const enum power before = run->power[i];
        if (before == POWER_DEAD) {
            continue;
        }
        run->power[i] = faults_hit(&run->faults, FAULT_DEAD, time_s, i)     ? POWER_DEAD
                        : faults_hit(&run->faults, FAULT_REBOOT, time_s, i) ? POWER_OFF
                                                                            : POWER_ON;
        if ((before == POWER_ON) != (run->power[i] == POWER_ON)) {
            network_power(&run->network, i, before != POWER_ON);
        }
    }
    const double next_s = fmin(faults_next_change_s(&run->faults, FAULT_DEAD, time_s),
                               faults_next_change_s(&run->faults, FAULT_REBOOT, time_s)) *
                          SIM_TIME_PER_S;
    run->next_switch = next_s < (double)run->end ? (sim_time)llround(next_s) : SIM_TIME_NEVER;
    return network_schedule(&run->network, run->next_switch);
}

static bool can_read(const struct run *run, uint64_t instant, double time_s, size_t node)
{
    return (!run->power || run->power[node] == POWER_ON) && !sensors_lost(&run->sensors, instant, time_s, node);
}

/* What node `node` measures now; false: nothing. Who is asked says what he hears, however little. */
static bool measure(const struct run *run, uint64_t instant, double time_s, uint32_t node, bool asked, double *value)
{
    const struct recorded_node *place = &run->roster.deployment.nodes[node];
    const struct point at = {place->x_m, place->y_m};
    if (run->quantity == QUANTITY_SOUND) {
        *value = sound_reading(&run->sound, &run->targets, time_s, node, at);
        return asked || *value >= 1;
    }
    const struct target_state source = targets_at(&run->targets, 0, time_s);
    if (!source.present) {
        return false;
    }
    if (run->quantity == QUANTITY_GAS) {
        *value = gas_reading(&run->gas, source.at, time_s, node, at);
        return true;
    }
    const double distance_m = hypot(hypot(at.x_m - source.at.x_m, at.y_m - source.at.y_m), place->z_m);
    return ranging_detects(&run->ranging, instant, node, distance_m, value);
}

/* `instant` is the nearest. */
static void sample_alone(struct run *run, uint64_t instant, double time_s, uint32_t node, bool asked)
{
    double value;
    if (can_read(run, instant, time_s, node) && measure(run, instant, time_s, node, asked, &value)) {
        network_reading(&run->network, node, sensors_convert(&run->sensors, instant, time_s, node, value), 0);
    }
}

static void sample_each(struct run *run, uint64_t instant, double time_s)
{
    const bool own_rates = run->roster.kit.protocol.own_rates;
    for (uint32_t i = 0; i < run->roster.deployment.count; i++) {
        if (!own_rates || (instant > 0 && instant % run->roster.kit.clusters.nodes[i].period == 0)) {
            sample_alone(run, instant, time_s, i, false);
        }
    }
}

/* A node whose sensor was asked, at whatever time. */
static void sense(void *context, uint32_t mote)
{
    struct run *run = context;
    if (mote < run->roster.deployment.count) {
        const uint64_t nearest = (run->network.now + run->interval / 2) / run->interval;
        sample_alone(run, nearest, network_time_s(&run->network), mote, true);
    }
}

static int sample_concentrations(struct run *run, uint64_t instant, double time_s)
{
    if (field_prepare(&run->field, time_s)) {
        return -1;
    }
    const struct deployment *deployment = &run->roster.deployment;
    for (size_t i = 0; i < deployment->count; i++) {
        const struct recorded_node *node = &deployment->nodes[i];
        run->concentrations[i] = field_concentration(&run->field, node->x_m, node->y_m);
    }
    sensors_read(&run->sensors, instant, run->concentrations, run->counts);
    for (size_t i = 0; i < deployment->count; i++) {
        if (can_read(run, instant, time_s, i)) {
            network_reading(&run->network, (uint32_t)i, run->counts[i], 0);
        }
    }
    return 0;
}

static int sample(struct run *run)
{
    const uint64_t instant = run->next++;
    const double time_s = network_time_s(&run->network);
    for (uint32_t k = 0; run->observer->truth && k < run->targets.count; k++) {
        const struct truth truth = truth_at(run, k, time_s);
        run->observer->truth(run->observer->context, &truth);
    }
    const bool together = run->quantity == QUANTITY_CONCENTRATION;
    if (together && sample_concentrations(run, instant, time_s)) {
        return -1;
    }
    if (!together && !run->roster.kit.protocol.in_turns) {
        sample_each(run, instant, time_s);
    }
    return run->next < run->instants ? network_schedule(&run->network, run->next * run->interval) : 0;
}

/* A source of synthetic traffic takes its sample, which it reports whatever it is. */
static int sample_one(struct run *run)
{
    const uint32_t node = traffic_take(&run->traffic);
    if (!run->power || run->power[node] == POWER_ON) {
        network_reading(&run->network, node, 0, 0);
    }
    return network_schedule(&run->network, traffic_next(&run->traffic));
}

/* Whatever is due. Each of them asks for the next of its kind, so nothing is done twice where several are due at once. */
static int instant_of_source(void *context)
{
    struct run *run = context;
    if (run->network.now >= run->next_switch && switch_nodes(run)) {
        return -1;
    }
    return run->network.now == run->next * run->interval ? sample(run) : 0;
}

static int instant_of_traffic(void *context)
{
    struct run *run = context;
    if (run->network.now >= run->next_switch && switch_nodes(run)) {
        return -1;
    }
    return run->network.now == traffic_next(&run->traffic) ? sample_one(run) : 0;
}

static int make_world(struct run *run, const struct scenario *scenario, uint64_t seed, char *error, size_t error_size)
{
    const size_t nodes = run->roster.deployment.count;
    faults_make(&run->faults, scenario, seed);
    run->next_switch = SIM_TIME_NEVER;
    if (faults_include(&run->faults, FAULT_DEAD) || faults_include(&run->faults, FAULT_REBOOT)) {
        run->power = calloc(nodes, sizeof *run->power);
        if (!run->power) {
            return -1;
        }
        run->next_switch = 0;
    }
    run->interval = (sim_time)run->roster.kit.head.interval * (SIM_TIME_PER_S / MH_TICKS_PER_S);
    if (scenario->source.path == PATH_NONE) {
        run->end = (sim_time)(scenario->source.duration_s * SIM_TIME_PER_S);
        return traffic_make(&run->traffic, (size_t)scenario->traffic.sources, nodes, run->interval, seed);
    }
    run->quantity = scenario->sensor.quantity;
    if (targets_make(&run->targets, scenario, seed, error, error_size) ||
        (run->quantity == QUANTITY_CONCENTRATION && field_make(&run->field, scenario, seed, error, error_size))) {
        return -1;
    }
    run->identify.range_m = scenario->sensor.range_m;
    run->instants = (sim_time)(run->targets.duration_s * SIM_TIME_PER_S + 1e-3) / run->interval + 1;
    run->end =
        run->instants * run->interval; /* the head waits for the last instant's measurements less than one interval */
    if (run->roster.kit.protocol.fixed) { /* the sink joins the last instant's tracks */
        run->end += (sim_time)run->roster.kit.protocol.config.fixed.wait * (SIM_TIME_PER_S / MH_TICKS_PER_S);
    }
    run->ranging = ranging_of(scenario, &run->roster.kit.clusters, seed);
    run->gas = gas_of(scenario, seed);
    run->sound = sound_of(scenario, seed);
    run->concentrations = malloc(nodes * sizeof *run->concentrations);
    run->counts = malloc(nodes * sizeof *run->counts);
    return run->concentrations && run->counts ? sensors_make(&run->sensors, scenario, seed, nodes) : -1;
}

static int bring_up(struct run *run, const struct host_provider *hosts, const struct scenario *scenario, uint64_t seed,
                    char *error, size_t error_size)
{
    const bool has_source = scenario->source.path != PATH_NONE;
    const struct network_config config = {.scenario = scenario,
                                          .roster = &run->roster,
                                          .hosts = hosts,
                                          .range_m = scenario->radio.range_m,
                                          .seed = seed,
                                          .observer = run->observer,
                                          .context = run,
                                          .sense = sense,
                                          .instant = has_source ? instant_of_source : instant_of_traffic,
                                          .awake = awake,
                                          .report = report};
    snprintf(error, error_size, "out of memory");
    if (roster_make(&run->roster, scenario, seed, error, error_size) ||
        make_world(run, scenario, seed, error, error_size) || network_make(&run->network, &config, error, error_size)) {
        return -1;
    }
    return network_schedule(&run->network, has_source ? 0 : traffic_next(&run->traffic)) ||
                   (run->power && network_schedule(&run->network, 0))
               ? -1
               : 0;
}

static void tear_down(struct run *run)
{
    network_free(&run->network);
    sensors_free(&run->sensors);
    free(run->counts);
    free(run->power);
    free(run->concentrations);
    field_free(&run->field);
    targets_free(&run->targets);
    traffic_free(&run->traffic);
    roster_free(&run->roster);
}

int simulation_run_on(const struct host_provider *hosts, const struct scenario *scenario, uint64_t seed,
                      const struct observer *observer, const volatile sig_atomic_t *stop,
                      struct simulation_counters *counters, char *error, size_t error_size)
{
    if (scenario->network.ideal && hosts && hosts->emulation && hosts->emulation->count > 0) {
        return fail(error, error_size, "--emulate: expected a network of motes, found network.ideal");
    }
    if (scenario->network.ideal) {
        return ideal_run(scenario, seed, observer, stop, counters, error, error_size);
    }
    struct run run = {.scenario = scenario, .observer = observer};
    int result = bring_up(&run, hosts, scenario, seed, error, error_size);
    if (result == 0) {
        result = network_run(&run.network, run.end, stop, error, error_size);
        *counters = (struct simulation_counters){
            .samples = run.next, .clusters.present = run.roster.kit.protocol.protocol == &mh_protocol_cluster};
    }
    if (result == 0) {
        result = network_count(&run.network, counters, error, error_size);
    }
    tear_down(&run);
    return result;
}

int simulation_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                   const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                   size_t error_size)
{
    return simulation_run_on(NULL, scenario, seed, observer, stop, counters, error, error_size);
}
