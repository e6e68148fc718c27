/* Messages to frames and back.
 *
 * A frame is an LCM-encoded message of lcm_types/mh_radio.lcm (8 bytes of fingerprint, then the fields, big-endian)
 * followed by the 16-bit frame check sequence of IEEE 802.15.4 (ITU-T CRC-16, least significant byte first), at most
 * MH_FRAME_MAX bytes in all. A message that travels to a place has an envelope before it, encoded in the same way. */
#ifndef MOTEHOUND_WIRE_H
#define MOTEHOUND_WIRE_H

#include "motehound/config.h"
#include "motehound/measurement.h"
#include "motehound/status.h"

#include "mh_alert_t.h"
#include "mh_answer_t.h"
#include "mh_ask_t.h"
#include "mh_awake_t.h"
#include "mh_beacon_t.h"
#include "mh_compete_t.h"
#include "mh_detection_t.h"
#include "mh_face_t.h"
#include "mh_fail_t.h"
#include "mh_form_t.h"
#include "mh_hand_over_t.h"
#include "mh_hello_t.h"
#include "mh_join_t.h"
#include "mh_landmark_t.h"
#include "mh_lead_t.h"
#include "mh_leak_t.h"
#include "mh_locate_t.h"
#include "mh_merge_t.h"
#include "mh_position_t.h"
#include "mh_report_t.h"
#include "mh_request_t.h"
#include "mh_rest_t.h"
#include "mh_sound_t.h"
#include "mh_succeed_t.h"
#include "mh_suppress_t.h"
#include "mh_sync_t.h"
#include "mh_taken_t.h"
#include "mh_token_t.h"
#include "mh_vicinity_t.h"

#include <stddef.h>
#include <stdint.h>

#define MH_BROADCAST ((mh_node_id)0xFFFFFFFFu)

#define MH_FORM_MEMBERS 16    /* that a form_t names */
#define MH_HAND_OVER_BYTES 64 /* of a track in a hand_over_t */
#define MH_VICINITY_NODES 6   /* that a vicinity_t tells of */
#define MH_CLUSTER_NONE 255   /* not the number of a fixed cluster */
#define MH_LEAD_BYTES 64      /* of a track in a lead_t */
#define MH_AWAKE_BYTES 52     /* of a track in an awake_t, and in a rest_t */

enum mh_message_kind {
    MH_MESSAGE_BEACON,
    MH_MESSAGE_REPORT,
    MH_MESSAGE_REQUEST,
    MH_MESSAGE_HELLO,
    MH_MESSAGE_LANDMARK,
    MH_MESSAGE_SYNC,
    MH_MESSAGE_ASK,
    MH_MESSAGE_ANSWER,
    MH_MESSAGE_FORM,
    MH_MESSAGE_JOIN,
    MH_MESSAGE_HAND_OVER,
    MH_MESSAGE_ALERT,
    MH_MESSAGE_POSITION,
    MH_MESSAGE_VICINITY,
    MH_MESSAGE_TOKEN,
    MH_MESSAGE_LEAK,
    MH_MESSAGE_LEAD,
    MH_MESSAGE_TAKEN,
    MH_MESSAGE_AWAKE,
    MH_MESSAGE_REST,
    MH_MESSAGE_LOCATE,
    MH_MESSAGE_SOUND,
    MH_MESSAGE_FAIL,
    MH_MESSAGE_SUCCEED,
    MH_MESSAGE_COMPETE,
    MH_MESSAGE_DETECTION,
    MH_MESSAGE_SUPPRESS,
    MH_MESSAGE_MERGE,
    MH_MESSAGE_KINDS
};

/* How a search stands, in token_t and leak_t (token.h). */
enum mh_search { MH_SEARCH_GOES_ON, MH_SEARCH_CONVERGED, MH_SEARCH_EXHAUSTED };

/* Why a locate_t is sent (prince.h). */
enum mh_locate { MH_LOCATE_PRINCE, MH_LOCATE_EXCEPTION, MH_LOCATE_REGENT, MH_LOCATE_COMPETITION };

enum mh_envelope_kind { MH_ENVELOPE_NONE, MH_ENVELOPE_ROUTE, MH_ENVELOPE_FACE, MH_ENVELOPE_KINDS };

struct mh_message {
    enum mh_message_kind kind;
    union {
        mh_beacon_t beacon;
        mh_report_t report;
        mh_request_t request;
        mh_hello_t hello;
        mh_landmark_t landmark;
        mh_sync_t sync;
        mh_ask_t ask;
        mh_answer_t answer;
        mh_form_t form;
        mh_join_t join;
        mh_hand_over_t hand_over;
        mh_alert_t alert;
        mh_position_t position;
        mh_vicinity_t vicinity;
        mh_token_t token;
        mh_leak_t leak;
        mh_lead_t lead;
        mh_taken_t taken;
        mh_awake_t awake;
        mh_rest_t rest;
        mh_locate_t locate;
        mh_sound_t sound;
        mh_fail_t fail;
        mh_succeed_t succeed;
        mh_compete_t compete;
        mh_detection_t detection;
        mh_suppress_t suppress;
        mh_merge_t merge;
    } as;
    enum mh_envelope_kind envelope;
    mh_face_t header; /* header.route in both envelopes, the rest only in MH_ENVELOPE_FACE */
};

/* How one type of message, or one envelope, is laid out in a frame. Who speaks it refers to it: an image holds the code of no others. */
struct mh_wire_type {
    enum mh_message_kind kind;                              /* MH_MESSAGE_KINDS: it is an envelope */
    enum mh_envelope_kind envelope;                         /* MH_ENVELOPE_NONE: it is a message */
    uint64_t (*fingerprint)(const __lcm_hash_ptr *parents); /* parents: NULL */
    /* -> bytes[0 .. room). Returns the length. */
    int (*encode)(const struct mh_message *message, uint8_t *bytes, int room);
    /* bytes[0 .. length) -> message. Returns how many bytes it took; negative if they are too few or a field is one that no sender
     * writes: MH_BROADCAST as sender, more than MH_HOPS_MAX hops (MH_ROUTE_HOPS_MAX in an envelope), a place outside
     * +- 1e9 mm, a speed along an axis outside +- 1e9 mm/s, a negative radius, a number of things that do not fit or are not there. */
    int (*decode)(struct mh_message *message, const uint8_t *bytes, int length);
};

extern const struct mh_wire_type mh_wire_beacon, mh_wire_report, mh_wire_request, mh_wire_hello, mh_wire_landmark,
    mh_wire_sync, mh_wire_ask, mh_wire_answer, mh_wire_form, mh_wire_join, mh_wire_hand_over, mh_wire_alert,
    mh_wire_position, mh_wire_vicinity, mh_wire_token, mh_wire_leak, mh_wire_lead, mh_wire_taken, mh_wire_awake,
    mh_wire_rest, mh_wire_locate, mh_wire_sound, mh_wire_fail, mh_wire_succeed, mh_wire_compete, mh_wire_detection,
    mh_wire_suppress, mh_wire_merge, mh_wire_route, mh_wire_face;

/* What somebody speaks: types in any order, then NULL. */
typedef const struct mh_wire_type *const mh_wire_types;

/* Every type there is: for who looks on. */
extern mh_wire_types mh_wire_all[];

/* message -> frame[0 .. *length). `frame` has room for MH_FRAME_MAX bytes, which are written whatever is returned. Errors: MH_ERR_ARGUMENT
 * (the kind or the envelope is not among `types`), MH_ERR_CAPACITY (too long for this envelope: form_t, hand_over_t, vicinity_t, lead_t and rest_t do not go in a face_t, awake_t in no
 * envelope). */
enum mh_status mh_wire_encode(mh_wire_types *types, const struct mh_message *message, uint8_t *frame, size_t *length);

/* frame[0 .. length) -> message; safe on any bytes. Errors: MH_ERR_CORRUPT (too short, too long, wrong check sum, or fields
 * that no sender writes), MH_ERR_UNKNOWN (sound as far as can be told, but of a type that is not among `types`). */
enum mh_status mh_wire_decode(mh_wire_types *types, const uint8_t *frame, size_t length, struct mh_message *message);

/* ITU-T CRC-16 as IEEE 802.15.4 uses it: polynomial x^16 + x^12 + x^5 + 1, reflected, initial value 0. */
uint16_t mh_wire_fcs(const uint8_t *bytes, size_t length);
/* The same byte by byte: that of what came before, and one more byte. */
uint16_t mh_wire_fcs_next(uint16_t fcs, uint8_t byte);

/* A measurement as the report that its node puts on the air (hops 0), and back. */
void mh_report_from_measurement(const struct mh_measurement *measurement, mh_report_t *report);
void mh_report_to_measurement(const mh_report_t *report, struct mh_measurement *measurement);

/* The same as an answer. */
void mh_answer_from_measurement(const struct mh_measurement *measurement, mh_answer_t *answer);
void mh_answer_to_measurement(const mh_answer_t *answer, struct mh_measurement *measurement);

#endif
