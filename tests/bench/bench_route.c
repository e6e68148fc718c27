/* A report that travels by places: heard, checked, decoded, its next hop found among as many neighbours as there can be, encoded and transmitted; and
 * the acknowledgement. */
#include "bench.h"
#include "geographic.h"
#include "motehound/geographic.h"

struct geographic_state bench_state;
static struct geographic_sent sent;
static uint8_t frame[MH_FRAME_MAX];
static size_t length;
static mh_tick now;

void bench_setup(void) { geographic_setup(&bench_state, &sent); }

void bench_prepare(unsigned step)
{
    static const struct mh_place sink = {60000, 9000, 0};
    struct mh_message report = {.kind = MH_MESSAGE_REPORT,
                                .as.report = {.sender = 2, .origin = 2, .x_mm = 1000, .value_q20 = 123456}};
    mh_geographic_address(&report, 2, (int16_t)step, GEOGRAPHIC_SINK, &sink);
    now = 1000 * (mh_tick)step + 20;
    sent.length = 0;
    if (mh_wire_encode(mh_protocol_geographic.types, &report, frame, &length) != MH_OK) {
        length = 0;
    }
}

void bench_step(void)
{
    (void)mh_mote_frame(&bench_state.mote, now, frame, length);
    mh_mote_sent(&bench_state.mote, now, MH_SENT_OK);
}

bool bench_worked(void) { return sent.length == length && length > 0; }
