/* One mote's side of `fixed`, message by message. Whole networks: tests/network. */
#include "motehound/fixed.h"
#include "motehound/geographic.h"
#include "port.h"
#include "unity.h"

#include <string.h>

enum { SINK = 1, RELAY = 5, T = 1000 };

static const struct mh_fixed_member first_members[] = {{11, {30000, 0, 0}}, {12, {32000, 0, 0}}, {13, {34000, 0, 0}}};
static const struct mh_fixed_member second_members[] = {{21, {0, 30000, 0}}, {22, {0, 32000, 0}}};
static const struct mh_fixed_cluster clusters[] = {{first_members, 3}, {second_members, 2}};

/* What the protocol did last, and how often. */
static struct {
    unsigned sent, leads, takens, parts, reports, delivered, led, followed, told;
    mh_node_id destination;
    struct mh_message message;
    mh_tick timer;
    mh_tick network_ahead; /* network time - own time */
    bool unknown;          /* the network's time */
    enum mh_status lead_status;
    size_t track_length; /* that it led with */
    bool refuses_track;
    size_t saved_length;
} saw;

/* What was asked of tracker and centre, and what they answer. */
static struct {
    unsigned summarised, taken, corrected, begun, offered, fused;
    mh_tick time;
    uint8_t cluster, first;
    size_t length, summary_length, feedback_length;
    enum mh_status take_status, correct_status, fuse_status;
} asked;

static void send(void *context, mh_node_id destination, const struct mh_message *message)
{
    (void)context;
    saw.sent++;
    saw.leads += message->kind == MH_MESSAGE_LEAD;
    saw.takens += message->kind == MH_MESSAGE_TAKEN;
    saw.parts += message->kind == MH_MESSAGE_HAND_OVER;
    saw.reports += message->kind == MH_MESSAGE_REPORT;
    if (message->kind != MH_MESSAGE_HELLO) {
        saw.destination = destination;
        saw.message = *message;
    }
}

static void set_timer(void *context, mh_tick time)
{
    (void)context;
    saw.timer = time;
}

static void deliver(void *context, mh_tick now, const struct mh_measurement *measurement)
{
    (void)context;
    (void)now;
    (void)measurement;
    saw.delivered++;
}

static bool network(void *context, mh_tick own, mh_tick *time)
{
    (void)context;
    *time = own + saw.network_ahead;
    return !saw.unknown;
}

static mh_tick own(void *context, mh_tick time)
{
    (void)context;
    return time - saw.network_ahead;
}

static enum mh_status lead(void *context, mh_tick now, const uint8_t *track, size_t length)
{
    (void)context;
    (void)now;
    if (length > 0 && (saw.refuses_track || track[0] != 9)) {
        return MH_ERR_CORRUPT;
    }
    saw.led++;
    saw.track_length = length;
    return saw.lead_status;
}

static enum mh_status save(void *context, uint8_t *track, size_t *length)
{
    (void)context;
    memset(track, 9, saw.saved_length);
    *length = saw.saved_length;
    return saw.saved_length > 0 ? MH_OK : MH_NONE;
}

static void follow(void *context)
{
    (void)context;
    saw.followed++;
}

static void tell(void *context, const struct mh_estimate *estimate)
{
    (void)context;
    (void)estimate;
    saw.told++;
}

static const struct mh_protocol_port port = {.send = send,
                                             .set_timer = set_timer,
                                             .deliver = deliver,
                                             .network = network,
                                             .own = own,
                                             .lead = lead,
                                             .follow = follow,
                                             .save = save,
                                             .tell = tell};

static enum mh_status summarise(void *context, mh_tick time, uint8_t *bytes, size_t *length)
{
    (void)context;
    asked.summarised++;
    asked.time = time;
    for (uint8_t i = 0; i < asked.summary_length; i++) {
        bytes[i] = (uint8_t)(i + 1);
    }
    *length = asked.summary_length;
    return asked.summary_length > 0 ? MH_OK : MH_NONE;
}

static void summary_taken(void *context, mh_tick time)
{
    (void)context;
    asked.taken++;
    asked.time = time;
}

static enum mh_status correct(void *context, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length)
{
    (void)context;
    asked.corrected++;
    asked.cluster = cluster;
    asked.time = time;
    asked.first = bytes[0];
    asked.length = length;
    return asked.correct_status;
}

static enum mh_status begin(void *context)
{
    (void)context;
    asked.begun++;
    return MH_OK;
}

static enum mh_status take(void *context, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length)
{
    (void)context;
    asked.offered++;
    asked.cluster = cluster;
    asked.time = time;
    asked.first = bytes[0];
    asked.length = length;
    return asked.take_status;
}

static enum mh_status fuse(void *context, mh_tick time, struct mh_estimate *estimate)
{
    (void)context;
    asked.fused++;
    asked.time = time;
    memset(estimate, 0, sizeof *estimate);
    return asked.fuse_status;
}

static enum mh_status feedback(void *context, uint8_t *bytes, size_t *length)
{
    (void)context;
    memset(bytes, 7, asked.feedback_length);
    *length = asked.feedback_length;
    return asked.feedback_length > 0 ? MH_OK : MH_NONE;
}

static const struct mh_fixed_port tracks = {summarise, summary_taken, correct, begin, take, fuse, feedback};

static const struct mh_protocol *const fixed = &mh_protocol_fixed;
static struct mh_fixed_config config;
static struct mh_protocol_node node;
static struct mh_fixed state;

/* A neighbour of all, half way to the sink. */
static void hear_hello(mh_tick now, mh_node_id sender, int32_t x_mm, int32_t y_mm)
{
    const struct mh_message message = {.kind = MH_MESSAGE_HELLO,
                                       .as.hello = {.sender = (int32_t)sender, .x_mm = x_mm, .y_mm = y_mm}};
    fixed->message(&state, now, &message);
}

static void come_up(mh_node_id id, int32_t x_mm, int32_t y_mm)
{
    const struct mh_protocol_node plain = {.id = id, .place = {x_mm, y_mm, 0}, .is_head = id > RELAY, .port = &port};
    memset(&saw, 0, sizeof saw);
    memset(&asked, 0, sizeof asked);
    asked.summary_length = 57;
    asked.fuse_status = MH_NONE;
    node = plain;
    TEST_ASSERT_EQUAL(MH_OK, fixed->init(&state, &config, &node));
    fixed->start(&state, 0);
    hear_hello(0, RELAY, 10000, 10000);
}

void setUp(void)
{
    mh_fixed_config_default(&config);
    config.port = &tracks;
    config.sink = SINK;
    config.clusters = clusters;
    config.cluster_count = 2;
}

void tearDown(void) {}

/* Run the timers that are due until then; whatever is sent to a neighbour arrives. */
static void run(mh_tick until)
{
    for (int i = 0; i < 200 && !mh_tick_before(until, saw.timer); i++) {
        const unsigned before = saw.sent;
        fixed->timer(&state, saw.timer);
        for (unsigned k = before; k < saw.sent; k++) {
            fixed->sent(&state, saw.timer, MH_SENT_OK);
        }
    }
}

/* The fate of all that has been sent since: the neighbour has it. */
static void all_arrives(mh_tick now)
{
    for (unsigned told = 0; told < 8 && (state.link.in_air || state.link.ahead > 0); told++) {
        fixed->sent(&state, now, MH_SENT_OK);
    }
}

static void hear_lead(mh_tick now, mh_node_id sender, mh_tick since, uint8_t cluster)
{
    const struct mh_message message = {
        .kind = MH_MESSAGE_LEAD,
        .as.lead = {.sender = (int32_t)sender, .since_ms = (int32_t)since, .cluster = cluster}};
    fixed->message(&state, now, &message);
}

static void publish(mh_tick now)
{
    const struct mh_measurement measurement = {.node = node.id, .place = node.place, .time = now};
    TEST_ASSERT_EQUAL(MH_OK, fixed->publish(&state, now, &measurement));
}

/* From `origin` to this node, or to another. */
static void hear(mh_tick now, struct mh_message *message, mh_node_id origin, mh_node_id destination)
{
    static int16_t sequence;
    const struct mh_place place = {0, 0, 0};
    mh_geographic_address(message, origin, sequence++, destination, &place);
    fixed->message(&state, now, message);
}

static void hear_bytes(mh_tick now, mh_node_id origin, int32_t cluster, mh_tick time, size_t length)
{
    struct mh_message message = {
        .kind = MH_MESSAGE_HAND_OVER,
        .as.hand_over = {.track = cluster, .generation = (int32_t)time, .time_ms = (int32_t)time}};
    uint8_t bytes[MH_SUMMARY_BYTES_MAX];
    memset(bytes, 42, sizeof bytes);
    for (uint8_t part = 0; part < MH_PARCEL_PARTS(length); part++) {
        mh_parcel_cut(bytes, length, part, &message.as.hand_over);
        hear(now, &message, origin, node.id);
    }
}

static void hear_taken(mh_tick now, mh_node_id origin, uint8_t cluster, mh_tick time)
{
    struct mh_message message = {.kind = MH_MESSAGE_TAKEN, .as.taken = {.time_ms = (int32_t)time, .cluster = cluster}};
    hear(now, &message, origin, node.id);
}

/* ---- who leads ---- */

static void the_first_member_leads_at_once_and_says_so(void)
{
    come_up(11, 30000, 0);
    TEST_ASSERT_EQUAL(1, saw.led);
    TEST_ASSERT_EQUAL(MH_FIXED_HEAD, state.role);
    run(10 * T);
    const unsigned often = saw.leads;
    TEST_ASSERT_UINT_WITHIN(2, 11, often); /* once an interval, or up to a quarter earlier */
    run(20 * T);
    TEST_ASSERT_UINT_WITHIN(2, 11, saw.leads - often);
    TEST_ASSERT_EQUAL(1, saw.led);
}

static void the_others_wait_one_after_the_other(void)
{
    come_up(12, 32000, 0);
    run(3 * T - 1);
    TEST_ASSERT_EQUAL(0, saw.led);
    run(3 * T);
    TEST_ASSERT_EQUAL(1, saw.led);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.taken_over);
    come_up(13, 34000, 0);
    run(4 * T - 1);
    TEST_ASSERT_EQUAL(0, saw.led);
    run(4 * T);
    TEST_ASSERT_EQUAL(1, saw.led);
}

static void a_member_that_hears_its_head_does_not_lead(void)
{
    come_up(12, 32000, 0);
    for (mh_tick now = 500; now < 20 * T; now += 2 * T) { /* every second one lost */
        run(now);
        hear_lead(now, 11, 0, 0);
    }
    TEST_ASSERT_EQUAL(0, saw.led);
    TEST_ASSERT_EQUAL(0, state.head);
    run(18500 + 3 * T - 1);
    TEST_ASSERT_EQUAL(0, saw.led);
    run(18500 + 3 * T);
    TEST_ASSERT_EQUAL(1, saw.led);
    TEST_ASSERT_EQUAL(MH_FIXED_HEAD, state.role);
}

static void sample(mh_tick now, enum mh_sent outcome)
{
    publish(now);
    fixed->sent(&state, now, outcome);
}

static void a_head_that_acknowledges_samples_is_alive(void)
{
    come_up(12, 32000, 0);
    for (mh_tick now = 500; now < 20 * T; now += 2 * T) {
        run(now);
        sample(now, MH_SENT_OK);
        if (now == 8500) {
            hear_lead(now, 11, 0, 0);
        }
    }
    TEST_ASSERT_EQUAL(0, saw.led);
    sample(19 * T, MH_SENT_NO_ACK);
    TEST_ASSERT_EQUAL_UINT32(18500 + 3 * T, state.due[MH_FIXED_WATCH]);
}

static void a_head_that_never_says_so_is_none_however_much_it_acknowledges(void)
{
    come_up(12, 32000, 0);
    for (mh_tick now = 500; now < 30 * T && saw.led == 0; now += T) {
        sample(now, MH_SENT_OK);
        run(now + T);
    }
    TEST_ASSERT_EQUAL(1, saw.led);
}

static void who_says_that_it_leads_is_believed_rather_than_who_acknowledges(void)
{
    come_up(12, 32000, 0);
    hear_lead(500, 11, 0, 0);
    for (mh_tick now = 1000; now < 5 * T; now += T) {
        run(now);
        sample(now, MH_SENT_OK);
    }
    hear_lead(5 * T, 13, 4 * T, 0);
    TEST_ASSERT_EQUAL(2, state.head);
    saw.network_ahead = (mh_tick)-2; /* the network's time is corrected a little */
    hear_lead(5 * T, 11, 5 * T, 0);
    TEST_ASSERT_EQUAL(2, state.head);
}

static void hear_sample(mh_tick now, mh_node_id origin)
{
    struct mh_message message = {.kind = MH_MESSAGE_REPORT, .as.report = {.origin = (int32_t)origin}};
    hear(now, &message, origin, node.id);
}

static void a_head_that_has_restarted_leads_when_it_is_taken_for_the_head(void)
{
    come_up(12, 32000, 0);
    hear_sample(T, 99);
    TEST_ASSERT_EQUAL(0, saw.led);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.refused);
    hear_sample(T, 13);
    TEST_ASSERT_EQUAL(1, saw.led);
    TEST_ASSERT_EQUAL(1, saw.delivered);
    hear_lead(2 * T, 11, 0, 0);
    hear_sample(2 * T, 13); /* knows nothing of that yet */
    TEST_ASSERT_EQUAL(1, saw.led);
    TEST_ASSERT_EQUAL(1, saw.delivered);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.misdirected);
}

static void who_takes_over_goes_on_with_the_track(void)
{
    come_up(11, 30000, 0);
    saw.saved_length = MH_LEAD_BYTES;
    run(10 * T);
    TEST_ASSERT_EQUAL(MH_MESSAGE_LEAD, saw.message.kind);
    TEST_ASSERT_EQUAL(MH_LEAD_BYTES, saw.message.as.lead.length);
    TEST_ASSERT_EQUAL(9, saw.message.as.lead.data[MH_LEAD_BYTES - 1]);
    const struct mh_message said = saw.message;
    saw.saved_length = MH_LEAD_BYTES + 1; /* too long to be said */
    run(12 * T);
    TEST_ASSERT_EQUAL(0, saw.message.as.lead.length);
    for (int refuses = 0; refuses < 2; refuses++) {
        come_up(12, 32000, 0);
        fixed->message(&state, 500, &said);
        saw.refuses_track = refuses == 1;
        run(500 + 3 * T);
        TEST_ASSERT_EQUAL(1, saw.led);
        TEST_ASSERT_EQUAL(refuses ? 0 : MH_LEAD_BYTES, saw.track_length);
    }
}

static void of_two_heads_the_one_that_has_led_longer_goes_on(void)
{
    come_up(12, 32000, 0);
    run(3 * T); /* leads since 3 T */
    hear_lead(3 * T + 1, 13, 3 * T, 0);
    hear_lead(3 * T + 2, 11, 3 * T + 1, 0); /* has restarted */
    hear_lead(3 * T + 3, 21, 0, 1);         /* of another cluster */
    TEST_ASSERT_EQUAL(MH_FIXED_HEAD, state.role);
    hear_lead(3 * T + 4, 11, 3 * T, 0); /* equally long, lower identifier */
    TEST_ASSERT_EQUAL(MH_FIXED_MEMBER, state.role);
    TEST_ASSERT_EQUAL(1, saw.followed);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.yielded);
    TEST_ASSERT_EQUAL(0, state.head);
    hear_lead(3 * T + 5, 13, 3 * T + 1, 0); /* not better than the one it follows */
    TEST_ASSERT_EQUAL(0, state.head);
    hear_lead(3 * T + 6, 13, 2 * T, 0);
    TEST_ASSERT_EQUAL(2, state.head);
    TEST_ASSERT_EQUAL_UINT32(0, state.counters.refused);
    hear_lead(3 * T + 7, 99, 0, 0); /* nobody knows it */
    TEST_ASSERT_EQUAL(2, state.head);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.refused);
}

static void who_cannot_lead_tries_again(void)
{
    come_up(12, 32000, 0);
    saw.lead_status = MH_ERR_ARGUMENT;
    run(3 * T);
    TEST_ASSERT_EQUAL(MH_FIXED_MEMBER, state.role);
    saw.lead_status = MH_OK;
    run(6 * T);
    TEST_ASSERT_EQUAL(MH_FIXED_HEAD, state.role);
    TEST_ASSERT_EQUAL(2, saw.led);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.taken_over);
}

static void when_the_time_jumps_all_begin_anew(void)
{
    come_up(12, 32000, 0);
    run(3 * T);
    TEST_ASSERT_EQUAL(MH_FIXED_HEAD, state.role);
    saw.network_ahead = 77777;
    fixed->time_jumped(&state, 3500);
    TEST_ASSERT_EQUAL(MH_FIXED_MEMBER, state.role);
    run(3500 + 3 * T - 1);
    TEST_ASSERT_EQUAL(MH_FIXED_MEMBER, state.role);
    run(3500 + 3 * T);
    TEST_ASSERT_EQUAL(MH_FIXED_HEAD, state.role);
    TEST_ASSERT_EQUAL_UINT32(3500 + 3 * T + 77777, state.since);
    saw.unknown = true;
    fixed->time_jumped(&state, 9000);
    const unsigned sent = saw.sent;
    hear_lead(9001, 13, 0, 0);
    fixed->timer(&state, 9100);
    const struct mh_measurement measurement = {.node = 12};
    TEST_ASSERT_EQUAL(MH_ERR_NO_ROUTE, fixed->publish(&state, 9200, &measurement));
    TEST_ASSERT_EQUAL(sent, saw.sent);
}

/* ---- samples ---- */

static void members_report_to_their_head(void)
{
    come_up(12, 32000, 0);
    publish(100);
    TEST_ASSERT_EQUAL_UINT32(11, saw.destination); /* the first member, unheard of as it is */
    TEST_ASSERT_EQUAL(MH_MESSAGE_REPORT, saw.message.kind);
    TEST_ASSERT_EQUAL_INT32(11, saw.message.header.route.destination);
    all_arrives(110);
    hear_lead(200, 13, 50, 0);
    publish(300);
    TEST_ASSERT_EQUAL_UINT32(13, saw.destination);
    TEST_ASSERT_EQUAL_INT32(34000, saw.message.header.route.x_mm);
    all_arrives(310);
    TEST_ASSERT_EQUAL(2, saw.reports);
}

/* What waits to be sent goes to whoever leads then. */
static void reports_that_wait_go_to_the_new_head(void)
{
    come_up(12, 32000, 0);
    hear_lead(50, 11, 0, 0);
    publish(100);
    publish(150);
    fixed->sent(&state, 200, MH_SENT_NO_ACK);
    hear_lead(210, 13, 0, 0); /* no better than 11: nothing changes */
    run(600);
    TEST_ASSERT_EQUAL_UINT32(11, saw.destination);
    come_up(12, 32000, 0);
    hear_lead(50, 13, 20, 0);
    publish(100);
    fixed->sent(&state, 110, MH_SENT_NO_ACK);
    hear_lead(111, 11, 10, 0);
    run(600);
    TEST_ASSERT_EQUAL_UINT32(11, saw.destination);
    const mh_tick silent = state.due[MH_FIXED_WATCH]; /* or to this node itself */
    publish(silent - 1);
    fixed->sent(&state, silent - 1, MH_SENT_NO_ACK);
    run(silent + 50);
    TEST_ASSERT_EQUAL(MH_FIXED_HEAD, state.role);
    TEST_ASSERT_EQUAL(1, saw.delivered);
    TEST_ASSERT_EQUAL(0, state.link.count);
}

static void a_head_takes_the_reports_of_its_members(void)
{
    come_up(11, 30000, 0);
    struct mh_message report = {.kind = MH_MESSAGE_REPORT, .as.report = {.sender = 12, .origin = 12}};
    hear(100, &report, 12, 11);
    TEST_ASSERT_EQUAL(1, saw.delivered);
    fixed->message(&state, 101, &report); /* its radio has sent it twice */
    TEST_ASSERT_EQUAL(1, saw.delivered);
    hear(102, &report, 12, 13); /* not for this one */
    report.as.report.origin = 21;
    hear(103, &report, 21, 11); /* of another cluster */
    TEST_ASSERT_EQUAL(1, saw.delivered);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.refused);
}

/* ---- summaries ---- */

/* And go on for a tenth of the report interval. */
static void close_instant(mh_tick now, mh_tick instant)
{
    fixed->closed(&state, now, instant, NULL, NULL, 0);
    run(now + T / 10);
}

static void a_head_summarises_at_its_report_interval(void)
{
    come_up(11, 30000, 0);
    close_instant(600, 500);
    TEST_ASSERT_EQUAL(0, asked.summarised);
    close_instant(1100, 1000);
    TEST_ASSERT_EQUAL(1, asked.summarised);
    TEST_ASSERT_EQUAL_UINT32(1000, asked.time);
    TEST_ASSERT_EQUAL(1, saw.parts);
    TEST_ASSERT_EQUAL_UINT32(RELAY, saw.destination);
    TEST_ASSERT_EQUAL_INT32(SINK, saw.message.header.route.destination);
    TEST_ASSERT_EQUAL_INT32(0, saw.message.as.hand_over.track);
    TEST_ASSERT_EQUAL_INT32(1000, saw.message.as.hand_over.time_ms);
    TEST_ASSERT_EQUAL(57, saw.message.as.hand_over.length);
    asked.summary_length = 97; /* two parts, one after the other */
    close_instant(2100, 2000);
    TEST_ASSERT_EQUAL(3, saw.parts);
    TEST_ASSERT_EQUAL(2, saw.message.as.hand_over.parts);
    TEST_ASSERT_EQUAL(33, saw.message.as.hand_over.length);
    asked.summary_length = 0; /* nothing to say */
    close_instant(3100, 3000);
    TEST_ASSERT_EQUAL(3, saw.parts);
    TEST_ASSERT_EQUAL_UINT32(2, state.counters.summaries);
    come_up(12, 32000, 0);
    close_instant(1100, 1000);
    TEST_ASSERT_EQUAL(0, asked.summarised);
    run(3 * T); /* leads: not for long, perhaps */
    close_instant(3100, 3000);
    TEST_ASSERT_EQUAL(0, asked.summarised);
    close_instant(4100, 4000);
    TEST_ASSERT_EQUAL(1, asked.summarised);
}

static void a_head_hears_the_centre_only(void)
{
    come_up(21, 0, 30000);
    hear_taken(1100, SINK, 1, 1000);
    TEST_ASSERT_EQUAL(1, asked.taken);
    TEST_ASSERT_EQUAL_UINT32(1000, asked.time);
    hear_taken(1101, RELAY, 1, 1000);
    hear_taken(1102, SINK, 0, 1000);
    TEST_ASSERT_EQUAL(1, asked.taken);
    hear_bytes(1600, SINK, 1, 1000, 59);
    TEST_ASSERT_EQUAL(1, asked.corrected);
    TEST_ASSERT_EQUAL(1, asked.cluster);
    TEST_ASSERT_EQUAL(59, asked.length);
    TEST_ASSERT_EQUAL(42, asked.first);
    hear_bytes(1601, RELAY, 1, 1000, 59);
    hear_bytes(1602, SINK, 0, 1000, 59);
    TEST_ASSERT_EQUAL(1, asked.corrected);
    asked.correct_status = MH_ERR_TIME;
    hear_bytes(2600, SINK, 1, 1000, 59);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.corrected);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.uncorrected);
    hear_bytes(2700, SINK, 1, 1000, MH_SUMMARY_BYTES_MAX);
    TEST_ASSERT_EQUAL_UINT32(2, state.counters.uncorrected);
    come_up(22, 0, 32000); /* who does not lead does not listen */
    hear_taken(1100, SINK, 1, 1000);
    hear_bytes(1600, SINK, 1, 1000, 59);
    TEST_ASSERT_EQUAL(0, asked.taken + asked.corrected);
}

static void who_is_between_passes_on(void)
{
    come_up(RELAY, 10000, 10000);
    TEST_ASSERT_EQUAL(MH_FIXED_RELAY, state.role);
    hear_hello(50, SINK, 0, 0);
    struct mh_message part = {.kind = MH_MESSAGE_HAND_OVER, .as.hand_over = {.parts = 1, .length = 57}};
    hear(100, &part, 11, SINK);
    TEST_ASSERT_EQUAL(1, saw.parts);
    TEST_ASSERT_EQUAL_UINT32(SINK, saw.destination);
    TEST_ASSERT_EQUAL_INT32(11, saw.message.header.route.origin);
}

/* ---- the sink ---- */

static void the_sink_takes_whole_summaries_of_members(void)
{
    config.acknowledges = true;
    come_up(SINK, 0, 0);
    TEST_ASSERT_EQUAL(1, asked.begun);
    hear_bytes(1200, 22, 1, 1000, 97);
    TEST_ASSERT_EQUAL(1, asked.offered);
    TEST_ASSERT_EQUAL(1, asked.cluster);
    TEST_ASSERT_EQUAL_UINT32(1000, asked.time);
    TEST_ASSERT_EQUAL(97, asked.length);
    TEST_ASSERT_EQUAL(42, asked.first);
    TEST_ASSERT_EQUAL(1, saw.takens);
    TEST_ASSERT_EQUAL_INT32(22, saw.message.header.route.destination);
    TEST_ASSERT_EQUAL_INT32(32000, saw.message.header.route.y_mm);
    TEST_ASSERT_EQUAL_INT32(1000, saw.message.as.taken.time_ms);
    TEST_ASSERT_EQUAL(1, saw.message.as.taken.cluster);
    all_arrives(1210);
    asked.take_status = MH_ERR_REPEATED; /* its acknowledgement was lost */
    hear_bytes(2200, 22, 1, 2000, 61);
    TEST_ASSERT_EQUAL(2, saw.takens);
    all_arrives(2210);
    asked.take_status = MH_ERR_TIME;
    hear_bytes(2300, 11, 0, 1000, 61);
    asked.take_status = MH_ERR_CORRUPT;
    hear_bytes(2400, 11, 0, 2000, 61);
    TEST_ASSERT_EQUAL(4, asked.offered);
    hear_bytes(2500, 11, 1, 2000, 61); /* not of that cluster */
    hear_bytes(2600, 11, 2, 2000, 61); /* there is none */
    hear_bytes(2700, 11, -1, 2000, 61);
    hear_bytes(2800, 99, 0, 2000, 61);
    TEST_ASSERT_EQUAL(4, asked.offered);
    TEST_ASSERT_EQUAL(2, saw.takens);
    struct mh_protocol_counters counters = {.retries = 0};
    fixed->count(&state, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.fixed.taken);
    TEST_ASSERT_EQUAL_UINT32(1, counters.fixed.repeated);
    TEST_ASSERT_EQUAL_UINT32(1, counters.fixed.overdue);
    TEST_ASSERT_EQUAL_UINT32(5, counters.fixed.refused);
}

static void parts_of_several_heads_may_come_in_turns(void)
{
    come_up(SINK, 0, 0);
    uint8_t bytes[MH_SUMMARY_BYTES_MAX] = {1};
    for (uint8_t part = 0; part < 2; part++) {
        for (int32_t cluster = 0; cluster < 2; cluster++) {
            struct mh_message message = {.kind = MH_MESSAGE_HAND_OVER,
                                         .as.hand_over = {.track = cluster, .generation = 1000, .time_ms = 1000}};
            mh_parcel_cut(bytes, 97, part, &message.as.hand_over);
            hear(1200, &message, cluster == 0 ? 11 : 21, SINK);
        }
    }
    TEST_ASSERT_EQUAL(2, asked.offered);
    TEST_ASSERT_EQUAL(0, saw.takens); /* nobody wants to know */
}

static void the_sink_fuses_at_its_own_rate_and_feeds_back(void)
{
    come_up(SINK, 0, 0);
    run(1499);
    TEST_ASSERT_EQUAL(0, asked.fused);
    run(1500);
    TEST_ASSERT_EQUAL(1, asked.fused);
    TEST_ASSERT_EQUAL_UINT32(1000, asked.time);
    TEST_ASSERT_EQUAL(0, saw.told); /* there was nothing to fuse */
    asked.fuse_status = MH_OK;
    asked.feedback_length = 59;
    hear_bytes(2200, 22, 1, 2000, 61);
    run(2500);
    TEST_ASSERT_EQUAL(1, saw.told);
    TEST_ASSERT_EQUAL(1, saw.parts); /* nobody of the other cluster was ever heard */
    TEST_ASSERT_EQUAL_INT32(22, saw.message.header.route.destination);
    TEST_ASSERT_EQUAL_INT32(1, saw.message.as.hand_over.track);
    TEST_ASSERT_EQUAL_INT32(2000, saw.message.as.hand_over.time_ms);
    TEST_ASSERT_EQUAL(7, saw.message.as.hand_over.data[58]);
    fixed->time_jumped(&state, 2600);
    TEST_ASSERT_EQUAL(2, asked.begun);
    run(3500);
    TEST_ASSERT_EQUAL(1, saw.parts); /* it knows no heads now */
}

/* ---- configurations ---- */

static void bad_configurations_are_refused(void)
{
    static const struct mh_fixed_member unsorted[] = {{12, {0, 0, 0}}, {11, {0, 0, 0}}};
    static const struct mh_fixed_member sinks[] = {{SINK, {0, 0, 0}}};
    static const struct mh_fixed_member nowhere[] = {{11, {INT32_MIN, 0, 0}}};
    static const struct mh_fixed_cluster bad[][1] = {
        {{unsorted, 2}}, {{sinks, 1}}, {{nowhere, 1}}, {{first_members, 0}}, {{NULL, 1}}};
    const struct mh_fixed_config good = config;
    come_up(11, 30000, 0);
    config.cluster_count = 1;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        config.clusters = bad[i];
        TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, fixed->init(&state, &config, &node));
    }
#define REFUSED(change)                                                                                                \
    config = good;                                                                                                     \
    config.change;                                                                                                     \
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, fixed->init(&state, &config, &node))
    REFUSED(cluster_count = MH_FIXED_CLUSTERS_MAX + 1);
    REFUSED(cluster_count = 0);
    REFUSED(clusters = NULL);
    REFUSED(port = NULL);
    REFUSED(sink = MH_BROADCAST);
    REFUSED(sink_place.x_mm = INT32_MAX);
    REFUSED(report_interval = 99);
    REFUSED(fuse_interval = 3600001u);
    REFUSED(wait = 0);
    REFUSED(wait = 1001);
    REFUSED(patience = 1);
    REFUSED(hello_period = 999);
    REFUSED(link.attempts = 0);
    config = good;
    node.is_head = false; /* a member that cannot compute */
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, fixed->init(&state, &config, &node));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_first_member_leads_at_once_and_says_so);
    RUN_TEST(the_others_wait_one_after_the_other);
    RUN_TEST(a_member_that_hears_its_head_does_not_lead);
    RUN_TEST(a_head_that_acknowledges_samples_is_alive);
    RUN_TEST(a_head_that_never_says_so_is_none_however_much_it_acknowledges);
    RUN_TEST(who_says_that_it_leads_is_believed_rather_than_who_acknowledges);
    RUN_TEST(a_head_that_has_restarted_leads_when_it_is_taken_for_the_head);
    RUN_TEST(who_takes_over_goes_on_with_the_track);
    RUN_TEST(of_two_heads_the_one_that_has_led_longer_goes_on);
    RUN_TEST(who_cannot_lead_tries_again);
    RUN_TEST(when_the_time_jumps_all_begin_anew);
    RUN_TEST(members_report_to_their_head);
    RUN_TEST(reports_that_wait_go_to_the_new_head);
    RUN_TEST(a_head_takes_the_reports_of_its_members);
    RUN_TEST(a_head_summarises_at_its_report_interval);
    RUN_TEST(a_head_hears_the_centre_only);
    RUN_TEST(who_is_between_passes_on);
    RUN_TEST(the_sink_takes_whole_summaries_of_members);
    RUN_TEST(parts_of_several_heads_may_come_in_turns);
    RUN_TEST(the_sink_fuses_at_its_own_rate_and_feeds_back);
    RUN_TEST(bad_configurations_are_refused);
    port_exit(UNITY_END() > 0);
    return 0;
}
