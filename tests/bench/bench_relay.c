/* A report on its way to the sink: heard, checked, decoded, handed to the protocol, encoded and transmitted again. */
#include "bench.h"
#include "motehound/collection.h"
#include "motehound/mote.h"

#include <string.h>

enum { SINK = 9, RELAY = 5, SOURCE = 2 };

struct {
    struct mh_mote mote;
    struct mh_collection collection;
} bench_state;

static struct mh_collection_config collection;
static struct mh_mote_config config;
static uint8_t frame[MH_FRAME_MAX], relayed[MH_FRAME_MAX];
static size_t length, relayed_length;
static mh_tick now;

static void transmit(void *context, mh_node_id destination, const uint8_t *bytes, size_t count)
{
    (void)context;
    if (destination == SINK) {
        memcpy(relayed, bytes, count);
        relayed_length = count;
    }
}

static void set_alarm(void *context, mh_tick time)
{
    (void)context;
    (void)time;
}

static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm};

void bench_setup(void)
{
    const struct mh_message beacon = {.kind = MH_MESSAGE_BEACON,
                                      .as.beacon = {.sender = SINK, .sink = SINK, .round = 1, .hops = 0}};
    mh_collection_config_default(&collection);
    config = (struct mh_mote_config){.id = RELAY,
                                     .protocol = &mh_protocol_collection,
                                     .protocol_config = &collection,
                                     .protocol_state = &bench_state.collection};
    if (mh_mote_init(&bench_state.mote, &config, &port, NULL, 0) == MH_OK &&
        mh_wire_encode(mh_protocol_collection.types, &beacon, frame, &length) == MH_OK) {
        (void)mh_mote_frame(&bench_state.mote, 1, frame, length);
    }
}

void bench_prepare(unsigned step)
{
    const struct mh_message report = {.kind = MH_MESSAGE_REPORT,
                                      .as.report = {.sender = SOURCE,
                                                    .origin = SOURCE,
                                                    .time_ms = (int32_t)(1000 * step),
                                                    .x_mm = 1000,
                                                    .y_mm = 2000,
                                                    .value_q20 = 123456,
                                                    .increment_q20 = 1234,
                                                    .hops = 3}};
    now = 1000 * (mh_tick)step + 20;
    relayed_length = 0;
    if (mh_wire_encode(mh_protocol_collection.types, &report, frame, &length) != MH_OK) {
        length = 0;
    }
}

void bench_step(void) { (void)mh_mote_frame(&bench_state.mote, now, frame, length); }

bool bench_worked(void) { return relayed_length == length && relayed_length > 0; }
