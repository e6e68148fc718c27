/* Frames from the air: any bytes, and the same with their check sum repaired, so that the fields behind it are reached. */
#include "fuzz.h"
#include "motehound/wire.h"

#include <string.h>

/* What is taken must be what a sender writes: encoded again it is the same frame. */
static void take(const uint8_t *frame, size_t length)
{
    struct mh_message message;
    uint8_t again[MH_FRAME_MAX];
    size_t again_length;
    if (mh_wire_decode(mh_wire_all, frame, length, &message) != MH_OK) {
        return;
    }
    require(mh_wire_encode(mh_wire_all, &message, again, &again_length) == MH_OK);
    require(again_length == length && memcmp(frame, again, length) == 0);
    if (message.kind == MH_MESSAGE_REPORT) {
        struct mh_measurement measurement;
        mh_report_to_measurement(&message.as.report, &measurement);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t repaired[2 * MH_FRAME_MAX];
    take(data, size);
    if (size >= 2 && size <= sizeof repaired) {
        memcpy(repaired, data, size);
        const uint16_t fcs = mh_wire_fcs(repaired, size - 2);
        repaired[size - 2] = (uint8_t)fcs;
        repaired[size - 1] = (uint8_t)(fcs >> 8);
        take(repaired, size);
    }
    return 0;
}
