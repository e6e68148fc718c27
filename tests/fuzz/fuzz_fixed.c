/* A mote of fixed clusters under hostile frames and clocks: a first member, another member, a relay, or the sink with its fusion centre.
 *
 * The first byte chooses: bits 0-1 the role, 2-5 the rule of fusion, 6 the tracker, 7 a clock of its own. Then come events, each an opcode and its operands; see next_event().
 * Whatever happens: what the mote transmits are frames that it would take itself, what it reports are finite numbers with a covariance, and a head's track is a Gaussian. */
#include "fuzz.h"
#include "motehound/cv.h"
#include "motehound/fusion_centre.h"
#include "motehound/geographic.h"
#include "motehound/mote.h"

#include <string.h>

enum { EVENTS_MAX = 300, ALARMS_MAX = 20, INTERVAL = 500, SELF = 7, SINK = 20 };

struct world {
    struct mh_mote mote;
    mh_tick now, alarm;
    int alarm_set, is_sink;
};

/* ---- what the mote asks ---- */

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
    require(estimate->covariance.xx > 0 && estimate->covariance.yy > 0 && mh_finite(estimate->covariance.xy));
    require(estimate->covariance_more[2] > 0 && estimate->covariance_more[6] > 0);
}

static void ring(struct world *world)
{
    for (int i = 0; i < ALARMS_MAX && world->alarm_set && !mh_tick_before(world->now, world->alarm); i++) {
        world->alarm_set = 0;
        mh_mote_alarm(&world->mote, world->now);
    }
}

/* ---- what others say ---- */

static void hear(struct world *world, const struct mh_message *message)
{
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    if (mh_wire_encode(mh_wire_all, message, frame, &length) == MH_OK) {
        (void)mh_mote_frame(&world->mote, world->now, frame, length);
    }
}

/* To this mote, or sometimes to be passed on. */
static void hear_enveloped(struct world *world, struct input *input, struct mh_message *message)
{
    const struct mh_place place = {0, 0, 0};
    const uint8_t who = byte(input);
    const mh_node_id self = world->is_sink ? SINK : SELF;
    mh_geographic_address(message, who % 32, (int16_t)byte(input), who < 224 ? self : SINK - SELF, &place);
    hear(world, message);
}

/* A whole report interval near now. */
static mh_tick instant(const struct world *world, uint8_t choice)
{
    return world->now / 1000 * 1000 + (choice & 1 ? 1000u : 0) - (choice & 2 ? 2000u : 0);
}

static void hear_lead(struct world *world, struct input *input)
{
    const uint8_t choice = byte(input);
    struct mh_message message = {.kind = MH_MESSAGE_LEAD,
                                 .as.lead = {.sender = SELF - 2 + choice % 5,
                                             .since_ms = (int32_t)(world->now - (mh_tick)byte(input) * 100),
                                             .cluster = choice >> 6}};
    message.as.lead.length = (uint8_t)bytes(input, message.as.lead.data, choice & 32 ? MH_CV_SAVED : choice % 65);
    hear(world, &message);
}

static void hear_report(struct world *world, struct input *input)
{
    const struct mh_measurement measurement = {.node = SELF - 2u + byte(input) % 5,
                                               .place = {(byte(input) - 128) * 500, (byte(input) - 128) * 500, 0},
                                               .time = instant(world, byte(input)) - byte(input) * 10u,
                                               .value = (mh_q20)byte(input) << 19};
    struct mh_message message = {.kind = MH_MESSAGE_REPORT};
    mh_report_from_measurement(&measurement, &message.as.report);
    hear_enveloped(world, input, &message);
}

/* What is nearly a summary: small numbers, with a positive diagonal more often than not. */
static size_t make_summary(struct world *world, struct input *input, uint8_t *summary)
{
    const enum mh_summary_kind kind = (enum mh_summary_kind)(1 + byte(input) % 4);
    struct mh_summary made = {.kind = kind, .since = instant(world, byte(input)), .clusters = byte(input)};
    struct mh_gaussian *plain = kind == MH_SUMMARY_SPLIT ? &made.of.split.dependent : &made.of.plain;
    plain->n = MH_SUMMARY_STATES;
    if (kind == MH_SUMMARY_INCREMENT) {
        made.of.increment.n = MH_SUMMARY_STATES;
        for (int i = 0; i < MH_SUMMARY_STATES; i++) {
            made.of.increment.vector[i] = (mh_real)byte(input);
            made.of.increment.matrix[MH_PACKED(i, i)] = (mh_real)byte(input) - 2.0f;
        }
    } else {
        for (int i = 0; i < MH_SUMMARY_STATES; i++) {
            plain->x[i] = (mh_real)byte(input);
            plain->P[MH_PACKED(i, i)] = (mh_real)byte(input) / 64.0f;
        }
        plain->P[MH_PACKED(0, 1)] = (mh_real)(byte(input) - 128) / 64.0f;
    }
    return mh_summary_write(&made, summary);
}

/* A summary for the sink, or the centre's feedback, or any bytes for either. */
static void hear_parcel(struct world *world, struct input *input, int any)
{
    uint8_t parcel[128] = {0};
    const size_t length = any ? 1 + bytes(input, parcel, byte(input) % 127) : make_summary(world, input, parcel);
    const mh_tick time = instant(world, byte(input));
    struct mh_message message = {
        .kind = MH_MESSAGE_HAND_OVER,
        .as.hand_over = {.track = byte(input) % 4, .generation = (int32_t)time, .time_ms = (int32_t)time}};
    for (uint8_t part = 0; part < MH_PARCEL_PARTS(length); part++) {
        mh_parcel_cut(parcel, length, part, &message.as.hand_over);
        hear_enveloped(world, input, &message);
    }
}

static void hear_taken(struct world *world, struct input *input)
{
    struct mh_message message = {
        .kind = MH_MESSAGE_TAKEN,
        .as.taken = {.time_ms = (int32_t)instant(world, byte(input)), .cluster = byte(input) % 4}};
    hear_enveloped(world, input, &message);
}

static void hear_hello(struct world *world, struct input *input)
{
    const struct mh_message message = {.kind = MH_MESSAGE_HELLO,
                                       .as.hello = {.sender = byte(input) % 40,
                                                    .x_mm = (byte(input) - 128) * 1000,
                                                    .y_mm = (byte(input) - 128) * 1000,
                                                    .sequence = byte(input) % 4}};
    hear(world, &message);
}

static void read_sensor(struct world *world, struct input *input)
{
    const struct mh_reading r = {world->now - byte(input), byte(input) << 19, 0};
    (void)mh_mote_reading(&world->mote, world->now, &r);
}

static void next_event(struct world *world, struct input *input)
{
    uint8_t frame[256];
    size_t length;
    switch (byte(input) % 12) {
    case 0:
        length = bytes(input, frame, byte(input));
        (void)mh_mote_frame(&world->mote, world->now, frame, length);
        break;
    case 1:
        hear_lead(world, input);
        break;
    case 2:
        hear_report(world, input);
        break;
    case 3:
        hear_parcel(world, input, 0);
        break;
    case 4:
        hear_parcel(world, input, 1);
        break;
    case 5:
        hear_taken(world, input);
        break;
    case 6:
        hear_hello(world, input);
        break;
    case 7:
        read_sensor(world, input);
        break;
    case 8:
    case 9:
        mh_mote_sent(&world->mote, world->now, (enum mh_sent)(byte(input) % 3));
        break;
    case 10:
        world->now += 4u * byte(input);
        break;
    default:
        world->now += (mh_tick)byte(input) << byte(input) % 25;
        break;
    }
    ring(world);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct mh_fixed_member first[] = {{SELF, {0, 0, 0}}, {8, {5000, 0, 0}}, {9, {0, 5000, 0}}};
    static const struct mh_fixed_member second[] = {{5, {0, 9000, 0}}, {6, {0, 7000, 0}}, {SELF, {0, 0, 0}}};
    static const struct mh_fixed_member others[] = {{10, {40000, 0, 0}}, {11, {45000, 0, 0}}};
    static const struct mh_fixed_cluster of_role[4][2] = {
        {{first, 3}, {others, 2}}, {{others, 2}, {second, 3}}, {{others, 2}, {others, 2}}, {{first, 3}, {others, 2}}};
    static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report};
    static const struct mh_sensor_config sensor = {.q20_per_count = 1,
                                                   .counts_min = INT32_MIN,
                                                   .counts_max = INT32_MAX,
                                                   .interval = INTERVAL,
                                                   .report_always = true};
    struct input input = {data, size};
    const uint8_t choice = byte(&input), role = choice & 3;
    const enum mh_fusion_rule rule = (enum mh_fusion_rule)((choice >> 2 & 15) % MH_FUSION_CENTRAL);
    const int is_sink = role == 3;
    struct mh_cv_config tracking;
    static struct mh_cv track;
    mh_cv_config_default(&tracking);
    tracking.summary = mh_summary_kind_of(rule);
    struct mh_fusion_centre_config joining;
    static struct mh_fusion_centre centre;
    mh_fusion_centre_config_default(&joining);
    joining.rule = rule;
    joining.clusters = 2;
    struct mh_fixed_config clusters;
    static struct mh_fixed state;
    mh_fixed_config_default(&clusters);
    clusters.port = &mh_mote_fixed;
    clusters.sink = SINK;
    clusters.clusters = of_role[role];
    clusters.cluster_count = 2;
    clusters.acknowledges = tracking.summary == MH_SUMMARY_INCREMENT;
    const struct mh_head_config head_config = {.tracker = choice & 64 ? &mh_tracker_cv_ekf : &mh_tracker_cv_ukf,
                                               .tracker_config = &tracking,
                                               .tracker_state = &track,
                                               .interval = INTERVAL,
                                               .window = 200,
                                               .tolerance = 20,
                                               .lateness = tracking.lag};
    static struct mh_head head;
    struct mh_clock clock;
    const struct mh_clock_config clock_config = {.period = 2000, .wait = 100, .sent_q8 = 128};
    const struct mh_mote_config config = {.id = is_sink ? SINK : SELF,
                                          .sensor = is_sink ? NULL : &sensor,
                                          .head = is_sink ? NULL : &head_config,
                                          .head_state = &head,
                                          .protocol = &mh_protocol_fixed,
                                          .protocol_config = &clusters,
                                          .protocol_state = &state,
                                          .centre = is_sink ? &mh_centre_fusion : NULL,
                                          .centre_config = &joining,
                                          .centre_state = &centre,
                                          .clock = choice & 128 ? &mh_clock_flooding : NULL,
                                          .clock_config = &clock_config,
                                          .clock_state = &clock};
    struct world world = {.is_sink = is_sink};
    require(mh_mote_init(&world.mote, &config, &port, &world, world.now) == MH_OK);
    for (int i = 0; i < EVENTS_MAX && input.left > 0; i++) {
        next_event(&world, &input);
    }
    if (world.mote.leads) {
        require(mh_gaussian_check(&track.latest.state) == MH_OK && mh_gaussian_check(&track.reference) == MH_OK);
    }
    return 0;
}
