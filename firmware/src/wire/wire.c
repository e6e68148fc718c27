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
    case MH_MESSAGE_REQUEST:
        return __mh_request_t_hash_recursive(NULL);
    case MH_MESSAGE_HELLO:
        return __mh_hello_t_hash_recursive(NULL);
    case MH_MESSAGE_LANDMARK:
        return __mh_landmark_t_hash_recursive(NULL);
    default:
        return __mh_sync_t_hash_recursive(NULL);
    }
}

static uint64_t envelope_fingerprint(enum mh_envelope_kind kind)
{
    return kind == MH_ENVELOPE_ROUTE ? __mh_route_t_hash_recursive(NULL) : __mh_face_t_hash_recursive(NULL);
}

static int encode_body(const struct mh_message *message, uint8_t *bytes, int room)
{
    switch (message->kind) {
    case MH_MESSAGE_BEACON:
        return __mh_beacon_t_encode_array(bytes, 0, room, &message->as.beacon, 1);
    case MH_MESSAGE_REPORT:
        return __mh_report_t_encode_array(bytes, 0, room, &message->as.report, 1);
    case MH_MESSAGE_REQUEST:
        return __mh_request_t_encode_array(bytes, 0, room, &message->as.request, 1);
    case MH_MESSAGE_HELLO:
        return __mh_hello_t_encode_array(bytes, 0, room, &message->as.hello, 1);
    case MH_MESSAGE_LANDMARK:
        return __mh_landmark_t_encode_array(bytes, 0, room, &message->as.landmark, 1);
    default:
        return __mh_sync_t_encode_array(bytes, 0, room, &message->as.sync, 1);
    }
}

static int encode_envelope(const struct mh_message *message, uint8_t *bytes, int room)
{
    return message->envelope == MH_ENVELOPE_ROUTE ? __mh_route_t_encode_array(bytes, 0, room, &message->header.route, 1)
                                                  : __mh_face_t_encode_array(bytes, 0, room, &message->header, 1);
}

static int decode_body(struct mh_message *message, const uint8_t *bytes, int length)
{
    switch (message->kind) {
    case MH_MESSAGE_BEACON:
        return __mh_beacon_t_decode_array(bytes, 0, length, &message->as.beacon, 1);
    case MH_MESSAGE_REPORT:
        return __mh_report_t_decode_array(bytes, 0, length, &message->as.report, 1);
    case MH_MESSAGE_REQUEST:
        return __mh_request_t_decode_array(bytes, 0, length, &message->as.request, 1);
    case MH_MESSAGE_HELLO:
        return __mh_hello_t_decode_array(bytes, 0, length, &message->as.hello, 1);
    case MH_MESSAGE_LANDMARK:
        return __mh_landmark_t_decode_array(bytes, 0, length, &message->as.landmark, 1);
    default:
        return __mh_sync_t_decode_array(bytes, 0, length, &message->as.sync, 1);
    }
}

static int decode_envelope(struct mh_message *message, const uint8_t *bytes, int length)
{
    return message->envelope == MH_ENVELOPE_ROUTE
               ? __mh_route_t_decode_array(bytes, 0, length, &message->header.route, 1)
               : __mh_face_t_decode_array(bytes, 0, length, &message->header, 1);
}

static bool valid(int32_t x_mm, int32_t y_mm) { return mh_coordinate_valid(x_mm) && mh_coordinate_valid(y_mm); }

static bool beacon_sound(const mh_beacon_t *beacon)
{
    return beacon->sender != -1 && beacon->hops <= MH_HOPS_MAX && beacon->tracking <= 1;
}

static bool body_sound(const struct mh_message *message)
{
    const mh_report_t *report = &message->as.report;
    const mh_request_t *request = &message->as.request;
    const mh_hello_t *hello = &message->as.hello;
    const mh_landmark_t *landmark = &message->as.landmark;
    const mh_sync_t *sync = &message->as.sync;
    switch (message->kind) {
    case MH_MESSAGE_BEACON:
        return beacon_sound(&message->as.beacon);
    case MH_MESSAGE_REPORT:
        return report->sender != -1 && report->origin != -1 && report->hops <= MH_HOPS_MAX &&
               valid(report->x_mm, report->y_mm) && mh_coordinate_valid(report->z_mm);
    case MH_MESSAGE_REQUEST:
        return request->sender != -1 && request->origin != -1 && request->hops <= MH_HOPS_MAX &&
               request->radius_mm >= 0 && valid(request->x_mm, request->y_mm) &&
               valid(request->sender_x_mm, request->sender_y_mm);
    case MH_MESSAGE_HELLO:
        return hello->sender != -1 && valid(hello->x_mm, hello->y_mm);
    case MH_MESSAGE_LANDMARK:
        return beacon_sound(&landmark->beacon) && valid(landmark->x_mm, landmark->y_mm);
    default:
        return sync->sender != -1 && sync->root != -1 && sync->stamped <= 1;
    }
}

static bool envelope_sound(const struct mh_message *message)
{
    const mh_face_t *face = &message->header;
    const mh_route_t *route = &face->route;
    return route->sender != -1 && route->origin != -1 && route->hops >= 0 && route->hops <= MH_ROUTE_HOPS_MAX &&
           valid(route->x_mm, route->y_mm) &&
           (message->envelope == MH_ENVELOPE_ROUTE ||
            (face->entry != -1 && face->first != -1 && valid(face->sender_x_mm, face->sender_y_mm) &&
             valid(face->entry_x_mm, face->entry_y_mm)));
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

enum mh_status mh_wire_encode(const struct mh_message *message, uint8_t *frame, size_t *length)
{
    if (!message || !frame || !length || (unsigned)message->kind >= MH_MESSAGE_KINDS ||
        (unsigned)message->envelope >= MH_ENVELOPE_KINDS) {
        return MH_ERR_ARGUMENT;
    }
    int end = 0;
    if (message->envelope != MH_ENVELOPE_NONE) {
        put_fingerprint(frame, envelope_fingerprint(message->envelope));
        end = FINGERPRINT_BYTES;
        end += encode_envelope(message, frame + end, MH_FRAME_MAX - FCS_BYTES - end);
    }
    put_fingerprint(frame + end, fingerprint(message->kind));
    end += FINGERPRINT_BYTES;
    end += encode_body(message, frame + end, MH_FRAME_MAX - FCS_BYTES - end);
    const uint16_t fcs = mh_wire_fcs(frame, (size_t)end);
    frame[end] = (uint8_t)(fcs & 0xFFu);
    frame[end + 1] = (uint8_t)(fcs >> 8);
    *length = (size_t)end + FCS_BYTES;
    return MH_OK;
}

static enum mh_message_kind kind_of(uint64_t type)
{
    enum mh_message_kind kind = MH_MESSAGE_BEACON;
    while (kind < MH_MESSAGE_KINDS && type != fingerprint(kind)) {
        kind = (enum mh_message_kind)(kind + 1);
    }
    return kind;
}

/* The envelope at the beginning of bytes[0 .. length), if there is one. Returns its length, negative if it is not whole. */
static int open_envelope(struct mh_message *message, const uint8_t *bytes, int length)
{
    const uint64_t type = get_fingerprint(bytes);
    for (int kind = MH_ENVELOPE_ROUTE; kind < MH_ENVELOPE_KINDS; kind++) {
        if (type == envelope_fingerprint((enum mh_envelope_kind)kind)) {
            message->envelope = (enum mh_envelope_kind)kind;
            const int header = decode_envelope(message, bytes + FINGERPRINT_BYTES, length - FINGERPRINT_BYTES);
            return header < 0 || !envelope_sound(message) ? -1 : FINGERPRINT_BYTES + header;
        }
    }
    return 0;
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
    struct mh_message decoded = {.kind = kind_of(get_fingerprint(frame))};
    const int end = (int)length - FCS_BYTES;
    int begin = 0;
    if (decoded.kind == MH_MESSAGE_KINDS) {
        begin = open_envelope(&decoded, frame, end);
        if (begin < 0 || end - begin < FINGERPRINT_BYTES) {
            return MH_ERR_CORRUPT;
        }
        decoded.kind = kind_of(get_fingerprint(frame + begin));
        if (decoded.kind == MH_MESSAGE_KINDS) {
            return MH_ERR_UNKNOWN;
        }
    }
    begin += FINGERPRINT_BYTES;
    if (decode_body(&decoded, frame + begin, end - begin) != end - begin || !body_sound(&decoded)) {
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
