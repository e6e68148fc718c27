/* One mote's side of `token`, event by event. Whole networks: tests/network. An instant each 5,000. */
#include "motehound/bytes.h"
#include "motehound/geographic.h"
#include "motehound/token.h"
#include "port.h"
#include "unity.h"

#include <string.h>

enum {
    NODE = 10,
    KEEPER = 20,
    NEXT = 30,
    OTHER = 40,
    SINK = 1,
    AHEAD = 777 /* of the mote's own clock */,
    FRAMES = 64
};

#define T 5000u
#define W 1000u
#define FIRST 10000u /* the first instant of a search that begins by itself */

static struct {
    unsigned sent, settled, of_kind[MH_MESSAGE_KINDS];
    uint8_t kinds[FRAMES];
    mh_node_id destinations[FRAMES];
    struct mh_message message, token, leak; /* the last one sent, and the last of these kinds */
    mh_tick timer;
    unsigned sensed, leads, follows, told, delivered, scored;
    size_t track, places;
    uint8_t first_byte;
    mh_node_id best; /* by the tracker's score; MH_BROADCAST: all alike */
    bool knows_time, scores;
    enum mh_status lead_status;
    size_t saves;
    struct mh_estimate expected, estimate; /* estimate: told */
    mh_node_id silent;                     /* acknowledges nothing */
    struct mh_place first_place;
} saw;

static void send(void *context, mh_node_id destination, const struct mh_message *message)
{
    (void)context;
    saw.kinds[saw.sent % FRAMES] = (uint8_t)message->kind;
    saw.destinations[saw.sent % FRAMES] = destination;
    saw.sent++;
    saw.of_kind[message->kind]++;
    saw.message = *message;
    saw.token = message->kind == MH_MESSAGE_TOKEN ? *message : saw.token;
    saw.leak = message->kind == MH_MESSAGE_LEAK ? *message : saw.leak;
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
    TEST_ASSERT_TRUE(needed);
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
    (void)time;
    saw.sensed++;
}

static enum mh_status lead(void *context, mh_tick now, const uint8_t *track, size_t length)
{
    (void)context;
    (void)now;
    saw.leads += saw.lead_status == MH_OK;
    saw.track = length;
    saw.first_byte = length > 0 ? track[0] : 0;
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
    memset(track, 7, saw.saves);
    *length = saw.saves;
    return saw.saves > 0 ? MH_OK : MH_NONE;
}

static enum mh_status expect(void *context, mh_tick time, struct mh_estimate *estimate)
{
    (void)context;
    *estimate = saw.expected;
    estimate->time = time;
    return MH_OK;
}

static enum mh_status score(void *context, mh_node_id candidate, const struct mh_place *places, size_t count,
                            mh_real *value)
{
    (void)context;
    saw.scored++;
    if (candidate == NEXT) {
        saw.places = count;
        saw.first_place = places[0];
    }
    *value = candidate == saw.best ? 2 : 1;
    return saw.scores ? MH_OK : MH_NONE;
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
                                             .score = score,
                                             .tell = tell};
static const struct mh_protocol *const token = &mh_protocol_token;
static struct mh_token_config config;
static struct mh_protocol_node node;
static struct mh_token_node state;

static void come_up(mh_node_id id)
{
    const struct mh_protocol_node plain = {.id = id, .place = {20000, 0, 0}, .is_head = id != SINK, .port = &port};
    memset(&saw, 0, sizeof saw);
    saw.knows_time = saw.scores = true;
    saw.best = saw.silent = MH_BROADCAST;
    saw.saves = 36;
    node = plain;
    TEST_ASSERT_EQUAL(MH_OK, token->init(&state, &config, &node));
    token->start(&state, AHEAD + 10);
}

void setUp(void)
{
    const struct mh_place sink = {0, 0, 0};
    mh_token_config_default(&config, SINK, &sink);
    config.start = OTHER;
    come_up(NODE);
}

void tearDown(void) {}

/* What was sent has gone out, and what follows from that. */
static void settle(mh_tick time)
{
    for (; saw.settled < saw.sent; saw.settled++) {
        const mh_node_id to = saw.destinations[saw.settled % FRAMES];
        TEST_ASSERT_TRUE(saw.sent - saw.settled <= FRAMES);
        token->sent(&state, AHEAD + time, to == saw.silent ? MH_SENT_NO_ACK : MH_SENT_OK);
    }
}

static void hear(mh_tick time, const struct mh_message *message)
{
    token->message(&state, AHEAD + time, message);
    settle(time);
}

/* All timers that are due until `time`, which has come then. */
static void pass(mh_tick time)
{
    for (unsigned i = 0; i < 2000 && !mh_tick_before(time, saw.timer); i++) {
        const mh_tick due = saw.timer;
        token->timer(&state, AHEAD + due);
        settle(due);
    }
    token->timer(&state, AHEAD + time);
    settle(time);
}

static void hear_hello(mh_tick time, mh_node_id id, int32_t x_mm)
{
    const struct mh_message message = {.kind = MH_MESSAGE_HELLO,
                                       .as.hello = {.sender = (int32_t)id, .x_mm = x_mm, .sequence = 9}};
    hear(time, &message);
}

static void hear_ask(mh_tick time, mh_tick instant, mh_node_id head, int32_t generation)
{
    const struct mh_message message = {.kind = MH_MESSAGE_ASK,
                                       .as.ask = {.sender = (int32_t)head,
                                                  .track = SINK,
                                                  .generation = generation,
                                                  .time_ms = (int32_t)instant,
                                                  .everyone = 1}};
    hear(time, &message);
}

static void envelop(struct mh_message *message, mh_node_id from, mh_node_id to)
{
    static int16_t number;
    mh_geographic_address(message, from, ++number, to, &node.place);
}

static void hear_token(mh_tick time, mh_node_id holder, int32_t generation, uint8_t how)
{
    struct mh_message message = {
        .kind = MH_MESSAGE_TOKEN,
        .as.token = {.sender = NEXT, .track = SINK, .generation = generation, .holder = (int32_t)holder, .state = how}};
    envelop(&message, NEXT, node.id);
    hear(time, &message);
}

static void measure(mh_tick time)
{
    const struct mh_measurement measurement = {.node = node.id, .place = node.place, .time = time, .value = 5};
    TEST_ASSERT_EQUAL(MH_OK, token->publish(&state, AHEAD + time, &measurement));
}

/* A part of a token of so many bytes, which say so many heads and calm ones. */
static struct mh_message part_of(size_t length, uint8_t part, mh_tick instant, int32_t generation, uint8_t heads,
                                 uint8_t calm)
{
    uint8_t bytes[MH_TOKEN_CARRIED_MAX] = {heads, calm, 99};
    struct mh_message message = {
        .kind = MH_MESSAGE_HAND_OVER,
        .as.hand_over = {.track = SINK, .generation = generation, .time_ms = (int32_t)instant}};
    mh_parcel_cut(bytes, length, part, &message.as.hand_over);
    envelop(&message, KEEPER, NODE);
    return message;
}

static void hand_over(mh_tick time, int32_t generation, uint8_t heads, uint8_t calm)
{
    const struct mh_message part = part_of(38, 0, time / T * T, generation, heads, calm);
    hear(time, &part);
}

/* The mote has become head by generation 5. Neighbours: NEXT at 60 m, OTHER at 25 m, KEEPER at 10 m, the sink. */
static void be_head_of(mh_tick time, uint8_t heads, uint8_t calm)
{
    pass(time);
    hear_hello(time, KEEPER, 10000);
    hear_hello(time, NEXT, 60000);
    hear_hello(time, OTHER, 25000);
    hear_hello(time, SINK, 0);
    hand_over(time, 5, heads, calm);
    TEST_ASSERT_EQUAL(1, saw.leads);
    TEST_ASSERT_EQUAL(MH_TOKEN_HEAD, state.role);
    saw.best = NEXT;
}

static void be_head(mh_tick time) { be_head_of(time, 2, 0); }

static void close_instant(mh_tick instant, uint8_t flags)
{
    struct mh_estimate estimate = {
        .time = instant, .position = {30, 5}, .rate = 2.5f, .covariance = {4, 1, 9}, .states = 3, .flags = flags};
    estimate.covariance_more[0] = 0.5f;
    estimate.covariance_more[2] = 2;
    pass(instant + W);
    token->closed(&state, AHEAD + instant + W, instant, &estimate, NULL, 0);
    settle(instant + W);
}

static void bad_configurations_are_refused(void)
{
    const struct mh_token_config good = config;
    for (uint8_t i = 0; i < 11; i++) {
        config = good;
        config.link.attempts = i == 0 ? 0 : config.link.attempts;
        config.sink = i == 1 ? MH_BROADCAST : config.sink;
        config.range_mm = i == 2 ? 0 : config.range_mm;
        config.interval = i == 3 ? 499 : config.interval;
        config.window = i == 4 ? T / 2 + 1 : i == 5 ? 99 : config.window;
        config.hello_period = i == 6 ? 9999 : config.hello_period;
        config.calm = i == 7 ? 0 : config.calm;
        config.heads_max = i == 8 ? 0 : config.heads_max;
        config.patience = i == 9 ? 3 : config.patience;
        config.start_place.x_mm = i == 10 ? INT32_MAX : 0;
        TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, token->init(&state, &config, &node));
    }
    config = good;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, token->init(&state, NULL, &node));
}

/* ---- neighbours ---- */

static void a_node_says_hello_and_whom_it_hears(void)
{
    hear_hello(20, SINK, 0);
    for (mh_node_id id = 100; id < 109; id++) {
        hear_hello(20, id, 1000 * (int32_t)id);
    }
    pass(MH_TOKEN_START);
    TEST_ASSERT_EQUAL(5, saw.of_kind[MH_MESSAGE_HELLO]);
    TEST_ASSERT_EQUAL(
        4, saw.of_kind[MH_MESSAGE_VICINITY]); /* after the last two; nine neighbours take two lists; the sink is none */
    TEST_ASSERT_EQUAL(MH_MESSAGE_VICINITY, saw.message.kind);
    TEST_ASSERT_EQUAL(3, saw.message.as.vicinity.count);
    TEST_ASSERT_EQUAL_INT32(108, saw.message.as.vicinity.id[2]);
    TEST_ASSERT_EQUAL_INT32(108000, saw.message.as.vicinity.x_mm[2]);
    TEST_ASSERT_EQUAL_INT32(-1, saw.message.as.vicinity.id[3]);
    pass(config.hello_period + MH_TOKEN_START);
    TEST_ASSERT_EQUAL(6, saw.of_kind[MH_MESSAGE_HELLO]);
    TEST_ASSERT_EQUAL(6, saw.of_kind[MH_MESSAGE_VICINITY]);
}

static void hear_newcomer(mh_tick time)
{
    const struct mh_message message = {.kind = MH_MESSAGE_HELLO, .as.hello = {.sender = NEXT, .x_mm = 60000}};
    hear(time, &message);
}

static void who_hears_a_node_begin_anew_says_hello(void)
{
    pass(30000);
    hear_newcomer(30000);
    hear_newcomer(30100);
    pass(35000);
    TEST_ASSERT_EQUAL(6, saw.of_kind[MH_MESSAGE_HELLO]);
    hear_newcomer(35100); /* many restart: a hello in a pause, no more */
    pass(40000);
    TEST_ASSERT_EQUAL(6, saw.of_kind[MH_MESSAGE_HELLO]);
    pass(51000);
    TEST_ASSERT_EQUAL(7, saw.of_kind[MH_MESSAGE_HELLO]);
}

/* ---- to begin ---- */

static void who_is_to_begin_does(void)
{
    come_up(OTHER);
    pass(FIRST - 1);
    TEST_ASSERT_EQUAL(1, saw.leads);
    TEST_ASSERT_EQUAL(0, saw.track);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_ASK]);
    saw.expected.origin.x_mm = 40000;
    pass(FIRST);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ASK]);
    TEST_ASSERT_EQUAL(1, saw.sensed);
    TEST_ASSERT_EQUAL_INT32(SINK, saw.message.as.ask.track);
    TEST_ASSERT_EQUAL_INT32(1, saw.message.as.ask.generation);
    TEST_ASSERT_EQUAL_INT32(FIRST, saw.message.as.ask.time_ms);
    TEST_ASSERT_EQUAL_INT32(40000, saw.message.as.ask.x_mm);
    TEST_ASSERT_EQUAL(1, state.events.begun);
}

static void nobody_begins_a_search_that_goes_on(void)
{
    pass(FIRST);
    TEST_ASSERT_EQUAL(0, saw.leads); /* another is to begin */
    come_up(OTHER);
    hear_ask(5010, 5000, NEXT, 7);
    pass(FIRST);
    TEST_ASSERT_EQUAL(0, saw.leads);
}

static void who_restarts_does_not_begin_again(void)
{
    come_up(OTHER);
    const struct mh_message as_new = {.kind = MH_MESSAGE_HELLO, .as.hello = {.sender = NEXT, .sequence = 4}};
    hear(5000, &as_new);
    pass(FIRST);
    TEST_ASSERT_EQUAL(1, saw.leads);
    come_up(OTHER);
    hear_hello(5000, NEXT, 60000); /* which has said nine before */
    pass(FIRST);
    TEST_ASSERT_EQUAL(0, saw.leads);
    hear_token(FIRST, MH_BROADCAST, 0, MH_SEARCH_GOES_ON); /* unless it is sent for */
    TEST_ASSERT_EQUAL(1, saw.leads);
}

static void who_is_sent_for_begins(void)
{
    pass(FIRST);
    hear_token(FIRST, MH_BROADCAST, 0, MH_SEARCH_GOES_ON);
    TEST_ASSERT_EQUAL(1, saw.leads);
    hear_token(FIRST, MH_BROADCAST, 0, MH_SEARCH_GOES_ON);
    TEST_ASSERT_EQUAL(1, saw.leads);
    setUp();
    hear_ask(FIRST, FIRST, NEXT, 7); /* there is one */
    hear_token(FIRST + 10, MH_BROADCAST, 0, MH_SEARCH_GOES_ON);
    TEST_ASSERT_EQUAL(0, saw.leads);
    hear_token(FIRST + 4 * T, MH_BROADCAST, 0, MH_SEARCH_GOES_ON); /* there was one */
    TEST_ASSERT_EQUAL(1, saw.leads);
}

/* ---- asked ---- */

static void who_is_asked_answers_once(void)
{
    pass(FIRST);
    hear_ask(FIRST + 5, FIRST, NEXT, 3);
    TEST_ASSERT_EQUAL(1, saw.sensed);
    measure(FIRST + 6);
    pass(FIRST + 5 * W / 9);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ANSWER]);
    TEST_ASSERT_EQUAL(NEXT, saw.destinations[(saw.sent - 1) % FRAMES]);
    TEST_ASSERT_EQUAL_INT32(5, saw.message.as.answer.value_q20);
    hear_ask(FIRST + 5 * W / 9, FIRST, NEXT, 3);
    pass(FIRST + W);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ANSWER]);
    TEST_ASSERT_EQUAL(1, saw.sensed);
}

static void a_sample_taken_before_is_answered_too(void)
{
    pass(FIRST);
    measure(FIRST);
    hear_ask(FIRST + 5, FIRST, NEXT, 3);
    pass(FIRST + W);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ANSWER]);
    measure(FIRST + T); /* of an instant that nobody asked for */
    hear_ask(FIRST + 2 * T, FIRST + 2 * T, NEXT, 4);
    pass(FIRST + 2 * T + W);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ANSWER]);
}

static void who_missed_the_first_ask_answers_the_second_in_time(void)
{
    const mh_tick again = FIRST + 5 * W / 9;
    pass(again);
    hear_ask(again, FIRST, NEXT, 3);
    measure(again + 1);
    pass(FIRST + W - 100);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ANSWER]);
}

static void absurd_asks_are_counted(void)
{
    pass(4 * T);
    hear_ask(4 * T, 2 * T, NEXT, 3); /* old */
    hear_ask(4 * T, 6 * T, NEXT, 3); /* of the future */
    struct mh_message message = {.kind = MH_MESSAGE_ASK,
                                 .as.ask = {.sender = NEXT, .track = 77, .generation = 1, .time_ms = 4 * T}};
    hear(4 * T, &message); /* another sink's */
    TEST_ASSERT_EQUAL(3, state.events.corrupt);
    TEST_ASSERT_EQUAL(0, saw.sensed);
    TEST_ASSERT_FALSE(state.knows);
}

/* ---- two tokens ---- */

static void an_outranked_head_is_told_so(void)
{
    pass(FIRST);
    hear_ask(FIRST, FIRST, OTHER, 9);
    TEST_ASSERT_EQUAL(1, saw.sensed);
    hear_ask(FIRST + 20, FIRST, NEXT, 8);
    TEST_ASSERT_EQUAL(1, saw.sensed);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_TOKEN]);
    TEST_ASSERT_EQUAL_INT32(NEXT, saw.token.header.route.destination);
    TEST_ASSERT_EQUAL_INT32(OTHER, saw.token.as.token.holder);
    TEST_ASSERT_EQUAL_INT32(9, saw.token.as.token.generation);
    hear_ask(FIRST + 30, FIRST, OTHER + 1, 9); /* of equal generations the lower identifier */
    TEST_ASSERT_EQUAL(1, saw.sensed);
    hear_ask(FIRST + 4 * T, FIRST + 4 * T, OTHER, 8); /* what was better is silent */
    TEST_ASSERT_EQUAL(2, saw.sensed);
}

static void of_two_heads_the_higher_generation_goes_on(void)
{
    be_head(FIRST - 100);
    pass(FIRST);
    hear_ask(FIRST + 5, FIRST, OTHER, 4); /* let it know */
    TEST_ASSERT_EQUAL(MH_TOKEN_HEAD, state.role);
    TEST_ASSERT_EQUAL_INT32(NODE, saw.token.as.token.holder);
    TEST_ASSERT_EQUAL_INT32(OTHER, saw.token.header.route.destination);
    hear_ask(FIRST + 6, FIRST, OTHER, 6); /* give way, and tell who keeps this one's token */
    TEST_ASSERT_EQUAL(MH_TOKEN_NODE, state.role);
    TEST_ASSERT_EQUAL(1, saw.follows);
    TEST_ASSERT_EQUAL(1, state.events.yielded);
    TEST_ASSERT_EQUAL_INT32(KEEPER, saw.token.header.route.destination);
    TEST_ASSERT_EQUAL_INT32(OTHER, saw.token.as.token.holder);
    TEST_ASSERT_EQUAL_INT32(6, saw.token.as.token.generation);
    measure(FIRST + 7);
    pass(FIRST + W);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ANSWER]); /* and is a neighbour as any */
}

static void who_is_told_of_a_better_token_gives_way(void)
{
    be_head(FIRST - 100);
    hear_token(FIRST, OTHER, 5, MH_SEARCH_GOES_ON); /* of equal ones the lower identifier goes on */
    TEST_ASSERT_EQUAL(MH_TOKEN_HEAD, state.role);
    hear_token(FIRST, NEXT, 6, MH_SEARCH_CONVERGED);
    TEST_ASSERT_EQUAL(MH_TOKEN_NODE, state.role);
}

/* ---- head ---- */

static void answer(mh_tick time, mh_node_id from)
{
    struct mh_message message = {.kind = MH_MESSAGE_ANSWER,
                                 .as.answer = {.sender = (int32_t)from, .time_ms = (int32_t)time}};
    envelop(&message, from, NODE);
    hear(time, &message);
}

static void who_has_not_answered_is_asked_once_more(void)
{
    be_head(FIRST - 100);
    pass(FIRST);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ASK]);
    answer(FIRST + 50, OTHER);
    answer(FIRST + 60, 999); /* no neighbour that is known */
    TEST_ASSERT_EQUAL(2, saw.delivered);
    pass(FIRST + W - 1);
    TEST_ASSERT_EQUAL(3, saw.of_kind[MH_MESSAGE_ASK]); /* KEEPER and NEXT, not the sink */
    unsigned to_keeper = 0, to_next = 0;
    for (unsigned i = 0; i < FRAMES; i++) {
        to_keeper += saw.kinds[i] == MH_MESSAGE_ASK && saw.destinations[i] == KEEPER;
        to_next += saw.kinds[i] == MH_MESSAGE_ASK && saw.destinations[i] == NEXT;
    }
    TEST_ASSERT_EQUAL(1, to_keeper);
    TEST_ASSERT_EQUAL(1, to_next);
}

static void the_token_goes_to_the_best_in_parts(void)
{
    const struct mh_message list = {
        .kind = MH_MESSAGE_VICINITY,
        .as.vicinity = {.sender = NEXT, .count = 2, .id = {50, 51, -1}, .x_mm = {140000, 140001}}};
    saw.saves = 36;
    be_head(FIRST - 100);
    hear(FIRST - 50, &list);
    saw.saves = 2 * MH_HAND_OVER_BYTES - 2; /* three bytes would be one too many */
    TEST_ASSERT_TRUE(saw.saves <= MH_TRACK_BYTES_MAX);
    close_instant(FIRST, 0);
    TEST_ASSERT_EQUAL(3, saw.scored);
    TEST_ASSERT_EQUAL(5, saw.places); /* NEXT itself, this node, KEEPER, OTHER, 50; 51 is a millimetre too far */
    TEST_ASSERT_EQUAL_INT32(60000, saw.first_place.x_mm);
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_HAND_OVER]);
    TEST_ASSERT_EQUAL(1, state.events.handed);
    TEST_ASSERT_EQUAL(1, saw.follows);
    TEST_ASSERT_EQUAL(MH_TOKEN_NODE, state.role);
    TEST_ASSERT_EQUAL_UINT8(3, state.carried[0]);
    TEST_ASSERT_EQUAL_INT32(6, state.next.generation);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_TOKEN]); /* who kept it until now need not */
    TEST_ASSERT_EQUAL_INT32(KEEPER, saw.token.header.route.destination);
    TEST_ASSERT_EQUAL_INT32(NEXT, saw.token.as.token.holder);
}

static void what_is_found_goes_to_the_sink(void)
{
    be_head(FIRST - 100);
    close_instant(FIRST, 0);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_LEAK]);
    const mh_leak_t *leak = &saw.leak.as.leak;
    TEST_ASSERT_EQUAL_INT32(SINK, saw.leak.header.route.destination);
    TEST_ASSERT_EQUAL_INT32(30000, leak->x_mm);
    TEST_ASSERT_EQUAL_INT32(5000, leak->y_mm);
    TEST_ASSERT_EQUAL_INT32(20000, leak->head_x_mm);
    TEST_ASSERT_EQUAL_UINT8(3, leak->heads);
    TEST_ASSERT_EQUAL_UINT8(MH_SEARCH_GOES_ON, leak->state);
    const uint8_t *rate = leak->rate, *spread = leak->spread;
    const mh_real expected[6] = {4, 1, 9, 0.5f, 0, 2};
    TEST_ASSERT_TRUE(mh_get_real(&rate) == 2.5f);
    for (uint8_t i = 0; i < 6; i++) {
        TEST_ASSERT_TRUE(mh_get_real(&spread) == expected[i]);
    }
}

static void a_covariance_beyond_all_numbers_is_not_sent(void)
{
    static const uint8_t none[24] = {0};
    struct mh_estimate estimate = {.time = FIRST, .covariance = {4, 1, 9}, .states = 3};
    estimate.covariance_more[2] = (mh_real)INFINITY;
    be_head(FIRST - 100);
    pass(FIRST + W);
    token->closed(&state, AHEAD + FIRST + W, FIRST, &estimate, NULL, 0);
    settle(FIRST + W);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_LEAK]);
    TEST_ASSERT_EQUAL_MEMORY(none, saw.leak.as.leak.spread, sizeof none);
}

static void without_a_score_the_nearest_to_the_estimate_is_next(void)
{
    be_head(FIRST - 100);
    saw.scores = false;
    saw.expected.position.x = 26;
    close_instant(FIRST, 0);
    TEST_ASSERT_EQUAL_INT32(OTHER, state.next.holder);
}

static void of_equals_the_lowest_is_next(void)
{
    be_head(FIRST - 100);
    saw.best = MH_BROADCAST;
    close_instant(FIRST, 0);
    TEST_ASSERT_EQUAL_INT32(KEEPER, state.next.holder);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_TOKEN]); /* it knows by itself that its copy is needless */
}

static void a_dead_head_is_not_chosen(void)
{
    be_head(FIRST - 100);
    saw.silent = NEXT;
    close_instant(FIRST, 0);
    pass(FIRST + W + 500);
    TEST_ASSERT_EQUAL(1, state.events.refused);
    TEST_ASSERT_EQUAL_INT32(KEEPER, state.next.holder); /* the next best, by identifier */
    TEST_ASSERT_EQUAL_INT32(7, state.next.generation);
    TEST_ASSERT_EQUAL(MH_TOKEN_ATTEMPTS + 1, saw.of_kind[MH_MESSAGE_HAND_OVER]);
    TEST_ASSERT_EQUAL(MH_TOKEN_NODE, state.role);
}

static void a_head_without_neighbours_stays(void)
{
    pass(FIRST - 100);
    hand_over(FIRST - 100, 5, 2, 0);
    close_instant(FIRST, 0);
    TEST_ASSERT_EQUAL(MH_TOKEN_HEAD, state.role);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_HAND_OVER]);
    pass(FIRST + T);
    TEST_ASSERT_EQUAL(2, saw.of_kind[MH_MESSAGE_ASK]);
    TEST_ASSERT_TRUE(saw.message.as.ask.generation > 5);
    close_instant(FIRST + T, 0);
    TEST_ASSERT_EQUAL_UINT8(4, state.heads);
}

static void a_head_that_finds_nobody_in_time_stays(void)
{
    be_head(FIRST - 100);
    pass(FIRST + W);
    struct mh_estimate estimate = {.time = FIRST};
    token->closed(&state, AHEAD + FIRST + W, FIRST, &estimate, NULL, 0);
    /* the radio tells nothing of what became of the first part */
    token->timer(&state, AHEAD + FIRST + T / 8 * 7);
    TEST_ASSERT_FALSE(state.handing);
    TEST_ASSERT_EQUAL(MH_TOKEN_HEAD, state.role);
    TEST_ASSERT_EQUAL_INT32(7, state.of.generation); /* above what was offered */
}

static void without_an_estimate_the_head_stays(void)
{
    struct mh_estimate nowhere = {.position = {NAN, 0}};
    be_head(FIRST - 100);
    pass(FIRST + W);
    token->closed(&state, AHEAD + FIRST + W, FIRST, NULL, NULL, 0);
    pass(FIRST + T + W);
    token->closed(&state, AHEAD + FIRST + T + W, FIRST + T, &nowhere, NULL, 0);
    settle(FIRST + T + W);
    TEST_ASSERT_EQUAL(MH_TOKEN_HEAD, state.role);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_LEAK]);
    TEST_ASSERT_EQUAL(2, state.events.heads);
}

/* ---- the end ---- */

static void calm_heads_in_succession_end_the_search(void)
{
    be_head_of(FIRST - 100, 2, 2);
    close_instant(FIRST, MH_ESTIMATE_CALM);
    TEST_ASSERT_EQUAL(MH_TOKEN_NODE, state.role);
    TEST_ASSERT_EQUAL(1, state.events.converged);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_HAND_OVER]);
    TEST_ASSERT_EQUAL_UINT8(MH_SEARCH_CONVERGED, saw.leak.as.leak.state);
    TEST_ASSERT_EQUAL_INT32(KEEPER, saw.token.header.route.destination);
    TEST_ASSERT_EQUAL_UINT8(MH_SEARCH_CONVERGED, saw.token.as.token.state);
    pass(FIRST + 10 * T);
    TEST_ASSERT_EQUAL(MH_TOKEN_REPORTS, saw.of_kind[MH_MESSAGE_LEAK]);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ASK] - 3); /* at one instant only: all, and three alone */
}

static void a_calm_head_between_others_ends_nothing(void)
{
    be_head_of(FIRST - 100, 2, 2);
    close_instant(FIRST, 0);
    TEST_ASSERT_EQUAL_UINT8(0, state.carried[1]);
    setUp();
    be_head_of(FIRST - 100, 2, 1);
    close_instant(FIRST, MH_ESTIMATE_CALM);
    TEST_ASSERT_EQUAL_UINT8(2, state.carried[1]);
}

static void so_many_heads_end_the_search(void)
{
    be_head_of(FIRST - 100, 59, 0);
    close_instant(FIRST, 0);
    TEST_ASSERT_EQUAL(MH_TOKEN_NODE, state.role);
    TEST_ASSERT_EQUAL(1, state.events.exhausted);
    TEST_ASSERT_EQUAL_UINT8(MH_SEARCH_EXHAUSTED, saw.leak.as.leak.state);
    TEST_ASSERT_EQUAL_UINT8(60, saw.leak.as.leak.heads);
}

/* ---- a token comes ---- */

static void parts_come_twice_and_in_any_order(void)
{
    pass(FIRST);
    const struct mh_message second = part_of(100, 1, FIRST, 5, 7, 1), again = part_of(100, 1, FIRST, 5, 7, 1),
                            first = part_of(100, 0, FIRST, 5, 7, 1);
    hear(FIRST, &second);
    hear(FIRST, &second); /* the very same */
    hear(FIRST, &again);
    TEST_ASSERT_EQUAL(0, saw.leads);
    hear(FIRST, &first);
    TEST_ASSERT_EQUAL(1, saw.leads);
    TEST_ASSERT_EQUAL(98, saw.track);
    TEST_ASSERT_EQUAL_UINT8(99, saw.first_byte);
    TEST_ASSERT_EQUAL_UINT8(7, state.heads);
    TEST_ASSERT_EQUAL_UINT8(1, state.calm);
    hear(FIRST, &second);
    hear(FIRST, &first);
    TEST_ASSERT_EQUAL(1, saw.leads);
    pass(FIRST + T);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_ASK]);
}

static void absurd_tokens_are_counted(void)
{
    pass(FIRST);
    hand_over(FIRST, 5, config.heads_max, 0);
    hand_over(FIRST, 5, 0, config.calm);
    struct mh_message part = part_of(2, 0, FIRST, 5, 0, 0); /* no track */
    hear(FIRST, &part);
    part = part_of(38, 0, FIRST - 3 * T, 5, 0, 0); /* old */
    hear(FIRST, &part);
    part = part_of(38, 0, FIRST, 5, 0, 0);
    part.as.hand_over.track = 99; /* another sink's */
    hear(FIRST, &part);
    part = part_of(38, 0, FIRST, 5, 0, 0);
    part.as.hand_over.parts = MH_PARCEL_PARTS_MAX + 2;
    part.as.hand_over.part = MH_PARCEL_PARTS_MAX + 1;
    envelop(&part, KEEPER, NODE);
    hear(FIRST, &part);
    saw.lead_status = MH_ERR_CORRUPT; /* the tracker does not load it */
    hand_over(FIRST, 5, 0, 0);
    TEST_ASSERT_EQUAL(7, state.events.corrupt);
    TEST_ASSERT_EQUAL(0, saw.leads);
    TEST_ASSERT_EQUAL(MH_TOKEN_NODE, state.role);
    saw.lead_status = MH_OK;
    hand_over(FIRST, 5, 0, 0);
    TEST_ASSERT_EQUAL(MH_TOKEN_HEAD, state.role);
}

static void an_outranked_token_is_not_taken(void)
{
    pass(FIRST);
    hear_ask(FIRST, FIRST, OTHER, 6);
    hand_over(FIRST + 10, 5, 0, 0);
    TEST_ASSERT_EQUAL(0, saw.leads);
    hand_over(FIRST + 20, 7, 0, 0);
    TEST_ASSERT_EQUAL(1, saw.leads);
    hand_over(FIRST + 30, 9, 4, 0); /* a better one, though this leads */
    TEST_ASSERT_EQUAL(2, saw.leads);
    TEST_ASSERT_EQUAL_UINT8(4, state.heads);
    TEST_ASSERT_EQUAL(MH_TOKEN_HEAD, state.role);
}

/* ---- a token is kept ---- */

static void who_handed_over_to_the_dead_leads_again(void)
{
    be_head(FIRST - 100);
    close_instant(FIRST, 0);
    TEST_ASSERT_TRUE(state.guarding);
    pass(FIRST + T + W - 1);
    TEST_ASSERT_EQUAL(1, saw.leads);
    pass(FIRST + T + W);
    TEST_ASSERT_EQUAL(2, saw.leads);
    TEST_ASSERT_EQUAL(36, saw.track);
    TEST_ASSERT_EQUAL(1, state.events.resumed);
    TEST_ASSERT_EQUAL_UINT8(3, state.heads);
    close_instant(FIRST + 2 * T, 0);
    TEST_ASSERT_EQUAL_INT32(KEEPER, state.next.holder); /* not NEXT again */
    TEST_ASSERT_TRUE(state.next.generation > 7);
}

static void who_hears_its_successor_waits_for_it_to_hand_on(void)
{
    be_head(FIRST - 100);
    close_instant(FIRST, 0);
    hear_ask(FIRST + T + 5, FIRST + T, NEXT, 6);
    pass(FIRST + 2 * T + W - 1);
    TEST_ASSERT_EQUAL(1, saw.leads);
    hear_ask(FIRST + 2 * T + W - 1, FIRST + 2 * T, NEXT, 8); /* it stays */
    pass(FIRST + 3 * T + W - 1);
    TEST_ASSERT_EQUAL(1, saw.leads);
    pass(FIRST + 3 * T + W); /* and falls silent */
    TEST_ASSERT_EQUAL(2, saw.leads);
    TEST_ASSERT_TRUE(state.of.generation > 8);
}

static void who_hears_that_the_token_has_gone_on_needs_no_copy(void)
{
    be_head(FIRST - 100);
    close_instant(FIRST, 0);
    hear_token(FIRST + T + W, OTHER, 7, MH_SEARCH_GOES_ON);
    TEST_ASSERT_FALSE(state.guarding);
    pass(FIRST + 6 * T);
    TEST_ASSERT_EQUAL(1, saw.leads);
    setUp();
    be_head(FIRST - 100);
    close_instant(FIRST, 0);
    hear_token(FIRST + T + W, NEXT, 6, MH_SEARCH_CONVERGED); /* or has found what it sought */
    pass(FIRST + 6 * T);
    TEST_ASSERT_EQUAL(1, saw.leads);
    setUp();
    be_head(FIRST - 100);
    close_instant(FIRST, 0);
    hear_token(FIRST + T, OTHER, 4, MH_SEARCH_GOES_ON); /* an old one does not count */
    TEST_ASSERT_TRUE(state.guarding);
}

static void the_token_may_come_back(void)
{
    be_head(FIRST - 100);
    close_instant(FIRST, 0);
    hand_over(FIRST + T + W, 7, 4, 0);
    TEST_ASSERT_EQUAL(2, saw.leads);
    TEST_ASSERT_FALSE(state.guarding);
    pass(FIRST + 2 * T + W);
    TEST_ASSERT_EQUAL(0, state.events.resumed);
}

/* ---- the sink ---- */

static struct mh_message leak_of(mh_node_id head, int32_t generation, mh_tick time, uint8_t how)
{
    struct mh_message message = {.kind = MH_MESSAGE_LEAK,
                                 .as.leak = {.track = SINK,
                                             .generation = generation,
                                             .time_ms = (int32_t)time,
                                             .head_x_mm = 70000,
                                             .x_mm = 30000,
                                             .y_mm = 5000,
                                             .heads = 3,
                                             .state = how}};
    const mh_real spread[6] = {4, 1, 9, 0.5f, 0, 2};
    uint8_t *rate = message.as.leak.rate, *at = message.as.leak.spread;
    mh_put_real(&rate, 2.5f);
    for (uint8_t i = 0; i < 6; i++) {
        mh_put_real(&at, spread[i]);
    }
    envelop(&message, head, SINK);
    return message;
}

static void hear_leak(mh_tick time, mh_node_id head, int32_t generation, mh_tick instant, uint8_t how)
{
    const struct mh_message message = leak_of(head, generation, instant, how);
    hear(time, &message);
}

static void be_sink(void)
{
    come_up(SINK);
    hear_hello(20, NEXT, 60000);
    hear_hello(20, OTHER, 25000);
    pass(FIRST);
}

static void the_sink_tells_what_it_is_told(void)
{
    be_sink();
    hear_leak(FIRST + W, NEXT, 4, FIRST, MH_SEARCH_GOES_ON);
    TEST_ASSERT_EQUAL(1, saw.told);
    TEST_ASSERT_EQUAL_INT32(30000, saw.estimate.origin.x_mm);
    TEST_ASSERT_TRUE(saw.estimate.rate == 2.5f);
    TEST_ASSERT_EQUAL_UINT8(3, saw.estimate.states);
    TEST_ASSERT_TRUE(saw.estimate.covariance.yy == 9 && saw.estimate.covariance_more[0] == 0.5f &&
                     saw.estimate.covariance_more[2] == 2);
    TEST_ASSERT_EQUAL_UINT32(FIRST, saw.estimate.time);
    hear_leak(FIRST + T + W, OTHER, 5, FIRST + T, MH_SEARCH_CONVERGED);
    TEST_ASSERT_EQUAL(2, saw.told);
    TEST_ASSERT_TRUE(saw.estimate.flags & MH_ESTIMATE_CALM);
    hear_leak(FIRST + 2 * T, OTHER, 5, FIRST + T, MH_SEARCH_CONVERGED); /* the end is reported more than once */
    TEST_ASSERT_EQUAL(2, saw.told);
    pass(FIRST + 100 * T);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_TOKEN]); /* it is over: nobody is sent for */
}

static void absurd_reports_are_counted(void)
{
    be_sink();
    struct mh_message bad = leak_of(NEXT, 4, FIRST, MH_SEARCH_GOES_ON);
    bad.as.leak.spread[0] = 0xC0; /* a negative variance */
    hear(FIRST, &bad);
    bad = leak_of(NEXT, 4, FIRST, MH_SEARCH_GOES_ON);
    bad.as.leak.spread[5] = 0xFF; /* more covariance than variance */
    bad.as.leak.spread[4] = 0x41;
    hear(FIRST, &bad);
    bad = leak_of(NEXT, 4, FIRST + T, MH_SEARCH_GOES_ON); /* of the future */
    hear(FIRST, &bad);
    bad = leak_of(NEXT, 4, FIRST, MH_SEARCH_GOES_ON);
    bad.as.leak.track = 99;
    hear(FIRST, &bad);
    TEST_ASSERT_EQUAL(4, state.events.corrupt);
    TEST_ASSERT_EQUAL(0, saw.told);
    struct mh_message plain = leak_of(NEXT, 4, FIRST, MH_SEARCH_GOES_ON);
    memset(plain.as.leak.spread, 0, sizeof plain.as.leak.spread); /* none stated is no error */
    hear(FIRST, &plain);
    TEST_ASSERT_EQUAL(1, saw.told);
    TEST_ASSERT_EQUAL_UINT8(0, saw.estimate.states);
}

static void the_sink_stops_a_second_search(void)
{
    be_sink();
    hear_leak(FIRST + W, NEXT, 8, FIRST, MH_SEARCH_GOES_ON);
    hear_leak(FIRST + T, OTHER, 7, FIRST - T, MH_SEARCH_GOES_ON); /* late, but of the same */
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_TOKEN]);
    hear_leak(FIRST + T + W, OTHER, 2, FIRST + T, MH_SEARCH_GOES_ON); /* another */
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_TOKEN]);
    TEST_ASSERT_EQUAL_INT32(OTHER, saw.token.header.route.destination);
    TEST_ASSERT_EQUAL_INT32(70000, saw.token.header.route.x_mm);
    TEST_ASSERT_EQUAL_INT32(NEXT, saw.token.as.token.holder);
    TEST_ASSERT_EQUAL(1, saw.told);
}

static void the_sink_sends_for_a_head_where_the_last_was(void)
{
    const mh_tick last = FIRST + W;
    be_sink();
    hear_leak(last, NEXT, 8, FIRST, MH_SEARCH_GOES_ON);
    pass(last + config.patience * T - 1);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_TOKEN]);
    pass(last + config.patience * T);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_TOKEN]);
    TEST_ASSERT_EQUAL_INT32(-1, saw.token.header.route.destination);
    TEST_ASSERT_EQUAL_INT32(-1, saw.token.as.token.holder);
    TEST_ASSERT_EQUAL_INT32(70000, saw.token.header.route.x_mm);
    pass(last + 100 * config.patience * T);
    TEST_ASSERT_EQUAL(MH_TOKEN_RESTARTS, saw.of_kind[MH_MESSAGE_TOKEN]);
    TEST_ASSERT_EQUAL(MH_TOKEN_RESTARTS, state.events.sent_for);
    hear_leak(saw.timer, OTHER, 1, saw.timer - 100, MH_SEARCH_GOES_ON); /* a search anew is as good as any */
    TEST_ASSERT_EQUAL(2, saw.told);
}

static void the_sink_may_begin_a_search(void)
{
    config.start = MH_BROADCAST;
    config.start_place.x_mm = 90000;
    be_sink();
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_TOKEN]);
    TEST_ASSERT_EQUAL_INT32(90000, saw.token.header.route.x_mm);
    TEST_ASSERT_EQUAL(NEXT, saw.destinations[(saw.sent - 1) % FRAMES]);
    config.start_place.x_mm = 21000; /* where it stands itself */
    be_sink();
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_TOKEN]);
    TEST_ASSERT_EQUAL(OTHER, saw.destinations[(saw.sent - 1) % FRAMES]);
    TEST_ASSERT_EQUAL_INT32(OTHER, saw.token.header.route.destination);
}

/* ---- others ---- */

static void reports_are_relayed(void)
{
    pass(FIRST);
    hear_hello(FIRST, SINK, 0);
    hear_hello(FIRST, NEXT, 60000);
    const struct mh_message message = leak_of(NEXT, 4, FIRST, MH_SEARCH_GOES_ON);
    hear(FIRST, &message);
    TEST_ASSERT_EQUAL(1, saw.of_kind[MH_MESSAGE_LEAK]);
    TEST_ASSERT_EQUAL(SINK, saw.destinations[(saw.sent - 1) % FRAMES]);
    TEST_ASSERT_EQUAL(0, state.events.corrupt);
}

static void a_jump_of_time_ends_what_was_known(void)
{
    be_head(FIRST - 100);
    token->time_jumped(&state, AHEAD + FIRST);
    TEST_ASSERT_EQUAL(MH_TOKEN_NODE, state.role);
    TEST_ASSERT_FALSE(state.knows);
    pass(FIRST + 2 * T);
    TEST_ASSERT_EQUAL(0, saw.of_kind[MH_MESSAGE_ASK]);
    saw.knows_time = false;
    token->time_jumped(&state, AHEAD + FIRST + 2 * T);
    const unsigned before = saw.sent;
    hear_ask(FIRST + 3 * T, FIRST + 3 * T, NEXT, 9);
    TEST_ASSERT_EQUAL(before, saw.sent);
}

static void what_happened_is_counted(void)
{
    struct mh_protocol_counters counters;
    memset(&counters, 0, sizeof counters);
    be_head(FIRST - 100);
    saw.silent = NEXT;
    close_instant(FIRST, 0);
    pass(FIRST + T + W);
    token->count(&state, &counters);
    TEST_ASSERT_EQUAL(1, counters.searches.heads);
    TEST_ASSERT_EQUAL(1, counters.searches.handed);
    TEST_ASSERT_EQUAL(1, counters.searches.refused);
    TEST_ASSERT_EQUAL(1, counters.searches.resumed); /* KEEPER, which took it, does not ask */
    TEST_ASSERT_EQUAL(0, counters.searches.corrupt);
}

/* Whatever comes, the state stays one that the protocol can be in. */
static void any_messages_are_borne(void)
{
    uint32_t random = 1;
    be_head(FIRST - 100);
    for (unsigned i = 0; i < 3000; i++) {
        static const enum mh_message_kind kinds[] = {MH_MESSAGE_HELLO,  MH_MESSAGE_VICINITY,  MH_MESSAGE_ASK,
                                                     MH_MESSAGE_ANSWER, MH_MESSAGE_HAND_OVER, MH_MESSAGE_TOKEN,
                                                     MH_MESSAGE_LEAK};
        const mh_tick time = FIRST + i * 37;
        struct mh_message message = {.kind = kinds[i % 7]};
        uint8_t *bytes = (uint8_t *)&message.as;
        for (unsigned k = 0; k < sizeof message.as; k++) {
            random = random * 1664525u + 1013904223u;
            bytes[k] = random >> 28 < 12 ? 0 : (uint8_t)(random >> 16);
        }
        switch (message.kind) { /* what wire.h guarantees, and some that are about now */
        case MH_MESSAGE_HELLO:
            message.as.hello.x_mm %= MH_COORDINATE_MAX_MM;
            message.as.hello.y_mm %= MH_COORDINATE_MAX_MM;
            break;
        case MH_MESSAGE_VICINITY:
            message.as.vicinity.count %= MH_VICINITY_NODES + 1;
            for (uint8_t k = 0; k < MH_VICINITY_NODES; k++) {
                message.as.vicinity.x_mm[k] %= MH_COORDINATE_MAX_MM;
                message.as.vicinity.y_mm[k] %= MH_COORDINATE_MAX_MM;
            }
            break;
        case MH_MESSAGE_ASK:
            message.as.ask.track = SINK;
            message.as.ask.time_ms = (int32_t)(time / T * T);
            break;
        case MH_MESSAGE_HAND_OVER:
            message.as.hand_over.track = SINK;
            message.as.hand_over.parts = (uint8_t)(random >> 30);
            message.as.hand_over.part = 0;
            message.as.hand_over.time_ms = (int32_t)(time / T * T);
            message.as.hand_over.length = MH_HAND_OVER_BYTES;
            break;
        case MH_MESSAGE_TOKEN:
            message.as.token.track = SINK;
            message.as.token.state %= 3;
            break;
        default:
            break;
        }
        if (message.kind != MH_MESSAGE_HELLO && message.kind != MH_MESSAGE_VICINITY && message.kind != MH_MESSAGE_ASK) {
            envelop(&message, NEXT, NODE);
        }
        pass(time);
        hear(time, &message);
        if (state.role == MH_TOKEN_HEAD && time % T > W && state.instant + T < time) {
            close_instant(time / T * T, 0);
        }
        TEST_ASSERT_EQUAL(saw.leads - saw.follows, state.role == MH_TOKEN_HEAD);
        TEST_ASSERT_FALSE(state.guarding && state.role == MH_TOKEN_HEAD);
        TEST_ASSERT_TRUE(state.vicinity.count <= MH_VICINITY_MAX && state.carried_length <= MH_TOKEN_CARRIED_MAX);
    }
    TEST_ASSERT_TRUE(saw.leads > 5);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bad_configurations_are_refused);
    RUN_TEST(a_node_says_hello_and_whom_it_hears);
    RUN_TEST(who_hears_a_node_begin_anew_says_hello);
    RUN_TEST(who_is_to_begin_does);
    RUN_TEST(nobody_begins_a_search_that_goes_on);
    RUN_TEST(who_restarts_does_not_begin_again);
    RUN_TEST(who_is_sent_for_begins);
    RUN_TEST(who_is_asked_answers_once);
    RUN_TEST(a_sample_taken_before_is_answered_too);
    RUN_TEST(who_missed_the_first_ask_answers_the_second_in_time);
    RUN_TEST(absurd_asks_are_counted);
    RUN_TEST(an_outranked_head_is_told_so);
    RUN_TEST(of_two_heads_the_higher_generation_goes_on);
    RUN_TEST(who_is_told_of_a_better_token_gives_way);
    RUN_TEST(who_has_not_answered_is_asked_once_more);
    RUN_TEST(the_token_goes_to_the_best_in_parts);
    RUN_TEST(what_is_found_goes_to_the_sink);
    RUN_TEST(a_covariance_beyond_all_numbers_is_not_sent);
    RUN_TEST(without_a_score_the_nearest_to_the_estimate_is_next);
    RUN_TEST(of_equals_the_lowest_is_next);
    RUN_TEST(a_dead_head_is_not_chosen);
    RUN_TEST(a_head_without_neighbours_stays);
    RUN_TEST(a_head_that_finds_nobody_in_time_stays);
    RUN_TEST(without_an_estimate_the_head_stays);
    RUN_TEST(calm_heads_in_succession_end_the_search);
    RUN_TEST(a_calm_head_between_others_ends_nothing);
    RUN_TEST(so_many_heads_end_the_search);
    RUN_TEST(parts_come_twice_and_in_any_order);
    RUN_TEST(absurd_tokens_are_counted);
    RUN_TEST(an_outranked_token_is_not_taken);
    RUN_TEST(who_handed_over_to_the_dead_leads_again);
    RUN_TEST(who_hears_its_successor_waits_for_it_to_hand_on);
    RUN_TEST(who_hears_that_the_token_has_gone_on_needs_no_copy);
    RUN_TEST(the_token_may_come_back);
    RUN_TEST(the_sink_tells_what_it_is_told);
    RUN_TEST(absurd_reports_are_counted);
    RUN_TEST(the_sink_stops_a_second_search);
    RUN_TEST(the_sink_sends_for_a_head_where_the_last_was);
    RUN_TEST(the_sink_may_begin_a_search);
    RUN_TEST(reports_are_relayed);
    RUN_TEST(a_jump_of_time_ends_what_was_known);
    RUN_TEST(what_happened_is_counted);
    RUN_TEST(any_messages_are_borne);
    port_exit(UNITY_END() > 0);
    return 0;
}
