#include "motehound/geographic.h"

#include <string.h>

void mh_geographic_address(struct mh_message *message, mh_node_id origin, int16_t sequence, mh_node_id destination,
                           const struct mh_place *place)
{
    const mh_face_t header = {.route = {.sender = (int32_t)origin,
                                        .origin = (int32_t)origin,
                                        .destination = (int32_t)destination,
                                        .x_mm = place->x_mm,
                                        .y_mm = place->y_mm,
                                        .sequence = sequence}};
    message->envelope = MH_ENVELOPE_ROUTE;
    message->header = header;
}

static struct mh_place place_of(const struct mh_neighbour *neighbour)
{
    const struct mh_place place = {neighbour->x_mm, neighbour->y_mm, 0};
    return place;
}

/* ---- greedy ---- */

/* Differences of coordinates are below 2^31, so that sums of two of their products are below 2^63. */
static uint64_t square_of_distance(const struct mh_place *a, const struct mh_place *b)
{
    const int64_t dx = a->x_mm - b->x_mm, dy = a->y_mm - b->y_mm;
    return (uint64_t)(dx * dx + dy * dy);
}

/* Nodes equally far from the destination are told apart by their identifiers, so that none sends a message back. */
static bool is_nearer(uint64_t a, mh_node_id a_id, uint64_t b, mh_node_id b_id)
{
    return a < b || (a == b && a_id < b_id);
}

/* The best of the neighbours that are nearer to the goal than a place at that distance, `id`'s. The destination itself is one of
 * them, wherever it has moved. */
static const struct mh_neighbour *greedy(const struct mh_neighbours *table, mh_node_id destination,
                                         const struct mh_place *goal, uint64_t limit_square, mh_node_id id)
{
    const uint32_t limit = mh_square_root(limit_square);
    const struct mh_neighbour *best = NULL;
    uint64_t best_square = 0, best_score = 0;
    for (uint8_t i = 0; i < table->count; i++) {
        const struct mh_neighbour *n = &table->list[i];
        const struct mh_place place = place_of(n);
        const uint64_t square = n->id == destination ? 0 : square_of_distance(&place, goal);
        if (!mh_neighbour_usable(n) || (n->id != destination && !is_nearer(square, n->id, limit_square, id))) {
            continue;
        }
        if (best && square > best_square && mh_neighbour_quality(n) <= mh_neighbour_quality(best)) {
            continue; /* spares the root */
        }
        const uint64_t score = (uint64_t)(limit - mh_square_root(square)) * mh_neighbour_quality(n);
        if (!best || score > best_score ||
            (score == best_score && (n->id == destination || is_nearer(square, n->id, best_square, best->id)))) {
            best = n;
            best_square = square;
            best_score = score;
        }
    }
    return best;
}

/* ---- faces ---- */

struct direction {
    int32_t x, y;
};

static struct direction direction_to(const struct mh_neighbours *table, int32_t x_mm, int32_t y_mm)
{
    const struct direction d = {x_mm - table->place.x_mm, y_mm - table->place.y_mm};
    return d;
}

static int64_t cross(struct direction a, struct direction b) { return (int64_t)a.x * b.y - (int64_t)a.y * b.x; }

static int64_t dot(struct direction a, struct direction b) { return (int64_t)a.x * b.x + (int64_t)a.y * b.y; }

/* Of the angle from `from` counterclockwise to d, which is above 0 and at most 360 degrees: below 180, 180, below 360, 360. */
static uint8_t turn(struct direction from, struct direction d)
{
    const int64_t side = cross(from, d);
    return side > 0 ? 0 : side < 0 ? 2 : dot(from, d) < 0 ? 1 : 3;
}

static bool comes_first(struct direction from, struct direction a, struct direction b)
{
    const uint8_t turn_a = turn(from, a), turn_b = turn(from, b);
    return turn_a != turn_b ? turn_a < turn_b : cross(a, b) > 0;
}

static const struct mh_neighbour *first_counterclockwise(const struct mh_neighbours *table, struct direction from)
{
    const struct mh_neighbour *first = NULL;
    struct direction first_direction = {0, 0};
    for (uint8_t i = 0; i < table->count; i++) {
        const struct mh_neighbour *n = &table->list[i];
        const struct direction d = direction_to(table, n->x_mm, n->y_mm);
        if (mh_neighbour_planar(table, n) && (!first || comes_first(from, d, first_direction))) {
            first = n;
            first_direction = d;
        }
    }
    return first;
}

/* ---- both ---- */

/* The next hop: to whom, and how. */
struct step {
    const struct mh_neighbour *to;
    enum { NEARER, AROUND_A_NEW_FACE, AROUND_THE_FACE } how;
};

/* No neighbour is nearer: begin to walk around a face. */
static enum mh_hop enter(const struct mh_neighbours *table, const struct mh_place *goal, bool for_the_nearest,
                         struct step *step)
{
    step->how = AROUND_A_NEW_FACE;
    step->to = first_counterclockwise(table, direction_to(table, goal->x_mm, goal->y_mm));
    if (!step->to) {
        return for_the_nearest ? MH_HOP_ARRIVED : MH_HOP_NO_NEIGHBOUR;
    }
    if (square_of_distance(&table->place, goal) == 0) { /* nobody is nearer anywhere */
        return for_the_nearest ? MH_HOP_ARRIVED : MH_HOP_UNREACHABLE;
    }
    return MH_HOP_NEXT;
}

static enum mh_hop walk_on(const struct mh_neighbours *table, const mh_face_t *header, struct step *step)
{
    step->how = AROUND_THE_FACE;
    step->to = first_counterclockwise(table, direction_to(table, header->sender_x_mm, header->sender_y_mm));
    if (!step->to) {
        return MH_HOP_NO_NEIGHBOUR;
    }
    if (header->entry == (int32_t)table->id && header->first == (int32_t)step->to->id) {
        return header->route.destination == (int32_t)MH_BROADCAST ? MH_HOP_ARRIVED : MH_HOP_UNREACHABLE;
    }
    return MH_HOP_NEXT;
}

static enum mh_hop choose(const struct mh_neighbours *table, bool faces, const struct mh_message *message,
                          struct step *step)
{
    const mh_face_t *header = &message->header;
    const mh_route_t *route = &header->route;
    const struct mh_place goal = {route->x_mm, route->y_mm, 0};
    if (route->destination == (int32_t)table->id) {
        return MH_HOP_ARRIVED;
    }
    if (route->hops >= MH_ROUTE_HOPS_MAX) {
        return MH_HOP_TOO_MANY;
    }
    const struct mh_place entry = {header->entry_x_mm, header->entry_y_mm, 0};
    const uint64_t here_square = square_of_distance(&table->place, &goal);
    const uint64_t entry_square = square_of_distance(&entry, &goal);
    const bool walks = message->envelope == MH_ENVELOPE_FACE && here_square >= entry_square;
    step->how = NEARER;
    step->to = walks ? greedy(table, (mh_node_id)route->destination, &goal, entry_square, 0)
                     : greedy(table, (mh_node_id)route->destination, &goal, here_square, table->id);
    if (step->to) {
        return MH_HOP_NEXT;
    }
    if (!faces) {
        return MH_HOP_NO_NEIGHBOUR;
    }
    return walks ? walk_on(table, header, step)
                 : enter(table, &goal, route->destination == (int32_t)MH_BROADCAST, step);
}

static enum mh_envelope_kind leave(const struct mh_neighbours *table, const struct step *step, mh_face_t *header)
{
    if (step->how == AROUND_A_NEW_FACE) {
        header->entry = (int32_t)table->id;
        header->entry_x_mm = table->place.x_mm;
        header->entry_y_mm = table->place.y_mm;
        header->first = (int32_t)step->to->id;
    }
    header->route.sender = (int32_t)table->id;
    header->route.hops++;
    header->sender_x_mm = table->place.x_mm;
    header->sender_y_mm = table->place.y_mm;
    return step->how == NEARER ? MH_ENVELOPE_ROUTE : MH_ENVELOPE_FACE;
}

enum mh_hop mh_geographic_next(const struct mh_neighbours *table, bool faces, const struct mh_message *message,
                               struct mh_message *leaving, mh_node_id *next)
{
    struct step step;
    const enum mh_hop hop = choose(table, faces, message, &step);
    if (hop == MH_HOP_NEXT) {
        *leaving = *message;
        leaving->envelope = leave(table, &step, &leaving->header);
        *next = step.to->id;
    }
    return hop;
}

/* A function of its own: the header is not on the stack while the hop is chosen, which goes deep. */
static void send(struct mh_link *link, const struct mh_neighbours *table, const struct step *step,
                 const struct mh_message *due)
{
    mh_face_t header = due->header;
    const enum mh_envelope_kind envelope = leave(table, step, &header);
    mh_link_send(link, step->to->id, envelope, &header);
}

enum mh_hop mh_geographic_send(struct mh_link *link, const struct mh_neighbours *table, bool faces,
                               const struct mh_message *due)
{
    struct step step;
    const enum mh_hop hop = choose(table, faces, due, &step);
    if (hop == MH_HOP_NEXT) {
        send(link, table, &step, due);
    }
    return hop;
}

enum mh_loss mh_geographic_loss(enum mh_hop hop)
{
    switch (hop) {
    case MH_HOP_UNREACHABLE:
        return MH_LOSS_LOOP;
    case MH_HOP_TOO_MANY:
        return MH_LOSS_HOPS;
    default:
        return MH_LOSS_NO_ROUTE;
    }
}
