/* One mote's side of `prince`, event by event; times are the network's. The states are those of docs/prince.md. Whole networks: tests/network. */
#include "motehound/prince.h"
#include "port.h"
#include "unity.h"

#include <string.h>

enum { NODE = 10, HEAD = 20, OTHER = 30, THIRD = 40, NEXT = 50, AHEAD = 777 /* of the mote's own clock */ };

#define TARGET 321u
#define NOW 20000u /* hellos are over */

static struct {
    unsigned sent, of_kind[MH_MESSAGE_KINDS];
    struct mh_message last[MH_MESSAGE_KINDS]; /* of each kind from MH_MESSAGE_AWAKE on */
    mh_tick time, timer;
    bool sensing, publishing, listens, knows_time;
    mh_tick delay; /* from wanting a reading to having it */
    unsigned sensed, told, localised, began, others;
    size_t measurements;
    mh_tick localised_at;
    mh_q20 own_value; /* of the measurement that is the node's own */
    float energy;     /* that the node hears */
    enum mh_status status;
    struct mh_estimate estimate, told_of;
    enum mh_status join_status;
    unsigned joined;
    uint32_t expected_of;
    uint8_t expected_byte;
    size_t length;
} saw;

static void send(void *context, mh_node_id destination, const struct mh_message *message)
{
    (void)context;
    TEST_ASSERT_EQUAL_UINT32(MH_BROADCAST, destination);
    saw.sent++;
    saw.of_kind[message->kind]++;
    saw.last[message->kind] = *message;
}

static void set_timer(void *context, mh_tick time)
{
    (void)context;
    saw.timer = time - AHEAD;
}

static void listen(void *context, bool needed)
{
    (void)context;
    saw.listens = needed;
}

static bool network(void *context, mh_tick own, mh_tick *time)
{
    (void)context;
    *time = saw.knows_time ? own - AHEAD : *time;
    return saw.knows_time;
}

static mh_tick own(void *context, mh_tick time)
{
    (void)context;
    return time + AHEAD;
}

static void sense(void *context, mh_tick now, mh_tick time)
{
    (void)context;
    TEST_ASSERT_EQUAL_UINT32(now - AHEAD, time);
    TEST_ASSERT_FALSE_MESSAGE(saw.publishing && time == saw.time, "a mote hands over what it has during the call");
    saw.sensing = true;
    saw.sensed++;
}

static void tell(void *context, const struct mh_estimate *estimate)
{
    (void)context;
    saw.told++;
    saw.told_of = *estimate;
}

static enum mh_status localise(void *context, const struct mh_saved_track *track, const struct mh_saved_track *others,
                               size_t count, mh_tick time, const struct mh_measurement *measurements,
                               size_t measurement_count, struct mh_estimate *estimate, uint8_t *bytes, size_t *length)
{
    (void)context;
    (void)others;
    saw.localised++;
    saw.began += track->length == 0;
    saw.others = (unsigned)count;
    saw.measurements = measurement_count;
    saw.localised_at = time;
    for (size_t i = 0; i < measurement_count; i++) {
        saw.own_value = measurements[i].node == NODE ? measurements[i].value : saw.own_value;
        TEST_ASSERT_EQUAL_UINT32(time, measurements[i].time);
        TEST_ASSERT_EQUAL(0, measurements[i].target);
    }
    if (saw.status == MH_OK) {
        *estimate = saw.estimate;
        estimate->time = time;
        memset(bytes, 7, saw.length);
        *length = saw.length;
    }
    return saw.status;
}

static enum mh_status expect(void *context, const struct mh_saved_track *track, mh_tick time,
                             struct mh_estimate *estimate)
{
    (void)context;
    saw.expected_of = track->target;
    saw.expected_byte = track->bytes[0];
    *estimate = saw.estimate;
    estimate->flags = 0;
    estimate->time = time;
    estimate->members = track->length == 80 ? 2 : 1;
    return MH_OK;
}

static enum mh_status join(void *context, const struct mh_saved_track *track, const struct mh_saved_track *other,
                           uint8_t *bytes, size_t *length)
{
    (void)context;
    (void)track;
    (void)other;
    memset(bytes, 9, 80);
    *length = 80;
    saw.joined++;
    return saw.join_status;
}

static enum mh_status part(void *context, uint8_t number, uint32_t *target, uint8_t *bytes, size_t *length)
{
    (void)context;
    *target = TARGET + number;
    *length = 40;
    memset(bytes, number, 40);
    return number < 2 ? MH_OK : MH_NONE;
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
static struct mh_prince_config config;
static struct mh_protocol_node node;
static struct mh_prince state;

/* Readings come at once or after `delay`, but after the event that wanted them. */
static void settle(void)
{
    while (saw.sensing) {
        saw.time += saw.delay;
        const struct mh_measurement measurement = {.node = NODE,
                                                   .place = node.place,
                                                   .time = saw.time,
                                                   .value = mh_q20_from_real(mh_real_from_float(saw.energy))};
        saw.sensing = false;
        saw.publishing = true;
        TEST_ASSERT_EQUAL(MH_OK, prince->publish(&state, saw.time + AHEAD, &measurement));
        saw.publishing = false;
    }
}

static void run_until(mh_tick time)
{
    while (!mh_tick_before(time, saw.timer)) {
        TEST_ASSERT_FALSE(mh_tick_before(saw.timer, saw.time));
        saw.time = saw.timer;
        prince->timer(&state, saw.time + AHEAD);
        settle();
    }
    if (mh_tick_before(saw.time, time)) {
        saw.time = time;
    }
}

static void hear(const struct mh_message *message)
{
    prince->message(&state, saw.time + AHEAD, message);
    settle();
}

/* At 40, 0 m. */
static void come_up(void)
{
    const struct mh_protocol_node plain = {.id = NODE, .place = {40000, 0, 0}, .is_head = true, .port = &port};
    memset(&saw, 0, sizeof saw);
    saw.knows_time = true;
    saw.length = 46;
    saw.estimate.velocity.x = MH_REAL(10.0f);
    saw.time = 5;
    node = plain;
    TEST_ASSERT_EQUAL(MH_OK, prince->init(&state, &config, &node));
    prince->start(&state, saw.time + AHEAD);
    run_until(NOW);
    saw.sent = 0;
}

void setUp(void)
{
    mh_prince_config_default(&config, MH_PRINCE_NAMED, true, MH_REAL(40.0f), MH_REAL(140.0f));
    config.port = &tracks;
    come_up();
}

void tearDown(void) {}

static struct mh_prince_row *row_of(uint32_t target)
{
    struct mh_prince_row *found = NULL;
    for (size_t i = 0; i < MH_TARGETS_MAX; i++) {
        if (state.rows[i].state != MH_PRINCE_FREE && state.rows[i].target == target) {
            found = &state.rows[i];
        }
    }
    return found;
}

static uint8_t state_of(uint32_t target)
{
    const struct mh_prince_row *row = row_of(target);
    return row ? row->state : MH_PRINCE_FREE;
}

/* The target was found at the origin just now, and goes along x at 10 m/s; the head stands there, too. The node (40, 0) enters at once. */
static struct mh_message awake(int16_t generation, mh_node_id head, mh_node_id next)
{
    const struct mh_message message = {.kind = MH_MESSAGE_AWAKE,
                                       .as.awake = {.sender = (int32_t)head,
                                                    .target = (int32_t)TARGET,
                                                    .generation = generation,
                                                    .time_ms = (int32_t)saw.time,
                                                    .vx_cmps = 1000,
                                                    .prince = (int32_t)next,
                                                    .enters_cs = 100,
                                                    .members = 1,
                                                    .length = 46}};
    return message;
}

static struct mh_message locate(int16_t generation, mh_node_id sender, enum mh_locate kind)
{
    const struct mh_message message = {.kind = MH_MESSAGE_LOCATE,
                                       .as.locate = {.sender = (int32_t)sender,
                                                     .target = (int32_t)TARGET,
                                                     .generation = generation,
                                                     .time_ms = (int32_t)saw.time,
                                                     .kind = (uint8_t)kind}};
    return message;
}

static struct mh_message sound(const struct mh_message *query, mh_node_id sender)
{
    const struct mh_message message = {.kind = MH_MESSAGE_SOUND,
                                       .as.sound = {.sender = (int32_t)sender,
                                                    .asker = query->as.locate.sender,
                                                    .target = query->as.locate.target,
                                                    .time_ms = query->as.locate.time_ms,
                                                    .x_mm = (int32_t)sender * 1000,
                                                    .value_q20 = MH_Q20(2.0f),
                                                    .share = 255}};
    return message;
}

static struct mh_message failed(int16_t generation, mh_node_id sender)
{
    const struct mh_message message = {.kind = MH_MESSAGE_FAIL,
                                       .as.fail = {.sender = (int32_t)sender,
                                                   .target = (int32_t)TARGET,
                                                   .generation = generation,
                                                   .time_ms = (int32_t)saw.time,
                                                   .vx_cmps = 1000}};
    return message;
}

static struct mh_message succeed(int16_t generation, mh_node_id sender, mh_node_id head)
{
    const struct mh_message message = {
        .kind = MH_MESSAGE_SUCCEED,
        .as.succeed = {
            .sender = (int32_t)sender, .head = (int32_t)head, .target = (int32_t)TARGET, .generation = generation}};
    return message;
}

static struct mh_message compete(int16_t generation, mh_node_id sender, float energy)
{
    const struct mh_message message = {.kind = MH_MESSAGE_COMPETE,
                                       .as.compete = {.sender = (int32_t)sender,
                                                      .target = (int32_t)TARGET,
                                                      .generation = generation,
                                                      .time_ms = (int32_t)saw.time,
                                                      .value_q20 = mh_q20_from_real(mh_real_from_float(energy))}};
    return message;
}

static void tell_the(struct mh_message message) { hear(&message); }

/* The query that is open gets answers of two nodes. */
static void answer(void)
{
    const struct mh_message query = saw.last[MH_MESSAGE_LOCATE];
    tell_the(sound(&query, OTHER));
    tell_the(sound(&query, THIRD));
}

/* Until the next query, for at most so long. */
static void run_until_it_asks(mh_tick longest)
{
    const mh_tick end = saw.time + longest;
    const unsigned before = saw.of_kind[MH_MESSAGE_LOCATE];
    while (saw.of_kind[MH_MESSAGE_LOCATE] == before && mh_tick_before(saw.time, end)) {
        run_until(saw.time + 1);
    }
    TEST_ASSERT_EQUAL(before + 1, saw.of_kind[MH_MESSAGE_LOCATE]);
}

/* The target is heard, this node is prince, and has asked. */
static void ask_as_prince(void)
{
    tell_the(awake(5, HEAD, NODE));
    saw.energy = 2;
    run_until(saw.time + 250);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_LOCATE]);
    TEST_ASSERT_EQUAL(MH_PRINCE_LOCATE, state_of(TARGET));
}

static void become_head(void)
{
    ask_as_prince();
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET));
}

/* The oldest frame of which this has not been told is out, or is not. */
static void tell_fate(enum mh_sent outcome)
{
    prince->sent(&state, saw.time + AHEAD, outcome);
    settle();
}

static void hello_of(mh_node_id id, int32_t x_mm)
{
    const struct mh_message message = {.kind = MH_MESSAGE_HELLO,
                                       .as.hello = {.sender = (int32_t)id, .x_mm = x_mm, .y_mm = 5000}};
    hear(&message);
}

/* ---- who watches ---- */

static void hellos_go_at_the_start_and_then_rarely(void)
{
    TEST_ASSERT_EQUAL(3, saw.of_kind[MH_MESSAGE_HELLO]);
    run_until(NOW + config.hello_period);
    TEST_ASSERT_EQUAL(4, saw.of_kind[MH_MESSAGE_HELLO]);
}

static void who_is_far_from_the_path_sleeps(void)
{
    struct mh_message message = awake(5, HEAD, NEXT);
    message.as.awake.y_mm = 90000;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(TARGET));
    run_until(saw.time + 5000);
    TEST_ASSERT_EQUAL(0, saw.sensed);
    run_until(saw.time + 60000);
    TEST_ASSERT_EQUAL(MH_PRINCE_FREE, state_of(TARGET));
}

static void who_is_behind_the_head_sleeps(void)
{
    struct mh_message message = awake(5, HEAD, NEXT);
    message.as.awake.head_x_dm = 401;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(TARGET));
}

static void classes_follow_the_distance_from_the_path(void)
{
    static const struct {
        int32_t y_mm;
        uint8_t as;
    } cases[] = {{0, MH_NODE_INNER},      {31900, MH_NODE_INNER}, {32100, MH_NODE_BORDER},
                 {39900, MH_NODE_BORDER}, {40100, MH_NODE_OUTER}, {79900, MH_NODE_OUTER}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct mh_message message = awake((int16_t)(5 + i), HEAD, NEXT);
        message.as.awake.y_mm = cases[i].y_mm;
        hear(&message);
        TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
        TEST_ASSERT_EQUAL(cases[i].as, row_of(TARGET)->as);
    }
}

static void without_a_prince_or_a_velocity_all_compete(void)
{
    tell_the(awake(5, HEAD, MH_BROADCAST));
    TEST_ASSERT_EQUAL(MH_NODE_COMPETITOR, row_of(TARGET)->as);
    struct mh_message message = awake(6, HEAD, MH_BROADCAST);
    message.as.awake.vx_cmps = 0;
    message.as.awake.y_mm = 130000;
    message.as.awake.arms_cs = 300;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_NODE_COMPETITOR, row_of(TARGET)->as);
    saw.energy = 2;
    run_until(saw.time + 2990);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_COMPETE]);
    run_until(saw.time + 1000);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_COMPETE]);
}

static void a_watcher_stays_until_the_target_has_passed(void)
{
    tell_the(awake(5, HEAD, NEXT)); /* within range from 0 s to 8 s */
    run_until(saw.time + 10900);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    run_until(saw.time + 200);
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(TARGET));
    TEST_ASSERT_EQUAL(0, state.counters.lost);
}

/* ---- who asks ---- */

static void the_prince_asks_as_soon_as_it_hears_the_target(void)
{
    tell_the(awake(5, HEAD, NODE));
    saw.energy = 0.9f;
    run_until(saw.time + 3000);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_LOCATE]);
    saw.energy = 1.1f;
    run_until(saw.time + 250);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_LOCATE]);
    const mh_locate_t *query = &saw.last[MH_MESSAGE_LOCATE].as.locate;
    TEST_ASSERT_EQUAL_INT32(TARGET, query->target);
    TEST_ASSERT_EQUAL_INT16(6, query->generation);
    TEST_ASSERT_EQUAL(MH_LOCATE_PRINCE, query->kind);
}

/* The reading comes later than it was wanted. It is one of now, which is not asked for again: see sense(). */
static void a_late_reading_is_enough_to_ask_and_to_answer(void)
{
    const mh_tick began = saw.time;
    tell_the(awake(5, HEAD, NODE));
    saw.energy = 2;
    saw.delay = 3;
    run_until(began + 500);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_LOCATE]);
    TEST_ASSERT_EQUAL(0, saw.last[MH_MESSAGE_LOCATE].as.locate.time_ms % 250 - 3);

    come_up();
    tell_the(awake(5, HEAD, NEXT));
    saw.energy = 2;
    saw.delay = 3;
    while (saw.time % 250 != 3) {
        run_until(saw.timer);
    }
    const unsigned sensed = saw.sensed;
    tell_the(locate(6, OTHER, MH_LOCATE_PRINCE));
    TEST_ASSERT_EQUAL(sensed, saw.sensed);
    run_until(saw.time + config.window);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_SOUND]);
}

static void a_fix_makes_a_head_that_tells_the_old_one_and_all(void)
{
    become_head();
    TEST_ASSERT_EQUAL(3, saw.measurements);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_SUCCEED]);
    TEST_ASSERT_EQUAL_INT32(HEAD, saw.last[MH_MESSAGE_SUCCEED].as.succeed.head);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_AWAKE]);
    const mh_awake_t *said = &saw.last[MH_MESSAGE_AWAKE].as.awake;
    TEST_ASSERT_EQUAL_INT16(6, said->generation);
    TEST_ASSERT_EQUAL_INT16(1000, said->vx_cmps);
    TEST_ASSERT_EQUAL_INT16(400, said->head_x_dm);
    TEST_ASSERT_EQUAL(46, said->length);
    TEST_ASSERT_EQUAL(7, said->data[45]);
    TEST_ASSERT_EQUAL(0, said->data[46]);
    TEST_ASSERT_EQUAL(1, saw.told);
    TEST_ASSERT_EQUAL_UINT32(TARGET, saw.told_of.target);
    TEST_ASSERT_EQUAL(1, state.counters.located);
    TEST_ASSERT_EQUAL(1, state.counters.princes);
}

/* Until the locate_t is out, `late` ticks after the query: the hellos of the start are before it. */
static void ask_and_sample_again(mh_tick late, float energy)
{
    ask_as_prince();
    const unsigned sensed = saw.sensed;
    run_until(saw.time + late);
    saw.energy = energy;
    for (unsigned i = 0; i < saw.of_kind[MH_MESSAGE_HELLO]; i++) {
        tell_fate(i == 0 ? MH_SENT_BUSY : MH_SENT_OK); /* one that never went out had its turn, too */
        TEST_ASSERT_EQUAL(sensed, saw.sensed);
    }
    tell_fate(MH_SENT_OK);
    TEST_ASSERT_EQUAL(sensed + 1, saw.sensed);
    answer(); /* to the time of the query */
    tell_fate(MH_SENT_OK);
    TEST_ASSERT_EQUAL(sensed + 1, saw.sensed);
}

static void the_locator_samples_again_when_its_query_is_out(void)
{
    ask_and_sample_again(7, 3);
    const mh_tick asked = (mh_tick)saw.last[MH_MESSAGE_LOCATE].as.locate.time_ms;
    run_until(asked + 300);
    TEST_ASSERT_EQUAL(3, saw.measurements);
    TEST_ASSERT_EQUAL_INT32(MH_Q20(3.0f), saw.own_value);
    TEST_ASSERT_EQUAL_UINT32(asked + 7, saw.localised_at);
    TEST_ASSERT_EQUAL_UINT32(asked + 7, row_of(TARGET)->found);
    TEST_ASSERT_EQUAL_INT32(asked + 7, saw.last[MH_MESSAGE_AWAKE].as.awake.time_ms);
    TEST_ASSERT_EQUAL_UINT32(asked + 7, saw.told_of.time);
}

static void what_it_then_hears_no_more_counts_as_1(void)
{
    ask_and_sample_again(7, 0.4f);
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(3, saw.measurements);
    TEST_ASSERT_EQUAL_INT32(MH_Q20_ONE, saw.own_value);
}

static void where_nobody_says_that_it_is_out_the_first_sample_counts(void)
{
    ask_as_prince();
    const mh_tick asked = (mh_tick)saw.last[MH_MESSAGE_LOCATE].as.locate.time_ms;
    saw.energy = 3;
    answer();
    run_until(asked + 300);
    TEST_ASSERT_EQUAL_INT32(MH_Q20(2.0f), saw.own_value);
    TEST_ASSERT_EQUAL_UINT32(asked, saw.localised_at);
}

static void who_has_given_up_before_it_is_out_does_not_sample(void)
{
    ask_as_prince();
    tell_the(succeed(6, OTHER, HEAD));
    const unsigned sensed = saw.sensed;
    for (unsigned i = 0; i < 10; i++) {
        tell_fate(MH_SENT_OK); /* more than there were */
    }
    TEST_ASSERT_EQUAL(sensed, saw.sensed);
}

static void an_outer_node_raises_an_exception_at_a_higher_energy(void)
{
    struct mh_message message = awake(5, HEAD, NEXT);
    message.as.awake.y_mm = 45000;
    hear(&message);
    saw.energy = 1.5f;
    run_until(saw.time + 2000);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_LOCATE]);
    saw.energy = 1.6f;
    run_until_it_asks(450);
    TEST_ASSERT_EQUAL(MH_LOCATE_EXCEPTION, saw.last[MH_MESSAGE_LOCATE].as.locate.kind);
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(1, state.counters.exceptions);
}

static void a_regent_asks_when_the_prince_does_not(void)
{
    tell_the(awake(5, HEAD, NEXT)); /* due after 1 s: regents from 2 s to 2.5 s on, and 0.2 s */
    saw.energy = 2;
    run_until(saw.time + 1990);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_LOCATE]);
    run_until_it_asks(960);
    TEST_ASSERT_EQUAL(MH_LOCATE_REGENT, saw.last[MH_MESSAGE_LOCATE].as.locate.kind);
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(1, state.counters.regents);
}

static void without_that_guard_it_does_not(void)
{
    config.guards = MH_PRINCE_EXCEPTION;
    tell_the(awake(5, HEAD, NEXT));
    saw.energy = 2;
    run_until(saw.time + 10000);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_LOCATE]);
}

static void the_strongest_competitor_asks(void)
{
    tell_the(failed(5, HEAD));
    TEST_ASSERT_EQUAL(MH_NODE_COMPETITOR, row_of(TARGET)->as);
    saw.energy = 2;
    run_until(saw.time + 250);
    TEST_ASSERT_EQUAL(MH_PRINCE_ACT_CONTEND, row_of(TARGET)->act);
    tell_the(compete(6, OTHER, 1.9f));
    run_until(saw.time + 350);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_COMPETE]);
    run_until_it_asks(360);
    TEST_ASSERT_EQUAL(MH_LOCATE_COMPETITION, saw.last[MH_MESSAGE_LOCATE].as.locate.kind);
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(1, state.counters.competitions);
    TEST_ASSERT_EQUAL(1, saw.began); /* nobody has told of a track */
}

static void who_is_weaker_holds_back(void)
{
    tell_the(failed(5, HEAD));
    saw.energy = 2;
    run_until(saw.time + 250);
    tell_the(compete(6, OTHER, 2.1f));
    run_until(saw.time + 710);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_LOCATE]);
    TEST_ASSERT_EQUAL(MH_PRINCE_ACT_NONE, row_of(TARGET)->act);
    TEST_ASSERT_TRUE(mh_tick_before(saw.time, row_of(TARGET)->hold));
}

static void three_competitors_are_enough(void)
{
    tell_the(failed(5, HEAD));
    saw.energy = 2;
    run_until(saw.time + 250);
    for (mh_node_id id = OTHER; id < OTHER + 3; id++) {
        tell_the(compete(6, id, 1.5f));
    }
    run_until(saw.time + 250);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_COMPETE]);
}

/* ---- queries ---- */

static void who_hears_the_target_answers_the_nearer_the_sooner(void)
{
    static const struct {
        float energy;
        mh_tick slot;
    } cases[] = {{1.01f, 252}, {4.01f, 63}, {1600, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        tell_the(awake((int16_t)(2 * i), HEAD, NEXT));
        saw.energy = cases[i].energy;
        tell_the(locate((int16_t)(2 * i + 1), OTHER, MH_LOCATE_EXCEPTION));
        run_until(saw.time + cases[i].slot - (cases[i].slot > 0));
        TEST_ASSERT_EQUAL(i, saw.of_kind[MH_MESSAGE_SOUND]);
        run_until(saw.time + 9);
        TEST_ASSERT_EQUAL(i + 1, saw.of_kind[MH_MESSAGE_SOUND]);
        TEST_ASSERT_EQUAL_INT32(OTHER, saw.last[MH_MESSAGE_SOUND].as.sound.asker);
        TEST_ASSERT_EQUAL(255, saw.last[MH_MESSAGE_SOUND].as.sound.share);
    }
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, mh_q20_from_real(mh_real_from_float(1e9f))); /* saturated is nearest */
}

/* In slots of 37 ticks, by where the neighbours and the target are expected to be, not by what is heard. */
static void where_the_target_is_expected_the_nearest_answer_in_turn(void)
{
    hello_of(OTHER, 20000); /* asks */
    hello_of(THIRD, 30000);
    hello_of(NEXT, 70000);
    tell_the(awake(5, HEAD, NEXT));
    saw.energy = 2;
    run_until(saw.time + 1000); /* at 10, 0 */
    tell_the(locate(6, OTHER, MH_LOCATE_PRINCE));
    run_until(saw.time + 36);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_SOUND]);
    run_until(saw.time + 1);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_SOUND]);
}

static void who_does_not_hear_it_is_silent(void)
{
    static const float energies[] = {0.99f, 0, -3};
    for (size_t i = 0; i < 3; i++) {
        tell_the(awake((int16_t)(2 * i), HEAD, NEXT));
        saw.energy = energies[i];
        tell_the(locate((int16_t)(2 * i + 1), OTHER, MH_LOCATE_PRINCE));
        run_until(saw.time + 400);
    }
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_SOUND]);
}

static void answers_that_are_enough_keep_others_silent(void)
{
    tell_the(awake(5, HEAD, NEXT));
    saw.energy = 1.1f;
    const struct mh_message query = locate(6, OTHER, MH_LOCATE_PRINCE);
    hear(&query);
    tell_the(sound(&query, THIRD));
    tell_the(sound(&query, NEXT));
    run_until(saw.time + 400);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_SOUND]);
}

static void a_query_keeps_others_from_asking(void)
{
    tell_the(awake(5, HEAD, NEXT));
    saw.energy = 2;
    run_until(saw.time + 1900);
    tell_the(locate(6, OTHER, MH_LOCATE_PRINCE));
    run_until(saw.time + 490);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_LOCATE]);
}

/* Answers about a group take twice as long. */
static void a_query_about_a_group_keeps_them_twice_as_long(void)
{
    struct mh_message message = awake(5, HEAD, MH_BROADCAST);
    message.as.awake.members = 2;
    hear(&message);
    tell_the(locate(6, OTHER, MH_LOCATE_COMPETITION));
    saw.energy = 2;
    run_until(saw.time + 2 * config.window + 199);
    TEST_ASSERT_EQUAL(MH_PRINCE_ACT_NONE, row_of(TARGET)->act);
    run_until(saw.time + 250);
    TEST_ASSERT_EQUAL(MH_PRINCE_ACT_CONTEND, row_of(TARGET)->act);
}

static void an_exception_takes_the_princes_right(void)
{
    tell_the(awake(5, HEAD, NODE));
    tell_the(locate(6, OTHER, MH_LOCATE_EXCEPTION));
    TEST_ASSERT_FALSE(row_of(TARGET)->is_prince);
}

static void without_answers_the_prince_tries_again_then_says_that_it_failed(void)
{
    ask_as_prince();
    tell_the(sound(&saw.last[MH_MESSAGE_LOCATE], OTHER));
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    run_until(saw.time + 500);
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_LOCATE]);
    TEST_ASSERT_EQUAL(MH_PRINCE_LOCATE, state_of(TARGET));
    TEST_ASSERT_EQUAL(1, state.counters.retries);
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_FAIL]);
    TEST_ASSERT_EQUAL_INT16(5, saw.last[MH_MESSAGE_FAIL].as.fail.generation);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    TEST_ASSERT_EQUAL(MH_NODE_COMPETITOR, row_of(TARGET)->as);
    TEST_ASSERT_EQUAL(0, saw.localised);
}

static void who_hears_the_target_no_more_does_not_try_again(void)
{
    ask_as_prince();
    run_until(saw.time + 300);
    saw.energy = 0.5f;
    run_until(saw.time + 500);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_LOCATE]);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_FAIL]);
}

static void without_retry_it_fails_at_once(void)
{
    config.guards = MH_PRINCE_EXCEPTION;
    ask_as_prince();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_FAIL]);
}

static void where_the_tracker_finds_nothing_it_fails_likewise(void)
{
    saw.status = MH_NONE;
    ask_as_prince();
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    TEST_ASSERT_EQUAL(1, saw.localised);
    TEST_ASSERT_EQUAL(0, saw.told);
}

static void what_is_no_track_is_begun_anew(void)
{
    saw.status = MH_ERR_CORRUPT;
    ask_as_prince();
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(2, saw.localised);
    TEST_ASSERT_EQUAL(1, saw.began);
}

static void a_winner_without_answers_keeps_others_awake_but_not_all_the_time(void)
{
    tell_the(failed(5, HEAD));
    saw.energy = 2;
    run_until(saw.time + 8000);
    TEST_ASSERT_TRUE(saw.of_kind[MH_MESSAGE_LOCATE] >= 3);
    TEST_ASSERT_TRUE(saw.of_kind[MH_MESSAGE_FAIL] >= 2 && saw.of_kind[MH_MESSAGE_FAIL] <= 3);
    TEST_ASSERT_EQUAL(saw.of_kind[MH_MESSAGE_FAIL], state.counters.relays);
}

static void of_two_who_ask_the_later_yields(void)
{
    ask_as_prince();
    struct mh_message query = locate(6, OTHER, MH_LOCATE_REGENT);
    query.as.locate.time_ms += 1;
    hear(&query);
    TEST_ASSERT_EQUAL(MH_PRINCE_LOCATE, state_of(TARGET));
    query.as.locate.time_ms -= 2;
    hear(&query);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    run_until(saw.time + 400);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_SOUND]); /* answers instead */
    TEST_ASSERT_EQUAL(0, saw.localised);
}

static void of_two_who_ask_at_once_the_higher_identifier_yields(void)
{
    ask_as_prince();
    tell_the(locate(6, NODE + 1, MH_LOCATE_REGENT));
    TEST_ASSERT_EQUAL(MH_PRINCE_LOCATE, state_of(TARGET));
    tell_the(locate(6, NODE - 1, MH_LOCATE_REGENT));
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
}

static void a_locator_gives_up_when_somebody_has_succeeded(void)
{
    ask_as_prince();
    tell_the(succeed(6, OTHER, HEAD));
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    TEST_ASSERT_TRUE(row_of(TARGET)->is_passive);
    run_until(saw.time + 1000);
    TEST_ASSERT_EQUAL(0, saw.localised);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_LOCATE]);
    tell_the(awake(6, OTHER, NEXT));
    TEST_ASSERT_FALSE(row_of(TARGET)->is_passive);
}

static void a_locator_gives_up_when_a_new_head_speaks(void)
{
    ask_as_prince();
    tell_the(awake(6, OTHER, NEXT));
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    run_until(saw.time + 400);
    TEST_ASSERT_EQUAL(0, saw.localised);
}

/* ---- heads ---- */

static void a_head_leaves_when_its_successor_says_so(void)
{
    become_head();
    saw.energy = 0;
    tell_the(succeed(7, OTHER, NODE));
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    TEST_ASSERT_TRUE(row_of(TARGET)->is_passive);
    run_until(saw.time + 3000);
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(TARGET));
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_FAIL]);
}

static void a_head_leaves_when_a_newer_one_speaks(void)
{
    become_head();
    struct mh_message message = awake(7, OTHER, NEXT);
    message.as.awake.y_mm = 200000;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(TARGET));
    TEST_ASSERT_EQUAL(0, state.counters.double_heads);
}

static void of_two_heads_of_a_generation_the_later_yields(void)
{
    become_head();
    struct mh_message message = awake(6, OTHER, NEXT);
    message.as.awake.time_ms = (int32_t)(row_of(TARGET)->found + 1);
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET));
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_AWAKE]); /* the other is to know */
    message.as.awake.time_ms -= 2;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    TEST_ASSERT_EQUAL(1, state.counters.double_heads);
}

static void of_two_heads_at_once_the_higher_identifier_yields(void)
{
    become_head();
    struct mh_message message = awake(6, NODE + 1, NEXT);
    message.as.awake.time_ms = (int32_t)row_of(TARGET)->found;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET));
    message.as.awake.sender = NODE - 1;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
}

static void who_is_behind_is_told_again_but_not_all_the_time(void)
{
    become_head();
    saw.time += 1000;
    tell_the(locate(6, OTHER, MH_LOCATE_REGENT));
    tell_the(failed(5, OTHER));
    tell_the(compete(6, OTHER, 2));
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_AWAKE]);
    saw.time += 500;
    tell_the(failed(5, OTHER));
    TEST_ASSERT_EQUAL(3, saw.of_kind[MH_MESSAGE_AWAKE]);
    TEST_ASSERT_EQUAL(2, state.counters.repeated);
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET));
}

static void a_fail_of_its_generation_makes_a_head_a_competitor(void)
{
    become_head();
    tell_the(failed(6, OTHER));
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    TEST_ASSERT_EQUAL(MH_NODE_COMPETITOR, row_of(TARGET)->as);
}

/* No neighbour is known, so nobody is prince: (140 - 40) m at 6 m/s. */
static void a_head_that_nobody_relieves_says_so(void)
{
    become_head();
    const mh_tick found = row_of(TARGET)->found;
    run_until(found + 16600);
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET));
    run_until(found + 16700);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_FAIL]);
    TEST_ASSERT_EQUAL(1, state.counters.watchdogs);
}

/* Found at 0, 0 with 10 m/s: who stands at x is reached after x - 39.7 m. */
static void the_prince_is_whom_the_target_reaches_after_the_step(void)
{
    hello_of(OTHER, 80000);
    hello_of(THIRD, 101000);
    hello_of(NEXT, 130000);
    become_head();
    TEST_ASSERT_EQUAL_INT32(THIRD, saw.last[MH_MESSAGE_AWAKE].as.awake.prince);
    TEST_ASSERT_INT16_WITHIN(3, 613, saw.last[MH_MESSAGE_AWAKE].as.awake.enters_cs);
    const mh_tick found = row_of(TARGET)->found;
    run_until(found + 8600);
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET));
    run_until(found + 8700);
    TEST_ASSERT_EQUAL(1, state.counters.watchdogs); /* 2.5 s after that */
}

static void or_the_farthest(void)
{
    config.farthest = true;
    hello_of(THIRD, 101000);
    hello_of(NEXT, 130000);
    become_head();
    TEST_ASSERT_EQUAL_INT32(NEXT, saw.last[MH_MESSAGE_AWAKE].as.awake.prince);
}

/* Radio of 1 km: the target would not leave it for 160 s, but then nobody would believe the fail_t. */
static void a_watchdog_does_not_wait_until_nobody_believes_it(void)
{
    config.radio_range_m = MH_REAL(1000.0f);
    saw.estimate.velocity.x = 0;
    become_head();
    saw.energy = 0;
    run_until(row_of(TARGET)->found + 24990);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_FAIL]);
    run_until(saw.time + 10);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_FAIL]);
}

static void the_largest_of_the_last_speeds_hastens_the_watchdog(void)
{
    struct mh_message message = awake(5, HEAD, NODE);
    message.as.awake.speeds[2] = 80; /* 20 m/s */
    hear(&message);
    saw.energy = 2;
    run_until(saw.time + 250);
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(80 / 4, row_of(TARGET)->speeds[2] / 4 + 20); /* it was the oldest */
    message = awake(7, HEAD, NODE);
    message.as.awake.speeds[1] = 80;
    hear(&message);
    run_until(saw.time + 250);
    answer();
    run_until(saw.time + 300);
    const mh_tick found = row_of(TARGET)->found;
    run_until(found + 4160);
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET));
    run_until(found + 4170); /* 100 m at 1.2 x 20 m/s */
    TEST_ASSERT_EQUAL(1, state.counters.watchdogs);
}

static void without_watchdog_a_head_gives_up_in_the_end(void)
{
    config.guards = MH_PRINCE_EXCEPTION;
    become_head();
    run_until(saw.time + 16000);
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(TARGET));
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_FAIL]);
    TEST_ASSERT_EQUAL(1, state.counters.lost);
}

static void a_long_track_comes_in_two_parts(void)
{
    saw.length = 80;
    become_head();
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_REST]);
    TEST_ASSERT_EQUAL(28, saw.last[MH_MESSAGE_REST].as.rest.length);
    TEST_ASSERT_EQUAL(7, saw.last[MH_MESSAGE_REST].as.rest.data[27]);
    struct mh_message message = awake(7, HEAD, NODE);
    message.as.awake.length = 80;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_AWAKE_BYTES, row_of(TARGET)->gathered);
    message = saw.last[MH_MESSAGE_REST];
    message.as.rest.sender = HEAD;
    hear(&message); /* of another generation */
    TEST_ASSERT_EQUAL(MH_AWAKE_BYTES, row_of(TARGET)->gathered);
    message.as.rest.generation = 7;
    hear(&message);
    TEST_ASSERT_EQUAL(80, row_of(TARGET)->gathered);
    TEST_ASSERT_EQUAL(7, row_of(TARGET)->bytes[79]);
}

/* ---- new targets ---- */

static void who_is_at_an_entry_watches_for_30_s(void)
{
    static const struct mh_prince_entry entries[] = {{{0, 0, 0}, NOW + 1000}, {{500000, 0, 0}, NOW}};
    config.entries = entries;
    config.entry_count = 2;
    come_up();
    run_until(NOW + 999);
    TEST_ASSERT_EQUAL(0, saw.sensed);
    run_until(NOW + 40000);
    TEST_ASSERT_EQUAL(121, saw.sensed); /* both ends */
}

static void who_hears_a_new_target_names_it(void)
{
    static const struct mh_prince_entry entry = {{0, 0, 0}, NOW};
    config.entries = &entry;
    config.entry_count = 1;
    come_up();
    saw.energy = 2;
    run_until_it_asks(1000);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_COMPETE]);
    TEST_ASSERT_EQUAL_INT32(0, saw.last[MH_MESSAGE_COMPETE].as.compete.target);
    const uint32_t target = (uint32_t)saw.last[MH_MESSAGE_LOCATE].as.locate.target;
    TEST_ASSERT_EQUAL_UINT32(NODE, target / 16);
    TEST_ASSERT_NOT_EQUAL(0, target % 16);
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(target));
    TEST_ASSERT_EQUAL(1, saw.began);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_SUCCEED]); /* there is no old head */
    TEST_ASSERT_EQUAL(1, state.counters.founded);
}

static void a_competitor_takes_the_name_that_another_has_given(void)
{
    static const struct mh_prince_entry entry = {{0, 0, 0}, NOW};
    config.entries = &entry;
    config.entry_count = 1;
    come_up();
    saw.energy = 2;
    run_until(saw.time + 250);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(0));
    tell_the(locate(1, OTHER, MH_LOCATE_COMPETITION));
    TEST_ASSERT_EQUAL(MH_PRINCE_FREE, state_of(0));
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    run_until(saw.time + 400);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_SOUND]);
    tell_the(awake(1, OTHER, NEXT));
    TEST_ASSERT_EQUAL(MH_NODE_INNER, row_of(TARGET)->as);
}

static void idle_nodes_look_for_targets_once_in_a_while(void)
{
    config.watch_period = 10000;
    come_up();
    run_until(NOW + 100000);
    TEST_ASSERT_EQUAL(12, saw.sensed);
    saw.energy = 2;
    run_until(saw.time + 10000 + 600);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_COMPETE]);
}

/* A target comes by at 10 m/s, so far off; it may be 25 m nearer. */
static uint8_t state_of_what_is_heard_besides(int32_t y_mm)
{
    come_up();
    struct mh_message message = awake(5, HEAD, NEXT);
    message.as.awake.y_mm = y_mm;
    hear(&message);
    saw.energy = 1.01f;
    run_until(saw.time + 500);
    return state_of(0);
}

static void what_is_explained_is_not_new(void)
{
    config.watch_period = 250;
    TEST_ASSERT_EQUAL(MH_PRINCE_FREE, state_of_what_is_heard_besides(60000));
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of_what_is_heard_besides(100000));
}

static void a_target_that_nobody_finds_again_is_forgotten(void)
{
    become_head();
    saw.energy = 0;
    run_until(saw.time + 28000);
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(TARGET));
    TEST_ASSERT_EQUAL(1, state.counters.lost);
    run_until(saw.time + 40000);
    TEST_ASSERT_EQUAL(MH_PRINCE_FREE, state_of(TARGET));
}

/* ---- the table ---- */

static void who_sleeps_wakes_when_the_target_turns_or_fails(void)
{
    struct mh_message message = awake(5, HEAD, NEXT);
    message.as.awake.y_mm = 90000;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(TARGET));
    tell_the(locate(6, OTHER, MH_LOCATE_PRINCE)); /* not for who sleeps */
    TEST_ASSERT_EQUAL(0, saw.sensed);
    tell_the(awake(6, OTHER, NEXT));
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
    message.as.awake.generation = 7;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(TARGET));
    tell_the(failed(7, OTHER));
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(TARGET));
}

#if MH_TARGETS_MAX == 4
/* Asleep: nearest to this node after so many seconds. */
static void hear_of(uint32_t target, int32_t seconds)
{
    struct mh_message message = awake(5, HEAD, NEXT);
    message.as.awake.target = (int32_t)target;
    message.as.awake.x_mm = 40000 - seconds * 10000;
    message.as.awake.y_mm = 90000;
    hear(&message);
}

static void whose_target_is_out_of_range_first_gives_way(void)
{
    tell_the(awake(5, HEAD, NEXT)); /* watched until 8 s */
    hear_of(2, 9);
    hear_of(3, 7);
    hear_of(4, 8);
    hear_of(5, 10);
    TEST_ASSERT_EQUAL(MH_PRINCE_FREE, state_of(3));
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(5));
    TEST_ASSERT_EQUAL(1, state.counters.evicted);
    struct mh_message message = awake(5, HEAD, NEXT);
    for (uint32_t target = 6; target < 12; target++) {
        message.as.awake.target = (int32_t)target;
        message.as.awake.x_mm += 1000;
        hear(&message);
    }
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(11));
    TEST_ASSERT_EQUAL(7, state.counters.evicted);
}

static void heads_never_give_way(void)
{
    become_head();
    for (uint32_t target = 2; target < 9; target++) {
        hear_of(target, (int32_t)target);
    }
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET));
    TEST_ASSERT_EQUAL(MH_PRINCE_SLEEP, state_of(8));
    TEST_ASSERT_EQUAL(4, state.counters.evicted);
}

/* This node is prince of one target, but another one is nearer. */
static void what_is_anothers_share_moves_nobody(void)
{
    struct mh_message message = awake(5, HEAD, NEXT);
    message.as.awake.target = 2;
    message.as.awake.y_mm = 20000;
    message.as.awake.x_mm = 40000;
    message.as.awake.vx_cmps = 100;
    hear(&message);
    message = awake(5, HEAD, NODE);
    message.as.awake.y_mm = -20000; /* 45 m off; the other 20 m: a sixth of the energy is its */
    hear(&message);
    saw.energy = 5;
    run_until(saw.time + 500);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_LOCATE]);
    saw.energy = 8;
    run_until(saw.time + 500);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_LOCATE]);
    TEST_ASSERT_EQUAL_INT32(TARGET, saw.last[MH_MESSAGE_LOCATE].as.locate.target);
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(1, saw.others); /* the tracker is told of it */
}
#endif

/* ---- all else ---- */

static void before_the_time_is_known_nothing_is_done(void)
{
    saw.knows_time = false;
    prince->time_jumped(&state, NOW + AHEAD);
    saw.sent = 0;
    tell_the(awake(5, HEAD, NODE));
    prince->timer(&state, NOW + AHEAD + 10000);
    TEST_ASSERT_EQUAL(MH_PRINCE_FREE, state_of(TARGET));
    TEST_ASSERT_EQUAL(0, saw.sent);
}

static void what_is_of_no_time_about_now_is_refused(void)
{
    struct mh_message message = awake(5, HEAD, NODE);
    message.as.awake.time_ms -= 31000;
    hear(&message);
    message.as.awake.time_ms += 33000;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_FREE, state_of(TARGET));
    TEST_ASSERT_EQUAL(2, state.counters.refused);
}

/* Only who contends for a new target speaks of one without a name. */
static void what_needs_a_name_and_has_none_is_refused(void)
{
    struct mh_message message = locate(3, OTHER, MH_LOCATE_PRINCE);
    message.as.locate.target = 0;
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_FREE, state_of(0));

    static const struct mh_prince_entry entry = {{0, 0, 0}, NOW};
    config.entries = &entry;
    config.entry_count = 1;
    come_up();
    saw.energy = 2;
    run_until(saw.time + 250);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(0));
    message = succeed(1, OTHER, HEAD);
    message.as.succeed.target = 0;
    hear(&message);
    TEST_ASSERT_FALSE(row_of(0)->is_passive);
    message.kind = MH_MESSAGE_MERGE;
    message.as.merge = (mh_merge_t){.sender = (int32_t)OTHER, .target = (int32_t)TARGET};
    hear(&message);
    TEST_ASSERT_EQUAL(MH_PRINCE_WATCH, state_of(0));
}

static void radios_without_watching_rows_sleep_but_in_windows(void)
{
    config.wake_period = 250;
    config.wake_length = 10;
    come_up();
    TEST_ASSERT_FALSE(saw.listens);
    tell_the(awake(5, HEAD, NODE));
    TEST_ASSERT_TRUE(saw.listens);
    saw.energy = 2;
    run_until(saw.time + 250);
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_AWAKE]);
    run_until(saw.time + 250);
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_AWAKE]);
    saw.energy = 0;
    tell_the(succeed(7, OTHER, NODE));
    run_until(saw.time + 3000);
    TEST_ASSERT_FALSE(saw.listens);
}

static void configurations_are_checked(void)
{
    struct mh_prince_config bad = config;
    TEST_ASSERT_EQUAL(MH_OK, prince->init(&state, &bad, &node));
    bad.port = NULL;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, prince->init(&state, &bad, &node));
    bad = config;
    bad.replies = 1;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, prince->init(&state, &bad, &node));
    bad = config;
    bad.radio_range_m = MH_REAL(40.0f);
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, prince->init(&state, &bad, &node));
    bad = config;
    bad.watch_period = 249;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, prince->init(&state, &bad, &node));
    bad = config;
    bad.entry_count = 1;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, prince->init(&state, &bad, &node));
}

/* ---- groups ---- */

/* Another target, TARGET + by, that HEAD leads. */
static void know_another(uint32_t by)
{
    struct mh_message another = awake(9, HEAD, OTHER);
    another.as.awake.target = (int32_t)(TARGET + by);
    another.as.awake.x_mm = 10000;
    hear(&another);
    TEST_ASSERT_NOT_NULL(row_of(TARGET + by));
}

static void a_head_takes_in_another_target(void)
{
    saw.estimate.flags = MH_ESTIMATE_MERGE;
    saw.estimate.near = TARGET + 4;
    ask_as_prince();
    know_another(4);
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL(1, saw.joined);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_MERGE]);
    TEST_ASSERT_EQUAL_INT32(TARGET, saw.last[MH_MESSAGE_MERGE].as.merge.target);
    TEST_ASSERT_EQUAL_INT32(TARGET + 4, saw.last[MH_MESSAGE_MERGE].as.merge.other);
    TEST_ASSERT_EQUAL(0, saw.last[MH_MESSAGE_MERGE].as.merge.answers);
    TEST_ASSERT_NULL(row_of(TARGET + 4));
    TEST_ASSERT_EQUAL_INT32(TARGET, saw.last[MH_MESSAGE_AWAKE].as.awake.target);
    TEST_ASSERT_EQUAL(10, saw.last[MH_MESSAGE_AWAKE].as.awake.generation); /* newer than both, which were 5 and 9 */
    TEST_ASSERT_EQUAL(2, saw.last[MH_MESSAGE_AWAKE].as.awake.members);
    TEST_ASSERT_EQUAL(80, saw.last[MH_MESSAGE_AWAKE].as.awake.length);
    TEST_ASSERT_EQUAL(1, saw.told);
    TEST_ASSERT_EQUAL(2, saw.told_of.members);
    TEST_ASSERT_EQUAL(1, state.counters.merged);
    TEST_ASSERT_EQUAL(1, state.counters.located);
}

/* The group has the lower identifier, and its own is the one that is no more. */
static void a_head_goes_on_under_the_lower_identifier(void)
{
    saw.estimate.flags = MH_ESTIMATE_MERGE;
    saw.estimate.near = TARGET - 4;
    ask_as_prince();
    know_another((uint32_t)-4);
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_NULL(row_of(TARGET));
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET - 4));
    TEST_ASSERT_EQUAL_INT32(TARGET, saw.last[MH_MESSAGE_SUCCEED].as.succeed.target); /* to the old head */
    TEST_ASSERT_EQUAL_INT32(TARGET, saw.last[MH_MESSAGE_MERGE].as.merge.other);
    TEST_ASSERT_EQUAL_INT32(TARGET - 4, saw.last[MH_MESSAGE_AWAKE].as.awake.target);
    TEST_ASSERT_EQUAL(10, saw.last[MH_MESSAGE_AWAKE].as.awake.generation);
}

/* It is in the group already: its head has not heard so. */
static void who_has_not_heard_of_the_merge_is_told_again(void)
{
    saw.estimate.flags = MH_ESTIMATE_MERGE;
    saw.estimate.near = TARGET + 4;
    saw.join_status = MH_ERR_CORRUPT;
    ask_as_prince();
    know_another(4);
    answer();
    run_until(saw.time + 300);
    TEST_ASSERT_EQUAL_INT32(TARGET + 4, saw.last[MH_MESSAGE_MERGE].as.merge.other);
    TEST_ASSERT_NULL(row_of(TARGET + 4));
    TEST_ASSERT_EQUAL(0, state.counters.merged);
    TEST_ASSERT_EQUAL(6, saw.last[MH_MESSAGE_AWAKE].as.awake.generation);
}

/* A tracker that says so of a target unknown, or that cannot join them. */
static void a_merge_that_cannot_be(void)
{
    saw.estimate.flags = MH_ESTIMATE_MERGE;
    saw.estimate.near = TARGET + 4;
    become_head();
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_MERGE]);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_AWAKE]);
}

static struct mh_message merge(uint32_t target, uint32_t other, uint8_t answers)
{
    const struct mh_message message = {.kind = MH_MESSAGE_MERGE,
                                       .as.merge = {.sender = (int32_t)OTHER,
                                                    .target = (int32_t)target,
                                                    .other = (int32_t)other,
                                                    .generation = 4,
                                                    .answers = answers}};
    return message;
}

static void the_head_of_a_target_that_is_taken_in_says_so(void)
{
    become_head();
    tell_the(merge(TARGET - 2, TARGET, 0));
    TEST_ASSERT_NULL(row_of(TARGET));
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_MERGE]);
    TEST_ASSERT_EQUAL(1, saw.last[MH_MESSAGE_MERGE].as.merge.answers);
    TEST_ASSERT_EQUAL_INT32(TARGET - 2, saw.last[MH_MESSAGE_MERGE].as.merge.target);
    TEST_ASSERT_EQUAL_INT32(TARGET, saw.last[MH_MESSAGE_MERGE].as.merge.other);
}

static void others_forget_a_target_that_is_taken_in(void)
{
    tell_the(awake(5, HEAD, OTHER));
    tell_the(merge(TARGET, TARGET, 0)); /* absurd */
    TEST_ASSERT_NOT_NULL(row_of(TARGET));
    tell_the(merge(TARGET - 2, TARGET, 1));
    TEST_ASSERT_NULL(row_of(TARGET));
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_MERGE]);
}

/* Two parts: the row goes on with the one that has its identifier, the other has a row of its own; both get a prince. */
static void a_group_falls_apart(void)
{
    saw.estimate.flags = MH_ESTIMATE_SPLIT;
    become_head();
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET));
    TEST_ASSERT_EQUAL(MH_PRINCE_HEAD, state_of(TARGET + 1));
    TEST_ASSERT_EQUAL(0, row_of(TARGET)->bytes[0]);
    TEST_ASSERT_EQUAL(1, row_of(TARGET + 1)->bytes[0]);
    TEST_ASSERT_EQUAL(40, row_of(TARGET + 1)->length);
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_AWAKE]);
    TEST_ASSERT_EQUAL_INT32(TARGET + 1, saw.last[MH_MESSAGE_AWAKE].as.awake.target);
    TEST_ASSERT_EQUAL(6, saw.last[MH_MESSAGE_AWAKE].as.awake.generation);
    TEST_ASSERT_EQUAL(0, saw.last[MH_MESSAGE_AWAKE].as.awake.speeds[0]);
    TEST_ASSERT_EQUAL(2, saw.told);
    TEST_ASSERT_EQUAL_UINT32(TARGET + 1, saw.expected_of);
    TEST_ASSERT_EQUAL(0, saw.told_of.flags & MH_ESTIMATE_SPLIT);
    TEST_ASSERT_EQUAL(1, state.counters.split);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(hellos_go_at_the_start_and_then_rarely);
    RUN_TEST(who_is_far_from_the_path_sleeps);
    RUN_TEST(who_is_behind_the_head_sleeps);
    RUN_TEST(classes_follow_the_distance_from_the_path);
    RUN_TEST(without_a_prince_or_a_velocity_all_compete);
    RUN_TEST(a_watcher_stays_until_the_target_has_passed);
    RUN_TEST(the_prince_asks_as_soon_as_it_hears_the_target);
    RUN_TEST(a_late_reading_is_enough_to_ask_and_to_answer);
    RUN_TEST(a_fix_makes_a_head_that_tells_the_old_one_and_all);
    RUN_TEST(the_locator_samples_again_when_its_query_is_out);
    RUN_TEST(what_it_then_hears_no_more_counts_as_1);
    RUN_TEST(where_nobody_says_that_it_is_out_the_first_sample_counts);
    RUN_TEST(who_has_given_up_before_it_is_out_does_not_sample);
    RUN_TEST(an_outer_node_raises_an_exception_at_a_higher_energy);
    RUN_TEST(a_regent_asks_when_the_prince_does_not);
    RUN_TEST(without_that_guard_it_does_not);
    RUN_TEST(the_strongest_competitor_asks);
    RUN_TEST(who_is_weaker_holds_back);
    RUN_TEST(three_competitors_are_enough);
    RUN_TEST(who_hears_the_target_answers_the_nearer_the_sooner);
    RUN_TEST(where_the_target_is_expected_the_nearest_answer_in_turn);
    RUN_TEST(who_does_not_hear_it_is_silent);
    RUN_TEST(answers_that_are_enough_keep_others_silent);
    RUN_TEST(a_query_keeps_others_from_asking);
    RUN_TEST(a_query_about_a_group_keeps_them_twice_as_long);
    RUN_TEST(an_exception_takes_the_princes_right);
    RUN_TEST(without_answers_the_prince_tries_again_then_says_that_it_failed);
    RUN_TEST(who_hears_the_target_no_more_does_not_try_again);
    RUN_TEST(without_retry_it_fails_at_once);
    RUN_TEST(where_the_tracker_finds_nothing_it_fails_likewise);
    RUN_TEST(what_is_no_track_is_begun_anew);
    RUN_TEST(a_winner_without_answers_keeps_others_awake_but_not_all_the_time);
    RUN_TEST(of_two_who_ask_the_later_yields);
    RUN_TEST(of_two_who_ask_at_once_the_higher_identifier_yields);
    RUN_TEST(a_locator_gives_up_when_somebody_has_succeeded);
    RUN_TEST(a_locator_gives_up_when_a_new_head_speaks);
    RUN_TEST(a_head_leaves_when_its_successor_says_so);
    RUN_TEST(a_head_leaves_when_a_newer_one_speaks);
    RUN_TEST(of_two_heads_of_a_generation_the_later_yields);
    RUN_TEST(of_two_heads_at_once_the_higher_identifier_yields);
    RUN_TEST(who_is_behind_is_told_again_but_not_all_the_time);
    RUN_TEST(a_fail_of_its_generation_makes_a_head_a_competitor);
    RUN_TEST(a_head_that_nobody_relieves_says_so);
    RUN_TEST(the_prince_is_whom_the_target_reaches_after_the_step);
    RUN_TEST(or_the_farthest);
    RUN_TEST(a_watchdog_does_not_wait_until_nobody_believes_it);
    RUN_TEST(the_largest_of_the_last_speeds_hastens_the_watchdog);
    RUN_TEST(without_watchdog_a_head_gives_up_in_the_end);
    RUN_TEST(a_long_track_comes_in_two_parts);
    RUN_TEST(who_is_at_an_entry_watches_for_30_s);
    RUN_TEST(who_hears_a_new_target_names_it);
    RUN_TEST(a_competitor_takes_the_name_that_another_has_given);
    RUN_TEST(idle_nodes_look_for_targets_once_in_a_while);
    RUN_TEST(what_is_explained_is_not_new);
    RUN_TEST(a_target_that_nobody_finds_again_is_forgotten);
    RUN_TEST(who_sleeps_wakes_when_the_target_turns_or_fails);
#if MH_TARGETS_MAX == 4
    RUN_TEST(whose_target_is_out_of_range_first_gives_way);
    RUN_TEST(heads_never_give_way);
    RUN_TEST(what_is_anothers_share_moves_nobody);
#endif
    RUN_TEST(before_the_time_is_known_nothing_is_done);
    RUN_TEST(what_is_of_no_time_about_now_is_refused);
    RUN_TEST(what_needs_a_name_and_has_none_is_refused);
    RUN_TEST(radios_without_watching_rows_sleep_but_in_windows);
    RUN_TEST(configurations_are_checked);
    RUN_TEST(a_head_takes_in_another_target);
    RUN_TEST(a_head_goes_on_under_the_lower_identifier);
    RUN_TEST(who_has_not_heard_of_the_merge_is_told_again);
    RUN_TEST(a_merge_that_cannot_be);
    RUN_TEST(the_head_of_a_target_that_is_taken_in_says_so);
    RUN_TEST(others_forget_a_target_that_is_taken_in);
    RUN_TEST(a_group_falls_apart);
    port_exit(UNITY_END() > 0);
    return 0;
}
