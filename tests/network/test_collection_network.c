/* Several hundred motes that run `collection` over a unit-disc radio with random delays and losses. */
#include "motehound/collection.h"
#include "motehound/mote.h"
#include "port.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

enum { NODES_MAX = 2000, EVENTS_MAX = 1 << 18 };

#define RANGE_MM 15000
#define SINK 0
#define UNREACHED 255

struct event {
    mh_tick time;
    uint32_t serial; /* order of events of one time; for an alarm also its validity */
    uint16_t mote;
    uint8_t length; /* of the frame; 0: an alarm, or if it is told the fate of a frame sent */
    bool tells;
    enum mh_sent fate;
    uint8_t frame[MH_FRAME_MAX];
};

/* A tracker that does as the test says. */
struct script {
    bool tracks, asks;
    struct mh_interest interest;
};

static struct network {
    unsigned count;
    struct mh_place places[NODES_MAX];
    struct mh_mote motes[NODES_MAX];
    struct mh_mote_config configs[NODES_MAX];
    struct mh_collection states[NODES_MAX];
    uint32_t alarm_serial[NODES_MAX]; /* of the alarm in force */
    uint8_t bfs_hops[NODES_MAX];
    struct event *heap[EVENTS_MAX];
    unsigned events;
    uint32_t serial;
    mh_tick now;
    uint64_t random;
    unsigned loss_percent;
    struct mh_collection_config collection;
    struct mh_sensor_config sensor;
    struct mh_head_config head_config;
    struct mh_head head;
    struct script script;
    unsigned sent[MH_MESSAGE_KINDS];
    unsigned detours, arrived; /* reports: hops beyond the shortest path, summed; count */
    unsigned longest_detour;
    bool asked[NODES_MAX]; /* reports flagged so have left this node */
} net;

static enum mh_status tracker_init(void *state, const void *config, mh_tick interval)
{
    (void)interval;
    *(const struct script **)state = config;
    return MH_OK;
}

static enum mh_status tracker_step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                                   struct mh_estimate *estimate)
{
    (void)measurements;
    (void)count;
    memset(estimate, 0, sizeof *estimate);
    estimate->time = time;
    return (*(const struct script **)state)->tracks ? MH_OK : MH_NONE;
}

static enum mh_status tracker_predict(const void *state, mh_tick time, struct mh_estimate *expected)
{
    (void)time;
    (void)expected;
    return (*(const struct script *const *)state)->tracks ? MH_OK : MH_NONE;
}

static enum mh_status tracker_interest(const void *state, struct mh_interest *interest)
{
    const struct script *script = *(const struct script *const *)state;
    *interest = script->interest;
    return script->asks ? MH_OK : MH_NONE;
}

static const struct mh_tracker tracker = {.name = "script",
                                          .state_size = sizeof(void *),
                                          .init = tracker_init,
                                          .step = tracker_step,
                                          .predict = tracker_predict,
                                          .interest = tracker_interest};

static uint32_t draw(uint32_t limit)
{
    net.random = net.random * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((net.random >> 32) * limit >> 32);
}

static bool before(const struct event *a, const struct event *b)
{
    return a->time != b->time ? mh_tick_before(a->time, b->time) : a->serial < b->serial;
}

static struct event *push(mh_tick time, unsigned mote)
{
    TEST_ASSERT_LESS_THAN(EVENTS_MAX, net.events);
    struct event *event = calloc(1, sizeof *event);
    event->time = time;
    event->serial = ++net.serial;
    event->mote = (uint16_t)mote;
    unsigned at = net.events++;
    for (; at > 0 && before(event, net.heap[(at - 1) / 2]); at = (at - 1) / 2) {
        net.heap[at] = net.heap[(at - 1) / 2];
    }
    net.heap[at] = event;
    return event;
}

static struct event *pop(void)
{
    struct event *first = net.heap[0], *last = net.heap[--net.events];
    unsigned at = 0;
    for (unsigned child = 1; child < net.events; at = child, child = 2 * at + 1) {
        child += child + 1 < net.events && before(net.heap[child + 1], net.heap[child]);
        if (!before(net.heap[child], last)) {
            break;
        }
        net.heap[at] = net.heap[child];
    }
    net.heap[at] = last;
    return first;
}

static bool in_range(unsigned a, unsigned b)
{
    return a != b && mh_place_within(&net.places[a], &net.places[b], RANGE_MM);
}

static unsigned index_of(const void *context) { return (unsigned)((const struct mh_mote *)context - net.motes); }

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    const unsigned sender = index_of(context);
    struct mh_message message;
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &message));
    net.sent[message.kind]++;
    if (message.kind == MH_MESSAGE_REPORT) {
        const unsigned origin = (unsigned)message.as.report.origin;
        net.asked[origin] |= sender == origin && (message.as.report.flags & MH_MEASUREMENT_ASKED) != 0;
        if (destination == SINK) {
            const unsigned detour = message.as.report.hops + 1u - net.bfs_hops[origin];
            net.arrived++;
            net.detours += detour;
            net.longest_detour = detour > net.longest_detour ? detour : net.longest_detour;
        }
    }
    struct event *told = push(net.now + 5, sender);
    told->tells = true;
    told->fate = destination == MH_BROADCAST ? MH_SENT_OK : MH_SENT_NO_ACK;
    for (unsigned i = 0; i < net.count; i++) {
        if (in_range(sender, i) && (destination == MH_BROADCAST || destination == i) && draw(100) >= net.loss_percent) {
            struct event *event = push(net.now + 2 + draw(3), i);
            memcpy(event->frame, frame, length);
            event->length = (uint8_t)length;
            told->fate = MH_SENT_OK;
        }
    }
}

static void set_alarm(void *context, mh_tick time)
{
    net.alarm_serial[index_of(context)] =
        push(mh_tick_before(time, net.now) ? net.now : time, index_of(context))->serial;
}

static void report(void *context, const struct mh_estimate *estimate)
{
    (void)context;
    (void)estimate;
}

static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report};

static void run_until(mh_tick end)
{
    while (net.events > 0 && !mh_tick_before(end, net.heap[0]->time)) {
        struct event *event = pop();
        net.now = event->time;
        if (event->length > 0) {
            (void)mh_mote_frame(&net.motes[event->mote], net.now, event->frame, event->length);
        } else if (event->tells) {
            mh_mote_sent(&net.motes[event->mote], net.now, event->fate);
        } else if (event->serial == net.alarm_serial[event->mote]) {
            mh_mote_alarm(&net.motes[event->mote], net.now);
        }
        free(event);
    }
    net.now = end;
}

static void measure_bfs(void)
{
    unsigned queue[NODES_MAX], head = 0, tail = 0;
    memset(net.bfs_hops, UNREACHED, sizeof net.bfs_hops);
    net.bfs_hops[SINK] = 0;
    queue[tail++] = SINK;
    while (head < tail) {
        const unsigned at = queue[head++];
        for (unsigned i = 0; i < net.count; i++) {
            if (net.bfs_hops[i] == UNREACHED && in_range(at, i)) {
                net.bfs_hops[i] = (uint8_t)(net.bfs_hops[at] + 1);
                queue[tail++] = i;
            }
        }
    }
}

/* `count` motes at random on a square; the sink in the middle of its lower side. All come up at `begin`. */
static void deploy(unsigned count, uint32_t side_mm, unsigned seed, unsigned loss_percent, mh_tick begin)
{
    while (net.events > 0) {
        free(pop());
    }
    memset(&net, 0, sizeof net);
    net.count = count;
    net.random = seed;
    net.loss_percent = loss_percent;
    net.now = begin;
    mh_collection_config_default(&net.collection);
    net.sensor.q20_per_count = 1;
    net.sensor.counts_max = 1000;
    net.sensor.interval = 1000;
    net.sensor.threshold = MH_Q20(0.2f);
    static void *tracker_state;
    const struct mh_head_config head = {&tracker, &net.script, &tracker_state, begin, 1000, 500, 0, false, 0};
    net.head_config = head;
    for (unsigned i = 0; i < count; i++) {
        net.places[i].x_mm = i == SINK ? (int32_t)side_mm / 2 : (int32_t)draw(side_mm);
        net.places[i].y_mm = i == SINK ? 0 : (int32_t)draw(side_mm);
    }
    measure_bfs();
    for (unsigned i = 0; i < count; i++) {
        const struct mh_mote_config config = {.id = i,
                                              .place = net.places[i],
                                              .sensor = &net.sensor,
                                              .head = i == SINK ? &net.head_config : NULL,
                                              .protocol = &mh_protocol_collection,
                                              .protocol_config = &net.collection,
                                              .protocol_state = &net.states[i],
                                              .head_state = i == SINK ? &net.head : NULL};
        net.configs[i] = config;
        TEST_ASSERT_EQUAL(MH_OK, mh_mote_init(&net.motes[i], &net.configs[i], &port, &net.motes[i], begin));
    }
}

static unsigned connected(void)
{
    unsigned n = 0;
    for (unsigned i = 1; i < net.count; i++) {
        n += net.bfs_hops[i] != UNREACHED;
    }
    return n;
}

static unsigned with_parent(void)
{
    unsigned n = 0;
    for (unsigned i = 1; i < net.count; i++) {
        n += net.states[i].joined;
        if (net.states[i].joined) {
            TEST_ASSERT_TRUE(in_range(i, net.states[i].parent));
            TEST_ASSERT_TRUE(net.states[i].hops >= net.bfs_hops[i]);
        }
    }
    return n;
}

void setUp(void) {}
void tearDown(void) {}

static void every_connected_node_gets_a_parent(void)
{
    for (unsigned seed = 1; seed <= 5; seed++) {
        deploy(500, 80000, seed, 0, 0);
        run_until(2000);
        TEST_ASSERT_GREATER_THAN(490, connected());
        TEST_ASSERT_EQUAL(connected(), with_parent());
    }
    /* so thin that the field falls apart: the nodes left over ask until they have one, the others stay alone */
    for (unsigned seed = 1; seed <= 5; seed++) {
        deploy(200, 100000, seed, 0, 0);
        run_until(60000);
        TEST_ASSERT_EQUAL(connected(), with_parent());
    }
}

static void the_tree_forms_across_the_wrap_of_the_ticks(void)
{
    deploy(500, 80000, 1, 0, (mh_tick)0 - 1000);
    run_until(1000);
    TEST_ASSERT_EQUAL(connected(), with_parent());
}

/* Each node reports once; the counts are taken when its report reaches the sink. */
static void reports_take_nearly_the_shortest_path(void)
{
    for (unsigned seed = 1; seed <= 3; seed++) {
        deploy(700, 80000, seed, 0, 0);
        run_until(2000);
        for (unsigned i = 1; i < net.count; i++) {
            const struct mh_reading reading = {net.now, 1, 0};
            net.sensor.report_always = true;
            TEST_ASSERT_EQUAL(MH_OK, mh_mote_reading(&net.motes[i], net.now, &reading));
            run_until(net.now + 50);
        }
        unsigned within_one = 0;
        for (unsigned i = 1; i < net.count; i++) {
            within_one += net.states[i].joined && net.states[i].hops <= net.bfs_hops[i] + 1u;
        }
        TEST_ASSERT_EQUAL(connected(), net.arrived);
        TEST_ASSERT_LESS_OR_EQUAL(2, net.longest_detour);
        TEST_ASSERT_GREATER_OR_EQUAL(connected() * 95 / 100, within_one);
        TEST_ASSERT_LESS_OR_EQUAL(net.arrived, net.detours); /* less than one hop more on average */
    }
}

static unsigned beacons_of_one_round(unsigned count, uint32_t side_mm)
{
    unsigned beacons = 0;
    for (unsigned seed = 1; seed <= 3; seed++) {
        deploy(count, side_mm, seed, 0, 0);
        run_until(3000);
        TEST_ASSERT_EQUAL(connected(), with_parent());
        beacons += net.sent[MH_MESSAGE_BEACON];
    }
    return beacons;
}

static void relays_grow_with_the_area_and_not_with_the_nodes(void)
{
    const unsigned thin = beacons_of_one_round(450, 60000), thick = beacons_of_one_round(1800, 60000),
                   wide = beacons_of_one_round(1800, 120000);
    TEST_ASSERT_LESS_THAN(thin * 3 / 2, thick);   /* four times the nodes */
    TEST_ASSERT_GREATER_THAN(thin * 5 / 2, wide); /* four times the area */
    TEST_ASSERT_LESS_THAN(thin * 11 / 2, wide);
}

/* One request for 8 m around each of 100 random places, half an instant ahead. */
static void requests_reach_the_nodes_around_a_place(void)
{
    unsigned wanted = 0, reached = 0;
    deploy(1280, 100000, 1, 0, 0);
    run_until(2000);
    net.sent[MH_MESSAGE_REQUEST] = 0;
    for (unsigned place = 0; place < 100; place++) {
        net.script.interest.centre.x_mm = (int32_t)draw(100000);
        net.script.interest.centre.y_mm = (int32_t)draw(100000);
        net.script.interest.radius_mm = 8000;
        net.script.asks = true;
        memset(net.asked, 0, sizeof net.asked);
        run_until(net.now + 1000); /* past the deadline, to the sampling instant it asks for */
        for (unsigned i = 1; i < net.count; i++) {
            const struct mh_reading reading = {net.now, 0, 0};
            (void)mh_mote_reading(&net.motes[i], net.now, &reading);
            if (net.bfs_hops[i] != UNREACHED &&
                mh_place_within(&net.places[i], &net.script.interest.centre, net.script.interest.radius_mm)) {
                wanted++;
                reached += net.asked[i];
            } else {
                TEST_ASSERT_FALSE(net.asked[i]);
            }
        }
    }
    TEST_ASSERT_GREATER_THAN(1500, wanted);
    TEST_ASSERT_GREATER_OR_EQUAL(wanted * 95 / 100, reached);
    TEST_ASSERT_LESS_THAN(100 * 20, net.sent[MH_MESSAGE_REQUEST]); /* the way is about 5 hops */
}

static void a_change_of_tracking_reaches_everybody_at_once(void)
{
    deploy(500, 80000, 2, 0, 0);
    run_until(2000);
    for (unsigned round = 0; round < 3; round++) {
        net.script.tracks = !net.script.tracks;
        run_until(net.now + 3000);
        for (unsigned i = 0; i < net.count; i++) {
            if (net.bfs_hops[i] != UNREACHED) {
                TEST_ASSERT_EQUAL(net.script.tracks, net.motes[i].tracking);
            }
        }
    }
}

static void losing_30_percent_of_the_frames_neither_loops_nor_splits(void)
{
    deploy(500, 80000, 3, 30, 0);
    net.sensor.report_always = true;
    net.script.asks = true;
    net.script.interest.centre.x_mm = 40000;
    net.script.interest.centre.y_mm = 60000;
    net.script.interest.radius_mm = 8000;
    unsigned sent = 0;
    for (unsigned second = 2; second < 92; second++) {
        run_until(second * 1000);
        const struct mh_reading reading = {net.now, 1, 0};
        const unsigned i = 1 + draw(net.count - 1);
        sent += mh_mote_reading(&net.motes[i], net.now, &reading) == MH_OK;
    }
    TEST_ASSERT_EQUAL(connected(), with_parent());
    TEST_ASSERT_LESS_THAN(sent * 12, net.sent[MH_MESSAGE_REPORT]); /* no report runs in circles */
    TEST_ASSERT_LESS_THAN(90 * 40, net.sent[MH_MESSAGE_REQUEST]);
    TEST_ASSERT_LESS_THAN(3 * 500 * 2, net.sent[MH_MESSAGE_BEACON]); /* three rounds, none a storm */
}

static void a_dead_parent_is_replaced_in_the_next_round(void)
{
    deploy(500, 80000, 4, 0, 0);
    run_until(2000);
    const unsigned dead = net.states[net.count - 1].parent == SINK ? net.count - 2 : net.states[net.count - 1].parent;
    net.places[dead].x_mm = 900000000; /* out of everybody's range */
    measure_bfs();
    run_until(100000);
    for (unsigned i = 1; i < net.count; i++) {
        if (net.bfs_hops[i] != UNREACHED) {
            TEST_ASSERT_NOT_EQUAL(dead, net.states[i].parent);
            TEST_ASSERT_FALSE(net.states[i].stale);
        }
    }
}

/* Its rounds begin at 1 again, while the field has come to 20 and believes that there is a track. */
static void a_sink_that_reboots_gets_its_tree_back(void)
{
    for (unsigned seed = 1; seed <= 3; seed++) {
        deploy(500, 80000, seed, 0, 0);
        net.script.tracks = true;
        run_until(600000);
        net.script.tracks = false;
        net.sent[MH_MESSAGE_BEACON] = 0;
        TEST_ASSERT_EQUAL(MH_OK, mh_mote_init(&net.motes[SINK], &net.configs[SINK], &port, &net.motes[SINK], net.now));
        run_until(net.now + 3000);
        for (unsigned i = 1; i < net.count; i++) {
            if (net.bfs_hops[i] != UNREACHED) {
                TEST_ASSERT_EQUAL_UINT16(net.states[SINK].round, net.states[i].round);
                TEST_ASSERT_FALSE(net.motes[i].tracking);
            }
        }
        TEST_ASSERT_LESS_THAN(500, net.sent[MH_MESSAGE_BEACON]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_connected_node_gets_a_parent);
    RUN_TEST(the_tree_forms_across_the_wrap_of_the_ticks);
    RUN_TEST(reports_take_nearly_the_shortest_path);
    RUN_TEST(relays_grow_with_the_area_and_not_with_the_nodes);
    RUN_TEST(requests_reach_the_nodes_around_a_place);
    RUN_TEST(a_change_of_tracking_reaches_everybody_at_once);
    RUN_TEST(losing_30_percent_of_the_frames_neither_loops_nor_splits);
    RUN_TEST(a_dead_parent_is_replaced_in_the_next_round);
    RUN_TEST(a_sink_that_reboots_gets_its_tree_back);
    port_exit(UNITY_END() > 0);
    return 0;
}
