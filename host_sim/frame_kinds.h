/* What kind of message a frame carries, told from its first bytes: cheap, and without judging whether the frame is sound. */
#ifndef MOTEHOUND_SIM_FRAME_KINDS_H
#define MOTEHOUND_SIM_FRAME_KINDS_H

#include "motehound/wire.h"

#include <stddef.h>
#include <stdint.h>

struct frame_kinds {
    uint64_t kinds[MH_MESSAGE_KINDS];      /* how messages of a kind begin */
    uint64_t envelopes[MH_ENVELOPE_KINDS]; /* how envelopes begin ... */
    size_t lengths[MH_ENVELOPE_KINDS];     /* ... and how long they are */
};

void frame_kinds_learn(struct frame_kinds *kinds);

/* Of the message, within an envelope if it is in one; MH_MESSAGE_KINDS for a frame that is none of the library's. */
enum mh_message_kind frame_kind(const struct frame_kinds *kinds, const uint8_t *frame, size_t length);

#endif
