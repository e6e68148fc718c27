/* A sensor node: its converter sees a source pass by, and what has risen goes to the head. Between two events the thread sleeps. */
#include "motehound/collection.h"
#include "motehound/mote.h"
#include <zephyr/kernel.h>
#include <zephyr/sys/printk.h>

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

/* What the mote asks of its board: the radio (ieee802154_radio_api's tx, say) and one timer. */
static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    (void)context, (void)frame;
    printk("frame of %u bytes to %d\n", (unsigned)length, (int)(int32_t)destination);
}

static void set_alarm(void *context, mh_tick time)
{
    (void)context;
    alarm_time = time;
}

static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm};

/* What a neighbour nearer to the head sends from time to time; in earnest the radio's receive callback queues frames for this thread. */
static void hear_beacon(mh_tick now)
{
    const struct mh_message beacon = {.kind = MH_MESSAGE_BEACON,
                                      .as.beacon = {.sender = 4, .sink = 1, .round = 1, .hops = 1, .tracking = 1}};
    uint8_t frame[MH_FRAME_MAX];
    size_t length = 0;
    (void)mh_wire_encode(mh_protocol_collection.types, &beacon, frame, &length);
    (void)mh_mote_frame(&mote, now, frame, length);
}

int main(void)
{
    static const int16_t counts[] = {0, 8, 60, 190, 300, 330, 310}; /* scripted samples, one a second */
    mh_tick begin = k_uptime_get_32(), sample_time = begin;
    if (mh_mote_init(&mote, &config, &port, NULL, begin) != MH_OK) {
        return 1;
    }
    hear_beacon(begin);
    while (sample_time - begin < 7000) {
        const mh_tick next = mh_tick_before(alarm_time, sample_time) ? alarm_time : sample_time;
        mh_tick now = k_uptime_get_32();
        if (mh_tick_before(now, next)) {
            k_msleep((int32_t)(next - now));
            now = k_uptime_get_32();
        }
        if (!mh_tick_before(now, alarm_time)) {
            mh_mote_alarm(&mote, now);
        }
        if (!mh_tick_before(now, sample_time)) {
            const struct mh_reading reading = {sample_time, counts[(sample_time - begin) / 1000], 0};
            (void)mh_mote_reading(&mote, now, &reading);
            sample_time += sensor.interval;
        }
    }
    printk("%u reports\n", (unsigned)mote.counters.reports);
    return 0;
}
