/* Image of the mote that joins the tracks of fixed clusters by covariance intersection, at their sink. */
#include "motehound/fusion_centre.h"
#include "board_mote.h"
#include "protocols/fixed.h"
#include "self_test.h"

static struct mh_fusion_centre_config joining;
static struct mh_fusion_centre centre;
static struct mh_clock_config clock_config = {.root = true, .period = 30000, .wait = 4000, .sent_q8 = 128};
static struct mh_clock clock_state;

static struct board_mote board = {
    .mote = {.id = MOTE_ID,
             .protocol = &mh_protocol_fixed,
             .protocol_config = &protocol_config,
             .protocol_state = &protocol_state,
             .clock = &mh_clock_flooding,
             .clock_config = &clock_config,
             .clock_state = &clock_state,
             .centre = &mh_centre_fusion,
             .centre_config = &joining,
             .centre_state = &centre},
    .clock = &mh_clock_flooding,
    .clock_config = &clock_config,
    .protocol = &protocol_config,
    .protocol_settings = PROTOCOL_SETTINGS,
    .protocol_entry = PROTOCOL_ENTRY,
    .centre = &joining,
    .centre_settings = mh_settings_fusion_centre,
    .self_test = self_test_fusion,
    .report = board_report,
};

int main(void)
{
    protocol_default();
    protocol_config.sink = MOTE_ID;
    mh_fusion_centre_config_default(&joining);
    return board_mote_run(&board);
}
