#include "motehound/wire.h"

#include <stdbool.h>

#define FINGERPRINT_BYTES 8
#define FCS_BYTES 2

uint16_t mh_wire_fcs_next(uint16_t fcs, uint8_t byte)
{
    /* one byte of the reflected division at once: the quotient's bits depend on each other only at distance 4 */
    uint8_t quotient = (uint8_t)(byte ^ (fcs & 0xFFu));
    quotient = (uint8_t)(quotient ^ (quotient << 4));
    return (uint16_t)((fcs >> 8) ^ ((uint16_t)quotient << 8) ^ ((uint16_t)quotient << 3) ^ (quotient >> 4));
}

uint16_t mh_wire_fcs(const uint8_t *bytes, size_t length)
{
    uint16_t fcs = 0;
    for (size_t i = 0; i < length; i++) {
        fcs = mh_wire_fcs_next(fcs, bytes[i]);
    }
    return fcs;
}

static void put_fingerprint(uint8_t *bytes, uint64_t type)
{
    for (uint8_t i = 0; i < FINGERPRINT_BYTES; i++) {
        bytes[i] = (uint8_t)(type >> (56 - 8 * i));
    }
}

static uint64_t get_fingerprint(const uint8_t *bytes)
{
    uint64_t type = 0;
    for (uint8_t i = 0; i < FINGERPRINT_BYTES; i++) {
        type = type << 8 | bytes[i];
    }
    return type;
}

static const struct mh_wire_type *find(mh_wire_types *types, enum mh_message_kind kind, enum mh_envelope_kind envelope)
{
    for (; *types && ((*types)->kind != kind || (*types)->envelope != envelope); types++) {}
    return *types;
}

static const struct mh_wire_type *find_fingerprint(mh_wire_types *types, const uint8_t *bytes)
{
    const uint64_t type = get_fingerprint(bytes);
    for (; *types && (*types)->fingerprint(NULL) != type; types++) {}
    return *types;
}

/* Returns the end; negative if there is no room. */
static int put(const struct mh_wire_type *type, const struct mh_message *message, uint8_t *frame, int begin)
{
    const int after = begin + FINGERPRINT_BYTES;
    put_fingerprint(frame + begin, type->fingerprint(NULL));
    const int taken = type->encode(message, frame + after, MH_FRAME_MAX - FCS_BYTES - after);
    return taken < 0 ? taken : after + taken;
}

enum mh_status mh_wire_encode(mh_wire_types *types, const struct mh_message *message, uint8_t *frame, size_t *length)
{
    if (!types || !message || !frame || !length) {
        return MH_ERR_ARGUMENT;
    }
    const bool is_enveloped = message->envelope != MH_ENVELOPE_NONE;
    const struct mh_wire_type *body = find(types, message->kind, MH_ENVELOPE_NONE);
    const struct mh_wire_type *envelope = is_enveloped ? find(types, MH_MESSAGE_KINDS, message->envelope) : NULL;
    if (!body || (is_enveloped && !envelope)) {
        return MH_ERR_ARGUMENT;
    }
    const int begin = envelope ? put(envelope, message, frame, 0) : 0;
    const int end = put(body, message, frame, begin);
    if (end < 0) {
        return MH_ERR_CAPACITY;
    }
    const uint16_t fcs = mh_wire_fcs(frame, (size_t)end);
    frame[end] = (uint8_t)(fcs & 0xFFu);
    frame[end + 1] = (uint8_t)(fcs >> 8);
    *length = (size_t)end + FCS_BYTES;
    return MH_OK;
}

/* The message or envelope that begins at *begin; *begin -> its end. */
static enum mh_status get(mh_wire_types *types, const uint8_t *frame, int *begin, int end, struct mh_message *message)
{
    if (end - *begin < FINGERPRINT_BYTES) {
        return MH_ERR_CORRUPT;
    }
    const struct mh_wire_type *type = find_fingerprint(types, frame + *begin);
    if (!type) {
        return MH_ERR_UNKNOWN;
    }
    *begin += FINGERPRINT_BYTES;
    const int taken = type->decode(message, frame + *begin, end - *begin);
    *begin += taken;
    message->kind = type->kind;
    message->envelope = type->envelope != MH_ENVELOPE_NONE ? type->envelope : message->envelope;
    return taken < 0 ? MH_ERR_CORRUPT : MH_OK;
}

enum mh_status mh_wire_decode(mh_wire_types *types, const uint8_t *frame, size_t length, struct mh_message *message)
{
    if (!types || !frame || !message) {
        return MH_ERR_ARGUMENT;
    }
    /* the remainder over a frame and its own check sum is zero */
    if (length < FINGERPRINT_BYTES + FCS_BYTES || length > MH_FRAME_MAX || mh_wire_fcs(frame, length) != 0) {
        return MH_ERR_CORRUPT;
    }
    struct mh_message decoded = {.envelope = MH_ENVELOPE_NONE};
    const int end = (int)length - FCS_BYTES;
    int begin = 0;
    enum mh_status status = get(types, frame, &begin, end, &decoded);
    if (status == MH_OK && decoded.envelope != MH_ENVELOPE_NONE) {
        status = get(types, frame, &begin, end, &decoded);
    }
    if (status == MH_OK && (begin != end || decoded.kind == MH_MESSAGE_KINDS)) {
        status = MH_ERR_CORRUPT; /* more than a message, or an envelope in an envelope */
    }
    if (status == MH_OK) {
        *message = decoded;
    }
    return status;
}

void mh_report_from_measurement(const struct mh_measurement *measurement, mh_report_t *report)
{
    const mh_report_t packed = {
        .sender = (int32_t)measurement->node,
        .origin = (int32_t)measurement->node,
        .time_ms = (int32_t)measurement->time,
        .x_mm = measurement->place.x_mm,
        .y_mm = measurement->place.y_mm,
        .z_mm = measurement->place.z_mm,
        .value_q20 = measurement->value,
        .increment_q20 = measurement->increment,
        .flags = measurement->flags,
        .target = measurement->target,
    };
    *report = packed;
}

void mh_report_to_measurement(const mh_report_t *report, struct mh_measurement *measurement)
{
    const struct mh_measurement unpacked = {
        .node = (mh_node_id)report->origin,
        .place = {report->x_mm, report->y_mm, report->z_mm},
        .time = (mh_tick)report->time_ms,
        .value = report->value_q20,
        .increment = report->increment_q20,
        .flags = report->flags,
        .target = report->target,
    };
    *measurement = unpacked;
}

void mh_answer_from_measurement(const struct mh_measurement *measurement, mh_answer_t *answer)
{
    const mh_answer_t packed = {
        .sender = (int32_t)measurement->node,
        .time_ms = (int32_t)measurement->time,
        .x_mm = measurement->place.x_mm,
        .y_mm = measurement->place.y_mm,
        .z_mm = measurement->place.z_mm,
        .value_q20 = measurement->value,
        .flags = measurement->flags,
    };
    *answer = packed;
}

void mh_answer_to_measurement(const mh_answer_t *answer, struct mh_measurement *measurement)
{
    const struct mh_measurement unpacked = {
        .node = (mh_node_id)answer->sender,
        .place = {answer->x_mm, answer->y_mm, answer->z_mm},
        .time = (mh_tick)answer->time_ms,
        .value = answer->value_q20,
        .flags = answer->flags & MH_MEASUREMENT_ASKED, /* an answer bears no increment */
    };
    *measurement = unpacked;
}
