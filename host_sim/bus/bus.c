#include "bus/bus.h"

#include "reals.h"
#include "scenario/text.h"
#include "totals.h"

#include "motehound/wire.h"

#include "motehound_cluster_t.h"
#include "motehound_frame_t.h"
#include "motehound_local_t.h"
#include "motehound_mote_t.h"
#include "motehound_node_t.h"
#include "motehound_run_begin_t.h"
#include "motehound_run_end_t.h"
#include "motehound_totals_t.h"
#include "motehound_track_t.h"
#include "motehound_truth_t.h"
#include "motehound_watch_t.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* A simulation is a thousand times faster than what it simulates; UDP's buffers hold some hundred messages. */
#define OUTSIDE_PAUSE_NS 50000

/* Let the machine's clock come to where simulated time is, at the bus's pace. A signal ends the wait: a run that is to stop
 * shall not sleep on. */
static void keep_pace(struct bus *bus, double time_s)
{
    struct timespec clock;
    clock_gettime(CLOCK_MONOTONIC, &clock);
    const double now_s = (double)clock.tv_sec + 1e-9 * (double)clock.tv_nsec, ahead_s = time_s / bus->pace;
    if (bus->began_s <= 0) {
        bus->began_s = now_s - ahead_s;
    }
    const double left_s = bus->began_s + ahead_s - now_s;
    if (left_s > 0) {
        const double whole_s = floor(left_s);
        const struct timespec wait = {(time_t)whole_s, (long)((left_s - whole_s) * 1e9)};
        nanosleep(&wait, NULL);
    }
}

static void publish(struct bus *bus, const char *channel, double time_s, void *bytes, int length)
{
    bus->time_s = time_s;
    bool sound = lcm_publish(bus->lcm, channel, bytes, (unsigned)length) == 0;
    while (sound && lcm_handle_timeout(bus->lcm, 0) > 0) {}
    if (sound && bus->log != NULL) {
        lcm_eventlog_event_t event = {
            .timestamp = (int64_t)llround(time_s * 1e6),
            .channellen = (int32_t)strlen(channel),
            .datalen = length,
            .channel = (char *)channel,
            .data = bytes,
        };
        sound = lcm_eventlog_write_event(bus->log, &event) == 0;
    }
    if (bus->outside != NULL) {
        /* a network that drops messages is no failure of the run, but listeners shall have time to take them */
        const struct timespec pause = {.tv_nsec = OUTSIDE_PAUSE_NS};
        if (bus->pace > 0) {
            keep_pace(bus, time_s);
        }
        lcm_publish(bus->outside, channel, bytes, (unsigned)length);
        nanosleep(&pause, NULL);
    }
    bus->failed = bus->failed || !sound;
}

/* The longest message but for a cluster: the totals, whose names are short; all other fields are fixed. */
enum { ENCODED_MAX = 1024 + 64 * TOTAL_COUNT };

/* Encode a message of a generated type and publish it at `at_s`. */
#define PUBLISH(bus, channel, type, message, at_s)                                                                     \
    do {                                                                                                               \
        uint8_t encoded[ENCODED_MAX];                                                                                  \
        const int encoded_length = type##_encode(encoded, 0, sizeof encoded, &(message));                              \
        if (encoded_length < 0) {                                                                                      \
            (bus)->failed = true;                                                                                      \
        } else {                                                                                                       \
            publish(bus, channel, at_s, encoded, encoded_length);                                                      \
        }                                                                                                              \
    } while (0)

void bus_prepare(void)
{
    __motehound_cluster_t_get_hash();
    __motehound_frame_t_get_hash();
    __motehound_local_t_get_hash();
    __motehound_mote_t_get_hash();
    __motehound_node_t_get_hash();
    __motehound_run_begin_t_get_hash();
    __motehound_run_end_t_get_hash();
    __motehound_totals_t_get_hash();
    __motehound_track_t_get_hash();
    __motehound_truth_t_get_hash();
    __motehound_watch_t_get_hash();
}

int bus_open(struct bus *bus, int32_t run, const char *log_path, lcm_t *outside, double pace, char *error,
             size_t error_size)
{
    *bus = (struct bus){.lcm = lcm_create("memq://"), .outside = outside, .run = run, .pace = pace};
    if (bus->lcm == NULL) {
        return fail(error, error_size, "memq://: cannot create an LCM");
    }
    if (log_path != NULL && (bus->log = lcm_eventlog_create(log_path, "w")) == NULL) {
        lcm_destroy(bus->lcm);
        return fail(error, error_size, "%s: cannot write", log_path);
    }
    return 0;
}

int bus_close(struct bus *bus, char *error, size_t error_size)
{
    if (bus->log != NULL) {
        bus->failed = fflush(bus->log->f) != 0 || ferror(bus->log->f) || bus->failed;
        lcm_eventlog_destroy(bus->log);
    }
    lcm_destroy(bus->lcm);
    return bus->failed
               ? fail(error, error_size, "events.lcm: a message of run %ld could not be written", (long)bus->run)
               : 0;
}

static void on_node(void *context, mh_node_id id, const struct mh_place *place)
{
    struct bus *bus = context;
    const motehound_node_t message = {.time_s = bus->time_s,
                                      .run = bus->run,
                                      .node = (int32_t)id,
                                      .x_m = place->x_mm * 1e-3,
                                      .y_m = place->y_mm * 1e-3,
                                      .z_m = place->z_mm * 1e-3};
    PUBLISH(bus, BUS_NODE, motehound_node_t, message, message.time_s);
}

static void on_truth(void *context, const struct truth *truth)
{
    struct bus *bus = context;
    const motehound_truth_t message = {.time_s = truth->time_s,
                                       .run = bus->run,
                                       .target = (int32_t)truth->target,
                                       .present = truth->present,
                                       .x_m = truth->x_m,
                                       .y_m = truth->y_m,
                                       .vx_mps = truth->vx_mps,
                                       .vy_mps = truth->vy_mps,
                                       .rate = truth->rate};
    PUBLISH(bus, BUS_TRUTH, motehound_truth_t, message, message.time_s);
}

static void on_frame(void *context, double time_s, mh_node_id sender, mh_node_id destination, const uint8_t *bytes,
                     size_t length)
{
    struct bus *bus = context;
    if (length > MH_FRAME_MAX) {
        bus->failed = true;
        return;
    }
    motehound_frame_t message = {.time_s = time_s,
                                 .run = bus->run,
                                 .sender = (int32_t)sender,
                                 .destination = (int32_t)destination,
                                 .length = (int16_t)length};
    memcpy(message.data, bytes, length);
    PUBLISH(bus, BUS_FRAME, motehound_frame_t, message, message.time_s);
}

/* What the tracker says of its own uncertainty, and of the source's release. */
static void put_states(motehound_track_t *message, const struct mh_estimate *estimate)
{
    message->cov_xx_m2 = number_of(estimate->covariance.xx);
    message->cov_xy_m2 = number_of(estimate->covariance.xy);
    message->cov_yy_m2 = number_of(estimate->covariance.yy);
    message->cov_13 = number_of(estimate->covariance_more[0]);
    message->cov_23 = number_of(estimate->covariance_more[1]);
    message->cov_33 = number_of(estimate->covariance_more[2]);
    message->cov_14 = number_of(estimate->covariance_more[3]);
    message->cov_24 = number_of(estimate->covariance_more[4]);
    message->cov_34 = number_of(estimate->covariance_more[5]);
    message->cov_44 = number_of(estimate->covariance_more[6]);
    message->states = estimate->states;
    message->rate = number_of(estimate->rate);
}

static void put_group(motehound_track_t *message, const struct mh_estimate *estimate)
{
    message->mode = estimate->mode;
    message->members = estimate->members;
    message->extent_m = number_of(estimate->extent);
    for (size_t i = 0; i < MH_GROUP_MAX && i < sizeof message->of / sizeof message->of[0]; i++) {
        message->of[i] = (int32_t)estimate->of[i];
    }
}

static void put_truth(motehound_track_t *message, const struct truth *truth)
{
    message->true_known = truth->present;
    message->true_x_m = truth->x_m;
    message->true_y_m = truth->y_m;
    message->true_vx_mps = truth->vx_mps;
    message->true_vy_mps = truth->vy_mps;
    message->true_rate = truth->rate;
}

static motehound_track_t track_of(const struct bus *bus, mh_node_id head, const struct mh_estimate *estimate,
                                  const struct truth *at_time, const struct truth *at_arrival)
{
    const double origin_x = estimate->origin.x_mm * 1e-3, origin_y = estimate->origin.y_mm * 1e-3;
    motehound_track_t message = {
        .time_s = at_time->time_s,
        .run = bus->run,
        .target = (int32_t)estimate->target,
        .number = at_time->present ? (int32_t)at_time->target : -1,
        .x_m = origin_x + number_of(estimate->position.x),
        .y_m = origin_y + number_of(estimate->position.y),
        .vx_mps = number_of(estimate->velocity.x),
        .vy_mps = number_of(estimate->velocity.y),
        .raw_x_m = origin_x + number_of(estimate->raw.x),
        .raw_y_m = origin_y + number_of(estimate->raw.y),
        .arrival_s = at_arrival->time_s,
        .measurements = estimate->measurements,
        .flags = estimate->flags,
        .head = (int32_t)head,
        .arrival_known = at_arrival->present,
        .arrival_x_m = at_arrival->x_m,
        .arrival_y_m = at_arrival->y_m,
    };
    put_truth(&message, at_time);
    put_states(&message, estimate);
    put_group(&message, estimate);
    return message;
}

static void on_estimate(void *context, double time_s, mh_node_id head, const struct mh_estimate *estimate,
                        const struct truth *at_time, const struct truth *at_arrival)
{
    struct bus *bus = context;
    const motehound_track_t message = track_of(bus, head, estimate, at_time, at_arrival);
    PUBLISH(bus, BUS_TRACK, motehound_track_t, message, time_s);
}

static void on_local(void *context, double time_s, uint8_t cluster, mh_node_id head, const struct mh_estimate *estimate,
                     const struct truth *at_time)
{
    struct bus *bus = context;
    const motehound_local_t message = {.time_s = at_time->time_s,
                                       .run = bus->run,
                                       .cluster = cluster,
                                       .track = track_of(bus, head, estimate, at_time, at_time)};
    PUBLISH(bus, BUS_LOCAL, motehound_local_t, message, time_s);
}

static void on_sink(void *context, double time_s, const struct mh_estimate *estimate, const struct truth *at_time)
{
    struct bus *bus = context;
    const double x_m = estimate->origin.x_mm * 1e-3 + number_of(estimate->position.x);
    const double y_m = estimate->origin.y_mm * 1e-3 + number_of(estimate->position.y);
    motehound_track_t message = {
        .time_s = at_time->time_s,
        .run = bus->run,
        .target = (int32_t)estimate->target,
        .number = at_time->present ? (int32_t)at_time->target : -1,
        .x_m = x_m,
        .y_m = y_m,
        .vx_mps = number_of(estimate->velocity.x),
        .vy_mps = number_of(estimate->velocity.y),
        .raw_x_m = x_m,
        .raw_y_m = y_m,
        .arrival_s = at_time->time_s,
        .head = -1,
        .arrival_known = at_time->present,
        .arrival_x_m = at_time->x_m,
        .arrival_y_m = at_time->y_m,
    };
    put_truth(&message, at_time);
    put_states(&message, estimate);
    PUBLISH(bus, BUS_SINK, motehound_track_t, message, time_s);
}

static void on_cluster(void *context, double time_s, uint32_t track, mh_node_id head, const mh_node_id *members,
                       size_t count, bool is_new)
{
    struct bus *bus = context;
    int32_t *ids = malloc((count + 1) * sizeof *ids);
    const motehound_cluster_t message = {.time_s = time_s,
                                         .run = bus->run,
                                         .track = (int32_t)track,
                                         .head = (int32_t)head,
                                         .is_new = is_new,
                                         .count = (int32_t)count,
                                         .members = ids};
    const int size = motehound_cluster_t_encoded_size(&message);
    uint8_t *encoded = malloc((size_t)size);
    if (ids != NULL && encoded != NULL) {
        for (size_t i = 0; i < count; i++) {
            ids[i] = (int32_t)members[i];
        }
        publish(bus, BUS_CLUSTER, time_s, encoded, motehound_cluster_t_encode(encoded, 0, size, &message));
    } else {
        bus->failed = true;
    }
    free(encoded);
    free(ids);
}

static void on_watch(void *context, double time_s, const struct watch_news *watch)
{
    struct bus *bus = context;
    const motehound_watch_t message = {.time_s = time_s,
                                       .run = bus->run,
                                       .target = (int32_t)watch->target,
                                       .number = (int32_t)watch->number,
                                       .head = (int32_t)watch->head,
                                       .prince = (int32_t)watch->prince,
                                       .prince_s = watch->prince_s,
                                       .x_m = watch->x_m,
                                       .y_m = watch->y_m,
                                       .vx_mps = watch->vx_mps,
                                       .vy_mps = watch->vy_mps,
                                       .sd_m = watch->sd_m,
                                       .extent_m = watch->extent_m,
                                       .members = (int32_t)watch->members};
    PUBLISH(bus, BUS_WATCH, motehound_watch_t, message, time_s);
}

static void on_mote(void *context, double time_s, mh_node_id id, const struct mote_state *state)
{
    struct bus *bus = context;
    const motehound_mote_t message = {.time_s = time_s,
                                      .run = bus->run,
                                      .node = (int32_t)id,
                                      .energy_mj = state->energy_mj,
                                      .battery_left = state->battery_left,
                                      .alive = state->alive,
                                      .clock_error_ms = state->clock_error_ms};
    PUBLISH(bus, BUS_MOTE, motehound_mote_t, message, message.time_s);
}

struct observer bus_observer(struct bus *bus)
{
    const bool heard = bus->log != NULL || bus->outside != NULL;
    return (struct observer){
        .context = bus,
        .node = heard || bus->searches || bus->run == 0 ? on_node : NULL,
        .truth = on_truth,
        .estimate = on_estimate,
        .sink = on_sink,
        .local = on_local,
        .cluster = heard || bus->searches ? on_cluster : NULL,
        .watch = on_watch,
        .frame = heard ? on_frame : NULL,
        .mote = heard ? on_mote : NULL,
    };
}

void bus_begin(struct bus *bus, uint64_t seed, const char *scenario, const char *version)
{
    const motehound_run_begin_t message = {.time_s = bus->time_s,
                                           .run = bus->run,
                                           .seed = (int64_t)seed,
                                           .scenario = (char *)scenario,
                                           .version = (char *)version};
    PUBLISH(bus, BUS_RUN_BEGIN, motehound_run_begin_t, message, message.time_s);
}

static void tell_totals(struct bus *bus, const struct simulation_counters *counters)
{
    double values[TOTAL_COUNT];
    const motehound_totals_t message = {
        .time_s = bus->time_s, .run = bus->run, .count = TOTAL_COUNT, .names = (char **)total_names, .values = values};
    totals_of(counters, values);
    PUBLISH(bus, BUS_TOTALS, motehound_totals_t, message, message.time_s);
}

void bus_end(struct bus *bus, const struct simulation_counters *counters)
{
    tell_totals(bus, counters);
    const motehound_run_end_t message = {
        .time_s = bus->time_s,
        .run = bus->run,
        .events = (int64_t)counters->events,
        .frames_sent_beacons = (int64_t)counters->frames_sent[MH_MESSAGE_BEACON],
        .frames_sent_reports = (int64_t)counters->frames_sent[MH_MESSAGE_REPORT],
        .frames_sent_requests = (int64_t)counters->frames_sent[MH_MESSAGE_REQUEST],
        .frames_received = (int64_t)counters->frames_received,
        .frames_lost = (int64_t)counters->frames_lost,
        .readings = counters->motes.readings,
        .readings_refused = counters->motes.readings_refused,
        .reports = counters->motes.reports,
        .reports_asked = counters->motes.reports_asked,
        .reports_no_route = counters->motes.reports_no_route,
        .measurements = counters->head.measurements,
        .measurements_late = counters->head.late,
        .measurements_overflowed = counters->head.overflowed,
    };
    PUBLISH(bus, BUS_RUN_END, motehound_run_end_t, message, message.time_s);
}

int bus_outside(const char *url, lcm_t **outside, char *error, size_t error_size)
{
    *outside = NULL;
    if (strncmp(url, "memq://", 7) == 0) {
        return 0;
    }
    if (strstr(url, "://") == NULL) { /* where LCM would choose one itself */
        return fail(error, error_size, "--bus %s: expected a URL such as udpm://239.255.76.67:7667?ttl=0", url);
    }
    fflush(stderr);
    const int kept = dup(STDERR_FILENO);
    const int nowhere = open("/dev/null", O_WRONLY);
    if (kept >= 0 && nowhere >= 0) {
        dup2(nowhere, STDERR_FILENO);
    }
    *outside = lcm_create(url);
    if (*outside != NULL && lcm_publish(*outside, BUS_HELLO, "", 0) != 0) {
        lcm_destroy(*outside);
        *outside = NULL;
    }
    fflush(stderr);
    if (kept >= 0) {
        dup2(kept, STDERR_FILENO);
        close(kept);
    }
    if (nowhere >= 0) {
        close(nowhere);
    }
    return *outside != NULL ? 0
                            : fail(error, error_size,
                                   "--bus %s: expected a URL that LCM can serve, such as "
                                   "udpm://239.255.76.67:7667?ttl=0 (which needs a multicast route)",
                                   url);
}
