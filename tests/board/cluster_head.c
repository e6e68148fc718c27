/* Image of a cluster head: a radio, one timer and a console, joined by the mote. It runs the paper's method on what its sensor nodes
 * report.
 *
 * The main loop is that of a real head. What is scripted here, so that it runs under an emulator without a radio, is the hardware: the
 * clock is a counter, and the frames are those of 16 nodes on a grid while a source passes through them. */
#include "console.h"
#include "motehound/direct.h"
#include "motehound/luo.h"
#include "motehound/mote.h"
#include "motehound/puff.h"

#define NODES 16
#define INTERVAL 1000u

static struct mh_luo_config tracking;
static struct mh_luo track;
static struct mh_head gathering;
static struct mh_direct route;
static const struct mh_direct_config routing = {10000, false};
static const struct mh_head_config head = {&mh_tracker_luo, &tracking, &track, 0, INTERVAL, 500, 0, false, 0};
static const struct mh_mote_config config = {.id = 1,
                                             .head = &head,
                                             .protocol = &mh_protocol_direct,
                                             .protocol_config = &routing,
                                             .protocol_state = &route,
                                             .head_state = &gathering};
static struct mh_mote mote;
static mh_tick alarm_time;
static uint8_t beacons, estimates, good;

/* ---- the hardware, scripted ---- */

/* What `node` measures: 100 g released each second where the source then was, on its way along y = 7 m at 2 m/s. */
static mh_q20 sample(const struct mh_place *node, mh_tick now)
{
    const struct mh_place corner = {0, 0, 0};
    mh_real sum = 0;
    for (mh_tick release = 500; release < now; release += 1000) {
        const struct mh_puff puff = {{(mh_real)release * 0.002f, 7}, (mh_real)(now - release) * 0.001f, 100};
        sum += mh_puff_concentration(&puff, 1, mh_place_relative(node, &corner), NULL);
    }
    return mh_q20_from_real(sum);
}

/* One node's report arrives each 10 ms after a sampling instant. */
static bool radio_has_received(mh_tick now, uint8_t *frame, size_t *length)
{
    const uint8_t node = (uint8_t)(now % INTERVAL / 10);
    const mh_tick instant = now - now % INTERVAL;
    if (now % 10 != 5 || node >= NODES || instant == 0) {
        return false;
    }
    const struct mh_place place = {node % 4 * 4000, node / 4 * 4000, 0};
    const mh_q20 value = sample(&place, instant);
    const struct mh_measurement measurement = {.node = node + 2u,
                                               .place = place,
                                               .time = instant,
                                               .value = value,
                                               .increment = value - sample(&place, instant - INTERVAL),
                                               .flags = MH_MEASUREMENT_HAS_INCREMENT};
    struct mh_message message = {.kind = MH_MESSAGE_REPORT};
    mh_report_from_measurement(&measurement, &message.as.report);
    return mh_wire_encode(mh_protocol_direct.types, &message, frame, length) == MH_OK;
}

/* ---- what the mote asks of the board ---- */

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    (void)context;
    (void)destination;
    (void)frame;
    (void)length;
    beacons++;
}

static void set_alarm(void *context, mh_tick time)
{
    (void)context;
    alarm_time = time;
}

static void report(void *context, const struct mh_estimate *estimate)
{
    const struct mh_place place = mh_place_from_offset(&estimate->origin, estimate->position);
    const int32_t x_error_mm = place.x_mm - (int32_t)estimate->time * 2;
    (void)context;
    put_named("", (int32_t)estimate->time);
    put_named(" ms: x ", place.x_mm);
    put_named(" mm, y ", place.y_mm);
    put_named(" mm from ", estimate->measurements);
    port_puts(" reports\n");
    estimates++;
    const bool near =
        x_error_mm > -6000 && x_error_mm < 3000 && place.y_mm > 5000 && place.y_mm < 9000; /* the method lags */
    good = (uint8_t)(good + near);
}

int main(void)
{
    static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report};
    mh_luo_config_default(&tracking);
    if (mh_mote_init(&mote, &config, &port, NULL, 0) != MH_OK) {
        return 1;
    }
    for (mh_tick now = 0; now < 7000; now++) { /* on a board: for ever, asleep until an interrupt */
        uint8_t frame[MH_FRAME_MAX];
        size_t length;
        if (radio_has_received(now, frame, &length)) {
            (void)mh_mote_frame(&mote, now, frame, length);
        }
        if (!mh_tick_before(now, alarm_time)) {
            mh_mote_alarm(&mote, now);
        }
    }
    put_named("state of the head: ", (int32_t)(sizeof mote + sizeof route + sizeof gathering + sizeof track));
    port_puts(" bytes\n");
    return estimates >= 3 && good >= estimates - 1 && beacons >= 2 ? 0 : 1;
}
