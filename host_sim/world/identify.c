#include "world/identify.h"
#include "reals.h"

#include <math.h>

static size_t known(const struct identify *identify)
{
    return identify->count < IDENTIFIED_MAX ? identify->count : IDENTIFIED_MAX;
}

static bool is_taken(const struct identify *identify, size_t number)
{
    for (size_t i = 0; i < known(identify); i++) {
        if (identify->pairs[i].number == number) {
            return true;
        }
    }
    return false;
}

/* The nearest target that is there, of those that nobody has or of all; NOT_IDENTIFIED: none within limit_m. */
static uint32_t nearest(const struct identify *identify, const struct targets *targets, struct point at, double time_s,
                        bool free, double limit_m)
{
    uint32_t best = NOT_IDENTIFIED;
    double least_m = limit_m;
    for (size_t k = 0; k < targets->count; k++) {
        const struct target_state state = targets_at(targets, k, time_s);
        const double distance_m = hypot(state.at.x_m - at.x_m, state.at.y_m - at.y_m);
        if (state.present && distance_m <= least_m && !(free && is_taken(identify, k))) {
            best = (uint32_t)k;
            least_m = distance_m;
        }
    }
    return best;
}

uint32_t identify_target(struct identify *identify, const struct targets *targets, uint32_t id, struct point at,
                         double time_s)
{
    for (size_t i = 0; i < known(identify); i++) {
        if (identify->pairs[i].id == id) {
            return identify->pairs[i].number;
        }
    }
    uint32_t number = nearest(identify, targets, at, time_s, true, 2 * identify->range_m);
    if (number == NOT_IDENTIFIED) {
        number = nearest(identify, targets, at, time_s, false, (double)INFINITY);
    }
    if (number != NOT_IDENTIFIED) {
        identify->pairs[identify->count++ % IDENTIFIED_MAX] = (struct identify_pair){id, number};
    }
    return number;
}

struct point identify_place(const struct mh_estimate *estimate)
{
    return (struct point){estimate->origin.x_mm / 1e3 + number_of(estimate->position.x),
                          estimate->origin.y_mm / 1e3 + number_of(estimate->position.y)};
}

struct identified identify_estimate(struct identify *identify, const struct targets *targets,
                                    const struct mh_estimate *estimate, double time_s)
{
    const struct point at = identify_place(estimate);
    const unsigned members = estimate->members > 1 ? estimate->members : 1;
    struct identify provisional = *identify; /* who is met first in a group is nobody in particular yet */
    struct identify *matched = members > 1 ? &provisional : identify;
    struct identified found = {.number = NOT_IDENTIFIED};
    struct target_state *middle = &found.state;
    double count = 0;
    for (unsigned i = 0; i < members && i < MH_GROUP_MAX; i++) {
        const uint32_t id = members > 1 ? estimate->of[i] : estimate->target;
        const uint32_t number = identify_target(matched, targets, id, at, time_s);
        const struct target_state state =
            number != NOT_IDENTIFIED ? targets_at(targets, number, time_s) : (struct target_state){0};
        found.number = members > 1 ? NOT_IDENTIFIED : number;
        if (state.present) {
            middle->present = true;
            middle->at.x_m += state.at.x_m;
            middle->at.y_m += state.at.y_m;
            middle->velocity.x_m += state.velocity.x_m;
            middle->velocity.y_m += state.velocity.y_m;
            count++;
        }
    }
    if (count > 1) {
        middle->at = (struct point){middle->at.x_m / count, middle->at.y_m / count};
        middle->velocity = (struct point){middle->velocity.x_m / count, middle->velocity.y_m / count};
    }
    return found;
}
