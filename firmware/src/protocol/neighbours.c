#include "motehound/neighbours.h"

#include <string.h>

#define SHARE_MAX 255    /* 100 % */
#define SHARE_NEW 192    /* of a neighbour's hellos, before a second one has come */
#define SHARE_USABLE 64  /* a quarter */
#define MISSED_MAX 16    /* a greater gap between the numbers of two hellos means that the sender has been restarted */
#define NOBODY UINT8_MAX /* index of no entry */
#define OCTANTS 8

static void count(struct mh_neighbours *table, enum mh_neighbour_loss reason)
{
    if (table->lost[reason] < UINT16_MAX) {
        table->lost[reason]++;
    }
}

static uint8_t better(uint8_t share) { return (uint8_t)(share + (SHARE_MAX - share + 3) / 4); }

static uint8_t worse(uint8_t share) { return (uint8_t)(share - (share + 3) / 4); }

/* ---- the Gabriel graph ---- */

static bool is_at(const struct mh_neighbour *n, int32_t x_mm, int32_t y_mm)
{
    return n->x_mm == x_mm && n->y_mm == y_mm;
}

static bool is_here(const struct mh_neighbours *table, const struct mh_neighbour *n)
{
    return is_at(n, table->place.x_mm, table->place.y_mm);
}

/* A point lies strictly inside a circle exactly if it sees a diameter under an obtuse angle. Differences of coordinates fit in 32 bits,
 * the product in 64. */
static bool witnesses(const struct mh_neighbours *table, const struct mh_neighbour *w, const struct mh_neighbour *v)
{
    if (is_here(table, v)) {
        return false;
    }
    if (is_here(table, w)) {
        return w->id < table->id;
    }
    if (is_at(w, v->x_mm, v->y_mm)) {
        return w->id < v->id;
    }
    const int64_t here_x = table->place.x_mm - w->x_mm, here_y = table->place.y_mm - w->y_mm;
    const int64_t v_x = v->x_mm - w->x_mm, v_y = v->y_mm - w->y_mm;
    return here_x * v_x + here_y * v_y < 0;
}

static void mark_those_witnessed_by(struct mh_neighbours *table, const struct mh_neighbour *w)
{
    for (uint8_t i = 0; i < table->count; i++) {
        struct mh_neighbour *v = &table->list[i];
        if (v->id != w->id && witnesses(table, w, v)) {
            v->edge = MH_EDGE_WITNESSED;
            v->witnessed_at = w->heard_at;
        }
    }
}

static void look_for_a_witness(const struct mh_neighbours *table, struct mh_neighbour *v)
{
    for (uint8_t i = 0; i < table->count && v->edge != MH_EDGE_WITNESSED; i++) {
        const struct mh_neighbour *w = &table->list[i];
        if (w->id != v->id && mh_neighbour_usable(w) && witnesses(table, w, v)) {
            v->edge = MH_EDGE_WITNESSED;
            v->witnessed_at = w->heard_at;
        }
    }
}

bool mh_neighbour_planar(const struct mh_neighbours *table, const struct mh_neighbour *neighbour)
{
    return mh_neighbour_usable(neighbour) && neighbour->edge == MH_EDGE_GABRIEL && !is_here(table, neighbour);
}

/* ---- quality ---- */

uint16_t mh_neighbour_quality(const struct mh_neighbour *neighbour)
{
    return (uint16_t)((uint16_t)neighbour->heard * neighbour->acked);
}

bool mh_neighbour_usable(const struct mh_neighbour *neighbour)
{
    return neighbour->heard >= SHARE_USABLE && neighbour->acked >= SHARE_USABLE;
}

/* The hellos since the last one that came: those missed, then this one. Each that comes also lets an unused neighbour recover. */
static void take_hello(struct mh_neighbour *n, uint16_t heard_at, uint8_t sequence)
{
    const uint8_t gap = (uint8_t)(sequence - n->sequence);
    n->heard_at = heard_at;
    n->sequence = sequence;
    for (uint8_t i = 1; i < gap && gap <= MISSED_MAX; i++) {
        n->heard = worse(n->heard);
    }
    if (gap > 0) {
        n->heard = better(n->heard);
        n->edge = n->edge == MH_EDGE_NEW ? MH_EDGE_GABRIEL : n->edge;
        if (n->acked < SHARE_USABLE) {
            n->acked = better(n->acked);
        }
    }
}

void mh_neighbours_acked(struct mh_neighbours *table, mh_node_id id, bool acked)
{
    for (uint8_t i = 0; i < table->count; i++) {
        struct mh_neighbour *n = &table->list[i];
        if (n->id == id) {
            n->acked = acked ? better(n->acked) : worse(n->acked);
        }
    }
}

/* ---- room ---- */

static uint32_t size_of(int32_t difference) { return difference < 0 ? 0 - (uint32_t)difference : (uint32_t)difference; }

/* distance x quality; the distance to within an eighth, without a root */
static uint64_t reach(const struct mh_neighbours *table, const struct mh_neighbour *n)
{
    const uint32_t dx = size_of(n->x_mm - table->place.x_mm), dy = size_of(n->y_mm - table->place.y_mm);
    const uint32_t distance = dx > dy ? dx + dy / 2 : dy + dx / 2;
    return (uint64_t)distance * mh_neighbour_quality(n);
}

static uint8_t octant(const struct mh_neighbours *table, const struct mh_neighbour *n)
{
    const int32_t dx = n->x_mm - table->place.x_mm, dy = n->y_mm - table->place.y_mm;
    return (uint8_t)((dx < 0) | (dy < 0) << 1 | (size_of(dx) < size_of(dy)) << 2);
}

static uint8_t worst_unused(const struct mh_neighbours *table)
{
    uint8_t worst = NOBODY;
    for (uint8_t i = 0; i < table->count; i++) {
        const struct mh_neighbour *n = &table->list[i];
        if (!mh_neighbour_usable(n) && n->id != table->kept &&
            (worst == NOBODY || mh_neighbour_quality(n) < mh_neighbour_quality(&table->list[worst]))) {
            worst = i;
        }
    }
    return worst;
}

static bool may_give_way(const struct mh_neighbours *table, const struct mh_neighbour *n)
{
    return n->edge == MH_EDGE_WITNESSED && n->id != table->kept;
}

/* Among the entries with a witness, and the newcomer if it has one. Returns NOBODY if nobody has; the table's count for the newcomer. */
static uint8_t least_reach_of_fullest_octant(const struct mh_neighbours *table, const struct mh_neighbour *newcomer)
{
    uint8_t in_octant[OCTANTS] = {0};
    for (uint8_t i = 0; i <= table->count; i++) {
        const struct mh_neighbour *n = i < table->count ? &table->list[i] : newcomer;
        in_octant[octant(table, n)] = (uint8_t)(in_octant[octant(table, n)] + may_give_way(table, n));
    }
    uint8_t fullest = 0;
    for (uint8_t i = 1; i < OCTANTS; i++) {
        fullest = in_octant[i] > in_octant[fullest] ? i : fullest;
    }
    uint8_t least = NOBODY;
    uint64_t least_reach = UINT64_MAX;
    for (uint8_t i = 0; i <= table->count; i++) {
        const struct mh_neighbour *n = i < table->count ? &table->list[i] : newcomer;
        if (may_give_way(table, n) && octant(table, n) == fullest && reach(table, n) <= least_reach) {
            least = i;
            least_reach = reach(table, n);
        }
    }
    return least;
}

static enum mh_status insert(struct mh_neighbours *table, const struct mh_neighbour *newcomer)
{
    if (table->count < table->capacity) {
        table->list[table->count++] = *newcomer;
        return MH_OK;
    }
    uint8_t gives_way = worst_unused(table);
    if (gives_way != NOBODY) {
        count(table, MH_NEIGHBOUR_UNUSED);
    } else {
        gives_way = least_reach_of_fullest_octant(table, newcomer);
        if (gives_way == NOBODY || gives_way == table->count) {
            count(table, gives_way == NOBODY ? MH_NEIGHBOUR_PLANAR : MH_NEIGHBOUR_REFUSED);
            return MH_NONE;
        }
        count(table, MH_NEIGHBOUR_CROWDED);
    }
    table->list[gives_way] = *newcomer;
    return MH_OK;
}

static void erase(struct mh_neighbours *table, uint8_t index)
{
    table->count--;
    table->list[index] = table->list[table->count];
}

/* ---- what happens ---- */

enum mh_status mh_neighbours_init(struct mh_neighbours *table, mh_node_id id, const struct mh_place *place,
                                  uint8_t capacity, mh_tick lifetime)
{
    if (!table || !place || capacity < 1 || capacity > MH_NEIGHBOURS_MAX || lifetime < 512 || lifetime > 3600000u) {
        return MH_ERR_ARGUMENT;
    }
    memset(table, 0, sizeof *table);
    table->id = id;
    table->place = *place;
    table->capacity = capacity;
    table->kept = MH_BROADCAST;
    table->lifetime = mh_coarse_of(lifetime);
    return MH_OK;
}

void mh_neighbours_keep(struct mh_neighbours *table, mh_node_id id) { table->kept = id; }

const struct mh_neighbour *mh_neighbours_find(const struct mh_neighbours *table, mh_node_id id)
{
    for (uint8_t i = 0; i < table->count; i++) {
        if (table->list[i].id == id) {
            return &table->list[i];
        }
    }
    return NULL;
}

enum mh_status mh_neighbours_hello(struct mh_neighbours *table, mh_tick now, const mh_hello_t *hello)
{
    struct mh_neighbour sender = {.id = (mh_node_id)hello->sender,
                                  .x_mm = hello->x_mm,
                                  .y_mm = hello->y_mm,
                                  .heard_at = mh_coarse_of(now),
                                  .sequence = (uint8_t)hello->sequence,
                                  .heard = SHARE_NEW,
                                  .acked = SHARE_MAX};
    if (sender.id == table->id) {
        return MH_ERR_ARGUMENT;
    }
    for (uint8_t i = 0; i < table->count; i++) {
        struct mh_neighbour *n = &table->list[i];
        if (n->id == sender.id && is_at(n, sender.x_mm, sender.y_mm)) {
            take_hello(n, sender.heard_at, sender.sequence);
            if (mh_neighbour_usable(n)) {
                mark_those_witnessed_by(table, n);
            }
            return MH_OK;
        }
        if (n->id == sender.id) { /* it has moved */
            erase(table, i);
            break;
        }
    }
    mark_those_witnessed_by(table, &sender);
    look_for_a_witness(table, &sender);
    return insert(table, &sender);
}

void mh_neighbours_age(struct mh_neighbours *table, mh_tick now)
{
    for (uint8_t i = table->count; i-- > 0;) {
        struct mh_neighbour *n = &table->list[i];
        if (mh_coarse_over(now, n->heard_at, table->lifetime)) {
            count(table, MH_NEIGHBOUR_SILENT);
            erase(table, i);
        } else if (n->edge == MH_EDGE_WITNESSED && mh_coarse_over(now, n->witnessed_at, table->lifetime)) {
            n->edge = MH_EDGE_GABRIEL;
        }
    }
}
