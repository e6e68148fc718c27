/* One mote on a board: the same mote (mote.h) as anywhere, whose radio and sensor are at the other end of the board's serial line (line.h).
 *
 * From the start it runs free, on the board's clock (port_ticks): alarms come when they are due, frames to send go out as TRANSMIT, and whoever bridges the line to a radio sends FRAME and
 * SENT; when it wants a reading it sends SENSE, and gets READING. Times in these are not looked at, the board's are taken. Between messages there are lines of text: how the image came
 * up, why the start before it ended, each estimate; a receiver of messages drops them as damaged.
 *
 * IDENTIFY, CONFIGURE, START and STOP end that until the board is reset: then the clock is at the other end of the line, too (lock step). A mote so configured has a
 * sensor, a head's configuration and a clock only if CONFIGURE has named them.
 *
 * At the start the image recomputes known answers; if they are not as known the mote does not run: START is answered with MH_ERR_CORRUPT. After each event the stack's guard is looked at, and the watchdog is fed, which runs while
 * the mote runs free: in lock step nobody waits for an event that takes long. A
 * fault is told at the next start, as text and by FAULT.
 *
 * Memory: 134 bytes for a message besides the mote's, and on an ATmega128 some 60 more. */
#ifndef BOARD_MOTE_H
#define BOARD_MOTE_H

#include "motehound/settings.h"

/* What an image consists of. All of it is the image's, and variable: it can be configured over the line. NULL: the image has no such thing, or nothing to configure. */
struct board_mote {
    struct mh_mote_config mote; /* as it runs free */
    struct mh_sensor_config *sensor;
    struct mh_head_config *head;
    const struct mh_clock_functions *clock;
    struct mh_clock_config *clock_config;
    void *protocol, *tracker;                          /* configurations ... */
    mh_settings *protocol_settings, *tracker_settings; /* ... and their fields */
    /* Entry `number` of the list that they point to. MH_ERR_CAPACITY: there is no room */
    enum mh_status (*protocol_entry)(struct mh_line_fields *fields, uint16_t number);
    enum mh_status (*tracker_entry)(struct mh_line_fields *fields, uint16_t number);
    void *centre; /* configuration of mote.centre ... */
    mh_settings *centre_settings;
    bool samples; /* the sensor each interval, running free; else when the protocol asks for it */
    bool (*self_test)(void);
    void (*report)(void *context,
                   const struct mh_estimate *estimate); /* board_report, on a mote that knows where targets are */
};

/* An estimate on the line, and running free as text. */
void board_report(void *context, const struct mh_estimate *estimate);

/* Run. Never returns on a board. */
int board_mote_run(struct board_mote *board);

#endif
