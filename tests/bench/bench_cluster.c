/* A turn of a node of the protocol `cluster` as head, with the tracker `range`: the track comes from the head before, the node asks at the next instant,
 * eight neighbours answer, it localises, elects the next head and hands the track on. Neighbours: as many as there can be. */
#include "bench.h"
#include "motehound/cluster.h"
#include "motehound/geographic.h"
#include "motehound/mote.h"
#include "motehound/range.h"
#include "ranging.h"

#include <string.h>

enum { SELF = 7, SINK = 1, BEFORE = 100, ANSWERS = 8, HERE = 8000 /* the instant before */ };

struct {
    struct mh_mote mote;
    struct mh_cluster_node protocol;
    struct mh_head head;
    struct mh_range tracker;
} bench_state;

static struct mh_cluster_config clustering;
static struct mh_range_config tracking;
static const struct mh_sensor_config sensor = {
    .q20_per_count = 1 << 10, .counts_max = 65535, .interval = RANGING_INTERVAL, .threshold = 0};
static const struct mh_head_config heading = {.tracker = &mh_tracker_range,
                                              .tracker_config = &tracking,
                                              .tracker_state = &bench_state.tracker,
                                              .interval = RANGING_INTERVAL,
                                              .window = 150,
                                              .tolerance = 500};
static const struct mh_mote_config config = {.id = SELF,
                                             .sensor = &sensor,
                                             .head = &heading,
                                             .protocol = &mh_protocol_cluster,
                                             .protocol_config = &clustering,
                                             .protocol_state = &bench_state.protocol,
                                             .head_state = &bench_state.head};
static mh_hand_over_t track;
static struct mh_message message;
static uint8_t frame[MH_FRAME_MAX]; /* as a radio has received it */
static mh_tick alarm_time;
static bool estimated;

static void transmit(void *context, mh_node_id destination, const uint8_t *bytes, size_t length)
{
    (void)context;
    (void)destination;
    (void)bytes;
    (void)length;
}

static void set_alarm(void *context, mh_tick time)
{
    (void)context;
    alarm_time = time;
}

static void report(void *context, const struct mh_estimate *estimate)
{
    (void)context;
    estimated = estimate->measurements >= ANSWERS;
}

static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report};

/* All alarms until `time`; what is sent is acknowledged. */
static void pass(mh_tick time)
{
    while (!mh_tick_before(time, alarm_time)) {
        const uint32_t sent = bench_state.mote.counters.frames_sent;
        const mh_tick now = alarm_time;
        mh_mote_alarm(&bench_state.mote, now);
        if (bench_state.mote.counters.frames_sent != sent) {
            mh_mote_sent(&bench_state.mote, now, MH_SENT_OK);
        }
    }
}

static void hear(mh_tick now)
{
    size_t length;
    if (mh_wire_encode(mh_protocol_cluster.types, &message, frame, &length) == MH_OK) {
        (void)mh_mote_frame(&bench_state.mote, now, frame, length);
    }
}

/* Distances from the target, which is `ahead` m along x from the origin, to neighbour i. */
static struct mh_place place_of(uint8_t i)
{
    const struct mh_place place = {(i % 4 * 20 - 20) * 1000, (i / 4 % 4 * 20 - 30) * 1000, 0};
    return place;
}

static mh_q20 range_to(uint8_t i, mh_real ahead)
{
    const struct mh_place origin = {0, 0, 0}, place = place_of(i);
    const struct mh_vec2 at = mh_place_relative(&place, &origin);
    return mh_q20_from_real(mh_sqrt(mh_squared(at.x - ahead) + mh_squared(at.y)));
}

/* The track as the head before has it: the target goes along x at 9 m/s and is about to leave this node's disc. */
static void make_track(void)
{
    struct mh_estimate estimate;
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length = 0;
    (void)mh_tracker_range.init(&bench_state.tracker, &tracking, RANGING_INTERVAL);
    for (uint8_t k = 0; k < 3; k++) {
        struct mh_measurement *const set = bench_state.head.measurements; /* not in use yet */
        memset(set, 0, ANSWERS * sizeof set[0]);
        for (uint8_t i = 0; i < ANSWERS; i++) {
            set[i].node = 100u + i;
            set[i].place = place_of(i);
            set[i].time = (mh_tick)(HERE - (2 - k) * RANGING_INTERVAL);
            set[i].value = range_to(i, (mh_real)(18 * k) - 18);
        }
        (void)mh_tracker_range.step(&bench_state.tracker, set[0].time, set, ANSWERS, &estimate);
    }
    (void)mh_tracker_range.save(&bench_state.tracker, bytes, &length);
    const mh_hand_over_t made = {
        .track = BEFORE, .generation = 3, .time_ms = HERE, .parts = 1, .length = (uint8_t)(length + 1)};
    track = made;
    memcpy(track.data + 1, bytes, length);
}

void bench_setup(void)
{
    const struct mh_place sink = {400000, 0, 0};
    mh_range_config_default(&tracking);
    tracking.range_sd_m = 5;
    tracking.sensing_range_m = 50;
    tracking.acceleration_sd_mps2 = 0.43f;
    tracking.speed_mps = 4.47f;
    tracking.height_m = 0;
    tracking.tolerance_m = 5;
    mh_cluster_config_default(&clustering, MH_ELECTION_SACX, SINK, &sink);
}

void bench_prepare(unsigned step)
{
    (void)step;
    make_track();
    estimated = false;
    if (mh_mote_init(&bench_state.mote, &config, &port, NULL, 0) != MH_OK) {
        return;
    }
    for (unsigned i = 0; i < MH_NEIGHBOURS_MAX; i++) {
        const struct mh_place place = place_of((uint8_t)i);
        const mh_hello_t hello = {
            .sender = (int32_t)(BEFORE + i), .x_mm = place.x_mm + (int32_t)(i / 16) * 40000, .y_mm = place.y_mm};
        message.kind = MH_MESSAGE_HELLO;
        message.as.hello = hello;
        hear(i);
    }
    pass(HERE + 200);
}

static void hear_track(void)
{
    const struct mh_place place = {0, 0, 0};
    message.kind = MH_MESSAGE_HAND_OVER;
    message.as.hand_over = track;
    mh_geographic_address(&message, BEFORE, 1, SELF, &place);
    hear(HERE + 252);
    message.envelope = MH_ENVELOPE_NONE;
}

static void hear_answers(void)
{
    for (uint8_t i = 0; i < ANSWERS; i++) {
        const struct mh_place place = place_of(i);
        const mh_answer_t answer = {.sender = BEFORE + i,
                                    .time_ms = HERE + RANGING_INTERVAL,
                                    .x_mm = place.x_mm,
                                    .y_mm = place.y_mm,
                                    .value_q20 = range_to(i, 36)};
        message.kind = MH_MESSAGE_ANSWER;
        message.as.answer = answer;
        hear(HERE + RANGING_INTERVAL + 20u + i);
    }
}

void bench_step(void)
{
    hear_track();
    pass(HERE + RANGING_INTERVAL + 10);
    hear_answers();
    pass(HERE + 2 * RANGING_INTERVAL - 10);
}

bool bench_worked(void) { return estimated && bench_state.protocol.events.handed == 1; }
