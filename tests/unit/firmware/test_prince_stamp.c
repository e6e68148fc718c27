/* One mote's side of the election by the first detection, and who goes on watching, event by event. The other elections: test_prince.c. */
#include "motehound/prince.h"
#include "port.h"
#include "unity.h"

#include <string.h>

enum { NODE = 10, LOWER = 5, HEAD = 20, OTHER = 30, THIRD = 40 };

#define TARGET 321u
#define NOW 20000u /* hellos are over */

static struct {
    unsigned of_kind[MH_MESSAGE_KINDS];
    struct mh_message last[MH_MESSAGE_KINDS];
    mh_tick time, timer;
    bool sensing;
    unsigned sensed;
    mh_tick localised_at;
    size_t measurements;
    float energy; /* that the node hears */
    enum mh_status status;
} saw;

static void send(void *context, mh_node_id destination, const struct mh_message *message)
{
    (void)context;
    TEST_ASSERT_EQUAL_UINT32(MH_BROADCAST, destination);
    saw.of_kind[message->kind]++;
    saw.last[message->kind] = *message;
}

static void set_timer(void *context, mh_tick time)
{
    (void)context;
    saw.timer = time;
}

static void listen(void *context, bool needed)
{
    (void)context;
    (void)needed;
}

static bool network(void *context, mh_tick own, mh_tick *time)
{
    (void)context;
    *time = own;
    return true;
}

static mh_tick own(void *context, mh_tick time)
{
    (void)context;
    return time;
}

static void sense(void *context, mh_tick now, mh_tick time)
{
    (void)context;
    TEST_ASSERT_EQUAL_UINT32(now, time);
    saw.sensing = true;
    saw.sensed++;
}

static void tell(void *context, const struct mh_estimate *estimate)
{
    (void)context;
    (void)estimate;
}

static enum mh_status localise(void *context, const struct mh_saved_track *track, const struct mh_saved_track *others,
                               size_t count, mh_tick time, const struct mh_measurement *measurements,
                               size_t measurement_count, struct mh_estimate *estimate, uint8_t *bytes, size_t *length)
{
    const struct mh_estimate found = {.time = time, .velocity = {MH_REAL(10.0f), 0}, .members = 1};
    (void)context;
    (void)track;
    (void)others;
    (void)count;
    saw.measurements = measurement_count;
    saw.localised_at = time;
    for (size_t i = 0; i < measurement_count; i++) {
        TEST_ASSERT_EQUAL_UINT32(time, measurements[i].time);
    }
    if (saw.status == MH_OK) {
        *estimate = found;
        memset(bytes, 7, 46);
        *length = 46;
    }
    return saw.status;
}

static enum mh_status expect(void *context, const struct mh_saved_track *track, mh_tick time,
                             struct mh_estimate *estimate)
{
    (void)context;
    (void)track;
    (void)time;
    (void)estimate;
    return MH_NONE;
}

static enum mh_status join(void *context, const struct mh_saved_track *track, const struct mh_saved_track *other,
                           uint8_t *bytes, size_t *length)
{
    (void)context;
    (void)track;
    (void)other;
    (void)bytes;
    (void)length;
    return MH_NONE;
}

static enum mh_status part(void *context, uint8_t number, uint32_t *target, uint8_t *bytes, size_t *length)
{
    (void)context;
    (void)number;
    (void)target;
    (void)bytes;
    (void)length;
    return MH_NONE;
}

static const struct mh_protocol_port port = {.send = send,
                                             .set_timer = set_timer,
                                             .listen = listen,
                                             .network = network,
                                             .own = own,
                                             .sense = sense,
                                             .tell = tell};
static const struct mh_prince_port tracks = {.localise = localise, .expect = expect, .join = join, .part = part};
static const struct mh_protocol *const prince = &mh_protocol_prince;
static const struct mh_protocol_node node = {.id = NODE, .place = {40000, 0, 0}, .is_head = true, .port = &port};
static struct mh_prince_config config;
static struct mh_prince state;

/* Readings come at once, but after the event that wanted them. */
static void settle(void)
{
    while (saw.sensing) {
        const struct mh_measurement measurement = {.node = NODE,
                                                   .place = node.place,
                                                   .time = saw.time,
                                                   .value = mh_q20_from_real(mh_real_from_float(saw.energy))};
        saw.sensing = false;
        TEST_ASSERT_EQUAL(MH_OK, prince->publish(&state, saw.time, &measurement));
    }
}

static void run_until(mh_tick time)
{
    while (!mh_tick_before(time, saw.timer)) {
        saw.time = saw.timer;
        prince->timer(&state, saw.time);
        settle();
    }
    saw.time = time;
}

static void hear(struct mh_message message)
{
    prince->message(&state, saw.time, &message);
    settle();
}

static void come_up(enum mh_prince_election election, bool guarded)
{
    memset(&saw, 0, sizeof saw);
    mh_prince_config_default(&config, election, guarded, MH_REAL(40.0f), MH_REAL(140.0f));
    config.port = &tracks;
    TEST_ASSERT_EQUAL(MH_OK, prince->init(&state, &config, &node));
    prince->start(&state, saw.time);
    run_until(NOW);
}

void setUp(void) { come_up(MH_PRINCE_TIMESTAMP, true); }
void tearDown(void) {}

static struct mh_prince_row *row(void)
{
    for (size_t i = 0; i < MH_TARGETS_MAX; i++) {
        if (state.rows[i].state != MH_PRINCE_FREE) {
            return &state.rows[i];
        }
    }
    return NULL;
}

/* The target was found at the origin just now and goes along x; whoever hears it may contend at once. */
static struct mh_message awake(int16_t generation, mh_node_id head)
{
    const struct mh_message message = {.kind = MH_MESSAGE_AWAKE,
                                       .as.awake = {.sender = (int32_t)head,
                                                    .target = (int32_t)TARGET,
                                                    .generation = generation,
                                                    .time_ms = (int32_t)saw.time,
                                                    .vx_cmps = 1000,
                                                    .prince = -1,
                                                    .members = 1,
                                                    .length = 46}};
    return message;
}

static struct mh_message detection(int16_t generation, mh_node_id sender, mh_tick detected)
{
    const struct mh_message message = {.kind = MH_MESSAGE_DETECTION,
                                       .as.detection = {.sender = (int32_t)sender,
                                                        .target = (int32_t)TARGET,
                                                        .generation = generation,
                                                        .detected_ms = (int32_t)detected,
                                                        .x_mm = (int32_t)sender * 1000,
                                                        .value_q20 = MH_Q20(2.0f)}};
    return message;
}

static struct mh_message suppress(int16_t generation, mh_node_id sender, bool released)
{
    const struct mh_message message = {
        .kind = MH_MESSAGE_SUPPRESS,
        .as.suppress = {
            .sender = (int32_t)sender, .target = (int32_t)TARGET, .generation = generation, .released = released}};
    return message;
}

static struct mh_message succeed(int16_t generation, mh_node_id sender)
{
    const struct mh_message message = {
        .kind = MH_MESSAGE_SUCCEED,
        .as.succeed = {
            .sender = (int32_t)sender, .head = (int32_t)NODE, .target = (int32_t)TARGET, .generation = generation}};
    return message;
}

/* The target of generation 5 comes, and is detected at the next tick -> when. */
static mh_tick detect(void)
{
    hear(awake(5, HEAD));
    saw.energy = 2;
    const mh_tick tick = mh_tick_aligned(0, config.tick, saw.time + 1);
    run_until(tick);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, row()->state);
    return tick;
}

/* All the time that an election takes. */
static mh_tick over(mh_tick detected) { return detected + config.contest + 350; }

static void who_detects_the_target_says_when_and_how_loud(void)
{
    const mh_tick detected = detect();
    run_until(detected + config.contest);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_DETECTION]);
    const mh_detection_t *said = &saw.last[MH_MESSAGE_DETECTION].as.detection;
    TEST_ASSERT_EQUAL_INT32(NODE, said->sender);
    TEST_ASSERT_EQUAL_INT32(TARGET, said->target);
    TEST_ASSERT_EQUAL_INT16(6, said->generation);
    TEST_ASSERT_EQUAL_UINT32(detected, said->detected_ms);
    TEST_ASSERT_EQUAL_INT32(40000, said->x_mm);
    TEST_ASSERT_EQUAL_INT32(MH_Q20(2.0f), said->value_q20);
}

static void the_first_suppresses_the_others_and_locates_with_their_detections(void)
{
    const mh_tick detected = detect();
    hear(detection(6, OTHER, detected + 100));
    hear(detection(6, THIRD, detected + 200));
    run_until(detected + config.contest + 150 - 1);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_SUPPRESS]);
    run_until(over(detected));
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_SUPPRESS]);
    TEST_ASSERT_EQUAL(0, saw.last[MH_MESSAGE_SUPPRESS].as.suppress.released);
    TEST_ASSERT_EQUAL_INT16(6, saw.last[MH_MESSAGE_SUPPRESS].as.suppress.generation);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_LOCATE]);
    TEST_ASSERT_EQUAL(3, saw.measurements);
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, row()->state);
    TEST_ASSERT_EQUAL_UINT16(6, row()->generation);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_SUCCEED]);
    TEST_ASSERT_EQUAL_INT32(HEAD, saw.last[MH_MESSAGE_SUCCEED].as.succeed.head);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_AWAKE]);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.competitions);
}

/* Its fix is of the time when it detected the target: nobody samples again. */
static void the_first_does_not_sample_again(void)
{
    const mh_tick detected = detect();
    hear(detection(6, OTHER, detected + 100));
    hear(detection(6, THIRD, detected + 200));
    run_until(detected + config.contest);
    const unsigned sensed = saw.sensed;
    for (unsigned i = 0; i < saw.of_kind[MH_MESSAGE_HELLO] + saw.of_kind[MH_MESSAGE_DETECTION]; i++) {
        prince->sent(&state, saw.time, MH_SENT_OK);
        settle();
    }
    TEST_ASSERT_EQUAL(sensed, saw.sensed);
    run_until(over(detected));
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, row()->state);
    TEST_ASSERT_EQUAL_UINT32(detected, saw.localised_at);
    TEST_ASSERT_EQUAL_INT32(detected, saw.last[MH_MESSAGE_AWAKE].as.awake.time_ms);
}

static void who_was_later_holds_back(void)
{
    const mh_tick detected = detect();
    hear(detection(6, OTHER, detected - 1));
    hear(detection(6, THIRD, detected + 100));
    run_until(over(detected));
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_SUPPRESS]);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, row()->state);
    run_until(detected + config.contest + 150 + 750 - 1);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_DETECTION]);
    run_until(over(detected) + 1250 + 2 * config.tick + config.contest); /* nothing came of the others' */
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_DETECTION]);
}

static void of_two_at_once_the_lower_identifier_is_first(void)
{
    mh_tick detected = detect();
    hear(detection(6, LOWER, detected));
    hear(detection(6, THIRD, detected));
    run_until(over(detected));
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, row()->state);
    come_up(MH_PRINCE_TIMESTAMP, true);
    detected = detect();
    hear(detection(6, OTHER, detected));
    hear(detection(6, THIRD, detected));
    run_until(over(detected));
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, row()->state);
}

/* Nobody has heard of it, so it does not lead either, though it was the first of all. */
static void after_three_detections_others_are_silent(void)
{
    const mh_tick detected = detect();
    for (mh_node_id sender = OTHER; sender < OTHER + 3; sender++) {
        hear(detection(6, sender, detected + 1));
    }
    run_until(over(detected));
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_DETECTION]);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_SUPPRESS]);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, row()->state);
}

static void too_few_detections_fail(void)
{
    const mh_tick detected = detect();
    hear(detection(6, OTHER, detected + 1));
    run_until(over(detected));
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_SUPPRESS]);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_FAIL]);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.relays);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, row()->state);
    TEST_ASSERT_EQUAL_UINT16(5, row()->generation);
}

static void who_is_suppressed_is_silent_until_released(void)
{
    const mh_tick detected = detect();
    hear(suppress(6, OTHER, false));
    run_until(detected + 1500);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_DETECTION]);
    hear(suppress(6, OTHER, true));
    run_until(saw.time + config.tick + config.contest);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_DETECTION]);
}

static void a_release_that_is_lost_is_not_waited_for_forever(void)
{
    const mh_tick detected = detect();
    hear(suppress(6, OTHER, false));
    run_until(detected + 2000 + config.tick + config.contest);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_DETECTION]);
}

static void who_suppresses_for_an_old_generation_does_not(void)
{
    const mh_tick detected = detect();
    hear(suppress(5, OTHER, false));
    run_until(detected + config.contest);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_DETECTION]);
}

static void become_head(void)
{
    const mh_tick detected = detect();
    hear(detection(6, OTHER, detected + 100));
    hear(detection(6, THIRD, detected + 200));
    run_until(over(detected));
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, row()->state);
}

/* Though the new head speaks before. */
static void the_old_head_releases_them(void)
{
    become_head();
    saw.energy = 0;
    hear(succeed(7, OTHER));
    const mh_tick relieved = saw.time;
    run_until(relieved + 20);
    hear(awake(7, OTHER));
    run_until(relieved + 199);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_SUPPRESS]);
    run_until(relieved + 200);
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_SUPPRESS]);
    TEST_ASSERT_EQUAL(1, saw.last[MH_MESSAGE_SUPPRESS].as.suppress.released);
    TEST_ASSERT_EQUAL_INT32(TARGET, saw.last[MH_MESSAGE_SUPPRESS].as.suppress.target);
}

static void who_contends_for_what_has_been_found_is_told(void)
{
    become_head();
    run_until(saw.time + 1000);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_AWAKE]);
    hear(detection(6, OTHER, saw.time));
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_AWAKE]);
    hear(detection(6, THIRD, saw.time));
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_AWAKE]);
}

/* The target, 20 m/s fast, should be out of range after 4 s, and 3 s later all is over. */
static void pass_by(void)
{
    struct mh_message fast = awake(5, HEAD);
    fast.as.awake.vx_cmps = 2000;
    fast.as.awake.prince = OTHER;
    fast.as.awake.enters_cs = 3000;
    hear(fast);
    TEST_ASSERT_EQUAL(MH_NODE_INNER, row()->as);
}

static void who_hears_the_target_when_its_time_is_over_watches_on(void)
{
    come_up(MH_PRINCE_NAMED, true);
    pass_by();
    const mh_tick found = saw.time;
    run_until(found + 6500);
    saw.energy = 2;
    run_until(found + 7100);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, row()->state);
    TEST_ASSERT_EQUAL(MH_NODE_COMPETITOR, row()->as);
    run_until(found + 8000);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_COMPETE]);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_LOCATE]);
    saw.energy = 0;
    run_until(found + 40000);
    TEST_ASSERT_NULL(row());
}

static void who_does_not_or_is_not_guarded_sleeps(void)
{
    for (uint8_t guarded = 0; guarded < 2; guarded++) {
        come_up(MH_PRINCE_NAMED, guarded);
        pass_by();
        const mh_tick found = saw.time;
        run_until(found + 6500);
        saw.energy = guarded ? 0 : 2;
        run_until(found + 6900);
        TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, row()->state);
        run_until(found + 7100);
        TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, row()->state);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(who_detects_the_target_says_when_and_how_loud);
    RUN_TEST(the_first_suppresses_the_others_and_locates_with_their_detections);
    RUN_TEST(the_first_does_not_sample_again);
    RUN_TEST(who_was_later_holds_back);
    RUN_TEST(of_two_at_once_the_lower_identifier_is_first);
    RUN_TEST(after_three_detections_others_are_silent);
    RUN_TEST(too_few_detections_fail);
    RUN_TEST(who_is_suppressed_is_silent_until_released);
    RUN_TEST(a_release_that_is_lost_is_not_waited_for_forever);
    RUN_TEST(who_suppresses_for_an_old_generation_does_not);
    RUN_TEST(the_old_head_releases_them);
    RUN_TEST(who_contends_for_what_has_been_found_is_told);
    RUN_TEST(who_hears_the_target_when_its_time_is_over_watches_on);
    RUN_TEST(who_does_not_or_is_not_guarded_sleeps);
    port_exit(UNITY_END() > 0);
}
