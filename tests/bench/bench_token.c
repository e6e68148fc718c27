/* A turn of a node of the protocol `token` as head, with the tracker `gas_small`: the token comes from the head before, the node asks at the next instant and samples,
 * eight neighbours answer, it estimates, scores the eight with who is around each, and hands the token on. */
#include "bench.h"
#include "leaking.h"
#include "motehound/geographic.h"
#include "motehound/mote.h"
#include "motehound/token.h"

#include <string.h>

enum {
    SELF = 7,
    SINK = 1,
    BEFORE = 100,
    ANSWERS = 8,
    AROUND = 12 /* two hops away */,
    HERE = 15000 /* the instant before */
};

struct {
    struct mh_mote mote;
    struct mh_token_node protocol;
    struct mh_head head;
    struct mh_gas_gaussian tracker;
} bench_state;

static struct mh_token_config searching;
static struct mh_gas_config tracking;
static const struct mh_sensor_config sensor = {
    .q20_per_count = 1, .counts_min = INT32_MIN, .counts_max = INT32_MAX, .interval = LEAKING_INTERVAL};
static const struct mh_head_config heading = {.tracker = &mh_tracker_gas_small,
                                              .tracker_config = &tracking,
                                              .tracker_state = &bench_state.tracker,
                                              .interval = LEAKING_INTERVAL,
                                              .window = 1000,
                                              .tolerance = LEAKING_INTERVAL / 4,
                                              .own_first = true};
static const struct mh_mote_config config = {.id = SELF,
                                             .place = {250000, 200000, 0},
                                             .sensor = &sensor,
                                             .head = &heading,
                                             .protocol = &mh_protocol_token,
                                             .protocol_config = &searching,
                                             .protocol_state = &bench_state.protocol,
                                             .head_state = &bench_state.head};
static uint8_t track[2 + MH_GAS_SAVED];
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
    estimated = estimate->measurements == ANSWERS + 1;
}

static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report};

/* What was sent is acknowledged, and what follows from that. */
static void settle(mh_tick now, uint32_t sent)
{
    for (; sent != bench_state.mote.counters.frames_sent; sent++) {
        mh_mote_sent(&bench_state.mote, now, MH_SENT_OK);
    }
}

static void pass(mh_tick time)
{
    while (!mh_tick_before(time, alarm_time)) {
        const uint32_t sent = bench_state.mote.counters.frames_sent;
        const mh_tick now = alarm_time;
        mh_mote_alarm(&bench_state.mote, now);
        settle(now, sent);
    }
}

static void hear(mh_tick now)
{
    size_t length;
    const uint32_t sent = bench_state.mote.counters.frames_sent;
    if (mh_wire_encode(mh_protocol_token.types, &message, frame, &length) == MH_OK) {
        (void)mh_mote_frame(&bench_state.mote, now, frame, length);
        settle(now, sent);
    }
}

/* A grid of 40 m around this node; the first eight are its neighbours. */
static struct mh_place place_of(uint8_t i)
{
    static const int8_t x[] = {-1, 0, 1, -1, 1, -1, 0, 1, -2, -1, 0, 1, 2, -2, 2, -2, 2, -2, 0, 2};
    static const int8_t y[] = {-1, -1, -1, 0, 0, 1, 1, 1, -2, -2, -2, -2, -2, -1, -1, 0, 0, 1, 2, 2};
    const struct mh_place place = {250000 + (int32_t)x[i] * 40000, 200000 + (int32_t)y[i] * 40000, 0};
    return place;
}

/* Of the leak's gas. */
static mh_q20 sample_at(const struct mh_place *place)
{
    static const struct mh_place origin = {0, 0, 0};
    static const struct mh_vec2 leak = {50, 200};
    mh_real concentration = 0;
    (void)mh_plume_model(&tracking.plume, mh_place_relative(place, &origin), leak, 0, &concentration, NULL);
    return mh_q20_from_real(30 * concentration / tracking.unit);
}

/* The token as the head before has it. */
static void make_track(void)
{
    struct mh_estimate estimate;
    struct mh_measurement *const set = bench_state.head.measurements; /* not in use yet */
    size_t length = 0;
    (void)mh_tracker_gas_small.init(&bench_state.tracker, &tracking, LEAKING_INTERVAL);
    leaking_measurements(HERE / LEAKING_INTERVAL, LEAKING_MEASUREMENTS, set);
    (void)mh_tracker_gas_small.step(&bench_state.tracker, HERE, set, LEAKING_MEASUREMENTS, &estimate);
    (void)mh_tracker_gas_small.save(&bench_state.tracker, track + 2, &length);
    track[0] = 1;
}

void bench_setup(void)
{
    const struct mh_place sink = {400000, 0, 0};
    leaking_config(&tracking);
    mh_token_config_default(&searching, SINK, &sink);
}

static void hear_of_neighbours(void)
{
    for (uint8_t i = 0; i < ANSWERS; i++) {
        const struct mh_place place = place_of(i);
        const mh_hello_t hello = {.sender = BEFORE + i, .x_mm = place.x_mm, .y_mm = place.y_mm};
        message.kind = MH_MESSAGE_HELLO;
        message.as.hello = hello;
        hear(i);
    }
    for (uint8_t list = 0; list < AROUND / MH_VICINITY_NODES; list++) {
        mh_vicinity_t vicinity = {.sender = BEFORE, .count = MH_VICINITY_NODES};
        for (uint8_t i = 0; i < MH_VICINITY_NODES; i++) {
            const uint8_t node = (uint8_t)(ANSWERS + list * MH_VICINITY_NODES + i);
            const struct mh_place place = place_of(node);
            vicinity.id[i] = BEFORE + node;
            vicinity.x_mm[i] = place.x_mm;
            vicinity.y_mm[i] = place.y_mm;
        }
        message.kind = MH_MESSAGE_VICINITY;
        message.as.vicinity = vicinity;
        hear((mh_tick)ANSWERS + list);
    }
}

void bench_prepare(unsigned step)
{
    (void)step;
    make_track();
    estimated = false;
    if (mh_mote_init(&bench_state.mote, &config, &port, NULL, 0) != MH_OK) {
        return;
    }
    hear_of_neighbours();
    pass(HERE + 1200);
}

static void hear_token(void)
{
    const mh_hand_over_t part = {.track = SINK, .generation = 3, .time_ms = HERE};
    message.kind = MH_MESSAGE_HAND_OVER;
    message.as.hand_over = part;
    mh_parcel_cut(track, sizeof track, 0, &message.as.hand_over);
    mh_geographic_address(&message, BEFORE, 1, SELF, &config.place);
    hear(HERE + 1252);
}

static void hear_answers(void)
{
    const struct mh_reading own = {.time = HERE + LEAKING_INTERVAL, .counts = sample_at(&config.place)};
    (void)mh_mote_reading(&bench_state.mote, HERE + LEAKING_INTERVAL, &own);
    for (uint8_t i = 0; i < ANSWERS; i++) {
        const struct mh_place place = place_of(i);
        const mh_answer_t answer = {.sender = BEFORE + i,
                                    .time_ms = HERE + LEAKING_INTERVAL,
                                    .x_mm = place.x_mm,
                                    .y_mm = place.y_mm,
                                    .value_q20 = sample_at(&place)};
        message.kind = MH_MESSAGE_ANSWER;
        message.as.answer = answer;
        mh_geographic_address(&message, (mh_node_id)BEFORE + i, 2, SELF, &config.place);
        hear(HERE + LEAKING_INTERVAL + 20u + i);
    }
    message.envelope = MH_ENVELOPE_NONE;
}

void bench_step(void)
{
    hear_token();
    pass(HERE + LEAKING_INTERVAL + 10);
    hear_answers();
    pass(HERE + LEAKING_INTERVAL + 1500);
}

bool bench_worked(void) { return estimated && bench_state.protocol.events.handed == 1; }
