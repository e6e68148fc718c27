/* Image of a mote that computes, always or when its turn comes. TRACKER_HEADER: trackers/NAME.h, PROTOCOL_HEADER: protocols/NAME.h. */
#include "board_mote.h"
#include "self_test.h"

#include PROTOCOL_HEADER
#include TRACKER_HEADER

#ifndef STEP_MS
#define STEP_MS 1000 /* between sampling instants */
#endif
#define WINDOW (PROTOCOL_SAMPLES ? STEP_MS / 2 : 150)
#define TOLERANCE (PROTOCOL_SAMPLES ? 0 : STEP_MS / 4)

static struct mh_sensor_config sensor = {
    .q20_per_count = 5125, .counts_max = 1023, .interval = STEP_MS, .threshold = MH_Q20(0.2f)};
static struct mh_head_config head = {.tracker = &TRACKER,
                                     .tracker_config = &tracker_config,
                                     .tracker_state = &tracker_state,
                                     .interval = STEP_MS,
                                     .window = WINDOW,
                                     .tolerance = TOLERANCE};
static struct mh_head gathering;
#ifdef KEEPS_TIME
static struct mh_clock_config clock_config = {.period = 30000, .wait = 4000, .sent_q8 = 128};
static struct mh_clock clock_state;
#endif

static struct board_mote board = {
    .mote =
        {
            .id = MOTE_ID,
            .sensor = &sensor,
            .head = &head,
            .protocol = &PROTOCOL,
            .protocol_config = &protocol_config,
            .protocol_state = &protocol_state,
            .head_state = &gathering,
#ifdef KEEPS_TIME
            .clock = &mh_clock_flooding,
            .clock_config = &clock_config,
            .clock_state = &clock_state,
#endif
        },
    .sensor = &sensor,
    .head = &head,
#ifdef KEEPS_TIME
    .clock = &mh_clock_flooding,
    .clock_config = &clock_config,
#endif
    .protocol = &protocol_config,
    .tracker = &tracker_config,
    .protocol_settings = PROTOCOL_SETTINGS,
    .tracker_settings = TRACKER_SETTINGS,
    .samples = PROTOCOL_SAMPLES,
    .self_test = SELF_TEST,
    .report = board_report,
};

int main(void)
{
    protocol_default();
    tracker_default();
    return board_mote_run(&board);
}
