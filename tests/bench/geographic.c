#include "geographic.h"

#include <string.h>

static struct mh_geographic_collection_config protocol;
static struct mh_mote_config config;

static void transmit(void *context, mh_node_id destination, const uint8_t *bytes, size_t count)
{
    struct geographic_sent *sent = context;
    if (destination != MH_BROADCAST) {
        sent->destination = destination;
        memcpy(sent->frame, bytes, count);
        sent->length = count;
    }
}

static void set_alarm(void *context, mh_tick time)
{
    (void)context;
    (void)time;
}

static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm};

void geographic_hear(struct geographic_state *state, mh_tick now, const struct mh_message *message)
{
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    if (mh_wire_encode(mh_protocol_geographic.types, message, frame, &length) == MH_OK) {
        (void)mh_mote_frame(&state->mote, now, frame, length);
    }
}

void geographic_setup(struct geographic_state *state, struct geographic_sent *sent)
{
    static const int8_t around[8][2] = {{10, 3}, {3, 10}, {-3, 10}, {-10, 3}, {-10, -3}, {-3, -10}, {3, -10}, {10, -3}};
    mh_geographic_collection_config_default(&protocol);
    config = (struct mh_mote_config){.id = GEOGRAPHIC_MOTE,
                                     .place = {1000, 2000, 0},
                                     .protocol = &mh_protocol_geographic,
                                     .protocol_config = &protocol,
                                     .protocol_state = &state->protocol};
    if (mh_mote_init(&state->mote, &config, &port, sent, 0) != MH_OK) {
        return;
    }
    for (int i = 0; i < 2 * MH_NEIGHBOURS_MAX; i++) {
        const int ring = 500 + 100 * (i / 8 % (MH_NEIGHBOURS_MAX / 8));
        const struct mh_message hello = {.kind = MH_MESSAGE_HELLO,
                                         .as.hello = {.sender = 100 + i % MH_NEIGHBOURS_MAX,
                                                      .x_mm = 1000 + (int32_t)around[i % 8][0] * ring,
                                                      .y_mm = 2000 + (int32_t)around[i % 8][1] * ring,
                                                      .sequence = (int16_t)(i / MH_NEIGHBOURS_MAX)}};
        geographic_hear(state, (mh_tick)i, &hello);
    }
    const struct mh_message landmark = {
        .kind = MH_MESSAGE_LANDMARK,
        .as.landmark = {.beacon = {.sender = 100, .sink = GEOGRAPHIC_SINK, .round = 1}, .x_mm = 60000, .y_mm = 9000}};
    geographic_hear(state, 500, &landmark);
}
