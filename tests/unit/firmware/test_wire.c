#include "motehound/wire.h"
#include "port.h"
#include "unity.h"

#include <string.h>

static uint8_t frame[MH_FRAME_MAX];
static size_t length;
static struct mh_message decoded;

void setUp(void) {}
void tearDown(void) {}

static struct mh_message example(enum mh_message_kind kind)
{
    struct mh_message message = {.kind = kind};
    switch (kind) {
    case MH_MESSAGE_BEACON: {
        const mh_beacon_t beacon = {.sender = 7, .sink = -2, .round = -32768, .hops = 3, .tracking = 1};
        message.as.beacon = beacon;
        break;
    }
    case MH_MESSAGE_REPORT: {
        const mh_report_t report = {.sender = 1,
                                    .origin = 2,
                                    .time_ms = -3,
                                    .x_mm = 1000000000,
                                    .y_mm = -1000000000,
                                    .z_mm = 12,
                                    .value_q20 = INT32_MAX,
                                    .increment_q20 = INT32_MIN,
                                    .flags = 3,
                                    .target = 255,
                                    .hops = MH_HOPS_MAX};
        message.as.report = report;
        break;
    }
    case MH_MESSAGE_HELLO: {
        const mh_hello_t hello = {.sender = 9, .x_mm = -1000000000, .y_mm = 1000000000, .sequence = -1};
        message.as.hello = hello;
        break;
    }
    case MH_MESSAGE_LANDMARK: {
        const mh_landmark_t landmark = {
            .beacon = {.sender = 7, .sink = 2, .round = 3, .hops = MH_HOPS_MAX}, .x_mm = 40, .y_mm = -50};
        message.as.landmark = landmark;
        break;
    }
    case MH_MESSAGE_ASK: {
        const mh_ask_t ask = {.sender = 1,
                              .track = 2,
                              .generation = -3,
                              .time_ms = INT32_MIN,
                              .x_mm = 1000000000,
                              .y_mm = -1000000000,
                              .vx_mmps = -4470,
                              .vy_mmps = 5,
                              .everyone = 1};
        message.as.ask = ask;
        break;
    }
    case MH_MESSAGE_ANSWER: {
        const mh_answer_t answer = {
            .sender = 1, .time_ms = -2, .x_mm = 3, .y_mm = -4, .z_mm = 5, .value_q20 = INT32_MIN, .flags = 2};
        message.as.answer = answer;
        break;
    }
    case MH_MESSAGE_FORM: {
        mh_form_t form = {.sender = 1, .track = 2, .generation = 3, .time_ms = 4, .count = 2};
        for (uint8_t i = 0; i < MH_FORM_MEMBERS; i++) {
            form.members[i] = i < form.count ? 10 + i : -1;
        }
        message.as.form = form;
        break;
    }
    case MH_MESSAGE_JOIN: {
        const mh_join_t join = {.sender = 1, .track = 2, .generation = 3};
        message.as.join = join;
        break;
    }
    case MH_MESSAGE_HAND_OVER: {
        const mh_hand_over_t part = {.track = 1,
                                     .generation = 2,
                                     .time_ms = 3,
                                     .part = 1,
                                     .parts = 2,
                                     .length = MH_HAND_OVER_BYTES,
                                     .data = {[0] = 4, [MH_HAND_OVER_BYTES - 1] = 255}};
        message.as.hand_over = part;
        break;
    }
    case MH_MESSAGE_ALERT: {
        const mh_alert_t alert = {.sender = 1,
                                  .track = 2,
                                  .generation = 3,
                                  .time_ms = 4,
                                  .x_mm = 5,
                                  .y_mm = -6,
                                  .value_q20 = -7,
                                  .lost = 1,
                                  .hops = MH_HOPS_MAX};
        message.as.alert = alert;
        break;
    }
    case MH_MESSAGE_POSITION: {
        const mh_position_t position = {.origin = 1,
                                        .track = 2,
                                        .generation = 3,
                                        .time_ms = 4,
                                        .x_mm = 5,
                                        .y_mm = -6,
                                        .vx_mmps = 1000000000,
                                        .vy_mmps = -8};
        message.as.position = position;
        break;
    }
    case MH_MESSAGE_VICINITY: {
        mh_vicinity_t vicinity = {.sender = 1, .count = MH_VICINITY_NODES - 1};
        for (uint8_t i = 0; i < MH_VICINITY_NODES; i++) {
            const bool told = i < vicinity.count;
            vicinity.id[i] = told ? 10 + i : -1;
            vicinity.x_mm[i] = told ? -1000000000 + i : 0;
            vicinity.y_mm[i] = told ? 1000000000 - i : 0;
        }
        message.as.vicinity = vicinity;
        break;
    }
    case MH_MESSAGE_TOKEN: {
        const mh_token_t token = {
            .sender = 1, .track = 2, .generation = -3, .holder = -1, .state = MH_SEARCH_EXHAUSTED};
        message.as.token = token;
        break;
    }
    case MH_MESSAGE_LEAK: {
        const mh_leak_t leak = {.track = 1,
                                .generation = 2,
                                .time_ms = -3,
                                .head_x_mm = 4,
                                .head_y_mm = -5,
                                .x_mm = 6,
                                .y_mm = -7,
                                .rate = {0x41, 0xF0},
                                .spread = {[20] = 0x3F, [21] = 0x80},
                                .heads = 250,
                                .state = MH_SEARCH_CONVERGED};
        message.as.leak = leak;
        break;
    }
    case MH_MESSAGE_LEAD: {
        const mh_lead_t lead = {
            .sender = 1, .since_ms = -2, .cluster = 250, .length = 63, .data = {[0] = 1, [62] = 255}};
        message.as.lead = lead;
        break;
    }
    case MH_MESSAGE_TAKEN: {
        const mh_taken_t taken = {.time_ms = -1, .cluster = 3};
        message.as.taken = taken;
        break;
    }
    case MH_MESSAGE_AWAKE: {
        const mh_awake_t awake = {.sender = 1,
                                  .target = -2,
                                  .generation = INT16_MIN,
                                  .time_ms = INT32_MIN,
                                  .x_mm = 1000000000,
                                  .y_mm = -1000000000,
                                  .vx_cmps = INT16_MAX,
                                  .vy_cmps = INT16_MIN,
                                  .head_x_dm = -400,
                                  .head_y_dm = 401,
                                  .prince = -1,
                                  .enters_cs = INT16_MAX,
                                  .arms_cs = 300,
                                  .extent_cm = 999,
                                  .speeds = {1, 2, 255},
                                  .members = MH_GROUP_MAX,
                                  .length = MH_AWAKE_BYTES - 1,
                                  .data = {[0] = 1, [MH_AWAKE_BYTES - 2] = 255}};
        message.as.awake = awake;
        break;
    }
    case MH_MESSAGE_REST: {
        const mh_rest_t rest = {.sender = 1, .target = 2, .generation = -3, .length = 2, .data = {[0] = 4, [1] = 255}};
        message.as.rest = rest;
        break;
    }
    case MH_MESSAGE_LOCATE: {
        const mh_locate_t locate = {
            .sender = 1, .target = 2, .generation = -3, .time_ms = 4, .kind = MH_LOCATE_COMPETITION};
        message.as.locate = locate;
        break;
    }
    case MH_MESSAGE_SOUND: {
        const mh_sound_t sound = {.sender = 1,
                                  .asker = 2,
                                  .target = 3,
                                  .time_ms = 5,
                                  .x_mm = -6,
                                  .y_mm = 7,
                                  .value_q20 = INT32_MIN,
                                  .share = 255,
                                  .others = 3};
        message.as.sound = sound;
        break;
    }
    case MH_MESSAGE_FAIL: {
        const mh_fail_t fail = {.sender = 1,
                                .target = 2,
                                .generation = -3,
                                .time_ms = 4,
                                .x_mm = -5,
                                .y_mm = 6,
                                .vx_cmps = -7,
                                .vy_cmps = 8};
        message.as.fail = fail;
        break;
    }
    case MH_MESSAGE_SUCCEED: {
        const mh_succeed_t succeed = {.sender = 1, .head = -1, .target = 3, .generation = -4};
        message.as.succeed = succeed;
        break;
    }
    case MH_MESSAGE_COMPETE: {
        const mh_compete_t compete = {
            .sender = 1, .target = 2, .generation = 3, .time_ms = -4, .x_mm = 5, .y_mm = -6, .value_q20 = -7};
        message.as.compete = compete;
        break;
    }
    case MH_MESSAGE_DETECTION: {
        const mh_detection_t detection = {
            .sender = 1, .target = 2, .generation = 3, .detected_ms = -4, .x_mm = 5, .y_mm = -6, .value_q20 = 7};
        message.as.detection = detection;
        break;
    }
    case MH_MESSAGE_SUPPRESS: {
        const mh_suppress_t suppress = {.sender = 1, .target = 2, .generation = 3, .released = 1};
        message.as.suppress = suppress;
        break;
    }
    case MH_MESSAGE_MERGE: {
        const mh_merge_t merge = {.sender = 1, .target = 2, .other = 3, .generation = 4, .answers = 1};
        message.as.merge = merge;
        break;
    }
    default: {
        const mh_request_t request = {.sender = 1,
                                      .origin = 2,
                                      .time_ms = INT32_MIN,
                                      .x_mm = 4,
                                      .y_mm = -5,
                                      .radius_mm = 8000,
                                      .sender_x_mm = 6,
                                      .sender_y_mm = -7,
                                      .hops = 0};
        message.as.request = request;
        break;
    }
    }
    return message;
}

static struct mh_message enveloped(enum mh_message_kind kind, enum mh_envelope_kind envelope)
{
    struct mh_message message = example(kind);
    const mh_face_t header = {.route = {.sender = 1,
                                        .origin = 2,
                                        .destination = -1,
                                        .x_mm = 3,
                                        .y_mm = -4,
                                        .sequence = INT16_MIN,
                                        .hops = MH_ROUTE_HOPS_MAX},
                              .sender_x_mm = 5,
                              .sender_y_mm = 6,
                              .entry = 7,
                              .entry_x_mm = -8,
                              .entry_y_mm = 9,
                              .first = 10};
    message.envelope = envelope;
    message.header = header;
    return message;
}

/* An awake_t and any envelope are longer than a frame together, and so are some others and a face_t. */
static bool fits(enum mh_message_kind kind, int envelope)
{
    const bool is_long = kind == MH_MESSAGE_FORM || kind == MH_MESSAGE_HAND_OVER || kind == MH_MESSAGE_VICINITY ||
                         kind == MH_MESSAGE_LEAD || kind == MH_MESSAGE_REST;
    return envelope == MH_ENVELOPE_NONE || (kind != MH_MESSAGE_AWAKE && (envelope != MH_ENVELOPE_FACE || !is_long));
}

/* The last of the envelopes, up to `most`, that the kind fits in. */
static enum mh_envelope_kind within(enum mh_message_kind kind, int most)
{
    for (; !fits(kind, most); most--) {}
    return (enum mh_envelope_kind)most;
}

static void encode(const struct mh_message *message)
{
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_encode(mh_wire_all, message, frame, &length));
    TEST_ASSERT_TRUE(length <= MH_FRAME_MAX);
}

/* "123456789" -> 0x2189: CRC-16/KERMIT of the CRC catalogue, which is the FCS of IEEE 802.15.4 */
static void check_sum_of_the_catalogue(void)
{
    TEST_ASSERT_EQUAL_HEX16(0x2189, mh_wire_fcs((const uint8_t *)"123456789", 9));
    TEST_ASSERT_EQUAL_HEX16(0, mh_wire_fcs(frame, 0));
}

static void check_sum_equals_the_division_bit_by_bit(void)
{
    uint8_t bytes[3];
    for (uint16_t trial = 0; trial < 300; trial++) {
        uint16_t remainder = 0;
        for (uint8_t i = 0; i < 3; i++) {
            bytes[i] = (uint8_t)(trial * 77u + i * 131u);
            remainder = (uint16_t)(remainder ^ bytes[i]);
            for (uint8_t bit = 0; bit < 8; bit++) {
                remainder = (uint16_t)(remainder & 1u ? remainder >> 1 ^ 0x8408u : remainder >> 1);
            }
        }
        TEST_ASSERT_EQUAL_HEX16(remainder, mh_wire_fcs(bytes, 3));
    }
}

static void every_kind_makes_the_round_trip(void)
{
    const struct mh_message beacon = example(MH_MESSAGE_BEACON), report = example(MH_MESSAGE_REPORT),
                            request = example(MH_MESSAGE_REQUEST);
    encode(&beacon);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
    TEST_ASSERT_EQUAL(MH_MESSAGE_BEACON, decoded.kind);
    TEST_ASSERT_EQUAL_INT32(7, decoded.as.beacon.sender);
    TEST_ASSERT_EQUAL_INT32(-2, decoded.as.beacon.sink);
    TEST_ASSERT_EQUAL_INT16(-32768, decoded.as.beacon.round);
    TEST_ASSERT_EQUAL_UINT8(3, decoded.as.beacon.hops);
    TEST_ASSERT_EQUAL_UINT8(1, decoded.as.beacon.tracking);
    encode(&report);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
    TEST_ASSERT_EQUAL(MH_MESSAGE_REPORT, decoded.kind);
    TEST_ASSERT_EQUAL_INT32(1, decoded.as.report.sender);
    TEST_ASSERT_EQUAL_INT32(2, decoded.as.report.origin);
    TEST_ASSERT_EQUAL_INT32(-3, decoded.as.report.time_ms);
    TEST_ASSERT_EQUAL_INT32(1000000000, decoded.as.report.x_mm);
    TEST_ASSERT_EQUAL_INT32(-1000000000, decoded.as.report.y_mm);
    TEST_ASSERT_EQUAL_INT32(12, decoded.as.report.z_mm);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, decoded.as.report.value_q20);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, decoded.as.report.increment_q20);
    TEST_ASSERT_EQUAL_UINT8(3, decoded.as.report.flags);
    TEST_ASSERT_EQUAL_UINT8(255, decoded.as.report.target);
    TEST_ASSERT_EQUAL_UINT8(MH_HOPS_MAX, decoded.as.report.hops);
    encode(&request);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
    TEST_ASSERT_EQUAL(MH_MESSAGE_REQUEST, decoded.kind);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, decoded.as.request.time_ms);
    TEST_ASSERT_EQUAL_INT32(4, decoded.as.request.x_mm);
    TEST_ASSERT_EQUAL_INT32(-5, decoded.as.request.y_mm);
    TEST_ASSERT_EQUAL_INT32(8000, decoded.as.request.radius_mm);
    TEST_ASSERT_EQUAL_INT32(6, decoded.as.request.sender_x_mm);
    TEST_ASSERT_EQUAL_INT32(-7, decoded.as.request.sender_y_mm);
}

static void a_neighbours_place_and_a_sinks_make_the_round_trip(void)
{
    const struct mh_message hello = example(MH_MESSAGE_HELLO), landmark = example(MH_MESSAGE_LANDMARK);
    encode(&hello);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
    TEST_ASSERT_EQUAL_INT32(9, decoded.as.hello.sender);
    TEST_ASSERT_EQUAL_INT32(-1000000000, decoded.as.hello.x_mm);
    TEST_ASSERT_EQUAL_INT32(1000000000, decoded.as.hello.y_mm);
    TEST_ASSERT_EQUAL_INT16(-1, decoded.as.hello.sequence);
    encode(&landmark);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
    TEST_ASSERT_EQUAL_INT32(7, decoded.as.landmark.beacon.sender);
    TEST_ASSERT_EQUAL_INT32(2, decoded.as.landmark.beacon.sink);
    TEST_ASSERT_EQUAL_INT16(3, decoded.as.landmark.beacon.round);
    TEST_ASSERT_EQUAL_INT32(40, decoded.as.landmark.x_mm);
    TEST_ASSERT_EQUAL_INT32(-50, decoded.as.landmark.y_mm);
    TEST_ASSERT_EQUAL(MH_ENVELOPE_NONE, decoded.envelope);
}

static void an_envelope_travels_before_every_kind_that_leaves_room(void)
{
    for (enum mh_message_kind kind = MH_MESSAGE_BEACON; kind < MH_MESSAGE_KINDS; kind++) {
        for (int envelope = MH_ENVELOPE_ROUTE; envelope < MH_ENVELOPE_KINDS; envelope++) {
            const struct mh_message message = enveloped(kind, (enum mh_envelope_kind)envelope);
            if (!fits(kind, envelope)) {
                length = 99;
                TEST_ASSERT_EQUAL(MH_ERR_CAPACITY, mh_wire_encode(mh_wire_all, &message, frame, &length));
                TEST_ASSERT_EQUAL(99, length);
                continue;
            }
            encode(&message);
            TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
            TEST_ASSERT_EQUAL(kind, decoded.kind);
            TEST_ASSERT_EQUAL(envelope, decoded.envelope);
            TEST_ASSERT_EQUAL_MEMORY(&message.header.route, &decoded.header.route, sizeof message.header.route);
            if (envelope == MH_ENVELOPE_FACE) {
                TEST_ASSERT_EQUAL_MEMORY(&message.header, &decoded.header, sizeof message.header);
            }
        }
    }
}

static void every_single_bit_counts(void)
{
    for (enum mh_message_kind kind = MH_MESSAGE_BEACON; kind < MH_MESSAGE_KINDS; kind++) {
        const struct mh_message message = enveloped(kind, within(kind, MH_ENVELOPE_FACE));
        encode(&message);
        for (size_t bit = 0; bit < 8 * length; bit++) {
            frame[bit / 8] = (uint8_t)(frame[bit / 8] ^ 1u << bit % 8);
            TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_wire_decode(mh_wire_all, frame, length, &decoded));
            frame[bit / 8] = (uint8_t)(frame[bit / 8] ^ 1u << bit % 8);
        }
        TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
    }
}

static void every_truncation_is_refused(void)
{
    for (enum mh_message_kind kind = MH_MESSAGE_BEACON; kind < MH_MESSAGE_KINDS; kind++) {
        for (int envelope = MH_ENVELOPE_NONE; fits(kind, envelope) && envelope < MH_ENVELOPE_KINDS; envelope++) {
            const struct mh_message message = enveloped(kind, (enum mh_envelope_kind)envelope);
            encode(&message);
            for (size_t shorter = 0; shorter < length; shorter++) {
                TEST_ASSERT_NOT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, shorter, &decoded));
            }
        }
    }
}

/* Change bytes, but keep the check sum right. */
static void seal(size_t end)
{
    const uint16_t fcs = mh_wire_fcs(frame, end);
    frame[end] = (uint8_t)(fcs & 0xFFu);
    frame[end + 1] = (uint8_t)(fcs >> 8);
    length = end + 2;
}

static void a_sound_frame_of_wrong_length_is_corrupt(void)
{
    for (int envelope = MH_ENVELOPE_NONE; envelope < MH_ENVELOPE_KINDS; envelope++) {
        const struct mh_message message = enveloped(MH_MESSAGE_REPORT, (enum mh_envelope_kind)envelope);
        encode(&message);
        const size_t right = length - 2;
        for (size_t end = 8; end <= MH_FRAME_MAX - 2; end++) {
            seal(end);
            TEST_ASSERT_EQUAL(end == right ? MH_OK : MH_ERR_CORRUPT,
                              mh_wire_decode(mh_wire_all, frame, length, &decoded));
            encode(&message);
        }
    }
    seal(MH_FRAME_MAX - 2);
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_wire_decode(mh_wire_all, frame, MH_FRAME_MAX + 1, &decoded));
}

static void an_unknown_type_is_told_apart(void)
{
    const struct mh_message message = example(MH_MESSAGE_BEACON);
    for (uint8_t i = 0; i < 8; i++) {
        encode(&message);
        frame[i] = (uint8_t)(frame[i] + 1);
        seal(length - 2);
        decoded.kind = MH_MESSAGE_REQUEST;
        TEST_ASSERT_EQUAL(MH_ERR_UNKNOWN, mh_wire_decode(mh_wire_all, frame, length, &decoded));
        TEST_ASSERT_EQUAL(MH_MESSAGE_REQUEST, decoded.kind);
    }
}

static void expect_corrupt(const struct mh_message *bad)
{
    encode(bad);
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_wire_decode(mh_wire_all, frame, length, &decoded));
}

static void fields_that_nobody_writes_are_corrupt(void)
{
    struct mh_message bad = example(MH_MESSAGE_BEACON);
    bad.as.beacon.sender = -1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_BEACON);
    bad.as.beacon.hops = MH_HOPS_MAX + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_BEACON);
    bad.as.beacon.tracking = 2;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_REPORT);
    bad.as.report.hops = MH_HOPS_MAX + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_REPORT);
    bad.as.report.z_mm = 1000000001;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_REPORT);
    bad.as.report.x_mm = INT32_MIN;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_REQUEST);
    bad.as.request.radius_mm = -1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_REQUEST);
    bad.as.request.y_mm = INT32_MIN;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_REQUEST);
    bad.as.request.sender_x_mm = INT32_MAX;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_HELLO);
    bad.as.hello.x_mm = INT32_MIN;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_LANDMARK);
    bad.as.landmark.beacon.tracking = 2;
    expect_corrupt(&bad);
}

static void fields_of_clusters_that_nobody_writes_are_corrupt(void)
{
    struct mh_message bad = example(MH_MESSAGE_ASK);
    bad.as.ask.everyone = 2;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_ASK);
    bad.as.ask.vy_mmps = 1000000001;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_ANSWER);
    bad.as.answer.z_mm = INT32_MIN;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_FORM);
    bad.as.form.count = MH_FORM_MEMBERS + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_FORM);
    bad.as.form.count = 3; /* of two */
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_FORM);
    bad.as.form.count = 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_JOIN);
    bad.as.join.sender = -1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_HAND_OVER);
    bad.as.hand_over.part = 2;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_HAND_OVER);
    bad.as.hand_over.length = MH_HAND_OVER_BYTES + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_HAND_OVER);
    bad.as.hand_over.length = MH_HAND_OVER_BYTES - 1; /* something behind the end */
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_ALERT);
    bad.as.alert.hops = MH_HOPS_MAX + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_POSITION);
    bad.as.position.x_mm = 1000000001;
    expect_corrupt(&bad);
}

static void fields_of_a_search_that_nobody_writes_are_corrupt(void)
{
    struct mh_message bad = example(MH_MESSAGE_VICINITY);
    bad.as.vicinity.count = MH_VICINITY_NODES + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_VICINITY);
    bad.as.vicinity.count--; /* one more behind the end */
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_VICINITY);
    bad.as.vicinity.x_mm[MH_VICINITY_NODES - 1] = 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_VICINITY);
    bad.as.vicinity.y_mm[0] = INT32_MIN;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_TOKEN);
    bad.as.token.state = MH_SEARCH_EXHAUSTED + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_TOKEN);
    bad.as.token.sender = -1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_LEAK);
    bad.as.leak.head_y_mm = 1000000001;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_LEAK);
    bad.as.leak.rate[0] = 0x7F; /* infinity */
    bad.as.leak.rate[1] = 0x80;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_LEAK);
    bad.as.leak.spread[20] = 0xFF; /* no number */
    bad.as.leak.spread[21] = 0xFF;
    expect_corrupt(&bad);
}

static void fields_of_fixed_clusters_that_nobody_writes_are_corrupt(void)
{
    struct mh_message bad = example(MH_MESSAGE_LEAD);
    bad.as.lead.sender = -1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_LEAD);
    bad.as.lead.cluster = MH_CLUSTER_NONE;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_LEAD);
    bad.as.lead.length = MH_LEAD_BYTES + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_LEAD);
    bad.as.lead.length = 62; /* one more behind the end */
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_TAKEN);
    bad.as.taken.cluster = MH_CLUSTER_NONE;
    expect_corrupt(&bad);
}

static void fields_of_a_targets_heads_that_nobody_writes_are_corrupt(void)
{
    struct mh_message bad = example(MH_MESSAGE_AWAKE);
    bad.as.awake.members = 0;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_AWAKE);
    bad.as.awake.members = MH_GROUP_MAX + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_AWAKE);
    bad.as.awake.extent_cm = -1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_AWAKE);
    bad.as.awake.length = 2 * MH_AWAKE_BYTES + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_AWAKE);
    bad.as.awake.length--; /* something behind the end */
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_REST);
    bad.as.rest.length = 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_LOCATE);
    bad.as.locate.kind = MH_LOCATE_COMPETITION + 1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_SOUND);
    bad.as.sound.asker = -1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_SOUND);
    bad.as.sound.y_mm = 1000000001;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_FAIL);
    bad.as.fail.x_mm = INT32_MIN;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_SUCCEED);
    bad.as.succeed.sender = -1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_COMPETE);
    bad.as.compete.y_mm = INT32_MIN;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_DETECTION);
    bad.as.detection.sender = -1;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_SUPPRESS);
    bad.as.suppress.released = 2;
    expect_corrupt(&bad);
    bad = example(MH_MESSAGE_MERGE);
    bad.as.merge.other = bad.as.merge.target;
    expect_corrupt(&bad);
}

static void what_clusters_say_makes_the_round_trip(void)
{
    for (enum mh_message_kind kind = MH_MESSAGE_ASK; kind < MH_MESSAGE_KINDS; kind++) {
        const struct mh_message message = example(kind);
        encode(&message);
        TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
        TEST_ASSERT_EQUAL(kind, decoded.kind);
        uint8_t again[MH_FRAME_MAX];
        size_t again_length;
        TEST_ASSERT_EQUAL(MH_OK, mh_wire_encode(mh_wire_all, &decoded, again, &again_length));
        TEST_ASSERT_EQUAL_MEMORY(frame, again, length);
        TEST_ASSERT_EQUAL_MEMORY(&message.as, &decoded.as, 2 * sizeof(int32_t)); /* two numbers first */
    }
    const struct mh_message position = example(MH_MESSAGE_POSITION);
    encode(&position);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
    TEST_ASSERT_EQUAL_INT32(1000000000, decoded.as.position.vx_mmps);
    const struct mh_message form = example(MH_MESSAGE_FORM);
    encode(&form);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
    TEST_ASSERT_EQUAL_UINT8(2, decoded.as.form.count);
    TEST_ASSERT_EQUAL_INT32(11, decoded.as.form.members[1]);
    const struct mh_message part = example(MH_MESSAGE_HAND_OVER);
    encode(&part);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &decoded));
    TEST_ASSERT_EQUAL_UINT8(255, decoded.as.hand_over.data[MH_HAND_OVER_BYTES - 1]);
}

static void envelopes_that_nobody_writes_are_corrupt(void)
{
    for (uint8_t i = 0; i < 8; i++) {
        struct mh_message bad = enveloped(MH_MESSAGE_REPORT, MH_ENVELOPE_FACE);
        int32_t *const fields[] = {&bad.header.route.sender, &bad.header.route.origin, &bad.header.entry,
                                   &bad.header.first};
        if (i < 4) {
            *fields[i] = -1;
        } else if (i == 4) {
            bad.header.route.hops = -1;
        } else if (i == 5) {
            bad.header.route.hops = MH_ROUTE_HOPS_MAX + 1;
        } else if (i == 6) {
            bad.header.route.y_mm = 1000000001;
        } else {
            bad.header.entry_x_mm = INT32_MIN;
        }
        encode(&bad);
        TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_wire_decode(mh_wire_all, frame, length, &decoded));
    }
}

static void unknown_kinds_are_not_encoded(void)
{
    struct mh_message message = example(MH_MESSAGE_BEACON);
    message.kind = MH_MESSAGE_KINDS;
    length = 99;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_wire_encode(mh_wire_all, &message, frame, &length));
    TEST_ASSERT_EQUAL(99, length);
    message = example(MH_MESSAGE_BEACON);
    message.envelope = MH_ENVELOPE_KINDS;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_wire_encode(mh_wire_all, &message, frame, &length));
}

/* Who speaks few types knows no others, nor an envelope without what is in it. */
static void only_what_is_spoken_is_understood(void)
{
    static mh_wire_types few[] = {&mh_wire_report, &mh_wire_route, NULL};
    for (int kind = 0; kind < MH_MESSAGE_KINDS; kind++) {
        for (int envelope = MH_ENVELOPE_NONE;
             fits((enum mh_message_kind)kind, envelope) && envelope < MH_ENVELOPE_KINDS; envelope++) {
            const struct mh_message message = enveloped((enum mh_message_kind)kind, (enum mh_envelope_kind)envelope);
            const bool spoken = kind == MH_MESSAGE_REPORT && envelope != MH_ENVELOPE_FACE;
            encode(&message);
            TEST_ASSERT_EQUAL(spoken ? MH_OK : MH_ERR_UNKNOWN, mh_wire_decode(few, frame, length, &decoded));
            TEST_ASSERT_EQUAL(spoken ? MH_OK : MH_ERR_ARGUMENT, mh_wire_encode(few, &message, frame, &length));
        }
    }
}

static void a_measurement_survives_its_report(void)
{
    const struct mh_measurement measurement = {.node = 0xFFFFFFFEu,
                                               .place = {1, -2, 3},
                                               .time = 0xFFFFFFFFu,
                                               .value = -4,
                                               .increment = 5,
                                               .flags = MH_MEASUREMENT_HAS_INCREMENT | MH_MEASUREMENT_ASKED,
                                               .target = 6};
    mh_report_t report;
    struct mh_measurement back;
    mh_report_from_measurement(&measurement, &report);
    mh_report_to_measurement(&report, &back);
    TEST_ASSERT_EQUAL_INT32(-2, report.sender);
    TEST_ASSERT_EQUAL_UINT8(0, report.hops);
    TEST_ASSERT_EQUAL_UINT32(measurement.node, back.node);
    TEST_ASSERT_EQUAL_INT32(-2, back.place.y_mm);
    TEST_ASSERT_EQUAL_INT32(3, back.place.z_mm);
    TEST_ASSERT_EQUAL_UINT32(measurement.time, back.time);
    TEST_ASSERT_EQUAL_INT32(-4, back.value);
    TEST_ASSERT_EQUAL_INT32(5, back.increment);
    TEST_ASSERT_EQUAL_UINT8(3, back.flags);
    TEST_ASSERT_EQUAL_UINT8(6, back.target);
}

static void a_measurement_survives_its_answer(void)
{
    const struct mh_measurement measurement = {.node = 0xFFFFFFFEu,
                                               .place = {1, -2, 3},
                                               .time = 0xFFFFFFFFu,
                                               .value = -4,
                                               .increment = 5,
                                               .flags = MH_MEASUREMENT_HAS_INCREMENT | MH_MEASUREMENT_ASKED};
    mh_answer_t answer;
    struct mh_measurement back;
    mh_answer_from_measurement(&measurement, &answer);
    mh_answer_to_measurement(&answer, &back);
    TEST_ASSERT_EQUAL_UINT32(measurement.node, back.node);
    TEST_ASSERT_EQUAL_INT32(-2, back.place.y_mm);
    TEST_ASSERT_EQUAL_INT32(3, back.place.z_mm);
    TEST_ASSERT_EQUAL_UINT32(measurement.time, back.time);
    TEST_ASSERT_EQUAL_INT32(-4, back.value);
    TEST_ASSERT_EQUAL_INT32(0, back.increment);
    TEST_ASSERT_EQUAL_UINT8(MH_MEASUREMENT_ASKED, back.flags);
}

/* Random bytes behind a right fingerprint and a right check sum: whatever is accepted encodes to the same bytes. */
static void any_bytes_are_safe(void)
{
    uint32_t random = 1;
    uint16_t accepted = 0;
    for (uint16_t trial = 0; trial < 300; trial++) {
        const int kind = (int)(trial % MH_MESSAGE_KINDS),
                  envelope = (int)(trial / MH_MESSAGE_KINDS % MH_ENVELOPE_KINDS);
        const struct mh_message message =
            enveloped((enum mh_message_kind)kind, within((enum mh_message_kind)kind, envelope));
        encode(&message);
        for (size_t i = 8; i < length - 2; i++) {
            random = random * 1664525u + 1013904223u;
            frame[i] = random >> 31 ? (uint8_t)(random >> 16) : frame[i];
        }
        seal(length - 2);
        if (mh_wire_decode(mh_wire_all, frame, length, &decoded) == MH_OK) {
            uint8_t again[MH_FRAME_MAX];
            size_t again_length;
            TEST_ASSERT_EQUAL(MH_OK, mh_wire_encode(mh_wire_all, &decoded, again, &again_length));
            TEST_ASSERT_EQUAL(length, again_length);
            TEST_ASSERT_EQUAL_MEMORY(frame, again, length);
            accepted++;
        }
    }
    TEST_ASSERT_GREATER_THAN(5, accepted);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(check_sum_of_the_catalogue);
    RUN_TEST(check_sum_equals_the_division_bit_by_bit);
    RUN_TEST(every_kind_makes_the_round_trip);
    RUN_TEST(a_neighbours_place_and_a_sinks_make_the_round_trip);
    RUN_TEST(an_envelope_travels_before_every_kind_that_leaves_room);
    RUN_TEST(every_single_bit_counts);
    RUN_TEST(every_truncation_is_refused);
    RUN_TEST(a_sound_frame_of_wrong_length_is_corrupt);
    RUN_TEST(an_unknown_type_is_told_apart);
    RUN_TEST(fields_that_nobody_writes_are_corrupt);
    RUN_TEST(fields_of_clusters_that_nobody_writes_are_corrupt);
    RUN_TEST(fields_of_a_search_that_nobody_writes_are_corrupt);
    RUN_TEST(fields_of_fixed_clusters_that_nobody_writes_are_corrupt);
    RUN_TEST(fields_of_a_targets_heads_that_nobody_writes_are_corrupt);
    RUN_TEST(what_clusters_say_makes_the_round_trip);
    RUN_TEST(envelopes_that_nobody_writes_are_corrupt);
    RUN_TEST(unknown_kinds_are_not_encoded);
    RUN_TEST(only_what_is_spoken_is_understood);
    RUN_TEST(a_measurement_survives_its_report);
    RUN_TEST(a_measurement_survives_its_answer);
    RUN_TEST(any_bytes_are_safe);
    port_exit(UNITY_END() > 0);
    return 0;
}
