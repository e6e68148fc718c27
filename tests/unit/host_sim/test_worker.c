/* The messages between a run and its workers, and a worker that is asked too early, too late, twice and nonsense. */
#include "bus/layout.h"
#include "engine/random.h"
#include "hosts/worker.h"
#include "port.h"
#include "reals.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

enum { SESSION = 77, WORKER = 5 };

static char error[300];
static struct worker_link link; /* the worker's, and the run's too: memq:// brings every message to all */
static struct worker *worker;
static const struct worker_config config = {.url = "memq://", .version = "1", .worker = WORKER, .lifeline = -1};

static int64_t session; /* that requests name */

static struct heard {
    unsigned joins, dones, totals, errors;
    int64_t number, next_us, session;
    int32_t actions, readings;
    char text[300];
} heard;

static void on_join(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    motehound_worker_join_t message;
    (void)channel;
    (void)context;
    TEST_ASSERT_TRUE(worker_decode_join(&link, buffer, &message));
    TEST_ASSERT_TRUE(message.worker == WORKER && strcmp(message.version, "1") == 0 &&
                     strcmp(message.arithmetic, arithmetic_name(MH_REAL_FIXED)) == 0);
    heard.session = message.session;
    heard.joins++;
    motehound_worker_join_t_decode_cleanup(&message);
}

static void on_done(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    motehound_worker_done_t message;
    (void)channel;
    (void)context;
    TEST_ASSERT_TRUE(worker_decode_done(&link, buffer, &message));
    heard.dones++;
    heard.number = message.number;
    heard.next_us = message.next_us;
    heard.actions = message.count;
    motehound_worker_done_t_decode_cleanup(&message);
}

static void on_totals(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    motehound_worker_totals_t message;
    (void)channel;
    (void)context;
    TEST_ASSERT_TRUE(worker_decode_totals(&link, buffer, &message));
    heard.totals++;
    heard.number = message.number;
    heard.readings = (int32_t)message.motes[offsetof(struct mh_mote_counters, readings) / sizeof(uint32_t)];
    motehound_worker_totals_t_decode_cleanup(&message);
}

static void on_error(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    motehound_worker_error_t message;
    (void)channel;
    (void)context;
    TEST_ASSERT_TRUE(worker_decode_error(&link, buffer, &message));
    heard.errors++;
    snprintf(heard.text, sizeof heard.text, "%s", message.text);
    motehound_worker_error_t_decode_cleanup(&message);
}

void setUp(void)
{
    session = SESSION;
    link = (struct worker_link){.lcm = lcm_create("memq://")};
    TEST_ASSERT_NOT_NULL(link.lcm);
    lcm_subscribe(link.lcm, WORKER_JOIN, on_join, NULL);
    lcm_subscribe(link.lcm, WORKER_DONE, on_done, NULL);
    lcm_subscribe(link.lcm, WORKER_TOTALS, on_totals, NULL);
    lcm_subscribe(link.lcm, WORKER_ERROR, on_error, NULL);
    worker = worker_open(&config, &link, error, sizeof error);
    TEST_ASSERT_NOT_NULL_MESSAGE(worker, error);
}

void tearDown(void)
{
    worker_link_close(&link);
    worker_close(worker);
}

/* Send it and hear all that it leads to. */
static void send(const char *channel, uint8_t *bytes, size_t size)
{
    TEST_ASSERT_NOT_NULL(bytes);
    heard = (struct heard){0};
    worker_link_publish(&link, channel, bytes, size);
    while (lcm_handle_timeout(link.lcm, 0) > 0) {}
}

/* ENCODE and send to the worker. */
#define ASK(kind, name, ...)                                                                                           \
    do {                                                                                                               \
        size_t asked_size;                                                                                             \
        char asked_channel[WORKER_CHANNEL_MAX];                                                                        \
        const motehound_worker_##name##_t asked = {session, WORKER, __VA_ARGS__};                                      \
        uint8_t *asked_bytes = worker_encode_##name(&asked, &asked_size);                                              \
        send(worker_channel(WORKER, kind, asked_channel), asked_bytes, asked_size);                                    \
        free(asked_bytes);                                                                                             \
    } while (0)

static void call(int64_t from)
{
    static char version[] = "1";
    size_t size;
    const motehound_worker_call_t message = {from, 1, version, version};
    uint8_t *bytes = worker_encode_call(&message, &size);
    send(WORKER_CALL, bytes, size);
    free(bytes);
}

static char scenario[] = "network: {protocol: collection}\ntracker: {name: luo}\n";

static motehound_worker_event_t starts[3];
static int32_t motes[3] = {100, 7, 50000};
static char none[] = "";

/* Joined, with three motes, the first of them the head; up. */
static void bring_up(void)
{
    motehound_worker_mote_t three[3] = {{.mote = motes[0], .id = 9, .is_sink = 1, .board = none},
                                        {.mote = motes[1], .id = 1, .x_mm = 5000, .board = none},
                                        {.mote = motes[2], .id = 2, .y_mm = 5000, .board = none}};
    call(SESSION);
    TEST_ASSERT_TRUE(heard.joins == 1 && heard.session == SESSION);
    ASK(WORKER_ASSIGN, assign, .number = 1, .scenario = scenario, .count = 3);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(1, heard.dones, heard.text);
    ASK(WORKER_MOTES, motes, .number = 2, .count = 3, .motes = three);
    TEST_ASSERT_TRUE(heard.dones == 1 && heard.number == 2 && heard.next_us == -1);
    for (int i = 0; i < 3; i++) {
        starts[i] = (motehound_worker_event_t){.kind = HOST_START, .count = 1, .motes = &motes[i]};
    }
    ASK(WORKER_WINDOW, window, .number = 3, .until_us = 1000, .count = 3, .events = starts);
    TEST_ASSERT_TRUE(heard.dones == 1 && heard.number == 3 && heard.next_us >= 1000);
}

static void joins_one_run_and_answers_its_call_again(void)
{
    call(SESSION);
    call(SESSION);
    TEST_ASSERT_EQUAL_UINT(1, heard.joins); /* the first answer may be lost */
    call(SESSION + 1);
    TEST_ASSERT_EQUAL_UINT(0, heard.joins);
    ASK(WORKER_ASSIGN, assign, .number = 1, .scenario = scenario, .count = 0);
    TEST_ASSERT_EQUAL_UINT(1, heard.dones);
    call(SESSION);
    TEST_ASSERT_EQUAL_UINT(0, heard.joins);
}

static void a_request_that_comes_again_is_answered_again_and_done_once(void)
{
    bring_up();
    motehound_worker_event_t reading = {
        .time_us = 5000, .kind = HOST_READING, .value = 1000, .count = 1, .motes = &motes[1]};
    for (int i = 0; i < 3; i++) {
        ASK(WORKER_WINDOW, window, .number = 4, .until_us = 6000, .count = 1, .events = &reading);
        TEST_ASSERT_TRUE(heard.dones == 1 && heard.number == 4 && heard.errors == 0);
    }
    ASK(WORKER_COUNT, count, .number = 5);
    TEST_ASSERT_TRUE(heard.totals == 1 && heard.number == 5 && heard.readings == 1);
    ASK(WORKER_COUNT, count, .number = 5);
    TEST_ASSERT_TRUE(heard.totals == 1 && heard.readings == 1);
}

static void a_request_whose_turn_it_is_not_is_ignored(void)
{
    ASK(WORKER_WINDOW, window, .number = 1, .until_us = 1000);
    TEST_ASSERT_EQUAL_UINT(0, heard.dones + heard.errors); /* it has no motes */
    bring_up();
    for (int64_t number = -1; number < 10; number++) {
        if (number != 3 && number != 4) {
            ASK(WORKER_WINDOW, window, .number = number, .until_us = 1000000);
            TEST_ASSERT_EQUAL_UINT(0, heard.dones + heard.errors);
        }
    }
    session++;
    ASK(WORKER_WINDOW, window, .number = 4, .until_us = 2000);
    session--;
    TEST_ASSERT_EQUAL_UINT(0, heard.dones + heard.errors);
    ASK(WORKER_WINDOW, window, .number = 4, .until_us = 2000);
    TEST_ASSERT_EQUAL_UINT(1, heard.dones);
}

static void alarms_wait_for_their_window(void)
{
    bring_up();
    unsigned actions = 0;
    int64_t next_us = 1000;
    for (int64_t number = 4; number < 40; number++) {
        ASK(WORKER_WINDOW, window, .number = number, .until_us = next_us + 1);
        TEST_ASSERT_TRUE(heard.dones == 1 && heard.next_us > next_us);
        next_us = heard.next_us;
        actions += (unsigned)heard.actions;
    }
    TEST_ASSERT_TRUE(actions > 0); /* the head's beacons */
}

static void a_new_assignment_begins_anew(void)
{
    bring_up();
    ASK(WORKER_ASSIGN, assign, .number = 2, .scenario = scenario, .count = 3);
    TEST_ASSERT_EQUAL_UINT(0, heard.dones); /* long past */
    ASK(WORKER_ASSIGN, assign, .number = 17, .scenario = scenario, .count = 0);
    TEST_ASSERT_TRUE(heard.dones == 1 && heard.number == 17 && heard.next_us == -1);
}

static void what_it_cannot_do_is_an_error_that_it_repeats(void)
{
    static char bad[] = "tracker: {name: oracle}\n";
    call(SESSION);
    ASK(WORKER_ASSIGN, assign, .number = 1, .scenario = bad, .count = 3);
    TEST_ASSERT_TRUE(heard.errors == 1 && strstr(heard.text, "oracle") != NULL);
    ASK(WORKER_ASSIGN, assign, .number = 1, .scenario = bad, .count = 3);
    TEST_ASSERT_EQUAL_UINT(1, heard.errors);
}

static void motes_of_others_are_an_error(void)
{
    bring_up();
    int32_t stranger = 8;
    motehound_worker_event_t reading = {.time_us = 5000, .kind = HOST_READING, .count = 1, .motes = &stranger};
    ASK(WORKER_WINDOW, window, .number = 4, .until_us = 6000, .count = 1, .events = &reading);
    TEST_ASSERT_EQUAL_UINT(1, heard.errors);
}

/* Cut short, or with one byte changed: ignored, or a request like another. Either way it is decoded within its bounds. */
static void spoilt_messages_do_no_harm(void)
{
    uint8_t frame[] = {1, 2, 3};
    motehound_worker_event_t event = {.kind = HOST_FRAME, .count = 3, .motes = motes, .length = 3, .frame = frame};
    motehound_worker_window_t window = {SESSION, WORKER, 4, 2000, 1, &event};
    size_t size;
    char channel[WORKER_CHANNEL_MAX];
    uint8_t *bytes = worker_encode_window(&window, &size);
    TEST_ASSERT_NOT_NULL(bytes);
    bring_up();
    worker_channel(WORKER, WORKER_WINDOW, channel);
    for (size_t shorter = 0; shorter < size; shorter++) {
        const uint64_t before = link.not_understood;
        send(channel, bytes, shorter);
        TEST_ASSERT_TRUE(link.not_understood == before + 1 && heard.dones + heard.errors == 0);
    }
    const struct random_stream stream = random_stream(1, RANDOM_DEPLOYMENT);
    for (uint64_t i = 0; i < 3000; i++) {
        const size_t at = (size_t)(random_uniform(stream, 2 * i) * (double)size);
        const uint8_t kept = bytes[at];
        bytes[at] = (uint8_t)random_bits(stream, 2 * i + 1);
        if (at < 16) {
            send(channel, bytes, size); /* another type, another session */
            TEST_ASSERT_TRUE(bytes[at] == kept || heard.dones + heard.errors == 0);
        } else {
            motehound_worker_window_t decoded;
            const lcm_recv_buf_t buffer = {bytes, (uint32_t)size, 0, NULL};
            if (worker_decode_window(&link, &buffer, &decoded)) {
                motehound_worker_window_t_decode_cleanup(&decoded);
            }
        }
        bytes[at] = kept;
    }
    free(bytes);
}

static void events_and_actions_come_out_as_they_went_in(void)
{
    static const uint32_t receivers[] = {4, 70000, 2};
    static const uint8_t frame[] = {9, 8, 7, 6};
    const struct host_event events[] = {
        {.time = 1, .kind = HOST_START, .mote = 3},
        {.time = 2, .kind = HOST_STOP, .mote = 3},
        {3, HOST_READING, 5, {.reading = {-123456, 200}}},
        {.time = 4, .kind = HOST_FRAME, .as.frame = {frame, receivers, 3, sizeof frame}},
        {5, HOST_SENT, 6, {.sent = MH_SENT_BUSY}},
        {.time = UINT64_C(1) << 60, .kind = HOST_PROBE, .mote = 1},
    };
    enum { EVENTS = sizeof events / sizeof events[0] };
    motehound_worker_event_t sent[EVENTS];
    for (size_t i = 0; i < EVENTS; i++) {
        sent[i] = worker_event_message(&events[i]);
    }
    const motehound_worker_window_t window = {1, 2, 3, 4, EVENTS, sent};
    motehound_worker_window_t got;
    size_t size;
    uint8_t *bytes = worker_encode_window(&window, &size);
    const lcm_recv_buf_t buffer = {bytes, (uint32_t)size, 0, NULL};
    TEST_ASSERT_TRUE(worker_decode_window(&link, &buffer, &got));
    TEST_ASSERT_TRUE(got.session == 1 && got.worker == 2 && got.number == 3 && got.until_us == 4 &&
                     got.count == EVENTS);
    for (size_t i = 0; i < EVENTS; i++) {
        struct host_event event;
        TEST_ASSERT_EQUAL_INT(0, worker_event_read(&got.events[i], &event));
        TEST_ASSERT_TRUE(event.time == events[i].time && event.kind == events[i].kind);
        if (event.kind == HOST_FRAME) {
            TEST_ASSERT_TRUE(event.as.frame.count == 3 && event.as.frame.length == sizeof frame);
            TEST_ASSERT_EQUAL_MEMORY(receivers, event.as.frame.receivers, sizeof receivers);
            TEST_ASSERT_EQUAL_MEMORY(frame, event.as.frame.bytes, sizeof frame);
        } else {
            TEST_ASSERT_EQUAL_UINT32(events[i].mote, event.mote);
        }
        if (event.kind == HOST_READING) {
            TEST_ASSERT_TRUE(event.as.reading.counts == -123456 && event.as.reading.target == 200);
        }
        if (event.kind == HOST_SENT) {
            TEST_ASSERT_EQUAL_INT(MH_SENT_BUSY, event.as.sent);
        }
    }
    motehound_worker_window_t_decode_cleanup(&got);
    free(bytes);

    const struct host_action actions[] = {
        {1, HOST_TRANSMIT, 2, {.transmit = {MH_BROADCAST, 3, {1, 2, 3}}}},
        {2,
         HOST_REPORT,
         3,
         {.estimate = {{1, -2, 3},
                       4000000000u,
                       {MH_REAL(0.1f), 2},
                       {3, 4},
                       {5, 6, 7},
                       {1, 2, 3, 4, 5, 6, 7},
                       MH_REAL(8.5f),
                       {8, 9},
                       {10, 11},
                       {12, 13},
                       MH_REAL(1.5f),
                       4000000001u,
                       4000000002u,
                       MH_REAL(2.5f),
                       {4000000001u, 4000000002u, 5, 6},
                       10,
                       513,
                       4,
                       3,
                       2}}},
        {3, HOST_SLEEP, 4, {.may_sleep = true}},
        {4, HOST_CLOCK, 5, {.clock_error_s = -1e-6}},
        {5, HOST_SENSE, 6, {.may_sleep = false}},
        {6, HOST_WORK, 7, {.work = {123456, MH_MESSAGE_ASK, true}}},
    };
    enum { ACTIONS = sizeof actions / sizeof actions[0] };
    motehound_worker_action_t done[ACTIONS];
    motehound_worker_estimate_t estimates[ACTIONS];
    for (size_t i = 0; i < ACTIONS; i++) {
        done[i] = worker_action_message(&actions[i], &estimates[i]);
    }
    const motehound_worker_done_t answer = {1, 2, 3, 4, ACTIONS, done};
    motehound_worker_done_t back;
    bytes = worker_encode_done(&answer, &size);
    const lcm_recv_buf_t answered = {bytes, (uint32_t)size, 0, NULL};
    TEST_ASSERT_TRUE(worker_decode_done(&link, &answered, &back));
    for (size_t i = 0; i < ACTIONS; i++) {
        struct host_action action;
        memset(&action, 0, sizeof action);
        TEST_ASSERT_EQUAL_INT(0, worker_action_read(&back.actions[i], &action));
        TEST_ASSERT_TRUE(action.time == actions[i].time && action.kind == actions[i].kind &&
                         action.mote == actions[i].mote);
        switch (action.kind) {
        case HOST_TRANSMIT:
            TEST_ASSERT_TRUE(action.as.transmit.destination == MH_BROADCAST && action.as.transmit.length == 3);
            TEST_ASSERT_EQUAL_MEMORY(actions[i].as.transmit.bytes, action.as.transmit.bytes, 3);
            break;
        case HOST_REPORT:
            TEST_ASSERT_EQUAL_MEMORY(&actions[i].as.estimate, &action.as.estimate,
                                     offsetof(struct mh_estimate, flags) + 1);
            break;
        case HOST_SLEEP:
            TEST_ASSERT_TRUE(action.as.may_sleep);
            break;
        case HOST_CLOCK:
            TEST_ASSERT_TRUE(action.as.clock_error_s == -1e-6);
            break;
        case HOST_SENSE:
            break;
        case HOST_WORK:
            TEST_ASSERT_TRUE(action.as.work.duration_us == 123456 && action.as.work.message == MH_MESSAGE_ASK &&
                             action.as.work.localises);
            break;
        }
    }
    motehound_worker_done_t_decode_cleanup(&back);
    free(bytes);
}

static void boards_come_out_as_they_went_in(void)
{
    struct board_result result = {.node = 17,
                                  .board = "atmega128",
                                  .image = "images/atmega128/sensor_node",
                                  .fixed = true,
                                  .events = 5,
                                  .cycles = 1ull << 40,
                                  .cycles_max = 1ull << 33,
                                  .rate_hz = 7372800,
                                  .missed = 1,
                                  .overlapped = 2,
                                  .ram = 4096,
                                  .variables = 1000,
                                  .stack = 500,
                                  .reports_max = 24,
                                  .neighbours_max = 8};
    step_cycles_count(&result.steps, 1000);
    step_cycles_count(&result.steps, 1ull << 33);
    motehound_worker_board_t board = worker_board_message(&result);
    const motehound_worker_totals_t totals = {.board_count = 1, .boards = &board};
    motehound_worker_totals_t back;
    size_t size;
    uint8_t *bytes = worker_encode_totals(&totals, &size);
    const lcm_recv_buf_t buffer = {bytes, (uint32_t)size, 0, NULL};
    TEST_ASSERT_TRUE(worker_decode_totals(&link, &buffer, &back));
    TEST_ASSERT_EQUAL_INT(1, back.board_count);
    const struct board_result got = worker_board_read(&back.boards[0]);
    TEST_ASSERT_EQUAL_STRING(result.board, got.board);
    TEST_ASSERT_EQUAL_STRING(result.image, got.image);
    TEST_ASSERT_TRUE(got.node == 17 && got.fixed && got.events == 5 && got.cycles == result.cycles &&
                     got.cycles_max == result.cycles_max && got.rate_hz == 7372800 && got.missed == 1 &&
                     got.overlapped == 2 && got.reports_max == 24 && got.neighbours_max == 8);
    TEST_ASSERT_EQUAL_UINT32(2596, board_ram_free(&got));
    TEST_ASSERT_EQUAL_MEMORY(&result.steps, &got.steps, sizeof got.steps);
    motehound_worker_totals_t_decode_cleanup(&back);
    free(bytes);

    /* runs of one board are added up, others stand beside */
    struct board_results all = {.count = 0};
    struct board_result other = result;
    other.node = 18;
    board_results_add(&all, &result);
    board_results_add(&all, &other);
    board_results_add(&all, &result);
    TEST_ASSERT_EQUAL_UINT(2, all.count);
    TEST_ASSERT_TRUE(all.list[0].events == 10 && all.list[0].cycles == 2 * result.cycles &&
                     all.list[0].cycles_max == result.cycles_max && all.list[1].events == 5);
    TEST_ASSERT_EQUAL_INT64(4, step_cycles_number(&all.list[0].steps));
}

static void a_layout_is_met_exactly(void)
{
    static const uint8_t message[] = {0, 0, 0, 0, 0,   0,   0, 0,           /* fingerprint */
                                      1,                                    /* 1 */
                                      0, 0, 0, 3, 'a', 'b', 0,              /* s */
                                      0, 0, 0, 2, 5,   0,   1, 6, 7, 0, 0}; /* [1{1}]: 5 with one byte, 7 with none */
    TEST_ASSERT_TRUE(layout_fits("1s[1{1}]", message, sizeof message));
    TEST_ASSERT_FALSE(layout_fits("1s[1{1}]", message, sizeof message - 1));
    TEST_ASSERT_FALSE(layout_fits("1s[1{1}]1", message, sizeof message));
    TEST_ASSERT_FALSE(layout_fits("1s[1{2}]", message, sizeof message));
    TEST_ASSERT_FALSE(layout_fits("2s[1{1}]", message, sizeof message));
    TEST_ASSERT_FALSE(layout_fits("", message, 7));
    TEST_ASSERT_TRUE(layout_fits("", message, 8));
    static const uint8_t negative[] = {0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF};
    TEST_ASSERT_FALSE(layout_fits("s", negative, sizeof negative));
    TEST_ASSERT_FALSE(layout_fits("[1]", negative, sizeof negative));
    static const uint8_t endless[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 'a', 'b'};
    TEST_ASSERT_FALSE(layout_fits("s", endless, sizeof endless)); /* no zero byte at its end */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(joins_one_run_and_answers_its_call_again);
    RUN_TEST(a_request_that_comes_again_is_answered_again_and_done_once);
    RUN_TEST(a_request_whose_turn_it_is_not_is_ignored);
    RUN_TEST(alarms_wait_for_their_window);
    RUN_TEST(a_new_assignment_begins_anew);
    RUN_TEST(what_it_cannot_do_is_an_error_that_it_repeats);
    RUN_TEST(motes_of_others_are_an_error);
    RUN_TEST(spoilt_messages_do_no_harm);
    RUN_TEST(events_and_actions_come_out_as_they_went_in);
    RUN_TEST(boards_come_out_as_they_went_in);
    RUN_TEST(a_layout_is_met_exactly);
    port_exit(UNITY_END() > 0);
}
