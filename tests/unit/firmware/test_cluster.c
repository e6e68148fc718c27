/* One mote's side of `cluster`, event by event. Whole networks: tests/network. Radios open for 10 in 250 ticks; an instant each 2,000. */
#include "motehound/cluster.h"
#include "motehound/geographic.h"
#include "port.h"
#include "unity.h"

#include <string.h>

enum { NODE = 10, HEAD = 20, NEXT = 30, OTHER = 40, SINK = 1, AHEAD = 777 /* of the mote's own clock */ };

#define T 2000u
#define LATER (4u * T) /* all hellos are said, no instant is left out */

static struct {
    unsigned sent, of_kind[MH_MESSAGE_KINDS];
    mh_node_id destination;
    struct mh_message message; /* the last one sent */
    mh_tick timer;
    unsigned sensed, leads, follows, restarts, told, delivered;
    mh_tick sensed_for;
    size_t track;
    bool listens, knows_time;
    struct mh_estimate estimate; /* told; and expected */
    enum mh_status lead_status;
} saw;

static void send(void *context, mh_node_id destination, const struct mh_message *message)
{
    (void)context;
    saw.sent++;
    saw.of_kind[message->kind]++;
    saw.destination = destination;
    saw.message = *message;
}

static void set_timer(void *context, mh_tick time)
{
    (void)context;
    saw.timer = time - AHEAD;
}

static void deliver(void *context, mh_tick now, const struct mh_measurement *measurement)
{
    (void)context;
    (void)now;
    (void)measurement;
    saw.delivered++;
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
    (void)now;
    saw.sensed++;
    saw.sensed_for = time;
}

static enum mh_status lead(void *context, mh_tick now, const uint8_t *track, size_t length)
{
    (void)context;
    (void)now;
    (void)track;
    saw.leads += saw.lead_status == MH_OK;
    saw.track = length;
    return saw.lead_status;
}

static void follow(void *context)
{
    (void)context;
    saw.follows++;
}

static enum mh_status save(void *context, uint8_t *track, size_t *length)
{
    (void)context;
    memset(track, 7, 60);
    *length = 60;
    return MH_OK;
}

static enum mh_status expect(void *context, mh_tick time, struct mh_estimate *estimate)
{
    (void)context;
    *estimate = saw.estimate;
    estimate->time = time;
    return MH_OK;
}

static void restart(void *context)
{
    (void)context;
    saw.restarts++;
}

static void tell(void *context, const struct mh_estimate *estimate)
{
    (void)context;
    saw.told++;
    saw.estimate = *estimate;
}

static const struct mh_protocol_port port = {.send = send,
                                             .set_timer = set_timer,
                                             .deliver = deliver,
                                             .listen = listen,
                                             .network = network,
                                             .own = own,
                                             .sense = sense,
                                             .lead = lead,
                                             .follow = follow,
                                             .save = save,
                                             .expect = expect,
                                             .restart = restart,
                                             .tell = tell};
static const struct mh_protocol *const cluster = &mh_protocol_cluster;
static struct mh_cluster_config config;
static struct mh_protocol_node node;
static struct mh_cluster_node state;

static void come_up(mh_node_id id)
{
    const struct mh_protocol_node plain = {.id = id, .place = {20000, 0, 0}, .is_head = true, .port = &port};
    memset(&saw, 0, sizeof saw);
    saw.knows_time = true;
    node = plain;
    TEST_ASSERT_EQUAL(MH_OK, cluster->init(&state, &config, &node));
    cluster->start(&state, AHEAD + 10);
}

void setUp(void)
{
    const struct mh_place sink = {0, 0, 0};
    mh_cluster_config_default(&config, MH_ELECTION_SAC, SINK, &sink);
    come_up(NODE);
}

void tearDown(void) {}

static void hear(mh_tick time, const struct mh_message *message) { cluster->message(&state, AHEAD + time, message); }

/* All timers that are due until `time`, which has come then; what is sent has gone out. */
static void pass(mh_tick time)
{
    for (unsigned i = 0; i < 500 && !mh_tick_before(time, saw.timer); i++) {
        const unsigned before = saw.sent;
        cluster->timer(&state, AHEAD + saw.timer);
        for (unsigned k = before; k < saw.sent; k++) {
            cluster->sent(&state, AHEAD + saw.timer + 3, MH_SENT_OK);
        }
    }
    cluster->timer(&state, AHEAD + time);
}

static void hear_hello(mh_node_id id, int32_t x_mm)
{
    const struct mh_message message = {.kind = MH_MESSAGE_HELLO, .as.hello = {.sender = (int32_t)id, .x_mm = x_mm}};
    hear(100, &message);
}

static void hear_ask(mh_tick time, mh_tick instant, mh_node_id head, int32_t generation, bool everyone)
{
    const struct mh_message message = {.kind = MH_MESSAGE_ASK,
                                       .as.ask = {.sender = (int32_t)head,
                                                  .track = HEAD,
                                                  .generation = generation,
                                                  .time_ms = (int32_t)instant,
                                                  .x_mm = 30000,
                                                  .vx_mmps = 1000,
                                                  .everyone = everyone}};
    hear(time, &message);
}

static void hear_form(mh_tick time, mh_tick first, mh_node_id head, int32_t generation, mh_node_id member)
{
    struct mh_message message = {
        .kind = MH_MESSAGE_FORM,
        .as.form = {
            .sender = (int32_t)head, .track = HEAD, .generation = generation, .time_ms = (int32_t)first, .count = 2}};
    for (uint8_t i = 0; i < MH_FORM_MEMBERS; i++) {
        message.as.form.members[i] = i == 0 ? (int32_t)OTHER : i == 1 ? (int32_t)member : -1;
    }
    hear(time, &message);
}

static void measure(mh_tick time, float range_m)
{
    const struct mh_measurement measurement = {
        .node = node.id, .place = node.place, .time = time, .value = mh_q20_from_real(mh_real_from_float(range_m))};
    TEST_ASSERT_EQUAL(MH_OK, cluster->publish(&state, AHEAD + time, &measurement));
}

static void hand_over_of(mh_tick time, mh_tick instant, int32_t generation, uint8_t part, uint8_t parts, int16_t number)
{
    struct mh_message message = {.kind = MH_MESSAGE_HAND_OVER,
                                 .as.hand_over = {.track = HEAD,
                                                  .generation = generation,
                                                  .time_ms = (int32_t)instant,
                                                  .part = part,
                                                  .parts = parts,
                                                  .length = part + 1 < parts ? MH_HAND_OVER_BYTES : 20}};
    message.as.hand_over.data[0] = part == 0 ? 1 : 0;
    message.as.hand_over.data[4] = part == 0 ? OTHER : 0; /* the member */
    mh_geographic_address(&message, HEAD, number, NODE, &node.place);
    hear(time, &message);
}

static void hand_over(mh_tick time, int32_t generation, uint8_t part, uint8_t parts, int16_t number)
{
    hand_over_of(time, time / T * T, generation, part, parts, number);
}

/* The mote has become head in the usual way, by generation 5 of HEAD's track, and its cluster is announced. Neighbours: NEXT at 60 m, OTHER at 25 m. */
static void be_head(mh_tick time)
{
    hear_hello(HEAD, 10000);
    hear_hello(NEXT, 60000);
    hear_hello(OTHER, 25000);
    hear_hello(SINK, 0);
    saw.estimate.position.x = MH_REAL(30.0f);
    hand_over(time, 5, 0, 1, 1);
    TEST_ASSERT_EQUAL(1, saw.leads);
    TEST_ASSERT_EQUAL(MH_CLUSTER_HEAD, state.role);
}

/* The instant is closed with so many measurements, the first this node's; the target is at x and moves. */
static void close_instant(mh_tick instant, int16_t x_m, int16_t vx_mps, uint8_t count)
{
    static const mh_node_id who[] = {NODE, OTHER, 50, 51, 52, 53};
    struct mh_measurement measurements[6];
    struct mh_estimate estimate = {.time = instant, .flags = MH_ESTIMATE_REFRESHED};
    memset(measurements, 0, sizeof measurements);
    for (uint8_t i = 0; i < count; i++) {
        measurements[i].node = who[i];
        measurements[i].time = instant;
    }
    estimate.position.x = estimate.stored.x = mh_real_from_int(x_m);
    estimate.velocity.x = estimate.stored_velocity.x = mh_real_from_int(vx_mps);
    cluster->closed(&state, AHEAD + instant + config.window, instant, count > 0 ? &estimate : NULL, measurements,
                    count);
}

static void bad_configurations_are_refused(void)
{
    struct mh_cluster_config good = config;
    config.wake_length = 3;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, cluster->init(&state, &config, &node));
    config = good;
    config.wake_length = config.wake_period;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, cluster->init(&state, &config, &node));
    config = good;
    config.window = T;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, cluster->init(&state, &config, &node));
    config = good;
    config.watch_period = T - 1;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, cluster->init(&state, &config, &node));
    config = good;
    config.election.members = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, cluster->init(&state, &config, &node));
    config = good;
    config.link.attempts = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, cluster->init(&state, &config, &node));
    config = good;
    config.sink = MH_BROADCAST;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, cluster->init(&state, &config, &node));
}

/* Two hellos while all listen, one in a wake window soon after, then one a period in a wake window, and the radio sleeps. */
static void a_node_sleeps_after_its_first_hellos(void)
{
    pass(MH_CLUSTER_START + 5);
    TEST_ASSERT_TRUE(saw.listens);
    pass(MH_CLUSTER_START + 20);
    TEST_ASSERT_FALSE(saw.listens);
    pass(LATER);
    TEST_ASSERT_EQUAL(3, saw.of_kind[MH_MESSAGE_HELLO]);
    while (saw.of_kind[MH_MESSAGE_HELLO] == 3) {
        const mh_tick due = saw.timer;
        cluster->timer(&state, AHEAD + due);
        if (saw.of_kind[MH_MESSAGE_HELLO] == 4) {
            TEST_ASSERT_TRUE(mh_rendezvous_open(&state.rendezvous, due));
            TEST_ASSERT_TRUE(due > config.hello_period / 2 && due < config.hello_period + 2 * MH_CLUSTER_START);
        }
    }
}

static void hear_hello_at(mh_tick time, int16_t sequence)
{
    const struct mh_message message = {.kind = MH_MESSAGE_HELLO,
                                       .as.hello = {.sender = NEXT, .x_mm = 60000, .sequence = sequence}};
    hear(time, &message);
}

/* Within 16 windows and those left to asking, in a window, once; then the next a period later. */
static void who_hears_a_node_begin_anew_says_hello(void)
{
    const mh_tick heard = 60000, pause = 10000, at_most = 16 * 250 * 8 / 7 + 500;
    pass(heard);
    const unsigned before = saw.of_kind[MH_MESSAGE_HELLO];
    hear_hello_at(heard, 2);
    for (mh_tick time = heard; time <= heard + at_most && saw.of_kind[MH_MESSAGE_HELLO] == before; time = saw.timer) {
        pass(saw.timer);
    }
    TEST_ASSERT_EQUAL(before + 1, saw.of_kind[MH_MESSAGE_HELLO]);
    TEST_ASSERT_TRUE(mh_rendezvous_open(&state.rendezvous, state.greeted));
    const mh_tick first = state.greeted;
    TEST_ASSERT_TRUE(first > heard && first <= heard + at_most);
    for (int i = 0; i < 20; i++) { /* many restart: a hello in a pause, no more */
        hear_hello_at(first + 10 + (mh_tick)i, (int16_t)(i % 3));
    }
    pass(first + pause - 1);
    TEST_ASSERT_EQUAL(before + 1, saw.of_kind[MH_MESSAGE_HELLO]);
    pass(first + pause + at_most);
    TEST_ASSERT_EQUAL(before + 2, saw.of_kind[MH_MESSAGE_HELLO]);
    pass(first + pause + at_most + config.hello_period / 2);
    TEST_ASSERT_EQUAL(before + 2, saw.of_kind[MH_MESSAGE_HELLO]);
}

static void a_hello_of_long_known_nodes_or_at_the_start_is_not_answered(void)
{
    pass(LATER);
    hear_hello_at(LATER, 2);
    pass(60000);
    hear_hello_at(60000, 3);
    hear_hello_at(60001, 256);
    hear_hello_at(60002, -1); /* 65,535 */
    pass(100000);
    TEST_ASSERT_EQUAL(3, saw.of_kind[MH_MESSAGE_HELLO]);
}

/* Its own instant once a watch period, if it has heard of no track. */
static void who_is_not_asked_watches(void)
{
    pass(LATER + 1);
    const unsigned before = saw.sensed;
    pass(LATER + 1 + 10 * config.watch_period);
    TEST_ASSERT_EQUAL(before + 10, saw.sensed);
    TEST_ASSERT_EQUAL_UINT32(0, saw.sensed_for % T);
    TEST_ASSERT_FALSE(saw.listens);
}

static void without_the_networks_time_nothing_is_done(void)
{
    memset(&saw, 0, sizeof saw);
    TEST_ASSERT_EQUAL(MH_OK, cluster->init(&state, &config, &node));
    cluster->start(&state, AHEAD);
    hear_ask(LATER, LATER, HEAD, 1, true);
    cluster->timer(&state, AHEAD + LATER);
    TEST_ASSERT_EQUAL(0, saw.sent + saw.sensed);
    saw.knows_time = true;
    cluster->time_jumped(&state, AHEAD + LATER);
    hear_ask(LATER + T, LATER + T, HEAD, 1, true);
    TEST_ASSERT_EQUAL(1, saw.sensed);
}

static void who_hears_an_ask_for_everyone_answers_once(void)
{
    pass(LATER - 1);
    const unsigned before = saw.sensed;
    hear_ask(LATER + 4, LATER, HEAD, 3, true);
    TEST_ASSERT_EQUAL(before + 1, saw.sensed);
    TEST_ASSERT_EQUAL_UINT32(LATER, saw.sensed_for);
    TEST_ASSERT_TRUE(saw.listens);
    measure(LATER + 5, -1.5f);
    pass(LATER + config.window);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ANSWER]);
    hear_ask(LATER + 80, LATER, HEAD, 3, true);
    TEST_ASSERT_EQUAL(before + 1, saw.sensed);
    pass(LATER + config.window);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ANSWER]);
    TEST_ASSERT_EQUAL_UINT32(HEAD, saw.destination);
    TEST_ASSERT_EQUAL_INT32(MH_Q20(-1.5f), saw.message.as.answer.value_q20);
    TEST_ASSERT_FALSE(saw.listens);
}

/* The radio has given the answer up: once more, in time. */
static void an_answer_that_is_not_acknowledged_goes_again(void)
{
    pass(LATER - 1);
    hear_ask(LATER + 4, LATER, HEAD, 3, true);
    measure(LATER + 5, 20);
    for (mh_tick time = LATER + 5; saw.of_kind[MH_MESSAGE_ANSWER] == 0; time++) {
        cluster->timer(&state, AHEAD + time);
    }
    cluster->sent(&state, AHEAD + LATER + 80, MH_SENT_NO_ACK);
    TEST_ASSERT_TRUE(saw.listens);
    pass(LATER + config.window);
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_ANSWER]);
}

static void who_is_no_member_is_not_asked(void)
{
    pass(LATER - 1);
    const unsigned before = saw.sensed;
    hear_ask(LATER + 4, LATER, HEAD, 3, false);
    TEST_ASSERT_EQUAL(before, saw.sensed);
    TEST_ASSERT_FALSE(saw.listens);
    pass(LATER + T);
    TEST_ASSERT_EQUAL(before, saw.sensed); /* nor does it watch while there is a head */
}

static void a_member_joins_wakes_at_the_instant_and_answers_in_turn(void)
{
    pass(LATER + 300);
    hear_form(LATER + 500, LATER + T, HEAD, 3, NODE);
    TEST_ASSERT_EQUAL(MH_CLUSTER_MEMBER, state.role);
    TEST_ASSERT_EQUAL(1, state.rank);
    pass(LATER + 600);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_JOIN]);
    TEST_ASSERT_EQUAL_UINT32(HEAD, saw.destination);
    TEST_ASSERT_EQUAL_INT32(3, saw.message.as.join.generation);
    pass(LATER + T - 1);
    TEST_ASSERT_FALSE(saw.listens);
    pass(LATER + T);
    TEST_ASSERT_TRUE(saw.listens);
    const unsigned before = saw.sensed;
    hear_ask(LATER + T + 4, LATER + T, HEAD, 3, false);
    TEST_ASSERT_EQUAL(before + 1, saw.sensed);
    measure(LATER + T + 5, 20);
    pass(LATER + T + 20); /* the first of two has its turn */
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_ANSWER]);
    pass(LATER + T + 70);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ANSWER]);
    hear_form(LATER + T + 500, LATER + 2 * T, NEXT, 4, OTHER); /* a new cluster without it */
    TEST_ASSERT_EQUAL(MH_CLUSTER_SLEEPER, state.role);
}

/* Nobody asks at two instants: the member samples, and takes over if it measures the target, after those before it. */
static void a_member_takes_over_from_a_silent_head(void)
{
    pass(LATER + 300);
    hear_hello(OTHER, 25000);
    hear_form(LATER + 500, LATER + T, HEAD, 3, NODE);
    hear_ask(LATER + T + 4, LATER + T, HEAD, 3, false);
    pass(LATER + 3 * T + config.window - 1);
    const unsigned before = saw.sensed;
    pass(LATER + 3 * T + config.window);
    TEST_ASSERT_EQUAL(before + 1, saw.sensed);
    measure(LATER + 3 * T + config.window + 1, 20);
    pass(LATER + 3 * T + 499);
    TEST_ASSERT_EQUAL(0, saw.leads);
    pass(LATER + 3 * T + 510);
    TEST_ASSERT_EQUAL(1, saw.leads);
    TEST_ASSERT_EQUAL(MH_CLUSTER_HEAD, state.role);
    TEST_ASSERT_EQUAL(MH_MESSAGE_FORM, saw.message.kind);
    TEST_ASSERT_EQUAL_INT32(4, saw.message.as.form.generation);
    TEST_ASSERT_EQUAL_INT32(HEAD, saw.message.as.form.track);
    TEST_ASSERT_EQUAL_INT32(OTHER, saw.message.as.form.members[0]);
    pass(LATER + 4 * T + 1);
    TEST_ASSERT_EQUAL(MH_MESSAGE_ASK, saw.message.kind);
    TEST_ASSERT_EQUAL(1, saw.message.as.ask.everyone);
    TEST_ASSERT_INT32_WITHIN(1, 36000, saw.message.as.ask.x_mm); /* where it went on to, at 1 m/s */
}

static void a_member_that_is_left_behind_does_not(void)
{
    pass(LATER + 300);
    hear_form(LATER + 500, LATER + T, HEAD, 3, NODE);
    hear_ask(LATER + T + 4, LATER + T, HEAD, 3, false);
    pass(LATER + 6 * T); /* samples, but nothing comes of it */
    TEST_ASSERT_EQUAL(0, saw.leads);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_FORM]);
}

static void another_that_takes_over_is_followed(void)
{
    pass(LATER + 300);
    hear_form(LATER + 500, LATER + T, HEAD, 3, NODE);
    pass(LATER + 3 * T + config.window);
    measure(LATER + 3 * T + config.window + 1, 20);
    hear_form(LATER + 3 * T + 252, LATER + 4 * T, OTHER, 4, NODE);
    pass(LATER + 4 * T - 1);
    TEST_ASSERT_EQUAL(0, saw.leads);
    TEST_ASSERT_EQUAL(MH_CLUSTER_MEMBER, state.role);
}

/* The first window after it was found, the nearer the sooner; the alert is heard by others, who then keep quiet. */
static void who_finds_the_target_alerts_and_leads(void)
{
    pass(LATER);
    measure(LATER, 11);
    pass(LATER + 499);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_ALERT]);
    pass(LATER + 505);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ALERT]);
    TEST_ASSERT_EQUAL(0, saw.message.as.alert.lost);
    TEST_ASSERT_EQUAL_INT32(NODE, saw.message.as.alert.track);
    TEST_ASSERT_EQUAL(1, saw.leads);
    TEST_ASSERT_EQUAL(0, saw.track);
    pass(LATER + T + 1);
    TEST_ASSERT_EQUAL(MH_MESSAGE_ASK, saw.message.kind);
    TEST_ASSERT_EQUAL(1, saw.message.as.ask.everyone);
}

static void an_alert_of_another_is_enough(void)
{
    const struct mh_message alert = {
        .kind = MH_MESSAGE_ALERT,
        .as.alert = {.sender = OTHER, .track = OTHER, .time_ms = (int32_t)LATER, .value_q20 = MH_Q20_ONE}};
    pass(LATER);
    measure(LATER, 11);
    hear(LATER + 251, &alert);
    pass(LATER + T);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_ALERT]);
    TEST_ASSERT_EQUAL(0, saw.leads);
}

/* He may only be too far from the head: the third time. */
static void who_measures_the_target_from_far_waits(void)
{
    for (uint8_t i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL(0, saw.leads);
        pass(LATER + i * T);
        measure(LATER + i * T, 48);
        pass(LATER + i * T + T - 1);
    }
    TEST_ASSERT_EQUAL(1, saw.leads);
}

static void a_lost_target_is_looked_for_at_every_instant(void)
{
    const struct mh_message lost = {
        .kind = MH_MESSAGE_ALERT,
        .as.alert = {.sender = HEAD, .track = HEAD, .generation = 4, .time_ms = (int32_t)LATER, .lost = 1}};
    pass(LATER + 200);
    hear(LATER + 251, &lost);
    const unsigned before = saw.sensed;
    pass(LATER + 5 * T + 1);
    TEST_ASSERT_EQUAL(before + 5, saw.sensed);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ALERT]); /* passed on, once */
    TEST_ASSERT_EQUAL(1, saw.message.as.alert.hops);
    hear(LATER + 5 * T + 251, &lost);
    pass(LATER + 6 * T);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ALERT]);
}

static void a_track_that_comes_makes_a_head(void)
{
    pass(LATER + 160);
    be_head(LATER + 252);
    TEST_ASSERT_EQUAL(19 - 4, saw.track); /* without the list of members */
    TEST_ASSERT_EQUAL(1, state.cluster.count);
    TEST_ASSERT_EQUAL_UINT32(OTHER, state.cluster.members[0].id);
    pass(LATER + 510);
    TEST_ASSERT_EQUAL(MH_MESSAGE_FORM, saw.message.kind);
    TEST_ASSERT_EQUAL_INT32(5, saw.message.as.form.generation);
    TEST_ASSERT_EQUAL_INT32(LATER + T, saw.message.as.form.time_ms);
    TEST_ASSERT_TRUE(saw.listens); /* to those who join */
    pass(LATER + T - 1);
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_FORM]); /* nobody has joined */
    TEST_ASSERT_FALSE(saw.listens);
    pass(LATER + T + 1);
    TEST_ASSERT_EQUAL(MH_MESSAGE_ASK, saw.message.kind);
    TEST_ASSERT_EQUAL(0, saw.message.as.ask.everyone);
    TEST_ASSERT_EQUAL_UINT32(LATER + T, saw.sensed_for);
    TEST_ASSERT_TRUE(saw.listens);
    pass(LATER + T + 90); /* the member, well within reach of the target, has not answered */
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_ASK]);
    TEST_ASSERT_EQUAL_INT32(LATER + T, saw.message.as.ask.time_ms);
}

static void a_cluster_that_has_joined_is_announced_once(void)
{
    pass(LATER + 160);
    be_head(LATER + 252);
    pass(LATER + 510);
    const struct mh_message join = {.kind = MH_MESSAGE_JOIN,
                                    .as.join = {.sender = OTHER, .track = HEAD, .generation = 5}};
    hear(LATER + 515, &join);
    pass(LATER + T - 1);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_FORM]);
}

static void a_track_comes_in_parts_in_any_order_and_once(void)
{
    pass(LATER + 160);
    hand_over(LATER + 252, 5, 1, 2, 11);
    TEST_ASSERT_EQUAL(0, saw.leads);
    hand_over(LATER + 252, 5, 1, 2, 11); /* again */
    hand_over(LATER + 254, 5, 0, 2, 10);
    TEST_ASSERT_EQUAL(1, saw.leads);
    TEST_ASSERT_EQUAL(MH_HAND_OVER_BYTES + 20 - 5, saw.track);
    hand_over(LATER + 256, 5, 0, 2, 10);
    TEST_ASSERT_EQUAL(1, saw.leads);
}

/* Of two parts, the last has come; and then one of so many that their number does not fit, or that leaves a gap. */
static void parts_that_do_not_fit_make_no_track(void)
{
    pass(LATER + 160);
    hand_over(LATER + 252, 5, 1, 2, 11);
    for (unsigned parts = 3; parts <= UINT8_MAX; parts++) {
        hand_over(LATER + 252, 5, 0, (uint8_t)parts, (int16_t)(20 + parts));
    }
    TEST_ASSERT_EQUAL(0, saw.leads);
    struct mh_message gap = {
        .kind = MH_MESSAGE_HAND_OVER,
        .as.hand_over = {.track = HEAD, .generation = 7, .time_ms = (int32_t)LATER, .parts = 2, .length = 63}};
    mh_geographic_address(&gap, HEAD, 12, NODE, &node.place);
    hear(LATER + 252, &gap);
    hand_over(LATER + 252, 7, 1, 2, 13);
    TEST_ASSERT_EQUAL(0, saw.leads);
}

static void parts_that_no_track_has_are_not_taken(void)
{
    pass(LATER + 160);
    hand_over(LATER + 252, 5, 0, 1, 11);
    TEST_ASSERT_EQUAL(1, saw.leads);
    for (uint8_t parts = 10; parts >= 10; parts = (uint8_t)(parts + 35)) {
        hand_over(LATER + 254, 6, 0, parts, (int16_t)(100 + parts));
        hand_over(LATER + 254, 6, (uint8_t)(parts - 1), parts, (int16_t)(400 + parts));
    }
    TEST_ASSERT_EQUAL(1, saw.leads);
}

/* A month without a target: what was known of the last one does not stand against a new one. */
static void old_tracks_are_forgotten(void)
{
    const mh_tick month = LATER + 30u * 24u * 3600000u;
    config.hello_period = 1000000;
    come_up(NODE);
    pass(LATER - 1);
    hear_ask(LATER + 4, LATER, HEAD, 9, true);
    for (mh_tick time = LATER; time < month; time += 100000000u) {
        state.set = 1u << MH_CLUSTER_HELLO; /* of all that happens hellos suffice */
        cluster->timer(&state, AHEAD + time);
        cluster->sent(&state, AHEAD + time + 3, MH_SENT_OK);
        state.due[MH_CLUSTER_HELLO] = time + 100000000u;
    }
    TEST_ASSERT_FALSE(state.knows);
    cluster->time_jumped(&state, AHEAD + month);
    hear_ask(month + T + 4, month + T, HEAD, 1, true); /* outranked, a month ago */
    TEST_ASSERT_EQUAL_INT32(1, state.of.generation);
}

/* The tracker does not know it: then anew. */
static void a_track_that_is_corrupt_is_begun_anew(void)
{
    pass(LATER + 160);
    saw.lead_status = MH_ERR_CORRUPT;
    hand_over(LATER + 252, 5, 0, 1, 11);
    TEST_ASSERT_EQUAL(MH_CLUSTER_SLEEPER, state.role);
    TEST_ASSERT_EQUAL(0, saw.track); /* tried without it at last */
}

static void old_and_outranked_tracks_are_not_taken(void)
{
    pass(LATER + 160);
    hear_ask(LATER + 170, LATER, HEAD, 5, false);
    hand_over(LATER + 252, 4, 0, 1, 11);
    TEST_ASSERT_EQUAL(0, saw.leads);
    hand_over_of(LATER + 252, LATER - 2 * T, 9, 0, 1, 12);
    TEST_ASSERT_EQUAL(0, saw.leads);
    hand_over(LATER + 252, 6, 0, 1, 13);
    TEST_ASSERT_EQUAL(1, saw.leads);
}

/* The elected head covers where the target goes; the track goes in the next window, and when the radio has acknowledged it this head is none. */
static void the_track_goes_to_the_elected_head(void)
{
    pass(LATER + 160);
    be_head(LATER + 252);
    pass(LATER + T + 140);
    close_instant(LATER + T, 68, 4, 5); /* P_1 is at 76 m: this node does not cover it */
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_HAND_OVER]);
    while (saw.of_kind[MH_MESSAGE_HAND_OVER] == 0) {
        cluster->timer(&state, AHEAD + saw.timer);
    }
    TEST_ASSERT_EQUAL_UINT32(NEXT, saw.destination);
    TEST_ASSERT_EQUAL_INT32(6, saw.message.as.hand_over.generation);
    TEST_ASSERT_EQUAL_INT32(LATER + T, saw.message.as.hand_over.time_ms);
    TEST_ASSERT_EQUAL(0, saw.follows);
    /* one of two parts: a list of members and 60 bytes of track; then the rest */
    for (uint8_t i = saw.message.as.hand_over.parts; i > 0; i--) {
        cluster->sent(&state, AHEAD + LATER + T + 254, MH_SENT_OK);
        if (i > 1) {
            pass(LATER + T + 255);
        }
    }
    TEST_ASSERT_EQUAL(1, saw.follows);
    TEST_ASSERT_EQUAL(MH_CLUSTER_SLEEPER, state.role);
    TEST_ASSERT_EQUAL_UINT32(NEXT, state.of.head);
}

/* Neither of the two attempts is acknowledged, and there is nobody else: the head stays, of a generation above the one it has offered. */
static void a_head_stays_if_nobody_takes_the_track(void)
{
    pass(LATER + 160);
    be_head(LATER + 252);
    pass(LATER + T + 140);
    close_instant(LATER + T, 68, 4, 5);
    for (uint8_t i = 0; i < MH_CLUSTER_ATTEMPTS; i++) {
        mh_tick time = saw.timer;
        for (const unsigned before = saw.sent; saw.sent == before;) {
            time = saw.timer;
            cluster->timer(&state, AHEAD + time);
        }
        TEST_ASSERT_EQUAL(MH_MESSAGE_HAND_OVER, saw.message.kind);
        TEST_ASSERT_EQUAL(0, saw.follows);
        cluster->sent(&state, AHEAD + time + 9, MH_SENT_NO_ACK);
    }
    TEST_ASSERT_EQUAL(1, state.events.refused);
    TEST_ASSERT_EQUAL(MH_CLUSTER_HEAD, state.role);
    TEST_ASSERT_EQUAL_INT32(7, state.of.generation);
    pass(LATER + 2 * T + 1);
    TEST_ASSERT_EQUAL(MH_MESSAGE_ASK, saw.message.kind);
    TEST_ASSERT_EQUAL(1, saw.message.as.ask.everyone);
    const unsigned before = saw.of_kind[MH_MESSAGE_HAND_OVER];
    close_instant(LATER + 2 * T, 76, 4, 5); /* NEXT has failed: it is not asked again */
    pass(LATER + 3 * T - 1);
    TEST_ASSERT_EQUAL(before, saw.of_kind[MH_MESSAGE_HAND_OVER]);
}

static void what_is_stored_goes_to_the_sink(void)
{
    pass(LATER + 160);
    be_head(LATER + 252);
    pass(LATER + T + 140);
    close_instant(LATER + T, 30, -1, 5); /* all well: no election */
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_POSITION]);
    pass(LATER + T + 260);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_POSITION]);
    TEST_ASSERT_EQUAL(MH_MESSAGE_POSITION, saw.message.kind);
    TEST_ASSERT_EQUAL_INT32(30000, saw.message.as.position.x_mm);
    TEST_ASSERT_EQUAL_INT32(-1000, saw.message.as.position.vx_mmps);
    TEST_ASSERT_EQUAL_UINT32(SINK, saw.destination);
    TEST_ASSERT_EQUAL(0, saw.follows);
}

/* Everyone is asked then; after the second instant more the track is given up, and its neighbours are told. */
static void a_target_that_nobody_measures_is_lost(void)
{
    pass(LATER + 160);
    be_head(LATER + 252);
    pass(LATER + T + 140);
    close_instant(LATER + T, 0, 0, 0);
    TEST_ASSERT_EQUAL(1, saw.restarts);
    pass(LATER + 2 * T + 1);
    TEST_ASSERT_EQUAL(1, saw.message.as.ask.everyone);
    close_instant(LATER + 2 * T, 0, 0, 0);
    TEST_ASSERT_EQUAL(0, saw.follows);
    state.events.lost = UINT16_MAX; /* a full counter stays */
    pass(LATER + 3 * T + 1);
    close_instant(LATER + 3 * T, 0, 0, 0);
    TEST_ASSERT_EQUAL(1, saw.follows);
    TEST_ASSERT_EQUAL(UINT16_MAX, state.events.lost);
    pass(LATER + 3 * T + 260);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ALERT]);
    TEST_ASSERT_EQUAL(1, saw.message.as.alert.lost);
}

/* Of two heads of one track the higher generation goes on; at equal ones the lower identifier. */
static void the_better_of_two_heads_goes_on(void)
{
    for (int8_t ahead = -1; ahead <= 1; ahead++) {
        for (uint8_t lower = 0; lower < 2; lower++) {
            const bool wins = ahead < 0 || (ahead == 0 && !lower);
            setUp();
            pass(LATER + 160);
            be_head(LATER + 252);
            pass(LATER + T + 1);
            const unsigned forms = saw.of_kind[MH_MESSAGE_FORM];
            hear_ask(LATER + T + 5, LATER + T, lower ? NODE - 1 : OTHER, 5 + ahead, false);
            TEST_ASSERT_EQUAL(wins ? 0 : 1, saw.follows);
            pass(LATER + T + 260);
            TEST_ASSERT_EQUAL(forms + wins, saw.of_kind[MH_MESSAGE_FORM]); /* the other is told */
        }
    }
}

/* Another track, begun elsewhere, within the sensing range of this one; and farther off. */
static void heads_of_different_tracks_become_one_where_they_meet(void)
{
    for (uint8_t far = 0; far < 2; far++) {
        setUp();
        pass(LATER + 160);
        be_head(LATER + 252);
        pass(LATER + T + 1);
        struct mh_message message = {.kind = MH_MESSAGE_ASK,
                                     .as.ask = {.sender = OTHER,
                                                .track = OTHER,
                                                .generation = 9,
                                                .time_ms = (int32_t)(LATER + T),
                                                .x_mm = far ? 80001 : 79999}};
        hear(LATER + T + 5, &message);
        TEST_ASSERT_EQUAL(far ? 0 : 1, saw.follows);
    }
}

static void frames_of_other_times_are_not_believed(void)
{
    pass(LATER + 10);
    hear_ask(LATER + 11, LATER - 3 * T, HEAD, 3, true);
    hear_ask(LATER + 11, LATER + 3 * T, HEAD, 3, true);
    hear_form(LATER + 12, LATER - 3 * T, HEAD, 3, NODE);
    TEST_ASSERT_FALSE(state.knows);
    TEST_ASSERT_EQUAL(MH_CLUSTER_SLEEPER, state.role);
}

static void tell_the_sink(mh_tick time, mh_tick instant, int32_t x_mm, int32_t vx_mmps, int32_t generation,
                          mh_node_id head)
{
    static int16_t number = 100;
    const struct mh_place place = {0, 0, 0};
    struct mh_message message = {.kind = MH_MESSAGE_POSITION,
                                 .as.position = {.origin = (int32_t)head,
                                                 .track = HEAD,
                                                 .generation = generation,
                                                 .time_ms = (int32_t)instant,
                                                 .x_mm = x_mm,
                                                 .vx_mmps = vx_mmps}};
    mh_geographic_address(&message, head, ++number, SINK, &place);
    hear(time, &message);
}

/* It extrapolates what it was told, tells its owner at every instant, and does not believe an outranked head. */
static void the_sink_extrapolates(void)
{
    come_up(SINK);
    pass(LATER + T);
    TEST_ASSERT_TRUE(saw.listens);
    TEST_ASSERT_EQUAL(0, saw.told);
    tell_the_sink(LATER + T + 600, LATER + T, 50000, 4000, 3, HEAD);
    pass(LATER + 2 * T);
    TEST_ASSERT_EQUAL(1, saw.told);
    TEST_ASSERT_EQUAL_UINT32(LATER + 2 * T, saw.estimate.time);
    TEST_ASSERT_EQUAL_INT32(50000, saw.estimate.origin.x_mm);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 8, mh_real_to_float(saw.estimate.position.x));
    tell_the_sink(LATER + 2 * T + 600, LATER + 2 * T, 500000, 0, 2, OTHER); /* outranked */
    tell_the_sink(LATER + 2 * T + 601, LATER, 0, 0, 3, HEAD);               /* overtaken on its way */
    pass(LATER + 3 * T);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 16, mh_real_to_float(saw.estimate.position.x));
    tell_the_sink(LATER + 3 * T + 600, LATER + 3 * T, 70000, 0, 4, OTHER);
    pass(LATER + 4 * T);
    TEST_ASSERT_EQUAL_INT32(70000, saw.estimate.origin.x_mm);
    TEST_ASSERT_EQUAL(3, saw.told);
    TEST_ASSERT_EQUAL(0, saw.sensed);
}

/* An alarm a day, late as they are then. */
static void pass_days(mh_tick from, uint8_t days)
{
    for (uint8_t day = 0; day <= days; day++) {
        cluster->timer(&state, AHEAD + from + day * 86400000u);
    }
}

/* Half a wrap of the ticks after a node has heard of a track, its time is no later than that to the ticks' arithmetic. */
static void what_is_long_past_does_not_come_back(void)
{
    const mh_tick month = 30u * 86400000u, then = month + LATER;
    pass(LATER - 1);
    hear_ask(LATER + 4, LATER, HEAD, 3, false);
    mh_shun(&state.shunned, NEXT, LATER + MH_CLUSTER_SHUN_TIME);
    pass_days(LATER, 30);
    pass(then + T);
    const unsigned before = saw.sensed;
    pass(then + T + 5 * config.watch_period); /* it watches, and only when it is its turn */
    TEST_ASSERT_EQUAL(before + 5, saw.sensed);
    TEST_ASSERT_TRUE(mh_ticks_between(state.shunned.list[0].until, state.time) >= 0);

    come_up(SINK);
    pass(LATER + T);
    tell_the_sink(LATER + T + 600, LATER + T, 50000, 4000, 3, HEAD);
    pass_days(LATER + T, 30);
    const mh_tick now = mh_tick_aligned(0, T, month + LATER + T);
    pass(now);
    const unsigned told = saw.told;
    pass(now + 3 * T);
    TEST_ASSERT_EQUAL(told, saw.told); /* of a day ago and more, nothing */
    tell_the_sink(now + 3 * T + 600, now + 3 * T, 70000, 0, 1, OTHER);
    pass(now + 4 * T);
    TEST_ASSERT_EQUAL(told + 1, saw.told);
    TEST_ASSERT_EQUAL_INT32(70000, saw.estimate.origin.x_mm);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bad_configurations_are_refused);
    RUN_TEST(a_node_sleeps_after_its_first_hellos);
    RUN_TEST(who_hears_a_node_begin_anew_says_hello);
    RUN_TEST(a_hello_of_long_known_nodes_or_at_the_start_is_not_answered);
    RUN_TEST(who_is_not_asked_watches);
    RUN_TEST(without_the_networks_time_nothing_is_done);
    RUN_TEST(who_hears_an_ask_for_everyone_answers_once);
    RUN_TEST(an_answer_that_is_not_acknowledged_goes_again);
    RUN_TEST(who_is_no_member_is_not_asked);
    RUN_TEST(a_member_joins_wakes_at_the_instant_and_answers_in_turn);
    RUN_TEST(a_member_takes_over_from_a_silent_head);
    RUN_TEST(a_member_that_is_left_behind_does_not);
    RUN_TEST(another_that_takes_over_is_followed);
    RUN_TEST(who_finds_the_target_alerts_and_leads);
    RUN_TEST(an_alert_of_another_is_enough);
    RUN_TEST(who_measures_the_target_from_far_waits);
    RUN_TEST(a_lost_target_is_looked_for_at_every_instant);
    RUN_TEST(a_track_that_comes_makes_a_head);
    RUN_TEST(a_cluster_that_has_joined_is_announced_once);
    RUN_TEST(a_track_comes_in_parts_in_any_order_and_once);
    RUN_TEST(parts_that_do_not_fit_make_no_track);
    RUN_TEST(parts_that_no_track_has_are_not_taken);
    RUN_TEST(old_tracks_are_forgotten);
    RUN_TEST(a_track_that_is_corrupt_is_begun_anew);
    RUN_TEST(old_and_outranked_tracks_are_not_taken);
    RUN_TEST(the_track_goes_to_the_elected_head);
    RUN_TEST(a_head_stays_if_nobody_takes_the_track);
    RUN_TEST(what_is_stored_goes_to_the_sink);
    RUN_TEST(a_target_that_nobody_measures_is_lost);
    RUN_TEST(the_better_of_two_heads_goes_on);
    RUN_TEST(heads_of_different_tracks_become_one_where_they_meet);
    RUN_TEST(frames_of_other_times_are_not_believed);
    RUN_TEST(the_sink_extrapolates);
    RUN_TEST(what_is_long_past_does_not_come_back);
    port_exit(UNITY_END() > 0);
    return 0;
}
