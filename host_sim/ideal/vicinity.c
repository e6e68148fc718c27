#include "ideal/vicinity.h"

#include "motehound/geographic.h"
#include "radio/places.h"
#include "roster.h"

#include <stdlib.h>
#include <string.h>

#define UNKNOWN UINT32_MAX
#define LIFETIME 600000u /* of an entry in a table, which is made and used at one moment */

static int find_neighbours(struct vicinity *vicinity, const struct places *places, double radio_range_m)
{
    size_t room = 0, used = 0;
    uint32_t *found = malloc(vicinity->count * sizeof *found);
    if (!found) {
        return -1;
    }
    for (uint32_t i = 0; i < vicinity->count; i++) {
        const size_t near = places_within(places, i, radio_range_m, found);
        if (used + near > room) {
            const size_t larger = 2 * room + near + vicinity->count;
            uint32_t *moved = realloc(vicinity->neighbours, larger * sizeof *moved);
            if (!moved) {
                free(found);
                return -1;
            }
            vicinity->neighbours = moved;
            room = larger;
        }
        vicinity->first[i] = used;
        if (near > 0) {
            memcpy(vicinity->neighbours + used, found, near * sizeof *found);
        }
        used += near;
    }
    vicinity->first[vicinity->count] = used;
    free(found);
    return 0;
}

static int link_up(struct vicinity *vicinity, double radio_range_m)
{
    double *x_m = malloc(vicinity->count * sizeof *x_m), *y_m = malloc(vicinity->count * sizeof *y_m);
    struct places places;
    int result = -1;
    if (x_m && y_m) {
        for (uint32_t i = 0; i < vicinity->count; i++) {
            x_m[i] = vicinity->place[i].x_mm * 1e-3;
            y_m[i] = vicinity->place[i].y_mm * 1e-3;
        }
        result = places_make(&places, x_m, y_m, vicinity->count, radio_range_m);
    }
    if (result == 0) {
        result = find_neighbours(vicinity, &places, radio_range_m);
        places_free(&places);
    }
    free(x_m);
    free(y_m);
    return result;
}

int vicinity_make(struct vicinity *vicinity, uint32_t count, const mh_node_id *ids, const struct mh_place *places,
                  double radio_range_m)
{
    *vicinity = (struct vicinity){.count = count,
                                  .id = malloc(count * sizeof *vicinity->id),
                                  .place = malloc(count * sizeof *vicinity->place),
                                  .first = malloc((count + (size_t)1) * sizeof *vicinity->first),
                                  .next = malloc(count * sizeof *vicinity->next)};
    if (!vicinity->id || !vicinity->place || !vicinity->first || !vicinity->next) {
        return -1;
    }
    memcpy(vicinity->id, ids, count * sizeof *ids);
    memcpy(vicinity->place, places, count * sizeof *places);
    for (uint32_t i = 0; i < count; i++) {
        vicinity->next[i] = UNKNOWN;
    }
    return link_up(vicinity, radio_range_m);
}

int vicinity_of(struct vicinity *vicinity, const struct scenario *scenario, const struct deployment *deployment,
                double radio_range_m)
{
    const uint32_t nodes = (uint32_t)deployment->count;
    const struct scenario_field field = scenario_field(scenario);
    mh_node_id *ids = malloc((nodes + (size_t)1) * sizeof *ids);
    struct mh_place *places = malloc((nodes + (size_t)1) * sizeof *places);
    int result = -1;
    if (ids && places) {
        for (uint32_t i = 0; i < nodes; i++) {
            const struct recorded_node *node = &deployment->nodes[i];
            ids[i] = node->id;
            places[i] = place_from_metres(node->x_m, node->y_m, node->z_m);
        }
        ids[nodes] = deployment->nodes[nodes - 1].id + 1;
        places[nodes] = place_from_metres(field.sink_x_m, field.sink_y_m, 0);
        result = vicinity_make(vicinity, nodes + 1, ids, places, radio_range_m);
    }
    free(ids);
    free(places);
    return result;
}

void vicinity_free(struct vicinity *vicinity)
{
    free(vicinity->id);
    free(vicinity->place);
    free(vicinity->neighbours);
    free(vicinity->first);
    free(vicinity->next);
    *vicinity = (struct vicinity){0};
}

uint32_t vicinity_find(const struct vicinity *vicinity, mh_node_id id)
{
    uint32_t low = 0, high = vicinity->count;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (vicinity->id[middle] <= id) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* What mote `i` knows after each of its neighbours has said hello twice, as its Gabriel edges need. */
static void make_table(const struct vicinity *vicinity, uint32_t i, struct mh_neighbours *table)
{
    (void)mh_neighbours_init(table, vicinity->id[i], &vicinity->place[i], MH_NEIGHBOURS_MAX, LIFETIME);
    mh_neighbours_keep(table, vicinity->id[vicinity->count - 1]);
    for (int16_t round = 0; round < 2; round++) {
        for (size_t k = vicinity->first[i]; k < vicinity->first[i + 1]; k++) {
            const uint32_t j = vicinity->neighbours[k];
            const mh_hello_t hello = {(int32_t)vicinity->id[j], vicinity->place[j].x_mm, vicinity->place[j].y_mm,
                                      round};
            (void)mh_neighbours_hello(table, (mh_tick)(10000 * (round + 1)), &hello);
        }
    }
}

bool vicinity_walk(struct vicinity *vicinity, uint32_t from, void (*hop)(void *context, uint32_t from, uint32_t to),
                   void *context)
{
    const uint32_t sink = vicinity->count - 1;
    struct mh_message message = {.kind = MH_MESSAGE_REPORT};
    mh_geographic_address(&message, vicinity->id[from], 0, vicinity->id[sink], &vicinity->place[sink]);
    for (uint32_t at = from; at != sink;) {
        const bool greedy = message.envelope == MH_ENVELOPE_ROUTE;
        uint32_t to = greedy ? vicinity->next[at] : UNKNOWN;
        if (to == UNKNOWN) {
            struct mh_neighbours table;
            mh_node_id next;
            make_table(vicinity, at, &table);
            if (mh_geographic_next(&table, true, &message, &message, &next) != MH_HOP_NEXT) {
                return false;
            }
            to = vicinity_find(vicinity, next);
            if (greedy && message.envelope == MH_ENVELOPE_ROUTE) {
                vicinity->next[at] = to;
            }
        }
        hop(context, at, to);
        at = to;
    }
    return true;
}
