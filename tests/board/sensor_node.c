/* Image of a sensor node: an ADC, a radio and one timer, joined by the mote.
 *
 * The main loop is that of a real node. What is scripted here, so that it runs under an emulator without a radio, is the hardware:
 * the clock is a counter, the converter gives the samples of a source that passes by, and three frames come in. */
#include "console.h"
#include "motehound/collection.h"
#include "motehound/mote.h"

static const struct mh_sensor_config sensor = {/* 10 bits for 0 to 5 g/m2 */
                                               .q20_per_count = 5125,
                                               .counts_max = 1023,
                                               .interval = 1000,
                                               .threshold = MH_Q20(0.2f)};
static const struct mh_collection_config routing = {30000, 100, 40, 3, 15000, 5, 20};

static struct mh_collection route;
static const struct mh_mote_config config = {.id = 17,
                                             .place = {12000, 9000, 0},
                                             .sensor = &sensor,
                                             .protocol = &mh_protocol_collection,
                                             .protocol_config = &routing,
                                             .protocol_state = &route};
static struct mh_mote mote;
static mh_tick alarm_time;

/* ---- the hardware, scripted ---- */

static const struct mh_message beacon = {.kind = MH_MESSAGE_BEACON,
                                         .as.beacon = {.sender = 4, .sink = 1, .round = 1, .hops = 1}};
static const struct mh_message beacon_tracking = {
    .kind = MH_MESSAGE_BEACON, .as.beacon = {.sender = 4, .sink = 1, .round = 2, .hops = 1, .tracking = 1}};
static const struct mh_message request = {
    .kind = MH_MESSAGE_REQUEST,
    .as.request = {.sender = 4, .origin = 1, .time_ms = 6000, .x_mm = 12000, .y_mm = 9000, .radius_mm = 8000}};

static bool radio_has_received(mh_tick now, uint8_t *frame, size_t *length)
{
    const struct mh_message *heard = now == 300    ? &beacon
                                     : now == 3400 ? &beacon_tracking
                                     : now == 5500 ? &request
                                                   : NULL;
    return heard && mh_wire_encode(mh_protocol_collection.types, heard, frame, length) == MH_OK;
}

static int32_t adc_counts(mh_tick now)
{
    static const int16_t counts[] = {0, 8, 60, 190, 300, 330, 310};
    return counts[now / 1000];
}

/* ---- what the mote asks of the board ---- */

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    struct mh_message message;
    (void)context;
    put_named("sends ", (int32_t)length);
    put_named(" bytes to ", (int32_t)destination);
    if (mh_wire_decode(mh_protocol_collection.types, frame, length, &message) == MH_OK &&
        message.kind == MH_MESSAGE_REPORT) {
        put_named(": sample of ", message.as.report.time_ms);
        put_named(" ms, increment ", (int32_t)(message.as.report.increment_q20 * 1000LL / MH_Q20_ONE));
        put_named(" mg/m2, flags ", message.as.report.flags);
    }
    port_puts("\n");
}

static void set_alarm(void *context, mh_tick time)
{
    (void)context;
    alarm_time = time;
}

int main(void)
{
    static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm};
    if (mh_mote_init(&mote, &config, &port, NULL, 0) != MH_OK) {
        return 1;
    }
    for (mh_tick now = 0; now < 7000; now++) { /* on a board: for ever, asleep until an interrupt */
        uint8_t frame[MH_FRAME_MAX];
        size_t length;
        if (radio_has_received(now, frame, &length)) {
            (void)mh_mote_frame(&mote, now, frame, length);
        }
        if (now % sensor.interval == 0) {
            const struct mh_reading reading = {now, adc_counts(now), 0};
            (void)mh_mote_reading(&mote, now, &reading);
        }
        if (!mh_tick_before(now, alarm_time)) {
            mh_mote_alarm(&mote, now);
        }
    }
    /* 2: a value above chi; 3, 4: increments; 6: because the head has asked. Two beacons and the request relayed. */
    put_named("state of the node: ", (int32_t)(sizeof mote + sizeof route));
    put_named(" bytes, reports: ", (int32_t)mote.counters.reports);
    put_named(", asked: ", (int32_t)mote.counters.reports_asked);
    port_puts("\n");
    return mote.counters.reports == 4 && mote.counters.reports_asked == 1 && mote.counters.frames_sent == 7 ? 0 : 1;
}
