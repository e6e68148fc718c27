/* The serial line of a board whose radio, sensor and, in lock step, clock are at its other end: on a simulator, or on whoever bridges a mote to a
 * radio of his own.
 *
 * A message on the line is a kind (1 byte), its fields, and their 16-bit frame check sequence (mh_wire_fcs, least significant byte first),
 * framed as in asynchronous HDLC (RFC 1662, 4.2): 0x7E before and after, and 0x7D, byte ^ 0x20 for each 0x7E and 0x7D between. So the sender
 * needs no memory, the receiver as much as the longest message, and after any disturbance the next frame is understood.
 *
 * A field is 4 bytes, most significant first, whatever its type is; a real is IEEE 754 binary32 in both arithmetics. A text ends with a zero byte.
 * `frame` is the frame's bytes, up to the end of the message.
 *
 *     to the board                              from the board, before DONE
 *     IDENTIFY                                  IDENTITY         struct mh_line_identity
 *     CONFIGURE  part, fields (settings.h)
 *     START      time                           TRANSMIT         destination, frame
 *     STOP                                      SET_ALARM        time
 *     READING    time, counts, target           REPORT           struct mh_estimate
 *     FRAME      time, frame                    SLEEP            may sleep
 *     SENT       time, enum mh_sent             SENSE
 *     ALARM      time
 *     PROBE      time                           CLOCK            the network's time is known, its tick, 1/256 of it
 *     COUNT                                     COUNTERS         mh_line_counters
 *                                               DONE             struct mh_line_done
 *                                               FAULT            reason, address: why the board has started anew
 *
 * Times are ticks of the mote's own clock, the present one. The board answers each message by what the mote does, in its order, and then DONE; until then it
 * gets no other. So time on the line is logical: an event takes none, however many cycles it takes. What is damaged, or no message, is counted and dropped;
 * a board answers what it has understood, but cannot use, with DONE and an error. FAULT comes unasked. */
#ifndef MOTEHOUND_LINE_H
#define MOTEHOUND_LINE_H

#include "motehound/mote.h"

#define MH_LINE_VERSION 1

enum mh_line_kind {
    MH_LINE_IDENTIFY = 1,
    MH_LINE_CONFIGURE,
    MH_LINE_START,
    MH_LINE_STOP,
    MH_LINE_READING,
    MH_LINE_FRAME,
    MH_LINE_SENT,
    MH_LINE_ALARM,
    MH_LINE_PROBE,
    MH_LINE_COUNT,
    MH_LINE_IDENTITY = 129,
    MH_LINE_TRANSMIT,
    MH_LINE_SET_ALARM,
    MH_LINE_REPORT,
    MH_LINE_SLEEP,
    MH_LINE_SENSE,
    MH_LINE_CLOCK,
    MH_LINE_COUNTERS,
    MH_LINE_DONE,
    MH_LINE_FAULT
};

/* What of a mote is configured, before START. Unless CONFIGURE names them the mote has no sensor, no head and no clock, whatever it has when it runs by itself; place, protocol and tracker keep the
 * image's own values. */
enum mh_line_part {
    MH_LINE_MOTE,          /* mh_settings_mote */
    MH_LINE_SENSOR,        /* mh_settings_sensor */
    MH_LINE_PROTOCOL,      /* that of the image's protocol */
    MH_LINE_HEAD,          /* mh_settings_head */
    MH_LINE_TRACKER,       /* that of the image's tracker */
    MH_LINE_CLOCK_KEEPING, /* mh_settings_clock */
    MH_LINE_CENTRE,        /* that of the image's fusion centre */
    /* an entry of the list that the protocol's or the tracker's configuration points to: its number, from 0 on one after the other, and its fields; number 0 begins the list anew */
    MH_LINE_PROTOCOL_ENTRY,
    MH_LINE_TRACKER_ENTRY
};

/* Longest messages, kind and check sequence included: a buffer for one. */
#define MH_LINE_TO_BOARD_MAX (MH_FRAME_MAX + 7)
#define MH_LINE_FROM_BOARD_MAX 512

/* ---- frames ---- */

struct mh_line_receiver {
    uint8_t *bytes; /* of the message: kind, then fields; room for `room` bytes, the caller's */
    uint16_t room, length;
    bool escaped, spoilt; /* the byte before was 0x7D; what is coming in is no message any more */
    bool complete;        /* a message is in `bytes` */
    uint16_t damaged;     /* frames dropped; saturates */
};

/* `room`: 3 to 32,767. */
void mh_line_receiver_init(struct mh_line_receiver *receiver, uint8_t *bytes, uint16_t room);

/* A byte has come. Returns true if it ends a sound message: bytes[0] is its kind, its fields are bytes[1 .. length), until the next call.
 * Cost: a few instructions a byte, some 10 more a byte at the end of a frame. */
bool mh_line_take(struct mh_line_receiver *receiver, uint8_t byte);

struct mh_line_sender {
    void (*put)(void *context, uint8_t byte); /* takes bytes as they are made */
    void *context;
    uint16_t fcs;
};

/* A message of one kind begins, goes on and ends. */
void mh_line_begin(struct mh_line_sender *sender, enum mh_line_kind kind);
void mh_line_byte(struct mh_line_sender *sender, uint8_t byte);
void mh_line_end(struct mh_line_sender *sender);

/* ---- fields ---- */

/* The fields of a message that is being sent (`to`), or read. So what a message holds is said once, for both directions. */
struct mh_line_fields {
    struct mh_line_sender *to; /* NULL: read */
    const uint8_t *at;         /* read: the next byte ... */
    uint16_t left;             /* ... and how many there are */
    bool broken;               /* read: too short, or a value that its variable cannot hold, which was left alone */
};

/* Read what the receiver holds. */
static inline struct mh_line_fields mh_line_read(const struct mh_line_receiver *receiver)
{
    const struct mh_line_fields fields = {NULL, receiver->bytes + 1, (uint16_t)(receiver->length - 1), false};
    return fields;
}

static inline struct mh_line_fields mh_line_write(struct mh_line_sender *sender)
{
    const struct mh_line_fields fields = {sender, NULL, 0, false};
    return fields;
}

/* True if all has been read, and made sense. */
static inline bool mh_line_complete(const struct mh_line_fields *fields)
{
    return !fields->broken && fields->left == 0;
}

void mh_line_u32(struct mh_line_fields *fields, uint32_t *value);
void mh_line_i32(struct mh_line_fields *fields, int32_t *value);
void mh_line_u16(struct mh_line_fields *fields, uint16_t *value);
void mh_line_u8(struct mh_line_fields *fields, uint8_t *value);
void mh_line_bool(struct mh_line_fields *fields, bool *value);
void mh_line_real(struct mh_line_fields *fields, mh_real *value);
void mh_line_place(struct mh_line_fields *fields, struct mh_place *place);
void mh_line_region(struct mh_line_fields *fields, struct mh_region *region);
void mh_line_vec2(struct mh_line_fields *fields, struct mh_vec2 *vector);
/* Read, it points into the message. */
void mh_line_text(struct mh_line_fields *fields, const char **text);
/* All bytes to the end; read, they lie in the message. At most 32,767. */
void mh_line_bytes(struct mh_line_fields *fields, const uint8_t **bytes, uint16_t *length);

#define MH_LINE_ENUM(fields, value)                                                                                    \
    do {                                                                                                               \
        uint8_t mh_line_value = (uint8_t)(value);                                                                      \
        mh_line_u8(fields, &mh_line_value);                                                                            \
        (value) = mh_line_value;                                                                                       \
    } while (0)

/* ---- messages of many fields ---- */

struct mh_line_identity {
    uint8_t version;       /* MH_LINE_VERSION */
    bool fixed;            /* the arithmetic of mh_real */
    bool self_test_passed; /* known answers were recomputed at start-up */
    bool senses, keeps_time;
    const char *board, *protocol, *tracker; /* tracker: empty if it never computes */
    const char *library;                    /* its version */
    uint16_t reports_max, neighbours_max;   /* MH_REPORTS_MAX, MH_NEIGHBOURS_MAX */
    uint32_t cycles_per_s;                  /* of the counts in DONE */
    uint32_t ram_size, ram_static;          /* bytes; the rest is the stack's */
};

struct mh_line_done {
    enum mh_status status;
    uint32_t cycles; /* of the event, without the line's; of a processor that counts instructions, these */
    uint32_t stack;  /* deepest so far, in bytes */
};

void mh_line_identity(struct mh_line_fields *fields, struct mh_line_identity *identity);
void mh_line_done(struct mh_line_fields *fields, struct mh_line_done *done);

/* Its reals are the bits of mh_real as the board has them, so that nothing is lost. `fixed`: what they are, of use in reading alone. */
void mh_line_estimate(struct mh_line_fields *fields, struct mh_estimate *estimate, bool fixed);

void mh_line_counters(struct mh_line_fields *fields, struct mh_mote_counters *mote, struct mh_head_counters *head,
                      struct mh_protocol_counters *protocol);

#endif
