#include "roster.h"

#include "world/sensor.h"

#include <math.h>
#include <stdio.h>

struct mh_place place_from_metres(double x_m, double y_m, double z_m)
{
    return (struct mh_place){(int32_t)lround(x_m * 1000), (int32_t)lround(y_m * 1000), (int32_t)lround(z_m * 1000)};
}

int roster_complete(struct roster *roster, const struct scenario *scenario, mh_tick epoch, char *error,
                    size_t error_size)
{
    const size_t nodes = roster->deployment.count;
    if (nodes < 1 || nodes >= UINT32_C(1) << 28 || roster->deployment.nodes[nodes - 1].id >= MH_BROADCAST - 1) {
        snprintf(error, error_size, "%zu nodes, expected 1 to 268,435,455 with identifiers below 4294967294", nodes);
        return -1;
    }
    const mh_tick interval = roster->sensor.interval;
    const double window_s = scenario->tracker.window_s;
    roster->count = (uint32_t)nodes + 1;
    roster->sink_id = roster->deployment.nodes[nodes - 1].id + 1;
    roster->sink_x_m = scenario->network.sink_x_m;
    roster->sink_y_m = scenario->network.sink_y_m;
    roster->head = (struct mh_head_config){
        .tracker = roster->tracker.tracker,
        .tracker_config = &roster->tracker.config,
        .epoch = epoch,
        .interval = interval,
        .window = window_s > 0 ? (mh_tick)lround(window_s * MH_TICKS_PER_S) : interval / 2,
    };
    return 0;
}

int roster_make(struct roster *roster, const struct scenario *scenario, uint64_t seed, char *error, size_t error_size)
{
    const struct mh_place far_corner = place_from_metres(scenario->field.width_m, scenario->field.height_m, 0);
    const struct mh_region region = {0, far_corner.x_mm, 0, far_corner.y_mm};
    *roster = (struct roster){.sensor = sensor_config(scenario)};
    if (deployment_make(&roster->deployment, scenario, seed, error, error_size) ||
        tracker_choose(scenario, &region, &roster->tracker, error, error_size) ||
        protocol_choose(scenario->network.protocol, scenario, &roster->protocol, error, error_size)) {
        return -1;
    }
    if (roster->tracker.measures != QUANTITY_CONCENTRATION) {
        snprintf(error, error_size, "tracker.name: `%s` works on ranges, a diffusing source gives concentrations",
                 scenario->tracker.name);
        return -1;
    }
    if (roster->sensor.interval < 1) {
        snprintf(error, error_size, "sensor.interval_s: %g, expected at least 0.001", scenario->sensor.interval_s);
        return -1;
    }
    return roster_complete(roster, scenario, 0, error, error_size);
}

void roster_free(struct roster *roster)
{
    deployment_free(&roster->deployment);
    *roster = (struct roster){0};
}

struct host_mote roster_mote(const struct roster *roster, uint32_t mote)
{
    struct host_mote what = {.id = roster_id(roster, mote),
                             .protocol = roster->protocol.protocol,
                             .protocol_config = &roster->protocol.config};
    if (mote < roster->deployment.count) {
        const struct recorded_node *node = &roster->deployment.nodes[mote];
        what.place = place_from_metres(node->x_m, node->y_m, node->z_m);
        what.sensor = &roster->sensor;
    } else {
        what.place = place_from_metres(roster->sink_x_m, roster->sink_y_m, 0);
        what.head = &roster->head;
    }
    return what;
}

mh_node_id roster_id(const struct roster *roster, uint32_t mote)
{
    return mote < roster->deployment.count ? roster->deployment.nodes[mote].id : roster->sink_id;
}

uint32_t roster_find(const struct roster *roster, mh_node_id id)
{
    return (uint32_t)deployment_find(&roster->deployment, id);
}
