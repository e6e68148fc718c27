/* Motes behind the host's table: events in, actions out, however they are spread. */
#include "engine/arena.h"
#include "engine/random.h"
#include "hosts/host.h"
#include "motehound/collection.h"
#include "motehound/luo.h"
#include "port.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

enum { MOTES = 30, WINDOWS = 400, LOOKAHEAD = 500, INTERVAL_MS = 1000 };

static struct mh_collection_config collection;
static struct mh_luo_config luo;
static const struct mh_sensor_config sensor = {
    .q20_per_count = 1, .counts_max = INT32_MAX, .interval = INTERVAL_MS, .threshold = 1000};
static const struct mh_head_config head = {
    .tracker = &mh_tracker_luo, .tracker_config = &luo, .interval = INTERVAL_MS, .window = INTERVAL_MS / 2};
static char error[200];

void setUp(void)
{
    mh_collection_config_default(&collection);
    mh_luo_config_default(&luo);
}
void tearDown(void) {}

static void make(struct host *host, uint32_t count, const uint32_t *order)
{
    TEST_ASSERT_EQUAL_INT(0, host_in_process(host, count, order, &mh_protocol_collection));
}

static void add(struct host *host, uint32_t at, uint32_t mote)
{
    const struct host_mote what = {.id = mote,
                                   .place = {(int32_t)(mote % 6) * 10000, (int32_t)(mote / 6) * 10000, 0},
                                   .sensor = mote == 0 ? NULL : &sensor,
                                   .head = mote == 0 ? &head : NULL,
                                   .protocol = &mh_protocol_collection,
                                   .protocol_config = &collection,
                                   .clock = {.offset_us = mote % 3 * 1000}};
    TEST_ASSERT_EQUAL_INT(0, host->add(host->state, at, &what));
}

/* The motes with mote % hosts == h live in host h. Every frame is heard by all the others after one lookahead. */
struct spread {
    uint32_t hosts;
    struct host host[4];
    uint64_t hash, actions;
    sim_time next;
};

static void mix(struct spread *spread, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        spread->hash = (spread->hash ^ ((const uint8_t *)bytes)[i]) * UINT64_C(1099511628211);
    }
}

static void fold(struct spread *spread, const struct host_actions *actions)
{
    for (size_t i = 0; i < actions->count; i++) {
        const struct host_action *action = &actions->list[i];
        mix(spread, &action->time, sizeof action->time);
        mix(spread, &action->mote, sizeof action->mote);
        mix(spread, &action->kind, sizeof action->kind);
        if (action->kind == HOST_TRANSMIT) {
            mix(spread, action->as.transmit.bytes, action->as.transmit.length);
        }
    }
    spread->actions += actions->count;
}

/* The events of a window, those of host h with its own numbers of motes. */
static size_t events_of(uint32_t h, uint32_t hosts, const struct host_event *all, size_t count,
                        struct host_event *events, struct arena *arena)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        struct host_event event = all[i];
        if (event.kind == HOST_FRAME) {
            uint32_t *receivers = arena_take(arena, event.as.frame.count * sizeof *receivers);
            uint32_t receiver_count = 0;
            for (uint32_t r = 0; r < event.as.frame.count; r++) {
                if (event.as.frame.receivers[r] % hosts == h) {
                    receivers[receiver_count++] = event.as.frame.receivers[r] / hosts;
                }
            }
            event.as.frame.receivers = receivers;
            event.as.frame.count = receiver_count;
            events[kept++] = event;
        } else if (event.mote % hosts == h) {
            event.mote /= hosts;
            events[kept++] = event;
        }
    }
    return kept;
}

static void run_spread(struct spread *spread, uint32_t hosts)
{
    static uint32_t order[MOTES];
    static struct host_event all[10 * MOTES], own[10 * MOTES];
    static uint8_t frames[MOTES][MH_FRAME_MAX];
    static uint32_t others[MOTES][MOTES];
    const struct random_stream stream = random_stream(3, RANDOM_DEPLOYMENT);
    struct host_actions actions = {0};
    struct arena arena = {0};
    size_t count = 0;
    *spread = (struct spread){.hosts = hosts, .hash = UINT64_C(14695981039346656037)};
    for (uint32_t i = 0; i < MOTES; i++) {
        order[i] = i;
    }
    for (uint32_t h = 0; h < hosts; h++) {
        make(&spread->host[h], MOTES / hosts + (h < MOTES % hosts), order);
    }
    for (uint32_t mote = 0; mote < MOTES; mote++) {
        add(&spread->host[mote % hosts], mote / hosts, mote);
        all[count++] = (struct host_event){.kind = HOST_START, .mote = mote};
    }
    for (uint64_t window = 0; window < WINDOWS; window++) {
        const sim_time until = (window + 1) * 100 * LOOKAHEAD;
        actions.count = 0;
        for (uint32_t h = 0; h < hosts; h++) {
            const size_t before = actions.count;
            const size_t mine = events_of(h, hosts, all, count, own, &arena);
            TEST_ASSERT_EQUAL_INT(
                0, spread->host[h].run(spread->host[h].state, until, own, mine, &actions, error, sizeof error));
            TEST_ASSERT_TRUE(spread->host[h].next(spread->host[h].state) >= until);
            for (size_t i = before; i < actions.count; i++) {
                actions.list[i].mote = actions.list[i].mote * hosts + h;
            }
        }
        TEST_ASSERT_EQUAL_INT(0, host_actions_sort(&actions));
        fold(spread, &actions);
        arena_reset(&arena);
        count = 0;
        for (size_t i = 0; i < actions.count && count < MOTES; i++) {
            const struct host_action *action = &actions.list[i];
            if (action->kind == HOST_TRANSMIT) {
                uint32_t receivers = 0;
                for (uint32_t mote = 0; mote < MOTES; mote++) {
                    if (mote != action->mote && random_uniform(stream, window * MOTES + mote) < 0.7) {
                        others[count][receivers++] = mote;
                    }
                }
                memcpy(frames[count], action->as.transmit.bytes, action->as.transmit.length);
                all[count] = (struct host_event){
                    .time = until,
                    .kind = HOST_FRAME,
                    .as.frame = {frames[count], others[count], receivers, action->as.transmit.length}};
                count++;
            }
        }
        if (window % 20 == 0) {
            for (uint32_t mote = 1; mote < MOTES; mote++) {
                const int32_t counts = (int32_t)(5000 * random_uniform(stream, 100000 + window * MOTES + mote));
                all[count++] = (struct host_event){until, HOST_READING, mote, {.reading = {counts, 0}}};
            }
            all[count++] = (struct host_event){.time = until, .kind = HOST_PROBE, .mote = 5};
        }
        if (window % 50 == 7) {
            all[count++] = (struct host_event){.time = until, .kind = HOST_STOP, .mote = 11};
        } else if (window % 50 == 20) {
            all[count++] = (struct host_event){.time = until, .kind = HOST_START, .mote = 11};
        }
    }
    arena_free(&arena);
    host_actions_free(&actions);
}

static struct host_totals end_spread(struct spread *spread)
{
    struct host_totals totals = {0};
    for (uint32_t h = 0; h < spread->hosts; h++) {
        struct host *host = &spread->host[h];
        TEST_ASSERT_EQUAL_INT(0, host->count(host->state, &totals, error, sizeof error));
        host->destroy(host->state);
    }
    return totals;
}

static void how_motes_are_spread_changes_nothing(void)
{
    struct spread one, other;
    run_spread(&one, 1);
    const struct host_totals totals = end_spread(&one);
    TEST_ASSERT_TRUE(one.actions > 200 && totals.motes.frames_sent > 100 && totals.motes.readings > 500);
    for (uint32_t hosts = 2; hosts <= 4; hosts++) {
        run_spread(&other, hosts);
        const struct host_totals again = end_spread(&other);
        TEST_ASSERT_EQUAL_HEX64(one.hash, other.hash);
        TEST_ASSERT_EQUAL_UINT64(one.actions, other.actions);
        TEST_ASSERT_EQUAL_MEMORY(&totals.motes, &again.motes, sizeof totals.motes);
        TEST_ASSERT_EQUAL_UINT64(totals.events, again.events);
    }
}

static void stopped_motes_do_nothing_and_start_anew(void)
{
    static const uint32_t order[] = {0};
    struct host host;
    struct host_actions actions = {0};
    struct host_totals totals = {0};
    make(&host, 1, order);
    add(&host, 0, 0); /* the head, whose beacons and deadlines never end */
    TEST_ASSERT_TRUE(host.next(host.state) == SIM_TIME_NEVER);
    const struct host_event start = {.kind = HOST_START}, stop = {.time = 60000000, .kind = HOST_STOP};
    TEST_ASSERT_EQUAL_INT(0, host.run(host.state, 60000000, &start, 1, &actions, error, sizeof error));
    const size_t beacons = actions.count;
    TEST_ASSERT_TRUE(beacons > 0);
    TEST_ASSERT_EQUAL_INT(0, host.run(host.state, 120000000, &stop, 1, &actions, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(beacons, actions.count);
    const struct host_event again = {.time = 120000000, .kind = HOST_START};
    TEST_ASSERT_EQUAL_INT(0, host.run(host.state, 180000000, &again, 1, &actions, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(2 * beacons, actions.count);
    TEST_ASSERT_TRUE(actions.list[beacons].time - 120000000 == actions.list[0].time);
    TEST_ASSERT_EQUAL_INT(0, host.count(host.state, &totals, error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(2 * beacons, totals.motes.frames_sent);
    host.destroy(host.state);
    host_actions_free(&actions);
}

static void a_mote_that_does_not_come_up_is_an_error(void)
{
    static const uint32_t order[] = {0};
    struct host host;
    struct host_actions actions = {0};
    collection.range_mm = 0;
    make(&host, 1, order);
    add(&host, 0, 0);
    const struct host_event start = {.kind = HOST_START};
    TEST_ASSERT_EQUAL_INT(-1, host.run(host.state, 1, &start, 1, &actions, error, sizeof error));
    TEST_ASSERT_NOT_NULL(strstr(error, "does not come up"));
    host.destroy(host.state);
    host_actions_free(&actions);
}

static int by_time_mote_number(const void *a, const void *b)
{
    const struct host_action *left = a, *right = b;
    if (left->time != right->time) {
        return left->time < right->time ? -1 : 1;
    }
    if (left->mote != right->mote) {
        return left->mote < right->mote ? -1 : 1;
    }
    return (left->as.transmit.destination > right->as.transmit.destination) -
           (left->as.transmit.destination < right->as.transmit.destination);
}

static void actions_are_sorted_stably(void)
{
    const struct random_stream stream = random_stream(5, RANDOM_DEPLOYMENT);
    for (uint32_t size = 0; size < 300; size += 1 + size / 3) {
        struct host_actions actions = {0};
        for (uint32_t i = 0; i < size; i++) {
            struct host_action *action = host_actions_add(&actions);
            TEST_ASSERT_NOT_NULL(action);
            memset(action, 0, sizeof *action);
            action->time = (sim_time)(5 * random_uniform(stream, 2 * i));
            action->mote = (uint32_t)(5 * random_uniform(stream, 2 * i + 1));
            action->as.transmit.destination = i;
        }
        struct host_action *expected = malloc((size + 1) * sizeof *expected);
        TEST_ASSERT_NOT_NULL(expected);
        if (size > 0) {
            memcpy(expected, actions.list, size * sizeof *expected);
            qsort(expected, size, sizeof *expected, by_time_mote_number);
        }
        TEST_ASSERT_EQUAL_INT(0, host_actions_sort(&actions));
        for (uint32_t i = 0; i < size; i++) {
            TEST_ASSERT_EQUAL_UINT32(expected[i].as.transmit.destination, actions.list[i].as.transmit.destination);
        }
        free(expected);
        host_actions_free(&actions);
    }
}

static void an_arena_keeps_its_pieces_apart(void)
{
    enum { PIECES = 500 };
    struct arena arena = {0};
    for (int round = 0; round < 3; round++) {
        uint8_t *pieces[PIECES];
        for (size_t i = 0; i < PIECES; i++) {
            pieces[i] = arena_take(&arena, 3 * i);
            TEST_ASSERT_NOT_NULL(pieces[i]);
            memset(pieces[i], (int)(i & 0xFF), 3 * i);
        }
        for (size_t i = 0; i < PIECES; i++) {
            for (size_t k = 0; k < 3 * i; k++) {
                TEST_ASSERT_EQUAL_UINT8(i & 0xFF, pieces[i][k]);
            }
        }
        arena_reset(&arena);
    }
    arena_free(&arena);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(how_motes_are_spread_changes_nothing);
    RUN_TEST(stopped_motes_do_nothing_and_start_anew);
    RUN_TEST(a_mote_that_does_not_come_up_is_an_error);
    RUN_TEST(actions_are_sorted_stably);
    RUN_TEST(an_arena_keeps_its_pieces_apart);
    port_exit(UNITY_END() > 0);
}
