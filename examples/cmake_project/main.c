/* A sensor node: its converter sees a source pass by, and what has risen goes to the head. */
#include "motehound/collection.h"
#include "motehound/mote.h"
#include <stdio.h>

static const struct mh_sensor_config sensor = {
    .q20_per_count = 5125, .counts_max = 1023, .interval = 1000, .threshold = MH_Q20(0.2f)};
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

/* What the mote asks of its board: the radio and one timer. */
static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    (void)context, (void)frame;
    printf("frame of %u bytes to %ld\n", (unsigned)length, (long)(int32_t)destination);
}

static void set_alarm(void *context, mh_tick time)
{
    (void)context;
    alarm_time = time;
}

static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm};

int main(void)
{
    /* scripted: the samples, one a second, and what a neighbour sends in the first */
    static const int16_t counts[] = {0, 8, 60, 190, 300, 330, 310};
    const struct mh_message beacon = {.kind = MH_MESSAGE_BEACON,
                                      .as.beacon = {.sender = 4, .sink = 1, .round = 1, .hops = 1, .tracking = 1}};
    uint8_t frame[MH_FRAME_MAX];
    size_t length = 0;
    (void)mh_wire_encode(mh_protocol_collection.types, &beacon, frame, &length);
    if (mh_mote_init(&mote, &config, &port, NULL, 0) != MH_OK) {
        return 1;
    }
    for (mh_tick now = 0; now < 7000; now++) { /* milliseconds; on a board: for ever, asleep until an interrupt */
        if (now == 300) {
            (void)mh_mote_frame(&mote, now, frame, length);
        }
        if (now % sensor.interval == 0) {
            const struct mh_reading reading = {now, counts[now / 1000], 0};
            (void)mh_mote_reading(&mote, now, &reading);
        }
        if (!mh_tick_before(now, alarm_time)) {
            mh_mote_alarm(&mote, now);
        }
    }
    printf("%lu reports\n", (unsigned long)mote.counters.reports);
    return 0;
}
