/* A byte string that is too long for a frame: cut into parts, which travel as hand_over_t, and joined again, whatever the order in which they come and
 * however often.
 *
 * Sender: for each part below MH_PARCEL_PARTS(length), mh_parcel_cut() and send; whether it has arrived is the link's business (link.h).
 * Receiver: a struct mh_parcel that begins as zeros, and room for the whole. One parcel is joined at a time: a part of another, which differs in its sender,
 * track, generation or number of parts, begins anew.
 *
 * Nothing is believed that does not fit: parts carry no check of their own beside the frame's, but what is joined has the length that was cut. */
#ifndef MOTEHOUND_PARCEL_H
#define MOTEHOUND_PARCEL_H

#include "motehound/wire.h"

#define MH_PARCEL_PARTS_MAX 31 /* 1,984 bytes */
#define MH_PARCEL_PARTS(length) (((length) + MH_HAND_OVER_BYTES - 1) / MH_HAND_OVER_BYTES)

struct mh_parcel {
    bool begun;
    mh_node_id from, track;
    int32_t generation;
    uint8_t parts;
    uint32_t came;   /* bit k: part k */
    uint16_t length; /* of the whole; 0 as long as the last part has not come */
};

/* Part number `part`, below MH_PARCEL_PARTS(length), of bytes[0 .. length) -> part, parts, length and data of *into. Track, generation and time are the
 * caller's. */
void mh_parcel_cut(const uint8_t *bytes, size_t length, uint8_t part, mh_hand_over_t *into);

/* A part has come from node `from`. Returns MH_OK when it was the last that was missing: bytes[0 .. parcel->length) is whole, and the next part begins
 * another parcel; else MH_NONE. Errors: MH_ERR_REPEATED (it has come before), MH_ERR_CORRUPT (not a part that mh_parcel_cut makes), MH_ERR_CAPACITY (it does
 * not fit in `room`, or there are more than MH_PARCEL_PARTS_MAX parts). */
enum mh_status mh_parcel_join(struct mh_parcel *parcel, uint8_t *bytes, size_t room, mh_node_id from,
                              const mh_hand_over_t *part);

#endif
