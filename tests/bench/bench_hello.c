/* The hello of a neighbour: heard, checked, decoded, taken into a full table with its place in the Gabriel graph. */
#include "bench.h"
#include "geographic.h"

struct geographic_state bench_state;
static struct geographic_sent sent;
static uint8_t frame[MH_FRAME_MAX];
static size_t length;
static mh_tick now;

void bench_setup(void) { geographic_setup(&bench_state, &sent); }

void bench_prepare(unsigned step)
{
    const struct mh_message hello = {
        .kind = MH_MESSAGE_HELLO,
        .as.hello = {.sender = 1000 + (int32_t)step, .x_mm = 7000, .y_mm = 8000 + 100 * (int32_t)step}};
    now = 1000 + (mh_tick)step;
    if (mh_wire_encode(mh_protocol_geographic.types, &hello, frame, &length) != MH_OK) {
        length = 0;
    }
}

void bench_step(void) { (void)mh_mote_frame(&bench_state.mote, now, frame, length); }

bool bench_worked(void) { return bench_state.mote.counters.frames_corrupt == 0 && length > 0; }
