/* Who hears whom, and how messages travel over many hops, in a network where every frame arrives within the radio range and none beyond it. */
#ifndef MOTEHOUND_SIM_IDEAL_VICINITY_H
#define MOTEHOUND_SIM_IDEAL_VICINITY_H

#include "motehound/geometry.h"
#include "motehound/measurement.h"
#include "scenario/scenario.h"
#include "world/deployment.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct vicinity {
    uint32_t count; /* of motes; the last one is the sink */
    mh_node_id *id; /* of each, ascending */
    struct mh_place *place;
    uint32_t *neighbours; /* of mote i: [first[i] .. first[i + 1]) */
    size_t *first;
    uint32_t *next; /* hop from each mote towards the sink, where it is known and always the same */
};

/* The `count` motes with these identifiers and places, which are copied; the last one is the sink. Returns 0, or -1 if there is no memory;
 * vicinity_free it in any case. */
int vicinity_make(struct vicinity *vicinity, uint32_t count, const mh_node_id *ids, const struct mh_place *places,
                  double radio_range_m);

/* The same of the nodes laid out and the scenario's sink, whose identifier is the largest node's plus one. */
int vicinity_of(struct vicinity *vicinity, const struct scenario *scenario, const struct deployment *deployment,
                double radio_range_m);

void vicinity_free(struct vicinity *vicinity);

/* Mote with identifier `id`, which there is. */
uint32_t vicinity_find(const struct vicinity *vicinity, mh_node_id id);

/* The way of a message from mote `from` to the sink by geographic.h, with a table of neighbours at every mote that has heard all of them: hop() is
 * called for each hop. Returns true if it arrives. */
bool vicinity_walk(struct vicinity *vicinity, uint32_t from, void (*hop)(void *context, uint32_t from, uint32_t to),
                   void *context);

#endif
