/* 80 motes and a cluster head follow a source that drifts through their field and releases 100 g/s of something that
 * diffuses. The motes are the library's; the rest of this program is their world: a clock, a radio, something to sample. */
#include "motehound/diffusion.h"
#include "motehound/direct.h"
#include "motehound/mote.h"
#include "motehound/puff.h"
#include <stdio.h>
#include <string.h>

enum { SIDE = 9, MOTES = SIDE * SIDE, HEAD = MOTES / 2, SPACING_MM = 3000, END = 20000, AIR = 256 };
static mh_tick now; /* milliseconds */
static struct frame {
    mh_node_id to;
    size_t length;
    uint8_t bytes[MH_FRAME_MAX];
} air[AIR];
static size_t sent, heard; /* frames, ever */

static struct mh_vec2 source_at(mh_tick time)
{
    return (struct mh_vec2){2 + (mh_real)time / 1000, 12 + 5 * sinf((mh_real)time / 5000)};
}
/* What the source has released until now, a puff of 10 g every 0.1 s, spread at 1 m2/s; in counts of 0.001 g/m2. */
static int32_t sample(struct mh_vec2 place)
{
    mh_real sum = 0;
    for (mh_tick release = 50; release < now; release += 100) {
        const struct mh_puff puff = {source_at(release), (mh_real)(now - release) / 1000, 10};
        sum += mh_puff_concentration(&puff, 1, place, NULL);
    }
    return (int32_t)(1000 * sum);
}
/* What the motes ask for. */
static void transmit(void *context, mh_node_id to, const uint8_t *bytes, size_t length)
{
    (void)context;
    struct frame *frame = &air[sent++ % AIR];
    *frame = (struct frame){.to = to, .length = length};
    memcpy(frame->bytes, bytes, length);
}
/* no need to: the alarms ring every millisecond */
static void set_alarm(void *context, mh_tick time) { (void)context, (void)time; }
static void report(void *context, const struct mh_estimate *estimate)
{
    const struct mh_vec2 true_m = source_at(estimate->time);
    const struct mh_place mm = mh_place_from_offset(&estimate->origin, estimate->position);
    (void)context;
    printf("source at %5.2f %5.2f m, ", (double)true_m.x, (double)true_m.y);
    printf("estimated at %5.2f %5.2f m\n", mm.x_mm / 1e3, mm.y_mm / 1e3);
}

int main(void)
{
    static struct mh_mote motes[MOTES]; /* number i stands in column i % SIDE, row i / SIDE */
    static struct mh_mote_config configs[MOTES];
    static struct mh_direct protocols[MOTES];
    static struct mh_head gathering;
    static struct mh_diffusion track;
    static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report};
    struct mh_direct_config direct;
    struct mh_diffusion_config diffusion;
    mh_direct_config_default(&direct);
    mh_diffusion_config_default(&diffusion);
    /* a sample every second, reported if it has risen by 0.2 g/m2; the head waits half a second for the reports */
    const struct mh_sensor_config sensor = {0, MH_Q20_ONE / 1000, 0, 65535, 1000, MH_Q20(0.2f), false, 0};
    const struct mh_head_config head = {.tracker = &mh_tracker_diffusion,
                                        .tracker_config = &diffusion,
                                        .tracker_state = &track,
                                        .interval = 1000,
                                        .window = 500};
    for (mh_node_id i = 0; i < MOTES; i++) {
        const struct mh_place place = {(int32_t)(i % SIDE) * SPACING_MM, (int32_t)(i / SIDE) * SPACING_MM, 0};
        const struct mh_head_config *computes = i == HEAD ? &head : NULL;
        configs[i] = (struct mh_mote_config){.id = i,
                                             .place = place,
                                             .sensor = &sensor,
                                             .head = computes,
                                             .protocol = &mh_protocol_direct,
                                             .protocol_config = &direct,
                                             .protocol_state = &protocols[i],
                                             .head_state = &gathering};
        mh_mote_init(&motes[i], &configs[i], &port, NULL, now);
    }
    for (; now < END; now++) {
        const size_t end = sent; /* what is sent in one millisecond is heard in the next */
        for (mh_node_id i = 0; i < MOTES; i++) {
            for (size_t n = heard; n != end; n++) {
                const struct frame *frame = &air[n % AIR];
                if (frame->to == i || frame->to == MH_BROADCAST) {
                    mh_mote_frame(&motes[i], now, frame->bytes, frame->length);
                }
            }
            mh_mote_alarm(&motes[i], now);
            if (now % sensor.interval == 0) {
                const struct mh_vec2 place = mh_place_relative(&configs[i].place, &(struct mh_place){0});
                mh_mote_reading(&motes[i], now, &(struct mh_reading){.time = now, .counts = sample(place)});
            }
        }
        heard = end;
    }
    return gathering.tracking ? 0 : 1;
}
