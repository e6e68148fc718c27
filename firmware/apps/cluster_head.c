/* Image of a mote that computes, always or when its turn comes. TRACKER_HEADER: trackers/NAME.h. */
#include "mote_parts.h"

#include TRACKER_HEADER

#ifndef TRACKER_ENTRY
#define TRACKER_ENTRY NULL /* its configuration points to no list */
#endif
#define WINDOW (PROTOCOL_SAMPLES ? STEP_MS / 2 : 150)
#define TOLERANCE (PROTOCOL_SAMPLES ? 0 : STEP_MS / 4)

static struct mh_head_config head = {.tracker = &TRACKER,
                                     .tracker_config = &tracker_config,
                                     .tracker_state = &tracker_state,
                                     .interval = STEP_MS,
                                     .window = WINDOW,
                                     .tolerance = TOLERANCE};
static struct mh_head gathering;

static struct board_mote board = {.mote = {MOTE_PARTS, .head = &head, .head_state = &gathering},
                                  BOARD_PARTS,
                                  .head = &head,
                                  .tracker = &tracker_config,
                                  .tracker_settings = TRACKER_SETTINGS,
                                  .tracker_entry = TRACKER_ENTRY,
                                  .self_test = SELF_TEST,
                                  .report = board_report};

int main(void)
{
    protocol_default();
    tracker_default();
    return board_mote_run(&board);
}
