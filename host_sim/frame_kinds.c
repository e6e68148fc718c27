#include "frame_kinds.h"

#include <string.h>

static uint64_t beginning(const uint8_t *bytes)
{
    uint64_t beginning;
    memcpy(&beginning, bytes, sizeof beginning);
    return beginning;
}

/* From frames that the library makes: so this file need not know how they are laid out, but that an envelope comes first. */
void frame_kinds_learn(struct frame_kinds *kinds)
{
    uint8_t frame[MH_FRAME_MAX] = {0};
    size_t length, bare = 0;
    *kinds = (struct frame_kinds){0};
    for (int kind = MH_MESSAGE_KINDS - 1; kind >= 0; kind--) {
        const struct mh_message message = {.kind = (enum mh_message_kind)kind};
        if (mh_wire_encode(mh_wire_all, &message, frame, &length) == MH_OK) {
            kinds->kinds[kind] = beginning(frame);
            bare = length; /* in the end of kind 0 */
        }
    }
    for (int envelope = MH_ENVELOPE_NONE + 1; envelope < MH_ENVELOPE_KINDS; envelope++) {
        const struct mh_message message = {.envelope = (enum mh_envelope_kind)envelope};
        if (mh_wire_encode(mh_wire_all, &message, frame, &length) == MH_OK) {
            kinds->envelopes[envelope] = beginning(frame);
            kinds->lengths[envelope] = length - bare;
        }
    }
}

enum mh_message_kind frame_kind(const struct frame_kinds *kinds, const uint8_t *frame, size_t length)
{
    size_t at = 0;
    for (int envelope = MH_ENVELOPE_NONE + 1; envelope < MH_ENVELOPE_KINDS && length >= sizeof(uint64_t); envelope++) {
        if (beginning(frame) == kinds->envelopes[envelope]) {
            at = kinds->lengths[envelope];
        }
    }
    int kind = 0;
    if (length < at + sizeof(uint64_t)) {
        return MH_MESSAGE_KINDS;
    }
    while (kind < MH_MESSAGE_KINDS && beginning(frame + at) != kinds->kinds[kind]) {
        kind++;
    }
    return (enum mh_message_kind)kind;
}
