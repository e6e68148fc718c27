/* A mote of the protocol `prince` under hostile frames and clocks.
 *
 * The first byte chooses: bits 0-1 the election, 2 the guards, 3 radios that sleep, 4 groups, 5 the tracker `dm`, 6 that new targets are looked for. Then come events, each an opcode and its operands; see next_event().
 * Whatever happens: what the mote transmits are frames that it would take itself, and what it reports are finite numbers with a covariance. */
#include "fuzz.h"
#include "motehound/acoustic.h"
#include "motehound/mote.h"

#include <string.h>

enum { EVENTS_MAX = 300, ALARMS_MAX = 20, SELF = 7 };

struct world {
    struct mh_mote mote;
    mh_tick now, alarm;
    int alarm_set;
    int sampling;
};

static int32_t metres(struct input *input) { return (byte(input) - 128) * 1000; }

/* ---- what the mote asks ---- */

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    (void)context;
    struct mh_message message;
    require(destination == MH_BROADCAST && length <= MH_FRAME_MAX);
    require(mh_wire_decode(mh_wire_all, frame, length, &message) == MH_OK);
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
}

static void sense(void *context)
{
    struct world *world = context;
    world->sampling = 1;
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
    require(mh_wire_encode(mh_wire_all, message, frame, &length) == MH_OK);
    (void)mh_mote_frame(&world->mote, world->now, frame, length);
}

static void hear_awake(struct world *world, struct input *input)
{
    struct mh_message message = {.kind = MH_MESSAGE_AWAKE};
    mh_awake_t *awake = &message.as.awake;
    awake->sender = byte(input) % 16;
    awake->target = byte(input) % 8;
    awake->generation = (int16_t)byte(input);
    awake->time_ms = (int32_t)(world->now - 16u * byte(input));
    awake->x_mm = metres(input);
    awake->y_mm = metres(input);
    awake->vx_cmps = (int16_t)((byte(input) - 128) * 16);
    awake->vy_cmps = (int16_t)((byte(input) - 128) * 256);
    awake->prince = byte(input) % 16;
    awake->enters_cs = (int16_t)(byte(input) * 128);
    awake->members = (uint8_t)(byte(input) % MH_GROUP_MAX + 1);
    awake->length = byte(input) % (2 * MH_AWAKE_BYTES + 1);
    bytes(input, awake->data, awake->length < MH_AWAKE_BYTES ? awake->length : MH_AWAKE_BYTES);
    hear(world, &message);
}

/* The others, whose fields have much in common. */
static void hear_other(struct world *world, struct input *input)
{
    const uint8_t kind = byte(input);
    const int32_t sender = byte(input) % 16, target = byte(input) % 8, time = (int32_t)(world->now - byte(input));
    const int16_t generation = (int16_t)byte(input);
    const int32_t x_mm = metres(input), y_mm = metres(input);
    const mh_q20 value = (mh_q20)((uint32_t)byte(input) << 23);
    struct mh_message message = {.kind = (enum mh_message_kind)(MH_MESSAGE_REST + kind % 9)};
    switch (message.kind) {
    case MH_MESSAGE_REST:
        message.as.rest = (mh_rest_t){.sender = sender, .target = target, .generation = generation};
        message.as.rest.length = (uint8_t)bytes(input, message.as.rest.data, byte(input) % (MH_AWAKE_BYTES + 1));
        break;
    case MH_MESSAGE_LOCATE:
        message.as.locate = (mh_locate_t){.sender = sender,
                                          .target = target,
                                          .generation = generation,
                                          .time_ms = time,
                                          .kind = kind / 9 % (MH_LOCATE_COMPETITION + 1)};
        break;
    case MH_MESSAGE_SOUND: { /* to this node's last query, or any */
        const struct mh_prince *state = world->mote.config->protocol_state;
        message.as.sound = (mh_sound_t){.sender = sender,
                                        .asker = SELF,
                                        .target = target,
                                        .time_ms = (int32_t)state->rows[target % MH_TARGETS_MAX].asked,
                                        .x_mm = x_mm,
                                        .y_mm = y_mm,
                                        .value_q20 = value};
        message.as.sound.target = (int32_t)state->rows[target % MH_TARGETS_MAX].target;
        break;
    }
    case MH_MESSAGE_FAIL:
        message.as.fail = (mh_fail_t){
            .sender = sender, .target = target, .generation = generation, .time_ms = time, .x_mm = x_mm, .y_mm = y_mm};
        break;
    case MH_MESSAGE_SUCCEED:
        message.as.succeed = (mh_succeed_t){.sender = sender, .head = SELF, .target = target, .generation = generation};
        break;
    case MH_MESSAGE_COMPETE:
        message.as.compete = (mh_compete_t){.sender = sender,
                                            .target = target,
                                            .generation = generation,
                                            .time_ms = time,
                                            .x_mm = x_mm,
                                            .y_mm = y_mm,
                                            .value_q20 = value};
        break;
    case MH_MESSAGE_DETECTION:
        message.as.detection = (mh_detection_t){.sender = sender,
                                                .target = target,
                                                .generation = generation,
                                                .detected_ms = time,
                                                .x_mm = x_mm,
                                                .y_mm = y_mm,
                                                .value_q20 = value};
        break;
    case MH_MESSAGE_SUPPRESS:
        message.as.suppress =
            (mh_suppress_t){.sender = sender, .target = target, .generation = generation, .released = kind / 9 % 2};
        break;
    default:
        message.as.merge = (mh_merge_t){.sender = sender,
                                        .target = target,
                                        .other = byte(input) % 8 + 8,
                                        .generation = generation,
                                        .answers = kind / 9 % 2};
        break;
    }
    hear(world, &message);
}

static void hear_hello(struct world *world, struct input *input)
{
    const struct mh_message message = {
        .kind = MH_MESSAGE_HELLO,
        .as.hello = {.sender = byte(input) % 16, .x_mm = metres(input), .y_mm = metres(input)}};
    hear(world, &message);
}

static void read_sensor(struct world *world, struct input *input)
{
    const struct mh_reading reading = {world->now, (int32_t)((uint32_t)byte(input) << 23) - 4096 * byte(input), 0};
    world->sampling = 0;
    (void)mh_mote_reading(&world->mote, world->now, &reading);
}

static void next_event(struct world *world, struct input *input)
{
    uint8_t frame[256];
    size_t length;
    switch (byte(input) % 8) {
    case 0:
        length = bytes(input, frame, byte(input));
        (void)mh_mote_frame(&world->mote, world->now, frame, length);
        break;
    case 1:
        hear_awake(world, input);
        break;
    case 2:
    case 3:
        hear_other(world, input);
        break;
    case 4:
        hear_hello(world, input);
        break;
    case 5:
        world->now += 4u * byte(input);
        break;
    case 6:
        world->now += (mh_tick)byte(input) << byte(input) % 25;
        break;
    default:
        if (world->alarm_set) {
            world->now = mh_tick_before(world->now, world->alarm) ? world->alarm : world->now;
        }
        break;
    }
    ring(world);
    if (world->sampling) {
        read_sensor(world, input);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report, .sense = sense};
    static const struct mh_sensor_config sensor = {
        .q20_per_count = 1, .counts_min = INT32_MIN, .counts_max = INT32_MAX, .interval = 1, .report_always = true};
    static const struct mh_prince_entry entry = {{0, 0, 0}, 2000};
    struct input input = {data, size};
    const uint8_t choice = byte(&input);
    struct mh_acoustic_config tracking;
    static struct mh_acoustic track;
    mh_acoustic_config_default(&tracking, 40);
    if ((choice & 48) == 16) {
        mh_group_config_default(&tracking.group, MH_GROUP_MEMBERS);
    }
    tracking.separation = choice & 32 ? MH_SEPARATION_DECOMPOSITION : MH_SEPARATION_JOINT;
    struct mh_prince_config heads;
    static struct mh_prince state;
    mh_prince_config_default(&heads, (enum mh_prince_election)((choice & 3) % 3), (choice & 4) == 0, 40, 140);
    heads.port = &mh_mote_prince;
    heads.wake_period = choice & 8 ? 250 : 0;
    heads.wake_length = 10;
    heads.watch_period = choice & 64 ? 250 : 0;
    heads.entries = &entry;
    heads.entry_count = 1;
    const struct mh_head_config head_config = {.tracker = choice & 32 ? &mh_tracker_dm : &mh_tracker_acoustic,
                                               .tracker_config = &tracking,
                                               .tracker_state = &track,
                                               .interval = 250};
    static struct mh_head head;
    const struct mh_mote_config config = {.id = SELF,
                                          .sensor = &sensor,
                                          .head = &head_config,
                                          .head_state = &head,
                                          .protocol = &mh_protocol_prince,
                                          .protocol_config = &heads,
                                          .protocol_state = &state};
    struct world world = {.now = 1000};
    require(mh_mote_init(&world.mote, &config, &port, &world, world.now) == MH_OK);
    for (int i = 0; i < EVENTS_MAX && input.left > 0; i++) {
        next_event(&world, &input);
    }
    return 0;
}
