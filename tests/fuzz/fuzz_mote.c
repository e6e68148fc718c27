/* A live mote under hostile frames, readings and clocks.
 *
 * The first byte chooses the mote: bits 0-1 the tracker, bit 2 a head or a plain sensor node, bit 4 the protocol. The second: above 127 the
 * protocol is `cluster`, bits 0-2 its election rule, bit 3 radios that sleep, bit 4 the sink, bits 5-6 the tracker if not 0; 64 to 127: it is `token`,
 * bits 0-1 the tracker, bit 2 who is to begin, bit 4 the sink. Then come events, each an opcode and its operands; see
 * next_event(). Whatever happens: what the mote transmits are frames that it would take itself,
 * and what it reports are finite numbers. */
#include "fuzz.h"
#include "motehound/centroid.h"
#include "motehound/cluster.h"
#include "motehound/collection.h"
#include "motehound/geographic.h"
#include "motehound/geographic_collection.h"
#include "motehound/luo.h"
#include "motehound/mote.h"
#include "motehound/pftl.h"
#include "motehound/token.h"
#if !MH_REAL_FIXED
#include "motehound/diffusion.h"
#include "motehound/gas.h"
#include "motehound/msl.h"
#include "motehound/range.h"
#endif

#include <string.h>

enum { EVENTS_MAX = 300, ALARMS_MAX = 20, INTERVAL = 1000 };

union tracker_state {
    struct mh_luo luo;
    struct mh_pftl pftl;
    struct mh_centroid_state centroid;
#if !MH_REAL_FIXED
    struct mh_diffusion diffusion;
    struct mh_range range;
    struct mh_msl msl;
    struct mh_gas gas;
    struct mh_gas_gaussian gas_gaussian;
#endif
};

struct world {
    struct mh_mote mote;
    mh_tick now, alarm;
    int alarm_set;
    int geographic;
    int searches;
    mh_node_id sink;
};

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    (void)context;
    (void)destination;
    struct mh_message message;
    require(length <= MH_FRAME_MAX && mh_wire_decode(mh_wire_all, frame, length, &message) == MH_OK);
}

static void set_alarm(void *context, mh_tick time)
{
    struct world *world = context;
    world->alarm = time;
    world->alarm_set = 1;
}

static void report(void *context, const struct mh_estimate *estimate)
{
    (void)context;
    require(mh_finite(estimate->position.x) && mh_finite(estimate->position.y));
    require(mh_finite(estimate->velocity.x) && mh_finite(estimate->velocity.y));
    require(estimate->covariance.xx >= 0 && estimate->covariance.yy >= 0 && mh_finite(estimate->covariance.xy));
}

/* The sample comes when the fuzzer has it come. */
static void sense(void *context) { (void)context; }

static void ring(struct world *world)
{
    for (int i = 0; i < ALARMS_MAX && world->alarm_set && !mh_tick_before(world->now, world->alarm); i++) {
        world->alarm_set = 0;
        mh_mote_alarm(&world->mote, world->now);
    }
}

/* Any bytes as a frame. */
static void raw_frame(struct world *world, struct input *input)
{
    uint8_t frame[256];
    const size_t length = bytes(input, frame, byte(input));
    mh_mote_frame(&world->mote, world->now, frame, length);
}

/* A frame with the right fingerprints and check sum, and any bytes in its fields. */
static void sound_frame(struct world *world, struct input *input)
{
    const uint8_t choice = byte(input);
    struct mh_message message = {.kind = (enum mh_message_kind)(choice % MH_MESSAGE_KINDS)};
    uint8_t frame[MH_FRAME_MAX];
    size_t length, bare;
    mh_wire_encode(mh_wire_all, &message, frame, &bare);
    message.envelope = (enum mh_envelope_kind)(choice / MH_MESSAGE_KINDS % MH_ENVELOPE_KINDS);
    if (mh_wire_encode(mh_wire_all, &message, frame, &length) != MH_OK) {
        return; /* too long for the envelope */
    }
    if (length > bare) {
        bytes(input, frame + 8, length - bare - 8);
    }
    bytes(input, frame + length - bare + 8, bare - 10);
    const uint16_t fcs = mh_wire_fcs(frame, length - 2);
    frame[length - 2] = (uint8_t)fcs;
    frame[length - 1] = (uint8_t)(fcs >> 8);
    mh_mote_frame(&world->mote, world->now, frame, length);
}

/* A measurement of now, so that the head has work: places within 16 m in steps of half a metre, increments of up to 8 g/m2. */
static void fresh_report(struct world *world, struct input *input)
{
    const struct mh_measurement measurement = {
        .node = byte(input),
        .place = {(byte(input) % 64 - 32) * 500, (byte(input) % 64 - 32) * 500, byte(input) * 10},
        .time = world->now - world->now % INTERVAL,
        .value = (mh_q20)byte(input) << 17,
        .increment = (mh_q20)byte(input) << 15,
        .flags = MH_MEASUREMENT_HAS_INCREMENT,
    };
    struct mh_message message = {.kind = MH_MESSAGE_REPORT};
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    mh_report_from_measurement(&measurement, &message.as.report);
    if (world->geographic) {
        mh_geographic_address(&message, byte(input), (int16_t)byte(input), byte(input) % 8, &measurement.place);
    }
    mh_wire_encode(mh_wire_all, &message, frame, &length);
    mh_mote_frame(&world->mote, world->now, frame, length);
}

/* Of a neighbour within 128 m, perhaps at this mote's own place. */
static void near_hello(struct world *world, struct input *input)
{
    const struct mh_message message = {.kind = MH_MESSAGE_HELLO,
                                       .as.hello = {.sender = byte(input) % 40,
                                                    .x_mm = (byte(input) - 128) * 1000,
                                                    .y_mm = (byte(input) - 128) * 1000,
                                                    .sequence = byte(input) % 4}};
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    mh_wire_encode(mh_wire_all, &message, frame, &length);
    mh_mote_frame(&world->mote, world->now, frame, length);
}

/* What nodes around this one say in clusters, of an instant near now. */
static void cluster_frame(struct world *world, struct input *input)
{
    const uint8_t kind = byte(input), who = byte(input), generation = byte(input), where = byte(input);
    const int32_t instant = (int32_t)(world->now / INTERVAL * INTERVAL + (kind & 128 ? INTERVAL : 0));
    const int32_t sender = who % 16, track = who / 16, x_mm = (where - 128) * 1000;
    struct mh_message message = {.kind = (enum mh_message_kind)(MH_MESSAGE_ASK + kind % 7)};
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    switch (message.kind) {
    case MH_MESSAGE_ASK:
        message.as.ask = (mh_ask_t){.sender = sender,
                                    .track = track,
                                    .generation = generation,
                                    .time_ms = instant,
                                    .x_mm = x_mm,
                                    .vx_mmps = 4000,
                                    .everyone = byte(input) & 1};
        break;
    case MH_MESSAGE_ANSWER:
        message.as.answer = (mh_answer_t){.sender = sender,
                                          .time_ms = instant,
                                          .x_mm = x_mm,
                                          .y_mm = byte(input) * 500,
                                          .value_q20 = (mh_q20)byte(input) << 19};
        break;
    case MH_MESSAGE_FORM:
        message.as.form = (mh_form_t){
            .sender = sender, .track = track, .generation = generation, .time_ms = instant, .count = where % 17};
        for (int i = 0; i < MH_FORM_MEMBERS; i++) {
            message.as.form.members[i] = i < where % 17 ? 7 + i : -1;
        }
        break;
    case MH_MESSAGE_JOIN:
        message.as.join = (mh_join_t){.sender = sender, .track = track, .generation = generation};
        break;
    case MH_MESSAGE_HAND_OVER:
        message.as.hand_over = (mh_hand_over_t){.track = track,
                                                .generation = generation,
                                                .time_ms = instant,
                                                .part = where % 8,
                                                .parts = where < 64 ? (uint8_t)(where % 8 + 1) : byte(input)};
        message.as.hand_over.length = (uint8_t)bytes(input, message.as.hand_over.data, byte(input) % 65);
        break;
    case MH_MESSAGE_ALERT:
        message.as.alert = (mh_alert_t){.sender = sender,
                                        .track = track,
                                        .generation = generation,
                                        .time_ms = instant,
                                        .x_mm = x_mm,
                                        .value_q20 = (mh_q20)byte(input) << 19,
                                        .lost = kind >> 6 & 1};
        break;
    default:
        message.as.position = (mh_position_t){
            .origin = sender, .track = track, .generation = generation, .time_ms = instant, .x_mm = x_mm};
        break;
    }
    if (message.kind == MH_MESSAGE_HAND_OVER || message.kind == MH_MESSAGE_POSITION) {
        const struct mh_place place = {0, 0, 0};
        mh_geographic_address(&message, (mh_node_id)sender, (int16_t)byte(input), 7, &place);
    }
    require(mh_wire_encode(mh_wire_all, &message, frame, &length) == MH_OK);
    mh_mote_frame(&world->mote, world->now, frame, length);
}

/* What nodes around this one, and the sink, say in a search, of about now. */
static void search_frame(struct world *world, struct input *input)
{
    static const enum mh_message_kind kinds[] = {MH_MESSAGE_ASK,   MH_MESSAGE_ANSWER, MH_MESSAGE_HAND_OVER,
                                                 MH_MESSAGE_TOKEN, MH_MESSAGE_LEAK,   MH_MESSAGE_VICINITY};
    const uint8_t kind = byte(input), who = byte(input), generation = byte(input), where = byte(input);
    const int32_t instant = (int32_t)(world->now / INTERVAL * INTERVAL), track = (int32_t)world->sink;
    const int32_t sender = who % 16, x_mm = (where - 128) * 1000;
    const struct mh_place place = {0, 0, 0};
    struct mh_message message = {.kind = kinds[kind % 6]};
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    switch (message.kind) {
    case MH_MESSAGE_ASK:
        message.as.ask = (mh_ask_t){.sender = sender,
                                    .track = track,
                                    .generation = generation,
                                    .time_ms = instant,
                                    .x_mm = x_mm,
                                    .everyone = 1};
        break;
    case MH_MESSAGE_ANSWER:
        message.as.answer = (mh_answer_t){.sender = sender,
                                          .time_ms = instant,
                                          .x_mm = x_mm,
                                          .y_mm = byte(input) * 1000,
                                          .value_q20 = (mh_q20)byte(input) << 20};
        break;
    case MH_MESSAGE_HAND_OVER:
        message.as.hand_over = (mh_hand_over_t){.track = track,
                                                .generation = generation,
                                                .time_ms = instant,
                                                .part = where % 4,
                                                .parts = (uint8_t)(where % 4 + 1 + where / 200)};
        message.as.hand_over.length = (uint8_t)bytes(input, message.as.hand_over.data, byte(input) % 65);
        break;
    case MH_MESSAGE_TOKEN:
        message.as.token = (mh_token_t){.sender = sender,
                                        .track = track,
                                        .generation = generation,
                                        .holder = where < 128 ? -1 : where % 16,
                                        .state = (uint8_t)(kind / 6 % 3)};
        break;
    case MH_MESSAGE_LEAK:
        message.as.leak = (mh_leak_t){.track = track,
                                      .generation = generation,
                                      .time_ms = instant,
                                      .x_mm = x_mm,
                                      .heads = who,
                                      .state = (uint8_t)(kind / 6 % 3)};
        bytes(input, message.as.leak.rate, sizeof message.as.leak.rate);
        bytes(input, message.as.leak.spread, sizeof message.as.leak.spread);
        break;
    default:
        message.as.vicinity = (mh_vicinity_t){.sender = sender, .count = where % 7};
        for (int i = 0; i < MH_VICINITY_NODES; i++) {
            message.as.vicinity.id[i] = i < where % 7 ? 20 + i + who : -1;
            message.as.vicinity.x_mm[i] = i < where % 7 ? x_mm + 7000 * i : 0;
        }
        break;
    }
    if (message.kind != MH_MESSAGE_ASK && message.kind != MH_MESSAGE_VICINITY) {
        mh_geographic_address(&message, (mh_node_id)sender, (int16_t)byte(input), 7, &place);
    }
    require(mh_wire_encode(mh_wire_all, &message, frame, &length) == MH_OK);
    mh_mote_frame(&world->mote, world->now, frame, length);
}

static void reading(struct world *world, struct input *input)
{
    const int32_t high = byte(input), low = byte(input);
    const struct mh_reading r = {world->now - byte(input), high * 256 + low, byte(input) % 2};
    mh_mote_reading(&world->mote, world->now, &r);
}

static void next_event(struct world *world, struct input *input)
{
    switch (byte(input) % 9) {
    case 0:
        raw_frame(world, input);
        break;
    case 1:
        sound_frame(world, input);
        break;
    case 2:
        fresh_report(world, input);
        break;
    case 3:
        reading(world, input);
        break;
    case 4:
        world->now += 16u * byte(input);
        mh_mote_sent(&world->mote, world->now, (enum mh_sent)(byte(input) % 3));
        break;
    case 5:
        mh_mote_sent(&world->mote, world->now, (enum mh_sent)(byte(input) % 3));
        break;
    case 6:
        near_hello(world, input);
        break;
    case 7:
        if (world->searches) {
            search_frame(world, input);
        } else {
            cluster_frame(world, input);
        }
        break;
    default:
        world->now += (mh_tick)byte(input) << byte(input) % 25;
        break;
    }
    ring(world);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct mh_tracker *const trackers[4] = {&mh_tracker_luo, FLOAT_ONLY(&mh_tracker_diffusion),
                                                         FLOAT_ONLY(&mh_tracker_range),
                                                         FLOAT_ONLY(&mh_tracker_diffusion)};
    static const struct mh_tracker *const trackers_of_clusters[4] = {FLOAT_ONLY(&mh_tracker_range), &mh_tracker_pftl,
                                                                     FLOAT_ONLY(&mh_tracker_msl), &mh_tracker_centroid};
    static const struct mh_tracker *const trackers_of_searches[4] = {
        FLOAT_ONLY(&mh_tracker_gas), FLOAT_ONLY(&mh_tracker_gas_small), FLOAT_ONLY(&mh_tracker_gas_ukf),
        FLOAT_ONLY(&mh_tracker_gas_ekf)};
    static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report, .sense = sense};
    static const struct mh_sensor_config sensor = {
        .q20_per_count = 1 << 8, .counts_max = 65535, .interval = INTERVAL, .threshold = MH_Q20(0.2f)};
    struct input input = {data, size};
    const uint8_t choice = byte(&input), second = byte(&input);
    const int clusters = second >= 128, searches = !clusters && second >= 64;
    const struct mh_tracker *tracker = clusters && (second & 96) ? trackers_of_clusters[second >> 5 & 3]
                                       : searches                ? trackers_of_searches[second & 3]
                                                                 : trackers[choice & 3];
    union {
        struct mh_luo_config luo;
        struct mh_pftl_config pftl;
        struct mh_centroid_config centroid;
#if !MH_REAL_FIXED
        struct mh_diffusion_config diffusion;
        struct mh_range_config range;
        struct mh_msl_config msl;
        struct mh_gas_config gas;
#endif
    } tracker_config;
    if (tracker == NULL) {
        return 0;
    }
    mh_luo_config_default(&tracker_config.luo);
    if (tracker == &mh_tracker_pftl) {
        mh_pftl_config_default(&tracker_config.pftl);
    } else if (tracker == &mh_tracker_centroid) {
        mh_centroid_config_default(&tracker_config.centroid);
    }
#if !MH_REAL_FIXED
    if (tracker == &mh_tracker_diffusion) {
        mh_diffusion_config_default(&tracker_config.diffusion);
    } else if (tracker == &mh_tracker_range) {
        mh_range_config_default(&tracker_config.range);
        if (second >= 128) {
            tracker_config.range.sensing_range_m = 50.0f;
            tracker_config.range.tolerance_m = 5.0f;
        }
    } else if (tracker == &mh_tracker_msl) {
        mh_msl_config_default(&tracker_config.msl);
    } else if (searches) {
        mh_gas_config_default(&tracker_config.gas);
    }
#endif
    static union tracker_state tracker_state;
    static struct mh_head head;
    static union {
        struct mh_collection collection;
        struct mh_geographic_collection geographic;
        struct mh_cluster_node cluster;
        struct mh_token_node token;
    } protocol_state;
    struct mh_geographic_collection_config protocol_config;
    mh_geographic_collection_config_default(&protocol_config);
    struct mh_cluster_config cluster_config;
    const struct mh_place sink = {50000, 0, 0};
    mh_cluster_config_default(&cluster_config, (enum mh_election)(second % 8 % MH_ELECTIONS), second & 16 ? 7 : 1,
                              &sink);
    cluster_config.election.interval = INTERVAL;
    cluster_config.wake_period = second & 8 ? 250 : 0;
    struct mh_token_config token_config = {.sink = cluster_config.sink};
#if !MH_REAL_FIXED
    mh_token_config_default(&token_config, cluster_config.sink, &sink);
#endif
    token_config.start = second & 4 ? 7 : MH_BROADCAST;
    token_config.interval = INTERVAL;
    token_config.window = INTERVAL / 2;
    const int geographic = !clusters && !searches && (choice & 16) != 0;
    const struct mh_head_config head_config = {
        .tracker = tracker,
        .tracker_config = &tracker_config,
        .tracker_state = &tracker_state,
        .interval = INTERVAL,
        .window = clusters   ? cluster_config.window
                  : searches ? token_config.window
                             : 900,
        .tolerance = clusters || searches ? INTERVAL / 4 : 0,
        .own_first = searches,
    };
    struct mh_clock clock;
    const struct mh_clock_config clock_config = {
        .root = (choice & 64) != 0, .period = choice & 128 ? 3600000 : 2000, .wait = 100, .sent_q8 = 128};
    const struct mh_mote_config config = {
        .id = 7,
        .sensor = &sensor,
        .head = choice & 4 ? NULL : &head_config,
        .protocol = clusters     ? &mh_protocol_cluster
                    : searches   ? FLOAT_ONLY(&mh_protocol_token)
                    : geographic ? &mh_protocol_geographic
                                 : &mh_protocol_collection,
        .protocol_config = clusters     ? (const void *)&cluster_config
                           : searches   ? (const void *)&token_config
                           : geographic ? (const void *)&protocol_config
                                        : &protocol_config.collection,
        .protocol_state = &protocol_state,
        .head_state = &head,
        .clock = choice & 32 ? &mh_clock_flooding : NULL,
        .clock_config = &clock_config,
        .clock_state = &clock,
    };
    struct world world = {.geographic = geographic,
                          .searches = searches,
                          .sink = token_config.sink,
                          .now = choice & 8 ? 0xFFFFE000u : 5000}; /* also across the wrap of the ticks */
    require(mh_mote_init(&world.mote, &config, &port, &world, world.now) == MH_OK);
    for (int i = 0; i < EVENTS_MAX && input.left > 0; i++) {
        next_event(&world, &input);
    }
    return 0;
}
