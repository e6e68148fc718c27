#include "motehound/wire.h"

#include <stdbool.h>

#define FINGERPRINT_BYTES 8
#define FCS_BYTES 2

/* lcm-gen's T_encode and T_decode keep the type's fingerprint in a static variable. Its functions one level below, which the
 * generated code itself uses for nested types, touch nothing but their arguments. */
static uint64_t fingerprint(enum mh_message_kind kind)
{
    switch (kind) {
    case MH_MESSAGE_BEACON:
        return __mh_beacon_t_hash_recursive(NULL);
    case MH_MESSAGE_REPORT:
        return __mh_report_t_hash_recursive(NULL);
    default:
        return __mh_request_t_hash_recursive(NULL);
    }
}

static int encode_body(const struct mh_message *message, uint8_t *bytes, int room)
{
    switch (message->kind) {
    case MH_MESSAGE_BEACON:
        return __mh_beacon_t_encode_array(bytes, 0, room, &message->as.beacon, 1);
    case MH_MESSAGE_REPORT:
        return __mh_report_t_encode_array(bytes, 0, room, &message->as.report, 1);
    default:
        return __mh_request_t_encode_array(bytes, 0, room, &message->as.request, 1);
    }
}

static int decode_body(struct mh_message *message, const uint8_t *bytes, int length)
{
    switch (message->kind) {
    case MH_MESSAGE_BEACON:
        return __mh_beacon_t_decode_array(bytes, 0, length, &message->as.beacon, 1);
    case MH_MESSAGE_REPORT:
        return __mh_report_t_decode_array(bytes, 0, length, &message->as.report, 1);
    default:
        return __mh_request_t_decode_array(bytes, 0, length, &message->as.request, 1);
    }
}

static bool sound(const struct mh_message *message)
{
    const mh_beacon_t *beacon = &message->as.beacon;
    const mh_report_t *report = &message->as.report;
    const mh_request_t *request = &message->as.request;
    switch (message->kind) {
    case MH_MESSAGE_BEACON:
        return beacon->sender != -1 && beacon->hops <= MH_HOPS_MAX && beacon->tracking <= 1;
    case MH_MESSAGE_REPORT:
        return report->sender != -1 && report->origin != -1 && report->hops <= MH_HOPS_MAX &&
               mh_coordinate_valid(report->x_mm) && mh_coordinate_valid(report->y_mm) &&
               mh_coordinate_valid(report->z_mm);
    default:
        return request->sender != -1 && request->origin != -1 && request->hops <= MH_HOPS_MAX &&
               request->radius_mm >= 0 && mh_coordinate_valid(request->x_mm) && mh_coordinate_valid(request->y_mm) &&
               mh_coordinate_valid(request->sender_x_mm) && mh_coordinate_valid(request->sender_y_mm);
    }
}

uint16_t mh_wire_fcs(const uint8_t *bytes, size_t length)
{
    uint16_t fcs = 0;
    for (size_t i = 0; i < length; i++) {
        /* one byte of the reflected division at once: the quotient's bits depend on each other only at distance 4 */
        uint8_t quotient = (uint8_t)(bytes[i] ^ (fcs & 0xFFu));
        quotient = (uint8_t)(quotient ^ (quotient << 4));
        fcs = (uint16_t)((fcs >> 8) ^ ((uint16_t)quotient << 8) ^ ((uint16_t)quotient << 3) ^ (quotient >> 4));
    }
    return fcs;
}

enum mh_status mh_wire_encode(const struct mh_message *message, uint8_t *frame, size_t *length)
{
    if (!message || !frame || !length || (unsigned)message->kind >= MH_MESSAGE_KINDS) {
        return MH_ERR_ARGUMENT;
    }
    const uint64_t type = fingerprint(message->kind);
    for (uint8_t i = 0; i < FINGERPRINT_BYTES; i++) {
        frame[i] = (uint8_t)(type >> (56 - 8 * i));
    }
    const int body = encode_body(message, frame + FINGERPRINT_BYTES, MH_FRAME_MAX - FINGERPRINT_BYTES - FCS_BYTES);
    const size_t end = FINGERPRINT_BYTES + (size_t)body;
    const uint16_t fcs = mh_wire_fcs(frame, end);
    frame[end] = (uint8_t)(fcs & 0xFFu);
    frame[end + 1] = (uint8_t)(fcs >> 8);
    *length = end + FCS_BYTES;
    return MH_OK;
}

enum mh_status mh_wire_decode(const uint8_t *frame, size_t length, struct mh_message *message)
{
    if (!frame || !message) {
        return MH_ERR_ARGUMENT;
    }
    /* the remainder over a frame and its own check sum is zero */
    if (length < FINGERPRINT_BYTES + FCS_BYTES || length > MH_FRAME_MAX || mh_wire_fcs(frame, length) != 0) {
        return MH_ERR_CORRUPT;
    }
    uint64_t type = 0;
    for (uint8_t i = 0; i < FINGERPRINT_BYTES; i++) {
        type = type << 8 | frame[i];
    }
    struct mh_message decoded = {.kind = MH_MESSAGE_BEACON};
    while (decoded.kind < MH_MESSAGE_KINDS && type != fingerprint(decoded.kind)) {
        decoded.kind = (enum mh_message_kind)(decoded.kind + 1);
    }
    if (decoded.kind == MH_MESSAGE_KINDS) {
        return MH_ERR_UNKNOWN;
    }
    const int body = (int)length - FINGERPRINT_BYTES - FCS_BYTES;
    if (decode_body(&decoded, frame + FINGERPRINT_BYTES, body) != body || !sound(&decoded)) {
        return MH_ERR_CORRUPT;
    }
    *message = decoded;
    return MH_OK;
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
