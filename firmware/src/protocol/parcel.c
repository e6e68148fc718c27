#include "motehound/parcel.h"

#include <string.h>

void mh_parcel_cut(const uint8_t *bytes, size_t length, uint8_t part, mh_hand_over_t *into)
{
    const size_t from = (size_t)part * MH_HAND_OVER_BYTES, left = length - from;
    into->part = part;
    into->parts = (uint8_t)MH_PARCEL_PARTS(length);
    into->length = (uint8_t)(left < MH_HAND_OVER_BYTES ? left : MH_HAND_OVER_BYTES);
    memset(into->data, 0, MH_HAND_OVER_BYTES);
    memcpy(into->data, bytes + from, into->length);
}

static bool is_of(const struct mh_parcel *parcel, mh_node_id from, const mh_hand_over_t *part)
{
    return parcel->begun && parcel->from == from && parcel->track == (mh_node_id)part->track &&
           parcel->generation == part->generation && parcel->parts == part->parts;
}

enum mh_status mh_parcel_join(struct mh_parcel *parcel, uint8_t *bytes, size_t room, mh_node_id from,
                              const mh_hand_over_t *part)
{
    const size_t begin = (size_t)part->part * MH_HAND_OVER_BYTES;
    const bool is_last = part->part + 1 == part->parts;
    if (part->part >= part->parts || part->length == 0 || part->length > MH_HAND_OVER_BYTES ||
        (!is_last && part->length != MH_HAND_OVER_BYTES)) {
        return MH_ERR_CORRUPT;
    }
    if (part->parts > MH_PARCEL_PARTS_MAX || begin + part->length > room) {
        return MH_ERR_CAPACITY;
    }
    if (!is_of(parcel, from, part)) {
        const struct mh_parcel begun = {.begun = true,
                                        .from = from,
                                        .track = (mh_node_id)part->track,
                                        .generation = part->generation,
                                        .parts = part->parts};
        *parcel = begun;
    }
    if (parcel->came >> part->part & 1u) {
        return MH_ERR_REPEATED;
    }
    memcpy(bytes + begin, part->data, part->length);
    parcel->came |= (uint32_t)1 << part->part;
    parcel->length = is_last ? (uint16_t)(begin + part->length) : parcel->length;
    if (parcel->came != ((uint32_t)1 << part->parts) - 1) {
        return MH_NONE;
    }
    parcel->begun = false;
    return MH_OK;
}
