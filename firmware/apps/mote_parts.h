/* What every image of a whole mote consists of: a sensor, a protocol (PROTOCOL_HEADER: protocols/NAME.h), and with KEEPS_TIME the network's
 * time. Included once, by the image's source, which sets its struct board_mote up with BOARD_PARTS and the mote in it with MOTE_PARTS. */
#ifndef MOTE_PARTS_H
#define MOTE_PARTS_H

#include "board_mote.h"
#include "self_test.h"

#include PROTOCOL_HEADER

#ifndef PROTOCOL_ENTRY
#define PROTOCOL_ENTRY NULL /* its configuration points to no list */
#endif
#ifndef STEP_MS
#define STEP_MS 1000 /* between sampling instants */
#endif

/* 10 bits for 0 to 5 g/m2 */
static struct mh_sensor_config sensor = {
    .q20_per_count = 5125, .counts_max = 1023, .interval = STEP_MS, .threshold = MH_Q20(0.2f)};

#ifdef KEEPS_TIME
static struct mh_clock_config clock_config = {.period = 30000, .wait = 4000, .sent_q8 = 128};
static struct mh_clock clock_state;
#define CLOCK_PARTS .clock = &mh_clock_flooding, .clock_config = &clock_config
#define CLOCK_STATE &clock_state
#else
#define CLOCK_PARTS .clock = NULL, .clock_config = NULL
#define CLOCK_STATE NULL
#endif

#define MOTE_PARTS                                                                                                     \
    .id = MOTE_ID, .sensor = &sensor, .protocol = &PROTOCOL, .protocol_config = &protocol_config,                      \
    .protocol_state = &protocol_state, .clock_state = CLOCK_STATE, CLOCK_PARTS
#define BOARD_PARTS                                                                                                    \
    .sensor = &sensor, .protocol = &protocol_config, .protocol_settings = PROTOCOL_SETTINGS,                           \
    .protocol_entry = PROTOCOL_ENTRY, .samples = PROTOCOL_SAMPLES, CLOCK_PARTS

#endif
