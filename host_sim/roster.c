#include "roster.h"

#include "radio/radio.h"
#include "world/campaign.h"
#include "world/sensor.h"

#include <math.h>
#include <stdio.h>

enum { MICROSECONDS_PER_TICK = SIM_TIME_PER_S / MH_TICKS_PER_S };

struct mh_place place_from_metres(double x_m, double y_m, double z_m)
{
    return (struct mh_place){(int32_t)lround(x_m * 1000), (int32_t)lround(y_m * 1000), (int32_t)lround(z_m * 1000)};
}

static bool clocks_are_ideal(const struct scenario *scenario)
{
    return fmax(scenario->clock.offset_s, fmax(scenario->clock.drift_ppm, scenario->clock.wander_ppm)) <= 0;
}

void mote_kit_complete(struct mote_kit *kit, const struct scenario *scenario, mh_tick epoch)
{
    const mh_tick interval = kit->sensor.interval;
    const double window_s = scenario->tracker.window_s;
    kit->head = (struct mh_head_config){
        .tracker = kit->tracker.tracker,
        .tracker_config = &kit->tracker.config,
        .epoch = epoch,
        .interval = interval,
        .tolerance = clocks_are_ideal(scenario) ? 0 : interval / 4, /* as much as the sensor node tolerates */
        .window = window_s > 0 ? (mh_tick)lround(window_s * MH_TICKS_PER_S) : interval / 2,
    };
}

/* Where in its tick a sync message ends on average, as struct mh_clock_config wants it: it is handed over as a tick begins, and waits for
 * one of the backoffs of a free channel, if there are any. */
static uint8_t sent_q8(const struct scenario *scenario)
{
    const struct mh_message message = {.kind = MH_MESSAGE_SYNC};
    const struct radio_profile profile = radio_config_of(scenario, scenario->radio.range_m).profile;
    uint8_t frame[MH_FRAME_MAX];
    size_t length = 0;
    (void)mh_wire_encode(mh_wire_all, &message, frame, &length);
    const size_t bytes = profile.preamble_bytes + profile.header_bytes + length;
    const double least_us = fmax(scenario->radio.delay_s * SIM_TIME_PER_S, 1) + radio_profile_air_us(&profile, bytes);
    const double sense_us = profile.contention ? profile.cca_us + profile.turnaround_us : 0;
    const unsigned backoffs = profile.contention ? 1u << profile.backoff_exponents[0] : 1;
    double sum = 0;
    for (unsigned k = 0; k < backoffs; k++) {
        const double wait_us = profile.contention ? (profile.least_units + k) * profile.backoff_unit_us : 0;
        sum += fmod(least_us + sense_us + wait_us, MICROSECONDS_PER_TICK) / MICROSECONDS_PER_TICK;
    }
    return (uint8_t)fmin(256 * sum / backoffs, 255);
}

static void keep_time(struct mote_kit *kit, const struct scenario *scenario)
{
    const mh_tick period = (mh_tick)lround(scenario->clock.sync_period_s * MH_TICKS_PER_S);
    kit->synchronised = scenario->clock.sync == SYNC_FLOODING;
    kit->other = (struct mh_clock_config){.period = period, .wait = period / 8, .sent_q8 = sent_q8(scenario)};
    kit->root = kit->other;
    kit->root.root = true;
}

int mote_kit_make(struct mote_kit *kit, const struct scenario *scenario, char *error, size_t error_size)
{
    const struct scenario_field field = scenario_field(scenario);
    const struct mh_place far_corner = place_from_metres(field.width_m, field.height_m, 0);
    const struct mh_region region = {0, far_corner.x_mm, 0, far_corner.y_mm};
    *kit = (struct mote_kit){.sensor = sensor_config(scenario)};
    if (tracker_choose(scenario, &region, &kit->tracker, error, error_size) ||
        protocol_choose(scenario->network.protocol, scenario, &kit->protocol, error, error_size) ||
        clusters_make(&kit->clusters, scenario, error, error_size)) {
        return -1;
    }
    if (scenario->source.path != PATH_NONE && kit->tracker.measures != scenario->sensor.quantity) {
        static const char *const many[] = {"concentrations", "ranges", "gas", "sound"};
        static const char *const one[] = {"concentration", "range", "gas", "sound"};
        snprintf(error, error_size, "tracker.name: `%s` works on %s, sensor.quantity is %s", scenario->tracker.name,
                 many[kit->tracker.measures], one[scenario->sensor.quantity]);
        return -1;
    }
    if (kit->sensor.interval < 1) {
        snprintf(error, error_size, "sensor.interval_s: %g, expected at least 0.001", scenario->sensor.interval_s);
        return -1;
    }
    mote_kit_complete(kit, scenario, 0);
    if (kit->protocol.fixed) {
        centre_choose(scenario, kit->clusters.count, &kit->centre);
        protocol_tell_clusters(&kit->protocol, &kit->clusters);
    }
    if (kit->protocol.own_rates) {
        kit->head.lateness = tracker_tell_clusters(&kit->tracker, &kit->clusters);
    }
    if (protocol_is(kit->protocol.protocol, "prince")) {
        kit->sensor.interval = 1; /* it samples when it likes */
    } else if (kit->protocol.in_turns) {
        const bool walks = protocol_is(kit->protocol.protocol, "token");
        kit->head.window = walks ? kit->protocol.config.token.window : kit->protocol.config.cluster.window;
        kit->head.own_first = walks;
        kit->head.tolerance = kit->head.interval / 4; /* who is asked samples when he hears it */
    } else if (radio_config_of(scenario, scenario->radio.range_m).profile.contention) {
        kit->sensor.report_spread = kit->head.window / 4 * 3; /* the rest is for the way */
    }
    keep_time(kit, scenario);
    return 0;
}

static bool nodes_lead(const struct protocol_choice *protocol) { return protocol->in_turns || protocol->fixed; }

struct host_mote mote_kit_mote(const struct mote_kit *kit, mh_node_id id, struct mh_place place, bool is_sink)
{
    return (struct host_mote){.id = id,
                              .place = place,
                              .sensor = is_sink ? NULL : &kit->sensor,
                              .head = is_sink != nodes_lead(&kit->protocol) ? &kit->head : NULL,
                              .centre = is_sink && kit->protocol.fixed ? kit->centre.centre : NULL,
                              .centre_config = &kit->centre.config,
                              .protocol = kit->protocol.protocol,
                              .protocol_config = &kit->protocol.config,
                              .sync = kit->synchronised ? is_sink ? &kit->root : &kit->other : NULL};
}

void mote_kit_tell_sink(struct mote_kit *kit, mh_node_id sink, struct mh_place place)
{
    if (kit->protocol.protocol == &mh_protocol_cluster) {
        kit->protocol.config.cluster.sink = sink;
        kit->protocol.config.cluster.sink_place = place;
    } else if (kit->protocol.fixed) {
        kit->protocol.config.fixed.sink = sink;
        kit->protocol.config.fixed.sink_place = place;
    } else if (protocol_is(kit->protocol.protocol, "token")) {
        kit->protocol.config.token.sink = sink;
        kit->protocol.config.token.sink_place = place;
    }
}

void mote_kit_tell_start(struct mote_kit *kit, mh_node_id start, struct mh_place place)
{
    if (protocol_is(kit->protocol.protocol, "token")) {
        kit->protocol.config.token.start = start;
        kit->protocol.config.token.start_place = place;
    }
}

static int tell_start(struct roster *roster, const struct scenario *scenario, char *error, size_t error_size)
{
    uint32_t start;
    if (campaign_start(scenario, roster->seed, &roster->deployment, &start, error, error_size)) {
        return -1;
    }
    const struct recorded_node *node = &roster->deployment.nodes[start];
    mote_kit_tell_start(&roster->kit, node->id, place_from_metres(node->x_m, node->y_m, node->z_m));
    return 0;
}

int roster_complete(struct roster *roster, const struct scenario *scenario, char *error, size_t error_size)
{
    const size_t nodes = roster->deployment.count;
    if (nodes < 1 || nodes >= UINT32_C(1) << 28 || roster->deployment.nodes[nodes - 1].id >= MH_BROADCAST - 1) {
        snprintf(error, error_size, "%zu nodes, expected 1 to 268,435,455 with identifiers below 4294967294", nodes);
        return -1;
    }
    roster->count = (uint32_t)nodes + 1;
    roster->sink_id = roster->deployment.nodes[nodes - 1].id + 1;
    tracker_seed(&roster->kit.tracker, (uint32_t)roster->seed);
    const struct scenario_field field = scenario_field(scenario);
    roster->sink_x_m = field.sink_x_m;
    roster->sink_y_m = field.sink_y_m;
    mote_kit_tell_sink(&roster->kit, roster->sink_id, place_from_metres(field.sink_x_m, field.sink_y_m, 0));
    if (protocol_is(roster->kit.protocol.protocol, "token") && tell_start(roster, scenario, error, error_size)) {
        return -1;
    }
    return protocol_tell_entries(&roster->kit.protocol, scenario, roster->seed, error, error_size);
}

int roster_make(struct roster *roster, const struct scenario *scenario, uint64_t seed, char *error, size_t error_size)
{
    *roster = (struct roster){.seed = seed,
                              .clock_offset_s = scenario->clock.offset_s,
                              .clock_drift_ppm = scenario->clock.drift_ppm,
                              .clock_wander_ppm = scenario->clock.wander_ppm};
    return mote_kit_make(&roster->kit, scenario, error, error_size) ||
                   deployment_make(&roster->deployment, scenario, seed, error, error_size)
               ? -1
               : roster_complete(roster, scenario, error, error_size);
}

void roster_free(struct roster *roster)
{
    deployment_free(&roster->deployment);
    *roster = (struct roster){0};
}

struct host_mote roster_mote(const struct roster *roster, uint32_t mote)
{
    const bool is_sink = mote >= roster->deployment.count;
    const struct recorded_node *node = &roster->deployment.nodes[mote];
    const struct mh_place place = is_sink ? place_from_metres(roster->sink_x_m, roster->sink_y_m, 0)
                                          : place_from_metres(node->x_m, node->y_m, node->z_m);
    struct host_mote what = mote_kit_mote(&roster->kit, roster_id(roster, mote), place, is_sink);
    if (!is_sink) {
        what.clock = local_clock_draw(roster->seed, mote, roster->clock_offset_s, roster->clock_drift_ppm,
                                      roster->clock_wander_ppm);
    }
    return what;
}

bool roster_computes(const struct roster *roster, uint32_t mote)
{
    return (mote >= roster->deployment.count) != nodes_lead(&roster->kit.protocol);
}

bool roster_has_clocks(const struct roster *roster)
{
    return roster->kit.synchronised ||
           fmax(roster->clock_offset_s, fmax(roster->clock_drift_ppm, roster->clock_wander_ppm)) > 0;
}

mh_node_id roster_id(const struct roster *roster, uint32_t mote)
{
    return mote < roster->deployment.count ? roster->deployment.nodes[mote].id : roster->sink_id;
}

uint32_t roster_find(const struct roster *roster, mh_node_id id)
{
    return (uint32_t)deployment_find(&roster->deployment, id);
}
