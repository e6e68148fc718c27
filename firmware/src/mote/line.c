#include "motehound/line.h"

#include "motehound/bytes.h"

#include <string.h>

#define FLAG 0x7Eu
#define ESCAPE 0x7Du
#define FLIPPED 0x20u

enum { FCS_BYTES = 2, FIELD_BYTES = 4 };

/* ---- frames ---- */

void mh_line_receiver_init(struct mh_line_receiver *receiver, uint8_t *bytes, uint16_t room)
{
    const struct mh_line_receiver fresh = {.bytes = bytes, .room = room};
    *receiver = fresh;
}

static void begin_anew(struct mh_line_receiver *receiver)
{
    receiver->length = 0;
    receiver->escaped = false;
    receiver->spoilt = false;
}

/* The frame is over; true if it is a message. */
static bool is_message(struct mh_line_receiver *receiver)
{
    const uint16_t length = receiver->length;
    if (length == 0 && !receiver->spoilt && !receiver->escaped) {
        return false; /* between two frames */
    }
    const bool sound =
        !receiver->spoilt && !receiver->escaped && length > FCS_BYTES && mh_wire_fcs(receiver->bytes, length) == 0;
    begin_anew(receiver);
    if (sound) {
        receiver->length = (uint16_t)(length - FCS_BYTES);
    } else {
        receiver->damaged = (uint16_t)(receiver->damaged + (receiver->damaged < UINT16_MAX));
    }
    return sound;
}

bool mh_line_take(struct mh_line_receiver *receiver, uint8_t byte)
{
    if (receiver->complete) {
        receiver->complete = false;
        begin_anew(receiver);
    }
    if (byte == FLAG) {
        receiver->complete = is_message(receiver);
        return receiver->complete;
    }
    if (byte == ESCAPE) {
        receiver->spoilt = receiver->spoilt || receiver->escaped;
        receiver->escaped = true;
    } else if (receiver->length == receiver->room) {
        receiver->spoilt = true;
    } else {
        receiver->bytes[receiver->length++] = (uint8_t)(receiver->escaped ? byte ^ FLIPPED : byte);
        receiver->escaped = false;
    }
    return false;
}

static void put_stuffed(const struct mh_line_sender *sender, uint8_t byte)
{
    if (byte == FLAG || byte == ESCAPE) {
        sender->put(sender->context, ESCAPE);
        byte ^= FLIPPED;
    }
    sender->put(sender->context, byte);
}

void mh_line_begin(struct mh_line_sender *sender, enum mh_line_kind kind)
{
    sender->fcs = 0;
    sender->put(sender->context, FLAG);
    mh_line_byte(sender, (uint8_t)kind);
}

void mh_line_byte(struct mh_line_sender *sender, uint8_t byte)
{
    sender->fcs = mh_wire_fcs_next(sender->fcs, byte);
    put_stuffed(sender, byte);
}

void mh_line_end(struct mh_line_sender *sender)
{
    put_stuffed(sender, (uint8_t)(sender->fcs & 0xFFu));
    put_stuffed(sender, (uint8_t)(sender->fcs >> 8));
    sender->put(sender->context, FLAG);
}

/* ---- fields ---- */

void mh_line_u32(struct mh_line_fields *fields, uint32_t *value)
{
    if (fields->to) {
        uint8_t bytes[FIELD_BYTES], *at = bytes;
        mh_put_u32(&at, *value);
        for (int i = 0; i < FIELD_BYTES; i++) {
            mh_line_byte(fields->to, bytes[i]);
        }
    } else if (fields->left < FIELD_BYTES) {
        fields->broken = true;
    } else {
        *value = mh_get_u32(&fields->at);
        fields->left = (uint16_t)(fields->left - FIELD_BYTES);
    }
}

/* A field of at most `largest`. */
static uint32_t narrow(struct mh_line_fields *fields, uint32_t value, uint32_t largest)
{
    uint32_t given = value;
    mh_line_u32(fields, &given);
    fields->broken = fields->broken || given > largest;
    return given > largest ? value : given;
}

void mh_line_u16(struct mh_line_fields *fields, uint16_t *value)
{
    *value = (uint16_t)narrow(fields, *value, UINT16_MAX);
}

void mh_line_u8(struct mh_line_fields *fields, uint8_t *value) { *value = (uint8_t)narrow(fields, *value, UINT8_MAX); }

void mh_line_bool(struct mh_line_fields *fields, bool *value)
{
    const uint32_t given = narrow(fields, fields->to ? *value : 0, 1);
    if (!fields->to && !fields->broken) {
        *value = given != 0;
    }
}

/* Variables of 4 bytes, as their bits. */
static void bits(struct mh_line_fields *fields, void *value)
{
    uint32_t same;
    memcpy(&same, value, sizeof same);
    mh_line_u32(fields, &same);
    memcpy(value, &same, sizeof same);
}

void mh_line_i32(struct mh_line_fields *fields, int32_t *value) { bits(fields, value); }

void mh_line_real(struct mh_line_fields *fields, mh_real *value)
{
    uint32_t ieee = fields->to ? mh_real_to_ieee(*value) : 0;
    mh_line_u32(fields, &ieee);
    if (!fields->to && !fields->broken) {
        *value = mh_real_from_ieee(ieee);
    }
}

void mh_line_place(struct mh_line_fields *fields, struct mh_place *place)
{
    mh_line_i32(fields, &place->x_mm);
    mh_line_i32(fields, &place->y_mm);
    mh_line_i32(fields, &place->z_mm);
}

void mh_line_region(struct mh_line_fields *fields, struct mh_region *region)
{
    mh_line_i32(fields, &region->x_min_mm);
    mh_line_i32(fields, &region->x_max_mm);
    mh_line_i32(fields, &region->y_min_mm);
    mh_line_i32(fields, &region->y_max_mm);
}

void mh_line_vec2(struct mh_line_fields *fields, struct mh_vec2 *vector)
{
    mh_line_real(fields, &vector->x);
    mh_line_real(fields, &vector->y);
}

void mh_line_text(struct mh_line_fields *fields, const char **text)
{
    if (fields->to) {
        const char *at = *text;
        do {
            mh_line_byte(fields->to, (uint8_t)*at);
        } while (*at++);
        return;
    }
    const uint8_t *end = fields->left > 0 ? memchr(fields->at, 0, fields->left) : NULL;
    if (!end) {
        fields->broken = true;
        return;
    }
    *text = (const char *)fields->at;
    fields->left = (uint16_t)(fields->left - (uint16_t)(end + 1 - fields->at));
    fields->at = end + 1;
}

void mh_line_bytes(struct mh_line_fields *fields, const uint8_t **bytes, uint16_t *length)
{
    if (fields->to) {
        for (uint16_t i = 0; i < *length; i++) {
            mh_line_byte(fields->to, (*bytes)[i]);
        }
        return;
    }
    *bytes = fields->at;
    *length = fields->left;
    fields->at += fields->left;
    fields->left = 0;
}

/* ---- messages of many fields ---- */

void mh_line_identity(struct mh_line_fields *fields, struct mh_line_identity *identity)
{
    mh_line_u8(fields, &identity->version);
    mh_line_bool(fields, &identity->fixed);
    mh_line_bool(fields, &identity->self_test_passed);
    mh_line_bool(fields, &identity->senses);
    mh_line_bool(fields, &identity->keeps_time);
    mh_line_text(fields, &identity->board);
    mh_line_text(fields, &identity->protocol);
    mh_line_text(fields, &identity->tracker);
    mh_line_text(fields, &identity->library);
    mh_line_u16(fields, &identity->reports_max);
    mh_line_u16(fields, &identity->neighbours_max);
    mh_line_u32(fields, &identity->cycles_per_s);
    mh_line_u32(fields, &identity->ram_size);
    mh_line_u32(fields, &identity->ram_static);
}

void mh_line_done(struct mh_line_fields *fields, struct mh_line_done *done)
{
    MH_LINE_ENUM(fields, done->status);
    mh_line_u32(fields, &done->cycles);
    mh_line_u32(fields, &done->stack);
}

static void own_real(struct mh_line_fields *fields, mh_real *value, bool fixed)
{
    if (fields->to || fixed == (MH_REAL_FIXED != 0)) {
        bits(fields, value);
        return;
    }
#if MH_REAL_FIXED
    mh_line_real(fields, value);
#else
    int32_t q16 = 0;
    mh_line_i32(fields, &q16);
    if (!fields->broken) {
        *value = (mh_real)q16 * (1.0f / 65536.0f);
    }
#endif
}

static void own_reals(struct mh_line_fields *fields, mh_real *values, uint8_t count, bool fixed)
{
    for (uint8_t i = 0; i < count; i++) {
        own_real(fields, &values[i], fixed);
    }
}

static void own_vec2(struct mh_line_fields *fields, struct mh_vec2 *value, bool fixed)
{
    own_real(fields, &value->x, fixed);
    own_real(fields, &value->y, fixed);
}

void mh_line_estimate(struct mh_line_fields *fields, struct mh_estimate *estimate, bool fixed)
{
    mh_line_place(fields, &estimate->origin);
    mh_line_u32(fields, &estimate->time);
    own_vec2(fields, &estimate->position, fixed);
    own_vec2(fields, &estimate->velocity, fixed);
    own_real(fields, &estimate->covariance.xx, fixed);
    own_real(fields, &estimate->covariance.xy, fixed);
    own_real(fields, &estimate->covariance.yy, fixed);
    own_reals(fields, estimate->covariance_more, sizeof estimate->covariance_more / sizeof estimate->covariance_more[0],
              fixed);
    own_real(fields, &estimate->rate, fixed);
    own_vec2(fields, &estimate->raw, fixed);
    own_vec2(fields, &estimate->stored, fixed);
    own_vec2(fields, &estimate->stored_velocity, fixed);
    own_real(fields, &estimate->age, fixed);
    mh_line_u32(fields, &estimate->target);
    mh_line_u32(fields, &estimate->near);
    own_real(fields, &estimate->extent, fixed);
    /* images have room for fewer than simulators: so many as there are, and how many can be */
    uint8_t members = estimate->members > MH_GROUP_MAX ? MH_GROUP_MAX : estimate->members;
    mh_line_u16(fields, &estimate->measurements);
    mh_line_u16(fields, &estimate->flags);
    mh_line_u8(fields, &estimate->states);
    mh_line_u8(fields, &members);
    mh_line_u8(fields, &estimate->mode);
    for (uint8_t i = 0; i < members && !fields->broken; i++) {
        uint32_t of = i < MH_GROUP_MAX ? estimate->of[i] : 0;
        mh_line_u32(fields, &of);
        if (i < MH_GROUP_MAX) {
            estimate->of[i] = of;
        }
    }
    estimate->members = members > MH_GROUP_MAX ? MH_GROUP_MAX : members;
}

/* Structures of nothing but uint32_t. */
static void all_u32(struct mh_line_fields *fields, void *counters, size_t size)
{
    for (size_t i = 0; i < size / sizeof(uint32_t); i++) {
        mh_line_u32(fields, (uint32_t *)counters + i);
    }
}

void mh_line_counters(struct mh_line_fields *fields, struct mh_mote_counters *mote, struct mh_head_counters *head,
                      struct mh_protocol_counters *protocol)
{
    all_u32(fields, mote, sizeof *mote);
    all_u32(fields, head, sizeof *head);
    all_u32(fields, protocol, sizeof *protocol);
}
