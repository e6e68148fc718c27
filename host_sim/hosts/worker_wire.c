#include "hosts/worker_wire.h"

#include "bus/bus.h"
#include "reals.h"
#include "scenario/text.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Awake for so long: several times what an answer takes when nothing is in its way. */
static const double awake_s = 50e-6;

/* ---- the link ---- */

double worker_now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int64_t worker_random(void)
{
    int64_t number = 0;
    const int source = open("/dev/urandom", O_RDONLY);
    if (source < 0 || read(source, &number, sizeof number) != sizeof number) {
        number = (int64_t)(1e9 * worker_now_s()) ^ (int64_t)getpid() << 40;
    }
    if (source >= 0) {
        close(source);
    }
    return (number & INT64_MAX) | 1;
}

int worker_link_open(struct worker_link *link, const char *url, double drop_share, char *error, size_t error_size)
{
    *link = (struct worker_link){.drop_share = drop_share, .drops = {(uint64_t)worker_random()}};
    if (bus_outside(url, &link->lcm, error, error_size) != 0) {
        return -1;
    }
    if (!link->lcm) {
        return fail(error, error_size,
                    "--bus %s: expected a bus that other processes hear too, such as udpm://239.255.76.67:7667?ttl=0",
                    url);
    }
    return 0;
}

void worker_link_close(struct worker_link *link)
{
    if (link->lcm) {
        lcm_destroy(link->lcm);
        link->lcm = NULL;
    }
}

void worker_link_publish(struct worker_link *link, const char *channel, const void *bytes, size_t size)
{
    const bool dropped = link->drop_share > 0 && random_uniform(link->drops, link->published) < link->drop_share;
    link->published++;
    if (!dropped) {
        (void)lcm_publish(link->lcm, channel, bytes, (unsigned)size);
    }
}

static bool handle_one(struct worker_link *link, int lifeline, int wait_ms)
{
    struct pollfd what[] = {{lcm_get_fileno(link->lcm), POLLIN, 0}, {lifeline, POLLIN, 0}};
    if (poll(what, lifeline >= 0 ? 2 : 1, wait_ms) > 0 && (what[0].revents & POLLIN) != 0) {
        lcm_handle(link->lcm);
        return true;
    }
    return what[1].revents != 0;
}

void worker_link_handle(struct worker_link *link, double wait_s, int lifeline)
{
    const double began_s = worker_now_s();
    const double awake = wait_s < awake_s ? wait_s : awake_s;
    do {
        if (handle_one(link, -1, 0)) {
            return;
        }
        sched_yield();
    } while (worker_now_s() - began_s < awake);
    if (wait_s > awake_s) {
        handle_one(link, lifeline, (int)(1e3 * (wait_s - awake_s)) + 1);
    }
}

const char *worker_channel(int64_t worker, enum worker_request request, char channel[WORKER_CHANNEL_MAX])
{
    static const char *const kinds[] = {"ASSIGN", "MOTES", "WINDOW", "COUNT", ".*"};
    snprintf(channel, WORKER_CHANNEL_MAX, "MOTEHOUND_WORKER_%016" PRIx64 "_%s", (uint64_t)worker, kinds[request]);
    return channel;
}

/* ---- motes, events, actions ---- */

motehound_worker_mote_t worker_mote_message(uint32_t mote, const struct host_mote *what)
{
    return (motehound_worker_mote_t){.mote = (int32_t)mote,
                                     .id = (int32_t)what->id,
                                     .x_mm = what->place.x_mm,
                                     .y_mm = what->place.y_mm,
                                     .z_mm = what->place.z_mm,
                                     .is_sink = what->sensor == NULL,
                                     .offset_us = what->clock.offset_us,
                                     .drift_ppm = what->clock.drift_ppm,
                                     .wander_ppm = what->clock.wander_ppm,
                                     .wander_phase = what->clock.wander_phase,
                                     .board = (char *)(what->board ? what->board : "")};
}

motehound_worker_event_t worker_event_message(const struct host_event *event)
{
    motehound_worker_event_t message = {
        .time_us = (int64_t)event->time, .kind = (int8_t)event->kind, .count = 1, .motes = (int32_t *)&event->mote};
    switch (event->kind) {
    case HOST_READING:
        message.value = event->as.reading.counts;
        message.target = (int8_t)event->as.reading.target;
        break;
    case HOST_FRAME:
        message.count = (int32_t)event->as.frame.count;
        message.motes = (int32_t *)event->as.frame.receivers;
        message.length = event->as.frame.length;
        message.frame = (uint8_t *)event->as.frame.bytes;
        break;
    case HOST_SENT:
        message.value = (int32_t)event->as.sent;
        break;
    default:
        break;
    }
    return message;
}

int worker_event_read(const motehound_worker_event_t *message, struct host_event *event)
{
    const bool is_frame = message->kind == HOST_FRAME;
    if (message->kind < HOST_START || message->kind > HOST_PROBE || message->time_us < 0 ||
        (!is_frame && message->count != 1) || message->length > MH_FRAME_MAX ||
        (message->kind == HOST_SENT && (message->value < MH_SENT_OK || message->value > MH_SENT_BUSY))) {
        return -1;
    }
    *event = (struct host_event){.time = (sim_time)message->time_us,
                                 .kind = (enum host_event_kind)message->kind,
                                 .mote = is_frame ? 0 : (uint32_t)message->motes[0]};
    switch (event->kind) {
    case HOST_READING:
        event->as.reading.counts = message->value;
        event->as.reading.target = (uint8_t)message->target;
        break;
    case HOST_FRAME:
        event->as.frame.receivers = (uint32_t *)message->motes;
        event->as.frame.count = (uint32_t)message->count;
        event->as.frame.bytes = message->frame;
        event->as.frame.length = (uint8_t)message->length;
        break;
    case HOST_SENT:
        event->as.sent = (enum mh_sent)message->value;
        break;
    default:
        break;
    }
    return 0;
}

enum { COVARIANCE_MORE = sizeof((struct mh_estimate *)NULL)->covariance_more / sizeof(mh_real) };

static motehound_worker_estimate_t estimate_message(const struct mh_estimate *estimate)
{
    motehound_worker_estimate_t message = {
        .origin_mm = {estimate->origin.x_mm, estimate->origin.y_mm, estimate->origin.z_mm},
        .time_ticks = estimate->time,
        .position_m = {number_of(estimate->position.x), number_of(estimate->position.y)},
        .velocity_mps = {number_of(estimate->velocity.x), number_of(estimate->velocity.y)},
        .covariance_m2 = {number_of(estimate->covariance.xx), number_of(estimate->covariance.xy),
                          number_of(estimate->covariance.yy)},
        .raw_m = {number_of(estimate->raw.x), number_of(estimate->raw.y)},
        .stored_m = {number_of(estimate->stored.x), number_of(estimate->stored.y)},
        .stored_velocity_mps = {number_of(estimate->stored_velocity.x), number_of(estimate->stored_velocity.y)},
        .age_s = number_of(estimate->age),
        .measurements = estimate->measurements,
        .target = estimate->target,
        .near = estimate->near,
        .extent_m = number_of(estimate->extent),
        .rate = number_of(estimate->rate),
        .members = estimate->members,
        .mode = estimate->mode,
        .states = estimate->states,
        .flags = estimate->flags};
    for (size_t i = 0; i < COVARIANCE_MORE; i++) {
        message.covariance_more[i] = number_of(estimate->covariance_more[i]);
    }
    for (size_t i = 0; i < MH_GROUP_MAX; i++) {
        message.of[i] = estimate->of[i];
    }
    return message;
}

static struct mh_estimate estimate_read(const motehound_worker_estimate_t *message)
{
    struct mh_estimate estimate = {
        .origin = {message->origin_mm[0], message->origin_mm[1], message->origin_mm[2]},
        .time = (mh_tick)message->time_ticks,
        .position = {real_of(message->position_m[0]), real_of(message->position_m[1])},
        .velocity = {real_of(message->velocity_mps[0]), real_of(message->velocity_mps[1])},
        .covariance = {.xx = real_of(message->covariance_m2[0]),
                       .xy = real_of(message->covariance_m2[1]),
                       .yy = real_of(message->covariance_m2[2])},
        .raw = {real_of(message->raw_m[0]), real_of(message->raw_m[1])},
        .stored = {real_of(message->stored_m[0]), real_of(message->stored_m[1])},
        .stored_velocity = {real_of(message->stored_velocity_mps[0]), real_of(message->stored_velocity_mps[1])},
        .age = real_of(message->age_s),
        .measurements = (uint16_t)message->measurements,
        .target = (uint32_t)message->target,
        .near = (uint32_t)message->near,
        .extent = real_of(message->extent_m),
        .rate = real_of(message->rate),
        .members = (uint8_t)message->members,
        .mode = (uint8_t)message->mode,
        .states = (uint8_t)message->states,
        .flags = (uint16_t)message->flags};
    for (size_t i = 0; i < COVARIANCE_MORE; i++) {
        estimate.covariance_more[i] = real_of(message->covariance_more[i]);
    }
    for (size_t i = 0; i < MH_GROUP_MAX; i++) {
        estimate.of[i] = (uint32_t)message->of[i];
    }
    return estimate;
}

motehound_worker_action_t worker_action_message(const struct host_action *action, motehound_worker_estimate_t *estimate)
{
    motehound_worker_action_t message = {
        .time_us = (int64_t)action->time, .kind = (int8_t)action->kind, .mote = (int32_t)action->mote};
    switch (action->kind) {
    case HOST_TRANSMIT:
        message.destination = (int32_t)action->as.transmit.destination;
        message.length = action->as.transmit.length;
        message.frame = (uint8_t *)action->as.transmit.bytes;
        break;
    case HOST_REPORT:
        *estimate = estimate_message(&action->as.estimate);
        message.estimates = 1;
        message.estimate = estimate;
        break;
    case HOST_SLEEP:
        message.may_sleep = action->as.may_sleep;
        break;
    case HOST_CLOCK:
        message.clock_error_s = action->as.clock_error_s;
        break;
    case HOST_WORK:
        message.work_us = (int32_t)action->as.work.duration_us;
        message.work_message = action->as.work.message;
        message.work_localises = action->as.work.localises;
        break;
    case HOST_SENSE:
        break;
    }
    return message;
}

int worker_action_read(const motehound_worker_action_t *message, struct host_action *action)
{
    if (message->kind < HOST_TRANSMIT || message->kind > HOST_WORK || message->time_us < 0 ||
        message->length > MH_FRAME_MAX || (message->estimates == 1) != (message->kind == HOST_REPORT)) {
        return -1;
    }
    action->time = (sim_time)message->time_us;
    action->kind = (enum host_action_kind)message->kind;
    action->mote = (uint32_t)message->mote;
    switch (action->kind) {
    case HOST_TRANSMIT:
        action->as.transmit.destination = (mh_node_id)message->destination;
        action->as.transmit.length = (uint8_t)message->length;
        memcpy(action->as.transmit.bytes, message->frame, (size_t)message->length);
        break;
    case HOST_REPORT:
        action->as.estimate = estimate_read(message->estimate);
        break;
    case HOST_SLEEP:
        action->as.may_sleep = message->may_sleep != 0;
        break;
    case HOST_CLOCK:
        action->as.clock_error_s = message->clock_error_s;
        break;
    case HOST_WORK:
        if (message->work_us < 0 || message->work_message < 0 || message->work_message > MH_MESSAGE_KINDS) {
            return -1;
        }
        action->as.work.duration_us = (uint32_t)message->work_us;
        action->as.work.message = (uint8_t)message->work_message;
        action->as.work.localises = message->work_localises != 0;
        break;
    case HOST_SENSE:
        break;
    }
    return 0;
}

motehound_worker_board_t worker_board_message(const struct board_result *result)
{
    return (motehound_worker_board_t){.node = (int32_t)result->node,
                                      .board = (char *)result->board,
                                      .image = (char *)result->image,
                                      .fixed = result->fixed,
                                      .events = (int64_t)result->events,
                                      .cycles = (int64_t)result->cycles,
                                      .cycles_max = (int64_t)result->cycles_max,
                                      .rate_hz = result->rate_hz,
                                      .missed = (int64_t)result->missed,
                                      .overlapped = (int64_t)result->overlapped,
                                      .ram = (int32_t)result->ram,
                                      .variables = (int32_t)result->variables,
                                      .stack = (int32_t)result->stack,
                                      .reports_max = (int32_t)result->reports_max,
                                      .neighbours_max = (int32_t)result->neighbours_max,
                                      .step_classes = STEP_CLASSES,
                                      .steps = (int32_t *)result->steps.classes,
                                      .step_longest = (int64_t)result->steps.longest};
}

struct board_result worker_board_read(const motehound_worker_board_t *message)
{
    struct board_result result = {.node = (mh_node_id)message->node,
                                  .fixed = message->fixed != 0,
                                  .events = (uint64_t)message->events,
                                  .cycles = (uint64_t)message->cycles,
                                  .cycles_max = (uint64_t)message->cycles_max,
                                  .rate_hz = message->rate_hz,
                                  .missed = (uint64_t)message->missed,
                                  .overlapped = (uint64_t)message->overlapped,
                                  .ram = (uint32_t)message->ram,
                                  .variables = (uint32_t)message->variables,
                                  .stack = (uint32_t)message->stack,
                                  .reports_max = (uint32_t)message->reports_max,
                                  .neighbours_max = (uint32_t)message->neighbours_max,
                                  .steps = {.longest = (uint64_t)message->step_longest}};
    for (int32_t i = 0; i < message->step_classes && i < STEP_CLASSES; i++) {
        result.steps.classes[i] = message->steps[i];
    }
    snprintf(result.board, sizeof result.board, "%s", message->board);
    snprintf(result.image, sizeof result.image, "%s", message->image);
    return result;
}
