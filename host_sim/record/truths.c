#include "record/truths.h"

#include <math.h>

static const double end_m = 150;

/* The first that is not before time_s. */
static size_t first_from(const struct recorder *recorder, double time_s)
{
    size_t low = 0, high = recorder->truth_count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (recorder->truths[middle].time_s < time_s) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Those of a target around a time; NULL: there is none on that side. */
struct neighbours {
    const motehound_truth_t *before, *from;
};

static const motehound_truth_t *next_of(const struct recorder *recorder, size_t number, size_t i)
{
    while (i < recorder->truth_count && recorder->truths[i].target != (int32_t)number) {
        i++;
    }
    return i < recorder->truth_count ? &recorder->truths[i] : NULL;
}

static struct neighbours around(const struct recorder *recorder, size_t number, double time_s)
{
    const size_t first = first_from(recorder, time_s);
    size_t i = first;
    while (i > 0 && recorder->truths[i - 1].target != (int32_t)number) {
        i--;
    }
    return (struct neighbours){i > 0 ? &recorder->truths[i - 1] : NULL, next_of(recorder, number, first)};
}

bool truths_present(const struct recorder *recorder, size_t number, double time_s)
{
    const struct neighbours found = around(recorder, number, time_s);
    return found.from != NULL && (found.before != NULL || found.from->time_s <= time_s);
}

bool truths_at(const struct recorder *recorder, size_t number, double time_s, struct point *place)
{
    const struct neighbours found = around(recorder, number, time_s);
    const motehound_truth_t *a = found.before != NULL ? found.before : found.from;
    const motehound_truth_t *b = found.from != NULL ? found.from : found.before;
    if (a == NULL) {
        return false;
    }
    const double share = b->time_s > a->time_s ? (time_s - a->time_s) / (b->time_s - a->time_s) : 0;
    *place = (struct point){a->x_m + share * (b->x_m - a->x_m), a->y_m + share * (b->y_m - a->y_m)};
    return true;
}

double truths_way_m(const struct recorder *recorder, size_t number, double from_s, double to_s)
{
    struct point here, there;
    double way_m = 0;
    if (!truths_at(recorder, number, from_s, &here) || !truths_at(recorder, number, to_s, &there)) {
        return 0;
    }
    for (size_t i = first_from(recorder, from_s); i < recorder->truth_count && recorder->truths[i].time_s < to_s; i++) {
        const motehound_truth_t *truth = &recorder->truths[i];
        if (truth->target == (int32_t)number) {
            way_m += hypot(truth->x_m - here.x_m, truth->y_m - here.y_m);
            here = (struct point){truth->x_m, truth->y_m};
        }
    }
    return to_s > from_s ? way_m + hypot(there.x_m - here.x_m, there.y_m - here.y_m) : 0;
}

bool truths_near_end(const struct recorder *recorder, size_t number, double time_s)
{
    return truths_way_m(recorder, number, time_s, recorder->last_s) <= end_m;
}
