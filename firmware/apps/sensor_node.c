/* Image of a mote that senses and relays, and computes nothing. PROTOCOL_HEADER: protocols/NAME.h. */
#include "board_mote.h"
#include "self_test.h"

#include PROTOCOL_HEADER

/* 10 bits for 0 to 5 g/m2, each second */
static struct mh_sensor_config sensor = {
    .q20_per_count = 5125, .counts_max = 1023, .interval = 1000, .threshold = MH_Q20(0.2f)};
#ifdef KEEPS_TIME
static struct mh_clock_config clock_config = {.period = 30000, .wait = 4000, .sent_q8 = 128};
static struct mh_clock clock_state;
#endif

static struct board_mote board = {
    .mote =
        {
            .id = MOTE_ID,
            .sensor = &sensor,
            .protocol = &PROTOCOL,
            .protocol_config = &protocol_config,
            .protocol_state = &protocol_state,
#ifdef KEEPS_TIME
            .clock = &mh_clock_flooding,
            .clock_config = &clock_config,
            .clock_state = &clock_state,
#endif
        },
    .sensor = &sensor,
#ifdef KEEPS_TIME
    .clock = &mh_clock_flooding,
    .clock_config = &clock_config,
#endif
    .protocol = &protocol_config,
    .protocol_settings = PROTOCOL_SETTINGS,
    .samples = PROTOCOL_SAMPLES,
    .self_test = self_test_node,
    .report = PROTOCOL_REPORT,
};

int main(void)
{
    protocol_default();
    return board_mote_run(&board);
}
