/* Which true target an identifier of the network stands for. An identifier is matched when it is first heard of, and for good: to the target nearest to its first estimate
 * that no other identifier has, if that is within twice the sensing range, else to the nearest of all. So a track that changes over to another target is found out, and
 * one that is begun anew is not taken for a target far away. A group is matched target by target, those that were never heard of alone for
 * this once, and compared with the middle of those. */
#ifndef MOTEHOUND_SIM_IDENTIFY_H
#define MOTEHOUND_SIM_IDENTIFY_H

#include "motehound/estimate.h"
#include "world/targets.h"

#include <stdint.h>

enum { IDENTIFIED_MAX = 256 }; /* identifiers kept; the oldest are forgotten */

#define NOT_IDENTIFIED UINT32_MAX

struct identified {
    struct target_state state; /* of a group: the middle of its targets that are there, and their mean velocity */
    uint32_t number;           /* NOT_IDENTIFIED: a group, or nothing is there */
};

/* All zero bytes but for the range: nobody is known. */
struct identify {
    double range_m; /* sensing range */
    struct identify_pair {
        uint32_t id, number;
    } pairs[IDENTIFIED_MAX];
    size_t count; /* of all that ever were */
};

/* The number of the target that `id` stands for, which is said to be at `at` at time_s. NOT_IDENTIFIED where no target is there and it is new. */
uint32_t identify_target(struct identify *identify, const struct targets *targets, uint32_t id, struct point at,
                         double time_s);

/* What an estimate for time_s is to be compared with. */
struct identified identify_estimate(struct identify *identify, const struct targets *targets,
                                    const struct mh_estimate *estimate, double time_s);

/* Where an estimate says the target is, m. */
struct point identify_place(const struct mh_estimate *estimate);

#endif
