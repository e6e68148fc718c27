/* 80 sensor motes and a cluster head follow a source that drifts through their field and releases 100 g/s of a diffusing
 * substance. The motes are the library's; the rest of this program is their world: a clock, a radio and something to sample. */
#include "motehound/collection.h"
#include "motehound/diffusion.h"
#include "motehound/mote.h"
#include "motehound/puff.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 9, MOTES = SIDE * SIDE, HEAD = 4, SPACING_MM = 3000, RANGE_MM = 7000, END = 20000, RING = 1024 };

static struct mh_mote motes[MOTES]; /* number i stands in column i % SIDE, row i / SIDE */
static mh_tick now, alarms[MOTES];  /* milliseconds */
static size_t sent, heard;          /* frames, ever */
static struct frame {
    const struct mh_mote_config *from;
    mh_node_id to;
    size_t length;
    uint8_t bytes[MH_FRAME_MAX];
} air[RING];

static struct mh_vec2 source_at(mh_tick time)
{
    const mh_real s = (mh_real)time / 1000;
    return (struct mh_vec2){2 + s, 12 + 5 * sinf(s / 5)};
}

/* What the source has released until now, a puff of 10 g every 0.1 s, spread at 1 m2/s. */
static mh_real concentration(const struct mh_place *place)
{
    mh_real sum = 0;
    for (mh_tick release = 50; release < now; release += 100) {
        const struct mh_puff puff = {source_at(release), (mh_real)(now - release) / 1000, 10};
        sum += mh_puff_concentration(&puff, 1, mh_place_relative(place, &(struct mh_place){0}), NULL);
    }
    return sum;
}

static void transmit(void *mote, mh_node_id to, const uint8_t *bytes, size_t length)
{
    struct frame *frame = &air[sent++ % RING];
    *frame = (struct frame){.from = ((struct mh_mote *)mote)->config, .to = to, .length = length};
    memcpy(frame->bytes, bytes, length);
}

static void set_alarm(void *mote, mh_tick time) { alarms[(struct mh_mote *)mote - motes] = time; }

static void report(void *mote, const struct mh_estimate *estimate)
{
    const struct mh_vec2 source = source_at(estimate->time);
    const struct mh_place place = mh_place_from_offset(&estimate->origin, estimate->position);
    (void)mote;
    printf("%2u s: source at %5.2f %5.2f m, estimated at %5.2f %5.2f m\n", (unsigned)estimate->time / 1000,
           (double)source.x, (double)source.y, place.x_mm / 1000.0, place.y_mm / 1000.0);
}

int main(void)
{
    static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report};
    static struct mh_mote_config configs[MOTES];
    static struct mh_collection routes[MOTES];
    static struct mh_diffusion track;
    static struct mh_head gathering;
    struct mh_collection_config routing;
    struct mh_diffusion_config tracking;
    mh_collection_config_default(&routing);
    mh_diffusion_config_default(&tracking);
    routing.range_mm = RANGE_MM;
    /* one count is 0.001 g/m2; a sample every second, reported if it has risen by 0.2 g/m2 */
    const struct mh_sensor_config sensor = {0, MH_Q20_ONE / 1000, 0, 65535, 1000, MH_Q20(0.2f), false};
    const struct mh_head_config head = {&mh_tracker_diffusion, &tracking, &track, 0, 1000, 500};

    for (mh_node_id i = 0; i < MOTES; i++) {
        const struct mh_place place = {(int32_t)(i % SIDE) * SPACING_MM, (int32_t)(i / SIDE) * SPACING_MM, 0};
        configs[i] = (struct mh_mote_config){
            i, place, &sensor, i == HEAD ? &head : NULL, &mh_protocol_collection, &routing, &routes[i], &gathering};
        mh_mote_init(&motes[i], &configs[i], &port, &motes[i], now);
    }
    for (; now < END; now++) {
        const size_t end = sent; /* what is sent in one millisecond is heard in the next */
        for (mh_node_id i = 0; i < MOTES; i++) {
            for (size_t n = heard; n != end; n++) {
                const struct frame *frame = &air[n % RING];
                if (frame->from->id != i && (frame->to == i || frame->to == MH_BROADCAST) &&
                    mh_place_within(&frame->from->place, &configs[i].place, RANGE_MM)) {
                    mh_mote_frame(&motes[i], now, frame->bytes, frame->length);
                }
            }
            if (!mh_tick_before(now, alarms[i])) {
                mh_mote_alarm(&motes[i], now);
            }
            if (now % sensor.interval == 0) {
                const struct mh_reading reading = {now, (int32_t)(1000 * concentration(&configs[i].place)), 0};
                mh_mote_reading(&motes[i], now, &reading);
            }
        }
        heard = end;
    }
    return gathering.tracking ? 0 : 1;
}
