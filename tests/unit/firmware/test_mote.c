/* The mote event by event, on a port and under a tracker that write down what they see. Protocol: direct, which adds least. */
#include "motehound/collection.h"
#include "motehound/direct.h"
#include "motehound/mote.h"
#include "port.h"
#include "unity.h"

#include <string.h>

#define T 1000u
#define HEAD 1u
#define NODE 2u

/* A sensor node under the larger protocol fits in 256 bytes of an ATmega128. */
#ifdef __AVR__
typedef char sensor_node_fits[sizeof(struct mh_mote) + sizeof(struct mh_collection) <= 256 ? 1 : -1];
#endif

static mh_wire_types spoken[] = {&mh_wire_beacon, &mh_wire_request, &mh_wire_report, &mh_wire_sync, NULL};

static struct {
    unsigned transmitted, alarms, reports, sleeps;
    mh_node_id destination;
    struct mh_message message; /* the last one transmitted */
    mh_tick alarm;
    mh_tick report_time;
    bool may_sleep;
} port_saw;

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    (void)context;
    port_saw.transmitted++;
    port_saw.destination = destination;
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(spoken, frame, length, &port_saw.message));
}

static void set_alarm(void *context, mh_tick time)
{
    (void)context;
    port_saw.alarms++;
    port_saw.alarm = time;
}

static void report(void *context, const struct mh_estimate *estimate)
{
    (void)context;
    port_saw.reports++;
    port_saw.report_time = estimate->time;
}

static void sleep_or_listen(void *context, bool may_sleep)
{
    (void)context;
    port_saw.sleeps++;
    port_saw.may_sleep = may_sleep;
}

static const struct mh_port port = {
    .transmit = transmit, .set_alarm = set_alarm, .report = report, .sleep = sleep_or_listen};

static struct {
    enum mh_status step_status, interest_status;
    struct mh_interest interest;
    size_t count;
    struct mh_measurement first;
} tracker_does;

static enum mh_status tracker_init(void *state, const void *config, mh_tick interval)
{
    (void)state;
    (void)config;
    (void)interval;
    return MH_OK;
}

static enum mh_status tracker_step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                                   struct mh_estimate *estimate)
{
    (void)state;
    tracker_does.count = count;
    if (count > 0) {
        tracker_does.first = measurements[0];
    }
    if (tracker_does.step_status == MH_OK) {
        memset(estimate, 0, sizeof *estimate);
        estimate->time = time;
    }
    return tracker_does.step_status;
}

static enum mh_status tracker_predict(const void *state, mh_tick time, struct mh_estimate *expected)
{
    (void)state;
    (void)time;
    (void)expected;
    return tracker_does.step_status;
}

static enum mh_status tracker_interest(const void *state, struct mh_interest *interest)
{
    (void)state;
    *interest = tracker_does.interest;
    return tracker_does.interest_status;
}

static const struct mh_tracker tracker = {.name = "script",
                                          .init = tracker_init,
                                          .step = tracker_step,
                                          .predict = tracker_predict,
                                          .interest = tracker_interest};

static struct mh_sensor_config sensor;
static struct mh_head_config head_config;
static struct mh_head head;
static struct mh_direct_config direct_config;
static struct mh_direct direct;
static struct mh_mote_config config;
static struct mh_mote mote;

void setUp(void)
{
    const struct mh_sensor_config plain_sensor = {
        .q20_per_count = 1, .counts_max = 1000, .interval = T, .threshold = 100};
    const struct mh_head_config plain_head = {&tracker, "", &tracker_does, 0, T, 400, 0, false, 0};
    const struct mh_mote_config sensor_node = {.id = NODE,
                                               .place = {3000, 4000, 5000},
                                               .sensor = &sensor,
                                               .protocol = &mh_protocol_direct,
                                               .protocol_config = &direct_config,
                                               .protocol_state = &direct};
    sensor = plain_sensor;
    head_config = plain_head;
    config = sensor_node;
    mh_direct_config_default(&direct_config);
    memset(&port_saw, 0, sizeof port_saw);
    memset(&tracker_does, 0, sizeof tracker_does);
    tracker_does.step_status = tracker_does.interest_status = MH_NONE;
}

void tearDown(void) {}

static void come_up(mh_tick now) { TEST_ASSERT_EQUAL(MH_OK, mh_mote_init(&mote, &config, &port, NULL, now)); }

static void come_up_as_head(mh_tick now)
{
    config.id = HEAD;
    config.head = &head_config;
    config.head_state = &head;
    come_up(now);
}

/* What was heard or sent last; one place for both spares the small boards' stack. */
static struct mh_message *said(enum mh_message_kind kind)
{
    memset(&port_saw.message, 0, sizeof port_saw.message);
    port_saw.message.kind = kind;
    return &port_saw.message;
}

static void receive(mh_tick now, const struct mh_message *message)
{
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_encode(spoken, message, frame, &length));
    TEST_ASSERT_EQUAL(MH_OK, mh_mote_frame(&mote, now, frame, length));
}

static void receive_beacon(mh_tick now, bool tracking)
{
    struct mh_message *message = said(MH_MESSAGE_BEACON);
    message->as.beacon.sender = message->as.beacon.sink = HEAD;
    message->as.beacon.round = 1;
    message->as.beacon.tracking = tracking;
    receive(now, message);
}

static void receive_request(mh_tick now, mh_tick time, int32_t radius_mm)
{
    struct mh_message *message = said(MH_MESSAGE_REQUEST);
    message->as.request.sender = message->as.request.origin = HEAD;
    message->as.request.time_ms = (int32_t)time;
    message->as.request.radius_mm = radius_mm;
    receive(now, message);
}

static void read(mh_tick time, int32_t counts, enum mh_status expected)
{
    const struct mh_reading reading = {time, counts, 0};
    TEST_ASSERT_EQUAL(expected, mh_mote_reading(&mote, time, &reading));
}

static struct {
    unsigned fates;
    enum mh_sent last;
    mh_tick time;
} protocol_saw;

/* A protocol that sends again in 7 ticks what was not acknowledged. */
static void protocol_sent(void *state, mh_tick now, enum mh_sent outcome)
{
    struct mh_direct *d = state;
    protocol_saw.fates++;
    protocol_saw.last = outcome;
    protocol_saw.time = now;
    if (outcome == MH_SENT_NO_ACK) {
        d->node->port->set_timer(d->node->context, now + 7);
    }
}

static void the_fate_of_a_frame_goes_to_the_protocol(void)
{
    struct mh_protocol retrying = mh_protocol_direct;
    retrying.sent = protocol_sent;
    config.protocol = &retrying;
    memset(&protocol_saw, 0, sizeof protocol_saw);
    come_up(0);
    receive_beacon(10, false);
    read(T, 500, MH_OK);
    read(2 * T, 800, MH_OK);
    const unsigned alarms = port_saw.alarms;
    mh_mote_sent(&mote, 2 * T + 3, MH_SENT_OK);
    TEST_ASSERT_EQUAL(1, protocol_saw.fates);
    TEST_ASSERT_EQUAL(MH_SENT_OK, protocol_saw.last);
    TEST_ASSERT_EQUAL_UINT32(2 * T + 3, protocol_saw.time);
    TEST_ASSERT_EQUAL(alarms, port_saw.alarms);
    mh_mote_sent(&mote, 2 * T + 5, MH_SENT_NO_ACK);
    TEST_ASSERT_EQUAL(MH_SENT_NO_ACK, protocol_saw.last);
    TEST_ASSERT_EQUAL_UINT32(2 * T + 12, port_saw.alarm);
    config.protocol = &mh_protocol_direct; /* which does not care */
    mh_mote_sent(&mote, 2 * T + 6, MH_SENT_BUSY);
    TEST_ASSERT_EQUAL(2, protocol_saw.fates);
}

static void bad_configurations_are_refused(void)
{
    const struct mh_mote_config good = config;
    config.id = MH_BROADCAST;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_mote_init(&mote, &config, &port, NULL, 0));
    config = good;
    config.place.z_mm = 1000000001;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_mote_init(&mote, &config, &port, NULL, 0));
    config = good;
    config.protocol_state = NULL;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_mote_init(&mote, &config, &port, NULL, 0));
    config = good;
    config.head = &head_config; /* but no room for its state */
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_mote_init(&mote, &config, &port, NULL, 0));
    config = good;
    sensor.interval = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_mote_init(&mote, &config, &port, NULL, 0));
    sensor.interval = T;
    direct_config.beacon_period = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_mote_init(&mote, &config, &port, NULL, 0));
}

/* The root's sync message `number`, heard at `now`: its last one ended at `network`. */
static void receive_sync(mh_tick now, uint8_t number, mh_tick network)
{
    struct mh_message *message = said(MH_MESSAGE_SYNC);
    message->as.sync.sender = message->as.sync.root = HEAD;
    message->as.sync.time_ms = (int32_t)network;
    message->as.sync.fraction = 128;
    message->as.sync.stamped = number > 1;
    message->as.sync.number = number;
    message->as.sync.round = number;
    receive(now, message);
}

static struct mh_clock clock;
static const struct mh_clock_config keeps_time = {.period = 15000, .wait = 1500, .sent_q8 = 128};

/* Its own clock shows 1,000,000 more than the network's time. */
static void a_node_speaks_the_networks_time(void)
{
    const mh_tick ahead = 1000000;
    config.clock = &mh_clock_flooding;
    config.clock_config = &keeps_time;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_mote_init(&mote, &config, &port, NULL, 0)); /* no room for its state */
    config.clock_state = &clock;
    come_up(ahead);
    receive_beacon(ahead + 1, false);
    read(ahead + 100, 500, MH_ERR_TIME); /* nobody knows when that was */
    TEST_ASSERT_EQUAL_UINT32(1, mote.counters.readings_unsynchronised);
    TEST_ASSERT_EQUAL(0, port_saw.transmitted);
    receive_sync(ahead + 200, 1, 0);
    receive_sync(ahead + 700, 2, 200);
    read(ahead + T, 500, MH_OK);
    TEST_ASSERT_EQUAL(MH_MESSAGE_REPORT, port_saw.message.kind);
    TEST_ASSERT_EQUAL_INT32(T, port_saw.message.as.report.time_ms);
    receive_request(ahead + 2 * T - 10, 2 * T, 10000000);
    read(ahead + 2 * T, 0, MH_OK); /* worth no report but asked for */
    TEST_ASSERT_EQUAL_UINT32(1, mote.counters.reports_asked);
    TEST_ASSERT_EQUAL_INT32(2 * T, port_saw.message.as.report.time_ms);
    /* the alarm is in its own time: the round is relayed */
    TEST_ASSERT_TRUE(port_saw.alarm - (ahead + 200) <= 1502);
    mh_mote_alarm(&mote, port_saw.alarm);
    TEST_ASSERT_EQUAL(MH_MESSAGE_SYNC, port_saw.message.kind);
    TEST_ASSERT_EQUAL_UINT32(MH_BROADCAST, port_saw.destination);
    TEST_ASSERT_EQUAL(0, port_saw.sleeps); /* it has to listen */
}

/* A head that is not the root: no instant before the time is known, then the network's, at its own time of them. */
static void a_head_keeps_the_networks_instants(void)
{
    const mh_tick ahead = 777;
    config.clock = &mh_clock_flooding;
    config.clock_config = &keeps_time;
    config.clock_state = &clock;
    come_up_as_head(ahead);
    mh_mote_alarm(&mote, ahead + 5 * T);
    TEST_ASSERT_EQUAL(0, head.counters.estimates);
    TEST_ASSERT_EQUAL_UINT32(T, head.instant); /* not closed */
    receive_sync(ahead + 6 * T, 1, 0);
    receive_sync(ahead + 6 * T + 500, 2, 6 * T);
    TEST_ASSERT_EQUAL_UINT32(7 * T, head.instant);
    tracker_does.step_status = MH_OK;
    for (mh_tick due = 7 * T + 400; due < 20 * T; due += T) { /* one position an instant, never at once again */
        while (port_saw.alarm != ahead + due) {
            const mh_tick alarm = port_saw.alarm;
            TEST_ASSERT_TRUE(mh_tick_before(alarm, ahead + due));
            mh_mote_alarm(&mote, alarm);
            TEST_ASSERT_TRUE(mh_tick_before(alarm, port_saw.alarm));
        }
        mh_mote_alarm(&mote, port_saw.alarm);
        TEST_ASSERT_EQUAL_UINT32(due - 400, port_saw.report_time);
    }
    TEST_ASSERT_EQUAL(13, port_saw.reports);
}

static void a_node_reports_what_is_worth_it(void)
{
    come_up(0);
    read(T, 101, MH_OK); /* above chi, but there is nobody to tell */
    TEST_ASSERT_EQUAL_UINT32(1, mote.counters.reports_no_route);
    receive_beacon(T + 1, false);
    read(2 * T, 150, MH_OK); /* an increment below chi, but nothing is tracked */
    TEST_ASSERT_EQUAL(1, port_saw.transmitted);
    TEST_ASSERT_EQUAL_UINT32(HEAD, port_saw.destination);
    TEST_ASSERT_EQUAL(MH_MESSAGE_REPORT, port_saw.message.kind);
    TEST_ASSERT_EQUAL_INT32(NODE, port_saw.message.as.report.origin);
    TEST_ASSERT_EQUAL_INT32(2 * T, port_saw.message.as.report.time_ms);
    TEST_ASSERT_EQUAL_INT32(5000, port_saw.message.as.report.z_mm);
    TEST_ASSERT_EQUAL_INT32(150, port_saw.message.as.report.value_q20);
    TEST_ASSERT_EQUAL_INT32(49, port_saw.message.as.report.increment_q20);
    TEST_ASSERT_EQUAL_UINT8(MH_MEASUREMENT_HAS_INCREMENT, port_saw.message.as.report.flags);
    receive_beacon(2 * T + 1, true);
    read(3 * T, 160, MH_OK); /* the same again, now that there is a track */
    TEST_ASSERT_EQUAL(1, port_saw.transmitted);
    read(4 * T, 260, MH_OK);
    TEST_ASSERT_EQUAL(2, port_saw.transmitted);
    TEST_ASSERT_EQUAL_UINT32(4, mote.counters.readings);
    TEST_ASSERT_EQUAL_UINT32(3, mote.counters.reports);
    TEST_ASSERT_EQUAL_UINT32(0, mote.counters.reports_asked);
}

static void bad_readings_leave_no_trace(void)
{
    come_up(0);
    receive_beacon(1, true);
    read(T, 0, MH_OK);
    read(2 * T, 1001, MH_ERR_RANGE);
    read(T, 1000, MH_ERR_REPEATED);
    const struct mh_reading future = {900 * T, 0, 0};
    TEST_ASSERT_EQUAL(MH_ERR_TIME, mh_mote_reading(&mote, 2 * T, &future));
    read(2 * T, 100, MH_OK);
    TEST_ASSERT_EQUAL_INT32(100, port_saw.message.as.report.increment_q20);
    TEST_ASSERT_EQUAL_UINT32(2, mote.counters.readings);
    TEST_ASSERT_EQUAL_UINT32(2, mote.counters.readings_refused);
    TEST_ASSERT_EQUAL_UINT32(1, mote.counters.readings_repeated);
    config.sensor = NULL;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_mote_reading(&mote, 3 * T, &future));
}

static void a_silent_node_answers_when_asked(void)
{
    come_up(0);
    receive_beacon(1, true);
    receive_request(2, T, 5000); /* ahead of the sample; the node stands 5 m from the centre */
    TEST_ASSERT_EQUAL(0, port_saw.transmitted);
    read(T, 3, MH_OK);
    TEST_ASSERT_EQUAL(1, port_saw.transmitted);
    TEST_ASSERT_EQUAL_UINT8(MH_MEASUREMENT_ASKED, port_saw.message.as.report.flags);
    receive_request(T + 1, T, 5000); /* it has told that already */
    read(2 * T, 4, MH_OK);           /* and nobody has asked for this ... */
    TEST_ASSERT_EQUAL(1, port_saw.transmitted);
    receive_request(2 * T + 300, 2 * T, 5000); /* ... until now: from memory */
    TEST_ASSERT_EQUAL(2, port_saw.transmitted);
    TEST_ASSERT_EQUAL_INT32(2 * T, port_saw.message.as.report.time_ms);
    TEST_ASSERT_EQUAL_UINT8(MH_MEASUREMENT_ASKED | MH_MEASUREMENT_HAS_INCREMENT, port_saw.message.as.report.flags);
    receive_request(2 * T + 400, 3 * T, 4999); /* too far off to be meant */
    read(3 * T, 5, MH_OK);
    TEST_ASSERT_EQUAL(2, port_saw.transmitted);
    TEST_ASSERT_EQUAL_UINT32(2, mote.counters.reports_asked);
}

static void a_due_answer_is_not_flagged(void)
{
    come_up(0);
    receive_beacon(1, false);
    receive_request(2, T, 5000);
    read(T, 500, MH_OK);
    TEST_ASSERT_EQUAL(1, port_saw.transmitted);
    TEST_ASSERT_EQUAL_UINT8(0, port_saw.message.as.report.flags);
}

static void a_request_may_lapse(void)
{
    come_up(0);
    receive_beacon(1, true);
    receive_request(2, T, 5000);
    read(2 * T, 0, MH_OK);
    TEST_ASSERT_TRUE(mote.asked);
    read(4 * T, 0, MH_OK);
    TEST_ASSERT_FALSE(mote.asked);
    TEST_ASSERT_EQUAL(0, port_saw.transmitted);
}

static void unsound_frames_are_counted(void)
{
    come_up(0);
    uint8_t frame[16] = {1};
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_mote_frame(&mote, 0, frame, 16));
    const uint16_t fcs = mh_wire_fcs(frame, 14);
    frame[14] = (uint8_t)(fcs & 0xFFu);
    frame[15] = (uint8_t)(fcs >> 8);
    TEST_ASSERT_EQUAL(MH_ERR_UNKNOWN, mh_mote_frame(&mote, 0, frame, 16));
    TEST_ASSERT_EQUAL_UINT32(1, mote.counters.frames_corrupt);
    TEST_ASSERT_EQUAL_UINT32(1, mote.counters.frames_unknown);
    TEST_ASSERT_EQUAL_UINT32(0, mote.counters.frames_received);
}

static void a_head_gathers_steps_and_reports(void)
{
    come_up_as_head(T - 500);
    TEST_ASSERT_EQUAL_UINT32(T - 499, port_saw.alarm); /* the protocol's */
    mh_mote_alarm(&mote, T - 499);
    TEST_ASSERT_EQUAL(MH_MESSAGE_BEACON, port_saw.message.kind);
    TEST_ASSERT_EQUAL_UINT32(T + 400, port_saw.alarm); /* the head's own */
    read(T, 200, MH_OK);                               /* its own sensor needs no frame */
    const struct mh_message message = {.kind = MH_MESSAGE_REPORT,
                                       .as.report = {.sender = 9, .origin = 0, .time_ms = T, .increment_q20 = 7}};
    receive(T + 20, &message);
    tracker_does.step_status = MH_OK;
    mh_mote_alarm(&mote, T + 399); /* early */
    TEST_ASSERT_EQUAL(0, port_saw.reports);
    TEST_ASSERT_EQUAL_UINT32(T + 400, port_saw.alarm);
    mh_mote_alarm(&mote, T + 400);
    TEST_ASSERT_EQUAL(2, tracker_does.count);
    TEST_ASSERT_EQUAL_UINT32(0, tracker_does.first.node);
    TEST_ASSERT_EQUAL_INT32(7, tracker_does.first.increment);
    TEST_ASSERT_EQUAL(1, port_saw.reports);
    TEST_ASSERT_EQUAL_UINT32(T, port_saw.report_time);
    TEST_ASSERT_EQUAL_UINT32(2 * T + 400, port_saw.alarm);
    mh_mote_alarm(&mote, T + 400); /* repeated */
    TEST_ASSERT_EQUAL(1, port_saw.reports);
}

static void a_head_tells_when_a_track_begins_and_ends(void)
{
    come_up_as_head(0);
    mh_mote_alarm(&mote, 1);
    TEST_ASSERT_EQUAL(1, port_saw.transmitted);
    mh_mote_alarm(&mote, 400);
    TEST_ASSERT_EQUAL(1, port_saw.transmitted); /* nothing has changed */
    tracker_does.step_status = MH_OK;
    mh_mote_alarm(&mote, T + 400);
    TEST_ASSERT_EQUAL(2, port_saw.transmitted);
    TEST_ASSERT_EQUAL_UINT8(1, port_saw.message.as.beacon.tracking);
    TEST_ASSERT_TRUE(mote.tracking);
    mh_mote_alarm(&mote, 2 * T + 400);
    TEST_ASSERT_EQUAL(2, port_saw.transmitted);
    tracker_does.step_status = MH_NONE;
    mh_mote_alarm(&mote, 3 * T + 400);
    TEST_ASSERT_EQUAL(3, port_saw.transmitted);
    TEST_ASSERT_EQUAL_UINT8(0, port_saw.message.as.beacon.tracking);
    TEST_ASSERT_FALSE(mote.tracking);
}

static void a_head_asks_for_the_next_instant(void)
{
    come_up_as_head(0);
    tracker_does.interest_status = MH_OK;
    tracker_does.interest.centre.x_mm = 3000;
    tracker_does.interest.centre.y_mm = 4000;
    tracker_does.interest.radius_mm = UINT32_MAX;
    mh_mote_alarm(&mote, 400);
    TEST_ASSERT_EQUAL(MH_MESSAGE_REQUEST, port_saw.message.kind);
    TEST_ASSERT_EQUAL_UINT32(MH_BROADCAST, port_saw.destination);
    TEST_ASSERT_EQUAL_INT32(T, port_saw.message.as.request.time_ms);
    TEST_ASSERT_EQUAL_INT32(4000, port_saw.message.as.request.y_mm);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, port_saw.message.as.request.radius_mm); /* the most that a request carries */
    read(T, 1, MH_OK);                                                         /* its own sensor is asked too */
    TEST_ASSERT_EQUAL_UINT16(1, head.count);
    TEST_ASSERT_EQUAL_UINT8(MH_MEASUREMENT_ASKED, head.measurements[0].flags);
}

static void a_late_alarm_is_made_up_for(void)
{
    come_up_as_head(0);
    tracker_does.step_status = MH_OK;
    for (unsigned call = 1; call <= 5; call++) {
        mh_mote_alarm(&mote, 4 * T + 500);
        TEST_ASSERT_EQUAL(call, port_saw.reports);
        TEST_ASSERT_EQUAL_UINT32((call - 1) * T, port_saw.report_time);
    }
    TEST_ASSERT_EQUAL_UINT32(5 * T + 400, port_saw.alarm);
}

static void a_node_sleeps_between_beacons(void)
{
    direct_config.sleeps = true;
    come_up(0);
    TEST_ASSERT_EQUAL(0, port_saw.sleeps); /* it listens from the start */
    receive_beacon(50, false);
    TEST_ASSERT_TRUE(port_saw.may_sleep);
    TEST_ASSERT_EQUAL_UINT32(50 + 10000 - 625, port_saw.alarm);
    mh_mote_alarm(&mote, port_saw.alarm);
    TEST_ASSERT_FALSE(port_saw.may_sleep);
    TEST_ASSERT_EQUAL(2, port_saw.sleeps);
    receive_beacon(10049, false);
    TEST_ASSERT_EQUAL(3, port_saw.sleeps);
    receive_beacon(10050, false);
    TEST_ASSERT_EQUAL(3, port_saw.sleeps); /* only changes are told */
}

/* The wait of node `id` before it reports the sample of `instant`. */
static mh_tick wait_of(mh_node_id id, mh_tick instant)
{
    config.id = id;
    come_up(instant - T);
    receive_beacon(instant - T + 1, false);
    port_saw.transmitted = 0;
    read(instant, 500, MH_OK);
    TEST_ASSERT_EQUAL(0, port_saw.transmitted);
    const mh_tick wait = port_saw.alarm - instant;
    mh_mote_alarm(&mote, port_saw.alarm);
    TEST_ASSERT_EQUAL(1, port_saw.transmitted);
    TEST_ASSERT_EQUAL_INT32(instant, port_saw.message.as.report.time_ms);
    return wait;
}

static void reports_of_one_instant_are_spread(void)
{
    enum { SPREAD = 400, PARTS = 4, NODES = 100 };
    unsigned share[PARTS] = {0}, changed = 0;
    sensor.report_spread = SPREAD;
    for (mh_node_id id = NODE; id < NODE + NODES; id++) {
        const mh_tick wait = wait_of(id, 5 * T);
        TEST_ASSERT_TRUE(wait < SPREAD);
        share[wait * PARTS / SPREAD]++;
        changed += wait_of(id, 6 * T) != wait;
    }
    for (unsigned part = 0; part < PARTS; part++) { /* 25 expected, standard deviation 4.3 */
        TEST_ASSERT_UINT_WITHIN(17, NODES / PARTS, share[part]);
    }
    TEST_ASSERT_TRUE(changed > NODES * 9 / 10); /* no node is always the last */
}

static void a_report_that_waits_may_lapse(void)
{
    sensor.report_spread = 400;
    come_up(0);
    receive_beacon(1, false);
    read(T, 101, MH_OK); /* worth a report while nothing is tracked */
    const struct mh_message news = {.kind = MH_MESSAGE_BEACON,
                                    .as.beacon = {.sender = HEAD, .sink = HEAD, .round = 2, .tracking = 1}};
    const mh_tick due = port_saw.alarm;
    receive(T, &news);
    mh_mote_alarm(&mote, due);
    TEST_ASSERT_EQUAL(0, port_saw.transmitted);
    read(2 * T, 301, MH_OK); /* worth one, and asked for while it waits: one report, without the flag */
    receive_request(2 * T, 2 * T, 10000000);
    mh_mote_alarm(&mote, port_saw.alarm);
    TEST_ASSERT_EQUAL(1, port_saw.transmitted);
    TEST_ASSERT_EQUAL(0, mote.counters.reports_asked);
    read(3 * T, 301, MH_OK); /* not worth one, asked for late: it waits too */
    receive_request(3 * T + 1, 3 * T, 10000000);
    TEST_ASSERT_EQUAL(1, port_saw.transmitted);
    mh_mote_alarm(&mote, port_saw.alarm);
    TEST_ASSERT_EQUAL(2, port_saw.transmitted);
    TEST_ASSERT_EQUAL(1, mote.counters.reports_asked);
}

static void the_next_reading_does_not_overtake_a_report(void)
{
    sensor.report_spread = 400;
    come_up(0);
    receive_beacon(1, false);
    read(T, 500, MH_OK);
    const struct mh_reading other = {T, 800, 1}; /* of another target, at the same time */
    TEST_ASSERT_EQUAL(MH_OK, mh_mote_reading(&mote, T, &other));
    TEST_ASSERT_EQUAL(1, port_saw.transmitted);
    TEST_ASSERT_EQUAL_INT32(500, port_saw.message.as.report.value_q20);
    mh_mote_alarm(&mote, port_saw.alarm);
    TEST_ASSERT_EQUAL(2, port_saw.transmitted);
    TEST_ASSERT_EQUAL_INT32(800, port_saw.message.as.report.value_q20);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bad_configurations_are_refused);
    RUN_TEST(a_node_speaks_the_networks_time);
    RUN_TEST(a_head_keeps_the_networks_instants);
    RUN_TEST(a_node_reports_what_is_worth_it);
    RUN_TEST(bad_readings_leave_no_trace);
    RUN_TEST(a_silent_node_answers_when_asked);
    RUN_TEST(a_due_answer_is_not_flagged);
    RUN_TEST(a_request_may_lapse);
    RUN_TEST(unsound_frames_are_counted);
    RUN_TEST(a_head_gathers_steps_and_reports);
    RUN_TEST(a_head_tells_when_a_track_begins_and_ends);
    RUN_TEST(a_head_asks_for_the_next_instant);
    RUN_TEST(a_late_alarm_is_made_up_for);
    RUN_TEST(a_node_sleeps_between_beacons);
    RUN_TEST(the_fate_of_a_frame_goes_to_the_protocol);
    RUN_TEST(reports_of_one_instant_are_spread);
    RUN_TEST(a_report_that_waits_may_lapse);
    RUN_TEST(the_next_reading_does_not_overtake_a_report);
    port_exit(UNITY_END() > 0);
    return 0;
}
