#include "motehound/vicinity.h"

#include <string.h>

static struct mh_place place_of(const struct mh_vicinity_entry *entry)
{
    const struct mh_place place = {entry->x_mm, entry->y_mm, 0};
    return place;
}

/* Index of the first entry whose identifier is not below `id`. */
static uint8_t find(const struct mh_vicinity *vicinity, mh_node_id id)
{
    uint8_t at = 0;
    while (at < vicinity->count && vicinity->list[at].id < id) {
        at++;
    }
    return at;
}

static bool is_at(const struct mh_vicinity *vicinity, uint8_t at, mh_node_id id)
{
    return at < vicinity->count && vicinity->list[at].id == id;
}

static void erase(struct mh_vicinity *vicinity, uint8_t at)
{
    vicinity->count--;
    memmove(&vicinity->list[at], &vicinity->list[at + 1], (size_t)(vicinity->count - at) * sizeof vicinity->list[0]);
}

static uint32_t distance_mm(const struct mh_vicinity *vicinity, const struct mh_vicinity_entry *entry)
{
    const struct mh_place place = place_of(entry);
    return mh_place_distance_mm(&vicinity->place, &place);
}

static uint8_t farthest(const struct mh_vicinity *vicinity)
{
    uint8_t far = 0;
    uint32_t far_mm = 0;
    for (uint8_t i = 0; i < vicinity->count; i++) {
        const uint32_t mm = distance_mm(vicinity, &vicinity->list[i]);
        if (mm >= far_mm) {
            far = i;
            far_mm = mm;
        }
    }
    return far;
}

enum mh_status mh_vicinity_init(struct mh_vicinity *vicinity, mh_node_id id, const struct mh_place *place,
                                mh_tick lifetime)
{
    if (!vicinity || !place || lifetime < 512 || lifetime > 3600000u) {
        return MH_ERR_ARGUMENT;
    }
    memset(vicinity, 0, sizeof *vicinity);
    vicinity->id = id;
    vicinity->place = *place;
    vicinity->lifetime = mh_coarse_of(lifetime);
    mh_vicinity_hear(vicinity, 0, id, place->x_mm, place->y_mm);
    return MH_OK;
}

void mh_vicinity_hear(struct mh_vicinity *vicinity, mh_tick now, mh_node_id id, int32_t x_mm, int32_t y_mm)
{
    const struct mh_vicinity_entry entry = {id, x_mm, y_mm, mh_coarse_of(now)};
    uint8_t at = find(vicinity, id);
    if (is_at(vicinity, at, id)) {
        if (id != vicinity->id) {
            vicinity->list[at] = entry;
        }
        return;
    }
    if (vicinity->count == MH_VICINITY_MAX) {
        const uint8_t far = farthest(vicinity);
        vicinity->crowded = (uint16_t)(vicinity->crowded + (vicinity->crowded < UINT16_MAX));
        if (distance_mm(vicinity, &entry) >= distance_mm(vicinity, &vicinity->list[far])) {
            return;
        }
        erase(vicinity, far);
        at = find(vicinity, id);
    }
    memmove(&vicinity->list[at + 1], &vicinity->list[at], (size_t)(vicinity->count - at) * sizeof entry);
    vicinity->list[at] = entry;
    vicinity->count++;
}

void mh_vicinity_forget(struct mh_vicinity *vicinity, mh_node_id id)
{
    const uint8_t at = find(vicinity, id);
    if (is_at(vicinity, at, id) && id != vicinity->id) {
        erase(vicinity, at);
    }
}

void mh_vicinity_age(struct mh_vicinity *vicinity, mh_tick now)
{
    for (uint8_t i = vicinity->count; i-- > 0;) {
        const struct mh_vicinity_entry *entry = &vicinity->list[i];
        if (entry->id != vicinity->id && mh_coarse_over(now, entry->heard_at, vicinity->lifetime)) {
            erase(vicinity, i);
        }
    }
}

size_t mh_vicinity_around(const struct mh_vicinity *vicinity, mh_node_id candidate, uint32_t range_mm,
                          struct mh_place *places)
{
    const uint8_t at = find(vicinity, candidate);
    if (!is_at(vicinity, at, candidate)) {
        return 0;
    }
    size_t count = 0;
    places[count++] = place_of(&vicinity->list[at]);
    for (uint8_t i = 0; i < vicinity->count; i++) {
        const struct mh_place place = place_of(&vicinity->list[i]);
        if (i != at && mh_place_within(&places[0], &place, range_mm)) {
            places[count++] = place;
        }
    }
    return count;
}
